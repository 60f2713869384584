//! Memory behind sync managers: every rule of access row by row, three buffers, mailbox, watchdog.

mod bus;

use bus::{Bus, INPUTS, MAILBOX_IN, MAILBOX_OUT, OUTPUTS, STATION};
use wire::frame::{Command, physical_address};
use wire::register::*;
use wire::{AlEvents, EscAccess, Nanos};

const START: u16 = 0x1100;
const LENGTH: usize = 8;

fn with(control: u8) -> Bus {
    let mut bus = Bus::new(1);
    bus.sync_manager(0, 2, START, LENGTH as u16, control);
    bus.catch_up();
    bus
}

fn status(bus: &mut Bus) -> u8 {
    bus.read_u8(0, SM + 2 * SM_SIZE + sync_manager::STATUS)
}

fn has_event(bus: &mut Bus) -> bool {
    bus.catch_up();
    bus.chip(0).events().has(AlEvents::sync_manager(2))
}

#[test]
fn disabled_is_plain_memory() {
    let mut bus = with(OUTPUTS);
    assert_eq!(bus.write(0, SM + 2 * SM_SIZE + sync_manager::ACTIVATE, &[0]), 1);
    assert_eq!(bus.write(0, START + 3, &[1, 2]), 1);
    assert_eq!(bus.read(0, START + 3, 2).data, [1, 2]);
    assert_eq!(status(&mut bus), 0x30);
    let mut bus = Bus::new(1);
    bus.sync_manager(0, 2, START, 0, OUTPUTS);
    assert_eq!(bus.write(0, START, &[1]), 1, "length 0 is disabled too");
}

#[test]
fn wrong_direction_is_no_access() {
    for (control, command) in [
        (OUTPUTS, Command::Fprd),
        (MAILBOX_OUT, Command::Fprd),
        (INPUTS, Command::Fpwr),
        (MAILBOX_IN, Command::Fpwr),
    ] {
        let mut bus = with(control);
        bus.chip(0).write(START, &[7; LENGTH]);
        let answer = bus.one(command, physical_address(STATION, START), &[0xEE; LENGTH]);
        assert_eq!(
            (answer.wkc, answer.data),
            (0, vec![0xEE; LENGTH]),
            "{command:?} at control {control:#04x}"
        );
    }
}

#[test]
fn exchange_commands_do_the_half_that_the_direction_allows() {
    let at = physical_address(STATION, START);
    let mut bus = with(OUTPUTS);
    let answer = bus.one(Command::Fprw, at, &[5; LENGTH]);
    assert_eq!((answer.wkc, answer.data), (2, vec![5; LENGTH]));
    let mut bus = with(INPUTS);
    bus.chip(0).write(START, &[9; LENGTH]);
    let answer = bus.one(Command::Fprw, at, &[5; LENGTH]);
    assert_eq!((answer.wkc, answer.data), (1, vec![9; LENGTH]));
}

#[test]
fn inputs_never_written_cannot_be_read() {
    let mut bus = with(INPUTS);
    assert_eq!(status(&mut bus) & 0x30, 0x30);
    assert_eq!(bus.read(0, START, LENGTH).wkc, 0);
    bus.chip(0).write(START, &[1; LENGTH - 1]);
    assert_eq!(bus.read(0, START, LENGTH).wkc, 0, "not complete yet");
    bus.chip(0).write(START + LENGTH as u16 - 1, &[2]);
    assert_eq!(bus.read(0, START, LENGTH).data, [1, 1, 1, 1, 1, 1, 1, 2]);
    assert_eq!(bus.read(0, START, LENGTH).wkc, 1, "and again");
    assert_eq!(status(&mut bus) & 0x30, 0x00);
}

#[test]
fn access_must_begin_at_the_first_byte() {
    let mut bus = with(OUTPUTS);
    assert_eq!(bus.write(0, START + 1, &[1; 7]), 0);
    assert_eq!(
        bus.write(0, START - 1, &[1; 9]),
        1,
        "the byte before is plain memory, then the first follows"
    );
    let mut bus = with(INPUTS);
    bus.chip(0).write(START, &[1; LENGTH]);
    assert_eq!(bus.read(0, START + 7, 1).wkc, 0);
    assert_eq!(bus.read(0, START, 1).wkc, 1);
    assert_eq!(bus.read(0, START + 3, 2).wkc, 1, "open now");
    assert_eq!(bus.read(0, START + 7, 1).wkc, 1);
    assert_eq!(bus.read(0, START + 7, 1).wkc, 0, "complete and closed");
}

