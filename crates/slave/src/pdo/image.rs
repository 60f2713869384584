//! A process image: objects at bit offsets.

use dictionary::MAX_VALUE_SIZE;
use heapless::Vec;

use super::mapping::Target;
use crate::bits;
use crate::configuration::MAX_PROCESS_DATA;
use crate::objects::{MAX_MAPPING_ENTRIES, PDOS_PER_DIRECTION};

const MAX_FIELDS: usize = MAX_MAPPING_ENTRIES * PDOS_PER_DIRECTION;

/// An object in a process image.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Field {
    target: Target,
    /// First bit in the image.
    offset: u16,
    /// Length in bits, at most 64.
    bits: u8,
}

impl Field {
    /// The bytes the field takes up if it starts and ends at byte borders.
    fn bytes(&self) -> Option<core::ops::Range<usize>> {
        let (offset, bits) = (usize::from(self.offset), usize::from(self.bits));
        ((offset | bits) % 8 == 0).then_some(offset / 8..(offset + bits) / 8)
    }
}

/// The layout of a process image; gaps take up bits without a field.
#[derive(Clone, Debug, Default)]
pub(crate) struct Image {
    fields: Vec<Field, MAX_FIELDS>,
    bits: u16,
}

impl Image {
    /// Bytes of the image.
    pub(crate) const fn size(&self) -> usize {
        self.bits.div_ceil(8) as usize
    }

    /// Appends an object or a gap of `bits` bits; `None` if the image becomes too large.
    pub(crate) fn append(&mut self, target: Target, bits: u8) -> Option<()> {
        let offset = self.bits;
        let end = offset + u16::from(bits);
        if usize::from(end) > MAX_PROCESS_DATA * 8 {
            return None;
        }
        if target != Target::Gap {
            self.fields.push(Field { target, offset, bits }).ok()?;
        }
        self.bits = end;
        Some(())
    }

    /// Hands every object's bytes to `store`, in the order of the mapping. `bytes` is at least [`Self::size`] long.
    pub(crate) fn scatter(&self, bytes: &[u8], mut store: impl FnMut(Target, &[u8])) {
        for field in &self.fields {
            if let Some(range) = field.bytes() {
                store(field.target, &bytes[range]);
            } else {
                let (value, size) = bits::extract(bytes, field.offset.into(), field.bits);
                store(field.target, &value[..size]);
            }
        }
    }

    /// Fills `bytes`, which is at least [`Self::size`] long, with the objects that `load` delivers; gaps stay as they are.
    pub(crate) fn gather(&self, bytes: &mut [u8], mut load: impl FnMut(Target, &mut [u8; MAX_VALUE_SIZE])) {
        for field in &self.fields {
            let mut value = [0; MAX_VALUE_SIZE];
            load(field.target, &mut value);
            if let Some(range) = field.bytes() {
                let size = range.len();
                bytes[range].copy_from_slice(&value[..size]);
            } else {
                bits::insert(bytes, field.offset.into(), field.bits, value);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::vec::Vec as List;

    proptest! {
        #[test]
        fn fields_of_any_width_at_any_offset_come_back_bit_by_bit(
            widths in proptest::collection::vec((1_u8..=64, any::<bool>(), any::<u64>()), 1..30),
        ) {
            let mut image = Image::default();
            let mut expected = List::new();
            let mut model = List::<bool>::new();
            for (position, &(bits, gap, value)) in widths.iter().enumerate() {
                let target = if gap { Target::Gap } else { Target::Application(position as u16) };
                prop_assert!(image.append(target, bits).is_some());
                let value = if gap { 0 } else { value & ((1_u128 << bits) - 1) as u64 };
                model.extend((0..bits).map(|bit| value >> bit & 1 == 1));
                if !gap {
                    expected.push((target, value));
                }
            }
            prop_assert_eq!(image.size(), model.len().div_ceil(8));

            let mut bytes = std::vec![0; image.size()];
            let mut values = expected.iter();
            image.gather(&mut bytes, |target, out| {
                let &(listed, value) = values.next().unwrap();
                assert_eq!(listed, target);
                *out = value.to_le_bytes();
            });
            for (bit, &set) in model.iter().enumerate() {
                prop_assert_eq!(bytes[bit / 8] >> (bit % 8) & 1 == 1, set, "bit {}", bit);
            }

            let mut found = List::new();
            image.scatter(&bytes, |target, data| {
                let mut value = [0; 8];
                value[..data.len()].copy_from_slice(data);
                found.push((target, u64::from_le_bytes(value)));
            });
            prop_assert_eq!(found, expected);
        }
    }

    #[test]
    fn an_image_does_not_grow_beyond_its_memory() {
        let mut image = Image::default();
        while image.append(Target::Gap, 255).is_some() {}
        assert!(image.size() <= MAX_PROCESS_DATA);
    }
}
