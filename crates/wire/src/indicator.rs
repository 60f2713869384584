//! What the LEDs of an EtherCAT device do: patterns of RUN, ERR and link/activity, their codes in 0x0138 and 0x0139, and when they are lit
//! (ETG.1300).

use core::fmt;

use crate::Nanos;

/// A short flash, and the pause after it within a group or in blinking, in ns.
const FLASH: u64 = 200_000_000;
/// The pause after a group of flashes in ns.
const PAUSE: u64 = 1_000_000_000;
/// How long flickering is on, and how long off, in ns.
const FLICKER: u64 = 50_000_000;

/// What an LED does as time goes by: one of the codes in bits 3:0 of the LED override registers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Pattern(u8);

impl Pattern {
    /// Dark.
    pub const OFF: Self = Self(0x0);
    /// 200 ms on, 1 s off.
    pub const SINGLE_FLASH: Self = Self(0x1);
    /// 200 ms on, 200 ms off, 200 ms on, 1 s off.
    pub const DOUBLE_FLASH: Self = Self(0x2);
    /// 200 ms on, 200 ms off: 2.5 Hz.
    pub const BLINKING: Self = Self(0xD);
    /// 50 ms on, 50 ms off: 10 Hz.
    pub const FLICKERING: Self = Self(0xE);
    /// Lit.
    pub const ON: Self = Self(0xF);

    /// In an LED override register: the code in bits 3:0 is shown.
    const OVERRIDE: u8 = 0x10;

    /// The pattern with the code in bits 3:0; codes 1 to 12 are as many flashes and a pause.
    pub const fn from_code(code: u8) -> Self {
        Self(code & 0x0F)
    }

    /// The pattern that an LED override register asks for, if it asks for any.
    pub const fn from_override(register: u8) -> Option<Self> {
        if register & Self::OVERRIDE != 0 {
            Some(Self::from_code(register))
        } else {
            None
        }
    }

    /// The LED override register that asks for this pattern.
    pub const fn to_override(self) -> u8 {
        Self::OVERRIDE | self.0
    }

    /// Whether an LED is lit that has shown this pattern for so long, in ns. Every pattern begins with light, if it has any.
    pub const fn is_lit(self, shown_for: u64) -> bool {
        let step = match self {
            Self::OFF => return false,
            Self::ON => return true,
            Self::FLICKERING => FLICKER,
            _ => FLASH,
        };
        let at = shown_for % self.period();
        at < self.active() && (at / step).is_multiple_of(2)
    }

    /// After how long the pattern begins anew, in ns; 1 if it never changes.
    pub const fn period(self) -> u64 {
        match self {
            Self::OFF | Self::ON => 1,
            Self::FLICKERING => 2 * FLICKER,
            Self::BLINKING => 2 * FLASH,
            _ => self.active() + PAUSE,
        }
    }

    /// From the first light of a period to the end of the last, in ns.
    const fn active(self) -> u64 {
        match self {
            Self::OFF => 0,
            Self::ON => 1,
            Self::FLICKERING => FLICKER,
            Self::BLINKING => FLASH,
            Self(flashes) => (2 * flashes as u64 - 1) * FLASH,
        }
    }
}

impl fmt::Display for Pattern {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::OFF => f.pad("off"),
            Self::ON => f.pad("on"),
            Self::BLINKING => f.pad("blinking"),
            Self::FLICKERING => f.pad("flickering"),
            Self::SINGLE_FLASH => f.pad("single flash"),
            Self::DOUBLE_FLASH => f.pad("double flash"),
            Self(flashes) => write!(f, "{flashes} flashes"),
        }
    }
}

/// An LED: its pattern, and when that began.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Indicator {
    pattern: Pattern,
    since: Nanos,
}

impl Indicator {
    /// Shows a pattern from `now` on; one that is shown already goes on.
    pub fn show(&mut self, pattern: Pattern, now: Nanos) {
        if pattern != self.pattern {
            *self = Self { pattern, since: now };
        }
    }

    /// The pattern.
    pub const fn pattern(&self) -> Pattern {
        self.pattern
    }

    /// Whether the LED is lit.
    pub const fn is_lit(&self, now: Nanos) -> bool {
        self.pattern.is_lit(now.since(self.since))
    }
}

#[cfg(test)]
mod tests {
    extern crate std;

    use std::string::ToString;

    use super::*;

    const MS: u64 = 1_000_000;

    /// Spans of light and dark in turn, in ms, as ETG.1300 gives them.
    const PATTERNS: [(u8, &str, &[u64]); 8] = [
        (0x0, "off", &[0, 1000]),
        (0x1, "single flash", &[200, 1000]),
        (0x2, "double flash", &[200, 200, 200, 1000]),
        (0x3, "3 flashes", &[200, 200, 200, 200, 200, 1000]),
        (0x4, "4 flashes", &[200, 200, 200, 200, 200, 200, 200, 1000]),
        (0xD, "blinking", &[200, 200]),
        (0xE, "flickering", &[50, 50]),
        (0xF, "on", &[1000, 0]),
    ];

    // manual: 1.4.1/fast 1.4.1/slow 1.4.1/single 1.4.1/double
    #[test]
    fn every_millisecond_of_two_periods_is_as_the_standard_says() {
        for (code, name, spans) in PATTERNS {
            let pattern = Pattern::from_code(code);
            assert_eq!(pattern.to_string(), name);
            let mut at = 0;
            for _ in 0..2 {
                for (number, span) in spans.iter().enumerate() {
                    for _ in 0..*span {
                        assert_eq!(pattern.is_lit(at * MS), number % 2 == 0, "{name} after {at} ms");
                        assert_eq!(
                            pattern.is_lit((at + 1) * MS - 1),
                            number % 2 == 0,
                            "{name} just before {} ms",
                            at + 1
                        );
                        at += 1;
                    }
                }
            }
        }
    }

    #[test]
    fn every_code_up_to_twelve_flashes_so_often_in_a_period() {
        for flashes in 1..=12 {
            let pattern = Pattern::from_code(flashes);
            let lit = |ms: u64| pattern.is_lit(ms * MS);
            let rises = (1..=pattern.period() / MS).filter(|ms| lit(*ms) && !lit(ms - 1)).count();
            assert_eq!(rises, usize::from(flashes));
        }
    }

    #[test]
    fn registers_name_every_pattern_and_whether_it_is_asked_for() {
        for register in 0..=u8::MAX {
            let pattern = Pattern::from_override(register);
            assert_eq!(pattern.is_some(), register & 0x10 != 0);
            if let Some(pattern) = pattern {
                assert_eq!(pattern.to_override(), 0x10 | register & 0x0F);
            }
        }
    }

    #[test]
    fn a_pattern_begins_anew_when_it_changes_and_only_then() {
        let mut led = Indicator::default();
        assert!(!led.is_lit(Nanos(0)));
        led.show(Pattern::SINGLE_FLASH, Nanos(330 * MS));
        assert!(led.is_lit(Nanos(330 * MS)) && !led.is_lit(Nanos(530 * MS)));
        led.show(Pattern::SINGLE_FLASH, Nanos(600 * MS));
        assert!(!led.is_lit(Nanos(600 * MS)), "the same goes on");
        led.show(Pattern::BLINKING, Nanos(700 * MS));
        assert!(led.is_lit(Nanos(700 * MS)), "another begins with light");
        assert!(led.is_lit(Nanos(0)), "an instant before is the beginning");
    }
}
