//! What the stack asks of the device.

use dictionary::{AbortCode, Objects};
use wire::coe::Emergency;

/// A device's objects from 0x2000 on, and what the stack's own objects need from the device.
pub trait Application: Objects {
    /// The error register, 0x1001 (CiA 301).
    fn error_register(&self) -> u8;

    /// The fault that is present, as an emergency message would tell it; code 0 while there is none. When the code changes, the master is
    /// told.
    fn emergency(&self) -> Emergency;

    /// Saves all parameters: 1 was written to 0x1010:01.
    ///
    /// # Errors
    /// The abort code with which the download ends.
    fn store_parameters(&mut self) -> Result<(), AbortCode>;

    /// Restores the parameters of delivery: 1 was written to 0x1011:01.
    ///
    /// # Errors
    /// The abort code with which the download ends.
    fn restore_defaults(&mut self) -> Result<(), AbortCode>;

    /// Whether the device's present state allows to write the object in `slot`, by SDO or by PDO.
    ///
    /// # Errors
    /// The abort code with which a download ends; a PDO leaves the object as it is.
    fn may_write(&self, slot: usize) -> Result<(), AbortCode> {
        let _ = slot;
        Ok(())
    }
}
