//! What the slave controllers cost: the frames of one cycle through a line of chips in memory, without the drives behind them.
//!
//! The drives are in OP over their default process data: each chip takes 7 bytes from the frame through an FMMU into the three buffers of
//! SM2, and puts 11 bytes of SM3 in. Times are CPU time; `frame` is per cycle, `chip` is the same divided by the number of chips.

use std::hint::black_box;
use std::time::Duration;

use benchmarks::bring_up;
use benchmarks::bus::Lockstep;
use benchmarks::cpu_time::cpu_time;
use benchmarks::cyclic::{Cycle, Image};
use benchmarks::machine;
use criterion::{BenchmarkId, Criterion};
use wire::Nanos;

/// Chips in the line.
const LINES: [usize; 3] = [1, 10, 100];

/// Time between two cycles, as the chips see it.
const CYCLE: Nanos = Nanos(1_000_000);

/// What a cycle consists of: name, place of the process data, whether it distributes the clock.
const CYCLES: [(&str, Image, bool); 4] = [
    ("LRW", Image::Overlapping, false),
    ("FRMW+LRW", Image::Overlapping, true),
    ("LRW separate", Image::Separate, false),
    ("FRMW+LRW separate", Image::Separate, true),
];

/// Drives in OP and the frames they are sent each cycle.
struct Line {
    drives: Lockstep,
    cycle: Cycle,
    frames: Vec<Vec<u8>>,
    returned: Vec<Vec<u8>>,
}

impl Line {
    fn new(chips: usize, image: Image, distribute_clock: bool) -> Self {
        let mut drives = Lockstep::new(chips);
        let mut cycle = Cycle::new(chips, image, distribute_clock);
        bring_up::to_op(&mut drives, &mut cycle);
        bring_up::enable(&mut drives, &mut cycle);
        let frames = cycle.frames();
        Self {
            drives,
            cycle,
            returned: frames.clone(),
            frames,
        }
    }

    /// CPU time of so many cycles. Their frames are new each time, as those of a master.
    fn run(&mut self, cycles: u64) -> Duration {
        let begin = cpu_time();
        for _ in 0..cycles {
            self.drives.now.0 += CYCLE.0;
            for (frame, returned) in self.frames.iter().zip(&mut self.returned) {
                returned.copy_from_slice(frame);
                black_box(self.drives.segment.process(black_box(returned), self.drives.now));
            }
        }
        let taken = cpu_time() - begin;
        assert!(self.cycle.take(&self.returned), "a chip has not taken part");
        taken
    }
}

fn main() {
    println!("{}", machine::describe());
    let mut criterion = Criterion::default()
        .warm_up_time(Duration::from_millis(300))
        .measurement_time(Duration::from_millis(1000))
        .sample_size(50)
        .without_plots()
        .configure_from_args();
    for (name, image, distribute_clock) in CYCLES {
        let mut group = criterion.benchmark_group(name);
        for chips in LINES {
            let mut line = Line::new(chips, image, distribute_clock);
            group.bench_function(BenchmarkId::new("frame", chips), |bencher| {
                bencher.iter_custom(|cycles| line.run(cycles))
            });
            if chips > 1 {
                group.bench_function(BenchmarkId::new("chip", chips), |bencher| {
                    bencher.iter_custom(|cycles| line.run(cycles) / chips as u32);
                });
            }
        }
        group.finish();
    }
    criterion.final_summary();
}
