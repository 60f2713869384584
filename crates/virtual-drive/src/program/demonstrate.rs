//! `usr2556e` alone.

use std::io::{self, Write};
use std::time::Duration;

use indicatif::{ProgressBar, ProgressStyle};

use super::arguments::Demonstration;
use super::arguments::motor::Equipment;
use crate::clock::Clock;
use crate::demo::session::Progress;
use crate::demo::{self, Machine};
use crate::motor::Motor;
use crate::motor::commissioning::Commissioning;

pub(super) fn demonstrate(options: &Demonstration) -> anyhow::Result<()> {
    let clock = if options.lock_step {
        Clock::lock_step()
    } else {
        Clock::real_time()
    };
    let mut progress = Bar::new();
    let outcome = demo::run(&options.output, clock, &machine(&options.equipment), &mut progress);
    progress.end();
    let outcome = outcome?;
    let mut out = io::stdout().lock();
    writeln!(out, "\nReport\n{}\n", outcome.report)?;
    writeln!(out, "Picture: {}", outcome.picture.display())?;
    writeln!(out, "Capture: {} (opens in Wireshark)", outcome.capture.display())?;
    Ok(())
}

/// What hangs on the drive. A motor that was chosen is commissioned with its rated current.
fn machine(equipment: &Equipment) -> Machine {
    let commission = |motor: &Motor| Commissioning::of(&motor.parameters, motor.parameters.rated_current);
    Machine {
        plant: equipment.plant(),
        commissioning: equipment.motor.as_ref().map(commission),
    }
}

/// A bar on a terminal; lines elsewhere.
struct Bar {
    bar: ProgressBar,
    is_terminal: bool,
}

impl Bar {
    fn new() -> Self {
        let bar = ProgressBar::new(0);
        let style = ProgressStyle::with_template("  {msg:45} [{bar:30}] {elapsed}");
        bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()).progress_chars("=> "));
        let is_terminal = !bar.is_hidden();
        Self { bar, is_terminal }
    }

    fn end(&self) {
        self.bar.finish_and_clear();
    }

    fn line(&self, text: &str) {
        if self.is_terminal {
            self.bar.println(text);
        } else {
            // A demonstration nobody reads still leaves its files.
            let _ = writeln!(io::stdout(), "{text}");
        }
    }
}

impl Progress for Bar {
    fn begin(&mut self, what: &str, expected: Duration) {
        self.line(what);
        self.bar.set_length(expected.as_millis() as u64);
        self.bar.set_position(0);
        self.bar.set_message(what.to_owned());
    }

    fn advance(&mut self, elapsed: Duration) {
        let length = self.bar.length().unwrap_or(0);
        self.bar.set_position((elapsed.as_millis() as u64).min(length));
    }

    fn note(&mut self, line: &str) {
        self.line(&format!("  {line}"));
    }
}
