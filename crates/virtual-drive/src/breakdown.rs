//! What breaks at a drive, its windings, its motor or its supply, to be broken and mended while everything runs.

use std::fmt;
use std::str::FromStr;

use board::Millivolts;
use plant::Faults;

/// One thing that breaks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Breakdown {
    /// The wire of winding A breaks, with three phases that of U.
    OpenA,
    /// The wire of winding B breaks, with three phases that of W.
    OpenB,
    /// Most turns of winding A, or U, are shorted.
    ShortedA,
    /// Most turns of winding B, or W, are shorted.
    ShortedB,
    /// The sensor of winding A's current, or U's, reads 1 A too much.
    SensorA,
    /// The sensor of winding B's current, or W's, reads 1 A too much.
    SensorB,
    /// The rotor cannot turn.
    StuckRotor,
    /// The supply's voltage is off by so much: a sag below 0, a surge above.
    Supply(Millivolts),
}

/// The furthest a supply can be off in mV, either way.
pub const LARGEST_OFFSET: i32 = 100_000;

impl Breakdown {
    /// All but the supply, by name.
    const NAMED: [(&str, Self); 7] = [
        ("open-a", Self::OpenA),
        ("open-b", Self::OpenB),
        ("shorted-a", Self::ShortedA),
        ("shorted-b", Self::ShortedB),
        ("sensor-a", Self::SensorA),
        ("sensor-b", Self::SensorB),
        ("stuck-rotor", Self::StuckRotor),
    ];

    /// Adds this to what is broken already.
    pub const fn add_to(self, faults: &mut Faults) {
        match self {
            Self::OpenA => faults.open[0] = true,
            Self::OpenB => faults.open[1] = true,
            Self::ShortedA => faults.shorted[0] = true,
            Self::ShortedB => faults.shorted[1] = true,
            Self::SensorA => faults.sensors[0] = true,
            Self::SensorB => faults.sensors[1] = true,
            Self::StuckRotor => faults.stuck_rotor = true,
            Self::Supply(offset) => faults.supply_offset = offset,
        }
    }

    /// What is broken, one by one.
    pub fn all_of(faults: &Faults) -> impl Iterator<Item = Self> {
        // Adding what is there already changes nothing.
        let is_there = |breakdown: &Self| {
            let mut more = *faults;
            breakdown.add_to(&mut more);
            more == *faults
        };
        let supply = (faults.supply_offset != Millivolts(0)).then_some(Self::Supply(faults.supply_offset));
        let named = Self::NAMED.into_iter().map(|(_, breakdown)| breakdown);
        named.filter(is_there).chain(supply)
    }
}

/// `open-a`, `supply -12000` in mV, and the like.
impl fmt::Display for Breakdown {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match (self, Self::NAMED.iter().find(|(_, breakdown)| breakdown == self)) {
            (Self::Supply(offset), _) => write!(f, "supply {}", offset.0),
            (_, named) => f.write_str(named.map_or("", |(name, _)| name)),
        }
    }
}

/// A text that tells no breakdown, and why not.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NoBreakdown;

impl fmt::Display for NoBreakdown {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "known are open-a, open-b, shorted-a, shorted-b, sensor-a, sensor-b, stuck-rotor, and supply with a number of mV up to {LARGEST_OFFSET} either way"
        )
    }
}

impl std::error::Error for NoBreakdown {}

impl FromStr for Breakdown {
    type Err = NoBreakdown;

    fn from_str(text: &str) -> Result<Self, NoBreakdown> {
        if let Some((_, breakdown)) = Self::NAMED.iter().find(|(name, _)| *name == text) {
            return Ok(*breakdown);
        }
        let offset = text
            .strip_prefix("supply ")
            .and_then(|number| number.parse().ok())
            .ok_or(NoBreakdown)?;
        if (-LARGEST_OFFSET..=LARGEST_OFFSET).contains(&offset) {
            Ok(Self::Supply(Millivolts(offset)))
        } else {
            Err(NoBreakdown)
        }
    }
}

/// What is to be done to a drive, whose number counts from 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Damage {
    /// Breaks one thing more.
    Break(usize, Breakdown),
    /// Mends everything.
    Mend(usize),
}

/// `break 2 open-a` and the like.
impl fmt::Display for Damage {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Break(drive, breakdown) => write!(f, "break {drive} {breakdown}"),
            Self::Mend(drive) => write!(f, "mend {drive}"),
        }
    }
}

impl FromStr for Damage {
    type Err = NoBreakdown;

    fn from_str(text: &str) -> Result<Self, NoBreakdown> {
        let (verb, rest) = text.split_once(' ').ok_or(NoBreakdown)?;
        let number = |text: &str| text.parse().map_err(|_| NoBreakdown);
        match (verb, rest.split_once(' ')) {
            ("break", Some((drive, breakdown))) => Ok(Self::Break(number(drive)?, breakdown.parse()?)),
            ("mend", None) => Ok(Self::Mend(number(rest)?)),
            _ => Err(NoBreakdown),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn damage_is_told_by_text_and_back() {
        for text in [
            "break 1 open-a",
            "break 2 open-b",
            "break 3 shorted-a",
            "break 4 shorted-b",
            "break 5 stuck-rotor",
            "break 5 sensor-a",
            "break 6 supply -12000",
            "mend 7",
        ] {
            assert_eq!(text.parse::<Damage>().unwrap().to_string(), text);
        }
        for text in [
            "",
            "break",
            "break 1",
            "break x open-a",
            "break 1 open-c",
            "break 1 supply",
            "break 1 supply 100001",
            "mend",
            "mend 1 2",
        ] {
            assert_eq!(text.parse::<Damage>(), Err(NoBreakdown), "{text}");
        }
    }

    #[test]
    fn what_was_broken_is_what_is_listed() {
        let all: Vec<Breakdown> = Breakdown::NAMED.into_iter().map(|(_, breakdown)| breakdown).collect();
        let mut faults = Faults::default();
        assert_eq!(Breakdown::all_of(&faults).count(), 0);
        for breakdown in &all {
            breakdown.add_to(&mut faults);
        }
        Breakdown::Supply(Millivolts(3_000)).add_to(&mut faults);
        let listed: Vec<Breakdown> = Breakdown::all_of(&faults).collect();
        assert_eq!(listed, [&all[..], &[Breakdown::Supply(Millivolts(3_000))]].concat());
    }
}
