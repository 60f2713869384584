//! The shaft of the motor, which follows the commanded field with a lag of first order.

use crate::Turns;
use crate::angle::lag;
use board::{ELECTRICAL_PERIODS_PER_TURN, ElectricalAngle, Milliamps, TICK};

/// Time constant with which the shaft follows the field: 100 us, the order of a loaded motor's stiff response far below resonance.
const TIME_CONSTANT_NS: f64 = 100_000.0;

/// The part of the lag that is made up in one tick, `1 - exp(-TICK / TIME_CONSTANT)` to five terms: the same bits on every machine.
const GAIN: f64 = {
    let x = TICK.0 as f64 / TIME_CONSTANT_NS;
    x * (1.0 - x / 2.0 * (1.0 - x / 3.0 * (1.0 - x / 4.0 * (1.0 - x / 5.0))))
};

/// The least current that holds the shaft against its own friction.
const HOLDING_MINIMUM: Milliamps = Milliamps(20);

/// Where a shaft is one tick later that a field pulls.
///
/// The field pulls the short way round, so a shaft that lags by more than half an electrical period falls back by whole periods:
/// steps are lost as on a real motor.
pub(crate) fn follow(shaft: Turns, angle: ElectricalAngle, amplitude: Milliamps) -> Turns {
    if amplitude < HOLDING_MINIMUM {
        return shaft;
    }
    let periods = shaft.0 * f64::from(ELECTRICAL_PERIODS_PER_TURN);
    Turns(shaft.0 + GAIN * lag(angle, periods) / f64::from(ELECTRICAL_PERIODS_PER_TURN))
}

/// The currents in windings A and B of a field, by Bhaskara's approximation of the cosine (error below 0.2 % of the amplitude).
pub(crate) fn phase_currents(angle: ElectricalAngle, amplitude: Milliamps) -> [Milliamps; 2] {
    const QUARTER: u32 = 1 << 30;
    [angle.0, angle.0.wrapping_sub(QUARTER)].map(|phase| Milliamps((f64::from(amplitude.0) * cosine(phase)) as i32))
}

/// The cosine of an angle in 2^-32 periods.
fn cosine(phase: u32) -> f64 {
    const QUARTER: i64 = 1 << 30;
    // Distance from the peak at 0, in periods of 4: 0 to 2.
    let distance = i64::from(phase as i32).abs();
    let (x, sign) = if distance <= QUARTER {
        (distance, 1.0)
    } else {
        (2 * QUARTER - distance, -1.0)
    };
    let square = (x as f64 / QUARTER as f64) * (x as f64 / QUARTER as f64);
    sign * 4.0 * (1.0 - square) / (4.0 + square)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn field(turns: f64) -> ElectricalAngle {
        ElectricalAngle((turns * 50.0 * 4_294_967_296.0) as i64 as u32)
    }

    #[test]
    fn shaft_closes_a_step_of_the_field_with_its_time_constant() {
        let mut shaft = Turns(0.0);
        for _ in 0..2 {
            shaft = follow(shaft, field(0.001), Milliamps(3000));
        }
        let done = shaft.0 / 0.001;
        assert!((done - (1.0 - (-1.0_f64).exp())).abs() < 1e-3, "after one time constant {done}");
        for _ in 0..40 {
            shaft = follow(shaft, field(0.001), Milliamps(3000));
        }
        assert!((shaft.0 - 0.001).abs() < 1e-8);
    }

    #[test]
    fn shaft_follows_over_many_turns_and_loses_nothing() {
        for direction in [1.0, -1.0] {
            let mut shaft = Turns(0.0);
            let mut turns = 0.0;
            while turns < 30.0 {
                turns += 20.0 * 50e-6;
                shaft = follow(shaft, field(direction * turns), Milliamps(3000));
            }
            for _ in 0..60 {
                shaft = follow(shaft, field(direction * turns), Milliamps(3000));
            }
            assert!((shaft.0 - direction * turns).abs() < 1e-6);
        }
    }

    #[test]
    fn a_jump_of_more_than_half_a_period_loses_whole_periods() {
        let mut shaft = Turns(0.0);
        for _ in 0..100 {
            shaft = follow(shaft, field(0.7 / 50.0), Milliamps(3000));
        }
        assert!((shaft.0 * 50.0 - -0.3).abs() < 1e-6, "the shaft went to the nearest period");
    }

    #[test]
    fn without_current_the_shaft_stays() {
        let mut shaft = Turns(1.0);
        shaft = follow(shaft, field(1.001), Milliamps(0));
        assert_eq!(shaft, Turns(1.0));
    }

    #[test]
    fn winding_currents_are_cosine_and_sine_of_the_angle() {
        for step in 0..64_u32 {
            let angle = step << 26;
            let radians = f64::from(step) / 64.0 * core::f64::consts::TAU;
            let [a, b] = phase_currents(ElectricalAngle(angle), Milliamps(6000));
            assert!((f64::from(a.0) - 6000.0 * radians.cos()).abs() < 12.0, "A at {step}/64: {}", a.0);
            assert!((f64::from(b.0) - 6000.0 * radians.sin()).abs() < 12.0, "B at {step}/64: {}", b.0);
        }
    }
}
