//! What may not be written at present, although the object table allows it.

use dictionary::AbortCode;

use crate::drive::Drive;
use crate::homing::Method;
use crate::modes::Mode;
use crate::objects::{DriveObjects, slots};
use crate::touch_probe;

impl Drive {
    /// Whether the present state forbids to write `data` into `slot`; length and range are the table's to check.
    ///
    /// # Errors
    /// The abort code of the download: 0x06090030 for a mode, a homing method, an option or a function that the drive does not have;
    /// 0x08000022 for the current loop's gains while the drive sets them itself, for another resolution or direction of rotation while
    /// the motor moves, and for clearing the position while it moves or is led by CSP.
    pub fn check_write(&self, objects: &DriveObjects, slot: usize, data: &[u8]) -> Result<(), AbortCode> {
        match (slot, data) {
            (slots::current_loop_kp | slots::current_loop_ki | slots::current_loop_kc, _) if objects.auto_pi != 0 => {
                Err(AbortCode::DeviceState)
            }
            (slots::mode, &[mode]) if mode != 0 && Mode::from_object(mode as i8).is_none() => Err(AbortCode::ValueRange),
            // Stops at the limit of current or voltage need a current reserve that is known, as only a closed loop has.
            (slots::quick_stop_option, &[3 | 4, 0]) => Err(AbortCode::ValueRange),
            (slots::homing_method, &[method]) if is_gap(method as i8) => Err(AbortCode::ValueRange),
            (slots::probe_function, &[low, high]) if !touch_probe::is_function(u16::from_le_bytes([low, high])) => {
                Err(AbortCode::ValueRange)
            }
            // In motion, either would be a jump in the speed of the shaft.
            (slots::resolution, &[low, high]) if self.is_moving() && u16::from_le_bytes([low, high]) != objects.resolution => {
                Err(AbortCode::DeviceState)
            }
            (slots::run_reverse, &[low, high]) if self.is_moving() && u16::from_le_bytes([low, high]) != objects.run_reverse => {
                Err(AbortCode::DeviceState)
            }
            (slots::zero_position, &[1, 0]) if !self.may_clear_position() => Err(AbortCode::DeviceState),
            _ => Ok(()),
        }
    }
}

/// Whether the drive has no such homing method although the range of 0x6098 spans it.
fn is_gap(method: i8) -> bool {
    let entry = &DriveObjects::ENTRIES[slots::homing_method];
    (entry.min..=entry.max).contains(&method.into()) && Method::lookup(method, 0).is_none()
}
