//! What an object or an entry is.

use dictionary::{AbortCode, Access, DataType, Entry, MAX_VALUE_SIZE, unit};
use wire::Nanos;
use wire::coe::Address;
use wire::coe::information::{ENTRY_SIZE, value_info};

use super::Data;
use crate::application::Application;
use crate::communication_area::CommunicationArea;
use crate::complete_access::entries;
use crate::configuration::Configuration;
use crate::device_objects::{APPLICATION, DeviceObjects, Located, load, locate};
use crate::objects::{self, COUNT_NAME};

/// The data of the description of the object at `index`. A name that does not fit is cut off, for some masters take one message only.
///
/// # Errors
/// 0x06020000 for an object that does not exist.
pub(super) fn object(index: u16, application: &'static [Entry], room: usize) -> Result<Data, AbortCode> {
    let entries = entries(index, application);
    let last = entries.last().ok_or(AbortCode::ObjectNotFound)?;
    let kind = objects::kind(entries);
    let mut data = Data::new();
    put(&mut data, &index.to_le_bytes());
    put(&mut data, &kind.data_type.to_le_bytes());
    put(&mut data, &[last.sub, kind.code as u8]);
    put_name(&mut data, last.object, room);
    Ok(data)
}

/// What is known of one entry, or of a sub-index 0 that is derived.
struct Known {
    name: &'static str,
    data_type: DataType,
    bits: u16,
    access: Access,
    unit: Option<u32>,
    /// Default, smallest and largest value.
    values: Option<[i64; 3]>,
}

/// The data of the description of an entry, with those of unit and values asked for that there are and that fit.
///
/// # Errors
/// 0x06020000 for an object that does not exist, 0x06090011 for such a sub-index.
pub(super) fn entry(
    index: u16,
    sub: u8,
    asked: u8,
    objects: &DeviceObjects<'_, impl Application>,
    configuration: &Configuration,
    room: usize,
) -> Result<Data, AbortCode> {
    let known = known(Address { index, sub }, objects, configuration)?;
    let size = usize::from(known.bits.div_ceil(8));
    let mut answered = asked & (value_info::ACCESS | value_info::MAPPABLE);
    let mut values = Data::new();
    let mut add = |flag, value: &[u8]| {
        if asked & flag != 0 && ENTRY_SIZE + values.len() + value.len() <= room {
            put(&mut values, value);
            answered |= flag;
        }
    };
    if let Some(unit) = known.unit {
        add(value_info::UNIT, &unit.to_le_bytes());
    }
    let flags = [value_info::DEFAULT, value_info::MINIMUM, value_info::MAXIMUM];
    for (flag, value) in flags.into_iter().zip(known.values.into_iter().flatten()) {
        add(flag, &bytes(value, known.data_type)[..size]);
    }
    let mut data = Data::new();
    put(&mut data, &index.to_le_bytes());
    put(&mut data, &[sub, answered]);
    for word in [known.data_type.code(), known.bits, known.access.bits()] {
        put(&mut data, &word.to_le_bytes());
    }
    put(&mut data, &values);
    put_name(&mut data, known.name, room);
    Ok(data)
}

fn known(address: Address, objects: &DeviceObjects<'_, impl Application>, configuration: &Configuration) -> Result<Known, AbortCode> {
    let located = locate(address.index, address.sub, objects.application.entries())?;
    let entry = match located {
        Located::Application(_, entry) | Located::Fixed(_, entry) | Located::Own(entry) => entry,
        Located::Count(count) => {
            return Ok(Known {
                name: COUNT_NAME,
                data_type: DataType::Unsigned8,
                bits: 8,
                access: Access::RO,
                unit: None,
                values: Some([i64::from(count); 3]),
            });
        }
    };
    let is_string = entry.data_type == DataType::VisibleString;
    let length = if is_string {
        load(objects.area, objects.application, address, objects.now)?.len()
    } else {
        0
    };
    let default = if entry.index < APPLICATION {
        at_delivery(located, configuration)
    } else {
        entry.default
    };
    Ok(Known {
        name: entry.name,
        data_type: entry.data_type,
        bits: if is_string { 8 * length as u16 } else { entry.bits },
        access: entry.access,
        unit: unit::code(entry.unit),
        values: entry.data_type.bits().is_some().then_some([default, entry.min, entry.max]),
    })
}

/// The value of one of the stack's own entries at delivery; entries behind the count of a list are 0.
fn at_delivery(located: Located, configuration: &Configuration) -> i64 {
    let new = CommunicationArea::new(configuration);
    let mut value = [0; MAX_VALUE_SIZE];
    match located {
        Located::Fixed(slot, _) => _ = new.load_fixed(slot, 0, Nanos(0), &mut value),
        Located::Own(entry) => {
            let bytes = new.load(entry).unwrap_or_default();
            let size = bytes.len().min(MAX_VALUE_SIZE);
            value[..size].copy_from_slice(&bytes[..size]);
        }
        Located::Application(..) | Located::Count(_) => {}
    }
    i64::from_le_bytes(value)
}

/// A value of a table on the wire. An `i64` does not hold the largest UNSIGNED64, so its own largest value stands for it.
fn bytes(value: i64, data_type: DataType) -> [u8; MAX_VALUE_SIZE] {
    if data_type == DataType::Unsigned64 && value == i64::MAX {
        [0xFF; MAX_VALUE_SIZE]
    } else {
        value.to_le_bytes()
    }
}

/// Appends bytes; all descriptions are far shorter than the longest mailbox.
fn put(data: &mut Data, bytes: &[u8]) {
    let _ = data.extend_from_slice(bytes);
}

/// Appends as much of a name as fits.
fn put_name(data: &mut Data, name: &str, room: usize) {
    let left = room.saturating_sub(data.len());
    put(data, &name.as_bytes()[..name.len().min(left)]);
}
