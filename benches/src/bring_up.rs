//! From power-on to Operation Enabled in CSP, register by register.

use std::time::Duration;

use device::layout::{self, SyncManager};
use raw_master::{Datagram, Direction, fmmu, sync_manager};
use usr2556e::master::process_data::{mode, statusword, towards_enabled};
use wire::al::AlState;
use wire::frame::{Command, physical_address};
use wire::register::{AL_CONTROL, AL_STATUS, FMMU, FMMU_SIZE, SM, SM_SIZE, STATION_ADDRESS};

use crate::bus::Bus;
use crate::cyclic::Cycle;

/// Time between two cyclic exchanges, and between two looks at a state.
pub const CYCLE: Duration = Duration::from_millis(1);

/// Looks at a state, or exchanges, until the drives must have done what they were asked.
const PATIENCE: usize = 5000;

/// Station address of the drive at `position`.
pub const fn station(position: usize) -> u16 {
    0x1001 + position as u16
}

/// Brings all drives to OP over the process data of `cycle`; they follow its outputs with each frame from then on.
///
/// # Panics
/// A drive does not get there, with what it said.
pub fn to_op(bus: &mut impl Bus, cycle: &mut Cycle) {
    let drives = cycle.outputs.len();
    for position in 0..drives {
        let address = physical_address((position as u16).wrapping_neg(), STATION_ADDRESS);
        access(bus, Command::Apwr, address, &mut station(position).to_le_bytes());
        let [mailbox_out, mailbox_in, ..] = &layout::SYNC_MANAGERS;
        set_sync_manager(bus, position, 0, mailbox_out);
        set_sync_manager(bus, position, 1, mailbox_in);
    }
    change_state(bus, drives, AlState::PreOp);
    for position in 0..drives {
        let [.., outputs, inputs] = &layout::SYNC_MANAGERS;
        set_sync_manager(bus, position, 2, outputs);
        set_sync_manager(bus, position, 3, inputs);
        set_fmmu(bus, position, 0, cycle.outputs_at(position).start, outputs, Direction::Write);
        set_fmmu(bus, position, 1, cycle.inputs_at(position).start, inputs, Direction::Read);
    }
    change_state(bus, drives, AlState::SafeOp);
    request_state(bus, drives, AlState::Op);
    let reached = (0..PATIENCE).any(|_| {
        bus.pause(CYCLE);
        let worked = cycle.run(bus);
        worked && (0..drives).all(|position| is_in(bus, position, AlState::Op))
    });
    assert!(reached, "the drives do not reach OP");
}

/// Leads all drives in OP to Operation Enabled in CSP, standing where they are.
///
/// # Panics
/// A drive does not get there, with its statusword.
pub fn enable(bus: &mut impl Bus, cycle: &mut Cycle) {
    for _ in 0..PATIENCE {
        bus.pause(CYCLE);
        assert!(cycle.run(bus), "a drive has left OP");
        for (outputs, inputs) in cycle.outputs.iter_mut().zip(&cycle.inputs) {
            outputs.mode = mode::CYCLIC_POSITION;
            outputs.target_position = inputs.position;
            outputs.controlword = towards_enabled(inputs.statusword, outputs.controlword);
        }
        if cycle.inputs.iter().all(|inputs| statusword::is_enabled(inputs.statusword)) {
            return;
        }
    }
    panic!("the drives do not reach Operation Enabled: {:?}", cycle.inputs);
}

fn change_state(bus: &mut impl Bus, drives: usize, state: AlState) {
    request_state(bus, drives, state);
    for position in 0..drives {
        let reached = (0..PATIENCE).any(|_| {
            bus.pause(CYCLE);
            is_in(bus, position, state)
        });
        assert!(reached, "drive {position} does not reach {}", state.name());
    }
}

fn request_state(bus: &mut impl Bus, drives: usize, state: AlState) {
    for position in 0..drives {
        write(bus, position, AL_CONTROL, &u16::from(state.code()).to_le_bytes());
    }
}

fn is_in(bus: &mut impl Bus, position: usize, state: AlState) -> bool {
    let mut status = [0; 6];
    access(bus, Command::Fprd, physical_address(station(position), AL_STATUS), &mut status);
    assert_eq!(
        status[0] & 0x10,
        0,
        "drive {position} refuses {} with AL status {status:02X?}",
        state.name()
    );
    status[0] == state.code()
}

fn set_sync_manager(bus: &mut impl Bus, position: usize, index: u16, sm: &SyncManager) {
    let bytes = sync_manager(sm.start, sm.length, sm.control);
    write(bus, position, SM + SM_SIZE * index, &bytes);
}

fn set_fmmu(bus: &mut impl Bus, position: usize, index: u16, logical: usize, sm: &SyncManager, direction: Direction) {
    write(bus, position, FMMU + FMMU_SIZE * index, &fmmu(logical as u32, sm, direction));
}

fn write(bus: &mut impl Bus, position: usize, register: u16, data: &[u8]) {
    access(
        bus,
        Command::Fpwr,
        physical_address(station(position), register),
        &mut data.to_vec(),
    );
}

/// One datagram to one drive, which must answer it.
fn access(bus: &mut impl Bus, command: Command, address: u32, data: &mut [u8]) {
    let mut datagrams = [Datagram::new(command, address, data.to_vec())];
    raw_master::exchange(&mut datagrams, |frame| {
        bus.exchange(frame);
        true
    });
    let [answer] = datagrams;
    assert_eq!(answer.counter, 1, "no drive answers {command:?} at {address:#010x}");
    data.copy_from_slice(&answer.data);
}
