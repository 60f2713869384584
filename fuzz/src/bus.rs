//! Drives, the cables between them, time, and a plain master.

use esc::{Chip, End, Processed, Segment, Side};
use raw_master::Datagram;
use usr2556e::drive::{DriveConfig, VirtualDrive};
use wire::Nanos;
use wire::frame::{Command, physical_address};

/// Time that a frame of the plain master takes, in ns.
const FRAME_TIME: u64 = 7_000;

/// Drives plugged together at an instant. A copy is a bus of its own in the same state.
#[derive(Clone)]
pub struct Bus {
    segment: Segment<Vec<VirtualDrive>>,
    now: Nanos,
}

impl Bus {
    /// A line of drives just switched on.
    pub fn new(drives: impl IntoIterator<Item = DriveConfig>) -> Self {
        Self {
            segment: Segment::new(drives.into_iter().map(VirtualDrive::new).collect()),
            now: Nanos(0),
        }
    }

    /// The drives.
    pub fn drives(&self) -> &[VirtualDrive] {
        self.segment.drives()
    }

    /// The drives.
    pub fn drives_mut(&mut self) -> &mut [VirtualDrive] {
        self.segment.drives_mut()
    }

    /// The slave controller of a drive.
    pub fn chip_mut(&mut self, position: usize) -> &mut Chip {
        self.segment.drives_mut()[position].as_mut()
    }

    /// The present instant.
    pub const fn now(&self) -> Nanos {
        self.now
    }

    /// Plugs a cable unless an end is taken or does not exist.
    pub fn connect(&mut self, one: End, other: End) {
        let _ = self.segment.connect(one, other);
    }

    /// Breaks the cable that ends here, if there is one.
    pub fn disconnect(&mut self, end: End) {
        self.segment.disconnect(end);
    }

    /// Lets time pass without simulating the drives.
    pub fn pass_time(&mut self, nanoseconds: u64) {
        self.now.0 += nanoseconds;
    }

    /// Lets time pass.
    pub fn wait(&mut self, nanoseconds: u64) {
        self.pass_time(nanoseconds);
        self.catch_up();
    }

    /// Simulates the drives up to the present.
    pub fn catch_up(&mut self) {
        for drive in self.segment.drives_mut() {
            drive.catch_up(self.now);
        }
    }

    /// Lets a frame pass through the drives, and tells where it comes out.
    pub fn pass(&mut self, from: Side, frame: &mut [u8]) -> (Processed, Option<Side>) {
        self.segment.process_from(from, frame, self.now)
    }

    /// Sends a frame of one datagram from the primary card, and lets the drives see to it. Puts the answer's data in place of what
    /// was sent, and returns the working counter; `None` if the frame is lost.
    pub fn ask(&mut self, command: Command, address: u32, data: &mut [u8]) -> Option<u16> {
        let mut datagrams = [Datagram::new(command, address, data.to_vec())];
        let returned = self.send(&mut datagrams);
        let [answer] = datagrams;
        data.copy_from_slice(&answer.data);
        returned.then_some(answer.counter)
    }

    /// Sends a frame from the primary card, and lets the drives see to it. Returns whether it comes back, at whichever card.
    fn send(&mut self, datagrams: &mut [Datagram]) -> bool {
        raw_master::exchange(datagrams, |frame| {
            let (processed, exit) = self.pass(Side::Primary, frame);
            self.wait(FRAME_TIME);
            assert!(exit.is_none() || processed == Processed::Returned, "{processed:?}");
            exit.is_some()
        })
    }

    /// Writes several registers of every drive with one frame, which may be lost.
    pub fn write_all_at_once(&mut self, registers: &[(u16, &[u8])]) {
        let datagrams = registers.iter();
        let datagrams = datagrams.map(|&(register, data)| Datagram::new(Command::Bwr, physical_address(0, register), data.to_vec()));
        self.send(&mut datagrams.collect::<Vec<_>>());
    }

    /// Writes the same to every drive; how many took it.
    pub fn write_all(&mut self, register: u16, data: &[u8]) -> usize {
        let mut data = data.to_vec();
        usize::from(self.ask(Command::Bwr, physical_address(0, register), &mut data).unwrap_or(0))
    }

    /// Reads from every drive: how many there were, and their values or-ed.
    pub fn read_all<const COUNT: usize>(&mut self, register: u16) -> (usize, [u8; COUNT]) {
        let mut data = [0; COUNT];
        let count = self.ask(Command::Brd, physical_address(0, register), &mut data).unwrap_or(0);
        (usize::from(count), data)
    }

    /// Writes to the drive at a position on the frames' way; whether it took the data.
    pub fn write_at(&mut self, position: u16, address: u16, data: &[u8]) -> bool {
        let mut data = data.to_vec();
        let address = physical_address(0_u16.wrapping_sub(position), address);
        self.ask(Command::Apwr, address, &mut data) == Some(1)
    }

    /// Writes to the first drive; whether it took the data.
    pub fn write(&mut self, address: u16, data: &[u8]) -> bool {
        self.write_at(0, address, data)
    }

    /// Reads from the first drive; whether it gave the data.
    pub fn read(&mut self, address: u16, data: &mut [u8]) -> bool {
        self.ask(Command::Aprd, physical_address(0, address), data) == Some(1)
    }

    /// Reads two bytes of the first drive; 0 if it did not answer.
    pub fn read_u16(&mut self, address: u16) -> u16 {
        let mut data = [0; 2];
        self.read(address, &mut data);
        u16::from_le_bytes(data)
    }
}
