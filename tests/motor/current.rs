//! The currents themselves.

use plant::{MotorParameters, motors};

use crate::axis::Axis;

/// A tick in milliseconds.
const TICK: f64 = 0.05;

/// What a step of the current looks like.
#[derive(Debug)]
struct Step {
    /// From a tenth to nine tenths, in milliseconds.
    rise: f64,
    /// Beyond the final value, as a share of it.
    overshoot: f64,
    /// From the first current to the last that is more than 2 % off, in milliseconds.
    settling: f64,
}

/// Switches a current on at once, with the rotor held.
fn step(axis: &mut Axis, milliampere: u16) -> Step {
    axis.blocked = true;
    axis.objects.soft_lock_time = 0;
    axis.objects.peak_current = milliampere;
    for controlword in [0, 0x06, 0x06, 0x0F] {
        axis.objects.controlword = controlword;
        axis.tick();
    }
    let share: Vec<f64> = (0..1_000)
        .map(|_| {
            axis.tick();
            axis.current() * 1000.0 / f64::from(milliampere)
        })
        .collect();
    let crossing = |level: f64| {
        let after = share.iter().position(|&at| at >= level).expect("the current comes");
        let before = if after == 0 { 0.0 } else { share[after - 1] };
        (after as f64 + (level - before) / (share[after] - before)) * TICK
    };
    let start = share.iter().position(|&at| at > 0.0).expect("a current flows");
    let unsettled = share.iter().rposition(|at| (at - 1.0).abs() > 0.02).unwrap_or(start);
    Step {
        rise: crossing(0.9) - crossing(0.1),
        overshoot: share.iter().fold(0.0, |most: f64, &at| most.max(at)) - 1.0,
        settling: (unsettled + 1 - start) as f64 * TICK,
    }
}

fn assert_shape(step: &Step, what: &str) {
    assert!((0.35..=0.45).contains(&step.rise), "{what}: {step:?}");
    assert!(step.overshoot < 0.01, "{what}: {step:?}");
    assert!(step.settling < 1.0, "{what}: {step:?}");
}

// manual: 2.2.11/loop
#[test]
fn with_the_gains_of_delivery_a_current_in_1_ohm_and_1_millihenry_rises_in_0_4_ms() {
    let motor = MotorParameters {
        resistance: 1.0,
        inductance: 1e-3,
        ..motors::QSH5718_56
    };
    for supply in [24.0, 36.0, 48.0] {
        let mut axis = Axis::new(motor, supply);
        assert_eq!((axis.objects.current_loop_kp, axis.objects.current_loop_ki), (1_000, 200));
        assert_shape(&step(&mut axis, 3_000), &format!("{supply} V"));
    }
}

#[test]
fn gains_of_a_motors_resistance_and_inductance_make_the_same_step_of_every_motor() {
    for named in motors::ALL {
        assert_shape(&step(&mut Axis::new(named.parameters, 48.0), 1_000), named.name);
    }
}

// manual: 2.2.11/loop
#[test]
fn without_the_anti_windup_gain_a_step_at_the_voltages_limit_overshoots() {
    let overshoot = [0, 256].map(|gain| {
        let mut axis = Axis::new(motors::AS1010, 24.0);
        axis.objects.current_loop_kc = gain;
        step(&mut axis, 4_000).overshoot
    });
    assert!(overshoot[0] > 0.05 && overshoot[1] < 0.01, "{overshoot:?}");
}

#[test]
fn gains_at_the_ends_of_their_ranges_leave_duties_and_currents_finite() {
    for (kp, ki, kc) in [(100, 10_000, 1_024), (65_535, 10_000, 0), (65_535, 0, 1_024), (100, 0, 0)] {
        for named in motors::ALL {
            let mut axis = Axis::new(named.parameters, 48.0);
            (
                axis.objects.current_loop_kp,
                axis.objects.current_loop_ki,
                axis.objects.current_loop_kc,
            ) = (kp, ki, kc);
            axis.try_to_enable();
            axis.ramp_to(5.0, 50.0);
            axis.seconds(0.2);
            // A loop with such gains may swing, or make next to no current, until the protection ends it.
            assert!([0, 0x2211, 0x7122].contains(&axis.objects.error_code), "{}", named.name);
            let (current, voltage) = (axis.drive.current_loop().current(), axis.drive.current_loop().voltage());
            assert!(
                current.dot(current).is_finite() && voltage.dot(voltage).is_finite(),
                "{}",
                named.name
            );
        }
    }
}

#[test]
fn at_the_end_of_a_tick_the_windings_have_the_current_that_it_has_commanded_at_any_speed() {
    for (name, speed) in [
        ("qsh5718-56", 0.5),
        ("qsh5718-56", -3.0),
        ("17hs4401", 6.0),
        ("three-phase-57", 2.5),
    ] {
        let mut axis = Axis::new(crate::motor(name), 48.0);
        axis.enable();
        axis.run_at(speed, 20.0);
        axis.seconds(1.0);
        for _ in 0..100 {
            axis.tick();
            let vector = axis.drive.current_vector().expect("the power stage is on");
            let radians = f64::from(vector.angle.0) / 2f64.powi(32) * std::f64::consts::TAU + f64::from(axis.drive.current_loop().trim());
            let amplitude = f64::from(vector.amplitude.0) / 1000.0;
            let [a, b] = axis.state.currents;
            let off = (a - amplitude * radians.cos()).hypot(b - amplitude * radians.sin());
            assert!(off < 0.03 * amplitude, "{name} at {speed}: {off} of {amplitude} A");
        }
    }
}
