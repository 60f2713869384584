//! Touch probes (manual 2.3.17 to 2.3.22): what is latched was armed, and is counted once.

use super::{Verdict, View, must};
use crate::coverage::Coverage;

/// The probes in the tick before.
#[derive(Clone, Debug, Default)]
pub struct Probes {
    function: u16,
    status: u16,
    counts: [u16; 4],
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
            }
        }
        *self = Self { function, status, counts };
        Ok(())
    }
}
