//! RUN and ERR LED, as registers 0x0138 and 0x0139 show them (ETG.1300; ESC data sheet, LED override).

use wire::al::{AlState, AlStatusCode};

/// The code in bits 3:0 is shown.
const OVERRIDE: u8 = 0x10;
const OFF: u8 = 0x0;
const SINGLE_FLASH: u8 = 0x1;
const DOUBLE_FLASH: u8 = 0x2;
const BLINKING: u8 = 0xD;
const FLICKERING: u8 = 0xE;
const ON: u8 = 0xF;

/// What an error is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Origin {
    /// The master asked for a state, with this code, and the change was refused.
    Request(u8),
    /// The device has left a state by itself.
    Device,
}

/// The RUN LED: the state.
pub(crate) const fn run(state: AlState) -> u8 {
    OVERRIDE
        | match state {
            AlState::Init => OFF,
            AlState::PreOp => BLINKING,
            AlState::Boot => FLICKERING,
            AlState::SafeOp => SINGLE_FLASH,
            AlState::Op => ON,
        }
}

/// The ERR LED: the error that was not acknowledged yet.
pub(crate) const fn error(code: AlStatusCode, origin: Origin) -> u8 {
    OVERRIDE
        | match (code, origin) {
            (AlStatusCode::None, _) => OFF,
            (AlStatusCode::SyncManagerWatchdog, _) => DOUBLE_FLASH,
            (AlStatusCode::SynchronizationError | AlStatusCode::FatalSyncError | AlStatusCode::NoSyncSignal, _) => SINGLE_FLASH,
            (_, Origin::Request(_)) => BLINKING,
            (_, Origin::Device) => SINGLE_FLASH,
        }
}
