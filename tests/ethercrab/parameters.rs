//! Parameters and the site address over power cycles, by the manual's 1.5, 2.1.5 and 2.1.6.

use std::time::Duration;

use dictionary::{AbortCode, Entry};
use drive::{DriveObjects, PowerState};
use ethercrab::error::Error;
use ethercrab::{Command, RegisterAddress};
use rig::{CYCLE, Rig};
use usr2556e::drive::{DriveConfig, VirtualDrive};
use usr2556e::flash;
use usr2556e::master::bring_up;
use usr2556e::master::sdo::{self, Address, abort_code};

use crate::raw_mailbox::fetch;

const SAVE: &str = "1010:1";
const RESTORE: &str = "1011:1";
const ACT: u16 = 1;

fn refusal(result: Result<(), Error>) -> Option<AbortCode> {
    abort_code(&result.err()?)
}

/// Writes objects, given as the text of their addresses, in a session of its own.
fn write(rig: &Rig, values: &[(&str, u16)]) {
    rig.in_preop(async |main, _, group| {
        let drive = group.subdevice(main, 0).unwrap();
        for (address, value) in values {
            sdo::write(&drive, address.parse().unwrap(), &value.to_le_bytes())
                .await
                .unwrap_or_else(|error| panic!("{address} = {value}: {error}"));
        }
    });
}

fn read(rig: &Rig, address: &str) -> u16 {
    rig.in_preop(async |main, _, group| {
        let drive = group.subdevice(main, 0).unwrap();
        let bytes = sdo::read(&drive, address.parse().unwrap()).await.unwrap();
        u16::from_le_bytes([bytes[0], bytes.get(1).copied().unwrap_or(0)])
    })
}

fn power_cycle(rig: &Rig) {
    rig.touch(0, VirtualDrive::power_cycle);
    rig.idle(Duration::from_millis(1));
}

/// Objects that act when they are written, or take only what the drive can do at present.
fn acts(entry: &Entry) -> bool {
    matches!(entry.index, 0x2010 | 0x6040 | 0x6060 | 0x60B8)
}

// manual: 2.1.5/save
#[test]
fn saved_are_the_objects_that_the_manual_marks_and_no_others() {
    let rig = Rig::new(1);
    let other = |entry: &Entry| match entry.default == entry.max {
        true => entry.min,
        false => entry.max,
    };
    let bytes = |value: i64, entry: &Entry| value.to_le_bytes()[..entry.size()].to_vec();
    let address = |entry: &Entry| Address {
        index: entry.index,
        sub: entry.sub,
    };
    let entries = || {
        DriveObjects::ENTRIES
            .iter()
            .filter(|entry| entry.access.is_writable() && !acts(entry))
    };
    rig.in_preop(async |main, _, group| {
        let drive = group.subdevice(main, 0).unwrap();
        for entry in entries() {
            sdo::write(&drive, address(entry), &bytes(other(entry), entry)).await.unwrap();
        }
        sdo::write(&drive, SAVE.parse().unwrap(), &ACT.to_le_bytes()).await.unwrap();
        assert_eq!(sdo::read(&drive, SAVE.parse().unwrap()).await, Ok(vec![0, 0]));
    });
    power_cycle(&rig);
    let mut saved = 0;
    rig.in_preop(async |main, _, group| {
        let drive = group.subdevice(main, 0).unwrap();
        for entry in entries() {
            let value = if entry.access.is_saved() { other(entry) } else { entry.default };
            saved += usize::from(entry.access.is_saved());
            assert_eq!(
                sdo::read(&drive, address(entry)).await,
                Ok(bytes(value, entry)),
                "{}",
                address(entry)
            );
        }
    });
    assert!(saved > 30, "{saved}");
}

#[test]
fn what_was_not_saved_is_gone_after_a_power_cycle() {
    let rig = Rig::new(1);
    write(&rig, &[("2000", 2000), (SAVE, ACT), ("2000", 2500), ("2003", 20)]);
    power_cycle(&rig);
    assert_eq!((read(&rig, "2000"), read(&rig, "2003")), (2000, 50));
}

// manual: 2.1.6/restore
#[test]
fn restored_defaults_come_with_the_next_power_on() {
    let rig = Rig::new(1);
    write(&rig, &[("2000", 2000), (SAVE, ACT)]);
    power_cycle(&rig);
    write(&rig, &[(RESTORE, ACT)]);
    assert_eq!((read(&rig, "2000"), read(&rig, RESTORE)), (2000, 0));
    power_cycle(&rig);
    assert_eq!(read(&rig, "2000"), 3000);
    power_cycle(&rig);
    assert_eq!(read(&rig, "2000"), 3000);
}

