//! What a segment of many axes with physics costs, of what a core has: drives in Operation Enabled, which follow sines in CSP with a cycle of 500 us.
//!
//! One iteration is a cycle: a frame through all chips and ten control ticks of each drive, its physics included. Times are CPU time of the
//! one thread that does it; what the master computes does not count.

use std::f64::consts::TAU;
use std::time::Duration;

use benchmarks::bring_up;
use benchmarks::bus::{Bus, FRAME_TIME, Lockstep};
use benchmarks::cpu_time::cpu_time;
use benchmarks::cyclic::{Cycle, Image};
use benchmarks::machine;
use criterion::Criterion;
use usr2556e::drive::VirtualDrive;

const CYCLE: Duration = Duration::from_micros(500);
/// Cycles of the sine.
const SINE_CYCLES: u64 = 2000;
/// Its amplitude in pulses: with a period of 1 s, 300 rpm at its steepest when the resolution is 10 000.
const AMPLITUDE: f64 = 8000.0;
/// What a drive may lag behind its target in pulses: a cycle of interpolation and the filter's 6.4 ms, at 50 pulses a ms.
const MOST_LAG: i32 = 600;

/// Drives that follow their sines, each another part of it.
struct Axes {
    bus: Lockstep,
    cycle: Cycle,
    starts: Vec<i32>,
    frames: Vec<Vec<u8>>,
    done: u64,
}

impl Axes {
    fn new(drives: usize) -> Self {
        let mut bus = Lockstep::new(drives);
        let mut cycle = Cycle::new(drives, Image::Separate, true);
        bring_up::to_op(&mut bus, &mut cycle);
        bring_up::enable(&mut bus, &mut cycle);
        let starts = cycle.inputs.iter().map(|inputs| inputs.position).collect();
        let mut axes = Self {
            bus,
            cycle,
            starts,
            frames: Vec::new(),
            done: 0,
        };
        axes.frames = (0..SINE_CYCLES).map(|number| axes.frame(number)).collect();
        axes
    }

    /// Where a drive is to be: all swing up from where they stand, and each has another amplitude.
    fn target(&self, drive: usize, number: u64) -> i32 {
        let height = AMPLITUDE * (drive + 1) as f64 / self.starts.len() as f64;
        let phase = TAU * (number % SINE_CYCLES) as f64 / SINE_CYCLES as f64;
        self.starts[drive] + (height * (1.0 - phase.cos())) as i32
    }

    fn frame(&mut self, number: u64) -> Vec<u8> {
        for drive in 0..self.starts.len() {
            self.cycle.outputs[drive].target_position = self.target(drive, number);
        }
        let mut frames = self.cycle.frames();
        assert_eq!(frames.len(), 1, "all process data fit into one frame");
        frames.remove(0)
    }

    /// CPU time of some cycles.
    fn run(&mut self, cycles: u64) -> Duration {
        let rest = CYCLE - Duration::from_nanos(FRAME_TIME.0);
        let mut buffer = self.frames[0].clone();
        let begin = cpu_time();
        for number in self.done..self.done + cycles {
            buffer.copy_from_slice(&self.frames[(number % SINE_CYCLES) as usize]);
            self.bus.exchange(&mut buffer);
            self.bus.pause(rest);
        }
        let taken = cpu_time() - begin;
        self.done += cycles;
        self.check(buffer);
        taken
    }

    fn check(&mut self, frame: Vec<u8>) {
        assert!(self.cycle.take(&[frame]), "a drive has left OP");
        for (drive, inputs) in self.cycle.inputs.iter().enumerate() {
            let lag = inputs.position - self.target(drive, self.done - 1);
            assert!(lag.abs() < MOST_LAG, "drive {drive} does not follow: {lag} pulses behind");
        }
        assert!(self.bus.segment.drives().iter().all(is_in_step), "a motor has lost steps");
    }
}

/// The shaft is where the drive's counter says, within half an electrical period.
fn is_in_step(drive: &VirtualDrive) -> bool {
    let objects = drive.device().objects();
    let counter = f64::from(objects.position) / f64::from(objects.resolution);
    (drive.plant().shaft().0 - counter).abs() < 0.5 / f64::from(board::ELECTRICAL_PERIODS_PER_TURN)
}

fn main() {
    println!("{}", machine::describe());
    let mut criterion = Criterion::default()
        .warm_up_time(Duration::from_millis(500))
        .measurement_time(Duration::from_secs(3))
        .sample_size(20)
        .without_plots()
        .configure_from_args();
    for drives in [1, 16, 64] {
        let mut axes = Axes::new(drives);
        criterion.bench_function(&format!("{drives} axes, a cycle of 500 us"), |bencher| {
            bencher.iter_custom(|cycles| axes.run(cycles));
        });
    }
    criterion.final_summary();
}
