//! Touch probes (manual 2.3.17 to 2.3.22): what is latched was armed, and is counted once.

use std::collections::VecDeque;

use super::motion::SUB_PULSES;
use super::{Verdict, View, must};
use crate::coverage::Coverage;

/// The longest input filter for which the place of an edge is known, in ticks.
const LONGEST: usize = 300;

/// The probes in the tick before.
#[derive(Clone, Debug, Default)]
pub struct Probes {
    function: u16,
    status: u16,
    counts: [u16; 4],
    /// Positions of the last ticks, the oldest first.
    positions: VecDeque<i32>,
    /// Input filter, and ticks for which it has been that.
    filter: (u16, usize),
}

impl Probes {
    /// Looks at a tick.
    ///
    /// # Errors
    /// What does not hold.
    pub fn tick(&mut self, view: &View, coverage: &mut Coverage) -> Verdict {
        let objects = view.objects;
        let (function, status) = (objects.probe_function, objects.probe_status);
        let counts = [
            objects.probe_1_positive_count,
            objects.probe_1_negative_count,
            objects.probe_2_positive_count,
            objects.probe_2_negative_count,
        ];
        self.remember(view);
        let places = [
            objects.probe_1_positive,
            objects.probe_1_negative,
            objects.probe_2_positive,
            objects.probe_2_negative,
        ];
        must(status & !0x0707 == 0, || format!("60B9 = {status:04X} has bits without a meaning"))?;
        for (edge, (count, before)) in counts.into_iter().zip(self.counts).enumerate() {
            let probe = edge / 2 * 8;
            let enabled = |function: u16| function >> probe & 1 != 0;
            let armed = |function: u16| enabled(function) && function >> (probe + 4 + edge % 2) & 1 != 0;
            let shown = |status: u16| status >> (probe + 1 + edge % 2) & 1 != 0;
            must((status >> probe & 1 != 0) == enabled(function), || {
                format!("60B9 = {status:04X} with 60B8 = {function:04X}")
            })?;
            must(!shown(status) || armed(function), || {
                format!("60B9 = {status:04X} shows an edge not armed in 60B8 = {function:04X}")
            })?;
            let latched = shown(status) && !shown(self.status);
            must(count.wrapping_sub(before) == latched.into(), || {
                format!(
                    "60D5 + {edge} from {before} to {count} with 60B9 from {:04X} to {status:04X}",
                    self.status
                )
            })?;
            must(!latched || armed(self.function), || {
                "an edge latched in the tick that armed it".into()
            })?;
            if latched {
                coverage.count("probe latched");
                self.check_place(places[edge] as i32, view)?;
            }
        }
        (self.function, self.status, self.counts) = (function, status, counts);
        Ok(())
    }

    /// Keeps the position, unless the counter has got another value.
    fn remember(&mut self, view: &View) {
        let position = view.objects.position;
        let travelled = i64::from(position.wrapping_sub(self.positions.back().copied().unwrap_or(position)));
        let velocity = view.velocity() / SUB_PULSES;
        if (travelled - velocity).abs() > 1 {
            self.positions.clear();
        }
        if self.positions.len() == LONGEST {
            self.positions.pop_front();
        }
        self.positions.push_back(position);
        let filter = view.objects.input_filter;
        let ticks = if self.filter.0 == filter { self.filter.1 + 1 } else { 0 };
        self.filter = (filter, ticks);
    }

    /// What is latched is where the axis was within the tick in which the level changed, before the filter's time.
    fn check_place(&self, place: i32, view: &View) -> Verdict {
        let delay = usize::from(view.objects.input_filter);
        // With a filter that was changed while the level differed, nothing is known.
        let known = self.positions.len().min(self.filter.1);
        if known < delay + 2 {
            return Ok(());
        }
        let from = self.positions.len() - (delay + 2);
        let offsets = self.positions.range(from..=from + 1).map(|position| position.wrapping_sub(place));
        let (least, most) = offsets.fold((i32::MAX, i32::MIN), |(least, most), offset| (least.min(offset), most.max(offset)));
        must(least <= 1 && most >= -1, || {
            format!("latched {place}, {least} to {most} pulses off")
        })
    }
}
