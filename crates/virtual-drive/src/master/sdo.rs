//! Reading and writing any object, with the object dictionary's knowledge of types where it has it.

use std::fmt;
use std::ops::Deref;
use std::str::FromStr;

use dictionary::{AbortCode, DataType, Entry, Lookup, lookup};
use drive::DriveObjects;
use ethercrab::error::{CoeAbortCode, Error, MailboxError};
use ethercrab::{EtherCrabWireRead, EtherCrabWireSized, SubDevice, SubDeviceRef};
use ethercrab_wire::WireError;

/// The longest object that can be read, in bytes.
const MAX_OBJECT: usize = 1024;

/// The bytes of an object, whatever their number.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Bytes(pub Vec<u8>);

impl EtherCrabWireSized for Bytes {
    const PACKED_LEN: usize = MAX_OBJECT;
    type Buffer = [u8; MAX_OBJECT];

    fn buffer() -> Self::Buffer {
        [0; MAX_OBJECT]
    }
}

impl EtherCrabWireRead for Bytes {
    fn unpack_from_slice(bytes: &[u8]) -> Result<Self, WireError> {
        Ok(Self(bytes.to_vec()))
    }
}

/// Reads the bytes at `address`.
///
/// # Errors
/// What the drive or the bus answered instead.
pub async fn read<S: Deref<Target = SubDevice>>(drive: &SubDeviceRef<'_, S>, address: Address) -> Result<Vec<u8>, Error> {
    drive.sdo_read::<Bytes>(address.index, address.sub).await.map(|bytes| bytes.0)
}

/// Writes up to four bytes to `address`.
///
/// # Errors
/// What the drive or the bus answered; the master itself refuses more than four bytes.
pub async fn write<S: Deref<Target = SubDevice>>(drive: &SubDeviceRef<'_, S>, address: Address, bytes: &[u8]) -> Result<(), Error> {
    drive.sdo_write(address.index, address.sub, bytes).await
}

/// The abort code in an error, if a drive has sent one.
pub fn abort_code(error: &Error) -> Option<AbortCode> {
    let Error::Mailbox(MailboxError::Aborted { code, .. }) = error else {
        return None;
    };
    let known = |candidate: &AbortCode| CoeAbortCode::unpack_from_slice(&candidate.code().to_le_bytes()).as_ref() == Ok(code);
    AbortCode::ALL.iter().copied().find(known)
}

/// Index and sub-index of an object, written `6041` or `1018:1` in hexadecimal digits, with or without `0x`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Address {
    /// Index.
    pub index: u16,
    /// Sub-index.
    pub sub: u8,
}

impl fmt::Display for Address {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "0x{:04X}:{:02X}", self.index, self.sub)
    }
}

impl FromStr for Address {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let (index, sub) = text.split_once(':').unwrap_or((text, "0"));
        let digits = |part: &str| part.trim_start_matches("0x").trim_start_matches("0X").to_owned();
        let wrong = || format!("\"{text}\" is no object address; write index and sub-index in hexadecimal, as in 6041 or 0x1018:1");
        Ok(Self {
            index: u16::from_str_radix(&digits(index), 16).map_err(|_| wrong())?,
            sub: u8::from_str_radix(&digits(sub), 16).map_err(|_| wrong())?,
        })
    }
}

impl Address {
    /// The type of the object, where the drive's own dictionary knows it.
    pub fn data_type(self) -> Option<DataType> {
        if self.sub == 0 && self.is_record() {
            return Some(DataType::Unsigned8);
        }
        self.entry().map(|entry| entry.data_type)
    }

    /// The object's entry in the drive's own dictionary.
    pub fn entry(self) -> Option<&'static Entry> {
        let found = |entries: &'static [Entry]| match lookup(entries, self.index, self.sub) {
            Ok(Lookup::Slot(slot)) => Some(&entries[slot]),
            _ => None,
        };
        found(slave::objects::ENTRIES).or_else(|| found(DriveObjects::ENTRIES))
    }

    fn is_record(self) -> bool {
        [slave::objects::ENTRIES, DriveObjects::ENTRIES]
            .iter()
            .any(|entries| matches!(lookup(entries, self.index, 0), Ok(Lookup::Count(_))))
    }
}

