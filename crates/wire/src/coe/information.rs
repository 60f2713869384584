//! SDO information (ETG.1000.6, SDO information services).

/// Bytes of the header of SDO information.
pub const HEADER_SIZE: usize = 4;
/// Bytes of a list's type, before its first indices.
pub const LIST_TYPE_SIZE: usize = 2;
/// Bytes before the name in an object description.
pub const OBJECT_SIZE: usize = 6;
/// Bytes before values and name in an entry description.
pub const ENTRY_SIZE: usize = 10;

/// What a message of SDO information is: bits 6:0 of its first byte.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Opcode {
    /// Asks for a list of objects.
    ListRequest = 1,
    /// A list of objects, or a part of it.
    ListResponse = 2,
    /// Asks what an object is.
    ObjectRequest = 3,
    /// What an object is.
    ObjectResponse = 4,
    /// Asks what an entry is.
    EntryRequest = 5,
    /// What an entry is.
    EntryResponse = 6,
    /// Why a request was refused.
    Error = 7,
}

/// The header of a response.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Header {
    /// What the response is.
    pub opcode: Opcode,
    /// How many further messages belong to it.
    pub fragments_left: u16,
}

impl Header {
    /// The header as it crosses the wire; bit 7 of the first byte says that more follows.
    pub const fn bytes(&self) -> [u8; HEADER_SIZE] {
        let incomplete = if self.fragments_left != 0 { 0x80 } else { 0 };
        let [low, high] = self.fragments_left.to_le_bytes();
        [self.opcode as u8 | incomplete, 0, low, high]
    }
}

/// Which objects a list is of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ListType {
    /// None: how many objects each of the other lists has.
    Counts,
    /// All objects.
    All,
    /// Objects with an entry that can be mapped into an RxPDO.
    RxMappable,
    /// Objects with an entry that can be mapped into a TxPDO.
    TxMappable,
    /// Objects to be stored for the replacement of the device.
    Backup,
    /// Objects that can be start-up parameters.
    Settings,
}

impl ListType {
    /// The lists that [`Self::Counts`] counts, in its order.
    pub const COUNTED: [Self; 5] = [Self::All, Self::RxMappable, Self::TxMappable, Self::Backup, Self::Settings];

    /// The list with this number, if there is one.
    pub const fn from_code(code: u16) -> Option<Self> {
        Some(match code {
            0 => Self::Counts,
            1 => Self::All,
            2 => Self::RxMappable,
            3 => Self::TxMappable,
            4 => Self::Backup,
            5 => Self::Settings,
            _ => return None,
        })
    }

    /// The list's number.
    pub const fn code(self) -> u16 {
        self as u16
    }
}

/// Bits of the value info of an entry description: what is asked for, and what the answer holds.
pub mod value_info {
    /// The access rights; they are always there.
    pub const ACCESS: u8 = 1 << 0;
    /// Whether the entry can be mapped; it is a part of the access rights.
    pub const MAPPABLE: u8 = 1 << 2;
    /// The unit, 32 bits.
    pub const UNIT: u8 = 1 << 3;
    /// The default value.
    pub const DEFAULT: u8 = 1 << 4;
    /// The smallest value.
    pub const MINIMUM: u8 = 1 << 5;
    /// The largest value.
    pub const MAXIMUM: u8 = 1 << 6;
}

/// A request for information.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Request {
    /// A list of objects.
    List {
        /// Which, from [`ListType`].
        list: u16,
    },
    /// What an object is.
    Object {
        /// Index of the object.
        index: u16,
    },
    /// What an entry is.
    Entry {
        /// Index of the object.
        index: u16,
        /// Sub-index.
        sub: u8,
        /// What is asked for, bits of [`value_info`].
        values: u8,
    },
    /// An opcode that is no request.
    Unknown,
}

impl Request {
    /// The request in `body`, the bytes after the CoE header; `None` if there are too few.
    pub fn parse(body: &[u8]) -> Option<Self> {
        let (&[opcode, _, _, _], rest) = body.split_first_chunk::<HEADER_SIZE>()?;
        let number = rest.first_chunk().copied().map(u16::from_le_bytes);
        Some(match opcode & 0x7F {
            1 => Self::List { list: number? },
            3 => Self::Object { index: number? },
            5 => {
                let &[low, high, sub, values] = rest.first_chunk()?;
                let index = u16::from_le_bytes([low, high]);
                Self::Entry { index, sub, values }
            }
            _ => Self::Unknown,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn requests_are_told_apart() {
        let cases: [(&[u8], Option<Request>); 8] = [
            (&[1, 0, 0, 0, 5, 0], Some(Request::List { list: 5 })),
            (&[3, 0, 0, 0, 0x40, 0x60], Some(Request::Object { index: 0x6040 })),
            (
                &[5, 0, 0, 0, 0x18, 0x10, 4, 0x70],
                Some(Request::Entry {
                    index: 0x1018,
                    sub: 4,
                    values: 0x70,
                }),
            ),
            (&[7, 0, 0, 0, 0, 0], Some(Request::Unknown)),
            (&[0, 0, 0, 0], Some(Request::Unknown)),
            (&[1, 0, 0, 0, 5], None),
            (&[5, 0, 0, 0, 0x18, 0x10, 4], None),
            (&[1, 0, 0], None),
        ];
        for (body, expected) in cases {
            assert_eq!(Request::parse(body), expected, "{body:02X?}");
        }
    }

    #[test]
    fn a_header_says_how_much_follows() {
        let header = |fragments_left| Header {
            opcode: Opcode::ListResponse,
            fragments_left,
        };
        assert_eq!(header(0).bytes(), [2, 0, 0, 0]);
        assert_eq!(header(0x102).bytes(), [0x82, 0, 2, 1]);
    }

    #[test]
    fn lists_are_numbered_as_in_the_standard() {
        for code in 0..6 {
            assert_eq!(ListType::from_code(code).map(ListType::code), Some(code));
        }
        assert_eq!(ListType::from_code(6), None);
    }
}