#[test]
fn second_and_third_buffer_are_out_of_reach() {
    let mut bus = with(OUTPUTS);
    for offset in [LENGTH, 2 * LENGTH, 3 * LENGTH - 1] {
        assert_eq!(bus.read(0, START + offset as u16, 1).wkc, 0);
        assert_eq!(bus.write(0, START + offset as u16, &[1]), 0);
        bus.chip(0).write(START + offset as u16, &[1]);
        assert_eq!(bus.chip(0).read_u8(START + offset as u16), 0);
    }
    assert_eq!(bus.write(0, START + 3 * LENGTH as u16, &[1]), 1);
    let mut bus = with(MAILBOX_OUT);
    assert_eq!(bus.write(0, START + LENGTH as u16, &[1]), 1, "a mailbox has but one");
}

#[test]
fn the_slave_can_lock_the_whole_area() {
    let mut bus = with(OUTPUTS);
    bus.write(0, START, &[1; LENGTH]);
    let pdi_control = SM + 2 * SM_SIZE + sync_manager::PDI_CONTROL;
    bus.chip(0).write_u8(pdi_control, sync_manager::PDI_DEACTIVATE);
    assert_eq!(bus.write(0, START, &[2; LENGTH]), 0);
    assert_eq!(bus.write(0, START + LENGTH as u16, &[2; LENGTH]), 0);
    assert_eq!(bus.chip(0).read_u8(START), 0);
    assert_eq!(status(&mut bus), 0x30, "buffers are reset");
    bus.chip(0).write_u8(pdi_control, 0);
    assert_eq!(bus.write(0, START, &[3; LENGTH]), 1);
    assert_eq!(bus.chip(0).read_u8(START), 3);
}

#[test]
fn a_single_byte_is_not_buffered_but_watched() {
    let mut bus = Bus::new(1);
    bus.sync_manager(0, 2, START, 1, OUTPUTS);
    bus.catch_up();
    assert_eq!(bus.read(0, START, 1).wkc, 1);
    assert!(!has_event(&mut bus), "reading is not what it waits for");
    let answer = bus.one(Command::Fprw, physical_address(STATION, START), &[5]);
    assert_eq!((answer.wkc, answer.data), (3, vec![0]));
    assert!(has_event(&mut bus));
    assert_eq!(bus.read_u8(0, PROCESS_WATCHDOG_STATUS), 1);
    assert_eq!(bus.chip(0).read_u8(START), 5);
    assert!(!has_event(&mut bus));
    assert_eq!(bus.write(0, START + 1, &[1, 1]), 1, "no further buffers");
}

#[test]
fn sync_managers_outside_of_process_memory_give_no_access() {
    for (start, length) in [(0x0F80, 0x100), (0x2FF0, 8), (0xFFFF, 0xFFFF)] {
        let mut bus = Bus::new(1);
        bus.sync_manager(0, 2, start, length, OUTPUTS);
        let at = start.clamp(0x1000, 0x2FFF);
        assert_eq!(bus.write(0, at, &[1]), u16::from(start > 0x3000), "{start:#06x}, {length:#06x}");
    }
}

#[test]
fn outputs_reach_the_slave_whole_and_newest_last() {
    let mut bus = with(OUTPUTS);
    bus.write(0, START, &[1; LENGTH]);
    bus.write(0, START, &[2; LENGTH]);
    bus.write(0, START, &[3; LENGTH - 1]);
    let mut data = [0; LENGTH];
    bus.chip(0).read(START, &mut data[..4]);
    bus.write(0, START + LENGTH as u16 - 1, &[3]);
    bus.write(0, START, &[4; LENGTH]);
    bus.write(0, START, &[5; LENGTH]);
    bus.chip(0).read(START + 4, &mut data[4..]);
    assert_eq!(data, [2; LENGTH], "a buffer being read does not change");
    bus.chip(0).read(START, &mut data);
    assert_eq!(data, [5; LENGTH]);
    bus.chip(0).read(START, &mut data);
    assert_eq!(data, [5; LENGTH], "nothing new: the same again");
}

#[test]
fn inputs_reach_the_bus_whole_and_newest_last() {
    let mut bus = with(INPUTS);
    bus.chip(0).write(START, &[1; LENGTH]);
    assert_eq!(bus.read(0, START, 4).data, [1; 4]);
    bus.chip(0).write(START, &[2; LENGTH]);
    bus.chip(0).write(START, &[3; LENGTH]);
    bus.chip(0).write(START, &[4; 4]);
    assert_eq!(bus.read(0, START + 4, 4).data, [1; 4]);
    assert_eq!(bus.read(0, START, LENGTH).data, [3; LENGTH]);
}

