//! Drives plugged together, and the wire that ends in this process.

use std::collections::VecDeque;
use std::time::Duration;

use esc::{CannotConnect, End, Processed, Segment, Side};
use plant::Faults;
use wire::Nanos;

use crate::breakdown::Damage;
use crate::cables::{Cable, CableState, Cables, Change, ChangeError};
use crate::clock::Clock;
use crate::drive::{DriveConfig, VirtualDrive};
use crate::link::pcap::{Direction, Recorder};
use crate::link::{Link, LinkError, Received};

/// Virtual drives and the cables between them: a line at first, each drive plugged into the one before it.
pub struct VirtualSegment {
    segment: Segment<Vec<VirtualDrive>>,
    cables: Cables,
}

impl VirtualSegment {
    /// Drives as configured, from the master outwards, just switched on.
    pub fn new(drives: impl IntoIterator<Item = DriveConfig>) -> Self {
        let drives: Vec<VirtualDrive> = drives.into_iter().map(VirtualDrive::new).collect();
        Self {
            cables: Cables::line(drives.len()),
            segment: Segment::new(drives),
        }
    }

    /// Like [`Self::new`], with one more cable, from the last drive to the master's second card.
    pub fn ring(drives: impl IntoIterator<Item = DriveConfig>) -> Self {
        let mut segment = Self::new(drives);
        let last = segment.cables.close();
        // Both of its ends are new and free.
        let _ = segment.lay(last);
        segment
    }

    /// `count` new drives.
    pub fn of(count: usize) -> Self {
        Self::new((0..count).map(DriveConfig::numbered))
    }

    /// Plugs a cable while everything runs.
    ///
    /// # Errors
    /// An end does not exist or is taken. Nothing has changed then.
    pub fn connect(&mut self, one: End, other: End) -> Result<(), CannotConnect> {
        self.segment.connect(one, other)
    }

    /// Unplugs, or breaks, the cable that ends here. Returns the other end, if there was a cable.
    pub fn disconnect(&mut self, end: End) -> Option<End> {
        self.segment.disconnect(end)
    }

    /// Cuts, repairs, unplugs or plugs while everything runs.
    ///
    /// # Errors
    /// There is no such cable or drive, or it is like that already.
    pub fn change(&mut self, change: Change) -> Result<(), ChangeError> {
        for number in self.cables.change(change)? {
            self.lay(number).map_err(ChangeError::Taken)?;
        }
        Ok(())
    }

    /// Breaks or mends something at a drive while everything runs. What is broken already stays so.
    ///
    /// # Errors
    /// There is no such drive.
    pub fn damage(&mut self, damage: Damage) -> Result<(), ChangeError> {
        let (Damage::Break(number, _) | Damage::Mend(number)) = damage;
        let drives = self.drives().len();
        let drive = number.checked_sub(1).and_then(|position| self.drives_mut().get_mut(position));
        let plant = drive.ok_or(ChangeError::NoSuchDrive { number, drives })?.plant_mut();
        let mut faults = plant.faults();
        match damage {
            Damage::Break(_, breakdown) => breakdown.add_to(&mut faults),
            Damage::Mend(_) => faults = Faults::default(),
        }
        plant.set_faults(faults);
        Ok(())
    }

    /// Says whether the interface to one of the master's cards is up. While it is not, the drive at its cable has no link there.
    pub fn set_interface(&mut self, side: Side, up: bool) {
        if let Some(number) = self.cables.set_interface(side, up) {
            // Another cable in its place stays there.
            let _ = self.lay(number);
        }
    }

