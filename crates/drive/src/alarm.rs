//! The alarm LED, green and red (manual 1.6).
//!
//! The manual gives the order of its flashes but not their times; they are those of the network's LEDs (manual 1.4.1).

use core::fmt;

use board::TICKS_PER_SECOND;

use crate::faults::Fault;
use crate::power_state::PowerState;

/// A flash, and the pause after it, in ticks: 200 ms.
const FLASH: u32 = TICKS_PER_SECOND / 5;
/// The pause after the last flash of a fault in ticks: 1 s.
const PAUSE: u32 = TICKS_PER_SECOND;

/// What the LED shows at an instant.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Light {
    /// Dark.
    Off,
    /// Green.
    Green,
    /// Red.
    Red,
}

/// What the LED tells.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Alarm {
    /// The drive is not enabled: green.
    Disabled,
    /// The drive works: green, flashing.
    Enabled,
    /// A fault: once green, then so often red.
    Fault {
        /// How often.
        red: u8,
    },
}

impl Alarm {
    /// What is to be told in a state. A fault without a place in the manual's table leaves a drive that is not enabled.
    pub(crate) fn of(state: PowerState, fault: Option<Fault>) -> Self {
        match fault.map_or(0, Fault::red_flashes) {
            0 if state.is_enabled() => Self::Enabled,
            0 => Self::Disabled,
            red => Self::Fault { red },
        }
    }

    /// What the LED shows that has told this for so many ticks.
    pub const fn light(self, ticks: u32) -> Light {
        let at = ticks % self.period();
        let flash = at / (2 * FLASH);
        match self {
            Self::Disabled => Light::Green,
            _ if at % (2 * FLASH) >= FLASH => Light::Off,
            Self::Enabled => Light::Green,
            Self::Fault { .. } if flash == 0 => Light::Green,
            Self::Fault { red } if flash <= red as u32 => Light::Red,
            Self::Fault { .. } => Light::Off,
        }
    }

    /// After how many ticks the LED begins anew.
    pub const fn period(self) -> u32 {
        match self {
            Self::Disabled => 1,
            Self::Enabled => 2 * FLASH,
            Self::Fault { red } => (2 * red as u32 + 1) * FLASH + PAUSE,
        }
    }
}

impl fmt::Display for Alarm {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Disabled => f.pad("green"),
            Self::Enabled => f.pad("green flashing"),
            Self::Fault { red } => write!(f, "1 green {red} red"),
        }
    }
}

/// The LED, tick by tick.
#[derive(Clone, Debug)]
pub(crate) struct AlarmLed {
    alarm: Alarm,
    /// Ticks in which it has told this: no drive runs for so long that they overflow.
    ticks: u64,
}

impl AlarmLed {
    /// The LED at power-up.
    pub(crate) const fn new() -> Self {
        Self {
            alarm: Alarm::Disabled,
            ticks: 0,
        }
    }

    /// Lets a tick pass; what is new begins anew.
    pub(crate) fn tick(&mut self, alarm: Alarm) {
        self.ticks = if alarm == self.alarm { self.ticks + 1 } else { 0 };
        self.alarm = alarm;
    }

    pub(crate) const fn alarm(&self) -> Alarm {
        self.alarm
    }

    pub(crate) const fn light(&self) -> Light {
        self.alarm.light((self.ticks % self.alarm.period() as u64) as u32)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TICKS_PER_MS: u32 = TICKS_PER_SECOND / 1000;

    /// What is shown, and for how many ms.
    fn assert_shown(alarm: Alarm, spans: &[(Light, u32)]) {
        let mut led = AlarmLed { alarm, ticks: 0 };
        for _ in 0..2 {
            for &(light, ms) in spans {
                for tick in 0..ms * TICKS_PER_MS {
                    assert_eq!(led.light(), light, "{alarm} {tick} ticks into {ms} ms of {light:?}");
                    led.tick(alarm);
                }
            }
        }
    }

    // manual: 1.6/disabled 1.6/working
    #[test]
    fn every_tick_of_two_periods_is_as_the_manual_says() {
        let (green, red, off) = (Light::Green, Light::Red, Light::Off);
        assert_shown(Alarm::Disabled, &[(green, 1000)]);
        assert_shown(Alarm::Enabled, &[(green, 200), (off, 200)]);
        assert_shown(Alarm::Fault { red: 1 }, &[(green, 200), (off, 200), (red, 200), (off, 1000)]);
        assert_shown(
            Alarm::Fault { red: 3 },
            &[
                (green, 200),
                (off, 200),
                (red, 200),
                (off, 200),
                (red, 200),
                (off, 200),
                (red, 200),
                (off, 1000),
            ],
        );
    }

    #[test]
    fn a_fault_with_seven_flashes_takes_as_many() {
        let alarm = Alarm::Fault { red: 7 };
        let rises = |light| {
            (1..=alarm.period())
                .filter(|tick| alarm.light(*tick) == light && alarm.light(tick - 1) != light)
                .count()
        };
        assert_eq!((rises(Light::Green), rises(Light::Red)), (1, 7));
    }

    #[test]
    fn what_is_new_begins_anew() {
        let mut led = AlarmLed::new();
        led.tick(Alarm::Enabled);
        for _ in 0..FLASH {
            led.tick(Alarm::Enabled);
        }
        assert_eq!(led.light(), Light::Off);
        led.tick(Alarm::Fault { red: 2 });
        assert_eq!(led.light(), Light::Green);
    }
}
