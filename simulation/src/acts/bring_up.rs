//! States, mapping, enabling.

use device::layout;
use drive::{DriveObjects, PowerState};
use plant::Turns;
use wire::al::AlState;
use wire::register as reg;

use crate::Simulation;
use crate::invariants::{Verdict, must};
use crate::mailbox::size_of_object;

/// Objects that the master commands, in the order in which it downloads those that are not mapped.
const COMMANDED: [u16; 7] = [0x6081, 0x6083, 0x6084, 0x60FF, 0x607A, 0x6060, 0x6040];
/// Ticks of a cycle: 500 us to 4 ms.
const CYCLES: [u64; 5] = [10, 20, 20, 40, 80];
/// Entries that a mapping of chance may have at most, beside those it always has.
const MOST_ENTRIES: u64 = 8;

impl Simulation {
    /// From INIT to OP, or to SAFEOP now and then. With a whole cable the drive owes every state on the way.
    pub(crate) fn begin_anew(&mut self) -> Verdict {
        self.bus.set_connected(true);
        self.master.loss = 0;
        self.master.cycle = self.random.pick(&CYCLES);
        self.master.offset = self.random.below(50_000);
        let clocks = self.random.chance(30);
        let end = if self.random.chance(90) { AlState::Op } else { AlState::SafeOp };
        let cycle = self.master.cycle * 50;
        self.note(|| format!("to {} with a cycle of {cycle} us, clocks: {clocks}", end.name()));
        self.reach(0x11)?;
        self.set_mailboxes();
        self.reach(2)?;
        self.map()?;
        self.set_process_data();
        self.set_clocks(clocks);
        self.master.clocks = clocks;
        self.reach(4)?;
        if end == AlState::SafeOp {
            return self.cycles(5);
        }
        self.master.commands.controlword = 0;
        self.exchange_process_data()?;
        self.request(8);
        let reached = self.until(200, |simulation| simulation.al_state() == AlState::Op)?;
        must(reached, || "OP is not reached".into())?;
        if clocks {
            self.coverage.count("OP with distributed clocks");
        }
        Ok(())
    }

    fn reach(&mut self, control: u16) -> Verdict {
        let answer = self.request(control);
        must(answer == Some((control & 0x0F, 0)), || {
            format!("AL control {control:02X} answered by {answer:04X?}")
        })
    }

    fn set_clocks(&mut self, on: bool) {
        self.write(reg::DC_ACTIVATION, &[0]);
        let Some(time) = self.read(reg::DC_SYSTEM_TIME, 8).filter(|_| on) else {
            return;
        };
        let cycle = self.master.cycle as u32 * 50_000;
        let mut now = [0; 8];
        now.copy_from_slice(&time);
        let start = u64::from_le_bytes(now) + u64::from(cycle);
        self.write(reg::DC_SYNC0_CYCLE, &cycle.to_le_bytes());
        self.write(reg::DC_SYNC1_CYCLE, &[0; 4]);
        self.write(reg::DC_START_TIME, &start.to_le_bytes());
        self.write(reg::DC_ACTIVATION, &[reg::dc_activation::CYCLIC | reg::dc_activation::SYNC0]);
    }

    /// Assigns one of the PDOs, of which the first gets a mapping of delivery or of chance.
    fn map(&mut self) -> Verdict {
        let number = self.random.pick(&[0, 0, 0, 1, 2]);
        let own = number == 0 && self.random.chance(30);
        let outputs = if own {
            self.any_mapping(true)
        } else {
            layout::RX_PDOS[number].entries.to_vec()
        };
        let inputs = if own {
            self.any_mapping(false)
        } else {
            layout::TX_PDOS[number.min(1)].entries.to_vec()
        };
        for (assignment, pdo, mapping) in [
            (0x1C12, layout::RX_PDOS[number].index, &outputs),
            (0x1C13, layout::TX_PDOS[number.min(1)].index, &inputs),
        ] {
            self.owed_download(assignment, 0, 0)?;
            if number == 0 {
                self.owed_download(pdo, 0, 0)?;
                for (place, entry) in (1..).zip(mapping) {
                    self.owed_download(pdo, place, i64::from(*entry))?;
                }
                self.owed_download(pdo, 0, mapping.len() as i64)?;
            }
            self.owed_download(assignment, 1, pdo.into())?;
            self.owed_download(assignment, 0, 1)?;
        }
        if own {
            self.coverage.count("own mapping");
        }
        self.master.input_size = inputs.iter().map(|entry| (entry & 0xFF) as usize / 8).sum();
        self.master.outputs = outputs;
        Ok(())
    }

