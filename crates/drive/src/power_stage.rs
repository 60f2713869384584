//! The command to the power stage: current and direction of the field.

use board::{ELECTRICAL_PERIODS_PER_TURN, ElectricalAngle, Milliamps, TICKS_PER_SECOND};

use crate::objects::DriveObjects;

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
}

impl Field {
    /// A field at angle zero.
    pub const fn new() -> Self {
        Self {
            phase: 0,
            period: period(200),
        }
    }

    /// Takes the sub-pulses travelled in a tick, at `resolution` pulses a turn; `reverse` turns the other way (manual 2.2.13).
    pub fn turn(&mut self, travel: i64, resolution: u16, reverse: bool) {
        let period = period(resolution);
        if period != self.period {
            self.phase = (i128::from(self.phase) * i128::from(period) / i128::from(self.period)) as i64;
            self.period = period;
        }
        let travel = travel * i64::from(ELECTRICAL_PERIODS_PER_TURN);
        let phase = self.phase + if reverse { -travel } else { travel };
        self.phase = if (0..period).contains(&phase) {
            phase
        } else {
            phase.rem_euclid(period)
        };
    }

    /// The angle.
    pub const fn angle(&self) -> ElectricalAngle {
        // The period has at most 45 bits; without the ones that are always zero, 35. What is still beyond 32 bits is below the angle's.
        let excess = (64 - (self.period as u64).leading_zeros()).saturating_sub(32);
        let (phase, period) = (self.phase as u64 >> excess, self.period as u64 >> excess);
        ElectricalAngle(((phase << 32) / period) as u32)
    }
}

/// Sub-pulses of one turn.
const fn period(resolution: u16) -> i64 {
    let sub_pulses_per_pulse = TICKS_PER_SECOND as i64 * TICKS_PER_SECOND as i64;
    let resolution = if resolution == 0 { 1 } else { resolution as i64 };
    resolution * sub_pulses_per_pulse
}
