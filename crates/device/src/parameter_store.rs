//! Where the set of parameters outlasts the power: wear-levelled logs in flash, of which a cut at any instant leaves the old set or the new.
//!
//! Each half of the memory is a log of its own, and sets go to the one and the other in turn: while one half is written or erased, and
//! whatever a cut makes of it, the other holds the set before. A set is one value of its log, so that it is never mixed. Sets are
//! numbered; behind each, its number goes to the other half as a seal. If there is a seal but no set of its number or a later one, the set
//! that was saved last has been damaged since: a cut leaves a set without its seal, never a seal without its set.

use dictionary::AbortCode;
use drive::DriveObjects;
use embedded_storage::nor_flash::NorFlash;
use sequential_storage::cache::{Cache, Uncached};
use sequential_storage::map::{MapConfig, MapStorage};

use crate::flash::{Immediate, at_once};
use crate::parameter_set::{self, Bytes, CAPACITY, FULL_SIZE};

/// Key of the set: its number, then its bytes.
const SET: u8 = 1;
/// Key of the seal: the number of the set before it.
const SEAL: u8 = 2;

const HALVES: [usize; 2] = [0, 1];
const KEY_SIZE: usize = 1;
const NUMBER_SIZE: usize = size_of::<u32>();
/// The smallest page that a log can have.
const MIN_PAGE: usize = 1024;

type Value = heapless::Vec<u8, { NUMBER_SIZE + CAPACITY }>;
/// Room for the longest value and its key, in whole words of any flash.
type Buffer = [u8; (KEY_SIZE + NUMBER_SIZE + CAPACITY).next_multiple_of(32)];
const EMPTY: Buffer = [0; size_of::<Buffer>()];

type Log<'a, M> = MapStorage<u8, Immediate<'a, M>, Cache<Uncached, Uncached, Uncached, u8>>;

/// The parameters cannot be trusted: fault 0x5530.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Damaged;

/// What the memory holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Contents {
    /// Nothing was ever saved to the end. What a first save has left that was cut off is to be erased.
    Nothing { erase: bool },
    /// The set that was saved last.
    Set { number: u32 },
    /// Something else; numbers up to this one may have been given.
    Damaged { last: u32 },
}

/// The objects at power-on: as they were saved, or those of delivery if nothing was. Writes nothing.
pub(crate) fn load(memory: &mut impl NorFlash) -> Result<DriveObjects, Damaged> {
    match examine(memory) {
        None | Some(Contents::Nothing { .. }) => Ok(DriveObjects::new()),
        Some(Contents::Damaged { .. }) => Err(Damaged),
        Some(Contents::Set { number }) => {
            let mut buffer = EMPTY;
            let log = log(Immediate::read_only(memory), half_of(number));
            let value = log.and_then(|mut log| fetch(&mut log, SET, &mut buffer)).ok_or(Damaged)?;
            parameter_set::read(value.get(NUMBER_SIZE..).ok_or(Damaged)?).map_err(|_| Damaged)
        }
    }
}

/// Makes `set` the one with which the next power-on begins.
///
/// # Errors
/// 0x08000020 without a memory that has room for it, 0x06060000 if the memory fails; the next power-on begins with the old set or the new.
pub(crate) fn save(memory: &mut impl NorFlash, set: &Bytes) -> Result<(), AbortCode> {
    let number = match examine(memory).ok_or(AbortCode::CannotStore)? {
        Contents::Set { number } | Contents::Damaged { last: number } => number.saturating_add(1),
        Contents::Nothing { erase } => {
            if erase {
                erase_half(memory, half_of(1));
            }
            1
        }
    };
    let mut value = Value::new();
    value
        .extend_from_slice(&number.to_le_bytes())
        .and_then(|()| value.extend_from_slice(set))
        .map_err(|_| AbortCode::CannotStore)?;
    let half = half_of(number);
    store(memory, half, SET, &value)?;
    store(memory, 1 - half, SEAL, &number.to_le_bytes())
}

/// The half of the memory to which the set with this number goes.
const fn half_of(number: u32) -> usize {
    1 - number as usize % 2
}

