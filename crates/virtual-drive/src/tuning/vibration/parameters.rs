//! The values as a file that the drive takes: lines of its `parameters.txt`, which leave all other objects alone.

use device::parameter_file;

use super::Values;
use crate::master::sdo::Address;

/// The file's text, with `heading` as comments before the values.
pub fn file(heading: &str, values: &Values) -> String {
    let mut text: String = heading.lines().flat_map(|line| ["# ", line, "\n"]).collect();
    for (index, value) in values.objects() {
        let entry = Address { index, sub: 0 }.entry();
        // A string takes everything, and the objects are the drive's own.
        _ = entry.map(|entry| parameter_file::write_line(&mut text, entry, value.into()));
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_has_its_heading_as_comments_and_a_line_for_each_object() {
        let values = Values {
            amplitude: 42,
            phase_a: 512,
            phase_b: 0,
        };
        assert_eq!(
            file("qsh5718-56\nat 36 V", &values),
            "# qsh5718-56\n# at 36 V\n\
             2060:00 = 42 # Amplitude of First Anti-Vibration\n\
             2061:00 = 512 # Phase A of First Anti-Vibration\n\
             2062:00 = 0 # Phase B of First Anti-Vibration\n"
        );
    }
}
