//! Faults: none without a cause that the simulation knows of, and every cause leads to its fault in time.

use std::f64::consts::TAU;

use board::TICKS_PER_SECOND;
use drive::{CurrentVector, PowerState};
use plant::Phases;

use super::motion::SUB_PULSES;
use super::windings::is_broken;
use super::{TICK, Verdict, View, must};
use crate::machine::motor_type;

/// Bus voltages in mV and how many ticks in a row beyond them are a fault.
const OVERVOLTAGE: (i32, u32) = (60_000, 2);
const UNDERVOLTAGE: (i32, u32) = (15_000, 40);
/// Current in mA, and ticks beyond it that are a fault, of four in a row.
const OVERCURRENT: (i32, u32) = (12_000, 2);
/// What the drive may take for an offset of the sensors at the most, in mA: noise of a step of the converter, as a mean.
const OFFSET: i32 = 10;
/// Ticks of the operating current after which an open phase is found at the latest: twice what the drive takes, as a phase that is hardly
/// to carry anything counts differently.
const MISSING: f64 = 100.0;
/// Ticks after which what was broken has no consequences any more.
const MENDED: u32 = 800;
/// Ticks with a current in a shorted winding after which the drive has found it: 20 ms, as at the enabling.
const SHORTED: u32 = 400;
/// Revolutions a second beyond which nobody knows what currents flow: the manual's 3000 rpm.
const FASTEST: f64 = 50.0;
/// Revolutions a second by which a shaft is faster than its field that the load spins: its back-EMF may drive any current.
const DRIVEN: f64 = 2.0;
/// Ticks after which a field or a shaft that turned faster than that is forgotten.
const FOLLOWED: u32 = 1_000;
/// Ticks after the end of the identification in which what it has found becomes a fault.
const VERDICT: u32 = 2;
/// Commanded amplitude from which on broken windings have to be found, in mA.
const ENOUGH: i32 = 1_000;

/// What the drive's protection should have seen.
#[derive(Clone, Debug)]
pub struct Alarms {
    high: u32,
    low: u32,
    /// Which of the last four samples may have been beyond the limit for over-current, and which were whatever the drive takes for an offset.
    over: u32,
    surely_over: u32,
    error: u16,
    /// Ticks since windings were broken, up to [`MENDED`].
    whole: u32,
    /// Whether the drive has last identified the motor that it has, whole and to its satisfaction.
    identified: bool,
    was_identifying: bool,
    /// Ticks since the motor was being identified, up to [`VERDICT`] and one more.
    since_identifying: u32,
    missing: [f64; 2],
    shorted: u32,
    angle: u32,
    /// Ticks since the field turned faster than any motor, or the load spun the shaft, up to [`FOLLOWED`].
    slow: u32,
    /// Ticks since the shaft was slower than the field by more than [`DRIVEN`], up to [`FOLLOWED`]: out of step, the back-EMF comes and
    /// goes, and drives up to more than twice the operating current.
    in_step: u32,
}

impl Default for Alarms {
    fn default() -> Self {
        Self {
            high: 0,
            low: 0,
            over: 0,
            surely_over: 0,
            error: 0,
            whole: MENDED,
            identified: false,
            was_identifying: false,
            since_identifying: VERDICT + 1,
            missing: [0.0; 2],
            shorted: 0,
            angle: 0,
            slow: FOLLOWED,
            in_step: FOLLOWED,
        }
    }
}

impl Alarms {
    /// Looks at a tick.
    ///
    /// # Errors
    /// What does not hold.
    pub fn tick(&mut self, view: &View) -> Verdict {
        self.measure(view);
        let error = view.objects.error_code;
        if error != self.error && error != 0 {
            self.check_cause(error, view)?;
        }
        self.error = error;
        self.check_owed(view)?;
        self.follow_identification(view);
        Ok(())
    }

