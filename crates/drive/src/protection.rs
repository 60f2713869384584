//! What the measured currents tell of faults: over-current and phase loss (manual 1.6, 2.3.1).

use board::{ElectricalAngle, Millivolts, TICKS_PER_SECOND};

use crate::current_loop::{Direction, Phases, ampere};
use crate::faults::Fault;
use crate::objects::DriveObjects;
use crate::power_stage::CurrentVector;

/// Bit 7 of 0x2056: phase loss is a fault (manual, revision V202).
pub const PHASE_LOSS: u16 = 1 << 7;

/// A current beyond this, in ampere, is a fault. A motor that has lost its step at high speed reaches more than twice its rated current
/// by itself, up to 11.6 A of the motors in this class; the power stage's comparator, which is faster, trips there as well.
pub const OVERCURRENT: f32 = 12.0;
/// Samples beyond it that make a fault, of as many in a row: the current of a loop that a short makes oscillate is beyond in every other one.
const OVERCURRENT_SAMPLES: (u32, u8) = (2, 4);

/// A phase carries nothing that carries less than this share of the commanded amplitude and these ampere, two to three steps of a
/// converter of 12 bits over 12.8 A either way.
const NOTHING: (f32, f32) = (0.03, 0.015);
/// A phase is to carry something that is to carry this many times as much.
const SOMETHING: f32 = 2.0;
/// The commanded current of a phase that carries nothing, added up, that is a lost phase: the operating current for 2.5 ms, in ticks. At a
/// twentieth of a turn a second that takes 27 ms where the phase is lost just before its current passes zero. While the current rises from
/// nothing, as in the shaft lock, the back-EMF of a shaft that a load turns may hold a whole winding at nothing for as long.
const MISSING: f32 = 2.5e-3 * TICKS_PER_SECOND as f32;
/// An operating current below this, in ampere, counts as this: the back-EMF of a shaft that has lost its step moves the currents by as much.
const SMALL: f32 = 1.0;
/// The current that the supply can drive through the winding at the present speed has to be this many times what counts as nothing.
const REACH: f32 = 4.0;

/// What a tick shows.
#[derive(Clone, Copy, Debug)]
pub struct View {
    /// Currents out of the legs A+ and B+ in ampere, offsets taken off.
    pub currents: [f32; 2],
    /// How the motor hangs on the legs.
    pub phases: Phases,
    /// The vector that these currents follow; none while something else than the current loop drives.
    pub due: Option<CurrentVector>,
    /// The operating current in ampere (0x2000).
    pub operating: f32,
    /// The supply in volt.
    pub supply: f32,
    /// Inductance of a winding in henry, roughly.
    pub inductance: f32,
    /// Share of the amplitude that the harmonic against resonance (0x2060) may take from a phase or add to it.
    pub harmonic: f32,
    /// Whether a lost phase is a fault: bit 7 of 0x2056.
    pub phase_loss: bool,
}

impl View {
    /// What currents in ampere and the supply show that follow `due`.
    pub fn new(currents: [f32; 2], supply: Millivolts, due: Option<CurrentVector>, objects: &DriveObjects) -> Self {
        Self {
            currents,
            phases: Phases::from_object(objects.motor_type),
            due,
            operating: f32::from(objects.peak_current) * 1e-3,
            supply: supply.0 as f32 * 1e-3,
            // The gain is the inductance in microhenry.
            inductance: f32::from(objects.current_loop_kp) * 1e-6,
            harmonic: f32::from(objects.harmonic_amplitude) * 1e-3,
            phase_loss: objects.error_detection & PHASE_LOSS != 0,
        }
    }
}

/// Looks after the currents while the power stage is on.
#[derive(Clone, Debug, Default)]
pub struct Protection {
    /// Which of the last samples were beyond [`OVERCURRENT`], a bit each.
    beyond: u8,
    /// For each phase, the commanded current since it last carried one, in ticks of the operating current.
    missing: [f32; 3],
    angle: Option<ElectricalAngle>,
}

