//! Positions, speeds and accelerations in sub-pulses and ticks.

use board::TICKS_PER_SECOND;

/// Ticks a second, in the width of the arithmetic here.
const TICK_RATE: i64 = TICKS_PER_SECOND as i64;

/// Sub-pulses in one pulse: the square of the tick rate, so that speeds and accelerations are whole numbers.
pub(super) const SUB_PULSES_PER_PULSE: i64 = TICK_RATE * TICK_RATE;

/// Sub-pulses in the whole range of a position object: 2^32 pulses.
const RANGE: i64 = SUB_PULSES_PER_PULSE << 32;

/// A commanded position, in sub-pulses.
///
/// The position objects hold whole pulses in 32 bits; a `Position` has room for five times that range, so that the distance between any
/// two objects' values, and a relative target beyond the range, need no care. What leaves the range comes back by [`Position::wrapped`] or
/// [`Position::pulses`], never by accident.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct Position(i64);

impl Position {
    /// The position of a whole pulse, as 0x607A and 0x6064 hold it.
    pub const fn from_pulses(pulses: i32) -> Self {
        Self(pulses as i64 * SUB_PULSES_PER_PULSE)
    }

    /// The position at a number of sub-pulses, of which a pulse has 400 000 000.
    pub const fn from_sub_pulses(sub_pulses: i64) -> Self {
        Self(sub_pulses)
    }

    /// The position in sub-pulses.
    pub const fn sub_pulses(self) -> i64 {
        self.0
    }

    /// The nearest whole pulse, wrapping at the ends of the 32 bits as 0x6064 does.
    pub const fn pulses(self) -> i32 {
        self.0.wrapping_add(SUB_PULSES_PER_PULSE / 2).div_euclid(SUB_PULSES_PER_PULSE) as i32
    }

    /// Whether this is the position of a whole pulse.
    pub const fn is_whole_pulse(self) -> bool {
        self.0 % SUB_PULSES_PER_PULSE == 0
    }

    /// The position `pulses` further on: a relative target. It may lie outside the 32 bits and does not wrap.
    pub const fn offset_by(self, pulses: i32) -> Self {
        Self(self.0.wrapping_add(pulses as i64 * SUB_PULSES_PER_PULSE))
    }

    /// The position after one tick at `speed`. It does not wrap to the 32 bits.
    pub const fn after_tick(self, speed: Speed) -> Self {
        Self(self.0.wrapping_add(speed.0))
    }

    /// The same position within the range of a 32-bit object, -2^31 to 2^31 pulses (the end excluded).
    pub const fn wrapped(self) -> Self {
        if self.0 >= -(RANGE / 2) && self.0 < RANGE / 2 {
            return self;
        }
        let within = self.0.rem_euclid(RANGE);
        Self(if within < RANGE / 2 { within } else { within - RANGE })
    }

    /// Sub-pulses from `origin` to this position the shorter way round the 32-bit range, within half of it.
    pub const fn sub_pulses_from(self, origin: Self) -> i64 {
        Self(self.wrapped().0 - origin.wrapped().0).wrapped().0
    }
}

/// A signed speed, in sub-pulses a tick; in other words, the distance travelled in one tick.
///
/// Its magnitude is at most [`Speed::MAX`]; what is faster is clamped.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct Speed(i64);

impl Speed {
    /// Standstill.
    pub const ZERO: Self = Self(0);

    /// 2^32 - 1 pulses/s, the largest speed an object can ask for.
    pub const MAX: Self = Self(u32::MAX as i64 * TICK_RATE);

    /// A speed of `rate` pulses/s, as 0x6081, 0x6099 and 0x60FF hold it.
    pub const fn from_pulses_per_second(rate: i64) -> Self {
        Self::from_sub_pulses_per_tick(rate.saturating_mul(TICK_RATE))
    }

    /// The speed that travels `sub_pulses` in one tick.
    pub const fn from_sub_pulses_per_tick(sub_pulses: i64) -> Self {
        if sub_pulses > Self::MAX.0 {
            Self::MAX
        } else if sub_pulses < -Self::MAX.0 {
            Self(-Self::MAX.0)
        } else {
            Self(sub_pulses)
        }
    }

    /// The distance travelled in one tick, in sub-pulses.
    pub const fn sub_pulses_per_tick(self) -> i64 {
        self.0
    }

    /// The speed in pulses/s, rounded to the nearest and clamped to 32 bits.
    pub const fn pulses_per_second(self) -> i32 {
        clamped(rounded_quotient(self.0, TICK_RATE))
    }

    /// The speed in revolutions a minute, the unit of 0x606C (manual 2.3.7), rounded to the nearest and clamped to 32 bits.
    ///
    /// `pulses_per_revolution` is the resolution; 0 is taken for 1.
    pub const fn revolutions_per_minute(self, pulses_per_revolution: u32) -> i32 {
        let pulses_per_revolution = if pulses_per_revolution == 0 {
            1
        } else {
            pulses_per_revolution as i64
        };
        clamped(rounded_quotient(self.0 * 60, TICK_RATE * pulses_per_revolution))
    }
}

