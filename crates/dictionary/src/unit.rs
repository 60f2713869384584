//! Units as numbers: power of ten, numerator and denominator (ETG.1004; CiA 303-2, notation indices).

/// Notation indices of CiA 303-2 and, for turns and pulses, of CiA 402.
mod notation {
    pub(super) const NONE: u8 = 0x00;
    pub(super) const SECOND: u8 = 0x03;
    pub(super) const AMPERE: u8 = 0x04;
    pub(super) const VOLT: u8 = 0x26;
    pub(super) const OHM: u8 = 0x28;
    pub(super) const HENRY: u8 = 0x2C;
    pub(super) const MINUTE: u8 = 0x47;
    pub(super) const SQUARE_SECOND: u8 = 0x57;
    pub(super) const REVOLUTION: u8 = 0xB4;
    pub(super) const INCREMENT: u8 = 0xB5;
}

use notation::*;

/// A unit as tables write it: power of ten, numerator, denominator.
const UNITS: [(&str, i8, u8, u8); 14] = [
    ("ns", -9, SECOND, NONE),
    ("us", -6, SECOND, NONE),
    ("ms", -3, SECOND, NONE),
    ("mA", -3, AMPERE, NONE),
    ("10mV", -2, VOLT, NONE),
    ("mOhm", -3, OHM, NONE),
    ("mH", -3, HENRY, NONE),
    // Parts of a hundred and of a thousand are numbers.
    ("%", -2, NONE, NONE),
    ("0.1%", -3, NONE, NONE),
    ("RPM", 0, REVOLUTION, MINUTE),
    ("Pulse", 0, INCREMENT, NONE),
    ("Pulse/s", 0, INCREMENT, SECOND),
    ("Pulse/s2", 0, INCREMENT, SQUARE_SECOND),
    ("Pulse/rev", 0, INCREMENT, REVOLUTION),
];

/// The number of a unit: prefix in bits 31:24 as a signed power of ten, numerator in 23:16, denominator in 15:8.
///
/// `None` for no unit, and for one that is not written so: steps of 50 us are no power of ten of anything.
pub fn code(unit: &str) -> Option<u32> {
    let (_, exponent, numerator, denominator) = UNITS.iter().find(|(name, ..)| *name == unit)?;
    Some(u32::from_be_bytes([*exponent as u8, *numerator, *denominator, 0]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_have_the_numbers_that_other_drives_publish() {
        for (unit, number) in [
            ("RPM", Some(0x00B4_4700)),
            ("10mV", Some(0xFE26_0000)),
            ("mA", Some(0xFD04_0000)),
            ("us", Some(0xFA03_0000)),
            ("Pulse/s", Some(0x00B5_0300)),
            ("0.1%", Some(0xFD00_0000)),
            ("50us", None),
            ("", None),
        ] {
            assert_eq!(code(unit), number, "{unit}");
        }
    }
}
