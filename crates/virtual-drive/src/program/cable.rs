//! `cable`.

use std::io::{self, Write};

use anyhow::bail;

use super::arguments::{Cable, CableAction};
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
    match control::ask(&options.control, order)? {
        Ok(text) => Ok(write!(io::stdout(), "{text}")?),
        Err(reason) => bail!(reason),
    }
}
