//! What can happen, how severe it is, and in which words it is told.

use core::fmt;

use heapless::Vec;
use wire::al::{AlState, AlStatusCode};

/// How severe an event is, with its code in a diagnosis message (ETG.1020).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Severity {
    /// It was meant to happen.
    Info = 0,
    /// The device goes on.
    Warning = 1,
    /// The device does no longer what it did.
    Error = 2,
}

impl Severity {
    /// The word for it in ESI files and in the report.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Info => "information",
            Self::Warning => "warning",
            Self::Error => "error",
        }
    }
}

/// What a diagnosis message says; configuration tools take the words from the ESI file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MessageText {
    /// The text's number in messages and in the ESI file.
    pub id: u16,
    /// How severe it is.
    pub severity: Severity,
    /// The words; each `%` stands for a parameter, in the notation of C.
    pub text: &'static str,
}

/// The texts of all messages.
pub const MESSAGES: [MessageText; 8] = [
    message(1, Severity::Info, "Power-on"),
    message(
        2,
        Severity::Warning,
        "Request for state %d refused in state %d, AL status code 0x%04X",
    ),
    message(3, Severity::Error, "State %d left for state %d, AL status code 0x%04X"),
    message(4, Severity::Error, "Fault 0x%04X, error register 0x%02X"),
    message(5, Severity::Info, "Fault 0x%04X cleared"),
    message(6, Severity::Info, "Parameters saved"),
    message(7, Severity::Info, "Parameters of delivery restored"),
    message(8, Severity::Info, "File written"),
];

const fn message(id: u16, severity: Severity, text: &'static str) -> MessageText {
    MessageText { id, severity, text }
}

/// The most parameters a message has.
pub(super) const MAX_PARAMETERS: usize = 3;

/// Something that has happened.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Event {
    /// The stack was polled for the first time.
    PowerOn,
    /// The master's request was refused; a lower state than before is one the refusal led to.
    Refused {
        /// The code of the requested state, which need not be one.
        requested: u8,
        state: AlState,
        code: AlStatusCode,
    },
    /// The device has left a state by itself.
    Left { from: AlState, to: AlState, code: AlStatusCode },
    /// A fault has come.
    Fault { code: u16, register: u8 },
    /// The fault is gone, and no other is there.
    FaultCleared { code: u16 },
    /// 0x1010 has saved the parameters.
    ParametersSaved,
    /// 0x1011 has restored the parameters of delivery.
    DefaultsRestored,
    /// A file was written, and the device has taken it.
    FileWritten(&'static str),
}

impl Event {
    const fn message(self) -> &'static MessageText {
        &MESSAGES[match self {
            Self::PowerOn => 0,
            Self::Refused { .. } => 1,
            Self::Left { .. } => 2,
            Self::Fault { .. } => 3,
            Self::FaultCleared { .. } => 4,
            Self::ParametersSaved => 5,
            Self::DefaultsRestored => 6,
            Self::FileWritten(_) => 7,
        }]
    }

    pub(crate) const fn severity(self) -> Severity {
        self.message().severity
    }

    pub(super) const fn text_id(self) -> u16 {
        self.message().id
    }

    /// The diagnosis code: for faults the error code behind 0xE800, as ETG.1020 has it; for all others the AL status code, if there is
    /// one, behind a number of the manufacturer's range 0xE000 to 0xE7FF, which is that of the text.
    pub(super) const fn diagnosis_code(self) -> u32 {
        const EMERGENCY: u32 = 0xE800;
        const MANUFACTURER: u32 = 0xE000;
        match self {
            Self::Fault { code, .. } => (code as u32) << 16 | EMERGENCY,
            Self::Refused { code, .. } | Self::Left { code, .. } => (code.code() as u32) << 16 | MANUFACTURER | self.text_id() as u32,
            _ => MANUFACTURER | self.text_id() as u32,
        }
    }

    /// The parameters of the text.
    pub(super) fn parameters(self) -> Vec<u16, MAX_PARAMETERS> {
        let parameters: &[u16] = match self {
            Self::PowerOn | Self::ParametersSaved | Self::DefaultsRestored | Self::FileWritten(_) => &[],
            Self::Refused { requested, state, code } => &[requested.into(), state.code().into(), code.code()],
            Self::Left { from, to, code } => &[from.code().into(), to.code().into(), code.code()],
            Self::Fault { code, register } => &[code, register.into()],
            Self::FaultCleared { code } => &[code],
        };
        parameters.iter().copied().collect()
    }
}

