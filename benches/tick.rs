//! What a control tick of 50 us costs: a whole virtual drive by `VirtualDrive::catch_up`, firmware core and plant together with everything on,
//! and the plant by what it is made of.
//!
//! Times are CPU time per tick. For a whole drive one iteration is a cycle of 1 ms with 20 ticks; in OP, the cycle begins with the
//! master's frame, which is part of the time: a 20th of a frame is in each tick.

use std::f64::consts::TAU;
use std::hint::black_box;
use std::time::Duration;

use benchmarks::bring_up;
use benchmarks::bus::{Bus, Lockstep};
use benchmarks::cpu_time::cpu_time;
use benchmarks::cyclic::{Cycle, Image};
use benchmarks::field;
use benchmarks::machine;
use benchmarks::scenario::SCENARIOS;
use board::{Actuators, Sensors, TICK, TICKS_PER_SECOND};
use criterion::Criterion;
use drive::{Drive, DriveObjects};
use plant::{Coupling, Plant, PlantConfig, Turns, motors};

/// Ticks of a cycle of 1 ms.
const TICKS: u32 = (bring_up::CYCLE.as_nanos() as u64 / TICK.0) as u32;

/// Cycles of the sine that moving drives follow, of one turn to either side: 300 rpm at its steepest.
const SINE_CYCLES: u64 = 1000;
/// Its amplitude in pulses.
const AMPLITUDE: f64 = 5000.0;

/// What a moving drive may lag behind its target in pulses: a cycle of interpolation and the filter's 6.4 ms, at 31 pulses a ms.
const MOST_LAG: i32 = 400;

/// The scenarios that are timed.
const TIMED: [&str; 3] = ["PP, set-points on the fly", "CSP, 1 ms", "homing, turned at a limit"];

/// Target positions of a moving drive.
fn sine(cycle: u64) -> i32 {
    (AMPLITUDE * (TAU * (cycle % SINE_CYCLES) as f64 / SINE_CYCLES as f64).sin()) as i32
}

/// Calls `cycle` with the number of each cycle; CPU time per tick.
fn per_tick(first: u64, cycles: u64, mut cycle: impl FnMut(u64)) -> Duration {
    let begin = cpu_time();
    for number in first..first + cycles {
        cycle(number);
    }
    (cpu_time() - begin) / TICKS
}

/// A whole virtual drive, without traffic, just switched on.
fn idle(criterion: &mut Criterion) {
    let mut bus = Lockstep::new(1);
    criterion.bench_function("virtual drive, INIT, no traffic", |bencher| {
        bencher.iter_custom(|cycles| per_tick(0, cycles, |_| bus.pause(bring_up::CYCLE)));
    });
}

/// A whole virtual drive, enabled in CSP.
fn operating(criterion: &mut Criterion, name: &str, target: fn(u64) -> i32) {
    let mut bus = Lockstep::new(1);
    let mut cycle = Cycle::new(1, Image::Separate, false);
    bring_up::to_op(&mut bus, &mut cycle);
    bring_up::enable(&mut bus, &mut cycle);
    let mut done = 0;
    criterion.bench_function(name, |bencher| {
        bencher.iter_custom(|cycles| {
            let frames: Vec<Vec<u8>> = (0..SINE_CYCLES)
                .map(|number| {
                    cycle.outputs[0].target_position = target(number);
                    cycle.frames().remove(0)
                })
                .collect();
            let mut buffer = frames[0].clone();
            let taken = per_tick(done, cycles, |number| {
                buffer.copy_from_slice(&frames[(number % SINE_CYCLES) as usize]);
                bus.exchange(&mut buffer);
                bus.pause(bring_up::CYCLE);
            });
            done += cycles;
            assert!(cycle.take(&[buffer.clone()]), "the drive has left OP");
            let lag = cycle.inputs[0].position - target(done - 1);
            assert!(lag.abs() < MOST_LAG, "the drive does not follow: {lag} pulses behind");
            taken
        });
    });
}

