//! The command to the power stage: current and direction of the field.

use board::{ELECTRICAL_PERIODS_PER_TURN, ElectricalAngle, Milliamps, TICKS_PER_SECOND};

use crate::current_loop::Phases;
use crate::objects::DriveObjects;
use crate::root::square_root;

/// Ticks in which the current falls to the standby current, 50 ms: slowly, so that the rotor settles without a jerk.
const STANDBY_RAMP: u32 = TICKS_PER_SECOND / 20;

/// Ticks in a millisecond, the unit of 0x2002.
const TICKS_PER_MILLISECOND: u32 = TICKS_PER_SECOND / 1000;

/// A current vector in the windings: `amplitude * cos(angle)` in winding A, `amplitude * sin(angle)` in winding B.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CurrentVector {
    /// The vector's direction, which the rotor follows.
    pub angle: ElectricalAngle,
    /// The peak of the sinusoidal phase current.
    pub amplitude: Milliamps,
}

/// The amplitude of the current: shaft lock, operation, standby (manual 2.2.1, 2.2.3, 2.2.4, 2.2.10).
#[derive(Clone, Debug, Default)]
pub struct Current {
    /// Ticks since the motor was switched on, up to the end of the shaft lock.
    lock_ticks: u32,
    locked: bool,
    /// What the current does not fall below in the shaft lock, as the identification has left it.
    least: u32,
    /// Ticks without motion, up to the end of the standby ramp.
    idle_ticks: u32,
}

impl Current {
    /// Whether the shaft lock of the present enabling is over and the shaft holds its full current.
    pub const fn is_locked(&self) -> bool {
        self.locked
    }

    /// The motor is switched off; the next time it is switched on, its shaft is locked anew.
    pub fn off(&mut self) {
        *self = Self::default();
    }

    /// A tick in which the identification drives the current, up to this amplitude. It counts for the shaft lock, which does not end by it.
    pub fn await_identification(&mut self, amplitude: Milliamps, objects: &DriveObjects) {
        self.lock_ticks = (self.lock_ticks + 1).min((u32::from(objects.soft_lock_time) * 2).saturating_sub(1));
        self.least = amplitude.0.unsigned_abs();
    }

    /// The amplitude for this tick of a motor that is on. Standby ends in the tick in which motion begins.
    pub fn tick(&mut self, moving: bool, objects: &DriveObjects) -> Milliamps {
        let peak = u32::from(objects.peak_current);
        if !self.locked {
            return Milliamps(self.lock(peak, u32::from(objects.soft_lock_time) * 2) as i32);
        }
        let wait = u32::from(objects.idle_time) * TICKS_PER_MILLISECOND;
        self.idle_ticks = if moving {
            0
        } else {
            (self.idle_ticks + 1).min(wait + STANDBY_RAMP)
        };
        let fallen = self.idle_ticks.saturating_sub(wait);
        if fallen == 0 {
            return Milliamps(peak as i32);
        }
        let standby = peak * u32::from(objects.idle_current.min(100)) / 100;
        Milliamps((peak - (peak - standby) * fallen / STANDBY_RAMP) as i32)
    }

    /// The current of the shaft lock, which rises for `duration` ticks.
    fn lock(&mut self, peak: u32, duration: u32) -> u32 {
        self.lock_ticks += 1;
        if self.lock_ticks >= duration {
            self.locked = true;
            return peak;
        }
        let risen = (u64::from(peak) * u64::from(self.lock_ticks) / u64::from(duration)) as u32;
        risen.max(self.least).min(peak)
    }
}

/// The direction of the field. It follows the shaft's travel and nothing else: giving the position counter another value, the resolution
/// or the direction of rotation does not turn it.
#[derive(Clone, Debug)]
pub struct Field {
    /// Travel within the electrical period, in sub-pulses times electrical periods a turn: from 0 up to `period`.
    phase: i64,
    /// The electrical period in the same unit: the sub-pulses of a turn.
    period: i64,
    /// The period, prepared for the division of every tick.
    scale: Scale,
}

impl Field {
    /// A field at angle zero.
    pub const fn new() -> Self {
        let period = period(200);
        Self {
            phase: 0,
            period,
            scale: Scale::of(period),
        }
    }

