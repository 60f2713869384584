//! What the keys of a motor's file tell.

use std::ops::Range;

use plant::{MotorParameters, Phases};
use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::line_of;
use crate::motor::mistake::{Mistake, nearest};
use crate::motor::quantity::{
    self, BACK_EMF, DETENT_TORQUE, DRAG, FRICTION, HOLDING_TORQUE, INDUCTANCE, LOAD_INERTIA, PEAK_CURRENT, QUANTITIES, RATED_CURRENT,
    RESISTANCE, ROTOR_INERTIA, SUPPLY_VOLTAGE, Unit, number,
};
use crate::motor::{Motor, figures};

/// Largest number of characters of a name or a description.
const TEXT_LIMIT: usize = 200;

/// Sections of the file.
const SECTIONS: [&str; 3] = ["motor", "load", "supply"];

/// Estimates for what a data sheet does not tell, as parts of the holding torque: those of the named motors, on average. Drag is by rad/s.
const ESTIMATES: [(usize, &str, f64); 3] = [
    (DETENT_TORQUE, "detent torque", 0.04),
    (FRICTION, "friction", 0.016),
    (DRAG, "drag", 0.001),
];

/// The shortest electrical time constant that a simulation in steps of 50 us follows, in s.
pub(super) const SHORTEST_TIME_CONSTANT: f64 = 100e-6;

/// The highest natural frequency that such a simulation follows, in Hz.
const HIGHEST_NATURAL_FREQUENCY: f64 = 2000.0;

/// A value that the file tells.
#[derive(Clone, Copy)]
struct Told {
    /// In SI units.
    value: f64,
    line: usize,
    unit: &'static Unit,
}

/// What has been read so far.
pub(super) struct Reader<'a> {
    text: &'a str,
    mistakes: Vec<Mistake>,
    name: String,
    description: String,
    phases: Phases,
    told: [Option<Told>; QUANTITIES.len()],
    /// Quantities that stand there, right or wrong: these are not missing.
    present: [bool; QUANTITIES.len()],
    /// The line of the motor's section, where a missing key belongs.
    section_line: usize,
}

impl<'a> Reader<'a> {
    pub(super) fn new(text: &'a str) -> Self {
        Self {
            text,
            mistakes: Vec::new(),
            name: String::new(),
            description: String::new(),
            phases: Phases::Two,
            told: [None; QUANTITIES.len()],
            present: [false; QUANTITIES.len()],
            section_line: 1,
        }
    }

    /// The motor of a document, or all of its mistakes.
    pub(super) fn read(mut self, document: &DeTable<'_>) -> Result<Motor, Vec<Mistake>> {
        self.top(document);
        let motor = self.motor();
        self.mistakes.sort_by_key(|mistake| mistake.line);
        match motor {
            Some(motor) if self.mistakes.is_empty() => Ok(motor),
            _ => Err(self.mistakes),
        }
    }

    fn mistake(&mut self, line: usize, reason: impl Into<String>, remedy: impl Into<String>) {
        self.mistakes.push(Mistake {
            line,
            reason: reason.into(),
            remedy: remedy.into(),
        });
    }

    fn line(&self, span: Range<usize>) -> usize {
        line_of(self.text, span.start)
    }

    fn top(&mut self, document: &DeTable<'_>) {
        for (key, value) in document {
            let line = self.line(key.span());
            match (key.get_ref().as_ref(), value.get_ref()) {
                ("name", value) => self.name = self.short_text("name", value, line),
                ("description", value) => self.description = self.short_text("description", value, line),
                (section, DeValue::Table(table)) if SECTIONS.contains(&section) => {
                    if section == "motor" {
                        self.section_line = line;
                    }
                    for (key, value) in table {
                        self.entry(section, key, value);
                    }
                }
                (section, _) if SECTIONS.contains(&section) => {
                    let remedy = format!("write [{section}] on a line of its own");
                    self.mistake(line, format!("`{section}` is a section"), remedy);
                }
                (unknown, _) => self.unknown_at_top(unknown, line),
            }
        }
    }

    fn short_text(&mut self, key: &str, value: &DeValue<'_>, line: usize) -> String {
        match value.as_str() {
            Some(text) if text.chars().count() <= TEXT_LIMIT && !text.chars().any(char::is_control) => return text.to_owned(),
            Some(_) => {
                let reason = format!("`{key}` is longer than {TEXT_LIMIT} characters, or of several lines");
                self.mistake(line, reason, "shorten it");
            }
            None => self.mistake(line, format!("`{key}` is no text"), format!("write {key} = \"...\"")),
        }
        String::new()
    }