/// The quotient rounded to the nearest, halves away from zero, so that both directions read alike.
const fn rounded_quotient(dividend: i64, divisor: i64) -> i64 {
    (dividend + dividend.signum() * (divisor / 2)) / divisor
}

/// The value, clamped to 32 bits.
const fn clamped(value: i64) -> i32 {
    if value > i32::MAX as i64 {
        i32::MAX
    } else if value < i32::MIN as i64 {
        i32::MIN
    } else {
        value as i32
    }
}

/// An acceleration or deceleration, in pulses/s^2, which is also sub-pulses a tick in each tick.
///
/// It is never 0. An object that holds 0 means the gentlest ramp there is, 1 pulse/s^2: the axis obeys, if slowly, and a stop still ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Acceleration(u32);

impl Acceleration {
    /// The acceleration in pulses/s^2, as 0x6083, 0x6084, 0x6085 and 0x609A hold it; 0 is taken for 1.
    pub const fn new(pulses_per_second_squared: u32) -> Self {
        Self(if pulses_per_second_squared == 0 {
            1
        } else {
            pulses_per_second_squared
        })
    }

    /// The change of speed in one tick, in sub-pulses a tick.
    pub const fn per_tick(self) -> i64 {
        self.0 as i64
    }
}

/// How fast a speed may rise and fall.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Ramp {
    /// The most by which the speed's magnitude rises.
    pub acceleration: Acceleration,
    /// The most by which the speed's magnitude falls.
    pub deceleration: Acceleration,
}

impl Ramp {
    /// A ramp from two objects' values in pulses/s^2; 0 is taken for 1.
    pub const fn new(acceleration: u32, deceleration: u32) -> Self {
        Self {
            acceleration: Acceleration::new(acceleration),
            deceleration: Acceleration::new(deceleration),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn whole_pulses_survive_the_conversion_at_both_ends_of_the_range() {
        for pulses in [i32::MIN, -1, 0, 1, i32::MAX] {
            let position = Position::from_pulses(pulses);
            assert!(position.is_whole_pulse());
            assert_eq!(position.pulses(), pulses);
            assert_eq!(position.wrapped(), position);
        }
    }

    #[test]
    fn a_fraction_reads_as_the_nearest_pulse_in_both_directions() {
        let just_under_half = SUB_PULSES_PER_PULSE / 2 - 1;
        assert_eq!(Position::from_sub_pulses(just_under_half).pulses(), 0);
        assert_eq!(Position::from_sub_pulses(just_under_half + 1).pulses(), 1);
        assert_eq!(Position::from_sub_pulses(-just_under_half).pulses(), 0);
        assert_eq!(Position::from_sub_pulses(-just_under_half - 2).pulses(), -1);
    }

    #[test]
    fn beyond_the_range_the_object_wraps_and_the_position_does_not() {
        let beyond = Position::from_pulses(i32::MAX).offset_by(3);
        assert!(beyond > Position::from_pulses(i32::MAX));
        assert_eq!(beyond.pulses(), i32::MIN + 2);
        assert_eq!(beyond.wrapped(), Position::from_pulses(i32::MIN + 2));
        let below = Position::from_pulses(i32::MIN).offset_by(i32::MIN).offset_by(-1);
        assert_eq!(below.wrapped(), Position::from_pulses(-1));
    }

    #[test]
    fn the_distance_goes_the_shorter_way_round() {
        let last = Position::from_pulses(i32::MAX);
        let first = Position::from_pulses(i32::MIN);
        assert_eq!(first.sub_pulses_from(last), SUB_PULSES_PER_PULSE);
        assert_eq!(last.sub_pulses_from(first), -SUB_PULSES_PER_PULSE);
        assert_eq!(
            first.sub_pulses_from(Position::from_pulses(0)),
            i64::from(i32::MIN) * SUB_PULSES_PER_PULSE
        );
    }

    #[test]
    fn speeds_read_back_in_pulses_a_second_and_revolutions_a_minute() {
        for rate in [i32::MIN + 1, -300_000, -1, 0, 1, 10_000, i32::MAX] {
            assert_eq!(Speed::from_pulses_per_second(rate.into()).pulses_per_second(), rate);
        }
        let speed = Speed::from_pulses_per_second(-10_000);
        assert_eq!(speed.revolutions_per_minute(10_000), -60);
        assert_eq!(Speed::from_pulses_per_second(125).revolutions_per_minute(10_000), 1);
        assert_eq!(Speed::MAX.revolutions_per_minute(0), i32::MAX);
    }

    #[test]
    fn a_ramp_of_zero_is_the_gentlest_ramp() {
        assert_eq!(Ramp::new(0, 0), Ramp::new(1, 1));
    }
}
