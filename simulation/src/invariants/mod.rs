//! What must hold in every tick, whatever the master does. None of it is computed by the drive's own functions.
//!
//! | module | watches |
//! |---|---|
//! | [`power`] | the power state machine: transitions, power stage, enabling |
//! | [`bits`] | statusword, status code, fault codes, mode display, outputs |
//! | [`alarms`] | faults: none without a cause, and none missing |
//! | [`windings`] | duties, voltages, currents |
//! | [`identification`] | how long the motor is identified, and how often |
//! | [`energy`] | bus voltage and where the energy goes |
//! | [`motion`] | field, position counter, speed and acceleration |
//! | [`limits`] | how far a motion goes past a limit switch |
//! | [`inputs`] | filter, polarity and functions of the inputs |
//! | [`probes`] | touch probes |
//! | [`ranges`] | values of objects |

pub mod alarms;
pub mod bits;
pub mod energy;
pub mod identification;
pub mod inputs;
pub mod limits;
pub mod motion;
pub mod power;
pub mod probes;
pub mod ranges;
pub mod windings;

use board::{Actuators, PowerStage, Sensors};
use drive::inputs::Signals;
use drive::{DriveObjects, Mode, PowerState};
use plant::Plant;
use usr2556e::drive::VirtualDrive;
use wire::al::AlState;

use crate::coverage::Coverage;

/// A control tick in seconds.
pub const TICK: f64 = 50e-6;

/// Ticks from one look at the lost steps to the next.
const STEPS_COUNTED: u32 = 1009;

/// Nothing, or what is wrong.
pub type Verdict = Result<(), String>;

/// Checks a condition; the text is made only when it does not hold.
pub fn must(condition: bool, what: impl FnOnce() -> String) -> Verdict {
    if condition { Ok(()) } else { Err(what()) }
}

/// A drive after a tick.
pub struct View<'a> {
    /// The drive.
    pub drive: &'a VirtualDrive,
    /// Its objects.
    pub objects: &'a DriveObjects,
    /// What the tick measured.
    pub sensors: &'a Sensors,
    /// What the tick commanded.
    pub actuators: &'a Actuators,
    /// The inputs as the drive sees them.
    pub signals: &'a Signals,
    /// The state of the power state machine before the tick.
    pub before: PowerState,
    /// And after it.
    pub state: PowerState,
    /// The mode.
    pub mode: Option<Mode>,
    /// Whether the AL state is OP.
    pub operational: bool,
}

impl View<'_> {
    /// What hangs on the drive's terminals, after the tick.
    pub fn plant(&self) -> &Plant {
        self.drive.plant()
    }

    /// Whether the power stage is on.
    pub fn is_powered(&self) -> bool {
        self.actuators.stage != PowerStage::Off
    }

    /// A bit of the statusword.
    pub const fn status(&self, bit: u32) -> bool {
        self.objects.statusword >> bit & 1 != 0
    }

    /// Sub-pulses that the field has travelled in the tick.
    pub fn velocity(&self) -> i64 {
        self.drive.device().drive().velocity().sub_pulses_per_tick()
    }

    /// Whether the drive says that it moves.
    pub fn is_moving(&self) -> bool {
        self.drive.device().drive().is_moving()
    }
}

/// All invariants.
#[derive(Clone, Debug, Default)]
pub struct Invariants {
    before: PowerState,
    al_state: AlState,
    moving_in: Option<Mode>,
    ticks: u32,
    lost_periods: i64,
    power: power::Power,
    modes: bits::Modes,
    motion: motion::Motion,
    limits: limits::Limits,
    inputs: inputs::Inputs,
    probes: probes::Probes,
    ranges: ranges::Ranges,
    alarms: alarms::Alarms,
    windings: windings::Windings,
    identification: identification::Identification,
    energy: energy::Energy,
}

impl Invariants {
    /// Looks at a tick that is over.
    ///
    /// # Errors
    /// What does not hold.
    pub fn tick(&mut self, drive: &VirtualDrive, sensors: &Sensors, coverage: &mut Coverage) -> Verdict {
        let core = drive.device().drive();
        let view = View {
            drive,
            objects: drive.device().objects(),
            sensors,
            actuators: drive.actuators(),
            signals: core.signals(),
            before: self.before,
            state: core.power_state(),
            mode: core.mode(),
            operational: drive.device().slave().state() == AlState::Op,
        };
        self.note(&view, coverage);
        self.before = view.state;
        self.inputs.tick(&view)?;
        self.power.tick(&view)?;
        self.modes.tick(&view)?;
        bits::check(&view)?;
        self.motion.tick(&view, coverage)?;
        self.limits.tick(&view, coverage)?;
        self.probes.tick(&view, coverage)?;
        self.alarms.tick(&view)?;
        self.windings.tick(&view)?;
        self.identification.tick(&view, coverage)?;
        self.energy.tick(&view)?;
        self.ranges.tick(&view)
    }

    /// The axis stands somewhere else than after the last tick.
    pub fn axis_moved_by_hand(&mut self) {
        self.motion.forget_shaft();
    }

    /// The drive was switched off and on again.
    pub fn power_cycled(&mut self) {
        *self = Self::default();
    }

    /// Counts what happens for the first time in this tick.
    fn note(&mut self, view: &View, coverage: &mut Coverage) {
        self.ticks += 1;
        if self.ticks.is_multiple_of(STEPS_COUNTED) {
            let lost = view.drive.motor().lost_periods;
            if lost != self.lost_periods {
                self.lost_periods = lost;
                coverage.count("steps lost");
            }
        }
        if view.state != view.before {
            coverage.count(&format!("state {}", view.state.name()));
            if view.state == PowerState::FaultReactionActive {
                coverage.count(&format!("fault {:04X}", view.objects.error_code));
            }
        }
        let al_state = view.drive.device().slave().state();
        if al_state != self.al_state {
            self.al_state = al_state;
            coverage.count(&format!("AL {}", al_state.name()));
            coverage.count(&format!("AL status code {:04X}", view.drive.device().slave().status_code() as u16));
        }
        let moving_in = view.mode.filter(|_| view.velocity() != 0);
        if moving_in != self.moving_in {
            match (self.moving_in, moving_in) {
                (Some(_), Some(_)) => coverage.count("change of mode in motion"),
                (None, Some(mode)) => coverage.count(&format!("moving in {}", mode.name())),
                _ => {}
            }
            self.moving_in = moving_in;
        }
    }
}
