//! One datagram on one chip: is it addressed, what happens, what does the working counter say (ETG.1000.4, 5.4).

use wire::frame::{Command, Datagram};
use wire::register::*;

use crate::chip::{Chip, Pass};
use crate::ecat::{Operation, Success};
use crate::logical::Wanted;

/// What a command makes a chip do.
enum Action {
    Nothing,
    Physical(Operation),
    Logical(Wanted),
}

impl Chip {
    /// Lets one datagram pass.
    pub(crate) fn execute(&mut self, pass: Pass, datagram: &mut Datagram<&mut [u8]>) {
        let command = datagram.command();
        let success = match self.action(command, datagram.adp()) {
            Action::Nothing => Success::default(),
            Action::Physical(Operation::Exchange) if self.registers.u16(PHYSICAL_OFFSET) != 0 => {
                self.exchange_apart(pass, u32::from(datagram.ado()), datagram.data_mut())
            }
            Action::Physical(operation) => {
                let address = u32::from(datagram.ado());
                self.ecat_access(pass, address, datagram.data_mut(), operation)
            }
            Action::Logical(wanted) => {
                let address = datagram.logical_address();
                self.logical_access(pass, address, datagram.data_mut(), wanted)
            }
        };
        let reads_and_writes = matches!(command, Command::Aprw | Command::Fprw | Command::Brw | Command::Lrw);
        let increment = match (reads_and_writes, success.read, success.write) {
            (true, read, write) => u16::from(read) + 2 * u16::from(write),
            (false, read, write) => u16::from(read || write),
        };
        if increment != 0 {
            datagram.add_working_counter(increment);
        }
        if is_counted_on(command) {
            datagram.increment_adp();
        }
        let mask = self.registers.u16(ECAT_EVENT_MASK);
        if mask != 0 {
            datagram.add_events(self.ecat_events() & mask);
        }
    }

    /// Reads and writes at addresses that the physical read/write offset keeps apart, byte for byte as the frame passes.
    fn exchange_apart(&mut self, pass: Pass, address: u32, data: &mut [u8]) -> Success {
        let offset = u32::from(self.registers.u16(PHYSICAL_OFFSET));
        let mut success = Success::default();
        for (at, byte) in (address..).zip(data.iter_mut()) {
            let mut written = [*byte];
            success |= self.ecat_access(pass, at, core::slice::from_mut(byte), Operation::Read);
            success |= self.ecat_access(pass, at + offset, &mut written, Operation::Write);
        }
        success
    }

    fn action(&self, command: Command, adp: u16) -> Action {
        let first = adp == 0;
        let addressed = |yes: bool, operation| if yes { Action::Physical(operation) } else { Action::Nothing };
        let multiple = |own: bool| Action::Physical(if own { Operation::Read } else { Operation::Write });
        match command {
            Command::Nop | Command::Unknown(_) => Action::Nothing,
            Command::Aprd => addressed(first, Operation::Read),
            Command::Apwr => addressed(first, Operation::Write),
            Command::Aprw => addressed(first, Operation::Exchange),
            Command::Fprd => addressed(self.is_station(adp), Operation::Read),
            Command::Fpwr => addressed(self.is_station(adp), Operation::Write),
            Command::Fprw => addressed(self.is_station(adp), Operation::Exchange),
            Command::Brd => Action::Physical(Operation::ReadOr),
            Command::Bwr => Action::Physical(Operation::Write),
            Command::Brw => Action::Physical(Operation::ExchangeOr),
            Command::Lrd => Action::Logical(Wanted { read: true, write: false }),
            Command::Lwr => Action::Logical(Wanted { read: false, write: true }),
            Command::Lrw => Action::Logical(Wanted { read: true, write: true }),
            Command::Armw => multiple(first),
            Command::Frmw => multiple(self.is_station(adp)),
        }
    }

    /// Whether the chip answers to this station address, or to its alias where the master has allowed that (0x0103.0).
    fn is_station(&self, address: u16) -> bool {
        let alias_enabled = self.registers.u8(DL_CONTROL + 3) & 1 != 0;
        address == self.registers.u16(STATION_ADDRESS) || alias_enabled && address == self.registers.u16(STATION_ALIAS)
    }
}

/// Whether every chip counts the address up as the datagram passes.
fn is_counted_on(command: Command) -> bool {
    matches!(
        command,
        Command::Aprd | Command::Apwr | Command::Aprw | Command::Brd | Command::Bwr | Command::Brw | Command::Armw
    )
}
