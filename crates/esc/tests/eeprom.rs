//! The SII EEPROM interface, in the ways of each master.

mod bus;

use bus::{Bus, STATION, eeprom};
use esc::{Chip, ChipConfig, EEPROM_SIZE};
use wire::EscAccess;
use wire::frame::{Command, physical_address};
use wire::register::*;
use wire::sii;

const IDLE: u16 = 0x0040;

fn words(image: &[u8], address: usize, count: usize) -> Vec<u8> {
    image[2 * address..2 * (address + count)].to_vec()
}

fn status(bus: &mut Bus) -> u16 {
    bus.read_u16(0, EEPROM_CONTROL)
}

#[test]
fn soem_and_ethercrab_read_eight_bytes_with_a_six_byte_command() {
    let mut bus = Bus::new(1);
    assert_eq!(status(&mut bus), IDLE);
    for address in [0u16, 8, 0x3A] {
        let mut command = vec![0x00, 0x01];
        command.extend(u32::from(address).to_le_bytes());
        assert_eq!(bus.write(0, EEPROM_CONTROL, &command), 1);
        assert_eq!(status(&mut bus), IDLE, "done and idle again");
        assert_eq!(bus.read(0, EEPROM_DATA, 8).data, words(&eeprom(), address.into(), 4));
    }
}

#[test]
fn igh_reads_with_four_bytes_and_fetches_ten() {
    let mut bus = Bus::new(1);
    // A stale upper half of the address, which IgH never writes.
    assert_eq!(bus.write(0, EEPROM_ADDRESS, &[0, 0, 0xFF, 0xFF]), 1);
    assert_eq!(bus.write(0, EEPROM_CONTROL, &[0x80, 0x01, 0x08, 0x00]), 1);
    let answer = bus.read(0, EEPROM_CONTROL, 10).data;
    assert_eq!(answer[1] & 0x81, 0, "neither busy nor reading");
    assert_eq!(answer[6..10], words(&eeprom(), 8, 2));
}

#[test]
fn igh_writes_with_one_datagram_of_eight_bytes() {
    let mut bus = Bus::new(1);
    assert_eq!(bus.write(0, EEPROM_CONTROL, &[0x81, 0x02, 0x04, 0x00, 0, 0, 0x34, 0x12]), 1);
    assert_eq!(status(&mut bus), IDLE);
    assert_eq!(bus.chip(0).eeprom()[8..10], [0x34, 0x12]);
    assert_eq!(bus.chip(0).eeprom_writes(), 1);
}

#[test]
fn soem_writes_data_first_and_the_command_after() {
    let mut bus = Bus::new(1);
    assert_eq!(bus.write(0, EEPROM_DATA, &[0x78, 0x56]), 1);
    assert_eq!(bus.write(0, EEPROM_CONTROL, &[0x01, 0x02, 0x05, 0, 0, 0]), 1);
    assert_eq!(bus.chip(0).eeprom()[10..12], [0x78, 0x56]);
    bus.write(0, EEPROM_CONTROL, &[0x00, 0x01, 0x05, 0, 0, 0]);
    assert_eq!(bus.read(0, EEPROM_DATA, 2).data, [0x78, 0x56], "and it reads back");
}

#[test]
fn kickcat_broadcasts_an_idle_command_and_gatorcat_clears_before_reading() {
    let mut bus = Bus::new(3);
    assert_eq!(bus.one(Command::Bwr, physical_address(0, EEPROM_CONFIGURATION), &[0, 0]).wkc, 3);
    assert_eq!(bus.one(Command::Bwr, physical_address(0, EEPROM_CONTROL), &[0, 0]).wkc, 3);
    assert_eq!(bus.write(0, EEPROM_CONTROL, &[0, 0]), 1);
    assert_eq!(bus.write(0, EEPROM_CONTROL, &[0, 1, 0, 0, 0, 0]), 1);
    assert_eq!(bus.read(0, EEPROM_DATA, 2).data, [0x05, 0x0C]);
}

#[test]
fn command_runs_after_all_datagrams_of_the_frame() {
    let mut bus = Bus::new(1);
    let at = |ado| physical_address(STATION, ado);
    let answers = bus.send(&[
        (Command::Fpwr, at(EEPROM_CONTROL), &[0, 1]),
        (Command::Fprd, at(EEPROM_DATA), &[0; 2]),
        (Command::Fpwr, at(EEPROM_ADDRESS), &[4, 0]),
    ]);
    assert_eq!(answers[1].data, [0, 0]);
    assert_eq!(bus.read(0, EEPROM_DATA, 2).data, [0xAA, 0]);
}

#[test]
fn beyond_the_image_everything_is_erased_and_nothing_can_be_written() {
    let mut bus = Bus::new(1);
    let last = (EEPROM_SIZE / 2 - 1) as u16;
    for address in [last, last + 1, 0xFFFF] {
        let [low, high] = address.to_le_bytes();
        assert_eq!(bus.write(0, EEPROM_CONTROL, &[0, 1, low, high, 0, 0]), 1);
        assert_eq!(bus.read(0, EEPROM_DATA, 8).data, [0xFF; 8], "{address:#06x}");
    }
    let [low, high] = (last + 1).to_le_bytes();
    bus.write(0, EEPROM_CONTROL, &[1, 2, low, high, 0, 0, 1, 1]);
    assert_eq!(status(&mut bus), IDLE | 0x2000, "no acknowledge");
    assert_eq!(bus.chip(0).eeprom_writes(), 0);
}

