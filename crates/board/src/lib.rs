//! The electrical boundary of the drive: what its firmware measures and what it commands.
//!
//! On a board, [`Sensors`] come from ADC and GPIO and [`Actuators`] go to PWM and GPIO; on a PC both are a simulation's. The firmware
//! core cannot tell which. Quantities are newtypes, so that no two units mix.
#![no_std]
#![forbid(unsafe_code)]

/// A span of time in nanoseconds.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct Nanos(pub u64);

/// The period of the firmware's control tick: 50 us, the unit of objects 0x200A and 0x204B (manual 2.2.10, 2.2.24).
pub const TICK: Nanos = Nanos(50_000);

/// Ticks a second.
pub const TICKS_PER_SECOND: u32 = (1_000_000_000 / TICK.0) as u32;

/// An electric current.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct Milliamps(pub i32);

/// A voltage.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct Millivolts(pub i32);

/// An angle within one electrical period of the motor, in 2^-32 periods; it wraps as angles do.
///
/// One electrical period is four full steps; a 1.8 degree motor has 50 of them a turn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ElectricalAngle(pub u32);

/// Electrical periods in one turn of the motor: 50, the pole pairs of a 1.8 degree hybrid stepper.
pub const ELECTRICAL_PERIODS_PER_TURN: u32 = 50;

/// Number of digital inputs (manual 1.3).
pub const INPUT_COUNT: usize = 6;

/// Number of digital outputs (manual 1.3).
pub const OUTPUT_COUNT: usize = 2;

/// Which opto-couplers of IN1 to IN6 carry current: bit 0 is IN1.
///
/// This is the electrical level, before filter (0x204B) and polarity (0x2008).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct InputLevels(pub u8);

impl InputLevels {
    /// Whether the input `number`, counted from 1 as on the terminal block, carries current.
    pub fn is_on(self, number: usize) -> bool {
        debug_assert!((1..=INPUT_COUNT).contains(&number));
        self.0 >> (number - 1) & 1 == 1
    }
}

/// Which output transistors of OUT1 and OUT2 conduct: bit 0 is OUT1.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct OutputLevels(pub u8);

/// What the firmware measures at the start of a tick.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Sensors {
    /// The six digital inputs.
    pub inputs: InputLevels,
    /// How long before this measurement each input took its level, IN1 first. It counts for inputs whose level is not that of the
    /// measurement before, and is [`TICK`] at the most.
    ///
    /// Touch probes latch the position at this instant. A board takes it from the input capture of a timer; one without capture leaves
    /// it 0, and an edge then counts at the measurement that shows it, up to a tick late.
    pub level_ages: [Nanos; INPUT_COUNT],
    /// The supply at the power stage.
    pub bus_voltage: Millivolts,
    /// Currents that flow out of the legs A+ and B+: those of winding A and winding B of a motor of two phases, of U and W of one of three.
    pub phase_currents: [Milliamps; 2],
}

/// What the firmware commands at the end of a tick.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Actuators {
    /// The power stage.
    pub stage: PowerStage,
    /// The two digital outputs.
    pub outputs: OutputLevels,
}

/// The command to the power stage.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PowerStage {
    /// All transistors off: no current, the shaft is free.
    #[default]
    Off,
    /// The four legs (half bridges) switch: A+, A-, B+, B-. The duty is the share of the PWM period in which the upper transistor is on.
    ///
    /// A PWM period lasts a tick and takes its duties at its start: the command that a tick ends with acts in the period after it, and the
    /// firmware has the whole tick to compute it.
    Legs([Duty; LEG_COUNT]),
}

/// Half bridges of the power stage: terminals A+, A-, B+, B-.
///
/// A motor of two phases has winding A between A+ and A-, and winding B between B+ and B-. One of three phases has U at A+, V at A- and
/// W at B+.
pub const LEG_COUNT: usize = 4;

/// Share of a PWM period in 2^-16: 0 is always low, 65535 always high but for the least step.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct Duty(pub u16);
