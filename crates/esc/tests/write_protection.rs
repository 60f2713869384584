//! Write protection of registers (0x0020, 0x0021) and of the whole chip (0x0030, 0x0031).

mod bus;

use bus::{Bus, FmmuEntry, OUTPUTS, STATION};
use wire::EscAccess;
use wire::frame::{Command, physical_address};
use wire::register::*;

const REGISTER: u16 = DC_SYSTEM_TIME_OFFSET;
const LOGICAL: u32 = 0x1_0000;

fn at(ado: u16) -> u32 {
    physical_address(STATION, ado)
}

/// Working counters of writes to a register, to free memory and to a sync manager's buffer, behind writes that release.
fn writes(bus: &mut Bus, released: &[u16]) -> [u16; 3] {
    let released: Vec<_> = released.iter().map(|&register| (Command::Fpwr, at(register), &[1][..])).collect();
    let writes = [
        (Command::Fpwr, at(REGISTER), &[1][..]),
        (Command::Fpwr, at(USER_RAM), &[1]),
        (Command::Fpwr, at(PROCESS_RAM), &[1, 2, 3, 4]),
    ];
    let answers = bus.send(&[&released[..], &writes].concat());
    [0, 1, 2].map(|index| answers[released.len() + index].wkc)
}

#[test]
fn protection_refuses_writes_that_their_frame_has_not_released() {
    const REGISTERS: u16 = WRITE_REGISTER_PROTECTION;
    const CHIP: u16 = ESC_WRITE_PROTECTION;
    let free = [1, 1, 1];
    for (protections, released, expected) in [
        (&[][..], &[][..], free),
        (&[REGISTERS], &[], [0, 1, 1]),
        (&[REGISTERS], &[WRITE_REGISTER_ENABLE], free),
        (&[REGISTERS], &[ESC_WRITE_ENABLE], [0, 1, 1]),
        (&[CHIP], &[], [0, 0, 0]),
        (&[CHIP], &[ESC_WRITE_ENABLE], free),
        (&[CHIP], &[WRITE_REGISTER_ENABLE], [0, 0, 0]),
        (&[REGISTERS, CHIP], &[ESC_WRITE_ENABLE], [0, 1, 1]),
        (&[REGISTERS, CHIP], &[WRITE_REGISTER_ENABLE], [0, 0, 0]),
        (&[REGISTERS, CHIP], &[WRITE_REGISTER_ENABLE, ESC_WRITE_ENABLE], free),
    ] {
        let mut bus = Bus::new(1);
        bus.sync_manager(0, 0, PROCESS_RAM, 4, OUTPUTS);
        let on: Vec<_> = protections
            .iter()
            .map(|&register| (Command::Fpwr, at(register), &[1][..]))
            .collect();
        if !on.is_empty() {
            assert!(
                bus.send(&on).iter().all(|answer| answer.wkc == 1),
                "in force behind its own frame only"
            );
        }
        assert_eq!(
            writes(&mut bus, released),
            expected,
            "{protections:04X?} released by {released:04X?}"
        );
        let shut = writes(&mut bus, &[]);
        assert_eq!(shut[0] == 0, !protections.is_empty(), "released for one frame: {protections:04X?}");
    }
}

#[test]
fn a_refused_write_changes_nothing_and_reading_goes_on() {
    let mut bus = Bus::new(1);
    bus.write(0, USER_RAM, &[0x55]);
    bus.write(0, REGISTER, &[0x66]);
    bus.write(0, ESC_WRITE_PROTECTION, &[1]);
    for ado in [USER_RAM, REGISTER] {
        assert_eq!(bus.write(0, ado, &[9]), 0);
        assert_eq!(bus.one(Command::Fprw, at(ado), &[9]).wkc, 1, "the read half");
        assert_eq!(bus.one(Command::Brw, physical_address(0, ado), &[0]).wkc, 1);
    }
    assert_eq!((bus.read_u8(0, USER_RAM), bus.read_u8(0, REGISTER)), (0x55, 0x66));
    let command = bus.one(Command::Bwr, physical_address(0, AL_CONTROL), &[0x11, 0]);
    assert_eq!(command.wkc, 0);
    assert_eq!(bus.read_u8(0, ESC_WRITE_PROTECTION), 1);
    assert_eq!(bus.read_u8(0, ESC_WRITE_ENABLE), 0, "the release ends with its frame");
}

#[test]
fn protection_ends_with_a_released_write_and_with_a_power_cycle() {
    for (enable, protection) in [
        (WRITE_REGISTER_ENABLE, WRITE_REGISTER_PROTECTION),
        (ESC_WRITE_ENABLE, ESC_WRITE_PROTECTION),
    ] {
        let mut bus = Bus::new(1);
        bus.write(0, protection, &[1]);
        assert_eq!(bus.write(0, protection, &[0]), 0);
        assert_eq!(bus.write(0, enable, &[0]), 1, "open, but 0 releases nothing");
        assert_eq!(bus.read_u8(0, protection), 1);
        // Both registers of a pair in one datagram: the bytes take effect in their order.
        assert_eq!(bus.write(0, enable, &[1, 0]), 1);
        assert_eq!((bus.read_u8(0, protection), bus.write(0, REGISTER, &[3])), (0, 1));
        bus.write(0, protection, &[1]);
        bus.chip(0).power_cycle();
        assert_eq!(bus.one(Command::Apwr, physical_address(0, REGISTER), &[3]).wkc, 1);
    }
}

#[test]
fn outputs_through_an_fmmu_are_refused_and_inputs_are_not() {
    let mut bus = Bus::new(1);
    bus.sync_manager(0, 0, PROCESS_RAM, 4, OUTPUTS);
    bus.fmmu(0, 0, FmmuEntry::whole(LOGICAL, 4, PROCESS_RAM, FmmuEntry::WRITE));
    bus.fmmu(0, 1, FmmuEntry::whole(LOGICAL + 4, 1, USER_RAM, FmmuEntry::READ));
    // Bit by bit into free memory.
    bus.fmmu(
        0,
        2,
        FmmuEntry {
            start_bit: 1,
            stop_bit: 2,
            ..FmmuEntry::whole(LOGICAL + 5, 1, USER_RAM + 8, FmmuEntry::WRITE)
        },
    );
    let exchange = |bus: &mut Bus, length| bus.one(Command::Lrw, LOGICAL, &vec![0xFF; length]).wkc;
    assert_eq!(exchange(&mut bus, 6), 3);
    assert_eq!(bus.read_u8(0, USER_RAM + 8), 0b11, "two bits");
    bus.write(0, USER_RAM + 8, &[0]);
    bus.write(0, ESC_WRITE_PROTECTION, &[1]);
    assert_eq!(exchange(&mut bus, 6), 1);
    assert_eq!(bus.read_u8(0, USER_RAM + 8), 0);
    assert_eq!(bus.one(Command::Lwr, LOGICAL, &[0; 4]).wkc, 0);
}

#[test]
fn the_slave_is_not_protected_against() {
    let mut bus = Bus::new(1);
    bus.write(0, WRITE_REGISTER_PROTECTION, &[1]);
    bus.one(Command::Fpwr, at(WRITE_REGISTER_ENABLE), &[0]);
    bus.chip(0).write(AL_STATUS, &[2, 0]);
    bus.chip(0).write(USER_RAM, &[7]);
    assert_eq!((bus.read_u16(0, AL_STATUS), bus.read_u8(0, USER_RAM)), (2, 7));
}
