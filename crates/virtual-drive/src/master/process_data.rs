//! The drive's default process data, 1600 and 1A00, and the words in them.

/// Length of the default outputs in bytes.
pub const OUTPUT_LENGTH: usize = 7;
/// Length of the default inputs in bytes.
pub const INPUT_LENGTH: usize = 11;

/// Modes of operation (manual 2.3.4).
pub mod mode {
    /// Profile position.
    pub const PROFILE_POSITION: i8 = 1;
    /// Profile velocity.
    pub const PROFILE_VELOCITY: i8 = 3;
    /// Homing.
    pub const HOMING: i8 = 6;
    /// Cyclic synchronous position.
    pub const CYCLIC_POSITION: i8 = 8;
}

/// Commands and bits of the controlword (manual 2.3.2, 2.4.2).
pub mod controlword {
    /// Transition to Ready To Switch On.
    pub const SHUTDOWN: u16 = 0x0006;
    /// Transition to Switched On.
    pub const SWITCH_ON: u16 = 0x0007;
    /// Transition to Operation Enabled.
    pub const ENABLE_OPERATION: u16 = 0x000F;
    /// New set-point, or start of homing.
    pub const START: u16 = 0x0010;
    /// The set-point takes effect at once.
    pub const IMMEDIATELY: u16 = 0x0020;
    /// The set-point is relative.
    pub const RELATIVE: u16 = 0x0040;
    /// Fault reset, with its rising edge.
    pub const FAULT_RESET: u16 = 0x0080;
    /// Halt.
    pub const HALT: u16 = 0x0100;
    /// The next set-point is passed into without a stop.
    pub const CHANGE_ON_SET_POINT: u16 = 0x0200;
}

/// Bits of the statusword (manual 2.3.3).
pub mod statusword {
    /// A fault is active.
    pub const FAULT: u16 = 1 << 3;
    /// Target reached.
    pub const TARGET_REACHED: u16 = 1 << 10;
    /// Internal limit: a limit switch is active.
    pub const INTERNAL_LIMIT: u16 = 1 << 11;
    /// Set-point acknowledge, homing attained, or drive follows the command value.
    pub const ACKNOWLEDGE: u16 = 1 << 12;
    /// Homing error.
    pub const HOMING_ERROR: u16 = 1 << 13;

    /// Whether the power state is Operation Enabled.
    pub const fn is_enabled(word: u16) -> bool {
        word & 0x6F == 0x27
    }
}

/// What the master sends each cycle.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Outputs {
    /// 0x6040.
    pub controlword: u16,
    /// 0x6060.
    pub mode: i8,
    /// 0x607A in pulses.
    pub target_position: i32,
}

impl Outputs {
    /// Puts the outputs into the drive's part of the process data.
    pub fn put(&self, bytes: &mut [u8]) {
        if let Some(bytes) = bytes.first_chunk_mut::<OUTPUT_LENGTH>() {
            bytes[..2].copy_from_slice(&self.controlword.to_le_bytes());
            bytes[2] = self.mode as u8;
            bytes[3..].copy_from_slice(&self.target_position.to_le_bytes());
        }
    }
}

/// What the master receives each cycle.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Inputs {
    /// 0x6041.
    pub statusword: u16,
    /// 0x6061.
    pub mode: i8,
    /// 0x6064 in pulses.
    pub position: i32,
    /// 0x60FD.
    pub digital_inputs: u32,
}

impl Inputs {
    /// Takes the inputs from the drive's part of the process data; all zero if that is shorter.
    pub fn take(bytes: &[u8]) -> Self {
        let Some(&[s0, s1, mode, p0, p1, p2, p3, d0, d1, d2, d3]) = bytes.first_chunk::<INPUT_LENGTH>() else {
            return Self::default();
        };
        Self {
            statusword: u16::from_le_bytes([s0, s1]),
            mode: mode as i8,
            position: i32::from_le_bytes([p0, p1, p2, p3]),
            digital_inputs: u32::from_le_bytes([d0, d1, d2, d3]),
        }
    }
}

/// The controlword that leads one step closer to Operation Enabled from the power state a statusword shows.
///
/// A fault is reset with a rising edge, so bit 7 is given only every other time: `was` is the controlword before.
pub fn towards_enabled(statusword: u16, was: u16) -> u16 {
    match statusword & 0x6F {
        0x21 => controlword::SWITCH_ON,
        0x23 | 0x27 => controlword::ENABLE_OPERATION,
        _ if statusword & 0x4F == 0x08 && was & controlword::FAULT_RESET == 0 => controlword::FAULT_RESET,
        _ if statusword & 0x4F == 0x08 => 0,
        _ => controlword::SHUTDOWN,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn process_data_lie_as_the_default_mapping_says() {
        let mut bytes = [0; OUTPUT_LENGTH];
        Outputs {
            controlword: 0x010F,
            mode: mode::CYCLIC_POSITION,
            target_position: -2,
        }
        .put(&mut bytes);
        assert_eq!(bytes, [0x0F, 0x01, 8, 0xFE, 0xFF, 0xFF, 0xFF]);
        let inputs = Inputs::take(&[0x37, 0x16, 8, 0xFE, 0xFF, 0xFF, 0xFF, 1, 0, 4, 0]);
        assert_eq!(
            inputs,
            Inputs {
                statusword: 0x1637,
                mode: 8,
                position: -2,
                digital_inputs: 0x0004_0001
            }
        );
        assert_eq!(Inputs::take(&[1; 10]), Inputs::default());
    }

    #[test]
    fn each_power_state_is_led_one_step_on() {
        for (status, was, word) in [
            (0x0250, 0, controlword::SHUTDOWN),
            (0x0231, 6, controlword::SWITCH_ON),
            (0x0233, 7, controlword::ENABLE_OPERATION),
            (0x0237, 15, controlword::ENABLE_OPERATION),
            (0x0218, 15, controlword::FAULT_RESET),
            (0x0218, 0x80, 0),
            (0x0217, 15, controlword::SHUTDOWN),
        ] {
            assert_eq!(towards_enabled(status, was), word, "statusword {status:#06x}");
        }
    }
}
