//! No motion past a limit switch by more than it takes to stop with 0x6085 (manual 2.3.13).

use super::motion::SUB_PULSES;
use super::{Verdict, View, must};
use crate::coverage::Coverage;

/// The longest motion filter in ticks, for which the field goes on after its command.
const FILTER: usize = 512;
/// Where 0x2043 ends, in rpm: beyond it, the commanded speed is not known.
const TOP_RPM: i16 = 3000;

/// Both directions.
#[derive(Clone, Debug, Default)]
pub struct Limits {
    /// The largest commanded speeds in pulses/s, of the span of a filter before the present one and of that.
    commanded: [f64; 2],
    ticks: usize,
    /// Commanded speed in the tick before, with its sign.
    before: f64,
    stops: [Option<Stop>; 2],
}

/// A limit switch that is valid.
#[derive(Clone, Debug)]
struct Stop {
    /// Speed towards it when it became so, in pulses/s.
    speed: f64,
    /// The fastest that the filter may still hold.
    fastest: f64,
    /// The least deceleration allowed since.
    deceleration: f64,
    /// Pulses travelled towards it since.
    travelled: f64,
}

impl Stop {
    fn allowed(&self) -> f64 {
        const TICK: f64 = 50e-6;
        let braking = self.speed * self.speed / (2.0 * self.deceleration);
        braking + 2.0 * TICK * self.speed + FILTER as f64 * TICK * self.fastest + 2.0
    }
}

impl Limits {
    /// Looks at a tick.
    ///
    /// # Errors
    /// What does not hold.
    pub fn tick(&mut self, view: &View, coverage: &mut Coverage) -> Verdict {
        let commanded = commanded(view);
        self.remember(commanded.abs());
        let switches = view.signals.switches;
        let deceleration = deceleration(view);
        for (index, (valid, direction)) in [(switches.positive_limit, 1.0), (switches.negative_limit, -1.0)]
            .into_iter()
            .enumerate()
        {
            if !valid {
                self.stops[index] = None;
                continue;
            }
            let rounding = 0.5 / 60.0 * f64::from(view.objects.resolution);
            let speed = (commanded * direction).max(self.before * direction).max(0.0) + rounding;
            let fastest = self.commanded[0].max(self.commanded[1]) + rounding;
            let stop = self.stops[index].get_or_insert_with(|| {
                if view.velocity() as f64 * direction > 0.0 {
                    coverage.count("limit switch met in motion");
                }
                Stop {
                    speed,
                    fastest,
                    deceleration,
                    travelled: 0.0,
                }
            });
            stop.deceleration = stop.deceleration.min(deceleration);
            stop.travelled += (view.velocity() as f64 * direction / SUB_PULSES as f64).max(0.0);
            must(stop.travelled <= stop.allowed(), || {
                let side = if direction > 0.0 { "positive" } else { "negative" };
                format!(
                    "{:.1} pulses past the {side} limit: {stop:?}, allowed {:.1}",
                    stop.travelled,
                    stop.allowed()
                )
            })?;
        }
        self.before = commanded;
        Ok(())
    }

    fn remember(&mut self, speed: f64) {
        self.ticks += 1;
        if self.ticks.is_multiple_of(FILTER) {
            self.commanded = [self.commanded[1], 0.0];
        }
        self.commanded[1] = self.commanded[1].max(speed);
    }
}

/// With what the axis stops at a limit switch.
fn deceleration(view: &View) -> f64 {
    f64::from(view.objects.quick_stop_deceleration.max(1))
}

/// The commanded speed in pulses/s before the filter, as far as whole revolutions a minute show it; unbounded if it is not known.
fn commanded(view: &View) -> f64 {
    let shown = view.objects.speed_reference;
    if shown.abs() >= TOP_RPM {
        return f64::INFINITY.copysign(shown.into());
    }
    f64::from(shown) / 60.0 * f64::from(view.objects.resolution)
}
