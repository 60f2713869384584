//! CANopen over EtherCAT (ETG.1000.6, CoE).
//!
//! | module | holds |
//! |---|---|
//! | here | the CoE header |
//! | [`sdo`] | SDO requests and responses |
//! | [`information`] | SDO information |
//! | [`emergency`] | emergency messages |

pub mod emergency;
pub mod information;
pub mod sdo;

pub use emergency::Emergency;
pub use sdo::{Address, SDO_SIZE, SHORT_SEGMENT, SdoRequest, SdoResponse};

/// Bytes of the CoE header.
pub const HEADER_SIZE: usize = 2;

/// The service in bits 15:12 of the CoE header.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Service {
    /// Emergency message.
    Emergency = 1,
    /// SDO request; aborts of either side carry it too.
    SdoRequest = 2,
    /// SDO response.
    SdoResponse = 3,
    /// TxPDO by mailbox.
    TxPdo = 4,
    /// RxPDO by mailbox.
    RxPdo = 5,
    /// Request for a TxPDO.
    TxPdoRequest = 6,
    /// Request for an RxPDO.
    RxPdoRequest = 7,
    /// SDO information.
    SdoInformation = 8,
}

impl Service {
    /// The service with this code, if there is one.
    pub const fn from_code(code: u8) -> Option<Self> {
        Some(match code {
            1 => Self::Emergency,
            2 => Self::SdoRequest,
            3 => Self::SdoResponse,
            4 => Self::TxPdo,
            5 => Self::RxPdo,
            6 => Self::TxPdoRequest,
            7 => Self::RxPdoRequest,
            8 => Self::SdoInformation,
            _ => return None,
        })
    }

    /// The CoE header of a message of this service, number 0.
    pub const fn header(self) -> [u8; HEADER_SIZE] {
        [0, (self as u8) << 4]
    }
}