    fn measure(&mut self, view: &View) {
        let sensors = view.sensors;
        let bus = sensors.bus_voltage.0;
        self.high = if bus > OVERVOLTAGE.0 { self.high + 1 } else { 0 };
        let enabled = matches!(
            view.before,
            PowerState::OperationEnabled | PowerState::QuickStopActive | PowerState::FaultReactionActive
        );
        self.low = if bus < UNDERVOLTAGE.0 && enabled { self.low + 1 } else { 0 };
        let [first, second] = sensors.phase_currents.map(|current| current.0);
        let third = if view.objects.motor_type == 1 { first + second } else { 0 };
        let most = first.abs().max(second.abs()).max(third.abs());
        let last_four = |samples: u32, limit: i32| (samples << 1 | u32::from(most > limit)) & 0xF;
        self.over = last_four(self.over, OVERCURRENT.0 - OFFSET);
        self.surely_over = last_four(self.surely_over, OVERCURRENT.0 + OFFSET);
        let turns = view.velocity() as f64 / SUB_PULSES as f64 / f64::from(view.objects.resolution) * f64::from(TICKS_PER_SECOND);
        let shaft = view.plant().motor().speed / TAU;
        let driven = shaft.abs() > turns.abs() + DRIVEN;
        self.slow = if turns.abs() > FASTEST || driven {
            0
        } else {
            (self.slow + 1).min(FOLLOWED)
        };
        self.in_step = if (shaft - turns).abs().min((shaft + turns).abs()) > DRIVEN {
            0
        } else {
            (self.in_step + 1).min(FOLLOWED)
        };
        let broken = is_broken(&view.plant().faults());
        self.whole = if broken { 0 } else { (self.whole + 1).min(MENDED) };
    }

    fn check_cause(&self, error: u16, view: &View) -> Verdict {
        let enabled = !matches!(
            view.before,
            PowerState::NotReadyToSwitchOn
                | PowerState::SwitchOnDisabled
                | PowerState::ReadyToSwitchOn
                | PowerState::SwitchedOn
                | PowerState::Fault
        );
        let unknown = !self.is_known(view);
        let holds = match error {
            0x7500 => enabled && !view.operational,
            0x3110 => self.high >= OVERVOLTAGE.1,
            0x3210 => self.low >= UNDERVOLTAGE.1,
            0x2211 => {
                (self.over.count_ones() >= OVERCURRENT.1 || self.since_identifying <= VERDICT)
                    && (unknown || self.slow < FOLLOWED || self.in_step < FOLLOWED || harmonic_is_high(view))
            }
            0x7122 => enabled && (unknown || self.slow < FOLLOWED),
            _ => false,
        };
        must(holds, || {
            let inductance = view.plant().config().motor.inductance;
            let (amplitude, kp) = (view.objects.peak_current, view.objects.current_loop_kp);
            let harmonic = view.objects.harmonic_amplitude;
            let bus = view.plant().bus_voltage();
            format!(
                "false alarm {error:04X} at {} ticks, {amplitude} mA, {harmonic}, {kp} uH of {inductance} H, {bus} V: {self:?}",
                self.slow
            )
        })
    }

    /// Whether the drive has whole windings before it, knows what motor they are, and sets the gains for it.
    fn is_known(&self, view: &View) -> bool {
        self.whole == MENDED && self.identified && view.objects.auto_pi == 1 && is_right(view)
    }

    fn follow_identification(&mut self, view: &View) {
        let identifying = view.drive.device().drive().is_identifying();
        self.since_identifying = if identifying {
            0
        } else {
            (self.since_identifying + 1).min(VERDICT + 1)
        };
        if identifying && !self.was_identifying {
            self.identified = true;
        }
        if identifying && (self.whole < MENDED || !is_right(view)) {
            self.identified = false;
        }
        let settled = view.drive.device().drive().winding().is_some_and(|winding| winding.settled);
        if self.was_identifying && !identifying && !settled {
            self.identified = false;
        }
        self.was_identifying = identifying;
    }

