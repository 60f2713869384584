//! A wire that loses one frame in a hundred in each direction.

use std::cell::RefCell;
use std::rc::Rc;
use std::time::Duration;

use ethercrab::MainDevice;
use ethercrab::subdevice_group::PreOp;
use rig::CYCLE;
use usr2556e::clock::Clock;
use usr2556e::link::lossy::{Loss, Lossy};
use usr2556e::master::axis::Operating;
use usr2556e::master::bring_up::{self, Group};
use usr2556e::master::{self, Pace, Retries};
use usr2556e::segment::{InMemory, VirtualSegment};
use wire::al::AlState;

const DRIVES: usize = 3;

/// Frames lost are sent again well before the process data watchdog's 100 ms are over.
const RETRIES: Retries = Retries {
    after: Duration::from_millis(5),
    times: 10,
};

/// A master asks for at least this much of 0x10F1:02 when frames get lost: three for each cycle of a retry's wait, and as much again.
const FORGIVEN_SYNC_ERRORS: u16 = 100;

type Wire = Rc<RefCell<Lossy<InMemory>>>;

fn wire(seed: u64) -> Wire {
    let link = InMemory::new(VirtualSegment::of(DRIVES), Clock::lock_step());
    Rc::new(RefCell::new(Lossy::new(link, Loss { share: 0.01, seed })))
}

/// A conversation that begins in PREOP. Loss begins there: what a scan makes of a lost frame is the master's own matter.
fn in_preop<T>(link: &Wire, conversation: impl AsyncFnOnce(&MainDevice<'_>, &Pace, Group<PreOp>) -> T) -> T {
    let ended = master::run_with(RETRIES, &mut link.clone(), async |main, pace| {
        let group = bring_up::scan(main, pace).await.expect("scan");
        conversation(main, pace, group).await
    });
    ended.expect("a wire in memory does not fail")
}

/// Controlword, mode and target of the default process data.
fn outputs(target: i32) -> [u8; 7] {
    let [a, b, c, d] = target.to_le_bytes();
    [0x0F, 0, 8, a, b, c, d]
}

/// Each drive's own set-point in cycle `cycle`.
fn target(position: usize, cycle: i32) -> i32 {
    [3, -5, 7][position] * cycle
}

async fn exchange(main: &MainDevice<'_>, pace: &Pace, operating: &Operating, cycle: i32) {
    let next = match operating {
        Operating::Frames(group, period) => {
            for (position, drive) in group.iter(main).enumerate() {
                drive.outputs_raw_mut().copy_from_slice(&outputs(target(position, cycle)));
            }
            let next = pace.now().after(*period);
            group.tx_rx(main).await.expect("retried");
            next
        }
        Operating::Clocks(group) => {
            for (position, drive) in group.iter(main).enumerate() {
                drive.outputs_raw_mut().copy_from_slice(&outputs(target(position, cycle)));
            }
            bring_up::exchange_with_clocks(main, pace, group).await.expect("retried").1
        }
    };
    pace.until(next).await;
}

#[test]
fn op_and_set_points_survive_lost_frames() {
    for (seed, with_clocks) in [(1, false), (2, true)] {
        let link = wire(seed);
        in_preop(&link, async |main, pace, group| {
            for drive in group.iter(main) {
                drive.sdo_write(0x10F1, 2, FORGIVEN_SYNC_ERRORS).await.unwrap();
            }
            let operating = if with_clocks {
                Operating::Clocks(bring_up::to_op_with_clocks(main, pace, group, CYCLE).await.unwrap())
            } else {
                Operating::Frames(bring_up::to_op(main, pace, group, CYCLE).await.unwrap(), CYCLE)
            };
            let before = link.borrow().lost();
            // Time to be enabled, then 5 s of motion.
            for cycle in (0..300).map(|_| 0).chain(0..5_000) {
                exchange(main, pace, &operating, cycle).await;
                for position in 0..DRIVES {
                    let link = link.borrow();
                    let drive = &link.inner().segment().drives()[position];
                    assert_eq!(drive.status().al_state, AlState::Op, "seed {seed}, drive {position}, cycle {cycle}");
                    let taken = drive.device().objects().target_position;
                    // A frame that went out has arrived, but SYNC0 may still be to come.
                    let last = (cycle - 1).max(0);
                    assert!(
                        [target(position, cycle), target(position, last)].contains(&taken),
                        "seed {seed}, drive {position}, cycle {cycle}: {taken}"
                    );
                }
            }
            assert!(link.borrow().lost() - before > 50, "frames were lost");
            for _ in 0..200 {
                exchange(main, pace, &operating, 4_999).await;
            }
        });
        for position in 0..DRIVES {
            let reached = link.borrow().inner().segment().drives()[position].status().position;
            assert_eq!(reached, target(position, 4_999), "seed {seed}");
        }
    }
}

/// Repeats an SDO transfer until it succeeds, as users of this master must: it sends frames again, but does not ask for a mailbox
/// whose first reading was lost to be repeated.
async fn persistently<T, E: std::fmt::Debug>(mut transfer: impl AsyncFnMut() -> Result<T, E>) -> T {
    let mut last = None;
    for _ in 0..5 {
        match transfer().await {
            Ok(value) => return value,
            Err(error) => last = Some(error),
        }
    }
    panic!("five times in succession: {last:?}");
}

#[test]
fn an_sdo_transfer_that_lost_frames_broke_off_succeeds_when_repeated() {
    let link = wire(3);
    in_preop(&link, async |main, _, group| {
        let before = link.borrow().lost();
        for round in 0..60_u16 {
            for (position, drive) in group.iter(main).enumerate() {
                let current = 1000 + 10 * round + position as u16;
                persistently(async || drive.sdo_write(0x2000, 0, current).await).await;
            }
            for (position, drive) in group.iter(main).enumerate() {
                let read = persistently(async || drive.sdo_read::<u16>(0x2000, 0).await).await;
                assert_eq!(read, 1000 + 10 * round + position as u16, "round {round}");
            }
        }
        assert!(link.borrow().lost() - before > 20, "frames were lost");
    });
}
