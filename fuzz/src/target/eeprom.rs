//! Arbitrary contents of the EEPROM at power-on, and arbitrary accesses to the interface of the EEPROM (0x0500 to 0x050F).
//!
//! What must hold: a command ends, and leaves no command bit and no busy bit behind; only a write command changes contents, and one word
//! of them; the checksum error is shown exactly when the checksum is wrong; and the drive gets to PREOP, whatever the EEPROM holds.

use std::sync::LazyLock;

use device::layout::MAILBOX_MAX;
use esc::EEPROM_SIZE;
use usr2556e::drive::DriveConfig;
use wire::register::{AL_CONTROL, EEPROM_ADDRESS, EEPROM_CONFIGURATION, EEPROM_CONTROL, EEPROM_DATA};
use wire::sii;

use crate::bus::Bus;
use crate::input::{Input, Patience};
use crate::{bring_up, mail};

/// Steps of an input at the most.
const MOST_STEPS: usize = 64;
/// Changes to the contents at power-on at the most.
const MOST_PATCHES: u8 = 16;
/// Bytes of the interface's registers.
const REGISTERS: u16 = 16;
/// Bits of 0x0502 that are there only while a command is executed: busy and the command.
const EXECUTING: u16 = 0x8700;
/// Bits of 0x0502: checksum error, and nothing loaded for that reason.
const CHECKSUM_ERROR: u16 = 0x0800;
const NOT_LOADED: u16 = 0x1000;
const COMMAND_READ: u8 = 0x01;
const COMMAND_WRITE: u8 = 0x02;
const COMMAND_RELOAD: u8 = 0x04;
/// How long a command may take, in ns.
const MOST_TIME: u64 = 20_000_000;
/// A checksum that switches the check off.
const CHECKSUM_OFF: [u8; 2] = [0xA4, 0x88];

/// Contents at delivery.
static DELIVERED: LazyLock<[u8; EEPROM_SIZE]> = LazyLock::new(|| device::sii::image(1, 0));

/// Runs an input.
///
/// # Panics
/// If the drive is not as it must be.
pub fn run(bytes: &[u8]) {
    let mut input = Input::new(bytes);
    let mut bus = Bus::new([DriveConfig {
        eeprom: Some(image(&mut input)),
        ..DriveConfig::numbered(0)
    }]);
    let mut patience = Patience::default();
    for _ in 0..MOST_STEPS {
        if input.is_empty() {
            break;
        }
        step(&mut bus, &mut input, &mut patience);
    }
    check_reload(&mut bus);
    check_words(&mut bus);
    bring_up::to_preop(&mut bus, MAILBOX_MAX);
    mail::assert_answers(&mut bus, MAILBOX_MAX);
}

/// Contents made of those at delivery, or of nothing, and some changes; the checksum is made right for most.
fn image(input: &mut Input<'_>) -> [u8; EEPROM_SIZE] {
    let shape = input.u8();
    let mut image = if shape & 0x80 == 0 { *DELIVERED } else { [0xFF; EEPROM_SIZE] };
    for _ in 0..shape % MOST_PATCHES {
        let at = usize::from(input.u16()) % EEPROM_SIZE;
        let length = usize::from(input.u8()).min(EEPROM_SIZE - at);
        let patch = input.bytes(length);
        image[at..at + patch.len()].copy_from_slice(patch);
    }
    if shape & 0x40 == 0 {
        image[2 * sii::word::CHECKSUM] = sii::checksum(&image);
    }
    image
}

