//! The way to PREOP from wherever the drives are, and on to OP: what a master does first of all, and what must always work.

use device::layout::SYNC_MANAGERS;
use raw_master::{Direction, fmmu, sync_manager};
use wire::EscAccess;
use wire::al::AlState;
use wire::register::{
    AL_CONTROL, AL_STATUS, DL_CONTROL, ESC_WRITE_ENABLE, FMMU, FMMU_SIZE, SM, SM_SIZE, TYPE, WRITE_REGISTER_ENABLE,
    WRITE_REGISTER_PROTECTION,
};

use crate::bus::Bus;

/// Acknowledge bit of AL control.
const ACKNOWLEDGE: u8 = 0x10;
/// What ends write protection, both enables before what they enable; and the DL control of after power-on, by which loops follow the links.
const UNLOCKED_AND_OPEN: [(u16, &[u8]); 4] = [
    (WRITE_REGISTER_ENABLE, &[1]),
    (ESC_WRITE_ENABLE, &[1, 0]),
    (WRITE_REGISTER_PROTECTION, &[0]),
    (DL_CONTROL, &[0x01, 0x00, 0x07, 0x00]),
];
/// Loop control of port 0 that closes it for good.
const CLOSED: u8 = 0b11;
/// How long a drive may take for a change of state, in ns.
const STATE_CHANGE: u64 = 200_000;

/// Leads every drive to PREOP with mailboxes of `length` bytes, whatever has happened to them before.
///
/// # Panics
/// If a drive does not get there: that is the finding.
pub fn to_preop(bus: &mut Bus, length: u16) {
    reach_everyone(bus);
    request(bus, AlState::Init);
    // The settings of a sync manager can be written only when it is off.
    for _ in 0..2 {
        bus.write_all(SM, &[0; 8 * SM_SIZE as usize]);
    }
    bus.write_all(FMMU, &[0; 8 * FMMU_SIZE as usize]);
    let count = bus.drives().len();
    assert_eq!(bus.write_all(SM, &mailboxes(length)), count, "mailboxes cannot be set up");
    request(bus, AlState::PreOp);
}

/// Leads drives from PREOP to SAFEOP with the default process data, each at its own logical address.
pub fn to_safeop(bus: &mut Bus) {
    for index in [2, 3] {
        let manager = SYNC_MANAGERS[index];
        bus.write_all(
            SM + index as u16 * SM_SIZE,
            &sync_manager(manager.start, manager.length, manager.control),
        );
    }
    for position in 0..bus.drives().len() as u16 {
        for index in [2, 3] {
            bus.write_at(position, FMMU + (index as u16 - 2) * FMMU_SIZE, &logical(position, index));
        }
    }
    request(bus, AlState::SafeOp);
}

/// Leads drives from SAFEOP to OP by sending outputs of zero.
pub fn to_op(bus: &mut Bus) {
    bus.write_all(AL_CONTROL, &[AlState::Op.code(), 0]);
    for _ in 0..4 {
        let outputs = SYNC_MANAGERS[2];
        bus.write_all(outputs.start, &vec![0; outputs.length.into()]);
        bus.wait(STATE_CHANGE);
    }
    assert_state(bus, AlState::Op);
}

/// Ends write protection, and undoes what closed loops do to the way of frames. A drive whose port towards the master was closed for good can be reached no more,
/// here as with a real one; it is switched off and on.
fn reach_everyone(bus: &mut Bus) {
    let count = bus.drives().len();
    for attempt in 0..2 {
        // Each frame at least opens a port that waits for one, or gets one drive further.
        for _ in 0..=2 * count {
            bus.write_all_at_once(&UNLOCKED_AND_OPEN);
        }
        let (reached, _) = bus.read_all::<1>(TYPE);
        if reached == count {
            return;
        }
        assert_eq!(attempt, 0, "{reached} of {count} drives can be reached");
        for position in 0..count {
            if bus.chip_mut(position).read_u8(DL_CONTROL + 1) & 0b11 == CLOSED {
                bus.drives_mut()[position].power_cycle();
            }
        }
    }
}

/// Asks every drive for a state, and sees that it takes it.
fn request(bus: &mut Bus, state: AlState) {
    let count = bus.drives().len();
    assert_eq!(bus.write_all(AL_CONTROL, &[state.code() | ACKNOWLEDGE, 0]), count, "AL control");
    bus.wait(STATE_CHANGE);
    assert_state(bus, state);
}

fn assert_state(bus: &mut Bus, state: AlState) {
    for drive in bus.drives() {
        let status = drive.status();
        assert_eq!(status.al_state, state, "{:?}", status.al_status_code);
    }
    let count = bus.drives().len();
    assert_eq!(bus.read_all(AL_STATUS), (count, [state.code(), 0]));
}

/// The registers of both mailboxes' sync managers.
fn mailboxes(length: u16) -> Vec<u8> {
    SYNC_MANAGERS[..2]
        .iter()
        .flat_map(|manager| sync_manager(manager.start, length, manager.control))
        .collect()
}

/// The registers of the FMMU for a sync manager's process data: 64 bytes of logical addresses a drive, inputs behind outputs.
fn logical(position: u16, index: usize) -> [u8; FMMU_SIZE as usize] {
    let (offset, direction) = if index == 3 { (32, Direction::Read) } else { (0, Direction::Write) };
    let address = 0x1_0000 + 64 * u32::from(position) + offset;
    fmmu(address, &SYNC_MANAGERS[index], direction)
}
