//! A line of chips and a master that sends single frames to it.
#![allow(dead_code, reason = "every test file uses another part")]

use esc::{Chip, ChipConfig, EEPROM_SIZE, End, Processed, Segment, Side};
use wire::Nanos;
use wire::frame::{Command, FrameBuilder, Layout, physical_address};
use wire::register::*;
use wire::sii;

/// Station address of the first chip; the others follow.
pub const STATION: u16 = 0x1001;

pub const SOURCE: [u8; 6] = [0x10; 6];

/// An EEPROM with a good configuration area: SYNC0 and SYNC1 reported, alias 0x00AA.
pub fn eeprom() -> [u8; EEPROM_SIZE] {
    let mut image = [0xFF; EEPROM_SIZE];
    image[..16].copy_from_slice(&[0x05, 0x0C, 0x03, 0xEE, 0xE8, 0x03, 0, 0, 0xAA, 0, 0, 0, 0, 0, 0, 0]);
    image[14] = sii::checksum(&image);
    for (at, byte) in image[16..128].iter_mut().enumerate() {
        *byte = at as u8;
    }
    image
}

pub fn chip(clock_offset_ns: u64, clock_ppb: i32) -> Chip {
    Chip::new(ChipConfig {
        eeprom: eeprom(),
        clock_offset_ns,
        clock_ppb,
    })
}

/// A chip with so many ports, whose clock shows `clock_offset_ns` at time 0.
pub fn junction(clock_offset_ns: u64, ports: usize) -> Chip {
    let config = ChipConfig {
        eeprom: eeprom(),
        clock_offset_ns,
        clock_ppb: 0,
    };
    Chip::with_ports(config, ports)
}

/// Port `port` of the chip in `position`.
pub fn port(position: usize, port: usize) -> End {
    End::Port { position, port }
}

pub const PRIMARY: End = End::Master(Side::Primary);
pub const SECONDARY: End = End::Master(Side::Secondary);

/// A frame of these datagrams from a card with this address.
pub fn frame(source: [u8; 6], datagrams: &[(Command, u32, &[u8])]) -> Vec<u8> {
    let mut buffer = [0; 2100];
    let mut builder = FrameBuilder::new(&mut buffer, source).unwrap();
    for (index, (command, address, data)) in datagrams.iter().enumerate() {
        builder.datagram(*command, index as u8, *address, data).unwrap();
    }
    let length = builder.finish();
    buffer[..length].to_vec()
}

/// What the datagrams of a frame say.
pub fn answers(frame: &[u8]) -> Vec<Answer> {
    let mut walk = Layout::of(frame).unwrap().walk();
    std::iter::from_fn(|| {
        walk.next(frame).map(|datagram| Answer {
            adp: datagram.adp(),
            events: datagram.events(),
            data: datagram.data().to_vec(),
            wkc: datagram.working_counter(),
        })
    })
    .collect()
}

/// What came back of one datagram.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Answer {
    pub adp: u16,
    pub events: u16,
    pub data: Vec<u8>,
    pub wkc: u16,
}

pub struct Bus {
    pub segment: Segment<Vec<Chip>>,
    pub now: u64,
}

impl Bus {
    /// `count` chips with station addresses from [`STATION`] on.
    pub fn new(count: usize) -> Self {
        Self::of((0..count).map(|at| chip(1_000_000 * (at as u64 + 1), 0)).collect())
    }

    pub fn of(chips: Vec<Chip>) -> Self {
        let count = chips.len();
        let mut bus = Self {
            segment: Segment::new(chips),
            now: 1_000_000,
        };
        for position in 0..count as u16 {
            let address = physical_address(0u16.wrapping_sub(position), STATION_ADDRESS);
            assert_eq!(bus.one(Command::Apwr, address, &(STATION + position).to_le_bytes()).wkc, 1);
        }
        bus
    }

    pub fn chip(&mut self, position: usize) -> &mut Chip {
        &mut self.segment.drives_mut()[position]
    }

    /// Brings the time of all slaves up to that of the bus.
    pub fn catch_up(&mut self) {
        let now = Nanos(self.now);
        self.segment.drives_mut().iter_mut().for_each(|chip| chip.advance(now));
    }

    pub fn pass(&mut self, nanoseconds: u64) {
        self.now += nanoseconds;
        self.catch_up();
    }

