//! The status line of each drive.

use std::fmt;
use std::io::{self, Write};

use drive::Mode;
use indicatif::{MultiProgress, ProgressBar, ProgressStyle};

use crate::cables::{Cable, CableState};
use crate::drive::DriveStatus;
use crate::segment::VirtualSegment;

impl fmt::Display for DriveStatus {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:6}", self.al_state.name())?;
        if self.al_status_code.code() != 0 {
            write!(f, " (0x{:04X})", self.al_status_code.code())?;
        }
        let mode = Mode::from_object(self.mode).map_or("no mode", Mode::name);
        write!(f, "  {:22} {:7}", self.power_state.name(), mode)?;
        write!(
            f,
            "  position {:>11}  shaft {:>9.3} turns  {:>5} rpm",
            self.position, self.shaft.0, self.velocity_rpm
        )?;
        if self.error_code != 0 {
            write!(f, "  error 0x{:04X}", self.error_code)?;
        }
        // By name: drawn as often as this line is, a flashing LED would show flashes that are not its own.
        write!(f, "  LEDs: {}", self.indicators)
    }
}

/// One line a drive: rewritten in place on a terminal, written anew when a state changes elsewhere. And one for each change of a cable.
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
        let style = ProgressStyle::with_template("{prefix:>4} {wide_msg}").unwrap_or_else(|_| ProgressStyle::default_spinner());
        let line = |number: usize| {
            let bar = frame.add(ProgressBar::new_spinner());
            bar.set_style(style.clone());
            bar.set_prefix(number.to_string());
            bar
        };
        let bars: Vec<ProgressBar> = (1..=drives).map(line).collect();
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
                self.bars[position].set_message(status.to_string());
            } else {
                let state = format!(
                    "{} {} {} {} {}",
                    status.al_state.name(),
                    status.al_status_code.code(),
                    status.power_state.name(),
                    status.mode,
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
