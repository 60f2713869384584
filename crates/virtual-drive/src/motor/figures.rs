//! What follows from a motor's values.

use board::ELECTRICAL_PERIODS_PER_TURN;
use plant::MotorParameters;

/// How fast the rotor swings about the field, in Hz, with a current's amplitude in A and the load's inertia in kg m^2.
pub fn natural_frequency(motor: &MotorParameters, current: f64, load_inertia: f64) -> f64 {
    let stiffness = f64::from(ELECTRICAL_PERIODS_PER_TURN) * motor.holding_torque(current);
    (stiffness / (motor.inertia + load_inertia)).sqrt() / std::f64::consts::TAU
}

/// How fast the current follows a voltage, in s.
pub fn electrical_time_constant(motor: &MotorParameters) -> f64 {
    motor.inductance / motor.resistance
}

/// The speed in turns a second at which an evenly turning field excites the natural frequency with its full steps, four in a period: the
/// resonance that is felt first.
pub fn resonant_speed(natural_frequency: f64) -> f64 {
    natural_frequency / (4.0 * f64::from(ELECTRICAL_PERIODS_PER_TURN))
}

#[cfg(test)]
mod tests {
    use super::*;
    use plant::motors::ALL;

    #[test]
    fn natural_frequencies_are_those_of_the_reference() {
        let expected = [306.0, 293.0, 206.0, 231.0, 223.0, 216.0, 216.0, 199.0];
        for (named, expected) in ALL.iter().zip(expected) {
            let found = natural_frequency(&named.parameters, named.parameters.rated_current, 0.0);
            assert!((found - expected).abs() < 1.0, "{}: {found} Hz, not {expected}", named.name);
        }
    }

    #[test]
    fn first_resonances_are_those_of_the_reference() {
        let found = [(206.0, 1.027), (306.2, 1.531), (232.0, 1.160)].map(|(frequency, speed)| resonant_speed(frequency) - speed);
        assert!(found.iter().all(|difference| difference.abs() < 0.005), "{found:?}");
    }
}
