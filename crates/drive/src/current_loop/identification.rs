//! Identification of the motor's resistance and inductance while the shaft is locked (manual 2.2.11, 2.2.12).
//!
//! | step | what | why |
//! |---|---|---|
//! | 1 | a square wave of 2.5 kHz on both axes, doubled until it shows | a rough inductance; an open or shorted winding |
//! | 2 | a soft loop takes the current to half its value, and to the whole | two voltages, whose difference dead times and offsets do not touch: the resistance |
//! | 3 | the square wave again, on top of the full current | the inductance, with the rotor aligned and the current far from zero |
//!
//! A level of step 2 counts when two means of 8 ms agree and the current across the commanded direction is calm: a rotor that still
//! swings induces voltages that would pass for resistance.

use super::ripple::{self, Answer};
use super::vector::{Direction, Vector};

/// Ticks that the identification takes at the most: 103 ms, which with 2 ms for the offsets before makes 105 ms.
pub const MOST_TICKS: u32 = 2_060;

/// Ticks of one amplitude of the square wave in step 1: 2 ms.
const PULSE_TICKS: u32 = 40;
/// The first of them do not count.
const PULSE_LEAD: u32 = 8;
/// Share of the supply that the square wave begins with, and ends with.
const PULSE_SHARE: (f32, f32) = (0.02, 0.3);
/// Amplitude of the current that is enough in step 1: this share of the locked current, and at least this many ampere.
const RIPPLE_SHARE: f32 = 0.05;
const RIPPLE_LEAST: f32 = 0.05;
/// A current below this at the full square wave is noise: the winding is open. 10 mA are 70 mH at 24 V.
const OPEN_BELOW: f32 = 0.010;
/// An inductance below this is a short, in henry.
const SHORT_BELOW: f32 = 50e-6;

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
/// Swing of the current across that is calm, peak to peak: 14 steps of a converter of 12 bits over 20 A.
const CALM_BELOW: f32 = 0.068;
/// The bounds of a current that has not been seen yet.
const CALM: (f32, f32) = (f32::INFINITY, f32::NEG_INFINITY);
/// When the full current's mean has to be known; the half's, at the end.
const FULL_DEADLINE: u32 = MOST_TICKS - RIPPLE_TICKS - FALL_TICKS - 2 * MEAN_TICKS;

/// Ticks of the square wave at full current, and how many of the first do not count.
const RIPPLE_TICKS: u32 = 272;
const RIPPLE_LEAD: u32 = 16;
/// Amplitude of the current in ampere that it is to have there at the least.
const RIPPLE_WANTED: f32 = 0.1;
/// Amplitude of the current in ampere where a square wave of 1 V lies over 1 Vs/A divided by a tick: its fundamental through 1 / |z - 1|.
const SQUARE_GAIN: f32 = 1.306_563 / 0.765_366_9;

/// What a tick looks at.
#[derive(Clone, Copy, Debug)]
pub struct Situation {
    /// The measured current, offsets taken off, in ampere.
    pub current: Vector,
    /// The supply in volt.
    pub supply: f32,
    /// The current of the locked shaft in ampere.
    pub amplitude: f32,
    /// Its direction.
    pub direction: Direction,
    /// Whether the motor has three phases.
    pub three_phases: bool,
}

/// A motor's winding as identified.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Winding {
    /// Resistance in ohm, that of bridge and cable included.
    pub resistance: f32,
    /// Inductance in henry.
    pub inductance: f32,
    /// Whether the rotor came to rest in time. If not, the values are rough.
    pub settled: bool,
}

/// What comes of a tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Outcome {
    /// The voltage over the windings for this tick.
    Drive(Vector),
    /// The motor is known; the voltage that holds the present current, in the commanded frame.
    Known(Winding, Vector),
    /// A winding, counted from 0, carries no current.
    Open(usize),
    /// A winding has no inductance worth the name.
    Shorted,
    /// The values make no sense, as those of a motor that somebody turns.
    Unknown,
}

/// The identification under way.
#[derive(Clone, Debug)]
pub struct Identification {
    tick: u32,
    step: Step,
}

#[derive(Clone, Debug)]
enum Step {
    Pulses(Pulses),
    Levels(Levels),
}

impl Identification {
    /// Before its first tick.
    pub fn new() -> Self {
        Self {
            tick: 0,
            step: Step::Pulses(Pulses::default()),
        }
    }

    /// One tick of it.
    pub fn tick(&mut self, at: &Situation) -> Outcome {
        self.tick += 1;
        let levels = match &mut self.step {
            Step::Levels(levels) => levels,
            Step::Pulses(pulses) => {
                let inductance = match pulses.tick(at) {
                    Pulse::Drive(voltage) => return Outcome::Drive(voltage),
                    Pulse::Open(winding) => return Outcome::Open(winding),
                    Pulse::Shorted => return Outcome::Shorted,
                    Pulse::Answered(inductance) => inductance,
                };
                self.step = Step::Levels(Levels::new(inductance));
                return self.tick(at);
            }
        };
        match levels.advance(self.tick) {
            Some(outcome) => outcome,
            None => Outcome::Drive(levels.drive(at)),
        }
    }

