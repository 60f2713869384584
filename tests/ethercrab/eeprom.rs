//! The EEPROM through its registers: what a master writes, and when the chip takes it.

use ethercrab::{Command, MainDevice, RegisterAddress, SubDevice, SubDeviceRef};
use rig::Rig;

/// Words of the SII (ETG.1000.6, table 16).
const ALIAS: u16 = 4;
const CHECKSUM: u16 = 7;
/// Behind the categories, where nobody looks.
const SPARE: u16 = 0x03F0;

/// DL control, byte 3: bit 0 lets the chip answer to its alias.
const ALIAS_ENABLE: u16 = 0x0103;
const EEPROM_CONTROL: u16 = 0x0502;
const EEPROM_CHECKSUM_ERROR: u16 = 1 << 11;

const NEW_ALIAS: u16 = 0x1234;

/// Asserts how many chips answer a read of AL status at a station address.
async fn assert_answered(main: &MainDevice<'_>, address: u16, chips: u16) {
    let read = Command::fprd(address, RegisterAddress::AlStatus.into()).with_wkc(chips);
    let answer = read.receive::<u16>(main).await;
    assert!(answer.is_ok(), "address {address:#06x}: {answer:?}");
}

async fn alias_register(drive: &SubDeviceRef<'_, &SubDevice>) -> u16 {
    drive.register_read(RegisterAddress::ConfiguredStationAlias).await.unwrap()
}

#[test]
fn an_alias_is_used_after_a_power_cycle_and_only_where_the_master_allows_it() {
    let rig = Rig::new(2);
    rig.in_preop(async |main, _, mut group| {
        group.iter_mut(main).nth(1).unwrap().set_alias_address(NEW_ALIAS).await.unwrap();
        let drive = group.subdevice(main, 1).unwrap();
        drive.register_write(ALIAS_ENABLE, 1_u8).await.unwrap();
        assert_eq!(alias_register(&drive).await, 0, "not before a power cycle");
        assert_answered(main, NEW_ALIAS, 0).await;
    });
    rig.look(1, |drive| assert!(wire::sii::is_intact(drive.chip().eeprom())));
    rig.touch(1, |drive| drive.power_cycle());
    rig.in_preop(async |main, _, group| {
        let aliases: Vec<_> = group.iter(main).map(|drive| drive.alias_address()).collect();
        assert_eq!(aliases, [0, NEW_ALIAS]);
        let drive = group.subdevice(main, 1).unwrap();
        assert_eq!(alias_register(&drive).await, NEW_ALIAS);
        for (enable, chips) in [(0_u8, 0), (1, 1), (0, 0)] {
            drive.register_write(ALIAS_ENABLE, enable).await.unwrap();
            assert_answered(main, NEW_ALIAS, chips).await;
            assert_answered(main, drive.configured_address(), 1).await;
        }
    });
}

#[test]
fn words_written_are_read_back_and_last_over_a_power_cycle() {
    const WORDS: [u16; 4] = [0x0000, 0xFFFF, 0xA55A, 0x0001];
    let rig = Rig::new(2);
    rig.in_preop(async |main, _, group| {
        let drive = group.subdevice(main, 0).unwrap();
        for (word, value) in (SPARE..).zip(WORDS) {
            drive.eeprom_write_dangerously(main, word, value).await.unwrap();
        }
    });
    for power_cycle in [false, true] {
        if power_cycle {
            rig.touch(0, |drive| drive.power_cycle());
        }
        rig.in_preop(async |main, _, group| {
            let (written, other) = (group.subdevice(main, 0).unwrap(), group.subdevice(main, 1).unwrap());
            for (word, value) in (SPARE..).zip(WORDS) {
                assert_eq!(written.eeprom_read::<u16>(main, word).await.unwrap(), value, "word {word:#06x}");
            }
            let mut untouched = [0; 8];
            other.eeprom_read_raw(main, SPARE, &mut untouched).await.unwrap();
            assert_eq!(untouched, [0xFF; 8]);
        });
    }
}

#[test]
fn a_wrong_checksum_shows_after_a_power_cycle_and_the_alias_is_not_taken() {
    let rig = Rig::new(1);
    rig.in_preop(async |main, _, group| {
        let drive = group.subdevice(main, 0).unwrap();
        let checksum: u16 = drive.eeprom_read(main, CHECKSUM).await.unwrap();
        drive.eeprom_write_dangerously(main, ALIAS, NEW_ALIAS).await.unwrap();
        drive.eeprom_write_dangerously(main, CHECKSUM, checksum ^ 1).await.unwrap();
        let control: u16 = drive.register_read(EEPROM_CONTROL).await.unwrap();
        assert_eq!(control & EEPROM_CHECKSUM_ERROR, 0);
    });
    rig.touch(0, |drive| drive.power_cycle());
    rig.converse(async |main, _| {
        let control: u16 = Command::aprd(0, EEPROM_CONTROL).receive(main).await.unwrap();
        assert_ne!(control & EEPROM_CHECKSUM_ERROR, 0);
        let alias: u16 = Command::aprd(0, RegisterAddress::ConfiguredStationAlias.into())
            .receive(main)
            .await
            .unwrap();
        assert_eq!(alias, 0);
    });
}
