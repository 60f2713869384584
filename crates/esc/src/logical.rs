//! Datagrams with logical addresses: through the FMMUs to where they map (ESC data sheet, section I, 7).

use crate::chip::{Chip, Pass};
use crate::ecat::{Operation, Success};
use crate::fmmu::{Fmmu, Span};

/// What a logical datagram asks for.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Wanted {
    /// LRD and LRW.
    pub(crate) read: bool,
    /// LWR and LRW.
    pub(crate) write: bool,
}

impl Chip {
    /// Accesses whatever the FMMUs map at `logical`.
    pub(crate) fn logical_access(&mut self, pass: Pass, logical: u32, data: &mut [u8], wanted: Wanted) -> Success {
        if self.fmmus.are_entangled() {
            return self.logical_bytewise(pass, logical, data, wanted);
        }
        // Outputs are taken from the data as it came in, so all of them before any input is put there.
        let mut success = Success::default();
        if wanted.write {
            for index in 0..self.fmmus.active().len() {
                let fmmu = self.fmmus.active()[index];
                success.write |= fmmu.writes && self.write_through(pass, &fmmu, logical, data);
            }
        }
        if wanted.read {
            for index in 0..self.fmmus.active().len() {
                let fmmu = self.fmmus.active()[index];
                success.read |= fmmu.reads && self.read_through(pass, &fmmu, logical, data);
            }
        }
        success
    }

    fn write_through(&mut self, pass: Pass, fmmu: &Fmmu, logical: u32, data: &mut [u8]) -> bool {
        let Some(overlap) = fmmu.overlap(logical, data.len()) else {
            return false;
        };
        let data = &mut data[overlap.data];
        if fmmu.is_bytewise() {
            return self.ecat_access(pass, fmmu.address(overlap.first), data, Operation::Write).write;
        }
        let mut any = false;
        for (index, byte) in (overlap.first..).zip(data.iter()) {
            any |= self.write_span(fmmu.span(index), *byte, 0xFF);
        }
        any
    }

    fn read_through(&mut self, pass: Pass, fmmu: &Fmmu, logical: u32, data: &mut [u8]) -> bool {
        let Some(overlap) = fmmu.overlap(logical, data.len()) else {
            return false;
        };
        let data = &mut data[overlap.data];
        if fmmu.is_bytewise() {
            return self.read_bytes_through(pass, fmmu.address(overlap.first), data);
        }
        let mut any = false;
        for (index, byte) in (overlap.first..).zip(data.iter_mut()) {
            let (value, mask) = self.read_span(pass, fmmu.span(index));
            *byte = *byte & !mask | value & mask;
            any |= mask != 0;
        }
        any
    }

    /// Reads whole bytes; those that nothing answers for keep what the datagram brought, as the bits of other slaves do.
    fn read_bytes_through(&mut self, pass: Pass, address: u32, data: &mut [u8]) -> bool {
        if address >= u32::from(wire::register::USER_RAM) {
            return self.ecat_access(pass, address, data, Operation::Read).read;
        }
        let mut any = false;
        for (at, byte) in (address..).zip(data) {
            let mut value = [0];
            if self.ecat_access(pass, at, &mut value, Operation::Read).read {
                *byte = value[0];
                any = true;
            }
        }
        any
    }

    /// The exact order of the hardware: byte after byte, in each the old value out before the new value in; of several FMMUs of one
    /// direction that map a bit, the one with the lowest number has it.
    fn logical_bytewise(&mut self, pass: Pass, logical: u32, data: &mut [u8], wanted: Wanted) -> Success {
        let mut success = Success::default();
        for (offset, byte) in data.iter_mut().enumerate() {
            let (incoming, mut read, mut written) = (*byte, 0, 0);
            for index in 0..self.fmmus.active().len() {
                let fmmu = self.fmmus.active()[index];
                if let Some(span) = span_at(&fmmu, logical, offset).filter(|span| wanted.read && fmmu.reads && span.mask() & !read != 0) {
                    let (value, mask) = self.read_span(pass, span);
                    let mask = mask & !read;
                    *byte = *byte & !mask | value & mask;
                    success.read |= mask != 0;
                    read |= span.mask();
                }
            }
            for index in 0..self.fmmus.active().len() {
                let fmmu = self.fmmus.active()[index];
                if let Some(span) =
                    span_at(&fmmu, logical, offset).filter(|span| wanted.write && fmmu.writes && span.mask() & !written != 0)
                {
                    success.write |= self.write_span(span, incoming, !written);
                    written |= span.mask();
                }
            }
        }
        success
    }

    /// The mapped bits, and which of them could be read.
    fn read_span(&mut self, pass: Pass, span: Span) -> (u8, u8) {
        let wanted = span.physical_mask();
        let (mut bytes, mut readable) = ([0; 2], [0; 2]);
        for half in 0..2 {
            let byte = &mut bytes[half..=half];
            if wanted[half] != 0 && self.ecat_access(pass, span.address + half as u32, byte, Operation::Read).read {
                readable[half] = 0xFF;
            }
        }
        (span.to_logical(bytes), span.to_logical(readable))
    }

    /// Writes those mapped bits that are also in `allowed`, a mask of the logical byte; whether any could be written.
    fn write_span(&mut self, span: Span, value: u8, allowed: u8) -> bool {
        let (mask, value) = (span.to_physical(allowed), span.to_physical(value));
        let mut any = false;
        for half in 0..2 {
            if mask[half] != 0 {
                any |= self.ecat_write_bits(span.address + half as u32, value[half], mask[half]);
            }
        }
        any
    }
}

fn span_at(fmmu: &Fmmu, logical: u32, offset: usize) -> Option<Span> {
    let at = logical.checked_add(offset as u32)?;
    fmmu.overlap(at, 1).map(|overlap| fmmu.span(overlap.first))
}
