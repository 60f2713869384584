//! The mapping objects 0x1600.. and 0x1A00.. and the assignments 0x1C12 and 0x1C13 together.

use dictionary::{AbortCode, Entry, MAX_VALUE_SIZE, Value};
use heapless::Vec;

use super::image::Image;
use super::list::List;
use super::mapping::{self, Direction};
use crate::configuration::{Configuration, MAX_PROCESS_DATA};
use crate::objects::{MAX_MAPPING_ENTRIES, PDOS_PER_DIRECTION, RX_ASSIGNMENT, RX_MAPPING, TX_ASSIGNMENT, TX_MAPPING};

type Mapping = List<u32, MAX_MAPPING_ENTRIES>;

/// Mapping and assignment of one direction.
#[derive(Clone, Debug)]
struct Pdos {
    direction: Direction,
    first: u16,
    mappings: [Mapping; PDOS_PER_DIRECTION],
    assigned: List<u16, PDOS_PER_DIRECTION>,
}

/// Mapping and assignment of both directions.
#[derive(Clone, Debug)]
pub(crate) struct PdoConfiguration {
    rx: Pdos,
    tx: Pdos,
}

/// Which object of one direction an index names.
enum Object {
    Mapping(usize),
    Assignment,
}

impl PdoConfiguration {
    /// Everything as at delivery.
    pub(crate) fn new(configuration: &Configuration) -> Self {
        Self {
            rx: Pdos::new(Direction::Rx, RX_MAPPING, configuration.rx_assignment, configuration),
            tx: Pdos::new(Direction::Tx, TX_MAPPING, configuration.tx_assignment, configuration),
        }
    }

    /// Copies the value of a sub-index to `out` and returns its size in bytes.
    ///
    /// # Errors
    /// 0x06090011 for entries behind those that count.
    pub(crate) fn load(&self, index: u16, sub: u8, out: &mut [u8; MAX_VALUE_SIZE]) -> Result<usize, AbortCode> {
        let (pdos, object) = if let Some(object) = self.rx.object(index, RX_ASSIGNMENT) {
            (&self.rx, object)
        } else {
            (&self.tx, self.tx.object(index, TX_ASSIGNMENT).ok_or(AbortCode::ObjectNotFound)?)
        };
        match object {
            Object::Mapping(pdo) if sub == 0 => Ok(pdos.mappings[pdo].count().put(out)),
            Object::Mapping(pdo) => Ok(pdos.mappings[pdo].item(sub)?.put(out)),
            Object::Assignment if sub == 0 => Ok(pdos.assigned.count().put(out)),
            Object::Assignment => Ok(pdos.assigned.item(sub)?.put(out)),
        }
    }

    /// Replaces the value of a sub-index. A mapping may be rewritten while its PDO is assigned; only its own sub-index 0 must be 0.
    ///
    /// # Errors
    /// 0x06010003 while sub-index 0 is not zero; see [`mapping::resolve`] and the checks of sub-index 0 for the others.
    pub(crate) fn store(&mut self, index: u16, sub: u8, data: &[u8], application: &'static [Entry]) -> Result<(), AbortCode> {
        let (pdos, object) = if let Some(object) = self.rx.object(index, RX_ASSIGNMENT) {
            (&mut self.rx, object)
        } else {
            let object = self.tx.object(index, TX_ASSIGNMENT).ok_or(AbortCode::ObjectNotFound)?;
            (&mut self.tx, object)
        };
        match object {
            Object::Mapping(pdo) if sub == 0 => pdos.set_mapping_count(pdo, take(data)?, application),
            Object::Mapping(pdo) => pdos.set_mapping(pdo, sub, take(data)?, application),
            Object::Assignment if sub == 0 => pdos.set_assignment_count(take(data)?),
            Object::Assignment => pdos.assign(sub, take(data)?),
        }
    }

    /// The process image of the PDOs assigned in a direction; `None` if they do not make one up.
    pub(crate) fn image(&self, direction: Direction, application: &'static [Entry]) -> Option<Image> {
        let pdos = match direction {
            Direction::Rx => &self.rx,
            Direction::Tx => &self.tx,
        };
        let mut image = Image::default();
        let mut seen: Vec<u16, PDOS_PER_DIRECTION> = Vec::new();
        for &index in pdos.assigned.active() {
            if seen.contains(&index) || seen.push(index).is_err() {
                return None;
            }
            for &entry in pdos.mappings[pdos.position(index)?].active() {
                let target = mapping::resolve(entry, direction, application).ok()?;
                image.append(target, mapping::bits(entry))?;
            }
        }
        Some(image)
    }
}

impl Pdos {
    fn new(direction: Direction, first: u16, assigned: &[u16], configuration: &Configuration) -> Self {
        let entries = |pdo: usize| {
            let index = first + pdo as u16;
            configuration
                .mappings
                .iter()
                .find(|(listed, _)| *listed == index)
                .map_or(&[][..], |(_, entries)| *entries)
        };
        Self {
            direction,
            first,
            mappings: core::array::from_fn(|pdo| List::new(entries(pdo))),
            assigned: List::new(assigned),
        }
    }

    fn object(&self, index: u16, assignment: u16) -> Option<Object> {
        if index == assignment {
            Some(Object::Assignment)
        } else {
            self.position(index).map(Object::Mapping)
        }
    }

    /// Which of the direction's PDOs an index names.
    fn position(&self, index: u16) -> Option<usize> {
        let position = usize::from(index.checked_sub(self.first)?);
        (position < PDOS_PER_DIRECTION).then_some(position)
    }

    fn set_mapping(&mut self, pdo: usize, sub: u8, entry: u32, application: &'static [Entry]) -> Result<(), AbortCode> {
        self.mappings[pdo].check_item(sub)?;
        // Some masters clear the entries they do not use; such an entry must not count later.
        if entry != 0 {
            mapping::resolve(entry, self.direction, application)?;
        }
        self.mappings[pdo].set_item(sub, entry)
    }

    fn set_mapping_count(&mut self, pdo: usize, count: u8, application: &'static [Entry]) -> Result<(), AbortCode> {
        let entries = self.mappings[pdo].first(count).ok_or(AbortCode::PdoLengthExceeded)?;
        let mut total = 0_usize;
        for &entry in entries {
            mapping::resolve(entry, self.direction, application)?;
            total += usize::from(mapping::bits(entry));
        }
        if total > MAX_PROCESS_DATA * 8 {
            return Err(AbortCode::PdoLengthExceeded);
        }
        self.mappings[pdo].set_count(count);
        Ok(())
    }

    fn assign(&mut self, sub: u8, index: u16) -> Result<(), AbortCode> {
        self.assigned.check_item(sub)?;
        if index != 0 && self.position(index).is_none() {
            return Err(AbortCode::ValueRange);
        }
        self.assigned.set_item(sub, index)
    }

    fn set_assignment_count(&mut self, count: u8) -> Result<(), AbortCode> {
        let assigned = self.assigned.first(count).ok_or(AbortCode::ValueTooHigh)?;
        for (position, &index) in assigned.iter().enumerate() {
            if self.position(index).is_none() {
                return Err(AbortCode::ValueRange);
            }
            if assigned[..position].contains(&index) {
                return Err(AbortCode::ParameterIncompatible);
            }
        }
        self.assigned.set_count(count);
        Ok(())
    }
}

fn take<T: Value>(data: &[u8]) -> Result<T, AbortCode> {
    T::take(data).ok_or(AbortCode::LengthMismatch)
}
