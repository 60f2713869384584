//! What a drive says of itself, as lines for people.

use std::ops::Deref;

use ethercrab::error::Error;
use ethercrab::{SubDevice, SubDeviceRef};

use super::sdo::{self, Address};

/// Name and identity, as the SII has them.
pub fn identity<S: Deref<Target = SubDevice>>(drive: &SubDeviceRef<'_, S>) -> String {
    let identity = drive.identity();
    format!(
        "{}: vendor 0x{:08X}, product 0x{:08X}, revision 0x{:08X}, serial number {}",
        drive.name(),
        identity.vendor_id,
        identity.product_id,
        identity.revision,
        identity.serial
    )
}

/// The assigned PDOs with their entries, read through the mailbox.
///
/// # Errors
/// The drive refuses to tell.
pub async fn mapping<S: Deref<Target = SubDevice>>(drive: &SubDeviceRef<'_, S>) -> Result<Vec<String>, Error> {
    let mut lines = Vec::new();
    for (assignment, direction) in [(0x1C12, "RxPDO"), (0x1C13, "TxPDO")] {
        for number in 1..=drive.sdo_read::<u8>(assignment, 0).await? {
            let pdo: u16 = drive.sdo_read(assignment, number).await?;
            lines.push(format!("{direction} 0x{pdo:04X}: {}", entries(drive, pdo).await?));
        }
    }
    Ok(lines)
}

async fn entries<S: Deref<Target = SubDevice>>(drive: &SubDeviceRef<'_, S>, pdo: u16) -> Result<String, Error> {
    let mut entries = Vec::new();
    for number in 1..=drive.sdo_read::<u8>(pdo, 0).await? {
        let mapping: u32 = drive.sdo_read(pdo, number).await?;
        let address = Address {
            index: (mapping >> 16) as u16,
            sub: (mapping >> 8) as u8,
        };
        let name = address.entry().map_or("", |entry| entry.name);
        let bits = mapping & 0xFF;
        entries.push(match address.index {
            0 => format!("gap of {bits} bits"),
            _ => format!("{address} {name} ({bits} bits)"),
        });
    }
    Ok(if entries.is_empty() { "empty".into() } else { entries.join(", ") })
}

/// The value at `address` with its name, for people.
///
/// # Errors
/// What the drive or the bus answered instead.
pub async fn value<S: Deref<Target = SubDevice>>(drive: &SubDeviceRef<'_, S>, address: Address) -> Result<String, Error> {
    let bytes = sdo::read(drive, address).await?;
    let name = address.entry().map_or(String::new(), |entry| format!(" {}", entry.name));
    Ok(format!("{address}{name} = {}", sdo::show(&bytes, address.data_type())))
}
