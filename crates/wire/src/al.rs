//! The application layer's state machine as it appears in registers 0x0120, 0x0130 and 0x0134 (ETG.1000.6, ESM).

/// A state of the EtherCAT state machine.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum AlState {
    /// No communication on the application layer.
    #[default]
    Init,
    /// Mailbox communication, no process data.
    PreOp,
    /// Firmware download.
    Boot,
    /// Inputs are valid, outputs are in their safe state.
    SafeOp,
    /// Inputs and outputs are valid.
    Op,
}

impl AlState {
    /// All states, in the order of their codes.
    pub const ALL: [Self; 5] = [Self::Init, Self::PreOp, Self::Boot, Self::SafeOp, Self::Op];

    /// The state with this code in bits 3:0 of AL control and AL status, if there is one.
    pub const fn from_code(code: u8) -> Option<Self> {
        match code {
            1 => Some(Self::Init),
            2 => Some(Self::PreOp),
            3 => Some(Self::Boot),
            4 => Some(Self::SafeOp),
            8 => Some(Self::Op),
            _ => None,
        }
    }

    /// The state's code in AL control and AL status.
    pub const fn code(self) -> u8 {
        match self {
            Self::Init => 1,
            Self::PreOp => 2,
            Self::Boot => 3,
            Self::SafeOp => 4,
            Self::Op => 8,
        }
    }

    /// The state's name as masters print it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Init => "INIT",
            Self::PreOp => "PREOP",
            Self::Boot => "BOOT",
            Self::SafeOp => "SAFEOP",
            Self::Op => "OP",
        }
    }
}

/// AL control (0x0120) as the master wrote it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct AlControl(pub u16);

impl AlControl {
    /// The code of the requested state, which need not be one.
    pub const fn state_code(self) -> u8 {
        (self.0 & 0x0F) as u8
    }

    /// Whether a pending error is acknowledged.
    pub const fn acknowledges_error(self) -> bool {
        self.0 & 0x10 != 0
    }

    /// Whether the device's identification is to be shown in place of the AL status code.
    pub const fn requests_identification(self) -> bool {
        self.0 & 0x20 != 0
    }
}

/// AL status (0x0130): state, error indication and device identification.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct AlStatus {
    /// The state the device is in.
    pub state: AlState,
    /// Whether the AL status code (0x0134) holds an error that was not acknowledged yet.
    pub error: bool,
    /// Whether the AL status code (0x0134) holds the device's identification.
    pub identified: bool,
}

impl AlStatus {
    /// The register's value.
    pub const fn bits(self) -> u16 {
        self.state.code() as u16 | (self.error as u16) << 4 | (self.identified as u16) << 5
    }
}

macro_rules! al_status_codes {
    ($($(#[$meta:meta])* $name:ident = $code:literal,)+) => {
        /// AL status codes (0x0134): why a state was refused or left.
        #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
        #[repr(u16)]
        pub enum AlStatusCode {
            $($(#[$meta])* $name = $code,)+
        }

        impl AlStatusCode {
            /// All codes.
            pub const ALL: &'static [Self] = &[$(Self::$name),+];
        }
    };
}

al_status_codes! {
    /// No error.
    #[default]
    None = 0x0000,
    /// The requested change of state is not one of the state machine's.
    InvalidStateChange = 0x0011,
    /// The requested state does not exist.
    UnknownState = 0x0012,
    /// The device has no bootstrap state.
    BootNotSupported = 0x0013,
    /// The mailbox sync managers are not usable.
    InvalidMailboxConfiguration = 0x0016,
    /// Outputs and SYNC0 are out of step.
    SynchronizationError = 0x001A,
    /// No outputs came in time.
    SyncManagerWatchdog = 0x001B,
    /// Sync manager 2 does not fit the mapped outputs.
    InvalidOutputConfiguration = 0x001D,
    /// Sync manager 3 does not fit the mapped inputs.
    InvalidInputConfiguration = 0x001E,
    /// Sync manager 2 triggers a watchdog whose time is zero.
    InvalidWatchdogConfiguration = 0x001F,
    /// The TxPDO mapping is invalid.
    InvalidInputMapping = 0x0024,
    /// The RxPDO mapping is invalid.
    InvalidOutputMapping = 0x0025,
    /// Free run needs three buffers for the process data.
    FreeRunNeedsThreeBuffers = 0x0029,
    /// SYNC0 stopped in OP.
    FatalSyncError = 0x002C,
    /// SYNC0 never came.
    NoSyncSignal = 0x002D,
    /// The distributed clock's activation is not one the device can follow.
    InvalidDcSyncConfiguration = 0x0030,
    /// The SYNC0 cycle time is out of range.
    InvalidSync0CycleTime = 0x0036,
}

impl AlStatusCode {
    /// The register's value.
    pub const fn code(self) -> u16 {
        self as u16
    }
}
