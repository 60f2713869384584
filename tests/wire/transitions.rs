//! Every request to the state machine in every state (ETG.1000.6, EtherCAT state machine).

use rig::raw::{OUTPUT_SIZE, RawMaster};
use wire::al::AlState;

const STATES: [AlState; 4] = [AlState::Init, AlState::PreOp, AlState::SafeOp, AlState::Op];

/// AL status and AL status code after a request, in the order of [`STATES`], when no error waits to be acknowledged.
type Answers = [(u16, u16); 4];

const UNKNOWN: Answers = [(0x11, 0x12), (0x12, 0x12), (0x14, 0x12), (0x18, 0x12)];

/// A row for each value of bits 3:0 of AL control.
const MATRIX: [Answers; 16] = [
    UNKNOWN,
    [(0x01, 0), (0x01, 0), (0x01, 0), (0x01, 0)],
    [(0x02, 0), (0x02, 0), (0x02, 0), (0x02, 0)],
    [(0x11, 0x13), (0x12, 0x11), (0x14, 0x11), (0x18, 0x11)],
    [(0x11, 0x11), (0x04, 0), (0x04, 0), (0x04, 0)],
    UNKNOWN,
    UNKNOWN,
    UNKNOWN,
    [(0x11, 0x11), (0x12, 0x11), (0x08, 0), (0x08, 0)],
    UNKNOWN,
    UNKNOWN,
    UNKNOWN,
    UNKNOWN,
    UNKNOWN,
    UNKNOWN,
    UNKNOWN,
];

const ACKNOWLEDGE: u16 = 0x10;
const INIT: u16 = 0x01;

/// Writes AL control; a master on its way to OP sends outputs too.
fn answer(master: &mut RawMaster, control: u16) -> (u16, u16) {
    master.request(control);
    master.send_outputs();
    master.al_status()
}

#[test]
fn every_request_in_every_state_is_answered_as_the_matrix_says() {
    for (request, answers) in (0..).zip(MATRIX) {
        for (from, expected) in STATES.into_iter().zip(answers) {
            for acknowledge in [0, ACKNOWLEDGE] {
                let mut master = RawMaster::in_state(from);
                let control = request | acknowledge;
                assert_eq!(answer(&mut master, control), expected, "{} <- 0x{control:02X}", from.name());
            }
        }
    }
}

#[test]
fn while_an_error_waits_only_init_and_acknowledged_requests_count() {
    for (request, answers) in (0..).zip(MATRIX) {
        for (from, expected) in STATES.into_iter().zip(answers) {
            for acknowledge in [0, ACKNOWLEDGE] {
                let mut master = RawMaster::in_state(from);
                let waiting = answer(&mut master, 0x0F);
                assert_eq!(waiting, (u16::from(from.code()) | 0x10, 0x12));
                let counts = acknowledge != 0 || request == INIT;
                let control = request | acknowledge;
                assert_eq!(
                    answer(&mut master, control),
                    if counts { expected } else { waiting },
                    "{} with an error <- 0x{control:02X}",
                    from.name()
                );
            }
        }
    }
}

#[test]
fn al_control_takes_the_next_request_right_after_the_last() {
    let mut master = RawMaster::in_state(AlState::Init);
    for control in [0x11, 0x12, 0x14, 0x12, 0x11, 0x12] {
        assert_eq!(answer(&mut master, control), (control & 0x0F, 0));
    }
}

#[test]
fn process_data_have_a_working_counter_from_safeop_on_and_lose_it_below() {
    for above in [AlState::SafeOp, AlState::Op] {
        for below in [AlState::Init, AlState::PreOp] {
            let mut master = RawMaster::in_state(above);
            assert!(master.send_outputs() && master.read_inputs().is_some());
            master.request(below.code().into());
            assert!(!master.send_outputs(), "outputs from {} to {}", above.name(), below.name());
            assert_eq!(master.read_inputs(), None, "inputs from {} to {}", above.name(), below.name());
            for state in [AlState::PreOp, AlState::SafeOp, AlState::Op] {
                answer(&mut master, state.code().into());
            }
            assert_eq!(master.al_status(), (8, 0), "the same sync managers serve again");
            assert!(master.send_outputs() && master.read_inputs().is_some());
        }
    }
}

#[test]
fn an_error_that_ends_safeop_takes_the_process_data_away_until_the_next_one() {
    let mut master = RawMaster::in_state(AlState::Op);
    master.set_sync_manager(2, 0x1200, OUTPUT_SIZE as u16, 0x64, true);
    assert_eq!(master.al_status(), (0x12, 0x1D));
    assert_eq!(master.request(0x12), (2, 0), "acknowledged");
    assert_eq!(master.read_inputs(), None);
    assert_eq!(master.request(4), (4, 0));
    assert!(master.read_inputs().is_some());
}