    fn unknown_at_top(&mut self, key: &str, line: usize) {
        let home = SECTIONS.into_iter().find(|section| {
            let is_phases = *section == "motor" && key == "phases";
            is_phases || quantity::of_key(section, key).is_some()
        });
        let remedy = match home {
            Some(section) => format!("it belongs below a line [{section}]"),
            None => match nearest(key, SECTIONS.into_iter().chain(["name", "description"])) {
                Some(near) if SECTIONS.contains(&near) => format!("did you mean [{near}]?"),
                Some(near) => format!("did you mean `{near}`?"),
                None => "there are name, description, [motor], [load] and [supply]".to_owned(),
            },
        };
        self.mistake(line, format!("`{key}` is unknown here"), remedy);
    }

    fn entry(&mut self, section: &str, key: &Spanned<std::borrow::Cow<'_, str>>, value: &Spanned<DeValue<'_>>) {
        let line = self.line(key.span());
        let key = key.get_ref().as_ref();
        if section == "motor" && key == "phases" {
            return self.phases(value.get_ref(), line);
        }
        let Some((index, unit)) = quantity::of_key(section, key) else {
            return self.unknown_in(section, key, line);
        };
        self.present[index] = true;
        let Some(written) = to_number(value.get_ref()) else {
            let reason = format!("`{key}` is a {}, and a number is needed", value.get_ref().type_str());
            return self.mistake(
                line,
                reason,
                format!("write the number alone, for the unit is in the key: {key} = 1.5"),
            );
        };
        self.quantity(index, unit, written, line);
    }

    fn phases(&mut self, value: &DeValue<'_>, line: usize) {
        match to_number(value) {
            Some(2.0) => self.phases = Phases::Two,
            Some(3.0) => self.phases = Phases::Three,
            _ => self.mistake(
                line,
                "`phases` is neither 2 nor 3",
                "write phases = 2, or leave it out; motors of 5 phases are not simulated",
            ),
        }
    }

    fn unknown_in(&mut self, section: &str, key: &str, line: usize) {
        let of_section: Vec<String> = QUANTITIES
            .iter()
            .filter(|quantity| quantity.section == section)
            .flat_map(quantity::Quantity::keys)
            .collect();
        let of_stem = QUANTITIES
            .iter()
            .filter(|quantity| quantity.section == section)
            .find(|quantity| key == quantity.stem || key.strip_prefix(quantity.stem).is_some_and(|rest| rest.starts_with('_')));
        let elsewhere = SECTIONS
            .into_iter()
            .find(|other| *other != section && quantity::of_key(other, key).is_some());
        let phases = (section == "motor").then_some("phases");
        let remedy = if let Some(quantity) = of_stem {
            let keys: Vec<String> = quantity.keys().map(|key| format!("`{key}`")).collect();
            format!("a key carries its unit: {}", keys.join(", "))
        } else if let Some(near) = nearest(key, of_section.iter().map(String::as_str).chain(phases)) {
            format!("did you mean `{near}`?")
        } else if let Some(other) = elsewhere {
            format!("it belongs below a line [{other}]")
        } else {
            let keys: Vec<String> = QUANTITIES
                .iter()
                .filter(|quantity| quantity.section == section)
                .map(quantity::Quantity::usual_key)
                .chain(phases.map(str::to_owned))
                .collect();
            format!("known are {}", keys.join(", "))
        };
        self.mistake(line, format!("`{key}` is unknown in [{section}]"), remedy);
    }

    fn quantity(&mut self, index: usize, unit: &'static Unit, written: f64, line: usize) {
        let quantity = &QUANTITIES[index];
        let value = written * unit.factor;
        if !quantity.allows(value) {
            let reason = format!(
                "`{}` is {}, and {} are possible",
                quantity.key(unit),
                number(written),
                quantity.range_in(unit)
            );
            let remedy = match quantity.unit_that_fits(written) {
                Some(other) => format!("did you mean {} = {}?", quantity.key(other), number(written)),
                None => format!("see {}", quantity.source),
            };
            return self.mistake(line, reason, remedy);
        }
        if let Some(other) = self.told[index].replace(Told { value, line, unit }) {
            // The keys of a table come in alphabetical order, whatever their lines.
            let (first, second) = (line.min(other.line), line.max(other.line));
            let reason = format!(
                "the {} is given in line {first} already, in another unit",
                quantity.stem.replace('_', " ")
            );
            self.mistake(second, reason, "leave one of them out");
        }
    }

    /// A quantity that has to be there.
    fn required(&mut self, index: usize) -> Option<f64> {
        if !self.present[index] {
            let quantity = &QUANTITIES[index];
            let remedy = format!("add a line {} = ..., {}", quantity.usual_key(), quantity.source);
            self.mistake(
                self.section_line,
                format!("`{}` is missing in [motor]", quantity.usual_key()),
                remedy,
            );
        }
        self.told[index].map(|told| told.value)
    }