#[test]
fn errors_stay_until_the_next_command() {
    let mut bus = Bus::new(1);
    bus.write(0, EEPROM_CONTROL, &[0, 2, 4, 0, 0, 0, 1, 1]);
    assert_eq!(status(&mut bus), IDLE | 0x4000, "not enabled for writing");
    assert_eq!(*bus.chip(0).eeprom(), eeprom());
    bus.write(0, EEPROM_CONTROL, &[0, 0]);
    assert_eq!(status(&mut bus), IDLE);
    bus.write(0, EEPROM_CONTROL, &[0, 7]);
    assert_eq!(status(&mut bus), IDLE | 0x2000, "no such command");
    bus.write(0, EEPROM_CONTROL, &[0, 1, 0, 0, 0, 0]);
    assert_eq!(status(&mut bus), IDLE);
}

#[test]
fn the_slave_gets_the_interface_only_when_offered_and_the_master_can_force_it_back() {
    let mut bus = Bus::new(1);
    bus.chip(0).write_u8(EEPROM_PDI_ACCESS, 1);
    assert_eq!(bus.read_u8(0, EEPROM_PDI_ACCESS), 0, "not offered");
    bus.chip(0).write(EEPROM_CONTROL, &[1, 2, 4, 0, 0, 0, 9, 9]);
    assert_eq!(bus.chip(0).eeprom_writes(), 0);

    assert_eq!(bus.write(0, EEPROM_CONFIGURATION, &[1]), 1);
    assert_eq!(bus.write(0, EEPROM_CONTROL, &[0, 1, 0, 0, 0, 0]), 1, "offered, but not taken");
    bus.chip(0).write_u8(EEPROM_PDI_ACCESS, 1);
    assert_eq!(bus.write(0, EEPROM_CONTROL, &[0, 1, 8, 0, 0, 0]), 0);
    bus.chip(0).write(EEPROM_CONTROL, &[0, 1, 4, 0, 0, 0]);
    assert_eq!(bus.chip(0).read_u16(EEPROM_DATA), 0x00AA);

    // SOEM: force, then take; ethercrab does so with 16 bits.
    assert_eq!(bus.write(0, EEPROM_CONFIGURATION, &[2, 0]), 1);
    assert_eq!(bus.write(0, EEPROM_CONFIGURATION, &[0, 0]), 1);
    assert_eq!(bus.read_u8(0, EEPROM_PDI_ACCESS), 0);
    assert_eq!(bus.write(0, EEPROM_CONTROL, &[0, 1, 8, 0, 0, 0]), 1);
}

#[test]
fn a_new_alias_counts_after_power_on_only() {
    let mut bus = Bus::new(1);
    let mut image = eeprom();
    image[8] = 0x55;
    let checksum = sii::checksum(&image);
    for (word, value) in [(4, 0x55), (7, checksum)] {
        assert_eq!(bus.write(0, EEPROM_DATA, &[value, 0]), 1);
        assert_eq!(bus.write(0, EEPROM_CONTROL, &[1, 2, word, 0, 0, 0]), 1);
    }
    bus.write(0, EEPROM_CONTROL, &[0, 4]);
    assert_eq!(status(&mut bus), IDLE);
    assert_eq!(bus.read_u16(0, STATION_ALIAS), 0xAA);
    bus.chip(0).power_cycle();
    assert_eq!(bus.one(Command::Aprd, physical_address(0, STATION_ALIAS), &[0; 2]).data, [0x55, 0]);
    assert_eq!(bus.chip(0).eeprom_writes(), 2, "the count goes on");
}

#[test]
fn configuration_area_is_loaded_if_its_checksum_is_right() {
    let mut bus = Bus::new(1);
    assert_eq!(bus.read(0, PDI_CONTROL, 2).data, [0x05, 0x0C]);
    assert_eq!(bus.read(0, PDI_CONFIGURATION, 4).data, [0x03, 0xEE, 0, 0]);
    assert_eq!(bus.read_u16(0, DC_PULSE_LENGTH), 1000);

    let mut image = eeprom();
    image[0] = 0x08;
    let mut chip = Chip::new(ChipConfig {
        eeprom: image,
        clock_offset_ns: 0,
        clock_ppb: 0,
    });
    assert_eq!(chip.read_u16(EEPROM_CONTROL), IDLE | 0x1800);
    assert_eq!(chip.read_u16(DL_STATUS) & 1, 0);
    assert_eq!((chip.read_u16(PDI_CONTROL), chip.read_u16(STATION_ALIAS)), (0, 0));

    image[14..16].copy_from_slice(&0x88A4u16.to_le_bytes());
    let mut chip = Chip::new(ChipConfig {
        eeprom: image,
        clock_offset_ns: 0,
        clock_ppb: 0,
    });
    assert_eq!(chip.read_u16(EEPROM_CONTROL), IDLE, "the word that switches the check off");
    assert_eq!(chip.read_u16(PDI_CONTROL), 0x0C08);
}

#[test]
fn reload_tells_of_a_configuration_area_gone_bad_and_leaves_what_was_loaded() {
    let mut bus = Bus::new(1);
    bus.write(0, EEPROM_CONTROL, &[1, 2, 0, 0, 0, 0, 0x80, 0x02]);
    bus.write(0, EEPROM_CONTROL, &[0, 4]);
    assert_eq!(status(&mut bus), IDLE | 0x1800);
    assert_eq!(bus.read(0, PDI_CONTROL, 2).data, [0x05, 0x0C]);
    let mut image = eeprom();
    image[..2].copy_from_slice(&[0x80, 0x02]);
    bus.write(0, EEPROM_CONTROL, &[1, 2, 7, 0, 0, 0, sii::checksum(&image), 0]);
    bus.write(0, EEPROM_CONTROL, &[0, 4]);
    assert_eq!(status(&mut bus), IDLE);
    assert_eq!(
        bus.read(0, PDI_CONTROL, 2).data,
        [0x80, 0x00],
        "enhanced link detection is loaded at power-on only"
    );
}
