//! The pull-out envelope against figures of an independent search over the current plane, and against what must hold of any motor.

use plant::motors::{self, ALL};
use plant::{Envelope, MotorParameters, Phases};

fn at_rated(motor: &MotorParameters, supply: f64) -> Envelope {
    Envelope::new(motor, supply, motor.rated_current)
}

/// Speeds in turns a second at 24, 36 and 48 V at which the reference's numeric search first misses torque: about one part in a thousand, so
/// these are slightly above the corner.
const CORNERS: [(&str, [f64; 3]); 7] = [
    ("17hs4401", [9.0, 14.0, 18.9]),
    ("as1010", [4.5, 7.0, 9.6]),
    ("qsh5718-56", [5.7, 8.9, 12.0]),
    ("as1050", [10.9, 16.7, 22.5]),
    ("qsh5718-76", [3.8, 6.0, 8.1]),
    ("qsh6018-86-4a2", [3.1, 4.8, 6.5]),
    ("three-phase-57", [3.6, 5.7, 7.9]),
];

fn lossless(motor: &MotorParameters) -> MotorParameters {
    MotorParameters {
        friction: 0.0,
        drag: 0.0,
        ..*motor
    }
}

fn motor(name: &str) -> MotorParameters {
    ALL.iter().find(|motor| motor.name == name).unwrap().parameters
}

#[test]
fn corner_speeds_are_those_of_the_reference() {
    for (name, speeds) in CORNERS {
        for (supply, expected) in [24.0, 36.0, 48.0].into_iter().zip(speeds) {
            let lossless = lossless(&motor(name));
            let envelope = at_rated(&lossless, supply);
            let ratio = expected / envelope.corner_speed();
            assert!(
                (1.0..1.03).contains(&ratio),
                "{name} at {supply} V: {} rps, not {expected}",
                envelope.corner_speed()
            );
            let left = envelope.torque_at(expected) / lossless.holding_torque(lossless.rated_current);
            assert!(
                (0.9975..0.99995).contains(&left),
                "{name} at {supply} V: {left} of the torque at {expected} rps"
            );
        }
    }
}

#[test]
fn torques_are_those_of_the_reference() {
    const TORQUES: [(&str, f64, [f64; 4]); 4] = [
        ("17hs4401", 24.0, [0.385, 0.380, 0.290, 0.163]),
        ("qsh5718-56", 24.0, [1.210, 0.947, 0.548, 0.244]),
        ("qsh6018-86-4a2", 48.0, [2.997, 2.627, 1.567, 0.774]),
        ("three-phase-57", 48.0, [1.440, 1.403, 0.868, 0.441]),
    ];
    for (name, supply, torques) in TORQUES {
        for (speed, expected) in [4.0, 8.0, 12.5, 20.0].into_iter().zip(torques) {
            // Three digits, of parameters of three digits.
            let found = at_rated(&motor(name), supply).torque_at(speed);
            assert!(
                (found - expected).abs() <= 0.0005 + 0.003 * expected,
                "{name} at {speed} rps: {found} Nm, not {expected}"
            );
        }
    }
}

/// A search of the current plane that knows nothing of circles: the largest q of a fine grid that keeps both limits.
fn by_search(motor: &MotorParameters, supply: f64, speed: f64) -> Option<f64> {
    const GRID: i32 = 1000;
    let voltage = 0.95 * supply / if motor.phases == Phases::Three { 3.0_f64.sqrt() } else { 1.0 };
    let mechanical = speed * std::f64::consts::TAU;
    let (reactance, emf) = (50.0 * mechanical * motor.inductance, mechanical * motor.back_emf);
    let ampere = |step: i32| motor.rated_current * f64::from(step) / f64::from(GRID);
    let keeps = |d: f64, q: f64| {
        let over = (motor.resistance * d - reactance * q).hypot(motor.resistance * q + reactance * d + emf);
        d.hypot(q) <= motor.rated_current && over <= voltage
    };
    let feasible = |q: &i32| (-GRID..=GRID).any(|d| keeps(ampere(d), ampere(*q)));
    (-GRID..=GRID).rev().find(feasible).map(ampere)
}

#[test]
fn circles_meet_where_a_search_finds_the_most_current() {
    for named in &ALL {
        let motor = named.parameters;
        for (supply, speed) in [(24.0, 3.0), (24.0, 11.0), (24.0, 30.0), (48.0, 6.5), (48.0, 25.0)] {
            let Some(current) = by_search(&motor, supply, speed) else {
                continue;
            };
            let losses = motor.friction + motor.drag * speed * std::f64::consts::TAU;
            let expected = motor.torque_constant() * current - losses;
            let found = at_rated(&motor, supply).torque_at(speed);
            let cell = motor.holding_torque(motor.rated_current) * 0.004;
            assert!(
                (found - expected).abs() < cell,
                "{} at {supply} V, {speed} rps: {found} Nm, not {expected}",
                named.name
            );
        }
    }
}

#[test]
fn torque_is_whole_up_to_the_corner_and_falls_from_there() {
    for named in &ALL {
        let motor = named.parameters;
        let lossless = lossless(&motor);
        let envelope = at_rated(&lossless, 36.0);
        let holding = motor.holding_torque(motor.rated_current);
        let corner = envelope.corner_speed();
        assert!((envelope.torque_at(corner * 0.999) - holding).abs() < 1e-9, "{}", named.name);
        let mut last = envelope.torque_at(corner * 1.001);
        assert!(last < holding, "{}", named.name);
        for percent in 102..1000 {
            let torque = envelope.torque_at(corner * f64::from(percent) / 100.0);
            assert!(torque <= last, "{} at {percent} % of the corner", named.name);
            last = torque;
        }
    }
}

#[test]
fn nothing_is_left_for_a_load_at_the_no_load_speed() {
    for named in &ALL {
        for supply in [24.0, 36.0, 48.0] {
            let envelope = at_rated(&named.parameters, supply);
            let fastest = envelope.no_load_speed();
            assert!(
                envelope.corner_speed() < fastest && fastest < 1000.0,
                "{}: {fastest} rps",
                named.name
            );
            assert!(
                envelope.torque_at(fastest * 0.9999) > 0.0 && envelope.torque_at(fastest * 1.0001) < 0.0,
                "{}",
                named.name
            );
        }
    }
}

#[test]
fn directions_are_alike() {
    let envelope = at_rated(&motors::QSH5718_56, 24.0);
    assert_eq!(envelope.torque_at(9.0), envelope.torque_at(-9.0));
}

#[test]
fn a_supply_too_weak_for_the_current_limits_torque_from_rest_on() {
    // 0.95 * 10 V drive 2.32 A through 4.1 ohm.
    let envelope = Envelope::new(&motors::AS1010, 10.0, 3.0);
    assert_eq!(envelope.corner_speed(), 0.0);
    let expected = 0.2687 * 9.5 / 4.1 - 8.0e-3;
    assert!((envelope.torque_at(0.0) - expected).abs() < 1e-12);
}

#[test]
fn a_motor_without_losses_ends_the_search_at_its_end() {
    let free = MotorParameters {
        resistance: 1e-9,
        ..lossless(&motors::QSH5718_56)
    };
    assert_eq!(at_rated(&free, 48.0).no_load_speed(), 1000.0);
}