// manual: 2.1.5/object 2.1.6/object
#[test]
fn the_objects_that_save_and_restore_have_one_entry_that_reads_0_and_is_not_for_pdos() {
    Rig::new(1).in_preop(async |main, _, group| {
        let drive = group.subdevice(main, 0).unwrap();
        for index in [0x1010_u16, 0x1011] {
            assert_eq!(drive.sdo_read::<u8>(index, 0).await, Ok(1));
            assert_eq!(drive.sdo_read::<u16>(index, 1).await, Ok(0));
            drive.sdo_write(0x1A00, 0, 0_u8).await.unwrap();
            let mapped = drive.sdo_write(0x1A00, 1, u32::from(index) << 16 | 0x0110).await;
            assert_eq!(refusal(mapped), Some(AbortCode::NotMappable));
        }
    });
}

// manual: 2.1.5/standstill 2.1.6/standstill
#[test]
fn saving_and_restoring_act_on_1_only_and_at_standstill_only() {
    Rig::new(1).in_preop(async |main, pace, group| {
        let drive = group.subdevice(main, 0).unwrap();
        let write = async |address: &str, value: &[u8]| refusal(sdo::write(&drive, address.parse().unwrap(), value).await);
        for command in [SAVE, RESTORE] {
            for value in [0_u16, 2, 0xFFFF] {
                assert_eq!(write(command, &value.to_le_bytes()).await, Some(AbortCode::ValueRange), "{value}");
            }
            assert_eq!(write(command, b"save").await, Some(AbortCode::LengthMismatch));
        }
        // Without shaft lock and identification, profile velocity moves as soon as it is enabled.
        for address in ["200A", "200B:1"] {
            assert_eq!(write(address, &[0, 0]).await, None);
        }
        let group = bring_up::to_op(main, pace, group, CYCLE).await.unwrap();
        let drive = group.subdevice(main, 0).unwrap();
        let write = async |address: &str, value: &[u8]| refusal(sdo::write(&drive, address.parse().unwrap(), value).await);
        for (address, value) in [
            ("6060", &[3][..]),
            ("60FF", &[0x10, 0x27, 0, 0]),
            ("6040", &[0x06, 0]),
            ("6040", &[0x0F, 0]),
        ] {
            assert_eq!(write(address, value).await, None, "{address}");
        }
        pace.until(pace.now().after(Duration::from_millis(20))).await;
        let status = sdo::read(&drive, "200F".parse().unwrap()).await.unwrap();
        assert_eq!(status[0] & 0x09, 0x09, "enabled and running");
        for command in [SAVE, RESTORE] {
            assert_eq!(write(command, &ACT.to_le_bytes()).await, Some(AbortCode::DeviceState));
        }
    });
}

/// The station alias register, and whether a drive with that alias answers to it.
fn alias_on_the_bus(rig: &Rig, alias: u16) -> (u16, bool) {
    const STATION_ALIAS: u16 = 0x0012;
    const USE_ALIAS: u16 = 0x0103;
    rig.in_preop(async |main, _, group| {
        let station = group.subdevice(main, 0).unwrap().configured_address();
        let register = Command::fprd(station, STATION_ALIAS).receive::<u16>(main).await.unwrap();
        Command::fpwr(station, USE_ALIAS).send(main, 1_u8).await.unwrap();
        let answer = Command::fprd(alias, STATION_ALIAS).receive::<u16>(main).await;
        Command::fpwr(station, USE_ALIAS).send(main, 0_u8).await.unwrap();
        (register, answer.is_ok())
    })
}

fn with_alias(alias: u16) -> Rig {
    let mut config = DriveConfig::numbered(0);
    config.eeprom = Some(device::sii::image(1, alias));
    Rig::with([config])
}

