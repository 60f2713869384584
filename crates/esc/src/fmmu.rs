//! The FMMUs' settings and their arithmetic of bits (ESC data sheet, section I, 7).

use core::ops::Range;

use wire::register::{FMMU, FMMU_SIZE};

use crate::registers::{FMMUS, Registers};

/// An active FMMU: `bits` bits from bit `logical_bit` of byte `logical` on are those from `physical_bit` of byte `physical` on.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Fmmu {
    logical: u32,
    length: u16,
    logical_bit: u8,
    physical_bit: u8,
    physical: u16,
    bits: u32,
    /// Whether the bus reads through it.
    pub(crate) reads: bool,
    /// Whether the bus writes through it.
    pub(crate) writes: bool,
}

/// The part of one logical byte that an FMMU maps: `width` bits from bit `low` on, to be found from bit `shift` of byte `address` on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Span {
    pub(crate) low: u32,
    pub(crate) width: u32,
    pub(crate) address: u32,
    pub(crate) shift: u32,
}

impl Span {
    /// The mapped bits within the logical byte.
    pub(crate) const fn mask(self) -> u8 {
        ((0xFF_u32 >> (8 - self.width)) << self.low) as u8
    }

    /// The mapped bits within the two physical bytes.
    pub(crate) const fn physical_mask(self) -> [u8; 2] {
        (((0xFF_u32 >> (8 - self.width)) << self.shift) as u16).to_le_bytes()
    }

    /// Moves bits of the logical byte to where they are in the two physical bytes.
    pub(crate) const fn to_physical(self, logical: u8) -> [u8; 2] {
        ((((logical & self.mask()) as u32 >> self.low) << self.shift) as u16).to_le_bytes()
    }

    /// Moves bits of the two physical bytes to where they are in the logical byte.
    pub(crate) const fn to_logical(self, physical: [u8; 2]) -> u8 {
        (((u16::from_le_bytes(physical) as u32 >> self.shift) << self.low) as u8) & self.mask()
    }
}

impl Fmmu {
    /// Decodes one FMMU's registers; `None` if it is inactive or maps nothing.
    pub(crate) fn decode(registers: [u8; FMMU_SIZE as usize]) -> Option<Self> {
        let [l0, l1, l2, l3, n0, n1, start, stop, p0, p1, physical_bit, kind, activate, ..] = registers;
        let length = u16::from_le_bytes([n0, n1]);
        let (start, stop) = (start & 7, stop & 7);
        let bits = (u32::from(length) * 8 + u32::from(stop) + 1).checked_sub(8 + u32::from(start))?;
        (activate & 1 != 0 && length != 0 && bits != 0).then_some(Self {
            logical: u32::from_le_bytes([l0, l1, l2, l3]),
            length,
            logical_bit: start,
            physical_bit: physical_bit & 7,
            physical: u16::from_le_bytes([p0, p1]),
            bits,
            reads: kind & 1 != 0,
            writes: kind & 2 != 0,
        })
    }

    fn logical_range(&self) -> Range<u64> {
        u64::from(self.logical)..u64::from(self.logical) + u64::from(self.length)
    }

    /// What a datagram of `count` bytes from `logical` on has in common with the FMMU.
    pub(crate) fn overlap(&self, logical: u32, count: usize) -> Option<Overlap> {
        let own = self.logical_range();
        let start = own.start.max(u64::from(logical));
        let end = own.end.min(u64::from(logical) + count as u64);
        (start < end).then(|| Overlap {
            data: (start - u64::from(logical)) as usize..(end - u64::from(logical)) as usize,
            first: (start - own.start) as u32,
        })
    }

    /// Whether logical and physical bytes are the same, all of them.
    pub(crate) fn is_bytewise(&self) -> bool {
        self.logical_bit == 0 && self.physical_bit == 0 && self.bits == u32::from(self.length) * 8
    }

    /// The physical address of logical byte `index` of a bytewise FMMU.
    pub(crate) fn address(&self, index: u32) -> u32 {
        u32::from(self.physical) + index
    }

    /// The mapped part of logical byte `index`, which must be less than the length.
    pub(crate) fn span(&self, index: u32) -> Span {
        let low = if index == 0 { u32::from(self.logical_bit) } else { 0 };
        let first = index * 8 + low - u32::from(self.logical_bit);
        let at = u32::from(self.physical_bit) + first;
        Span {
            low,
            width: (self.bits - first).min(8 - low),
            address: u32::from(self.physical) + at / 8,
            shift: at % 8,
        }
    }

    fn physical_range(&self) -> Range<u32> {
        let bits = u32::from(self.physical_bit) + self.bits;
        u32::from(self.physical)..u32::from(self.physical) + bits.div_ceil(8)
    }

    fn is_entangled_with(&self, other: &Self) -> bool {
        let logical = intersect(&self.logical_range(), &other.logical_range());
        let physical = intersect(&self.physical_range(), &other.physical_range());
        let same_direction = self.reads && other.reads || self.writes && other.writes;
        let changes = self.writes && (other.reads || other.writes) || other.writes && self.reads;
        logical && same_direction || physical && changes
    }
}

