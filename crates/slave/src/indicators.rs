//! RUN and ERR LED: what they tell, and what the master makes them show instead (ETG.1300; ESC data sheet, LED override).

use wire::al::{AlState, AlStatusCode};
use wire::indicator::{Indicator, Pattern};
use wire::{EscAccess, Nanos, register};

use crate::stack::Slave;

/// What an error is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Origin {
    /// The master asked for a state, with this code, and the change was refused.
    Request(u8),
    /// The device has left a state by itself.
    Device,
}

/// RUN (green) and ERR (red) LED.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Leds {
    /// The state.
    pub run: Indicator,
    /// The error that was not acknowledged yet.
    pub err: Indicator,
}

/// What the LEDs are to tell.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Patterns {
    pub(crate) run: Pattern,
    pub(crate) err: Pattern,
}

impl Patterns {
    /// For a state, and an error that is pending.
    pub(crate) const fn new(state: AlState, code: AlStatusCode, origin: Origin) -> Self {
        Self {
            run: run(state),
            err: error(code, origin),
        }
    }
}

/// The RUN LED: the state.
const fn run(state: AlState) -> Pattern {
    match state {
        AlState::Init => Pattern::OFF,
        AlState::PreOp => Pattern::BLINKING,
        AlState::Boot => Pattern::FLICKERING,
        AlState::SafeOp => Pattern::SINGLE_FLASH,
        AlState::Op => Pattern::ON,
    }
}

/// The ERR LED: the error that was not acknowledged yet.
const fn error(code: AlStatusCode, origin: Origin) -> Pattern {
    match (code, origin) {
        (AlStatusCode::None, _) => Pattern::OFF,
        (AlStatusCode::SyncManagerWatchdog, _) => Pattern::DOUBLE_FLASH,
        (AlStatusCode::SynchronizationError | AlStatusCode::FatalSyncError | AlStatusCode::NoSyncSignal, _) => Pattern::SINGLE_FLASH,
        (_, Origin::Request(_)) => Pattern::BLINKING,
        (_, Origin::Device) => Pattern::SINGLE_FLASH,
    }
}

impl Slave {
    /// RUN and ERR LED now, for a board whose slave controller does not drive them itself, or for a picture of one.
    ///
    /// To be called every few milliseconds: a pattern begins when it is seen here first. What the override registers (0x0138, 0x0139) ask
    /// for goes before what the stack has to tell, which it writes there with each change of state.
    pub fn leds(&mut self, esc: &mut impl EscAccess, now: Nanos) -> Leds {
        let mut overrides = [0; 2];
        esc.read(register::RUN_LED, &mut overrides);
        let [run, err] = overrides.map(Pattern::from_override);
        self.leds.run.show(run.unwrap_or(self.patterns.run), now);
        self.leds.err.show(err.unwrap_or(self.patterns.err), now);
        self.leds
    }
}