// manual: 1.5/master
#[test]
fn with_2151_at_0_the_alias_is_that_of_the_eeprom_and_2150_shows_it() {
    let rig = with_alias(77);
    assert_eq!((read(&rig, "2150"), read(&rig, "2151")), (77, 0));
    assert_eq!(alias_on_the_bus(&rig, 77), (77, true));
    // What a master writes to the EEPROM comes with the next power-on.
    rig.in_preop(async |main, _, mut group| {
        let mut drive = group.iter_mut(main).next().unwrap();
        drive.set_alias_address(1234).await.unwrap();
    });
    assert_eq!((read(&rig, "2150"), alias_on_the_bus(&rig, 77)), (77, (77, true)));
    power_cycle(&rig);
    assert_eq!((read(&rig, "2150"), alias_on_the_bus(&rig, 1234)), (1234, (1234, true)));
    // 0x2150 alone, even saved, changes nothing.
    write(&rig, &[("2150", 5), (SAVE, ACT)]);
    power_cycle(&rig);
    assert_eq!((read(&rig, "2150"), alias_on_the_bus(&rig, 5)), (1234, (1234, false)));
}

// manual: 1.5/object
#[test]
fn with_2151_at_1_the_alias_is_2150_from_the_next_power_on() {
    let rig = with_alias(77);
    write(&rig, &[("2151", 1), ("2150", 300), (SAVE, ACT)]);
    assert_eq!(alias_on_the_bus(&rig, 300), (77, false));
    power_cycle(&rig);
    assert_eq!(alias_on_the_bus(&rig, 300), (300, true));
    assert_eq!((read(&rig, "2150"), read(&rig, "2151")), (300, 1));
    // The device identifies itself with it.
    rig.in_preop(async |main, _, group| {
        let drive = group.subdevice(main, 0).unwrap();
        drive.register_write(RegisterAddress::AlControl, 0x22_u16).await.unwrap();
        assert_eq!(drive.register_read(RegisterAddress::AlStatusCode).await, Ok(300_u16));
    });
    write(&rig, &[("2151", 0), (SAVE, ACT)]);
    power_cycle(&rig);
    assert_eq!(
        (read(&rig, "2150"), alias_on_the_bus(&rig, 77)),
        (77, (77, true)),
        "the EEPROM has kept its own"
    );
}

#[test]
fn an_alias_by_object_survives_reset_by_register_and_a_reload_of_the_eeprom() {
    const RELOAD: [u8; 2] = [0x00, 0x04];
    let rig = with_alias(77);
    write(&rig, &[("2151", 1), ("2150", 300), (SAVE, ACT)]);
    for letter in *b"RES" {
        rig.converse(async |main, _| Command::bwr(0x0040).send(main, letter).await.unwrap());
    }
    rig.idle(Duration::from_millis(1));
    assert_eq!(alias_on_the_bus(&rig, 300), (300, true));
    rig.converse(async |main, _| Command::bwr(0x0502).send(main, RELOAD).await.unwrap());
    rig.idle(Duration::from_millis(1));
    assert_eq!(alias_on_the_bus(&rig, 300), (300, true));
}

#[test]
fn damaged_parameters_are_a_fault_that_a_reset_clears() {
    let mut config = DriveConfig::numbered(0);
    config.parameters = Some([0x55; flash::SIZE]);
    let rig = Rig::with([config]);
    rig.idle(Duration::from_millis(1));
    rig.in_preop(async |main, pace, group| {
        let drive = group.subdevice(main, 0).unwrap();
        let read = async |address: &str| sdo::read(&drive, address.parse().unwrap()).await.unwrap();
        let emergency = fetch(&drive).await;
        assert_eq!(emergency, Some((1, vec![0x30, 0x55, 0x01, 0, 0, 0, 0, 0])));
        assert_eq!(
            (read("603F").await, read("1001").await, read("200E").await),
            (vec![0x30, 0x55], vec![1], vec![0, 0])
        );
        assert_eq!(read("6041").await[0] & 0x4F, 0x08, "Fault");
        assert_eq!(read("2000").await, [0xB8, 0x0B]);
        sdo::write(&drive, "6040".parse().unwrap(), &[0x80, 0]).await.unwrap();
        pace.until(pace.now().after(Duration::from_millis(1))).await;
        assert_eq!(fetch(&drive).await, Some((1, vec![0; 8])), "no fault any more");
        assert_eq!((read("603F").await, read("1001").await), (vec![0, 0], vec![0]));
    });
    assert_eq!(rig.look(0, |drive| drive.status().power_state), PowerState::SwitchOnDisabled);
    // It is still damaged at the next power-on, until something is saved.
    power_cycle(&rig);
    assert_eq!(read(&rig, "603F"), 0x5530);
    write(&rig, &[("2000", 2000), (SAVE, ACT)]);
    power_cycle(&rig);
    assert_eq!((read(&rig, "603F"), read(&rig, "2000")), (0, 2000));
}
