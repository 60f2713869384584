//! Drives plugged together otherwise than in a line, cables that break, a slave controller that is reset.

use std::cell::RefCell;
use std::rc::Rc;
use std::time::Duration;

use esc::{End, Side};
use ethercrab::RegisterAddress;
use rig::CYCLE;
use usr2556e::clock::Clock;
use usr2556e::drive::DriveConfig;
use usr2556e::master::{self, bring_up};
use usr2556e::segment::{InMemory, VirtualSegment};
use wire::al::{AlState, AlStatusCode};
use wire::register;

/// Time from one drive to the next.
const HOP: u32 = (esc::segment::PROCESSING_DELAY_NS + esc::segment::WIRE_DELAY_NS) as u32;

type Wire = Rc<RefCell<InMemory>>;

fn wire(segment: VirtualSegment) -> Wire {
    Rc::new(RefCell::new(InMemory::new(segment, Clock::lock_step())))
}

fn port(position: usize, port: usize) -> End {
    End::Port { position, port }
}

/// Two drives behind port 1 of the first and two behind its port 2.
fn branches() -> VirtualSegment {
    let mut segment = VirtualSegment::new((0..5).map(|position| DriveConfig {
        ports: if position == 0 { 3 } else { 2 },
        ..DriveConfig::numbered(position)
    }));
    assert_eq!(segment.disconnect(port(3, 0)), Some(port(2, 1)));
    segment.connect(port(0, 2), port(3, 0)).unwrap();
    segment
}

fn al_state(wire: &Wire, position: usize) -> AlState {
    wire.borrow().segment().drives()[position].status().al_state
}

#[test]
fn branches_are_scanned_in_the_order_of_ports_with_the_clocks_true_delays() {
    let mut link = wire(branches());
    let found = master::run(&mut link, async |main, pace| {
        let group = bring_up::scan(main, pace).await.unwrap();
        group
            .iter(main)
            .map(|drive| (drive.identity().serial, drive.propagation_delay()))
            .collect::<Vec<_>>()
    });
    assert_eq!(found.unwrap(), [(1, 0), (2, HOP), (3, 2 * HOP), (4, 5 * HOP), (5, 6 * HOP)]);
}

#[test]
fn branches_run_in_op_on_one_time() {
    let mut link = wire(branches());
    let ran = master::run(&mut link, async |main, pace| {
        let group = bring_up::scan(main, pace).await.unwrap();
        let group = bring_up::to_op_with_clocks(main, pace, group, CYCLE).await.unwrap();
        for _ in 0..500 {
            let (all_op, next) = bring_up::exchange_with_clocks(main, pace, &group).await.unwrap();
            assert!(all_op);
            pace.until(next).await;
        }
        for drive in group.iter(main) {
            let difference: u32 = drive.register_read(RegisterAddress::DcSystemTimeDifference).await.unwrap();
            assert!(difference & 0x7FFF_FFFF < 100, "system time difference {difference:#x}");
        }
    });
    ran.unwrap();
}

#[test]
fn a_branch_that_is_unplugged_leaves_the_others_to_a_new_scan() {
    let link = wire(branches());
    let scan = || {
        let found = master::run(&mut link.clone(), async |main, pace| {
            let group = bring_up::scan(main, pace).await.unwrap();
            group.iter(main).map(|drive| drive.identity().serial).collect::<Vec<_>>()
        });
        found.unwrap()
    };
    link.borrow_mut().segment_mut().disconnect(port(0, 1));
    assert_eq!(scan(), [1, 4, 5]);
    link.borrow_mut().segment_mut().connect(port(4, 1), port(1, 0)).unwrap();
    assert_eq!(scan(), [1, 4, 5, 2, 3], "plugged in again elsewhere");
}

#[test]
fn behind_a_broken_cable_drives_leave_op_and_those_before_it_stay() {
    let mut link = wire(VirtualSegment::of(3));
    let hand = link.clone();
    let ran = master::run(&mut link, async |main, pace| {
        let group = bring_up::scan(main, pace).await.unwrap();
        let group = bring_up::to_op(main, pace, group, CYCLE).await.unwrap();
        assert_eq!(group.tx_rx(main).await.unwrap().working_counter, 9);
        hand.borrow_mut().segment_mut().disconnect(port(1, 1));
        for _ in 0..150 {
            // The master may call the missing answers an error; the frame went out all the same.
            let _ = group.tx_rx(main).await;
            pace.pause(CYCLE).await;
        }
        assert_eq!(
            [0, 1, 2].map(|position| al_state(&hand, position)),
            [AlState::Op, AlState::Op, AlState::SafeOp]
        );
        let code = hand.borrow().segment().drives()[2].status().al_status_code;
        assert_eq!(code, AlStatusCode::SyncManagerWatchdog);
        hand.borrow_mut().segment_mut().connect(port(1, 1), port(2, 0)).unwrap();
        let drive = group.subdevice(main, 2).unwrap();
        let status: u16 = drive.register_read(register::AL_STATUS).await.unwrap();
        assert_eq!(status, 0x14, "it kept its address, and tells of the error");
    });
    ran.unwrap();
}

#[test]
fn a_ring_gives_its_frames_back_at_the_other_end() {
    let mut segment = VirtualSegment::of(2);
    segment.connect(port(1, 1), End::Master(Side::Secondary)).unwrap();
    let mut frame = [0; 60];
    frame[12..16].copy_from_slice(&[0x88, 0xA4, 13, 0x10]);
    frame[16] = 7;
    frame[22] = 1;
    assert!(!segment.process(&mut frame, wire::Nanos(1)));
    assert_eq!(
        segment.process_from(Side::Primary, &mut frame, wire::Nanos(2)),
        Some(Side::Secondary)
    );
    assert_eq!(frame[27], 4, "two drives, twice");
}

#[test]
fn a_reset_by_register_restarts_the_drive() {
    let mut link = wire(VirtualSegment::of(2));
    let hand = link.clone();
    let ran = master::run(&mut link, async |main, pace| {
        let group = bring_up::scan(main, pace).await.unwrap();
        let group = bring_up::to_op(main, pace, group, CYCLE).await.unwrap();
        let drive = group.subdevice(main, 1).unwrap();
        for letter in *b"RES" {
            assert_eq!(al_state(&hand, 1), AlState::Op);
            drive.register_write(register::RESET, letter).await.unwrap();
        }
        pace.pause(Duration::from_millis(1)).await;
        assert_eq!((al_state(&hand, 0), al_state(&hand, 1)), (AlState::Op, AlState::Init));
        assert!(drive.status().await.is_err(), "its address is gone");
    });
    ran.unwrap();
    let mut link = hand;
    let found = master::run(&mut link, async |main, pace| {
        bring_up::scan(main, pace).await.map(|group| group.len())
    });
    assert_eq!(found.unwrap().unwrap(), 2, "and it comes up again");
}
