//! The identification's further steps: voltage at the full current and at half of it, and between them the square wave.

use super::identification::{MOST_TICKS, Outcome, Situation, Winding};
use super::pulses::{PULSE_SHARE, RIPPLE_SHARE};
use super::ripple::{self, Answer, TICK_SECONDS};
use super::vector::Vector;

/// Gain of the soft loop in V/A is this times the rough inductance: a bandwidth of 318 Hz.
const SOFT_BANDWIDTH: f32 = 2_000.0;
/// Its integration time in ticks: 2.5 ms.
const SOFT_INTEGRATION: f32 = 50.0;
/// Share of the supply that the soft loop may use; the rest is for the square wave.
const SOFT_SHARE: f32 = 0.6;
/// Ticks in which the current rises to a level: 10 ms.
const RISE_TICKS: u32 = 200;
/// Ticks in which it falls to half, and the soft loop settles: 8 ms.
const FALL_TICKS: u32 = 160;
/// Resistance that the loop shows a current across the direction, divided by the rough inductance: near the reactance at the frequency
/// at which the rotor swings, where it takes the most of the swing.
const ACROSS_BANDWIDTH: f32 = 1_000.0;
/// Ticks of a mean: 8 ms.
const MEAN_TICKS: u32 = 160;
/// Two means of the voltage agree that differ by less than this share and this many volt.
const AGREEMENT: (f32, f32) = (0.004, 0.003);
/// Swing of the current across that is calm, peak to peak: eleven steps of a converter of 12 bits over 12.8 A either way.
const CALM_BELOW: f32 = 0.068;
/// The bounds of a current that has not been seen yet.
const UNSEEN: (f32, f32) = (f32::INFINITY, f32::NEG_INFINITY);
/// When the full current's mean has to be known; the half's, at the end.
const FULL_DEADLINE: u32 = MOST_TICKS - RIPPLE_TICKS - FALL_TICKS - 2 * MEAN_TICKS;

/// Ticks of the square wave at full current, and how many of the first do not count.
const RIPPLE_TICKS: u32 = 272;
const RIPPLE_LEAD: u32 = 16;
/// Amplitude of the current in ampere that it is to have there at the least.
const RIPPLE_WANTED: f32 = 0.1;
/// Amplitude of the current's fundamental in ampere for a square wave of 1 V over an inductance of 1 H for ticks of 1 s: that of the wave,
/// through 1 / |z - 1|.
const SQUARE_GAIN: f32 = 1.306_563 / 0.765_366_9;

/// Mean voltage and current along the commanded direction at a level.
#[derive(Clone, Copy, Debug, Default)]
struct Mean {
    voltage: f32,
    current: f32,
}

/// Steps 2 to 4 under way.
#[derive(Clone, Debug)]
pub struct Levels {
    /// The rough inductance.
    inductance: f32,
    stage: Stage,
    /// Ticks of the stage.
    tick: u32,
    integral: f32,
    voltage: Vector,
    sum: Mean,
    across: (f32, f32),
    last: Option<Mean>,
    full: Mean,
    settled: bool,
    answer: Answer,
}

/// Where in steps 2 to 4.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Stage {
    /// The current rises; then its means, until the rotor has come to rest.
    Full,
    /// The square wave.
    Ripple,
    /// The current falls to the half; then its means.
    Half,
}

impl Levels {
    /// Before the first tick, with the rough inductance in henry.
    pub fn new(inductance: f32) -> Self {
        Self {
            inductance,
            stage: Stage::Full,
            tick: 0,
            integral: 0.0,
            voltage: Vector::default(),
            sum: Mean::default(),
            across: UNSEEN,
            last: None,
            full: Mean::default(),
            settled: true,
            answer: Answer::default(),
        }
    }

    /// Goes on to the next stage when one is over; `elapsed` are the ticks since the start of the identification.
    pub fn advance(&mut self, elapsed: u32) -> Option<Outcome> {
        match self.stage {
            Stage::Full => {
                self.full = self.mean(elapsed >= FULL_DEADLINE)?;
                self.begin(Stage::Ripple);
                None
            }
            Stage::Ripple => {
                if self.tick == RIPPLE_TICKS {
                    self.begin(Stage::Half);
                }
                None
            }
            Stage::Half => {
                let half = self.mean(elapsed >= MOST_TICKS)?;
                Some(self.result(half))
            }
        }
    }

