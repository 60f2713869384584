//! The cyclic frames of N drives over their default process data: 7 bytes of outputs and 11 bytes of inputs each.

use std::ops::Range;

use raw_master::{MAX_FRAME, SOURCE};
use usr2556e::master::process_data::{INPUT_LENGTH, Inputs, OUTPUT_LENGTH, Outputs};
use wire::frame::{Command, Datagram, FrameBuilder, Layout, physical_address};
use wire::register::DC_SYSTEM_TIME;

use crate::bring_up::station;
use crate::bus::Bus;

/// Data that fit into one frame beside the clock's datagram.
const MAX_DATA: usize = 1466;

/// Working counter of a drive whose outputs were taken and whose inputs came.
const WORKING: u16 = 3;

/// Where the process data of the drives lie in the logical address space.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Image {
    /// Outputs and inputs of a drive begin at the same address, so that each takes only 11 bytes of the frame.
    Overlapping,
    /// All outputs, then all inputs, as most masters have them: 18 bytes a drive.
    Separate,
}

/// One cycle's exchange with a number of drives.
#[derive(Clone, Debug)]
pub struct Cycle {
    image: Image,
    distribute_clock: bool,
    /// What is sent to each drive.
    pub outputs: Vec<Outputs>,
    /// What came from each.
    pub inputs: Vec<Inputs>,
}

impl Cycle {
    /// A cycle with `drives` drives. With `distribute_clock`, it begins with a datagram that brings the first drive's system time to the
    /// others (FRMW 0x0910).
    pub fn new(drives: usize, image: Image, distribute_clock: bool) -> Self {
        Self {
            image,
            distribute_clock,
            outputs: vec![Outputs::default(); drives],
            inputs: vec![Inputs::default(); drives],
        }
    }

    /// Logical addresses of a drive's outputs.
    pub fn outputs_at(&self, drive: usize) -> Range<usize> {
        let start = match self.image {
            Image::Overlapping => INPUT_LENGTH * drive,
            Image::Separate => OUTPUT_LENGTH * drive,
        };
        start..start + OUTPUT_LENGTH
    }

    /// Logical addresses of a drive's inputs.
    pub fn inputs_at(&self, drive: usize) -> Range<usize> {
        let start = match self.image {
            Image::Overlapping => INPUT_LENGTH * drive,
            Image::Separate => OUTPUT_LENGTH * self.outputs.len() + INPUT_LENGTH * drive,
        };
        start..start + INPUT_LENGTH
    }

    fn size(&self) -> usize {
        self.outputs.len().checked_sub(1).map_or(0, |last| self.inputs_at(last).end)
    }

    /// The logical addresses that each frame of the cycle covers: one if everything fits, or else one with outputs and one with inputs.
    fn parts(&self) -> Vec<Range<usize>> {
        let size = self.size();
        let split = if size <= MAX_DATA { size } else { self.inputs_at(0).start };
        [0..split, split..size].into_iter().filter(|part| !part.is_empty()).collect()
    }

    /// The frames of the cycle with the present outputs.
    pub fn frames(&self) -> Vec<Vec<u8>> {
        let mut image = vec![0; self.size()];
        for (drive, outputs) in self.outputs.iter().enumerate() {
            outputs.put(&mut image[self.outputs_at(drive)]);
        }
        let parts = self.parts();
        parts
            .iter()
            .enumerate()
            .map(|(index, part)| self.frame(index, part, &image))
            .collect()
    }

    fn frame(&self, index: usize, part: &Range<usize>, image: &[u8]) -> Vec<u8> {
        let mut buffer = [0; MAX_FRAME];
        let mut builder = FrameBuilder::new(&mut buffer, SOURCE).expect("room for the header");
        if self.distribute_clock && index == 0 {
            let clock = physical_address(station(0), DC_SYSTEM_TIME);
            builder.datagram(Command::Frmw, 0xFF, clock, &[0; 8]).expect("room for the clock");
        }
        let data = &image[part.clone()];
        builder
            .datagram(Command::Lrw, index as u8, part.start as u32, data)
            .expect("room for the process data");
        let length = builder.finish();
        buffer[..length].to_vec()
    }

    /// Takes the inputs from the frames that came back. Returns whether all drives have taken part.
    pub fn take(&mut self, frames: &[Vec<u8>]) -> bool {
        let mut image = Vec::with_capacity(self.size());
        let mut working = 0;
        for frame in frames {
            let Some(datagram) = process_data(frame) else { return false };
            image.extend_from_slice(datagram.data());
            working += usize::from(datagram.working_counter());
        }
        for drive in 0..self.inputs.len() {
            let Some(bytes) = image.get(self.inputs_at(drive)) else {
                return false;
            };
            self.inputs[drive] = Inputs::take(bytes);
        }
        working == usize::from(WORKING) * self.inputs.len()
    }

    /// One exchange. Returns whether all drives have taken part.
    pub fn run(&mut self, bus: &mut impl Bus) -> bool {
        let mut frames = self.frames();
        for frame in &mut frames {
            bus.exchange(frame);
        }
        self.take(&frames)
    }
}

/// The datagram with the process data.
fn process_data(frame: &[u8]) -> Option<Datagram<&[u8]>> {
    let mut walk = Layout::of(frame)?.walk();
    std::iter::from_fn(|| walk.next(frame)).find(|datagram| datagram.command() == Command::Lrw)
}

/// Whether a frame that came back has passed `drives` drives in OP.
pub fn has_worked(frame: &[u8], drives: u16) -> bool {
    process_data(frame).is_some_and(|datagram| datagram.working_counter() == WORKING * drives)
}