fn intersect<T: PartialOrd>(a: &Range<T>, b: &Range<T>) -> bool {
    a.start < b.end && b.start < a.end
}

/// What a datagram and an FMMU have in common.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Overlap {
    /// Bytes of the datagram's data.
    pub(crate) data: Range<usize>,
    /// The FMMU's byte that corresponds to the first of them.
    pub(crate) first: u32,
}

/// The active FMMUs of a chip, in the order of their numbers.
#[derive(Clone, Debug)]
pub(crate) struct Fmmus {
    active: [Fmmu; FMMUS],
    count: usize,
    entangled: bool,
}

impl Fmmus {
    /// None active.
    pub(crate) fn new() -> Self {
        Self {
            active: [Fmmu::default(); FMMUS],
            count: 0,
            entangled: false,
        }
    }

    /// Takes over all FMMU registers.
    pub(crate) fn configure(&mut self, registers: &Registers) {
        self.count = 0;
        for index in 0..FMMUS as u16 {
            if let Some(fmmu) = Fmmu::decode(registers.bytes(FMMU + index * FMMU_SIZE)) {
                self.active[self.count] = fmmu;
                self.count += 1;
            }
        }
        let active = &self.active[..self.count];
        let within_one = active.iter().any(|fmmu| fmmu.reads && fmmu.writes);
        let between_two = (1..active.len()).any(|i| active[..i].iter().any(|other| active[i].is_entangled_with(other)));
        self.entangled = within_one || between_two;
    }

    /// The active FMMUs.
    pub(crate) fn active(&self) -> &[Fmmu] {
        &self.active[..self.count]
    }

    /// Whether the order in which bytes pass the FMMUs matters, because two of one direction map the same logical byte, or one
    /// writes a physical byte that another maps too.
    pub(crate) const fn are_entangled(&self) -> bool {
        self.entangled
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn registers(logical: u32, length: u16, start: u8, stop: u8, physical: u16, physical_bit: u8) -> [u8; 16] {
        let mut bytes = [0; 16];
        bytes[..4].copy_from_slice(&logical.to_le_bytes());
        bytes[4..6].copy_from_slice(&length.to_le_bytes());
        bytes[6] = start;
        bytes[7] = stop;
        bytes[8..10].copy_from_slice(&physical.to_le_bytes());
        bytes[10] = physical_bit;
        bytes[11] = 1;
        bytes[12] = 1;
        bytes
    }

    #[test]
    fn the_data_sheets_example_maps_fourteen_bits() {
        let fmmu = Fmmu::decode(registers(0x0001_0011, 3, 3, 0, 0x0F01, 1)).unwrap();
        assert_eq!(fmmu.bits, 14);
        let span = |low, width, address, shift| Span {
            low,
            width,
            address,
            shift,
        };
        assert_eq!(fmmu.span(0), span(3, 5, 0x0F01, 1));
        assert_eq!(fmmu.span(1), span(0, 8, 0x0F01, 6));
        assert_eq!(fmmu.span(2), span(0, 1, 0x0F02, 6));
        assert_eq!(fmmu.physical_range(), 0x0F01..0x0F03);
    }

    #[test]
    fn spans_move_bits_both_ways() {
        for low in 0..8 {
            for width in 1..=8 - low {
                for shift in 0..8 {
                    let span = Span {
                        low,
                        width,
                        address: 0,
                        shift,
                    };
                    for value in 0..=255 {
                        let physical = span.to_physical(value);
                        assert_eq!(span.to_logical(physical), value & span.mask());
                        assert_eq!(physical[0] & !span.physical_mask()[0], 0);
                        assert_eq!(physical[1] & !span.physical_mask()[1], 0);
                    }
                    assert_eq!(span.mask().count_ones(), width);
                }
            }
        }
    }

    #[test]
    fn settings_that_map_nothing_are_inactive() {
        assert!(Fmmu::decode(registers(0, 0, 0, 7, 0x1000, 0)).is_none());
        assert!(Fmmu::decode(registers(0, 1, 5, 4, 0x1000, 0)).is_none());
        assert!(Fmmu::decode([0; 16]).is_none());
        assert!(Fmmu::decode([0xFF; 16]).is_some());
    }

    #[test]
    fn overlap_is_that_of_the_byte_ranges_even_at_the_end_of_the_address_space() {
        let fmmu = Fmmu::decode(registers(0xFFFF_FFFE, 8, 0, 7, 0x1000, 0)).unwrap();
        assert_eq!(fmmu.overlap(0xFFFF_FFFC, 4), Some(Overlap { data: 2..4, first: 0 }));
        assert_eq!(fmmu.overlap(0xFFFF_FFFF, 3), Some(Overlap { data: 0..3, first: 1 }));
        assert_eq!(fmmu.overlap(0xFFFF_FFFC, 2), None);
        assert_eq!(fmmu.overlap(0, 4), None);
    }
}
