//! How much load a motor carries, and how fast it turns before it falls out of step.

use plant::{Envelope, motors};

use crate::axis::Axis;

/// An axis whose drive knows the motor's back-EMF.
fn tuned(name: &str, supply: f64) -> Axis {
    let motor = crate::motor(name);
    let mut axis = Axis::new(motor, supply);
    axis.objects.bemf_coefficient = (motor.back_emf * 1000.0).round() as u16;
    axis
}

/// The load in Nm at which the shaft falls out of step at a speed, the load rising to the holding torque in some two seconds.
fn pull_out(mut axis: Axis, speed: f64) -> f64 {
    axis.enable();
    axis.run_at(speed, 20.0);
    axis.seconds(0.3);
    assert!(axis.is_in_sync(), "out of step without a load at {speed} turns a second");
    let most = axis.motor.holding_torque(axis.motor.rated_current) * 1.1;
    while axis.is_in_sync() && axis.load < most {
        axis.load += most / 40_000.0;
        axis.tick();
    }
    axis.load
}

/// The speed in turns a second at which a motor with a share of its holding torque as its load falls out of step.
fn stall(mut axis: Axis, share: f64) -> f64 {
    axis.enable();
    axis.load = share * axis.motor.holding_torque(axis.motor.rated_current);
    axis.seconds(0.1);
    axis.ramp_to(60.0, 3.0);
    while axis.is_in_sync() {
        axis.tick();
    }
    f64::from(axis.drive.velocity().pulses_per_second()) / 10_000.0
}

// manual: 1.1.1/motors 2.2.12/type
#[test]
fn pull_out_torque_reaches_the_envelope_of_voltage_and_current() {
    // Motor, supply in V, speed in turns a second, envelope in Nm, and whether this is below the corner, where the current is the limit.
    let cases = [
        ("17hs4401", 24.0, 4.0, 0.385, true),
        ("17hs4401", 24.0, 8.0, 0.380, true),
        ("17hs4401", 24.0, 12.5, 0.290, false),
        ("17hs4401", 24.0, 20.0, 0.163, false),
        ("qsh5718-56", 24.0, 4.0, 1.210, true),
        ("qsh5718-56", 24.0, 8.0, 0.947, false),
        ("qsh5718-56", 24.0, 20.0, 0.244, false),
        ("qsh6018-86-4a2", 48.0, 4.0, 2.997, true),
        ("qsh6018-86-4a2", 48.0, 8.0, 2.627, false),
        ("qsh6018-86-4a2", 48.0, 20.0, 0.774, false),
        ("three-phase-57", 48.0, 4.0, 1.440, true),
        ("three-phase-57", 48.0, 12.5, 0.868, false),
        ("three-phase-57", 48.0, 20.0, 0.441, false),
    ];
    for (name, supply, speed, envelope, below_corner) in cases {
        let share = pull_out(tuned(name, supply), speed) / envelope;
        let bounds = if below_corner { 0.98..1.02 } else { 0.95..1.5 };
        assert!(
            bounds.contains(&share),
            "{name} {supply} V, {speed} turns/s: {share:.3} of the envelope"
        );
    }
}

#[test]
fn at_2_turns_a_second_every_motor_carries_what_its_current_gives() {
    for named in motors::ALL {
        for supply in [24.0, 48.0] {
            let axis = tuned(named.name, supply);
            let current = f64::from(axis.objects.peak_current) / 1000.0;
            let envelope = Envelope::new(&named.parameters, supply, current);
            // A motor of many turns behind a low supply has left its corner behind.
            let bounds = if envelope.corner_speed() > 2.0 { 0.98..1.02 } else { 0.95..1.3 };
            let share = pull_out(axis, 2.0) / envelope.torque_at(2.0);
            assert!(bounds.contains(&share), "{} {supply} V: {share:.3} of the envelope", named.name);
        }
    }
}

#[test]
fn with_the_back_emf_of_delivery_every_motor_still_reaches_its_envelope() {
    let cases = [
        ("17hs4401", 24.0, 20.0, 0.163),
        ("qsh5718-56", 24.0, 12.5, 0.548),
        ("qsh6018-86-4a2", 48.0, 12.5, 1.567),
    ];
    for (name, supply, speed, envelope) in cases {
        let axis = Axis::new(crate::motor(name), supply);
        assert_eq!(axis.objects.bemf_coefficient, 256);
        let share = pull_out(axis, speed) / envelope;
        assert!(share > 0.95, "{name} {supply} V, {speed} turns/s: {share:.3} of the envelope");
    }
}

#[test]
fn stall_speeds_are_those_of_the_envelope_and_without_the_damper_far_below() {
    let cases = [
        ("qsh5718-56", 24.0, 0.3, 16.0),
        ("qsh5718-76", 48.0, 0.3, 21.4),
        ("qsh6018-86-4a2", 48.0, 0.3, 18.0),
        ("17hs4401", 24.0, 0.3, 24.7),
    ];
    for (name, supply, share, predicted) in cases {
        let damped = stall(tuned(name, supply), share) / predicted;
        assert!((0.95..1.12).contains(&damped), "{name} {supply} V: {damped:.3} of the prediction");
        let mut axis = tuned(name, supply);
        axis.objects.bemf_coefficient = 0;
        let plain = stall(axis, share) / predicted;
        assert!(plain < 0.7, "{name} {supply} V: {plain:.3} of the prediction without the damper");
    }
}

// manual: 2.2.13/reverse
#[test]
fn reversals_lose_no_step_and_run_reverse_turns_the_shaft_the_other_way() {
    for (name, supply) in [("17hs4401", 24.0), ("qsh5718-56", 36.0), ("three-phase-57", 48.0)] {
        for reverse in [0, 1] {
            let mut axis = tuned(name, supply);
            axis.objects.run_reverse = reverse;
            axis.objects.filter_time = 6_400;
            axis.enable();
            for speed in [10.0, -10.0, 10.0, -10.0] {
                axis.ramp_to(speed, 80.0);
                for _ in 0..12_000 {
                    axis.tick();
                    assert!(
                        axis.is_in_sync(),
                        "{name}: {:.2} periods behind towards {speed} turns/s",
                        axis.lag()
                    );
                }
                let direction = if reverse == 1 { -speed } else { speed };
                assert!(
                    (axis.state().speed / std::f64::consts::TAU - direction).abs() < 0.5,
                    "{name}: {}",
                    axis.state().speed
                );
            }
        }
    }
}
