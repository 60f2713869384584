//! Digital outputs: function, polarity and the custom state (manual 1.3.2, 2.2.5, 2.2.6, 2.3.24).

use board::{OUTPUT_COUNT, OutputLevels};

use crate::objects::DriveObjects;

/// What outputs can tell.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Indications {
    /// There is a fault.
    pub alarm: bool,
    /// The brake is to be open, because the motor holds the shaft.
    pub brake_open: bool,
    /// The motor stands where it was sent.
    pub in_place: bool,
}

/// Functions of outputs, the values of 0x2005 but for 0, custom.
const ALARM: u16 = 1;
const BRAKE: u16 = 2;
const IN_PLACE: u16 = 3;

/// Whether some output leads to a brake.
pub fn has_brake(objects: &DriveObjects) -> bool {
    functions(objects).contains(&BRAKE)
}

/// Which output transistors conduct: those whose function is active, if normally open, the others, if normally closed.
pub fn levels(indications: Indications, objects: &DriveObjects) -> OutputLevels {
    let custom = (objects.physical_outputs & objects.output_mask) >> 16;
    let mut active = 0;
    for (number, function) in functions(objects).into_iter().enumerate() {
        let is_active = match function {
            ALARM => indications.alarm,
            BRAKE => indications.brake_open,
            IN_PLACE => indications.in_place,
            _ => custom >> number & 1 == 1,
        };
        active |= u8::from(is_active) << number;
    }
    let normally_open = objects.output_polarity as u8;
    OutputLevels(!(active ^ normally_open) & MASK)
}

/// The value of 0x204A for these levels: 0 stands for an output that conducts (manual 2.2.23).
pub const fn output_level(levels: OutputLevels) -> u16 {
    (!levels.0 & MASK) as u16
}

const fn functions(objects: &DriveObjects) -> [u16; OUTPUT_COUNT] {
    [objects.output_1_function, objects.output_2_function]
}

const MASK: u8 = (1 << OUTPUT_COUNT) - 1;

#[cfg(test)]
mod tests {
    use super::*;

    // manual: 1.3.2/open 2.2.23/level
    #[test]
    fn by_default_alarm_is_on_out1_and_brake_on_out2() {
        let objects = DriveObjects::new();
        let alarm = Indications {
            alarm: true,
            ..Indications::default()
        };
        let brake = Indications {
            brake_open: true,
            ..Indications::default()
        };
        assert_eq!(levels(Indications::default(), &objects), OutputLevels(0b00));
        assert_eq!(levels(alarm, &objects), OutputLevels(0b01));
        assert_eq!(levels(brake, &objects), OutputLevels(0b10));
        assert_eq!(output_level(OutputLevels(0b10)), 0b01);
    }

    // manual: 1.3.2/settings 2.2.6/polarity
    #[test]
    fn a_normally_closed_output_conducts_while_its_function_is_not_active() {
        let mut objects = DriveObjects::new();
        objects.output_polarity = 0b10;
        objects.output_1_function = 3;
        let in_place = Indications {
            in_place: true,
            ..Indications::default()
        };
        assert_eq!(levels(Indications::default(), &objects), OutputLevels(0b01));
        assert_eq!(levels(in_place, &objects), OutputLevels(0b00));
    }

    // manual: 2.2.5/custom 2.3.24/outputs 2.3.24/mask 2.3.24/reserved
    #[test]
    fn a_custom_output_follows_its_bit_only_through_the_mask() {
        let mut objects = DriveObjects::new();
        (objects.output_1_function, objects.output_2_function) = (0, 0);
        objects.physical_outputs = 0x0003_0000;
        assert_eq!(levels(Indications::default(), &objects), OutputLevels(0));
        objects.output_mask = 0x0002_0000;
        assert_eq!(levels(Indications::default(), &objects), OutputLevels(0b10));
        objects.physical_outputs = 0x0001_FFFF;
        assert_eq!(levels(Indications::default(), &objects), OutputLevels(0));
        (objects.physical_outputs, objects.output_mask) = (!0x0003_0000, !0);
        assert_eq!(levels(Indications::default(), &objects), OutputLevels(0), "reserved bits");
    }

    // manual: 2.2.5/custom 2.2.6/polarity
    #[test]
    fn with_0x60fe_left_at_0_polarity_alone_switches_a_custom_output() {
        let mut objects = DriveObjects::new();
        (objects.output_1_function, objects.output_2_function) = (0, 0);
        for (polarity, conducting) in [(0b11, 0b00), (0b10, 0b01), (0b01, 0b10), (0b00, 0b11)] {
            objects.output_polarity = polarity;
            assert_eq!(levels(Indications::default(), &objects), OutputLevels(conducting));
        }
    }
}