/// The firmware core alone, without traffic and disabled.
fn core_idle(criterion: &mut Criterion) {
    let (mut core, mut objects) = (Drive::new(), DriveObjects::new());
    let sensors = Plant::new(PlantConfig::default()).sensors();
    criterion.bench_function("Drive::tick, disabled", |bencher| {
        bencher.iter_custom(|cycles| per_tick(0, cycles, |_| tick(&mut core, &sensors, &mut objects)));
    });
}

/// Firmware core and plant through some scenarios, everything on; and the plant alone with the same commands. An iteration is a whole run,
/// divided by its ticks.
fn everything_on(criterion: &mut Criterion) {
    for scenario in SCENARIOS.iter().filter(|scenario| TIMED.contains(&scenario.name)) {
        criterion.bench_function(&format!("full tick, {}", scenario.name), |bencher| {
            bencher.iter_custom(|runs| {
                let run = |_| {
                    let mut core = (scenario.begin)();
                    let begin = cpu_time();
                    scenario.follow(&mut core);
                    cpu_time() - begin
                };
                (0..runs).map(run).sum::<Duration>() / scenario.ticks
            });
        });
        let mut core = (scenario.begin)();
        let plant = core.plant.clone();
        let commands: Vec<Actuators> = (0..scenario.ticks)
            .map(|tick| {
                (scenario.before_tick)(&mut core, tick);
                core.step();
                core.actuators
            })
            .collect();
        assert!((scenario.succeeded)(&core), "{}", scenario.name);
        replay(criterion, &format!("its Plant::step, {}", scenario.name), &plant, &commands);
    }
}

/// A cycle's ticks.
fn tick(core: &mut Drive, sensors: &Sensors, objects: &mut DriveObjects) {
    for _ in 0..TICKS {
        black_box(core.tick(black_box(sensors), objects));
    }
}

/// The plant alone, by what it is made of.
fn plants(criterion: &mut Criterion) {
    /// A second.
    const STEPS: u32 = TICKS_PER_SECOND;
    let mut config = PlantConfig::default();
    config.travel.stops = (Turns(-1e3), Turns(1e3));
    let three_phases = PlantConfig {
        motor: motors::THREE_PHASE_57,
        ..config
    };
    let mut elastic = config;
    elastic.load.coupling = Some(Coupling {
        stiffness: 50.0,
        damping: 0.01,
    });
    let plants = [
        ("two phases", config, 5.0),
        ("three phases", three_phases, 5.0),
        ("elastic coupling", elastic, 5.0),
        ("two phases at 16 turns/s, two steps a tick", config, 16.0),
    ];
    for (name, config, speed) in plants {
        let (plant, commands) = field::turning(config, speed, STEPS);
        replay(criterion, &format!("Plant::step, {name}"), &plant, &commands);
    }
    let off = vec![Actuators::default(); STEPS as usize];
    replay(criterion, "Plant::step, power stage off", &Plant::new(config), &off);
}

/// A plant's steps under commands that are known beforehand.
fn replay(criterion: &mut Criterion, name: &str, plant: &Plant, commands: &[Actuators]) {
    criterion.bench_function(name, |bencher| {
        bencher.iter_custom(|runs| {
            let run = |_| {
                let mut plant = plant.clone();
                let begin = cpu_time();
                for command in commands {
                    black_box(plant.step(black_box(command)));
                }
                cpu_time() - begin
            };
            (0..runs).map(run).sum::<Duration>() / commands.len() as u32
        });
    });
}

fn main() {
    println!("{}", machine::describe());
    let mut criterion = Criterion::default()
        .warm_up_time(Duration::from_millis(300))
        .measurement_time(Duration::from_millis(1500))
        .sample_size(50)
        .without_plots()
        .configure_from_args();
    idle(&mut criterion);
    operating(&mut criterion, "virtual drive, OP, enabled and standing", |_| 0);
    operating(&mut criterion, "virtual drive, OP, moving in CSP", sine);
    core_idle(&mut criterion);
    everything_on(&mut criterion);
    plants(&mut criterion);
    criterion.final_summary();
}