    /// Which of two quantities is there, one of which has to be.
    fn one_of(&mut self, first: usize, second: usize) -> Option<(usize, f64)> {
        let [a, b] = [first, second].map(|index| QUANTITIES[index].usual_key());
        match [first, second].map(|index| self.present[index]) {
            [false, false] => {
                let remedy = format!("add one: {}, or {}", QUANTITIES[first].source, QUANTITIES[second].source);
                self.mistake(self.section_line, format!("both `{a}` and `{b}` are missing in [motor]"), remedy);
            }
            [true, true] => {
                let lines = [first, second].map(|index| self.told[index].map_or(self.section_line, |told| told.line));
                let line = lines[0].max(lines[1]);
                self.mistake(line, format!("`{a}` and `{b}` tell the same"), "leave one of them out");
            }
            _ => {}
        }
        [first, second].into_iter().find_map(|index| Some((index, self.told[index]?.value)))
    }

    /// The motor, as far as everything needed is there.
    fn motor(&mut self) -> Option<Motor> {
        let resistance = self.required(RESISTANCE);
        let inductance = self.required(INDUCTANCE);
        let inertia = self.required(ROTOR_INERTIA);
        let current = self.one_of(RATED_CURRENT, PEAK_CURRENT);
        let torque = self.one_of(HOLDING_TORQUE, BACK_EMF);
        let rated_current = match current? {
            (RATED_CURRENT, value) => value * core::f64::consts::SQRT_2,
            (_, value) => value,
        };
        // Torque at one ampere of the current vector, by the volt second of one winding.
        let windings = if self.phases == Phases::Three { 1.5 } else { 1.0 };
        let back_emf = match torque? {
            (HOLDING_TORQUE, value) => value / rated_current / windings,
            (_, value) => value,
        };
        let holding_torque = windings * back_emf * rated_current;
        let [detent_torque, friction, drag] =
            ESTIMATES.map(|(index, _, share)| self.told[index].map_or(share * holding_torque, |told| told.value));
        let parameters = MotorParameters {
            phases: self.phases,
            resistance: resistance?,
            inductance: inductance?,
            rated_current,
            back_emf,
            detent_torque,
            inertia: inertia?,
            friction,
            drag,
        };
        self.check(&parameters);
        Some(Motor {
            name: std::mem::take(&mut self.name),
            description: std::mem::take(&mut self.description),
            parameters,
            load_inertia: self.told[LOAD_INERTIA].map(|told| told.value),
            supply: self.told[SUPPLY_VOLTAGE].map(|told| told.value),
            estimates: ESTIMATES
                .iter()
                .filter(|(index, _, _)| self.told[*index].is_none())
                .map(|(_, name, _)| *name)
                .collect(),
        })
    }

    /// What no value tells alone.
    fn check(&mut self, motor: &MotorParameters) {
        let holding_torque = motor.holding_torque(motor.rated_current);
        for index in [DETENT_TORQUE, FRICTION] {
            let Some(told) = self.told[index].filter(|told| told.value > holding_torque / 2.0) else {
                continue;
            };
            let reason = format!(
                "{} is more than half of the holding torque of {} Nm",
                QUANTITIES[index].key(told.unit),
                number(holding_torque)
            );
            self.mistake(told.line, reason, "a few percent are usual: check both numbers and their units");
        }
        let time_constant = figures::electrical_time_constant(motor);
        if time_constant < SHORTEST_TIME_CONSTANT {
            let reason = format!(
                "inductance by resistance is {} ms, and the simulation follows {} ms or more",
                number(time_constant * 1e3),
                number(SHORTEST_TIME_CONSTANT * 1e3)
            );
            self.mistake(
                self.line_told(INDUCTANCE),
                reason,
                "a few ms are usual: check both numbers and their units",
            );
        }
        let frequency = figures::natural_frequency(motor, motor.rated_current, 0.0);
        if frequency > HIGHEST_NATURAL_FREQUENCY {
            let reason = format!(
                "this rotor and this torque swing with {frequency:.0} Hz, and the simulation follows {HIGHEST_NATURAL_FREQUENCY} Hz at the most"
            );
            let remedy = "some 200 to 400 Hz are usual: check the rotor's inertia and the torque";
            self.mistake(self.line_told(ROTOR_INERTIA), reason, remedy);
        }
    }

    fn line_told(&self, index: usize) -> usize {
        self.told[index].map_or(self.section_line, |told| told.line)
    }
}

fn to_number(value: &DeValue<'_>) -> Option<f64> {
    match value {
        DeValue::Integer(integer) => i64::from_str_radix(integer.as_str(), integer.radix())
            .ok()
            .map(|whole| whole as f64),
        DeValue::Float(float) => float.as_str().parse().ok(),
        _ => None,
    }
}