    /// Takes the sub-pulses travelled in a tick, at `resolution` pulses a turn; `reverse` turns the other way (manual 2.2.13).
    pub fn turn(&mut self, travel: i64, resolution: u16, reverse: bool) {
        let period = period(resolution);
        if period != self.period {
            self.phase = (i128::from(self.phase) * i128::from(period) / i128::from(self.period)) as i64;
            self.period = period;
            self.scale = Scale::of(period);
        }
        let travel = travel * i64::from(ELECTRICAL_PERIODS_PER_TURN);
        let phase = self.phase + if reverse { -travel } else { travel };
        // At speeds that a motor can follow, a tick is less than a period, and no division is needed.
        self.phase = match phase {
            phase if (0..period).contains(&phase) => phase,
            phase if (period..2 * period).contains(&phase) => phase - period,
            phase if (-period..0).contains(&phase) => phase + period,
            phase => phase.rem_euclid(period),
        };
    }

    /// The angle.
    pub const fn angle(&self) -> ElectricalAngle {
        ElectricalAngle(self.scale.quotient(self.phase))
    }
}

/// A period, prepared for dividing by it every tick.
#[derive(Clone, Debug)]
struct Scale {
    /// Bits that a period has beyond 32, and a phase drops: what is below is below the angle's.
    excess: u32,
    /// The period without them, its highest bit set.
    divisor: u32,
    /// 2^64 over the divisor, less 2^32.
    reciprocal: u32,
}

impl Scale {
    const fn of(period: i64) -> Self {
        // The shortest period, of a resolution of 1, has 29 bits.
        let bits = 64 - (period as u64).leading_zeros();
        let excess = bits.saturating_sub(32);
        let divisor = (period as u64 >> excess) as u32;
        let reciprocal = match bits {
            32.. => (u64::MAX / divisor as u64).wrapping_sub(1 << 32) as u32,
            _ => 0,
        };
        Self {
            excess,
            divisor,
            reciprocal,
        }
    }

    /// `phase` in 2^-32 periods, rounded down: what (phase << 32) / divisor is.
    const fn quotient(&self, phase: i64) -> u32 {
        let phase = phase as u64 >> self.excess;
        if self.reciprocal == 0 {
            return ((phase << 32) / self.divisor as u64) as u32;
        }
        // The reciprocal is rounded down, so the estimate is, too: by two at the most.
        let mut quotient = phase + ((phase * self.reciprocal as u64) >> 32);
        let mut rest = (phase << 32) - quotient * self.divisor as u64;
        while rest >= self.divisor as u64 {
            quotient += 1;
            rest -= self.divisor as u64;
        }
        quotient as u32
    }
}

/// Sub-pulses of one turn.
const fn period(resolution: u16) -> i64 {
    let sub_pulses_per_pulse = TICKS_PER_SECOND as i64 * TICKS_PER_SECOND as i64;
    let resolution = if resolution == 0 { 1 } else { resolution as i64 };
    resolution * sub_pulses_per_pulse
}

/// The current vector's amplitude in per mille of the operating current, from the currents out of A+ and B+ in ampere.
pub fn torque(currents: [f32; 2], objects: &DriveObjects) -> i16 {
    let vector = Phases::from_object(objects.motor_type).current(currents);
    let share = square_root(vector.dot(vector)) / f32::from(objects.peak_current.max(1));
    (share * 1e6 + 0.5) as i16
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_angle_is_that_of_the_long_division_at_every_resolution() {
        let mut phase = 0x9E37_79B9_7F4A_7C15u64;
        for resolution in 0..=u16::MAX {
            let period = period(resolution);
            let scale = Scale::of(period);
            let excess = (64 - (period as u64).leading_zeros()).saturating_sub(32);
            phase = phase
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            for phase in [0, 1, period - 1, period / 2, (phase >> 1) as i64 % period] {
                let quotient = ((phase as u64 >> excess) << 32) / (period as u64 >> excess);
                assert_eq!(scale.quotient(phase), quotient as u32, "resolution {resolution}, phase {phase}");
            }
        }
    }
}