impl Protection {
    /// The power stage is off.
    pub fn off(&mut self) {
        *self = Self::default();
    }

    /// Looks at a tick. The fault is told once; by the next tick the power stage is off.
    #[inline]
    pub fn tick(&mut self, view: &View) -> Option<Fault> {
        let [first, second] = view.currents;
        let third = match view.phases {
            Phases::Two => 0.0,
            Phases::Three => -first - second,
        };
        let currents = [first, second, third];
        let (most, of) = OVERCURRENT_SAMPLES;
        let beyond = currents.iter().any(|current| current.abs() > OVERCURRENT);
        self.beyond = (self.beyond << 1 | u8::from(beyond)) & ((1 << of) - 1);
        if self.beyond.count_ones() >= most {
            self.off();
            return Some(Fault::Overcurrent);
        }
        match view.due {
            Some(due) if view.phase_loss => self.watch_phases(currents, due, view),
            _ => {
                (self.missing, self.angle) = ([0.0; 3], None);
                None
            }
        }
    }

    /// Adds up what each phase was to carry while it carries nothing. A phase whose turn it is not yet neither counts nor is cleared.
    ///
    /// At a speed at which even a whole winding hardly carries anything, nothing can be told, and nothing is.
    fn watch_phases(&mut self, currents: [f32; 3], due: CurrentVector, view: &View) -> Option<Fault> {
        let amplitude = ampere(due.amplitude);
        let nothing = NOTHING.0 * amplitude + NOTHING.1;
        let advance = due.angle.0.wrapping_sub(self.angle.replace(due.angle).unwrap_or(due.angle).0) as i32;
        let speed = advance.unsigned_abs() as f32 * (core::f32::consts::TAU / 4_294_967_296.0 * TICKS_PER_SECOND as f32);
        let idle = currents.map(|current| current.abs() < nothing);
        if !idle[0] && !idle[1] && (!idle[2] || view.phases == Phases::Two) {
            self.missing = [0.0; 3];
            return None;
        }
        let in_reach = view.supply > REACH * nothing * speed * view.inductance;
        let wanted = shares(view.phases, Direction::of(due.angle.0)).map(|share| (share.abs() - view.harmonic) * amplitude);
        for ((missing, idle), wanted) in self.missing.iter_mut().zip(idle).zip(wanted) {
            if !idle {
                *missing = 0.0;
            } else if wanted > SOMETHING * nothing && in_reach {
                *missing += wanted / view.operating.max(SMALL);
            }
        }
        let lost = self.missing.iter().any(|missing| *missing > MISSING);
        if lost {
            self.off();
        }
        lost.then_some(Fault::PhaseLoss)
    }
}

/// The share of the amplitude that each measured phase carries, in the order of [`View::currents`]; the third is V of three phases.
fn shares(phases: Phases, direction: Direction) -> [f32; 3] {
    let half = -0.5 * direction.cosine;
    let across = 0.866_025_4 * direction.sine;
    match phases {
        Phases::Two => [direction.cosine, direction.sine, 0.0],
        Phases::Three => [direction.cosine, half - across, half + across],
    }
}

#[cfg(test)]
mod tests {
    use board::Milliamps;

    use super::*;

    /// A view at an angle in degrees with both currents as they should be, but for the phases in `open`.
    fn view(degrees: f32, phases: Phases, open: [bool; 2]) -> View {
        let angle = ElectricalAngle((degrees / 360.0 * 4_294_967_296.0) as i64 as u32);
        let [first, second, _] = shares(phases, Direction::of(angle.0));
        View {
            currents: [if open[0] { 0.0 } else { 3.0 * first }, if open[1] { 0.0 } else { 3.0 * second }],
            phases,
            due: Some(CurrentVector {
                angle,
                amplitude: Milliamps(3_000),
            }),
            operating: 3.0,
            supply: 24.0,
            inductance: 2.5e-3,
            harmonic: 0.0,
            phase_loss: true,
        }
    }

