//! Duties, voltages and currents of the windings.

use board::{Duty, PowerStage};
use plant::{Faults, Phases};

use super::{TICK, Verdict, View, must};

/// A full PWM period in a duty's unit.
const PERIOD: i32 = 1 << 16;
/// The share of the supply that a winding may get, with what rounding of two duties adds.
const USABLE: i32 = PERIOD * 95 / 100 + 2;
/// What trips over-current, in ampere, with a step of the converter.
const OVERCURRENT: f64 = 12.0 + 0.0063;
/// Ticks in which a current goes on rising after that: it begins within one, up to four samples tell it, and then the bridge is off.
const REACTION: f64 = 5.0;
/// Current in ampere that is none.
const NONE: f64 = 1e-9;
/// Forward voltages in the way of a current when all transistors are off, in V: two diodes of at least this.
const DIODES: f64 = 2.0 * 0.8;

/// What is known of the currents.
#[derive(Clone, Debug, Default)]
pub struct Windings {
    /// The most current that there may be now, in ampere, with the power stage off since it was this large.
    decaying: Option<f64>,
    /// Whether the present currents come from whole windings that the drive controls.
    whole: bool,
}

impl Windings {
    /// Looks at a tick.
    ///
    /// # Errors
    /// What does not hold.
    pub fn tick(&mut self, view: &View) -> Verdict {
        let plant = view.plant();
        let broken = is_broken(&plant.faults());
        let motor = &plant.config().motor;
        let [a, b] = plant.motor().currents;
        let amplitude = a.hypot(b);
        let emf = motor.back_emf * plant.motor().speed.abs();
        must(amplitude.is_finite() && emf.is_finite(), || {
            format!("currents {a} {b}, back-EMF {emf}")
        })?;
        // The currents of a short may be anything, and last until the windings are whole and the currents gone.
        self.whole = !broken && (self.whole || amplitude <= NONE);
        if let PowerStage::Legs(duties) = view.actuators.stage {
            self.decaying = None;
            check_duties(duties, view.objects.motor_type)?;
            let rise = REACTION * TICK * (plant.bus_voltage() + emf) / motor.inductance;
            return must(!self.whole || amplitude.abs() <= most(motor.phases) * (OVERCURRENT + rise), || {
                format!("{amplitude:.2} A in whole windings")
            });
        }
        if !self.whole {
            self.decaying = None;
            return Ok(());
        }
        self.check_decay(amplitude, emf, view)
    }

    /// With the power stage off the bus takes the current out of the windings: the energy that they have falls by what flows into the
    /// bus, and rises by what a turning rotor induces.
    fn check_decay(&mut self, amplitude: f64, emf: f64, view: &View) -> Verdict {
        let plant = view.plant();
        let motor = &plant.config().motor;
        // In a star at least this share of the bus is against the vector, as the current has to come through two windings.
        let (share, span) = match motor.phases {
            Phases::Two => (1.0, 1.0),
            Phases::Three => (0.577, 1.732),
        };
        let against = plant.bus_voltage() + DIODES;
        // In the tick in which it is switched off, the currents may still have risen by what was before.
        let rest = self
            .decaying
            .map_or(amplitude, |most| most + (emf - share * against) * TICK / motor.inductance);
        if span * emf > plant.bus_voltage() {
            self.decaying = Some(rest.max(amplitude));
            return Ok(());
        }
        self.decaying = Some(rest.max(0.0));
        let slack = share * against * TICK / motor.inductance;
        must(amplitude <= NONE || amplitude <= rest + slack, || {
            format!("{amplitude:.3} A with the power stage off, where {rest:.3} A may be left")
        })
    }
}

/// Whether windings are broken.
pub const fn is_broken(faults: &Faults) -> bool {
    faults.open[0] || faults.open[1] || faults.shorted[0] || faults.shorted[1]
}

/// The amplitude of the vector when a phase has a current of 1.
const fn most(phases: Phases) -> f64 {
    match phases {
        // Both windings may have it.
        Phases::Two => 1.4143,
        // The third is less than both.
        Phases::Three => 1.1548,
    }
}

fn check_duties(duties: [Duty; 4], motor_type: u16) -> Verdict {
    let [u, v, w, x] = duties.map(|duty| i32::from(duty.0));
    let spans = match motor_type {
        1 => [u.max(v).max(w) - u.min(v).min(w), 0],
        _ => [(u - v).abs(), (w - x).abs()],
    };
    must(spans.into_iter().all(|span| span <= USABLE), || {
        format!("duties {u} {v} {w} {x} take more than 95 % of the supply")
    })?;
    let least = (PERIOD - USABLE) / 2;
    must([u, v, w, x].iter().all(|duty| (least..=PERIOD - least).contains(duty)), || {
        format!("duties {u} {v} {w} {x} leave no time to measure")
    })
}
