//! Values at any bit of an image: process data and complete access.

use dictionary::MAX_VALUE_SIZE;

/// The bytes that `bits` bits from bit `offset` on touch, and the place and mask of these bits in them as one little-endian number.
fn window(offset: usize, bits: u8) -> (core::ops::Range<usize>, u32, u128) {
    let end = offset + usize::from(bits);
    (offset / 8..end.div_ceil(8), (offset % 8) as u32, (1_u128 << bits) - 1)
}

/// The value of at most 64 bits at `offset`, and its size in bytes.
pub(crate) fn extract(bytes: &[u8], offset: usize, bits: u8) -> ([u8; MAX_VALUE_SIZE], usize) {
    let (range, shift, mask) = window(offset, bits);
    let mut number = [0; 16];
    number[..range.len()].copy_from_slice(&bytes[range]);
    let value = (u128::from_le_bytes(number) >> shift) & mask;
    ((value as u64).to_le_bytes(), usize::from(bits.div_ceil(8)))
}

/// Replaces the value of at most 64 bits at `offset` and leaves the bits around it.
pub(crate) fn insert(bytes: &mut [u8], offset: usize, bits: u8, value: [u8; MAX_VALUE_SIZE]) {
    let (range, shift, mask) = window(offset, bits);
    let size = range.len();
    let mut number = [0; 16];
    number[..size].copy_from_slice(&bytes[range.clone()]);
    let kept = u128::from_le_bytes(number) & !(mask << shift);
    let merged = kept | (u128::from(u64::from_le_bytes(value)) & mask) << shift;
    bytes[range].copy_from_slice(&merged.to_le_bytes()[..size]);
}
