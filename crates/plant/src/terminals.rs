//! The input terminals: what on the axis switches them, and when within a step.

use board::{INPUT_COUNT, InputLevels, Nanos, TICK};

use crate::{PlantConfig, Turns};

/// Switches an axis can have: two limits, home, and one more for each terminal.
const SWITCHES: usize = 3 + INPUT_COUNT;

/// A switch on the axis and its wire.
#[derive(Clone, Copy, Debug)]
struct Switch {
    /// The terminal's bit, or 0 if the wire leads nowhere.
    terminal: u8,
    /// On from here on...
    from: Turns,
    /// ...and up to here, where it is off again.
    to: Turns,
}

impl Switch {
    fn new(terminal: usize, (from, to): (Turns, Turns)) -> Self {
        let exists = (1..=INPUT_COUNT).contains(&terminal);
        Self {
            terminal: if exists { 1 << (terminal - 1) } else { 0 },
            from,
            to,
        }
    }

    fn is_on_at(&self, position: Turns) -> bool {
        self.from <= position && position < self.to
    }

    /// How long before the end of a step this switch changed, whose shaft went evenly from `start` to `end`. What changed although the
    /// shaft did not pass an edge was changed by a hand before the step.
    fn age(&self, start: Turns, end: Turns) -> Nanos {
        let entered = self.is_on_at(end);
        if self.is_on_at(start) == entered {
            return TICK;
        }
        let edge = if (end > start) == entered { self.from } else { self.to };
        let share = (end.0 - edge.0) / (end.0 - start.0);
        Nanos((share.clamp(0.0, 1.0) * TICK.0 as f64) as u64)
    }
}

/// The terminals with all that is wired to them.
#[derive(Clone, Debug)]
pub(crate) struct Terminals {
    switches: [Switch; SWITCHES],
    /// Input terminals somebody holds on by hand, as a wire or a push-button would.
    pub(crate) held_on: InputLevels,
    /// Where the last step ended, which terminals were held on then, and the levels there.
    seen: (Turns, InputLevels, InputLevels),
    /// Nothing switches from the first of these positions up to, not including, the second, between which the last step ended.
    still: (Turns, Turns),
    /// How long before that the levels had changed that changed in that step.
    pub(crate) ages: [Nanos; INPUT_COUNT],
}

impl Terminals {
    pub(crate) fn new(config: &PlantConfig) -> Self {
        let [negative_limit, positive_limit, home] = config.travel.ranges();
        let mut switches = [Switch::new(config.wiring.home, home); SWITCHES];
        switches[1] = Switch::new(config.wiring.negative_limit, negative_limit);
        switches[2] = Switch::new(config.wiring.positive_limit, positive_limit);
        for (index, flag) in config.flags.iter().enumerate() {
            let terminal = if flag.is_some() { index + 1 } else { 0 };
            switches[3 + index] = Switch::new(terminal, flag.unwrap_or_default());
        }
        let mut terminals = Self {
            switches,
            held_on: InputLevels(0),
            seen: (config.start, InputLevels(0), InputLevels(0)),
            still: (config.start, config.start),
            ages: [Nanos(0); INPUT_COUNT],
        };
        terminals.seen.2 = terminals.levels(config.start);
        terminals
    }

    /// The nearest edges around a position.
    fn edges_around(&self, position: Turns) -> (Turns, Turns) {
        let edges = self.switches.iter().flat_map(|switch| [switch.from, switch.to]);
        let far = (Turns(f64::NEG_INFINITY), Turns(f64::INFINITY));
        edges.fold(far, |(below, above), edge| {
            if edge <= position {
                (if edge > below { edge } else { below }, above)
            } else {
                (below, if edge < above { edge } else { above })
            }
        })
    }

    /// The levels while the shaft is at `position`.
    pub(crate) fn levels(&self, position: Turns) -> InputLevels {
        let on = |switch: &&Switch| switch.is_on_at(position);
        let switched = self.switches.iter().filter(on).fold(0, |levels, switch| levels | switch.terminal);
        InputLevels(switched | self.held_on.0)
    }

    /// Takes a step in which the shaft goes evenly from `start` to `end`, and returns the levels there.
    #[inline]
    pub(crate) fn step(&mut self, start: Turns, end: Turns) -> InputLevels {
        let (_, held_on, levels) = self.seen;
        if self.still.0 <= end && end < self.still.1 && self.held_on == held_on {
            self.seen.0 = end;
            self.ages = [Nanos(0); INPUT_COUNT];
            return levels;
        }
        self.switch(start, end)
    }

    /// A step that may have passed an edge.
    fn switch(&mut self, start: Turns, end: Turns) -> InputLevels {
        let levels = self.levels(end);
        self.ages = match self.seen.2.0 ^ levels.0 {
            0 => [Nanos(0); INPUT_COUNT],
            changed => core::array::from_fn(|number| match changed & 1 << number {
                0 => Nanos(0),
                terminal => self.age(terminal, levels.0 & terminal != 0, start, end),
            }),
        };
        self.seen = (end, self.held_on, levels);
        self.still = self.edges_around(end);
        levels
    }

    /// How long before the end of the step `terminal` took its level: it is on since the first of what is wired to it went on, and off
    /// since the last went off.
    fn age(&self, terminal: u8, on: bool, start: Turns, end: Turns) -> Nanos {
        let changed = |switch: &&Switch| switch.terminal == terminal && switch.is_on_at(self.seen.0) != switch.is_on_at(end);
        let by_hand = (self.seen.1.0 ^ self.held_on.0) & terminal != 0;
        let switched = self.switches.iter().filter(changed).map(|switch| switch.age(start, end));
        let ages = switched.chain(by_hand.then_some(TICK));
        let age = if on { ages.max() } else { ages.min() };
        age.unwrap_or(TICK)
    }
}