    /// Sends one frame of several datagrams.
    pub fn send(&mut self, datagrams: &[(Command, u32, &[u8])]) -> Vec<Answer> {
        let mut frame = frame(SOURCE, datagrams);
        assert_eq!(self.segment.process(&mut frame, Nanos(self.now)), Processed::Returned);
        answers(&frame)
    }

    /// Sends a frame from a card, changed in place; where it comes out.
    pub fn send_from(&mut self, side: Side, frame: &mut [u8]) -> Option<Side> {
        self.segment.process_from(side, frame, Nanos(self.now)).1
    }

    /// Plugs a cable.
    pub fn plug(&mut self, one: End, other: End) {
        assert_eq!(self.segment.connect(one, other), Ok(()));
    }

    /// Breaks the cable that ends here.
    pub fn unplug(&mut self, end: End) {
        assert!(self.segment.disconnect(end).is_some(), "{end:?} has no cable");
    }

    pub fn one(&mut self, command: Command, address: u32, data: &[u8]) -> Answer {
        self.send(&[(command, address, data)]).remove(0)
    }

    /// FPRD at the chip in `position`.
    pub fn read(&mut self, position: u16, ado: u16, length: usize) -> Answer {
        self.one(Command::Fprd, physical_address(STATION + position, ado), &vec![0; length])
    }

    /// FPWR at the chip in `position`; the working counter.
    pub fn write(&mut self, position: u16, ado: u16, data: &[u8]) -> u16 {
        self.one(Command::Fpwr, physical_address(STATION + position, ado), data).wkc
    }

    pub fn read_u8(&mut self, position: u16, ado: u16) -> u8 {
        self.read(position, ado, 1).data[0]
    }

    pub fn read_u16(&mut self, position: u16, ado: u16) -> u16 {
        u16::from_le_bytes(self.read(position, ado, 2).data.try_into().unwrap())
    }

    pub fn read_u32(&mut self, position: u16, ado: u16) -> u32 {
        u32::from_le_bytes(self.read(position, ado, 4).data.try_into().unwrap())
    }

    pub fn read_u64(&mut self, position: u16, ado: u16) -> u64 {
        u64::from_le_bytes(self.read(position, ado, 8).data.try_into().unwrap())
    }

    /// Configures and enables a sync manager of the chip in `position`.
    pub fn sync_manager(&mut self, position: u16, index: u16, start: u16, length: u16, control: u8) {
        let base = SM + SM_SIZE * index;
        assert_eq!(self.write(position, base + sync_manager::ACTIVATE, &[0]), 1);
        let mut bytes = [0; 8];
        bytes[..2].copy_from_slice(&start.to_le_bytes());
        bytes[2..4].copy_from_slice(&length.to_le_bytes());
        bytes[4] = control;
        bytes[6] = 1;
        assert_eq!(self.write(position, base, &bytes), 1);
    }

    /// Configures FMMU `index` of the chip in `position`.
    pub fn fmmu(&mut self, position: u16, index: u16, fmmu: FmmuEntry) {
        assert_eq!(self.write(position, FMMU + FMMU_SIZE * index, &fmmu.bytes()), 1);
    }
}

#[derive(Clone, Copy, Debug)]
pub struct FmmuEntry {
    pub logical: u32,
    pub length: u16,
    pub start_bit: u8,
    pub stop_bit: u8,
    pub physical: u16,
    pub physical_bit: u8,
    pub kind: u8,
}

impl FmmuEntry {
    pub const READ: u8 = 1;
    pub const WRITE: u8 = 2;

    pub fn whole(logical: u32, length: u16, physical: u16, kind: u8) -> Self {
        Self {
            logical,
            length,
            start_bit: 0,
            stop_bit: 7,
            physical,
            physical_bit: 0,
            kind,
        }
    }

    pub fn bytes(&self) -> [u8; 16] {
        let mut bytes = [0; 16];
        bytes[..4].copy_from_slice(&self.logical.to_le_bytes());
        bytes[4..6].copy_from_slice(&self.length.to_le_bytes());
        bytes[6] = self.start_bit;
        bytes[7] = self.stop_bit;
        bytes[8..10].copy_from_slice(&self.physical.to_le_bytes());
        bytes[10] = self.physical_bit;
        bytes[11] = self.kind;
        bytes[12] = 1;
        bytes
    }
}

pub const MAILBOX_OUT: u8 = 0x26;
pub const MAILBOX_IN: u8 = 0x22;
pub const OUTPUTS: u8 = 0x64;
pub const INPUTS: u8 = 0x20;
