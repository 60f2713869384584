//! Whether the shaft is where the drive believes it to be, which an open-loop drive cannot know.

use board::ELECTRICAL_PERIODS_PER_TURN;
use drive::CurrentVector;
use plant::Turns;

/// Shaft and commanded field against one another.
///
/// A rotor that falls out of step locks in again whole electrical periods away (each is four full steps). Such periods are counted from the
/// moment on at which the shaft is locked after enabling.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Synchronism {
    /// The commanded field while the power stage is on.
    field: Option<Field>,
    /// Periods that were lost before the shaft was locked the last time.
    lost_before: i64,
    lost: i64,
    lag: f64,
}

/// The commanded field, in electrical periods of the axis.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Field {
    angle: u32,
    periods: f64,
}

impl Synchronism {
    /// By how much the shaft lags behind the field, in electrical periods from -0.5 to 0.5; positive when the field is ahead in positive
    /// direction. At a quarter, the motor gives its greatest torque. 0 without current.
    pub const fn lag(&self) -> f64 {
        self.lag
    }

    /// Electrical periods lost since power-on: positive when the shaft is on the negative side of where it should be.
    pub const fn lost_periods(&self) -> i64 {
        self.lost_before + self.lost
    }

    /// By how much the shaft is behind the field since it was locked, in electrical periods: lost ones count on.
    pub const fn behind(&self) -> f64 {
        self.lost as f64 + self.lag
    }

    /// Looks at the end of a tick; `locked` is whether the shaft lock is over.
    pub fn observe(&mut self, vector: Option<CurrentVector>, locked: bool, shaft: Turns) {
        let Some(CurrentVector { angle, .. }) = vector else {
            *self = Self {
                lost_before: self.lost_periods(),
                ..Self::default()
            };
            return;
        };
        let shaft = shaft.0 * f64::from(ELECTRICAL_PERIODS_PER_TURN);
        let periods = match self.field {
            Some(field) if locked => field.periods + turned(field.angle, angle.0),
            // Until it is locked, the shaft goes to whichever period is the nearest.
            _ => shaft + turned(angle_of(shaft), angle.0),
        };
        self.field = Some(Field { angle: angle.0, periods });
        self.lost = (periods - shaft).round() as i64;
        self.lag = periods - shaft - self.lost as f64;
    }
}

/// Electrical periods from one angle to another, the short way round.
fn turned(from: u32, to: u32) -> f64 {
    f64::from(to.wrapping_sub(from) as i32) / PERIOD
}

/// The angle of a place in electrical periods, in 2^-32 periods.
fn angle_of(periods: f64) -> u32 {
    (periods.rem_euclid(1.0) * PERIOD) as u64 as u32
}

const PERIOD: f64 = (1_u64 << 32) as f64;

#[cfg(test)]
mod tests {
    use board::{ElectricalAngle, Milliamps};

    use super::*;

    fn at(periods: f64) -> Option<CurrentVector> {
        Some(CurrentVector {
            angle: ElectricalAngle(angle_of(periods)),
            amplitude: Milliamps(1_000),
        })
    }

    /// A field that turns from one place to another while the shaft stands somewhere, both in electrical periods.
    fn turn(synchronism: &mut Synchronism, from: f64, to: f64, shaft: f64) {
        for step in 1..=100 {
            let field = from + (to - from) * f64::from(step) / 100.0;
            synchronism.observe(at(field), true, Turns(shaft / 50.0));
        }
    }

    #[test]
    fn lag_is_the_distance_to_the_field_and_lost_periods_are_whole() {
        let mut synchronism = Synchronism::default();
        synchronism.observe(at(-7.0), true, Turns(-7.0 / 50.0));
        turn(&mut synchronism, -7.0, -6.8, -7.0);
        assert!((synchronism.lag() - 0.2).abs() < 1e-6);
        assert_eq!(synchronism.lost_periods(), 0);
        turn(&mut synchronism, -6.8, -4.1, -7.0);
        assert_eq!(synchronism.lost_periods(), 3);
        assert!((synchronism.lag() + 0.1).abs() < 1e-6);
        turn(&mut synchronism, -4.1, -8.3, -7.0);
        assert_eq!(synchronism.lost_periods(), -1);
    }

    #[test]
    fn the_way_into_the_lock_is_not_lost_and_what_was_lost_before_stays() {
        let mut synchronism = Synchronism::default();
        synchronism.observe(at(0.0), false, Turns(2.4 / 50.0));
        synchronism.observe(at(0.0), false, Turns(2.1 / 50.0));
        synchronism.observe(at(0.0), true, Turns(2.0 / 50.0));
        assert_eq!((synchronism.lost_periods(), synchronism.lag().abs() < 1e-6), (0, true));
        turn(&mut synchronism, 0.0, 2.0, 2.0);
        assert_eq!(synchronism.lost_periods(), 2);
        synchronism.observe(None, false, Turns(0.7));
        assert_eq!((synchronism.lost_periods(), synchronism.lag()), (2, 0.0));
        synchronism.observe(at(0.0), false, Turns(0.3));
        turn(&mut synchronism, 0.0, -1.0, 15.0);
        assert_eq!(synchronism.lost_periods(), 1);
    }
}
