//! The log as lines of text.

use core::fmt::Write;

use super::EventLog;
use crate::files::Line;

/// The name of the file.
pub(crate) const FILE: &str = "eventlog.txt";

/// What a reading of the file goes over: the events that were in the log when it began.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Span {
    first: u32,
    events: usize,
}

impl EventLog {
    /// The events to report now.
    pub(crate) fn span(&self) -> Span {
        Span {
            first: self.numbers().start,
            events: self.records.len(),
        }
    }

    /// Writes line number `line` of a report to `out`: a heading, then a line for each event. An event that was overwritten meanwhile
    /// makes an empty one. Returns whether there is such a line.
    pub(crate) fn line(&self, span: Span, device: &str, line: usize, out: &mut Line) -> bool {
        // A line that does not fit is cut off: the longest event has some hundred bytes.
        let Some(event) = line.checked_sub(1) else {
            _ = writeln!(out, "# Event log of {device}: number, device time in s, severity, event");
            return true;
        };
        if event >= span.events {
            return false;
        }
        if let Some(record) = self.record(span.first.wrapping_add(event as u32)) {
            let (seconds, nanoseconds) = (record.time / 1_000_000_000, record.time % 1_000_000_000);
            let severity = record.event.severity().name();
            _ = writeln!(
                out,
                "{:>5} {seconds:>7}.{nanoseconds:09} {severity:<11} {}",
                record.number, record.event
            );
        }
        true
    }
}

#[cfg(test)]
mod tests {
    use super::super::{CAPACITY, Event};
    use super::*;

    fn report(log: &EventLog, span: Span) -> std::string::String {
        let mut text = std::string::String::new();
        let mut line = Line::new();
        let mut number = 0;
        while log.line(span, "Lamp", number, &mut line) {
            text.push_str(&line);
            line.clear();
            number += 1;
        }
        text
    }

    #[test]
    fn a_report_has_a_heading_and_a_line_an_event() {
        let mut log = EventLog {
            time: 12_000_000_034,
            ..EventLog::default()
        };
        log.add(Event::PowerOn);
        log.add(Event::Fault { code: 0x3110, register: 5 });
        assert_eq!(
            report(&log, log.span()),
            "# Event log of Lamp: number, device time in s, severity, event\n\
             \x20   0      12.000000034 information Power-on\n\
             \x20   1      12.000000034 error       Fault 0x3110, error register 0x05\n"
        );
    }

    #[test]
    fn a_report_ends_where_it_ended_when_it_began_and_leaves_out_what_is_gone() {
        let mut log = EventLog::default();
        for _ in 0..CAPACITY {
            log.add(Event::PowerOn);
        }
        let span = log.span();
        for _ in 0..CAPACITY - 1 {
            log.add(Event::ParametersSaved);
        }
        let text = report(&log, span);
        assert_eq!(text.lines().count(), 2);
        assert!(text.ends_with(" 31       0.000000000 information Power-on\n"), "{text}");
    }
}