    fn check_owed(&mut self, view: &View) -> Verdict {
        let quiet = view.objects.error_code == 0;
        must(!quiet || self.high < OVERVOLTAGE.1, || "no fault of a bus above 60 V".into())?;
        must(!quiet || self.low < UNDERVOLTAGE.1, || "no fault of a bus below 15 V".into())?;
        let vector = view.drive.device().drive().current_vector();
        let Some(vector) = vector.filter(|_| view.is_powered()) else {
            (self.missing, self.shorted, self.surely_over) = ([0.0; 2], 0, 0);
            return Ok(());
        };
        must(self.surely_over.count_ones() <= OVERCURRENT.1, || {
            "the power stage stays on beyond 12 A".into()
        })?;
        let speed = f64::from(vector.angle.0.wrapping_sub(self.angle) as i32).abs() / 2_f64.powi(32) * TAU * f64::from(TICKS_PER_SECOND);
        self.angle = vector.angle.0;
        let faults = view.plant().faults();
        if vector.amplitude.0 < ENOUGH || self.was_identifying || !is_right(view) {
            return Ok(());
        }
        self.check_open(faults.open, vector, speed, view)?;
        // A short before the identification is found by that, or is what the gains are made for.
        let shorted = (faults.shorted[0] || faults.shorted[1]) && self.identified && view.objects.auto_pi == 1 && shows(view);
        self.shorted = if shorted { self.shorted + 1 } else { 0 };
        must(self.shorted <= SHORTED, || "a shorted winding is not found".into())
    }

    /// A phase that is to carry current and cannot is a fault, as far as the supply could drive one at the speed.
    fn check_open(&mut self, open: [bool; 2], vector: CurrentVector, speed: f64, view: &View) -> Verdict {
        let objects = view.objects;
        let nothing = 0.03 * f64::from(objects.peak_current) / 1000.0 + 0.015;
        let reach = 8.0 * nothing * speed * f64::from(objects.current_loop_kp) * 1e-6;
        let in_reach = view.plant().bus_voltage() > reach;
        let masked = objects.error_detection & 0x80 == 0 || objects.harmonic_amplitude != 0;
        let amplitude = f64::from(vector.amplitude.0);
        let angle = f64::from(vector.angle.0) / 2_f64.powi(32) * TAU;
        let axes = match view.plant().config().motor.phases {
            Phases::Two => [0.0, TAU / 4.0],
            Phases::Three => [0.0, -TAU / 3.0],
        };
        for phase in 0..2 {
            let share = (angle - axes[phase]).cos().abs();
            if !open[phase] || masked {
                self.missing[phase] = 0.0;
            } else if share > 0.3 && in_reach {
                self.missing[phase] += share * amplitude / f64::from(objects.peak_current);
            }
            must(self.missing[phase] <= MISSING, || format!("open phase {phase} is not found"))?;
        }
        Ok(())
    }
}

/// Whether a short takes the current beyond what the drive bears. The loop swings from one end of the voltage to the other, and the current
/// by what the supply drives in a tick through the hundredth of the inductance that is left; a motor of many turns on a low supply stays below.
fn shows(view: &View) -> bool {
    let inductance = view.plant().config().motor.inductance / 100.0;
    view.plant().bus_voltage() * TICK / inductance > 1.5e-3 * f64::from(OVERCURRENT.0)
}

/// Whether 0x200C:01 says what motor there is.
fn is_right(view: &View) -> bool {
    view.objects.motor_type == motor_type(view.plant().config().motor.phases)
}

/// Whether the harmonic against resonance asks for more than the power stage bears.
fn harmonic_is_high(view: &View) -> bool {
    let [peak, harmonic] = [view.objects.peak_current, view.objects.harmonic_amplitude].map(f64::from);
    peak * (1.0 + harmonic / 1000.0) > 0.8 * f64::from(OVERCURRENT.0)
}
