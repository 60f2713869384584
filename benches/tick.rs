//! What a control tick of 50 us costs: a whole virtual drive by `VirtualDrive::catch_up`, its firmware core alone, its plant alone, and
//! both of them with everything on.
//!
//! One iteration is a cycle of 1 ms with 20 ticks; times are CPU time per tick. In OP, the cycle begins with the master's frame, which is
//! part of the time: a 20th of a frame is in each tick.

use std::f64::consts::TAU;
use std::hint::black_box;
use std::time::Duration;

use benchmarks::bring_up;
use benchmarks::bus::{Bus, Lockstep};
use benchmarks::cpu_time::cpu_time;
use benchmarks::cyclic::{Cycle, Image};
use benchmarks::machine;
use benchmarks::scenario::SCENARIOS;
use board::{Actuators, Duty, PowerStage, Sensors, TICK};
use criterion::Criterion;
use drive::{Drive, DriveObjects, PowerState};
use plant::{Plant, PlantConfig};
use usr2556e::master::process_data::{mode, towards_enabled};

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

/// The firmware core alone, enabled and moving in CSP.
fn core_moving(criterion: &mut Criterion) {
    let (mut core, mut objects) = (Drive::new(), DriveObjects::new());
    let sensors = Plant::new(PlantConfig::default()).sensors();
    core.set_network(true);
    objects.mode = mode::CYCLIC_POSITION;
    while core.power_state() != PowerState::OperationEnabled {
        objects.controlword = towards_enabled(objects.statusword, objects.controlword);
        core.tick(&sensors, &mut objects);
    }
    let mut done = 0;
    criterion.bench_function("Drive::tick, CSP moving", |bencher| {
        bencher.iter_custom(|cycles| {
            let taken = per_tick(done, cycles, |number| {
                objects.target_position = sine(number);
                core.synchronize(&objects, Some(board::Nanos(bring_up::CYCLE.as_nanos() as u64)));
                tick(&mut core, &sensors, &mut objects);
            });
            done += cycles;
            let lag = objects.position - sine(done - 1);
            assert!(lag.abs() < MOST_LAG, "the drive does not follow: {lag} pulses behind");
            taken
        });
    });
}

/// Firmware core and plant through some scenarios, everything on. An iteration is a whole run, divided by its ticks.
fn everything_on(criterion: &mut Criterion) {
    for scenario in SCENARIOS.iter().filter(|scenario| TIMED.contains(&scenario.name)) {
        criterion.bench_function(&format!("Drive::tick and Plant::step, {}", scenario.name), |bencher| {
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
    }
}

/// A cycle's ticks.
fn tick(core: &mut Drive, sensors: &Sensors, objects: &mut DriveObjects) {
    for _ in 0..TICKS {
        black_box(core.tick(black_box(sensors), objects));
    }
}

/// The plant alone, its field turning.
fn plant_step(criterion: &mut Criterion) {
    let mut plant = Plant::new(PlantConfig::default());
    let mut done = 0;
    criterion.bench_function("Plant::step, field turning", |bencher| {
        bencher.iter_custom(|cycles| {
            let taken = per_tick(done, cycles, |number| {
                for step in 0..TICKS {
                    black_box(plant.step(black_box(&field(number as u32 * TICKS + step))));
                }
            });
            done += cycles;
            taken
        });
    });
}

/// Voltages of 3 V that turn by 20 electrical periods to and fro, at 5 periods a second.
fn field(tick: u32) -> Actuators {
    let phase = f64::from(tick % (20 << 12)) / f64::from(1 << 12) * TAU;
    let turns_back = tick / (20 << 12) % 2 == 1;
    let sine = if turns_back { -phase.sin() } else { phase.sin() };
    let leg = |voltage: f64| Duty((32_768.0 * (1.0 + voltage / 12.0)) as u16);
    Actuators {
        stage: PowerStage::Legs([leg(phase.cos()), leg(-phase.cos()), leg(sine), leg(-sine)]),
        ..Actuators::default()
    }
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
    core_moving(&mut criterion);
    plant_step(&mut criterion);
    everything_on(&mut criterion);
    criterion.final_summary();
}
