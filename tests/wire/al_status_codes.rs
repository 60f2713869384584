//! Every AL status code the drive has: a way to each (ETG.1000.6, AL status codes).

use std::collections::BTreeSet;
use std::time::Duration;

use rig::raw::{INPUT_SIZE, OUTPUT_SIZE, RawMaster};
use wire::al::AlState::{self, Init, Op, PreOp, SafeOp};
use wire::al::AlStatusCode::{self, *};
use wire::register as reg;

const OUTPUTS: u16 = OUTPUT_SIZE as u16;
/// Bits of the activation register.
const SYNC0: u8 = 0b011;
const SYNC0_AND_1: u8 = 0b111;
const MILLISECOND: u32 = 1_000_000;
/// Nine gaps of 224 bits: more than half of the longest process image.
const WIDE_ENTRIES: u8 = 9;
const WIDE_GAP: u32 = 0x0000_00E0;

/// A way to a status: what it is, the state it begins in, what the master does, AL status and code at its end.
type Row = (&'static str, AlState, fn(&mut RawMaster), u16, AlStatusCode);

// A row a line.
#[rustfmt::skip]
const ROWS: [Row; 47] = [
    ("OP from INIT", Init, |it| _ = it.request(8), 0x11, InvalidStateChange),
    ("SAFEOP from INIT", Init, |it| _ = it.request(4), 0x11, InvalidStateChange),
    ("OP from PREOP", PreOp, |it| _ = it.request(8), 0x12, InvalidStateChange),
    ("BOOT from OP", Op, |it| _ = it.request(3), 0x18, InvalidStateChange),
    ("state 7", SafeOp, |it| _ = it.request(7), 0x14, UnknownState),
    ("BOOT", Init, |it| _ = it.request(3), 0x11, BootNotSupported),
    // Mailboxes.
    ("mailbox of 35 bytes", Init, |it| mailbox(it, 0, 0x1000, 35, 0x26), 0x11, InvalidMailboxConfiguration),
    ("mailbox of 129 bytes", Init, |it| mailbox(it, 0, 0x1000, 129, 0x26), 0x11, InvalidMailboxConfiguration),
    ("mailbox of three buffers", Init, |it| mailbox(it, 0, 0x1000, 128, 0x24), 0x11, InvalidMailboxConfiguration),
    ("mailbox the wrong way", Init, |it| mailbox(it, 1, 0x1080, 128, 0x26), 0x11, InvalidMailboxConfiguration),
    ("mailboxes that overlap", Init, |it| mailbox(it, 1, 0x1040, 128, 0x22), 0x11, InvalidMailboxConfiguration),
    ("mailbox off in OP", Op, |it| it.set_sync_manager(0, 0x1000, 128, 0x26, false), 0x11, InvalidMailboxConfiguration),
    // Process data.
    ("outputs too short", PreOp, |it| safeop(it, OUTPUTS - 1, INPUT_SIZE), 0x12, InvalidOutputConfiguration),
    ("outputs too long", PreOp, |it| safeop(it, OUTPUTS + 1, INPUT_SIZE), 0x12, InvalidOutputConfiguration),
    ("no outputs", PreOp, |it| safeop(it, 0, INPUT_SIZE), 0x12, InvalidOutputConfiguration),
    ("outputs the wrong way", PreOp, |it| process_data(it, 2, 0x1100, OUTPUTS, 0x60), 0x12, InvalidOutputConfiguration),
    ("outputs on a mailbox", PreOp, |it| process_data(it, 2, 0x10FD, OUTPUTS, 0x64), 0x12, InvalidOutputConfiguration),
    ("outputs moved in OP", Op, |it| it.set_sync_manager(2, 0x1200, OUTPUTS, 0x64, true), 0x12, InvalidOutputConfiguration),
    ("inputs too short", PreOp, |it| safeop(it, OUTPUTS, INPUT_SIZE - 1), 0x12, InvalidInputConfiguration),
    ("inputs too long", PreOp, |it| safeop(it, OUTPUTS, INPUT_SIZE + 1), 0x12, InvalidInputConfiguration),
    ("no inputs", PreOp, |it| safeop(it, OUTPUTS, 0), 0x12, InvalidInputConfiguration),
    ("inputs the wrong way", PreOp, |it| process_data(it, 3, 0x1400, INPUT_SIZE, 0x24), 0x12, InvalidInputConfiguration),
    ("inputs on the outputs", PreOp, |it| process_data(it, 3, 0x1108, INPUT_SIZE, 0x20), 0x12, InvalidInputConfiguration),
    ("inputs off in SAFEOP", SafeOp, |it| it.set_sync_manager(3, 0x1400, INPUT_SIZE, 0x20, false), 0x12, InvalidInputConfiguration),
    ("watchdog of no time", PreOp, watchdog_without_time, 0x12, InvalidWatchdogConfiguration),
    ("TxPDOs beyond the image", PreOp, |it| two_wide_pdos(it, 0x1A00, 0x1C13), 0x12, InvalidInputMapping),
    ("RxPDOs beyond the image", PreOp, |it| two_wide_pdos(it, 0x1600, 0x1C12), 0x12, InvalidOutputMapping),
    // Synchronisation.
    ("free run with one buffer", PreOp, free_run_with_one_buffer, 0x12, FreeRunNeedsThreeBuffers),
    ("clock without a signal", PreOp, |it| clocks(it, 0b001, MILLISECOND, 0), 0x12, InvalidDcSyncConfiguration),
    ("SYNC1 without SYNC0", PreOp, |it| clocks(it, 0b101, MILLISECOND, 0), 0x12, InvalidDcSyncConfiguration),
    ("cycles below SYNC0", PreOp, |it| clocks(it, SYNC0_AND_1, MILLISECOND, 4 * MILLISECOND), 0x12, InvalidDcSyncConfiguration),
    ("SYNC0 asked for, clock off", PreOp, |it| sync_type(it, 0x1C32, 2, 0), 0x12, InvalidDcSyncConfiguration),
    ("SYNC1 asked for, not set up", PreOp, |it| sync_type(it, 0x1C33, 3, SYNC0), 0x12, InvalidDcSyncConfiguration),
    ("SYNC0 faster than 500 us", PreOp, |it| clocks(it, SYNC0, 499_999, 0), 0x12, InvalidSync0CycleTime),
    ("SYNC0 of a single shot", PreOp, |it| clocks(it, SYNC0, 0, 0), 0x12, InvalidSync0CycleTime),
    ("no outputs on the way to OP", SafeOp, |it| op_that_never_comes(it), 0x14, SyncManagerWatchdog),
    ("outputs stop in OP", Op, |it| it.wait(Duration::from_millis(150)), 0x14, SyncManagerWatchdog),
    ("no SYNC0 on the way to OP", PreOp, sync0_that_never_comes, 0x14, NoSyncSignal),
    ("SYNC0 stops in OP", PreOp, sync0_that_stops, 0x14, FatalSyncError),
    ("outputs missing before SYNC0", PreOp, outputs_out_of_step, 0x14, SynchronizationError),
    // No error.
    ("INIT", Op, |it| _ = it.request(1), 0x01, None),
    ("PREOP", Op, |it| _ = it.request(2), 0x02, None),
    ("SAFEOP", Op, |it| _ = it.request(4), 0x04, None),
    ("SYNC0", PreOp, |it| clocks(it, SYNC0, MILLISECOND, 0), 0x04, None),
    ("SYNC0 of 500 us", PreOp, |it| clocks(it, SYNC0, 500_000, 0), 0x04, None),
    ("SYNC1 after SYNC0", PreOp, |it| clocks(it, SYNC0_AND_1, MILLISECOND, 250_000), 0x04, None),
    ("the same sync managers again", Op, set_up_again, 0x08, None),
];

fn mailbox(master: &mut RawMaster, number: u16, start: u16, length: u16, control: u8) {
    master.set_sync_manager(number, start, length, control, true);
    master.request(2);
}

fn safeop(master: &mut RawMaster, outputs: u16, inputs: u16) {
    master.set_process_data(outputs, inputs);
    master.request(4);
}

fn process_data(master: &mut RawMaster, number: u16, start: u16, length: u16, control: u8) {
    master.set_sync_manager(number, start, length, control, true);
    master.request(4);
}

fn watchdog_without_time(master: &mut RawMaster) {
    assert!(master.write(reg::PROCESS_WATCHDOG_TIME, &[0, 0]));
    master.request(4);
}

/// Maps gaps into the first two PDOs of a direction, each as long as fits, and assigns both.
fn two_wide_pdos(master: &mut RawMaster, mapping: u16, assignment: u16) {
    for pdo in [mapping, mapping + 1] {
        master.download(pdo, 0, &[0]).unwrap();
        for sub in 1..=WIDE_ENTRIES {
            master.download(pdo, sub, &WIDE_GAP.to_le_bytes()).unwrap();
        }
        master.download(pdo, 0, &[WIDE_ENTRIES]).unwrap();
    }
    master.download(assignment, 0, &[0]).unwrap();
    master.download(assignment, 1, &mapping.to_le_bytes()).unwrap();
    master.download(assignment, 2, &(mapping + 1).to_le_bytes()).unwrap();
    master.download(assignment, 0, &[2]).unwrap();
    master.request(4);
}

fn free_run_with_one_buffer(master: &mut RawMaster) {
    master.set_sync_manager(2, 0x1100, OUTPUTS, 0x66, true);
    master.download(0x1C32, 1, &[0, 0]).unwrap();
    master.request(4);
}

fn clocks(master: &mut RawMaster, activation: u8, sync0: u32, sync1: u32) {
    master.set_sync_unit(activation, sync0, sync1);
    master.request(4);
}

fn sync_type(master: &mut RawMaster, object: u16, kind: u8, activation: u8) {
    master.download(object, 1, &[kind, 0]).unwrap();
    clocks(master, activation, MILLISECOND, 0);
}

fn op_that_never_comes(master: &mut RawMaster) {
    // Outputs of before are too old to count.
    master.wait(Duration::from_millis(200));
    assert_eq!(master.request(8), (4, 0), "waiting");
    master.wait(Duration::from_secs(9));
}

fn sync0_that_never_comes(master: &mut RawMaster) {
    clocks(master, SYNC0, MILLISECOND, 0);
    // A start long past: the clock would have to wrap around.
    assert!(master.write(reg::DC_ACTIVATION, &[0]));
    assert!(master.write(reg::DC_START_TIME, &u64::MAX.to_le_bytes()));
    assert!(master.write(reg::DC_ACTIVATION, &[SYNC0]));
    master.request(8);
    master.cycles(9_000);
}

/// OP in step with SYNC0 of 1 ms.
fn op_with_sync0(master: &mut RawMaster) {
    clocks(master, SYNC0, MILLISECOND, 0);
    master.request(8);
    master.cycles(20);
    assert_eq!(master.al_status(), (8, 0));
}

fn sync0_that_stops(master: &mut RawMaster) {
    op_with_sync0(master);
    assert!(master.write(reg::DC_ACTIVATION, &[0]));
    master.cycles(3);
}

fn outputs_out_of_step(master: &mut RawMaster) {
    op_with_sync0(master);
    master.wait(Duration::from_millis(3));
    assert_eq!(master.upload(0x1C32, 0x20), Ok(vec![1]), "sync error is shown");
}

fn set_up_again(master: &mut RawMaster) {
    let all = master.read(reg::SM, 4 * usize::from(reg::SM_SIZE)).expect("sync managers");
    assert!(master.write(reg::SM, &all));
}

#[test]
fn every_way_to_a_code_ends_with_it_and_init_leads_out() {
    for (what, from, act, status, code) in ROWS {
        let mut master = RawMaster::in_state(from);
        act(&mut master);
        assert_eq!(master.al_status(), (status, code.code()), "{what}");
        assert!(master.write(reg::DC_ACTIVATION, &[0]));
        assert_eq!(master.request(0x11), (1, 0), "{what}: acknowledged by INIT");
        master.set_mailboxes(128);
        assert_eq!(master.request(2), (2, 0), "{what}: the next master finds the drive ready");
    }
}

#[test]
fn an_error_shows_until_it_is_acknowledged_with_the_present_state() {
    for (what, from, act, status, code) in ROWS {
        if code == None || status & 0x0F == 0x01 {
            continue;
        }
        let mut master = RawMaster::in_state(from);
        act(&mut master);
        let state = status & 0x0F;
        assert_eq!(master.request(state), (status, code.code()), "{what}: not without acknowledge");
        assert_eq!(master.request(state | 0x10).0, state, "{what}: acknowledged");
    }
}

#[test]
fn every_code_has_a_row() {
    let provoked: BTreeSet<u16> = ROWS.iter().map(|row| row.4.code()).collect();
    let known: BTreeSet<u16> = AlStatusCode::ALL.iter().map(|code| code.code()).collect();
    assert_eq!(provoked, known);
}