    /// The share of the locked current that is commanded.
    pub fn level(&self) -> f32 {
        match &self.step {
            Step::Pulses(_) => 0.0,
            Step::Levels(levels) => levels.level(),
        }
    }
}

impl Default for Identification {
    fn default() -> Self {
        Self::new()
    }
}

/// Step 1.
#[derive(Clone, Debug, Default)]
struct Pulses {
    tick: u32,
    /// Share of the supply.
    share: f32,
    answer: Answer,
}

enum Pulse {
    Drive(Vector),
    Answered(f32),
    Open(usize),
    Shorted,
}

impl Pulses {
    fn tick(&mut self, at: &Situation) -> Pulse {
        if self.tick == PULSE_TICKS {
            if let Some(verdict) = self.verdict(at) {
                return verdict;
            }
            self.tick = 0;
        }
        if self.tick == 0 {
            self.share = (self.share * 2.0).clamp(PULSE_SHARE.0, PULSE_SHARE.1);
            self.answer = Answer::default();
        }
        let volts = self.share * at.supply;
        // A quarter of a period apart: a vector that turns, to which each of three phases answers alike.
        let voltage = Vector {
            a: volts * ripple::square(self.tick),
            b: volts * ripple::square(self.tick + ripple::PERIOD * 3 / 4),
        };
        if self.tick >= PULSE_LEAD {
            self.answer.add(self.tick, at.current, voltage);
        }
        self.tick += 1;
        Pulse::Drive(voltage)
    }

    /// What an amplitude has shown; none if it takes a larger one.
    fn verdict(&self, at: &Situation) -> Option<Pulse> {
        let ripple = self.answer.ripple(at.three_phases);
        let [a, b] = self.answer.inductances();
        let least = ripple.iter().copied().fold(f32::INFINITY, f32::min);
        let enough = (RIPPLE_SHARE * at.amplitude).max(RIPPLE_LEAST);
        let most = ripple.iter().copied().filter(|ripple| ripple.is_finite()).fold(0.0, f32::max);
        if most >= enough && a.min(b) < SHORT_BELOW {
            return Some(Pulse::Shorted);
        }
        if least < enough && self.share < PULSE_SHARE.1 {
            return None;
        }
        match ripple.iter().position(|ripple| *ripple < OPEN_BELOW) {
            Some(winding) => Some(Pulse::Open(winding)),
            None => Some(Pulse::Answered((a + b) / 2.0)),
        }
    }
}

/// Mean voltage and current along the commanded direction at a level.
#[derive(Clone, Copy, Debug, Default)]
struct Mean {
    voltage: f32,
    current: f32,
}

/// Steps 2 and 3: the full current, the square wave on top of it, and the half.
#[derive(Clone, Debug)]
struct Levels {
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

/// Where in steps 2 and 3.
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
    fn new(inductance: f32) -> Self {
        Self {
            inductance,
            stage: Stage::Full,
            tick: 0,
            integral: 0.0,
            voltage: Vector::default(),
            sum: Mean::default(),
            across: CALM,
            last: None,
            full: Mean::default(),
            settled: true,
            answer: Answer::default(),
        }
    }

    /// Goes on to the next stage when one is over; `elapsed` are the ticks since the start of the identification.
    fn advance(&mut self, elapsed: u32) -> Option<Outcome> {
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
        (self.sum, self.across) = (Mean::default(), CALM);
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
            return if late { Some(self.last.unwrap_or_default()) } else { None };
        }
        let mean = Mean {
            voltage: self.sum.voltage / MEAN_TICKS as f32,
            current: self.sum.current / MEAN_TICKS as f32,
        };
        let (share, volts) = AGREEMENT;
        let agrees = |last: Mean| (mean.voltage - last.voltage).abs() < share * mean.voltage.abs() + volts;
        let calm = self.across.1 - self.across.0 < CALM_BELOW;
        let settled = calm && self.last.is_some_and(agrees);
        (self.sum, self.across, self.last) = (Mean::default(), CALM, Some(mean));
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
    fn level(&self) -> f32 {
        match self.stage {
            Stage::Full => self.tick.min(RISE_TICKS) as f32 / RISE_TICKS as f32,
            Stage::Ripple => 1.0,
            Stage::Half => 1.0 - 0.5 * self.tick.min(FALL_TICKS) as f32 / FALL_TICKS as f32,
        }
    }

    fn drive(&mut self, at: &Situation) -> Vector {
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

/// A tick in seconds.
const TICK_SECONDS: f32 = board::TICK.0 as f32 * 1e-9;