#[test]
fn events_come_with_the_last_byte_and_go_with_the_first() {
    let mut bus = with(OUTPUTS);
    assert_eq!(bus.write(0, START, &[1; 7]), 1);
    assert!(!has_event(&mut bus));
    assert_eq!(status(&mut bus), 0xB0, "being written, none written yet");
    assert_eq!(bus.write(0, START + 7, &[1]), 1);
    assert!(has_event(&mut bus));
    assert_eq!(status(&mut bus), 0x01);
    bus.chip(0).read_u8(START);
    assert!(!has_event(&mut bus));
    assert_eq!(status(&mut bus), 0x40);
    bus.chip(0).read(START + 1, &mut [0; 7]);
    assert_eq!(status(&mut bus), 0x02);

    let mut bus = with(INPUTS);
    bus.chip(0).write(START, &[1; LENGTH]);
    assert!(!has_event(&mut bus));
    bus.read(0, START, LENGTH);
    assert!(has_event(&mut bus), "the inputs were fetched");
    bus.chip(0).write_u8(START, 1);
    assert!(!has_event(&mut bus));
}

#[test]
fn events_need_their_control_bits() {
    let mut bus = with(OUTPUTS & !sync_manager::CONTROL_AL_EVENT);
    bus.write(0, START, &[1; LENGTH]);
    assert!(!has_event(&mut bus));
    let bit = 1 << 6;
    let mut bus = with(INPUTS);
    bus.chip(0).write(START, &[1; LENGTH]);
    assert_eq!(bus.read_u16(0, ECAT_EVENT_REQUEST) & bit, 0);
    let mut bus = with(INPUTS | sync_manager::CONTROL_ECAT_EVENT);
    bus.chip(0).write(START, &[1; LENGTH]);
    assert_eq!(bus.read_u16(0, ECAT_EVENT_REQUEST) & bit, bit);
    bus.read(0, START, 1);
    assert_eq!(bus.read_u16(0, ECAT_EVENT_REQUEST) & bit, 0);
}

#[test]
fn buffers_change_hands_at_the_end_of_good_frames_only() {
    let mut bus = with(OUTPUTS);
    let mut frame = [0; 100];
    let mut builder = wire::frame::FrameBuilder::new(&mut frame, bus::SOURCE).unwrap();
    builder
        .datagram(Command::Fpwr, 0, physical_address(STATION, START), &[1; LENGTH])
        .unwrap();
    let length = builder.finish();
    frame[16 + 7] |= 0x80;
    let now = Nanos(bus.now);
    assert_eq!(bus.segment.process(&mut frame[..length], now), esc::Processed::Malformed);
    assert!(!has_event(&mut bus));
    assert_eq!(status(&mut bus), 0x30);
    assert_eq!(bus.write(0, START + 7, &[1]), 0, "closed again");
    assert_eq!(bus.write(0, START, &[2; LENGTH]), 1);
    assert_eq!(bus.chip(0).read_u8(START), 2);
}

#[test]
fn mailbox_is_full_from_its_last_byte_written_to_its_last_byte_read() {
    let mut bus = with(MAILBOX_OUT);
    assert_eq!(status(&mut bus), 0);
    assert_eq!(bus.write(0, START, &[1; 7]), 1);
    assert_eq!(status(&mut bus) & 8, 0);
    assert_eq!(bus.chip(0).read_u8(START), 0, "nothing to read yet");
    assert_eq!(bus.write(0, START + 7, &[2]), 1);
    assert_eq!(status(&mut bus), 0x09);
    assert!(has_event(&mut bus));
    assert_eq!(bus.write(0, START, &[9; LENGTH]), 0, "full");
    let mut data = [0; LENGTH];
    bus.chip(0).read(START, &mut data[..6]);
    assert_eq!(bus.write(0, START, &[9; LENGTH]), 0, "still being read");
    bus.chip(0).read(START + 6, &mut data[6..]);
    assert_eq!(data, [1, 1, 1, 1, 1, 1, 1, 2]);
    assert!(!has_event(&mut bus));
    assert_eq!(bus.write(0, START, &[9; LENGTH]), 1);
}