/// The event as the report tells it: names of states and files in place of numbers.
impl fmt::Display for Event {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Refused { requested, state, code } => {
                match AlState::from_code(requested) {
                    Some(requested) => write!(f, "Request for {} refused in {}", requested.name(), state.name())?,
                    None => write!(f, "Request for state {requested} refused in {}", state.name())?,
                }
                write_code(f, code)
            }
            Self::Left { from, to, code } => {
                write!(f, "{} left for {}", from.name(), to.name())?;
                write_code(f, code)
            }
            Self::Fault { code, register } => write!(f, "Fault 0x{code:04X}, error register 0x{register:02X}"),
            Self::FaultCleared { code } => write!(f, "Fault 0x{code:04X} cleared"),
            Self::FileWritten(name) => write!(f, "File {name} written"),
            Self::PowerOn | Self::ParametersSaved | Self::DefaultsRestored => f.write_str(self.message().text),
        }
    }
}

fn write_code(f: &mut fmt::Formatter<'_>, code: AlStatusCode) -> fmt::Result {
    write!(f, ", AL status code 0x{:04X} {code:?}", code.code())
}

#[cfg(test)]
mod tests {
    use std::string::ToString;

    use super::*;

    const EVENTS: [(Event, &str, u32); 9] = [
        (Event::PowerOn, "Power-on", 0x0000_E001),
        (
            Event::Refused {
                requested: 8,
                state: AlState::SafeOp,
                code: AlStatusCode::NoSyncSignal,
            },
            "Request for OP refused in SAFEOP, AL status code 0x002D NoSyncSignal",
            0x002D_E002,
        ),
        (
            Event::Refused {
                requested: 5,
                state: AlState::Init,
                code: AlStatusCode::UnknownState,
            },
            "Request for state 5 refused in INIT, AL status code 0x0012 UnknownState",
            0x0012_E002,
        ),
        (
            Event::Left {
                from: AlState::Op,
                to: AlState::SafeOp,
                code: AlStatusCode::SyncManagerWatchdog,
            },
            "OP left for SAFEOP, AL status code 0x001B SyncManagerWatchdog",
            0x001B_E003,
        ),
        (
            Event::Fault {
                code: 0x7500,
                register: 0x11,
            },
            "Fault 0x7500, error register 0x11",
            0x7500_E800,
        ),
        (Event::FaultCleared { code: 0x7500 }, "Fault 0x7500 cleared", 0x0000_E005),
        (Event::ParametersSaved, "Parameters saved", 0x0000_E006),
        (Event::DefaultsRestored, "Parameters of delivery restored", 0x0000_E007),
        (Event::FileWritten("a.txt"), "File a.txt written", 0x0000_E008),
    ];

    #[test]
    fn events_are_told_by_name_and_by_code() {
        for (event, text, code) in EVENTS {
            assert_eq!(event.to_string(), text);
            assert_eq!(event.diagnosis_code(), code, "{text}");
        }
    }

    #[test]
    fn every_text_has_its_number_and_as_many_places_as_its_event_has_parameters() {
        for (event, text, _) in EVENTS {
            assert_eq!(event.message().text.matches('%').count(), event.parameters().len(), "{text}");
        }
        assert!(MESSAGES.iter().zip(1..).all(|(message, id)| message.id == id));
    }
}