/// Writes a value for people: by its type where that is known, else by its length.
pub fn show(bytes: &[u8], data_type: Option<DataType>) -> String {
    let number = match bytes.len() {
        1..=8 => Some(bytes.iter().rev().fold(0_u64, |number, byte| number << 8 | u64::from(*byte))),
        _ => None,
    };
    match (data_type, number) {
        (Some(DataType::VisibleString), _) => format!("\"{}\"", String::from_utf8_lossy(bytes)),
        (Some(kind), Some(number)) if kind.is_signed() => {
            let unused = 64 - 8 * bytes.len() as u32;
            format!(
                "{} (0x{number:0width$X})",
                (number << unused) as i64 >> unused,
                width = 2 * bytes.len()
            )
        }
        (_, Some(number)) => format!("{number} (0x{number:0width$X})", width = 2 * bytes.len()),
        (_, None) => bytes.iter().map(|byte| format!("{byte:02X}")).collect::<Vec<_>>().join(" "),
    }
}

/// Reads a number, decimal or `0x`, as the bytes of an object of this type.
///
/// # Errors
/// A text that is no number of that type, and what would be one.
pub fn parse(text: &str, data_type: DataType) -> Result<Vec<u8>, String> {
    let Some(bits) = data_type.bits() else {
        return Ok(text.as_bytes().to_vec());
    };
    let number = match text.strip_prefix("0x").or_else(|| text.strip_prefix("0X")) {
        Some(digits) => i128::from_str_radix(digits, 16).ok(),
        None => text.parse().ok(),
    };
    let (min, max) = if data_type.is_signed() {
        (-(1_i128 << (bits - 1)), (1 << (bits - 1)) - 1)
    } else {
        (0, (1_i128 << bits) - 1)
    };
    match number {
        Some(number) if (min..=max).contains(&number) => Ok(number.to_le_bytes()[..usize::from(bits.div_ceil(8))].to_vec()),
        _ => Err(format!(
            "\"{text}\" is no {}; write a whole number from {min} to {max}, decimal or 0x",
            data_type.esi_name()
        )),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn addresses_are_read_with_and_without_prefix() {
        for (text, index, sub) in [
            ("6041", 0x6041, 0),
            ("0x6041", 0x6041, 0),
            ("1018:4", 0x1018, 4),
            ("0x1C12:0x10", 0x1C12, 16),
        ] {
            assert_eq!(text.parse(), Ok(Address { index, sub }), "{text}");
        }
        for wrong in ["", "60411", "6041:", "6041:100", "zz", "1018 1"] {
            assert!(wrong.parse::<Address>().is_err(), "{wrong}");
        }
    }

    #[test]
    fn values_are_shown_by_type_and_read_back() {
        assert_eq!(show(&[0xFE, 0xFF, 0xFF, 0xFF], Some(DataType::Integer32)), "-2 (0xFFFFFFFE)");
        assert_eq!(show(&[0xFE, 0xFF], Some(DataType::Unsigned16)), "65534 (0xFFFE)");
        assert_eq!(show(b"ECR60", Some(DataType::VisibleString)), "\"ECR60\"");
        assert_eq!(show(&[1; 9], None), "01 01 01 01 01 01 01 01 01");
        assert_eq!(parse("-2", DataType::Integer32), Ok(vec![0xFE, 0xFF, 0xFF, 0xFF]));
        assert_eq!(parse("0x06", DataType::Unsigned16), Ok(vec![6, 0]));
        for (wrong, kind) in [
            ("-1", DataType::Unsigned8),
            ("256", DataType::Unsigned8),
            ("32768", DataType::Integer16),
            ("six", DataType::Integer8),
        ] {
            assert!(parse(wrong, kind).unwrap_err().contains("whole number"), "{wrong}");
        }
    }

    #[test]
    fn types_come_from_the_dictionary() {
        assert_eq!("6041".parse::<Address>().unwrap().data_type(), Some(DataType::Unsigned16));
        assert_eq!("1018".parse::<Address>().unwrap().data_type(), Some(DataType::Unsigned8));
        assert_eq!("1008".parse::<Address>().unwrap().data_type(), Some(DataType::VisibleString));
        assert_eq!("5FFF".parse::<Address>().unwrap().data_type(), None);
    }
}