#[test]
fn mail_of_the_slave_waits_until_fetched() {
    let mut bus = with(MAILBOX_IN);
    assert_eq!(bus.read(0, START, LENGTH).wkc, 0, "empty");
    bus.chip(0).write(START, &[1, 2, 3]);
    assert_eq!(bus.read(0, START, LENGTH).wkc, 0, "not complete");
    bus.chip(0).write(START + 7, &[8]);
    // IgH tests bit 3 of byte 5 of eight bytes; SOEM and ethercrab read the status byte alone.
    assert_eq!(bus.read(0, SM + 2 * SM_SIZE, 8).data[5] & 8, 8);
    assert_eq!(status(&mut bus) & 8, 8);
    bus.chip(0).write(START, &[7; LENGTH]);
    let answers = bus.send(&[
        (Command::Fprd, physical_address(STATION, START), &[0; LENGTH]),
        (Command::Fprd, physical_address(STATION, START), &[0; LENGTH]),
    ]);
    assert_eq!(
        (&answers[0].data[..], answers[0].wkc),
        (&[1, 2, 3, 0, 0, 0, 0, 8][..], 1),
        "no mail overwrites another"
    );
    assert_eq!(answers[1].wkc, 0, "once per mail");
    assert_eq!(status(&mut bus) & 8, 0);
    assert!(has_event(&mut bus));
    bus.chip(0).write(START, &[7; LENGTH]);
    assert!(!has_event(&mut bus));
    assert_eq!(bus.read(0, START, LENGTH).data, [7; LENGTH]);
}

#[test]
fn mail_taken_early_raises_no_event_later() {
    let mut bus = with(MAILBOX_OUT);
    bus.now += 1_000;
    bus.write(0, START, &[1; LENGTH]);
    bus.chip(0).read(START, &mut [0; LENGTH]);
    assert!(!has_event(&mut bus));
}

#[test]
fn configuration_of_an_enabled_sync_manager_cannot_be_changed() {
    let mut bus = with(MAILBOX_OUT);
    bus.write(0, START, &[1; LENGTH]);
    let base = SM + 2 * SM_SIZE;
    let before = bus.read(0, base, 8).data;
    assert_eq!(bus.write(0, base, &[0; 5]), 0);
    let mut rewrite = before.clone();
    rewrite[0] = 0x55;
    assert_eq!(bus.write(0, base, &rewrite), 1, "the activate byte is always writable");
    assert_eq!(bus.read(0, base, 8).data, before, "neither settings nor buffer have changed");
    assert_eq!(bus.write(0, base, &[0; 8]), 1);
    assert_eq!(
        bus.read(0, base, 8).data,
        [0x00, 0x11, 8, 0, MAILBOX_OUT, 0, 0, 0],
        "switched off, with its old settings"
    );
    assert_eq!(bus.write(0, base, &[0; 8]), 1);
    assert_eq!(bus.read(0, base, 8).data, [0, 0, 0, 0, 0, 0x30, 0, 0]);
}

#[test]
fn switching_off_and_on_resets_buffers_and_events() {
    let mut bus = with(MAILBOX_OUT);
    let activate = SM + 2 * SM_SIZE + sync_manager::ACTIVATE;
    bus.write(0, START, &[1; LENGTH]);
    assert!(has_event(&mut bus));
    bus.write(0, activate, &[0]);
    assert!(!has_event(&mut bus));
    bus.write(0, activate, &[1]);
    assert_eq!(status(&mut bus), 0);
    assert_eq!(bus.write(0, START, &[2; LENGTH]), 1);
}

#[test]
fn activation_is_reported_until_the_slave_reads_it() {
    let mut bus = Bus::new(1);
    bus.catch_up();
    assert!(!bus.chip(0).events().has(AlEvents::SM_ACTIVATION));
    bus.write(0, SM + 6, &[0]);
    bus.catch_up();
    assert!(bus.chip(0).events().has(AlEvents::SM_ACTIVATION));
    bus.chip(0).read(SM, &mut [0; 6]);
    assert!(bus.chip(0).events().has(AlEvents::SM_ACTIVATION));
    bus.chip(0).read(SM, &mut [0; 8]);
    assert!(!bus.chip(0).events().has(AlEvents::SM_ACTIVATION));
}

#[test]
fn repeat_request_is_passed_on_and_acknowledged() {
    let mut bus = with(MAILBOX_IN);
    let base = SM + 2 * SM_SIZE;
    bus.chip(0).write(START, &[1; LENGTH]);
    bus.catch_up();
    bus.chip(0).read(base, &mut [0; 8]);
    // SOEM writes status and activate as one word; the status byte is not writable.
    assert_eq!(bus.write(0, base + sync_manager::STATUS, &[0x08, 0x03]), 1);
    bus.catch_up();
    assert!(bus.chip(0).events().has(AlEvents::SM_ACTIVATION));
    assert_eq!(bus.chip(0).read_u8(base + sync_manager::ACTIVATE), 3);
    assert_eq!(status(&mut bus) & 8, 8, "the mail is still there");
    bus.chip(0).write_u8(base + sync_manager::PDI_CONTROL, sync_manager::PDI_REPEAT_ACK);
    assert_eq!(bus.read_u8(0, base + sync_manager::PDI_CONTROL), 2);
    assert_eq!(bus.read(0, START, LENGTH).wkc, 1, "acknowledging resets nothing");
}

