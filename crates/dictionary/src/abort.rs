//! Abort codes of SDO transfers (ETG.1000.6, table "SDO abort codes").

macro_rules! abort_codes {
    ($($(#[$meta:meta])* $name:ident = $code:literal, $text:literal;)+) => {
        /// Why an access to the object dictionary was refused.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        #[repr(u32)]
        pub enum AbortCode {
            $(#[doc = $text] $(#[$meta])* $name = $code,)+
        }

        impl AbortCode {
            /// All codes.
            pub const ALL: &'static [Self] = &[$(Self::$name),+];

            /// What the code means, as masters print it.
            pub const fn text(self) -> &'static str {
                match self {
                    $(Self::$name => $text,)+
                }
            }
        }
    };
}

abort_codes! {
    ToggleNotAlternated = 0x0503_0000, "toggle bit not alternated";
    ProtocolTimeout = 0x0504_0000, "SDO protocol timed out";
    UnknownCommand = 0x0504_0001, "command specifier not valid or unknown";
    OutOfMemory = 0x0504_0005, "out of memory";
    UnsupportedAccess = 0x0601_0000, "unsupported access to an object";
    WriteOnly = 0x0601_0001, "attempt to read a write-only object";
    ReadOnly = 0x0601_0002, "attempt to write a read-only object";
    SubIndexZeroNotCleared = 0x0601_0003, "entry cannot be written while sub-index 0 is not zero";
    CompleteAccessUnsupported = 0x0601_0004, "complete access is not supported for this object";
    ObjectTooLong = 0x0601_0005, "object length exceeds the mailbox";
    ObjectNotFound = 0x0602_0000, "object does not exist in the object dictionary";
    NotMappable = 0x0604_0041, "object cannot be mapped to the PDO";
    PdoLengthExceeded = 0x0604_0042, "number and length of the mapped objects exceed the PDO";
    ParameterIncompatible = 0x0604_0043, "general parameter incompatibility";
    HardwareError = 0x0606_0000, "access failed due to a hardware error";
    LengthMismatch = 0x0607_0010, "data type does not match, length of the parameter does not match";
    LengthTooHigh = 0x0607_0012, "data type does not match, parameter too long";
    LengthTooLow = 0x0607_0013, "data type does not match, parameter too short";
    SubIndexNotFound = 0x0609_0011, "sub-index does not exist";
    ValueRange = 0x0609_0030, "value range of the parameter exceeded";
    ValueTooHigh = 0x0609_0031, "value of the parameter too high";
    ValueTooLow = 0x0609_0032, "value of the parameter too low";
    General = 0x0800_0000, "general error";
    CannotStore = 0x0800_0020, "data cannot be transferred or stored to the application";
    LocalControl = 0x0800_0021, "data cannot be stored because of local control";
    DeviceState = 0x0800_0022, "data cannot be stored because of the present device state";
}

impl AbortCode {
    /// The code as it crosses the wire.
    pub const fn code(self) -> u32 {
        self as u32
    }

    /// The abort code with this number, if it is one of those this project knows.
    pub fn from_code(code: u32) -> Option<Self> {
        Self::ALL.iter().copied().find(|known| known.code() == code)
    }
}

impl core::fmt::Display for AbortCode {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        write!(f, "0x{:08X}: {}", self.code(), self.text())
    }
}