    fn begin(&mut self, stage: Stage) {
        (self.stage, self.tick, self.last) = (stage, 0, None);
        (self.sum, self.across) = (Mean::default(), UNSEEN);
    }

    /// Ticks of the present stage that come before its means.
    const fn lead(&self) -> u32 {
        match self.stage {
            Stage::Full => RISE_TICKS,
            Stage::Ripple => RIPPLE_TICKS,
            Stage::Half => FALL_TICKS,
        }
    }

    /// The mean of a level, once two have agreed, or it is too late for that.
    fn mean(&mut self, late: bool) -> Option<Mean> {
        let ticks = self.tick.saturating_sub(self.lead());
        if ticks == 0 || !ticks.is_multiple_of(MEAN_TICKS) {
            self.settled &= !late;
            return late.then(|| self.last.unwrap_or_default());
        }
        let mean = Mean {
            voltage: self.sum.voltage / MEAN_TICKS as f32,
            current: self.sum.current / MEAN_TICKS as f32,
        };
        let (share, volts) = AGREEMENT;
        let agrees = |last: Mean| (mean.voltage - last.voltage).abs() < share * mean.voltage.abs() + volts;
        let calm = self.across.1 - self.across.0 < CALM_BELOW;
        let settled = calm && self.last.is_some_and(agrees);
        (self.sum, self.across, self.last) = (Mean::default(), UNSEEN, Some(mean));
        self.settled &= settled || !late;
        (settled || late).then_some(mean)
    }

    fn result(&self, half: Mean) -> Outcome {
        let resistance = (self.full.voltage - half.voltage) / (self.full.current - half.current);
        if !(resistance > 0.0 && resistance.is_finite()) {
            return Outcome::Unknown;
        }
        match self.answer.inductance(resistance) {
            Some(inductance) => {
                let winding = Winding {
                    resistance,
                    inductance,
                    settled: self.settled,
                };
                Outcome::Known(winding, self.voltage)
            }
            None => Outcome::Unknown,
        }
    }

    /// The current along the direction that the stage is to have by now, as a share.
    pub fn level(&self) -> f32 {
        match self.stage {
            Stage::Full => self.tick.min(RISE_TICKS) as f32 / RISE_TICKS as f32,
            Stage::Ripple => 1.0,
            Stage::Half => 1.0 - 0.5 * self.tick.min(FALL_TICKS) as f32 / FALL_TICKS as f32,
        }
    }

    /// The voltage over the windings for this tick.
    pub fn drive(&mut self, at: &Situation) -> Vector {
        let current = at.direction.into_frame(at.current);
        let error = at.amplitude * self.level() - current.a;
        let gain = SOFT_BANDWIDTH * self.inductance;
        let most = SOFT_SHARE * at.supply;
        self.integral = (self.integral + error * gain / SOFT_INTEGRATION).clamp(-most, most);
        self.voltage = Vector {
            a: (self.integral + error * gain).clamp(-most, most),
            b: (-current.b * ACROSS_BANDWIDTH * self.inductance).clamp(-most, most),
        };
        if self.stage == Stage::Ripple {
            self.add_ripple(current, at);
        }
        if self.tick >= self.lead() {
            self.sum.voltage += self.voltage.a;
            self.sum.current += current.a;
            self.across = (self.across.0.min(current.b), self.across.1.max(current.b));
        }
        self.tick += 1;
        at.direction.out_of_frame(self.voltage)
    }

    /// Lays the square wave over the voltage.
    fn add_ripple(&mut self, current: Vector, at: &Situation) {
        let wanted = (RIPPLE_SHARE * at.amplitude).max(RIPPLE_WANTED);
        let volts = wanted * self.inductance / (TICK_SECONDS * SQUARE_GAIN);
        self.voltage.a += volts.min(PULSE_SHARE.1 * at.supply) * ripple::square(self.tick);
        if self.tick >= RIPPLE_LEAD {
            self.answer.add(self.tick, current, self.voltage);
        }
    }
}