/// The log in one half of a memory; `None` if the memory has not two pages for each, of a size that suffices.
fn log<M: NorFlash>(memory: Immediate<'_, M>, half: usize) -> Option<Log<'_, M>> {
    use embedded_storage_async::nor_flash::ReadNorFlash;
    let pages = memory.capacity().checked_div(2 * M::ERASE_SIZE)?;
    let size = u32::try_from(pages * M::ERASE_SIZE).ok()?;
    let start = size.checked_mul(half as u32)?;
    let config = MapConfig::try_new(start..start.checked_add(size)?).ok()?;
    (M::ERASE_SIZE >= MIN_PAGE).then(|| MapStorage::new(memory, config, Cache::new_uncached()))
}

/// The last value of a log under `key`; `None` if there is none that can be read.
fn fetch<'b, M: NorFlash>(log: &mut Log<'_, M>, key: u8, buffer: &'b mut Buffer) -> Option<&'b [u8]> {
    at_once(log.fetch_item(buffer, &key))?.ok()?
}

/// Appends a value to a log and reads it back. A log that cannot take it, as a cut may have left it, is begun anew.
fn store(memory: &mut impl NorFlash, half: usize, key: u8, value: &[u8]) -> Result<(), AbortCode> {
    let mut buffer = EMPTY;
    for _ in 0..2 {
        let mut log = log(Immediate::writable(memory), half).ok_or(AbortCode::CannotStore)?;
        let stored = at_once(log.store_item(&mut buffer, &key, &value));
        if matches!(stored, Some(Ok(()))) && fetch(&mut log, key, &mut buffer) == Some(value) {
            return Ok(());
        }
        erase_half(memory, half);
    }
    Err(AbortCode::HardwareError)
}

/// Erases a half; whether that has worked shows when it is written.
fn erase_half(memory: &mut impl NorFlash, half: usize) {
    if let Some(mut log) = log(Immediate::writable(memory), half) {
        let _ = at_once(log.erase_all());
    }
}

/// Looks for the set that was saved last, without writing anything. `None` without a memory.
fn examine<M: NorFlash>(memory: &mut M) -> Option<Contents> {
    let mut buffer = EMPTY;
    let (mut set, mut seal) = (None, None);
    for half in HALVES {
        let mut log = log(Immediate::read_only(memory), half)?;
        set = set.max(fetch(&mut log, SET, &mut buffer).and_then(number));
        seal = seal.max(fetch(&mut log, SEAL, &mut buffer).and_then(number));
    }
    Some(match (set, seal) {
        (Some(number), seal) if Some(number) >= seal => Contents::Set { number },
        (None, None) => match extent(memory) {
            Ok(extent) if extent <= first_set_end::<M>() => Contents::Nothing { erase: extent > 0 },
            _ => Contents::Damaged { last: 0 },
        },
        _ => Contents::Damaged {
            last: set.max(seal).unwrap_or(0),
        },
    })
}

fn number(value: &[u8]) -> Option<u32> {
    value.first_chunk().copied().map(u32::from_le_bytes)
}

/// Where the first set ends that is saved in a blank memory; what a cut leaves of it ends before.
const fn first_set_end<M: NorFlash>() -> usize {
    let word = if M::WRITE_SIZE > M::READ_SIZE {
        M::WRITE_SIZE
    } else {
        M::READ_SIZE
    };
    let overhead = Log::<M>::item_overhead_size() as usize;
    word + overhead + (KEY_SIZE + NUMBER_SIZE + FULL_SIZE).next_multiple_of(word)
}

/// Bytes from the memory's start to the last one that is not erased.
fn extent<M: NorFlash>(memory: &mut M) -> Result<usize, M::Error> {
    const ERASED: u8 = 0xFF;
    let mut chunk = [ERASED; 64];
    let mut end = memory.capacity();
    while end > 0 {
        let start = (end - 1) / chunk.len() * chunk.len();
        let bytes = &mut chunk[..end - start];
        memory.read(start as u32, bytes)?;
        if let Some(last) = bytes.iter().rposition(|byte| *byte != ERASED) {
            return Ok(start + last + 1);
        }
        end = start;
    }
    Ok(0)
}

#[cfg(test)]
mod tests;
