//! The axis: end stops, two limit switches and a home switch.

/// A position of the shaft or the axis, in turns of the motor.
#[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd)]
pub struct Turns(pub f64);

/// The axis a motor moves, in turns of the motor. Position 0 is wherever the caller says.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Travel {
    /// The negative limit switch is on here and below.
    pub negative_limit: Turns,
    /// The positive limit switch is on here and above.
    pub positive_limit: Turns,
    /// The home switch is on from its left edge up to, not including, its right edge.
    pub home: (Turns, Turns),
    /// The shaft comes to a hard stop at these two ends.
    pub stops: (Turns, Turns),
}

impl Default for Travel {
    /// Twenty turns between the limit switches, a home switch half a turn wide right of the middle, hard stops two turns behind the
    /// limit switches.
    fn default() -> Self {
        Self {
            negative_limit: Turns(-10.0),
            positive_limit: Turns(10.0),
            home: (Turns(1.0), Turns(1.5)),
            stops: (Turns(-12.0), Turns(12.0)),
        }
    }
}

/// Which switches are on.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Switches {
    /// The negative end is reached.
    pub negative_limit: bool,
    /// The positive end is reached.
    pub positive_limit: bool,
    /// The home switch is on.
    pub home: bool,
}

impl Travel {
    /// The switches when the axis stands at `position`.
    pub fn switches(&self, position: Turns) -> Switches {
        let [negative_limit, positive_limit, home] = self.ranges().map(|(from, to)| from <= position && position < to);
        Switches {
            negative_limit,
            positive_limit,
            home,
        }
    }

    /// Where the negative limit switch, the positive one and the home switch are on: each from its left edge up to, not including, its
    /// right one.
    pub(crate) const fn ranges(&self) -> [(Turns, Turns); 3] {
        [
            (Turns(f64::NEG_INFINITY), Turns(self.negative_limit.0.next_up())),
            (self.positive_limit, Turns(f64::INFINITY)),
            self.home,
        ]
    }
}
