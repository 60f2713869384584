//! What is known of an object before anybody reads it.

/// Data types of object dictionary entries (ETG.1000.6, basic data types).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u16)]
pub enum DataType {
    /// One bit, BOOLEAN.
    Boolean = 0x0001,
    /// INTEGER8.
    Integer8 = 0x0002,
    /// INTEGER16.
    Integer16 = 0x0003,
    /// INTEGER32.
    Integer32 = 0x0004,
    /// UNSIGNED8.
    Unsigned8 = 0x0005,
    /// UNSIGNED16.
    Unsigned16 = 0x0006,
    /// UNSIGNED32.
    Unsigned32 = 0x0007,
    /// VISIBLE_STRING.
    VisibleString = 0x0009,
    /// OCTET_STRING: bytes that are no text; as many as the entry has.
    OctetString = 0x000A,
    /// UNSIGNED64.
    Unsigned64 = 0x001B,
}

impl DataType {
    /// The type's number in SDO information, SII and PDO lists.
    pub const fn code(self) -> u16 {
        self as u16
    }

    /// The length in bits; `None` for strings.
    pub const fn bits(self) -> Option<u8> {
        match self {
            Self::Boolean => Some(1),
            Self::Integer8 | Self::Unsigned8 => Some(8),
            Self::Integer16 | Self::Unsigned16 => Some(16),
            Self::Integer32 | Self::Unsigned32 => Some(32),
            Self::Unsigned64 => Some(64),
            Self::VisibleString | Self::OctetString => None,
        }
    }

    /// The smallest and the largest value, as far as an `i64` holds it; `None` for strings.
    pub const fn range(self) -> Option<(i64, i64)> {
        match self.bits() {
            None => None,
            Some(64) => Some((0, i64::MAX)),
            Some(bits) if self.is_signed() => Some((-(1 << (bits - 1)), (1 << (bits - 1)) - 1)),
            Some(bits) => Some((0, (1 << bits) - 1)),
        }
    }

    /// The type's name in an ESI file (ETG.2000). Strings carry their length there, which is left to the caller; those of octets are arrays of
    /// the type named here.
    pub const fn esi_name(self) -> &'static str {
        match self {
            Self::Boolean => "BOOL",
            Self::Integer8 => "SINT",
            Self::Integer16 => "INT",
            Self::Integer32 => "DINT",
            Self::Unsigned8 => "USINT",
            Self::Unsigned16 => "UINT",
            Self::Unsigned32 => "UDINT",
            Self::Unsigned64 => "ULINT",
            Self::VisibleString => "STRING",
            Self::OctetString => "BYTE",
        }
    }

    /// Whether values are two's complement.
    pub const fn is_signed(self) -> bool {
        matches!(self, Self::Integer8 | Self::Integer16 | Self::Integer32)
    }
}

/// Access rights by AL state, PDO directions and persistence: the object access word of SDO information (ETG.1000.6, table "object
/// access").
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Access(u16);

impl Access {
    /// Readable in every state.
    pub const RO: Self = Self(0x0007);
    /// Readable and writable in every state.
    pub const RW: Self = Self(0x003F);
    /// Readable in every state, writable in PREOP only.
    pub const RW_PREOP: Self = Self(0x000F);
    /// May be mapped into an RxPDO.
    pub const RX_PDO: Self = Self(0x0040);
    /// May be mapped into a TxPDO.
    pub const TX_PDO: Self = Self(0x0080);
    /// Saved by 0x1010.
    pub const SAVED: Self = Self(0x0100);

    /// Usable as a start-up parameter.
    pub const SETTING: Self = Self(0x0200);

    const READ: u16 = 0x0007;
    const WRITE: u16 = 0x0038;
    const WRITE_PREOP: u16 = 0x0008;

    /// Both rights together.
    pub const fn with(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    /// The object access word.
    pub const fn bits(self) -> u16 {
        self.0
    }

    /// Whether the entry can be read at all.
    pub const fn is_readable(self) -> bool {
        self.0 & Self::READ != 0
    }

    /// Whether the entry can be written in some state.
    pub const fn is_writable(self) -> bool {
        self.0 & Self::WRITE != 0
    }

    /// Whether the entry can be written outside of PREOP too.
    pub const fn is_writable_everywhere(self) -> bool {
        self.0 & Self::WRITE == Self::WRITE
    }

    /// Whether the entry can be written in PREOP only.
    pub const fn is_writable_in_preop_only(self) -> bool {
        self.0 & Self::WRITE == Self::WRITE_PREOP
    }

    /// Whether the entry may be mapped into an RxPDO.
    pub const fn is_rx_mappable(self) -> bool {
        self.0 & Self::RX_PDO.0 != 0
    }

    /// Whether the entry may be mapped into a TxPDO.
    pub const fn is_tx_mappable(self) -> bool {
        self.0 & Self::TX_PDO.0 != 0
    }

    /// Whether 0x1010 saves the entry.
    pub const fn is_saved(self) -> bool {
        self.0 & Self::SAVED.0 != 0
    }

    /// Whether the entry is meant as a start-up parameter.
    pub const fn is_setting(self) -> bool {
        self.0 & Self::SETTING.0 != 0
    }
}

/// One entry of an object dictionary.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Entry {
    /// Index of the object.
    pub index: u16,
    /// Sub-index; 0 for an object of one value.
    pub sub: u8,
    /// The entry's name.
    pub name: &'static str,
    /// The name of the object the entry belongs to: the same as `name` for an object of one value.
    pub object: &'static str,
    /// Type of the value.
    pub data_type: DataType,
    /// Length of the value in bits.
    pub bits: u16,
    /// Who may read, write, map and save it.
    pub access: Access,
    /// Value at delivery.
    pub default: i64,
    /// Smallest value that can be written.
    pub min: i64,
    /// Largest value that can be written.
    pub max: i64,
    /// Unit of the value, empty if it has none; [`crate::unit::code`] makes a number of it.
    pub unit: &'static str,
    /// What it means, and where the manual or a standard says so.
    pub doc: &'static str,
}

impl Entry {
    /// Length of the value in bytes.
    pub const fn size(&self) -> usize {
        self.bits.div_ceil(8) as usize
    }

    /// Whether the entry belongs to an object with sub-indices.
    pub const fn in_record(&self) -> bool {
        self.sub != 0
    }

    /// The 32-bit form in which PDO mappings name an entry: index, sub-index, length in bits.
    pub const fn mapping(&self) -> u32 {
        (self.index as u32) << 16 | (self.sub as u32) << 8 | self.bits as u32
    }
}