    /// The cables of the line or ring, from the master's first card outwards; not those plugged by [`Self::connect`].
    pub fn cables(&self) -> impl Iterator<Item = Cable> + '_ {
        (1..=self.cables.count()).map(|number| self.cables.cable(number))
    }

    /// Plugs or unplugs a cable, as it ought to be.
    fn lay(&mut self, number: usize) -> Result<(), CannotConnect> {
        let Cable {
            ends: [one, other], state, ..
        } = self.cables.cable(number);
        let linked = self.segment.connected(one) == Some(other);
        match state {
            CableState::Whole if !linked => self.segment.connect(one, other)?,
            CableState::Cut | CableState::Unplugged(_) | CableState::InterfaceDown if linked => {
                self.segment.disconnect(one);
            }
            _ => {}
        }
        Ok(())
    }

    /// Lets a frame that arrives from one of the master's two cards at `now` pass. Returns the card where it comes out, if it does. For
    /// the rest, see [`Self::process`].
    pub fn process_from(&mut self, side: Side, frame: &mut [u8], now: Nanos) -> Option<Side> {
        self.segment.process_from(side, frame, now).1
    }

    /// Lets a frame that arrives at `now` pass through all drives. Returns whether it comes back, as a broken EtherCAT frame does too;
    /// frames of other protocols do not, nor do frames that get lost on their way.
    ///
    /// The simulation stays where it is, so that the answer need not wait for it; call [`Self::catch_up`] after sending it.
    pub fn process(&mut self, frame: &mut [u8], now: Nanos) -> bool {
        matches!(self.segment.process(frame, now), Processed::Returned | Processed::Malformed)
    }

    /// Simulates every drive up to `now`.
    pub fn catch_up(&mut self, now: Nanos) {
        for drive in self.drives_mut() {
            drive.catch_up(now);
        }
    }

    /// The drives, from the master outwards.
    pub fn drives(&self) -> &[VirtualDrive] {
        self.segment.drives()
    }

    /// The drives, from the master outwards.
    pub fn drives_mut(&mut self) -> &mut [VirtualDrive] {
        self.segment.drives_mut()
    }
}

/// Time a frame spends on a 100 Mbit/s wire at the least: what each frame costs in lock-step.
const FRAME_TIME: Nanos = Nanos(6_720);

/// The longest step of time while a master waits in lock-step, so that it sees changes as they come.
const WAIT_STEP: Duration = Duration::from_micros(100);

/// Frames a master may have under way before it fetches them; further ones are lost, as in a full network buffer.
const FRAMES_UNDER_WAY: usize = 64;

/// A wire inside this process with drives at its other end: no network, no privileges.
pub struct InMemory {
    segment: VirtualSegment,
    clock: Clock,
    returning: VecDeque<Vec<u8>>,
    recorder: Option<Recorder>,
}

impl InMemory {
    /// A wire to `segment` in the time of `clock`.
    pub fn new(segment: VirtualSegment, clock: Clock) -> Self {
        Self {
            segment,
            clock,
            returning: VecDeque::new(),
            recorder: None,
        }
    }

    /// Records every frame in both directions, in the time of the clock, counted from the Unix epoch.
    pub fn with_recorder(mut self, recorder: Recorder) -> Self {
        self.recorder = Some(recorder);
        self
    }

    /// Ends the recording.
    pub fn take_recorder(&mut self) -> Option<Recorder> {
        self.recorder.take()
    }

    fn record(&mut self, direction: Direction, frame: &[u8]) {
        let now = Duration::from_nanos(self.clock.now().0);
        if let Some(recorder) = &mut self.recorder {
            recorder.record(now, direction, frame);
        }
    }

    /// The drives at the other end.
    pub fn segment(&self) -> &VirtualSegment {
        &self.segment
    }

    /// The drives at the other end.
    pub fn segment_mut(&mut self) -> &mut VirtualSegment {
        &mut self.segment
    }

    /// The present instant.
    pub fn now(&self) -> Nanos {
        self.clock.now()
    }

    /// Whether time moves only when somebody waits.
    pub fn is_lock_step(&self) -> bool {
        matches!(self.clock, Clock::LockStep(_))
    }

    /// Lets time pass up to `instant` and simulates the drives meanwhile.
    pub fn wait_until(&mut self, instant: Nanos) {
        self.clock.wait_until(instant);
        self.segment.catch_up(self.clock.now());
    }
}

impl Link for InMemory {
    fn send(&mut self, frame: &[u8]) -> Result<(), LinkError> {
        if let Clock::LockStep(now) = &mut self.clock {
            now.0 += FRAME_TIME.0;
        }
        let now = self.clock.now();
        self.record(Direction::Outbound, frame);
        let mut frame = frame.to_vec();
        if self.segment.process(&mut frame, now) && self.returning.len() < FRAMES_UNDER_WAY {
            self.record(Direction::Inbound, &frame);
            self.returning.push_back(frame);
        }
        self.segment.catch_up(now);
        Ok(())
    }

    fn receive(&mut self, buffer: &mut [u8], wait: Duration) -> Result<Received, LinkError> {
        if let Some(frame) = self.returning.pop_front() {
            let Some(place) = buffer.get_mut(..frame.len()) else {
                return Ok(Received::Timeout);
            };
            place.copy_from_slice(&frame);
            return Ok(Received::Frame(frame.len()));
        }
        self.wait_until(self.clock.now().after(wait.min(WAIT_STEP)));
        Ok(Received::Timeout)
    }
}