    /// Controlword and mode, or statusword and display, and some more of what can be mapped.
    fn any_mapping(&mut self, outputs: bool) -> Vec<u32> {
        let mut mapping = if outputs {
            vec![0x6040_0010, 0x6060_0008]
        } else {
            vec![0x6041_0010, 0x6061_0008]
        };
        for _ in 0..self.random.below(MOST_ENTRIES) {
            let entry = self.any_entry();
            let mappable = if outputs {
                entry.access.is_rx_mappable()
            } else {
                entry.access.is_tx_mappable()
            };
            if mappable && !mapping.contains(&entry.mapping()) {
                mapping.push(entry.mapping());
            }
        }
        mapping
    }

    pub(crate) fn any_entry(&mut self) -> dictionary::Entry {
        self.random.pick(DriveObjects::ENTRIES)
    }

    fn owed_download(&mut self, index: u16, sub: u8, value: i64) -> Verdict {
        let taken = self.download(index, sub, value)?;
        must(taken, || {
            format!("{index:04X}:{sub} = {value:X} is refused in {}", self.al_state().name())
        })
    }

    /// Sends what the master commands: what is not mapped, by SDO.
    pub(crate) fn command(&mut self) -> Verdict {
        for index in COMMANDED {
            let mapped = self.master.outputs.iter().any(|entry| (entry >> 16) as u16 == index);
            let value = self.master.commands.value(index).unwrap_or_default();
            let size = size_of_object(index, 0);
            if !mapped && self.present(index, 0)[..size] != value.to_le_bytes()[..size] {
                self.download(index, 0, value.into())?;
            }
        }
        self.cycle()
    }

    /// Brings the drive to Operation Enabled in a mode, with whatever that takes. Returns whether it got there.
    pub(crate) fn prepare(&mut self, mode: i8) -> Result<bool, String> {
        self.bus.set_connected(true);
        self.master.commands.mode = mode;
        if self.al_state() != AlState::Op {
            self.begin_anew()?;
        }
        if !self.commissioned {
            self.commission()?;
        }
        if !self.enable()? {
            self.restore_order()?;
            self.begin_anew()?;
            if !self.enable()? {
                return Ok(false);
            }
        }
        self.command()?;
        Ok(self.objects().mode_display == mode)
    }

    pub(crate) fn enable(&mut self) -> Result<bool, String> {
        for _ in 0..40 {
            self.master.commands.controlword = match self.bus.drive().device().drive().power_state() {
                PowerState::OperationEnabled => return Ok(true),
                PowerState::Fault => 0x80 ^ (self.master.commands.controlword & 0x80),
                PowerState::ReadyToSwitchOn => self.random.pick(&[0x07, 0x0F]),
                PowerState::SwitchedOn => 0x0F,
                PowerState::QuickStopActive => 0x00,
                _ => 0x06,
            };
            self.command()?;
        }
        Ok(false)
    }

    /// Everything as on a new machine: values of delivery, inputs off, supply on, the axis between its limits.
    pub(crate) fn restore_order(&mut self) -> Verdict {
        self.note(|| "everything as delivered".into());
        self.release_surroundings();
        let place = self.random.within(-9_500, 9_500) as f64 / 1000.0;
        self.place_axis(Turns(place));
        if self.al_state() == AlState::Init {
            self.begin_anew()?;
        }
        for entry in DriveObjects::ENTRIES {
            if entry.access.is_writable() && ![0x6040, 0x2010].contains(&entry.index) {
                self.download(entry.index, entry.sub, entry.default)?;
            }
        }
        self.master.commands.speed = 10_000;
        self.master.commands.acceleration = 100_000;
        self.master.commands.deceleration = 100_000;
        self.commission()
    }
}
