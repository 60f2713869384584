//! A rig for tests: virtual drives, the `ethercrab` master and lock-step time on one thread.
//!
//! | module | holds |
//! |---|---|
//! | [`raw`] | a master of single datagrams |
//! | [`esi`] | a reader of the ESI |

pub mod esi;
pub mod raw;

use std::cell::RefCell;
use std::rc::Rc;
use std::time::Duration;

use ethercrab::MainDevice;
use ethercrab::subdevice_group::PreOp;
use usr2556e::clock::Clock;
use usr2556e::drive::{DriveConfig, VirtualDrive};
use usr2556e::master::axis::{Axis, Exchange, Operating};
use usr2556e::master::bring_up::{self, Group};
use usr2556e::master::{self, Pace};
use usr2556e::segment::{InMemory, VirtualSegment};

/// Pulses of one turn at delivery.
pub const PULSES_PER_TURN: f64 = 10_000.0;

/// Interval of process data in tests.
pub const CYCLE: Duration = Duration::from_millis(1);

/// Drives on a wire in this process.
#[derive(Clone)]
pub struct Rig {
    link: Rc<RefCell<InMemory>>,
}

impl Rig {
    /// `drives` new drives.
    pub fn new(drives: usize) -> Self {
        Self::with((0..drives).map(DriveConfig::numbered))
    }

    /// Drives as configured.
    pub fn with(drives: impl IntoIterator<Item = DriveConfig>) -> Self {
        Self {
            link: Rc::new(RefCell::new(InMemory::new(VirtualSegment::new(drives), Clock::lock_step()))),
        }
    }

    /// One drive whose axis stands at `turns` at power-on, and whose shaft rests where the field is.
    pub fn standing_at(turns: f64) -> Self {
        let mut config = DriveConfig::numbered(0);
        config.plant.start = plant::Turns(turns);
        Self::with([without_losses(config)])
    }

    /// A master's conversation with the drives, from its first frame to its last. Each is a master of its own, just started.
    pub fn converse<T>(&self, conversation: impl AsyncFnOnce(&MainDevice<'_>, &Pace) -> T) -> T {
        master::run(&mut self.link.clone(), conversation).expect("a wire in memory does not fail")
    }

    /// A conversation that begins with a scan to PREOP.
    pub fn in_preop<T>(&self, conversation: impl AsyncFnOnce(&MainDevice<'_>, &Pace, Group<PreOp>) -> T) -> T {
        self.converse(async |main, pace| {
            let group = bring_up::scan(main, pace).await.expect("scan");
            conversation(main, pace, group).await
        })
    }

    /// A conversation with the first drive in OP over its default process data, all effective with each frame.
    pub fn in_op<T>(&self, conversation: impl AsyncFnOnce(&mut Axis<'_>) -> T) -> T {
        self.in_op_after(async |_, _| (), conversation)
    }

    /// Like [`Rig::in_op`], with something to do in PREOP first.
    pub fn in_op_after<T>(
        &self,
        prepare: impl AsyncFnOnce(&MainDevice<'_>, &Group<PreOp>),
        conversation: impl AsyncFnOnce(&mut Axis<'_>) -> T,
    ) -> T {
        self.in_preop(async |main, pace, group| {
            prepare(main, &group).await;
            let group = bring_up::to_op(main, pace, group, CYCLE).await.expect("OP");
            lead(main, pace, Operating::Frames(group, CYCLE), conversation).await
        })
    }

    /// A conversation with the first drive in OP over its default process data, effective with SYNC0.
    pub fn in_op_with_clocks<T>(
        &self,
        prepare: impl AsyncFnOnce(&MainDevice<'_>, &Group<PreOp>),
        conversation: impl AsyncFnOnce(&mut Axis<'_>) -> T,
    ) -> T {
        self.in_preop(async |main, pace, group| {
            prepare(main, &group).await;
            let group = bring_up::to_op_with_clocks(main, pace, group, CYCLE).await.expect("OP");
            lead(main, pace, Operating::Clocks(group), conversation).await
        })
    }

    /// Looks at the drive at `position`.
    pub fn look<T>(&self, position: usize, at: impl FnOnce(&VirtualDrive) -> T) -> T {
        at(&self.link.borrow().segment().drives()[position])
    }

    /// Lays a hand on the drive at `position`.
    pub fn touch<T>(&self, position: usize, hand: impl FnOnce(&mut VirtualDrive) -> T) -> T {
        hand(&mut self.link.borrow_mut().segment_mut().drives_mut()[position])
    }

    /// Lets time pass without a frame.
    pub fn idle(&self, span: Duration) {
        let mut link = self.link.borrow_mut();
        let until = link.now().after(span);
        link.wait_until(until);
    }

    /// Where the first drive's shaft is, in pulses from where position 0 was at power-on.
    pub fn shaft(&self) -> f64 {
        self.look(0, |drive| drive.plant().shaft().0 * PULSES_PER_TURN)
    }
}

/// A drive whose motor has neither friction nor detent torque, and whose bridge has no dead time: its shaft is where the field is, so that
/// positions can be compared to the pulse.
pub fn without_losses(mut config: DriveConfig) -> DriveConfig {
    config.plant.bridge.dead_time = 0.0;
    config.plant.motor.friction = 0.0;
    config.plant.motor.detent_torque = 0.0;
    config
}

/// A conversation with the one at `position` of drives in OP, after which the master stops dead: nothing is taken back.
pub async fn operate<T>(
    main: &MainDevice<'_>,
    pace: &Pace,
    drives: Operating,
    position: usize,
    conversation: impl AsyncFnOnce(&mut Axis<'_>) -> T,
) -> T {
    let mut unobserved = |_: &Exchange| ();
    conversation(&mut Axis::new(main, pace, drives, position, &mut unobserved)).await
}

/// A conversation with the first of drives in OP, and back to PREOP.
async fn lead<T>(main: &MainDevice<'_>, pace: &Pace, drives: Operating, conversation: impl AsyncFnOnce(&mut Axis<'_>) -> T) -> T {
    let mut unobserved = |_: &Exchange| ();
    let mut axis = Axis::new(main, pace, drives, 0, &mut unobserved);
    let result = conversation(&mut axis).await;
    axis.leave().await.expect("back to PREOP");
    result
}
