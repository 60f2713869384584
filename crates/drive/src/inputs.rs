//! Digital inputs: filter, polarity and function (manual 1.3.1, 2.2.7, 2.2.8, 2.2.24).

use board::{INPUT_COUNT, InputLevels};

use crate::homing;
use crate::objects::DriveObjects;

/// Functions of inputs, the values of 0x2007 but for 0, general; 7 and 8 are probes 1 and 2.
const CW_LIMIT: usize = 1;
const CCW_LIMIT: usize = 2;
const HOME: usize = 3;
const FAULT_CLEAR: usize = 4;
const EMERGENCY_STOP: usize = 5;
const MOTOR_OFFLINE: usize = 6;
const PROBE_1: usize = 7;
const PROBE_2: usize = 8;

/// Number of touch probes.
pub const PROBES: usize = 2;

/// The signals of all inputs, after filter, polarity and function. Several inputs of one function are combined by or; of those that clear
/// faults, each counts for itself.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Signals {
    /// Inputs whose signal is valid, bit 0 IN1.
    pub valid: u8,
    /// Limit switches and home switch, of which CW is the positive limit and CCW the negative one.
    pub switches: homing::Signals,
    /// Which of them some input has as its function.
    pub assigned: homing::Signals,
    /// Function 4, fault clearance: an input that has it has become valid in this tick.
    pub fault_clear: bool,
    /// Function 5, emergency stop.
    pub emergency_stop: bool,
    /// Function 6, motor offline.
    pub offline: bool,
    /// Which inputs have function 7, probe 1, and function 8, probe 2; bit 0 is IN1.
    pub probes: [u8; PROBES],
    /// Which inputs have begun to differ from their filtered level in this tick. The filter may still reject that.
    pub differing: u8,
    /// Which inputs' filtered level has changed in this tick.
    pub changed: u8,
}

impl Signals {
    /// Whether a limit switch forbids motion in the direction that `travel` has the sign of.
    pub const fn block(&self, travel: i64) -> bool {
        travel > 0 && self.switches.positive_limit || travel < 0 && self.switches.negative_limit
    }

    /// Whether some limit switch is valid.
    pub const fn at_limit(&self) -> bool {
        self.switches.positive_limit || self.switches.negative_limit
    }

    /// The value of 0x60FD (manual 2.3.23).
    pub const fn digital_inputs(&self) -> u32 {
        self.switches.negative_limit as u32
            | (self.switches.positive_limit as u32) << 1
            | (self.switches.home as u32) << 2
            | (self.valid as u32) << 16
    }
}

/// The inputs with their filters.
#[derive(Clone, Debug, Default)]
pub struct Inputs {
    /// The level of each input that has been steady for long enough; none before the first tick, whose levels count at once.
    steady: Option<InputLevels>,
    /// Counts ticks; wraps after more of them than the longest filter has.
    now: u16,
    /// Which inputs differ from their steady level.
    differing: u8,
    /// When each of those has begun to.
    since: [u16; LANES],
    /// The functions of the inputs, 0x2007, as last seen.
    functions: [u16; INPUT_COUNT],
    /// What follows from them: which inputs have each function, bit 0 IN1.
    inputs: [u8; PROBE_2 + 1],
    /// Which switches some input has as its function.
    assigned: homing::Signals,
}

/// Room for the inputs in a round number, with which the filter goes through all of them by one vector instruction where there are such.
const LANES: usize = 8;

impl Inputs {
    /// Takes a tick's levels.
    #[inline(always)]
    pub fn tick(&mut self, levels: InputLevels, objects: &DriveObjects) -> Signals {
        let before = self.steady.unwrap_or(levels);
        let (steady, differing) = self.filter(levels, before, objects.input_filter);
        let normally_open = objects.input_polarity as u8;
        let valid = !(steady.0 ^ normally_open) & ((1 << INPUT_COUNT) - 1);
        let changed = steady.0 ^ before.0;
        self.assign(objects);
        let inputs = &self.inputs;
        let some_valid = |function: usize| valid & inputs[function] != 0;
        Signals {
            valid,
            switches: homing::Signals {
                negative_limit: some_valid(CCW_LIMIT),
                positive_limit: some_valid(CW_LIMIT),
                home: some_valid(HOME),
            },
            assigned: self.assigned,
            fault_clear: valid & changed & inputs[FAULT_CLEAR] != 0,
            emergency_stop: some_valid(EMERGENCY_STOP),
            offline: some_valid(MOTOR_OFFLINE),
            probes: [inputs[PROBE_1], inputs[PROBE_2]],
            differing,
            changed,
        }
    }

