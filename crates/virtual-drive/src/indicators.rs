//! The LEDs on a drive's front: RUN, ERR, link and activity of each port (manual 1.4.1), alarm (manual 1.6).

use std::fmt;

use drive::{Alarm, Drive, Light};
use esc::Chip;
use slave::Leds;
use wire::Nanos;
use wire::indicator::{Indicator, Pattern};

/// Ports as the manual names them; a junction's further ones have numbers.
const PORT_NAMES: [&str; 4] = ["IN", "OUT", "port 2", "port 3"];

/// The LEDs of one drive. [`Indicator::is_lit`] tells whether one is lit at an instant, [`Indicator::pattern`] what it does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Indicators {
    /// RUN, green: the state.
    pub run: Indicator,
    /// ERR, red: an error that is not acknowledged.
    pub err: Indicator,
    /// What the alarm LED tells.
    pub alarm: Alarm,
    /// What it shows.
    pub alarm_light: Light,
    /// The ports' LEDs, by number; `None` for ports that the slave controller does not have.
    pub ports: [Option<PortIndicators>; PORT_NAMES.len()],
}

/// The two LEDs of a port.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PortIndicators {
    /// Yellow: on with a link.
    pub link: Indicator,
    /// Green: flickers while frames come by.
    pub activity: Indicator,
}

impl Indicators {
    /// The LEDs of a drive with so many ports at power-on.
    pub(crate) fn new(ports: usize) -> Self {
        Self {
            run: Indicator::default(),
            err: Indicator::default(),
            alarm: Alarm::Disabled,
            alarm_light: Light::Green,
            ports: std::array::from_fn(|port| (port < ports).then(PortIndicators::default)),
        }
    }

    pub(crate) fn update(&mut self, leds: Leds, chip: &Chip, drive: &Drive, now: Nanos) {
        let Leds { run, err } = leds;
        (self.run, self.err) = (run, err);
        (self.alarm, self.alarm_light) = (drive.alarm(), drive.alarm_light());
        for (port, lights) in self.ports.iter_mut().enumerate() {
            if let Some(PortIndicators { link, activity }) = lights {
                link.show(if chip.has_link(port) { Pattern::ON } else { Pattern::OFF }, now);
                let flickers = chip.is_active(port, now);
                activity.show(if flickers { Pattern::FLICKERING } else { Pattern::OFF }, now);
            }
        }
    }

    /// What all LEDs do but those that flicker with the traffic, so that it is the same text as long as nothing changes.
    pub fn without_activity(&self) -> String {
        let ports = self.ports.map(|port| {
            port.map(|port| PortIndicators {
                activity: Indicator::default(),
                ..port
            })
        });
        Self { ports, ..*self }.to_string()
    }
}

impl fmt::Display for Indicators {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "RUN {}, ERR {}, alarm {}", self.run.pattern(), self.err.pattern(), self.alarm)?;
        for (name, port) in PORT_NAMES.iter().zip(&self.ports) {
            if let Some(port) = port {
                write!(f, ", {name} {port}")?;
            }
        }
        Ok(())
    }
}

impl fmt::Display for PortIndicators {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match (self.link.pattern(), self.activity.pattern()) {
            (Pattern::OFF, _) => "no link",
            (_, Pattern::OFF) => "link",
            _ => "active",
        })
    }
}
