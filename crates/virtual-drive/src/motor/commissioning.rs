//! What a drive has to be told about its motor: what somebody writes who commissions it.

use drive::DriveObjects;
use plant::{MotorParameters, Phases};

/// Values for the objects that depend on the motor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Commissioning {
    /// 0x2000 in mA: the motor's rated current, as far as the drive gives it.
    pub peak_current: u16,
    /// 0x200C:01: 0 two phases, 1 three.
    pub motor_type: u16,
    /// 0x200C:06 in mV s/rad.
    pub bemf_coefficient: u16,
}

impl Commissioning {
    /// For a motor with a current's peak in A, each value within its object's range.
    pub fn of(motor: &MotorParameters, current: f64) -> Self {
        Self {
            peak_current: (current * 1e3).round().clamp(100.0, 6000.0) as u16,
            motor_type: (motor.phases == Phases::Three).into(),
            bemf_coefficient: (motor.back_emf * 1e3).round().clamp(0.0, 1000.0) as u16,
        }
    }

    /// The same as downloads: address and value.
    pub fn downloads(&self) -> [(&'static str, [u8; 2]); 3] {
        [
            ("2000", self.peak_current.to_le_bytes()),
            ("200C:1", self.motor_type.to_le_bytes()),
            ("200C:6", self.bemf_coefficient.to_le_bytes()),
        ]
    }

    /// Writes them into a drive's objects.
    pub fn write(&self, objects: &mut DriveObjects) {
        objects.peak_current = self.peak_current;
        objects.motor_type = self.motor_type;
        objects.bemf_coefficient = self.bemf_coefficient;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use plant::motors;

    #[test]
    fn a_motor_of_three_phases_is_told_with_its_current_and_its_back_emf() {
        let told = Commissioning::of(&motors::THREE_PHASE_57, 5.8);
        let downloads = [("2000", [0xA8, 0x16]), ("200C:1", [1, 0]), ("200C:6", [172, 0])];
        assert_eq!(told.downloads(), downloads);
    }

    #[test]
    fn what_is_beyond_the_drive_is_told_as_its_most() {
        assert_eq!(Commissioning::of(&motors::QSH5718_56, 9.0).peak_current, 6000);
    }
}
