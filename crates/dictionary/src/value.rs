//! Rust types that an object can have, and their bytes on the wire.

use crate::{AbortCode, DataType, Entry};

/// A type an object dictionary entry can hold.
pub trait Value: Copy {
    /// The type's name in the dictionary.
    const DATA_TYPE: DataType;
    /// Smallest value of the type, as far as an `i64` holds it.
    const MIN: i64;
    /// Largest value of the type, as far as an `i64` holds it.
    const MAX: i64;

    /// Writes the value little-endian to the front of `out` and returns its size in bytes.
    fn put(self, out: &mut [u8; crate::MAX_VALUE_SIZE]) -> usize;

    /// The value in `data`, if `data` has exactly its size.
    fn take(data: &[u8]) -> Option<Self>;

    /// The value for comparison with an entry's range.
    fn as_i64(self) -> i64;
}

macro_rules! value {
    ($($type:ty = $data_type:ident, $max:expr;)+) => {$(
        impl Value for $type {
            const DATA_TYPE: DataType = DataType::$data_type;
            const MIN: i64 = <$type>::MIN as i64;
            const MAX: i64 = $max;

            fn put(self, out: &mut [u8; crate::MAX_VALUE_SIZE]) -> usize {
                const SIZE: usize = size_of::<$type>();
                out[..SIZE].copy_from_slice(&self.to_le_bytes());
                SIZE
            }

            fn take(data: &[u8]) -> Option<Self> {
                data.try_into().ok().map(Self::from_le_bytes)
            }

            fn as_i64(self) -> i64 {
                i64::try_from(self).unwrap_or(i64::MAX)
            }
        }
    )+};
}

value! {
    u8 = Unsigned8, u8::MAX as i64;
    i8 = Integer8, i8::MAX as i64;
    u16 = Unsigned16, u16::MAX as i64;
    i16 = Integer16, i16::MAX as i64;
    u32 = Unsigned32, u32::MAX as i64;
    i32 = Integer32, i32::MAX as i64;
    u64 = Unsigned64, i64::MAX;
}

impl Value for bool {
    const DATA_TYPE: DataType = DataType::Boolean;
    const MIN: i64 = 0;
    const MAX: i64 = 1;

    fn put(self, out: &mut [u8; crate::MAX_VALUE_SIZE]) -> usize {
        out[0] = u8::from(self);
        1
    }

    fn take(data: &[u8]) -> Option<Self> {
        match data {
            [bits] => Some(bits & 1 == 1),
            _ => None,
        }
    }

    fn as_i64(self) -> i64 {
        i64::from(self)
    }
}

/// Reads a value for `entry` from the wire.
///
/// # Errors
/// A wrong length answers 0x06070010, a value outside of the entry's range 0x06090031 or 0x06090032.
pub fn parse<T: Value>(entry: &Entry, data: &[u8]) -> Result<T, AbortCode> {
    let value = T::take(data).ok_or(AbortCode::LengthMismatch)?;
    match value.as_i64() {
        number if number > entry.max => Err(AbortCode::ValueTooHigh),
        number if number < entry.min => Err(AbortCode::ValueTooLow),
        _ => Ok(value),
    }
}