#[test]
fn where_two_claim_the_same_memory_the_lower_number_has_it() {
    let mut bus = Bus::new(1);
    bus.sync_manager(0, 3, START, 16, MAILBOX_IN);
    bus.sync_manager(0, 1, START + 4, 4, MAILBOX_OUT);
    assert_eq!(bus.write(0, START + 4, &[1; 4]), 1);
    bus.chip(0).write(START, &[5; 16]);
    assert_eq!(bus.read(0, START, 16).data, [5, 5, 5, 5, 0, 0, 0, 0, 5, 5, 5, 5, 5, 5, 5, 5]);
}

#[test]
fn process_watchdog_runs_after_the_first_outputs_and_expires_without_more() {
    let mut bus = with(OUTPUTS);
    bus.pass(500_000_000);
    assert!(!bus.chip(0).events().has(AlEvents::PROCESS_WATCHDOG));
    bus.write(0, START, &[1; 4]);
    assert_eq!(bus.read_u8(0, PROCESS_WATCHDOG_STATUS), 0, "incomplete outputs are none");
    bus.write(0, START + 4, &[1; 4]);
    assert_eq!(bus.read_u8(0, PROCESS_WATCHDOG_STATUS), 1);
    bus.pass(99_999_999);
    assert_eq!(bus.chip(0).read_u8(PROCESS_WATCHDOG_STATUS), 1);
    bus.pass(1);
    assert!(bus.chip(0).events().has(AlEvents::PROCESS_WATCHDOG));
    assert_eq!(bus.chip(0).read_u8(PROCESS_WATCHDOG_STATUS), 0);
    assert!(!bus.chip(0).events().has(AlEvents::PROCESS_WATCHDOG), "acknowledged by reading");
    assert_eq!(bus.read_u8(0, PROCESS_WATCHDOG_COUNTER), 1);
    bus.write(0, START, &[1; LENGTH]);
    assert_eq!(bus.read_u8(0, PROCESS_WATCHDOG_STATUS), 1);
}

#[test]
fn process_watchdog_needs_its_control_bit_and_a_time() {
    let mut bus = with(OUTPUTS & !sync_manager::CONTROL_WATCHDOG);
    bus.write(0, START, &[1; LENGTH]);
    bus.pass(500_000_000);
    assert!(!bus.chip(0).events().has(AlEvents::PROCESS_WATCHDOG));
    let mut bus = with(OUTPUTS);
    bus.write(0, PROCESS_WATCHDOG_TIME, &[0, 0]);
    assert_eq!(bus.read_u8(0, PROCESS_WATCHDOG_STATUS), 1, "off");
    bus.write(0, START, &[1; LENGTH]);
    bus.pass(500_000_000);
    assert_eq!(bus.read_u8(0, PROCESS_WATCHDOG_STATUS), 1);
    bus.write(0, PROCESS_WATCHDOG_TIME, &[10, 0]);
    bus.write(0, WATCHDOG_DIVIDER, &[23, 0]);
    bus.pass(9_999);
    assert_eq!(
        bus.read_u8(0, PROCESS_WATCHDOG_STATUS),
        1,
        "10 ticks of 25 x 40 ns, from the change on"
    );
    bus.pass(1);
    assert_eq!(bus.read_u8(0, PROCESS_WATCHDOG_STATUS), 0);
}

#[test]
fn a_stall_of_the_master_is_seen_by_a_slave_that_catches_up_afterwards() {
    let mut bus = with(OUTPUTS);
    bus.write(0, START, &[1; LENGTH]);
    let stalled = bus.now;
    bus.now += 250_000_000;
    bus.write(0, START, &[2; LENGTH]);
    let chip = bus.chip(0);
    chip.advance(Nanos(stalled + 99_999_999));
    assert_eq!(
        (chip.events().has(AlEvents::PROCESS_WATCHDOG), chip.read_u8(PROCESS_WATCHDOG_STATUS)),
        (false, 1)
    );
    chip.advance(Nanos(stalled + 100_000_000));
    assert!(chip.events().has(AlEvents::PROCESS_WATCHDOG));
    assert_eq!(chip.read_u8(PROCESS_WATCHDOG_STATUS), 0);
    chip.advance(Nanos(stalled + 250_000_000));
    assert_eq!(chip.read_u8(PROCESS_WATCHDOG_STATUS), 1);
    assert!(!chip.events().has(AlEvents::PROCESS_WATCHDOG));
}