    #[test]
    fn two_of_four_samples_beyond_12_a_are_an_overcurrent_in_any_phase_and_one_is_not() {
        let surge = |currents, phases| View {
            currents,
            due: None,
            ..view(0.0, phases, [false; 2])
        };
        for (currents, phases) in [([12.1, 0.0], Phases::Two), ([0.0, -12.1], Phases::Two), ([6.1, 6.1], Phases::Three)] {
            let surge = surge(currents, phases);
            for between in 0..5 {
                let mut protection = Protection::default();
                assert_eq!(protection.tick(&surge), None);
                for _ in 0..between {
                    assert_eq!(protection.tick(&view(0.0, phases, [false; 2])), None);
                }
                let expected = (between < 3).then_some(Fault::Overcurrent);
                assert_eq!(protection.tick(&surge), expected, "{between} samples between");
            }
        }
        let mut protection = Protection::default();
        for _ in 0..10 {
            assert_eq!(protection.tick(&surge([11.9, -11.9], Phases::Two)), None);
        }
    }

    #[test]
    fn a_phase_is_lost_after_2_and_a_half_ms_of_the_operating_current_unless_the_mask_says_no() {
        for (degrees, open) in [(0.0, [true, false]), (90.0, [false, true])] {
            let mut protection = Protection::default();
            let lost = (1..100).find(|_| protection.tick(&view(degrees, Phases::Two, open)) == Some(Fault::PhaseLoss));
            assert!(matches!(lost, Some(50 | 51)), "{lost:?}");
            for _ in 0..1_000 {
                let masked = View {
                    phase_loss: false,
                    ..view(degrees, Phases::Two, open)
                };
                assert_eq!(protection.tick(&masked), None);
            }
        }
    }

    #[test]
    fn a_phase_without_current_while_the_shaft_lock_begins_is_not_lost_so_soon_as_in_operation() {
        let mut protection = Protection::default();
        for tick in 0..100 {
            // A back-EMF holds the current at nothing while a ramp of 50 ms begins.
            let rising = View {
                due: Some(CurrentVector {
                    angle: ElectricalAngle(1 << 30),
                    amplitude: Milliamps(3 * tick),
                }),
                ..view(90.0, Phases::Two, [false, true])
            };
            assert_eq!(protection.tick(&rising), None, "{tick}");
        }
    }

    #[test]
    fn at_a_small_operating_current_a_phase_is_lost_as_much_later() {
        let mut protection = Protection::default();
        let small = View {
            due: Some(CurrentVector {
                angle: ElectricalAngle(0),
                amplitude: Milliamps(250),
            }),
            operating: 0.25,
            ..view(0.0, Phases::Two, [true, false])
        };
        let lost = (1..1_000).find(|_| protection.tick(&small).is_some());
        assert!(matches!(lost, Some(200..=202)), "{lost:?}");
    }

    #[test]
    fn a_phase_that_is_to_carry_next_to_nothing_is_not_lost_however_long_it_stands() {
        let mut protection = Protection::default();
        for _ in 0..100_000 {
            assert_eq!(protection.tick(&view(3.0, Phases::Two, [false, true])), None);
        }
    }

    #[test]
    fn the_third_of_three_phases_is_watched_too() {
        let mut protection = Protection::default();
        // V open: what flows out of U comes back through W.
        let open = View {
            currents: [2.0, -2.0],
            ..view(0.0, Phases::Three, [false; 2])
        };
        let ticks = (1..).find(|_| protection.tick(&open).is_some());
        assert!(matches!(ticks, Some(100 | 101)), "{ticks:?}");
    }

    #[test]
    fn a_phase_that_the_harmonic_may_take_to_zero_is_not_lost() {
        let mut protection = Protection::default();
        for _ in 0..100_000 {
            let harmonic = View {
                harmonic: 0.5,
                ..view(29.0, Phases::Two, [false, true])
            };
            assert_eq!(protection.tick(&harmonic), None);
        }
    }
}
