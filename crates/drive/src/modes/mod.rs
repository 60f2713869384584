//! Modes of operation: what moves the motor in Operation Enabled (manual 2.4).
//!
//! - [`profile_position`]: PP, from set-point to set-point
//! - [`profile_velocity`]: PV, at a speed
//! - [`homing`]: the homing mode around the homing sequences
//! - [`cyclic_position`]: CSP, along the master's targets
//!
//! A mode takes the motion as it is: after a change of mode in flight, the new mode goes on from the speed there is, or brakes.

pub mod cyclic_position;
pub mod homing;
pub mod profile_position;
pub mod profile_velocity;

use board::Nanos;

use crate::controlword::Controlword;
use crate::inputs::Signals;
use crate::motion::Motion;
use crate::objects::DriveObjects;
use crate::profile::Acceleration;
use cyclic_position::CyclicPosition;
use homing::HomingMode;
use profile_position::ProfilePosition;
use profile_velocity::ProfileVelocity;

/// A mode of operation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(i8)]
pub enum Mode {
    /// PP.
    ProfilePosition = 1,
    /// PV.
    ProfileVelocity = 3,
    /// Homing.
    Homing = 6,
    /// CSP.
    CyclicPosition = 8,
}

impl Mode {
    /// The mode with this number in 0x6060, if the drive has it.
    pub const fn from_object(value: i8) -> Option<Self> {
        Some(match value {
            1 => Self::ProfilePosition,
            3 => Self::ProfileVelocity,
            6 => Self::Homing,
            8 => Self::CyclicPosition,
            _ => return None,
        })
    }

    /// The mode's short name.
    pub const fn name(self) -> &'static str {
        match self {
            Self::ProfilePosition => "PP",
            Self::ProfileVelocity => "PV",
            Self::Homing => "homing",
            Self::CyclicPosition => "CSP",
        }
    }
}

/// What a mode looks at in a tick.
#[derive(Clone, Copy, Debug)]
pub struct Context<'a> {
    /// The objects.
    pub objects: &'a DriveObjects,
    /// The controlword.
    pub controlword: Controlword,
    /// Rising edge of the controlword's bit 4.
    pub start: bool,
    /// The inputs.
    pub signals: &'a Signals,
    /// Whether the shaft has its full current. Before, a mode that makes its own motion does not begin one.
    pub locked: bool,
}

/// All modes and the active one.
#[derive(Clone, Debug)]
pub struct Modes {
    active: Option<Mode>,
    profile_position: ProfilePosition,
    profile_velocity: ProfileVelocity,
    homing: HomingMode,
    cyclic_position: CyclicPosition,
}

impl Modes {
    /// No mode yet.
    pub const fn new() -> Self {
        Self {
            active: None,
            profile_position: ProfilePosition::new(),
            profile_velocity: ProfileVelocity::new(),
            homing: HomingMode::new(),
            cyclic_position: CyclicPosition::new(),
        }
    }

    /// The active mode.
    pub const fn active(&self) -> Option<Mode> {
        self.active
    }

    /// Whether homing has been completed since power-up.
    pub const fn is_homed(&self) -> bool {
        self.homing.is_homed()
    }

    /// Takes 0x6060. A value that is no mode keeps the active one.
    pub fn select(&mut self, value: i8) {
        let Some(mode) = Mode::from_object(value) else { return };
        if self.active != Some(mode) {
            self.interrupt();
            self.homing.forget();
            self.active = Some(mode);
        }
    }

    /// Takes the target of CSP at the instant of synchronisation.
    pub const fn synchronize(&mut self, target: i32, cycle: Option<Nanos>) {
        self.cyclic_position.synchronize(target, cycle);
    }

    /// A tick has begun, whatever the state.
    pub const fn count_tick(&mut self) {
        self.cyclic_position.count_tick();
    }

    /// The mode no longer moves the motor: set-points are dropped, homing is interrupted.
    pub const fn interrupt(&mut self) {
        self.profile_position.drop_set_points();
        self.profile_velocity.leave();
        self.homing.interrupt();
        self.cyclic_position.leave();
    }

    /// The deceleration of the active mode, with which it slows down.
    pub const fn deceleration(&self, objects: &DriveObjects) -> Acceleration {
        match self.active {
            Some(Mode::Homing) => Acceleration::new(objects.homing_acceleration),
            _ => Acceleration::new(objects.profile_deceleration.unsigned_abs()),
        }
    }

    /// Moves the motor for a tick and returns the mode's bits of the statusword.
    pub fn operate(&mut self, context: &Context, motion: &mut Motion) -> u16 {
        match self.active {
            Some(Mode::ProfilePosition) => self.profile_position.tick(context, motion),
            Some(Mode::ProfileVelocity) => self.profile_velocity.tick(context, motion),
            Some(Mode::Homing) => self.homing.tick(context, motion, self.cyclic_position.cycle()),
            Some(Mode::CyclicPosition) => self.cyclic_position.tick(context, motion),
            None => {
                motion.stop(self.deceleration(context.objects));
                0
            }
        }
    }
}
