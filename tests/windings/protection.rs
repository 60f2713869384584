//! What the currents of real windings tell: lost phases, shorts, and nothing where nothing is wrong.

use drive::Alarm;
use drive::PowerState::{Fault, OperationEnabled};
use plant::{MotorParameters, Phases, motors};

use crate::bench::{Bench, Random};

/// Pulses a turn at delivery.
const TURN: f64 = 10_000.0;
/// Ticks of a millisecond.
const MS: usize = 20;

/// A drive that turns a motor in PV at that many turns a second.
fn turning(motor: MotorParameters, seed: u64, speed: f64) -> Bench {
    let mut bench = Bench::new(motor, seed);
    bench.enable(3);
    bench.lock();
    (bench.objects.profile_acceleration, bench.objects.profile_deceleration) = (200_000, 200_000);
    bench.objects.target_velocity = (speed * TURN) as i32;
    let ticks = (speed * TURN / 200_000.0 * 1000.0) as usize * MS;
    bench.ticks(ticks + 50 * MS);
    bench
}

/// The windings that can be open: those of two phases, or U and V of three.
fn openings(motor: &MotorParameters) -> &'static [usize] {
    match motor.phases {
        Phases::Two => &[0, 1],
        Phases::Three => &[2],
    }
}

// manual: 2.3.1/7122
#[test]
fn a_winding_that_opens_in_motion_is_found_in_10_ms_from_1_turn_a_second_on_and_in_30_at_a_twentieth() {
    let mut seed = 0;
    for named in motors::ALL {
        for (speed, most) in [(0.05, 30 * MS), (0.2, 30 * MS), (1.0, 10 * MS), (3.0, 10 * MS), (10.0, 10 * MS)] {
            for &winding in openings(&named.parameters) {
                for delay in [0, 7, 13] {
                    seed += 1;
                    let mut bench = turning(named.parameters, seed, speed);
                    bench.ticks(delay * if speed < 1.0 { 35 * MS } else { 1 });
                    assert_eq!(bench.objects.error_code, 0, "{} at {speed}", named.name);
                    bench.open = Some(winding);
                    let found = bench.until(|bench| bench.objects.error_code != 0);
                    let context = format!("{} at {speed}, winding {winding}, seed {seed}: {found:?}", named.name);
                    assert_eq!(bench.objects.error_code, 0x7122, "{context}");
                    assert!(found.is_some_and(|ticks| ticks <= most), "{context}");
                }
            }
        }
    }
}

// manual: 1.6/phase-loss 2.3.1/7122
#[test]
fn an_open_winding_is_found_when_the_motor_is_enabled_and_again_after_every_reset() {
    for named in motors::ALL {
        for &winding in openings(&named.parameters) {
            let mut bench = Bench::new(named.parameters, 1);
            bench.open = Some(winding);
            for _ in 0..2 {
                bench.enable(1);
                let found = bench.until(|bench| bench.drive.power_state() == Fault);
                assert!(found.is_some_and(|ticks| ticks < 20 * MS), "{}: {found:?}", named.name);
                assert_eq!((bench.objects.error_code, bench.drive.alarm()), (0x7122, Alarm::Fault { red: 7 }));
                bench.objects.controlword = 0x80;
                bench.tick();
            }
            bench.open = None;
            bench.enable(1);
            bench.lock();
            assert!(bench.drive.winding().is_some());
        }
    }
}

// manual: 2.3.1/2211
#[test]
fn a_shorted_motor_is_an_overcurrent_before_any_loop_is_closed() {
    for named in motors::ALL {
        for supply in [20.0, 48.0] {
            for resistance in [0.02, 0.3] {
                let shorted = MotorParameters {
                    resistance,
                    inductance: 20e-6,
                    ..named.parameters
                };
                let mut bench = Bench::new(shorted, 1);
                bench.supply = supply;
                bench.enable(1);
                let found = bench.until(|bench| bench.drive.power_state() == Fault);
                assert!(found.is_some_and(|ticks| ticks < 20 * MS), "{} {resistance}: {found:?}", named.name);
                assert_eq!((bench.objects.error_code, bench.drive.alarm()), (0x2211, Alarm::Fault { red: 1 }));
            }
        }
    }
}

/// Seconds of varied motion: speeds up to far beyond what the motor can follow, loads up to far beyond what it can hold, standstill,
/// standby, all amplitudes.
fn varied(named: &motors::NamedMotor, seed: u64, seconds: usize) {
    let mut random = Random(seed);
    let mut bench = Bench::new(named.parameters, seed);
    bench.supply = random.between(20.0, 48.0);
    bench.load_inertia = named.parameters.inertia * random.between(0.0, 5.0);
    bench.offsets = [random.between(-0.1, 0.1), random.between(-0.1, 0.1)];
    bench.enable(3);
    bench.lock();
    bench.objects.idle_time = 200;
    let holding = named.parameters.holding_torque(named.parameters.rated_current);
    let rated = (named.parameters.rated_current * 1000.0).min(6000.0);
    let mut elapsed = 0;
    while elapsed < seconds * 1000 {
        let fastest = [0.1, 1.0, 5.0, 15.0, 30.0, 50.0][random.between(0.0, 6.0) as usize];
        let speed = random.between(-fastest, fastest);
        bench.objects.target_velocity = if random.between(0.0, 1.0) < 0.15 {
            0
        } else {
            (speed * TURN) as i32
        };
        let ramp = random.between(1e5, 3e6) as i32;
        (bench.objects.profile_acceleration, bench.objects.profile_deceleration) = (ramp, ramp);
        bench.load = if random.between(0.0, 1.0) < 0.2 {
            1.5
        } else {
            random.between(0.0, 0.7)
        } * holding;
        bench.objects.peak_current = (rated * random.between(0.3, 1.0)).max(100.0) as u16;
        let span = random.between(20.0, 600.0) as usize;
        elapsed += span;
        bench.ticks(span * MS);
        assert_eq!(
            (bench.drive.power_state(), bench.objects.error_code),
            (OperationEnabled, 0),
            "{} seed {seed} after {elapsed} ms: {speed} rps, {:?}, {} V, peak {} mA",
            named.name,
            bench.state,
            bench.supply,
            bench.objects.peak_current
        );
    }
}

#[test]
fn minutes_of_varied_motion_with_saturation_and_stall_are_no_fault() {
    for (number, named) in motors::ALL.iter().enumerate() {
        for part in 0..8 {
            varied(named, (number * 8 + part) as u64, 10);
        }
    }
}
