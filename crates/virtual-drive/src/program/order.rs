//! `cable` and `fault`: orders to a drive server.

use std::io::{self, Write};
use std::path::Path;

use anyhow::bail;
use board::Millivolts;

use super::arguments::{Cable, CableAction, Fault, FaultAction};
use crate::breakdown::{Breakdown, Damage};
use crate::cables::Change;
use crate::control::{self, Order};

pub(super) fn cable(options: &Cable) -> anyhow::Result<()> {
    let order = match options.action {
        CableAction::List => Order::List,
        CableAction::Cut { cable } => Order::Change(Change::Cut(cable)),
        CableAction::Repair { cable } => Order::Change(Change::Repair(cable)),
        CableAction::Unplug { drive } => Order::Change(Change::Unplug(drive)),
        CableAction::Plug { drive } => Order::Change(Change::Plug(drive)),
    };
    give(&options.control, order)
}

pub(super) fn fault(options: &Fault) -> anyhow::Result<()> {
    let drive = usize::from(options.drive);
    let damage = match options.action {
        FaultAction::List => return give(&options.control, Order::Faults),
        FaultAction::OpenA => Breakdown::OpenA,
        FaultAction::OpenB => Breakdown::OpenB,
        FaultAction::ShortedA => Breakdown::ShortedA,
        FaultAction::ShortedB => Breakdown::ShortedB,
        FaultAction::SensorA => Breakdown::SensorA,
        FaultAction::SensorB => Breakdown::SensorB,
        FaultAction::StuckRotor => Breakdown::StuckRotor,
        FaultAction::Supply { volts } => Breakdown::Supply(Millivolts((volts * 1000.0).round() as i32)),
        FaultAction::Mend => return give(&options.control, Order::Damage(Damage::Mend(drive))),
    };
    give(&options.control, Order::Damage(Damage::Break(drive, damage)))
}

/// Gives an order and writes what the server says.
fn give(control: &Path, order: Order) -> anyhow::Result<()> {
    match control::ask(control, order)? {
        Ok(text) => Ok(write!(io::stdout(), "{text}")?),
        Err(reason) => bail!(reason),
    }
}