    /// The levels that follow on `steady`, and which inputs have begun to differ from it.
    fn filter(&mut self, levels: InputLevels, steady: InputLevels, ticks: u16) -> (InputLevels, u8) {
        self.now = self.now.wrapping_add(1);
        let differing = levels.0 ^ steady.0;
        let begun = differing & !self.differing;
        let mut over = 0;
        if differing != 0 {
            for (number, since) in self.since.iter_mut().enumerate() {
                let bit = 1 << number;
                *since = if u16::from(begun) & bit != 0 { self.now } else { *since };
                over |= if self.now.wrapping_sub(*since) >= ticks { bit } else { 0 };
            }
        }
        let over = over as u8;
        let changed = differing & over;
        self.differing = differing & !changed;
        let steady = InputLevels(steady.0 ^ changed);
        self.steady = Some(steady);
        (steady, begun)
    }

    /// Sorts the inputs by their functions, when those have changed. Unknown functions are general ones.
    fn assign(&mut self, objects: &DriveObjects) {
        let functions = [
            objects.input_1_function,
            objects.input_2_function,
            objects.input_3_function,
            objects.input_4_function,
            objects.input_5_function,
            objects.input_6_function,
        ];
        if functions == self.functions {
            return;
        }
        self.functions = functions;
        self.inputs = [0; PROBE_2 + 1];
        for (number, function) in functions.into_iter().enumerate() {
            if let Some(inputs) = self.inputs.get_mut(usize::from(function)) {
                *inputs |= 1 << number;
            }
        }
        self.assigned = homing::Signals {
            negative_limit: self.inputs[CCW_LIMIT] != 0,
            positive_limit: self.inputs[CW_LIMIT] != 0,
            home: self.inputs[HOME] != 0,
        };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    // manual: 2.2.24/time
    #[test]
    fn a_level_counts_once_it_was_steady_for_the_filter_time() {
        let mut objects = DriveObjects::new();
        objects.input_filter = 3;
        let mut inputs = Inputs::default();
        inputs.tick(InputLevels(0), &objects);
        let valid: [u8; 5] = core::array::from_fn(|_| inputs.tick(InputLevels(1), &objects).valid);
        assert_eq!(valid, [0, 0, 0, 1, 1]);
        for _ in 0..3 {
            assert_eq!(inputs.tick(InputLevels(0), &objects).valid, 1);
        }
        assert_eq!(inputs.tick(InputLevels(1), &objects).valid, 1);
        assert_eq!(inputs.tick(InputLevels(0), &objects).valid, 1);
    }

    #[test]
    fn without_filter_time_a_level_counts_in_its_own_tick_and_the_first_tick_counts_at_once() {
        let mut objects = DriveObjects::new();
        assert_eq!(Inputs::default().tick(InputLevels(0b10_0001), &objects).valid, 0b10_0001);
        objects.input_filter = 0;
        let mut inputs = Inputs::default();
        inputs.tick(InputLevels(0), &objects);
        assert_eq!(inputs.tick(InputLevels(0b100), &objects).valid, 0b100);
    }

    // manual: 2.2.8/polarity
    #[test]
    fn normally_open_is_valid_with_current_and_normally_closed_without() {
        let mut objects = DriveObjects::new();
        objects.input_polarity = 0b00_0100;
        assert_eq!(Inputs::default().tick(InputLevels(0b00_0111), &objects).valid, 0b11_1100);
    }

    // manual: 2.3.23/switches
    #[test]
    fn cw_is_the_positive_limit_and_bit_1_of_the_digital_inputs() {
        let objects = DriveObjects::new();
        let value = |levels| Inputs::default().tick(InputLevels(levels), &objects).digital_inputs();
        assert_eq!(value(0b00_0100), 0x0004_0002);
        assert_eq!(value(0b00_1000), 0x0008_0001);
        assert_eq!(value(0b01_0000), 0x0010_0004);
        assert_eq!(value(0b10_0011), 0x0023_0000);
    }

    #[test]
    fn inputs_of_one_function_are_combined_by_or() {
        let mut objects = DriveObjects::new();
        objects.input_1_function = 3;
        let signals = Inputs::default().tick(InputLevels(0b00_0001), &objects);
        assert!(signals.switches.home && signals.assigned.home);
    }
}