fn step(bus: &mut Bus, input: &mut Input<'_>, patience: &mut Patience) {
    match input.u8() % 8 {
        0..=2 => {
            let at = u16::from(input.u8()) % REGISTERS;
            let length = 1 + u16::from(input.u8()) % (REGISTERS - at);
            let mut data = input.bytes(length.into()).to_vec();
            data.resize(length.into(), 0);
            access(bus, at, &data);
        }
        3 => {
            let word = input.u16() % 0x480;
            access(bus, EEPROM_ADDRESS - EEPROM_CONFIGURATION, &word.to_le_bytes());
            let command = input.one_of(&[COMMAND_READ, COMMAND_WRITE, COMMAND_RELOAD]);
            access(bus, EEPROM_CONTROL - EEPROM_CONFIGURATION, &[input.u8() & 1, command]);
        }
        4 => {
            let data: [u8; 2] = input.array();
            access(bus, EEPROM_DATA - EEPROM_CONFIGURATION, &data);
        }
        5 => {
            let span = patience.span(input);
            bus.wait(span);
        }
        6 => _ = bus.write(AL_CONTROL, &[input.u8(), 0]),
        _ => {
            let mut data = [0; REGISTERS as usize];
            bus.read(EEPROM_CONFIGURATION, &mut data);
        }
    }
}

/// Writes to the interface and sees that a command ends, and that contents change only as they may.
fn access(bus: &mut Bus, at: u16, data: &[u8]) {
    let before = *bus.drives()[0].chip().eeprom();
    bus.write(EEPROM_CONFIGURATION + at, data);
    await_end(bus);
    let after = bus.drives()[0].chip().eeprom();
    let differ: Vec<_> = (0..EEPROM_SIZE / 2)
        .filter(|word| before[2 * word..][..2] != after[2 * word..][..2])
        .collect();
    assert!(differ.len() <= 1, "words {differ:04X?} changed at once");
    if !differ.is_empty() {
        let offset = usize::from(EEPROM_CONTROL - EEPROM_CONFIGURATION);
        let written = |register: usize| register.checked_sub(at.into()).and_then(|index| data.get(index));
        let enabled = written(offset).is_some_and(|control| control & 1 != 0);
        let commanded = written(offset + 1).is_some_and(|command| command & 7 == COMMAND_WRITE);
        assert!(enabled && commanded, "contents changed without a write command");
    }
}

/// Lets time pass until no command is executed.
fn await_end(bus: &mut Bus) -> u16 {
    let start = bus.now();
    loop {
        let status = bus.read_u16(EEPROM_CONTROL);
        if status & EXECUTING == 0 {
            return status;
        }
        assert!(bus.now().since(start) < MOST_TIME, "0x0502 stays {status:04X}");
        bus.wait(100_000);
    }
}

/// Takes the interface from whoever has it.
fn take_over(bus: &mut Bus) {
    assert!(bus.write(EEPROM_CONFIGURATION, &[2]) && bus.write(EEPROM_CONFIGURATION, &[0]));
    await_end(bus);
}

/// Reloads, and sees that the checksum is checked.
fn check_reload(bus: &mut Bus) {
    take_over(bus);
    assert!(bus.write(EEPROM_CONTROL, &[0, COMMAND_RELOAD]));
    let status = await_end(bus);
    let image = bus.drives()[0].chip().eeprom();
    let intact = sii::is_intact(image) || image[2 * sii::word::CHECKSUM..][..2] == CHECKSUM_OFF;
    let expected = if intact { 0 } else { CHECKSUM_ERROR | NOT_LOADED };
    assert_eq!(status & (CHECKSUM_ERROR | NOT_LOADED), expected);
}

/// Reads contents as a master does.
fn check_words(bus: &mut Bus) {
    for word in [0, sii::word::IDENTITY, sii::word::CATEGORIES, EEPROM_SIZE / 2 - 4] {
        assert!(bus.write(EEPROM_ADDRESS, &(word as u32).to_le_bytes()));
        assert!(bus.write(EEPROM_CONTROL, &[0, COMMAND_READ]));
        await_end(bus);
        let mut data = [0; 8];
        assert!(bus.read(EEPROM_DATA, &mut data));
        assert_eq!(data, bus.drives()[0].chip().eeprom()[2 * word..][..8]);
    }
}
