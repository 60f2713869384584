//! An EtherCAT slave controller of the ET1100's class in software: 8 FMMUs, 8 sync managers, 8 kB of process memory, 64-bit distributed
//! clocks, two ports or up to four. Frames come in on one side ([`Segment::process`]), the slave stack works on the other ([`wire::EscAccess`]).
//!
//! | module | holds |
//! |---|---|
//! | [`segment`] | [`Segment`]: chips and the cables between them, through which a frame passes |
//! | `walk` | the way of one frame from port to port |
//! | `ports` | links, loops and receive times of a chip's ports |
//! | [`chip`] | [`Chip`]: the parts together, power-on, passing of time, one frame through one chip |
//! | `datagram` | one datagram on one chip: addressing, working counter |
//! | `ecat` | the bus side's access to registers and memory, byte for byte |
//! | `pdi` | the slave stack's access to registers and memory |
//! | `logical` | datagrams with logical addresses, through the FMMUs |
//! | `fmmu` | the FMMUs' settings and their arithmetic of bits |
//! | `memory` | which part of the chip an address belongs to |
//! | `sync_managers` | all sync managers: which of them guards an address |
//! | `sync_manager` | one sync manager: three-buffer exchange and mailbox |
//! | `buffers` | the three buffers' change of hands |
//! | `registers` | the register file and its access rights |
//! | `protection` | write protection of registers and memory |
//! | `shadow` | register writes that wait for the frame's end |
//! | `commit` | what written registers do at the frame's end |
//! | `live` | registers whose value is computed when they are read |
//! | `event` | the AL event request, on the slave stack's time |
//! | `eeprom` | the SII EEPROM and its interface |
//! | `watchdog` | process data and PDI watchdog |
//! | `clock` | the local clock and the loop that makes it follow the reference clock |
//! | `sync_signal` | SYNC0 and SYNC1 |
//! | `latch` | the latch units: times of edges of an input |
//! | `reset` | reset by register |
#![no_std]
#![forbid(unsafe_code)]

pub mod chip;
pub mod segment;

mod buffers;
mod clock;
mod commit;
mod datagram;
mod ecat;
mod eeprom;
mod event;
mod fmmu;
mod latch;
mod live;
mod logical;
mod memory;
mod pdi;
mod ports;
mod protection;
mod registers;
mod reset;
mod shadow;
mod sync_manager;
mod sync_managers;
mod sync_signal;
mod walk;
mod watchdog;

pub use chip::{Chip, ChipConfig};
pub use eeprom::EEPROM_SIZE;
pub use segment::{CannotConnect, End, Processed, Segment, Side};

#[cfg(test)]
mod robustness;
