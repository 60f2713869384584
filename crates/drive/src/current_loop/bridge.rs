//! From a voltage vector to the duties of the legs: limits of the supply, two phases and three.

use board::{Duty, LEG_COUNT, Millivolts};

use super::vector::Vector;

/// Share of the supply that a winding may get. The rest is for dead times, and for the lower transistors to be on long enough to measure
/// the current.
const USABLE: f32 = 0.95;
/// Supply voltages that the calculation of duties believes. What is outside is a measurement gone wrong, or a supply with which no motor
/// turns; protection deals with that, and duties stay within their limits meanwhile.
const BELIEVABLE: core::ops::RangeInclusive<i32> = 5_000..=100_000;

const SQRT_3: f32 = 1.732_050_8;

/// How the motor hangs on the legs, 0x200C:01 (manual 2.2.12).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Phases {
    /// Winding A between A+ and A-, winding B between B+ and B-.
    Two,
    /// A star: U at A+, V at A-, W at B+.
    Three,
}

impl Phases {
    /// The value of 0x200C:01.
    pub const fn from_object(motor_type: u16) -> Self {
        if motor_type == 1 { Self::Three } else { Self::Two }
    }

    /// The current vector from the currents out of A+ and B+.
    pub fn current(self, [first, second]: [f32; 2]) -> Vector {
        match self {
            Self::Two => Vector { a: first, b: second },
            Self::Three => Vector {
                a: first,
                b: (first + 2.0 * second) * (-1.0 / SQRT_3),
            },
        }
    }
}

/// The legs at a supply voltage.
#[derive(Clone, Copy, Debug)]
pub struct Bridge {
    phases: Phases,
    /// What lies between the ends of a winding (two phases) or between any two terminals (three) at the most, in volt.
    limit: f32,
    /// Share of the period that makes a volt.
    per_volt: f32,
}

impl Bridge {
    /// The legs with a motor at them, at the measured supply.
    pub fn at(supply: Millivolts, phases: Phases) -> Self {
        let volts = supply.0.clamp(*BELIEVABLE.start(), *BELIEVABLE.end()) as f32 * 1e-3;
        Self {
            phases,
            limit: USABLE * volts,
            per_volt: 1.0 / volts,
        }
    }

    /// What the supply leaves of a voltage.
    ///
    /// With two phases each winding has its own limit: at the limit of both the vector's direction gives way, and the voltage reaches
    /// 4/pi of what a circle would allow. With three the vector is shortened to the hexagon, its direction kept.
    pub fn limited(&self, voltage: Vector) -> Vector {
        match self.phases {
            Phases::Two => Vector {
                a: voltage.a.clamp(-self.limit, self.limit),
                b: voltage.b.clamp(-self.limit, self.limit),
            },
            Phases::Three => {
                let (least, most) = ends(terminals(voltage));
                let span = most - least;
                if span > self.limit {
                    voltage.times(self.limit / span)
                } else {
                    voltage
                }
            }
        }
    }

    /// The duties for a voltage that [`Bridge::limited`] has let through.
    ///
    /// Their middle is half the period: with two phases both ends of a winding move apart from it, with three the highest and the lowest
    /// terminal do, which is what uses the supply best.
    pub fn duties(&self, voltage: Vector) -> [Duty; LEG_COUNT] {
        match self.phases {
            Phases::Two => {
                let (a, b) = (voltage.a / 2.0, voltage.b / 2.0);
                [a, -a, b, -b].map(|volts| self.duty(volts))
            }
            Phases::Three => {
                let [u, v, w] = terminals(voltage);
                let (least, most) = ends([u, v, w]);
                let middle = (least + most) / 2.0;
                [u - middle, v - middle, w - middle, 0.0].map(|volts| self.duty(volts))
            }
        }
    }

    /// The duty of a leg whose mean is that many volts above half the supply.
    fn duty(&self, volts: f32) -> Duty {
        Duty(((0.5 + volts * self.per_volt) * 65_536.0) as u16)
    }
}

/// Voltages of U, V and W against the star.
fn terminals(voltage: Vector) -> [f32; 3] {
    let half = -voltage.a / 2.0;
    let across = voltage.b * (SQRT_3 / 2.0);
    [voltage.a, half + across, half - across]
}

/// The least and the most.
fn ends([u, v, w]: [f32; 3]) -> (f32, f32) {
    (u.min(v).min(w), u.max(v).max(w))
}
