//! Inputs from the terminal to 0x60FD (manual 2.2.7, 2.2.8, 2.2.22, 2.2.24, 2.3.23).

use board::INPUT_COUNT;

use super::{Verdict, View, must};

/// The filtered levels, by a model of its own.
#[derive(Clone, Debug, Default)]
pub struct Inputs {
    /// Filtered level and for how many ticks the input has differed from it; nothing before the first tick.
    filters: Option<[(bool, u32); INPUT_COUNT]>,
}

impl Inputs {
    /// Looks at a tick.
    ///
    /// # Errors
    /// What does not hold.
    pub fn tick(&mut self, view: &View) -> Verdict {
        let objects = view.objects;
        let level = |number: usize| view.sensors.inputs.0 >> number & 1 != 0;
        let filters = self.filters.get_or_insert_with(|| std::array::from_fn(|number| (level(number), 0)));
        let functions = [
            objects.input_1_function,
            objects.input_2_function,
            objects.input_3_function,
            objects.input_4_function,
            objects.input_5_function,
            objects.input_6_function,
        ];
        let mut expected = 0_u32;
        let (mut emergency, mut offline) = (false, false);
        for (number, (steady, differing)) in filters.iter_mut().enumerate() {
            *differing = if level(number) == *steady { 0 } else { *differing + 1 };
            if *differing > u32::from(objects.input_filter) {
                (*steady, *differing) = (!*steady, 0);
            }
            let normally_open = objects.input_polarity >> number & 1 != 0;
            if *steady != normally_open {
                continue;
            }
            expected |= 1 << (16 + number);
            match functions[number] {
                1 => expected |= 2,
                2 => expected |= 1,
                3 => expected |= 4,
                5 => emergency = true,
                6 => offline = true,
                _ => {}
            }
        }
        must(objects.digital_inputs == expected, || {
            format!("60FD = {:06X}, not {expected:06X}", objects.digital_inputs)
        })?;
        must((view.signals.emergency_stop, view.signals.offline) == (emergency, offline), || {
            format!("emergency stop {emergency}, motor offline {offline} not seen")
        })?;
        let levels = u16::from(view.sensors.inputs.0);
        must(objects.input_level == levels, || {
            format!("2049 = {:04X}, not {levels:04X}", objects.input_level)
        })
    }
}
