//! What a simulation has been through: a run that never got anywhere proves nothing.

use std::collections::BTreeMap;
use std::fmt;

/// How often each thing has happened, by name.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Coverage(BTreeMap<String, u64>);

impl Coverage {
    /// Counts one more.
    pub fn count(&mut self, what: &str) {
        match self.0.get_mut(what) {
            Some(count) => *count += 1,
            None => {
                self.0.insert(what.into(), 1);
            }
        }
    }

    /// How often it has happened.
    pub fn of(&self, what: &str) -> u64 {
        self.0.get(what).copied().unwrap_or(0)
    }

    /// Takes what another simulation has been through.
    pub fn add(&mut self, other: &Self) {
        for (what, count) in &other.0 {
            *self.0.entry(what.clone()).or_default() += count;
        }
    }
}

impl fmt::Display for Coverage {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (what, count) in &self.0 {
            writeln!(f, "{count:>12}  {what}")?;
        }
        Ok(())
    }
}

/// What every simulated hour must have been through.
pub const REQUIRED: &[&str] = &[
    "state Switch On Disabled",
    "state Ready To Switch On",
    "state Switched On",
    "state Operation Enabled",
    "state Quick Stop Active",
    "state Fault Reaction Active",
    "state Fault",
    "AL INIT",
    "AL PREOP",
    "AL SAFEOP",
    "AL OP",
    "OP with distributed clocks",
    "moving in PP",
    "moving in PV",
    "moving in homing",
    "moving in CSP",
    "fault 7500",
    "fault 3110",
    "homing attained",
    "homing failed",
    "target reached in PP",
    "probe latched",
    "limit switch met in motion",
    "change of mode in motion",
    "position cleared",
    "motor offline in motion",
    "cable cut",
    "power cycle",
    "parameters saved",
    "parameters restored",
    "own mapping",
    "SDO taken",
    "SDO refused",
    "segments taken",
    "complete access",
    "event log read",
    "parameters read as a file",
    "parameters restored from a file",
    "reset of the slave controller",
    "motor identified",
    "motor mistaken",
    "current loop tuned",
    "broken: open A",
    "broken: open B",
    "broken: shorted A",
    "broken: shorted B",
    "broken: stuck rotor",
    "broken: supply sags",
    "broken: supply surges",
    "fault 2211",
    "fault 3210",
    "fault 7122",
    "steps lost",
];
