//! The status line of each drive.

use std::fmt;
use std::io::{self, Write};

use drive::Mode;
use drive::faults::Fault;
use indicatif::{MultiProgress, ProgressBar, ProgressStyle};

use crate::cables::{Cable, CableState};
use crate::drive::DriveStatus;
use crate::segment::VirtualSegment;

/// States, mode, position and error, without the LEDs.
struct States<'a>(&'a DriveStatus);

impl fmt::Display for States<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self(status) = self;
        write!(f, "{:6}", status.al_state.name())?;
        if status.al_status_code.code() != 0 {
            write!(f, " (0x{:04X})", status.al_status_code.code())?;
        }
        let mode = Mode::from_object(status.mode).map_or("no mode", Mode::name);
        write!(f, "  {:22} {:7}", status.power_state.name(), mode)?;
        write!(
            f,
            "  position {:>11}  shaft {:>9.3} turns  {:>5} rpm",
            status.position, status.motor.shaft.0, status.velocity_rpm
        )?;
        if status.error_code != 0 {
            let name = Fault::of_code(status.error_code).map_or("unknown", Fault::name);
            write!(f, "  fault 0x{:04X}, {name}", status.error_code)?;
        }
        Ok(())
    }
}

impl fmt::Display for DriveStatus {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // By name: drawn as often as this line is, a flashing LED would show flashes that are not its own.
        write!(f, "{}  motor: {}  LEDs: {}", States(self), self.motor, self.indicators)
    }
}

/// What there is to tell of each drive: rewritten in place on a terminal, with motor and LEDs on lines of their own, since many terminals are
/// not wide enough for all; written anew when a state changes or the first step is lost elsewhere. And a line for each change of a cable.
pub struct StatusLines {
    bars: Vec<ProgressBar>,
    /// Draws the bars; nothing is drawn without it.
    frame: MultiProgress,
    is_terminal: bool,
    states: Vec<String>,
    /// The cables as they were last told; whole at first.
    cables: Vec<Cable>,
}

impl StatusLines {
    /// Lines for so many drives.
    pub fn new(drives: usize) -> Self {
        let frame = MultiProgress::new();
        let style = ProgressStyle::with_template("{wide_msg}\n{prefix}").unwrap_or_else(|_| ProgressStyle::default_spinner());
        let lines = |_| {
            let bar = frame.add(ProgressBar::new_spinner());
            bar.set_style(style.clone());
            bar
        };
        let bars: Vec<ProgressBar> = (0..drives).map(lines).collect();
        let is_terminal = bars.first().is_some_and(|bar| !bar.is_hidden());
        Self {
            bars,
            frame,
            is_terminal,
            states: vec![String::new(); drives],
            cables: Vec::new(),
        }
    }

    /// Shows how cables and drives are.
    pub fn show(&mut self, segment: &VirtualSegment) {
        self.show_cables(segment.cables().collect());
        for (position, drive) in segment.drives().iter().enumerate() {
            let status = drive.status();
            if self.is_terminal {
                self.bars[position].set_message(format!("{:>4} {}", position + 1, States(&status)));
                self.bars[position].set_prefix(format!("     motor: {}\n     LEDs: {}", status.motor, status.indicators));
            } else {
                let state = format!(
                    "{} {} {} {} {} {}",
                    status.al_state.name(),
                    status.al_status_code.code(),
                    status.power_state.name(),
                    status.mode,
                    status.motor.lost_periods != 0,
                    status.indicators.without_activity()
                );
                if state != self.states[position] {
                    // The drives go on when nobody reads.
                    let _ = writeln!(io::stdout(), "{:>4} {status}", position + 1);
                    self.states[position] = state;
                }
            }
        }
    }

    /// Says which cables are not what they were.
    fn show_cables(&mut self, cables: Vec<Cable>) {
        for (number, cable) in cables.iter().enumerate() {
            let before = self.cables.get(number).map_or(CableState::Whole, |cable| cable.state);
            if cable.state != before {
                let line = cable.to_string();
                // The drives go on when nobody reads.
                let _ = match self.is_terminal {
                    true => self.frame.println(line),
                    false => writeln!(io::stdout(), "{line}"),
                };
            }
        }
        self.cables = cables;
    }
}
