//! The keys of a motor's file: what each one means, in which units it can be given, and what is possible.
//!
//! Every key carries its unit, so that no number can be read in two ways.

/// A quantity and all of its keys.
#[derive(Debug)]
pub(super) struct Quantity {
    /// Where its keys stand.
    pub section: &'static str,
    /// What its keys begin with.
    pub stem: &'static str,
    /// Its units, the usual one first.
    pub units: &'static [Unit],
    /// What is possible, in SI units.
    pub range: (f64, f64),
    /// Where to find it.
    pub source: &'static str,
}

/// A unit of a quantity.
#[derive(Debug)]
pub(super) struct Unit {
    /// What the key ends with.
    pub suffix: &'static str,
    /// What is written behind a number.
    pub symbol: &'static str,
    /// How much of the SI unit it is.
    pub factor: f64,
}

const fn unit(suffix: &'static str, symbol: &'static str, factor: f64) -> Unit {
    Unit { suffix, symbol, factor }
}

/// Kilogram-force centimetre, as many data sheets have it, in Nm.
const KILOGRAM_CENTIMETRE: f64 = 0.098_066_5;

const CURRENTS: &[Unit] = &[unit("a", "A", 1.0), unit("ma", "mA", 1e-3)];
const TORQUES: &[Unit] = &[
    unit("nm", "Nm", 1.0),
    unit("ncm", "Ncm", 1e-2),
    unit("mnm", "mNm", 1e-3),
    unit("kgcm", "kg cm", KILOGRAM_CENTIMETRE),
];
const SMALL_TORQUES: &[Unit] = &[
    unit("mnm", "mNm", 1e-3),
    unit("ncm", "Ncm", 1e-2),
    unit("nm", "Nm", 1.0),
    unit("kgcm", "kg cm", KILOGRAM_CENTIMETRE),
];
const INERTIAS: &[Unit] = &[
    unit("gcm2", "g cm^2", 1e-7),
    unit("kgcm2", "kg cm^2", 1e-4),
    unit("kgm2", "kg m^2", 1.0),
];

/// The quantities, as indices of [`QUANTITIES`].
pub(super) const RESISTANCE: usize = 0;
pub(super) const INDUCTANCE: usize = 1;
pub(super) const RATED_CURRENT: usize = 2;
pub(super) const PEAK_CURRENT: usize = 3;
pub(super) const HOLDING_TORQUE: usize = 4;
pub(super) const BACK_EMF: usize = 5;
pub(super) const DETENT_TORQUE: usize = 6;
pub(super) const ROTOR_INERTIA: usize = 7;
pub(super) const FRICTION: usize = 8;
pub(super) const DRAG: usize = 9;
pub(super) const LOAD_INERTIA: usize = 10;
pub(super) const SUPPLY_VOLTAGE: usize = 11;

/// All of them.
pub(super) const QUANTITIES: [Quantity; 12] = [
    Quantity {
        section: "motor",
        stem: "resistance",
        units: &[unit("ohm", "ohm", 1.0), unit("mohm", "mohm", 1e-3)],
        range: (0.01, 100.0),
        source: "the resistance per phase of the data sheet",
    },
    Quantity {
        section: "motor",
        stem: "inductance",
        units: &[unit("mh", "mH", 1e-3), unit("uh", "uH", 1e-6), unit("h", "H", 1.0)],
        range: (20e-6, 0.2),
        source: "the inductance per phase of the data sheet",
    },
    Quantity {
        section: "motor",
        stem: "rated_current",
        units: CURRENTS,
        range: (0.05, 15.0),
        source: "the current per phase of the data sheet",
    },
    Quantity {
        section: "motor",
        stem: "peak_current",
        units: CURRENTS,
        range: (0.05, 20.0),
        source: "the peak of the sinusoidal phase current at which the motor has its holding torque",
    },
    Quantity {
        section: "motor",
        stem: "holding_torque",
        units: TORQUES,
        range: (2e-3, 60.0),
        source: "the holding torque of the data sheet, with all phases on",
    },
    Quantity {
        section: "motor",
        stem: "back_emf",
        units: &[
            unit("v_s_per_rad", "V s/rad", 1.0),
            unit("v_per_krpm", "V per 1000 rpm", 0.06 / core::f64::consts::TAU),
        ],
        range: (1e-3, 10.0),
        source: "the peak of a phase's open-circuit voltage by the speed, as measured",
    },
    Quantity {
        section: "motor",
        stem: "detent_torque",
        units: SMALL_TORQUES,
        range: (0.0, 5.0),
        source: "the detent torque of the data sheet",
    },
    Quantity {
        section: "motor",
        stem: "rotor_inertia",
        units: INERTIAS,
        range: (5e-8, 0.1),
        source: "the rotor inertia of the data sheet",
    },
    Quantity {
        section: "motor",
        stem: "friction",
        units: SMALL_TORQUES,
        range: (0.0, 5.0),
        source: "an estimate: one or two percent of the holding torque",
    },
    Quantity {
        section: "motor",
        stem: "drag",
        units: &[unit("mnms_per_rad", "mNm s/rad", 1e-3), unit("nms_per_rad", "Nm s/rad", 1.0)],
        range: (0.0, 0.2),
        source: "an estimate: a thousandth of the holding torque at 1 rad/s",
    },
    Quantity {
        section: "load",
        stem: "inertia",
        units: INERTIAS,
        range: LOAD_INERTIAS,
        source: "the inertia of all that turns with the shaft",
    },
    Quantity {
        section: "supply",
        stem: "voltage",
        units: &[unit("v", "V", 1.0), unit("mv", "mV", 1e-3)],
        range: SUPPLIES,
        source: "the voltage at the drive's terminals",
    },
];

/// Inertias of a load that can be simulated, in kg m^2.
pub const LOAD_INERTIAS: (f64, f64) = (0.0, 1.0);

/// Voltages of a supply that can be simulated, in V. The drive works from 18 to 50 V and reports a fault elsewhere, which can be tried too.
pub const SUPPLIES: (f64, f64) = (10.0, 80.0);

impl Quantity {
    /// The key that gives it in this unit.
    pub(super) fn key(&self, unit: &Unit) -> String {
        format!("{}_{}", self.stem, unit.suffix)
    }

    /// The key to recommend.
    pub(super) fn usual_key(&self) -> String {
        self.key(&self.units[0])
    }

    /// All keys.
    pub(super) fn keys(&self) -> impl Iterator<Item = String> {
        self.units.iter().map(|unit| self.key(unit))
    }

    /// Whether a value in SI units is possible; NaN is not.
    pub(super) fn allows(&self, value: f64) -> bool {
        self.range.0 <= value && value <= self.range.1
    }

    /// What is possible, in a unit.
    pub(super) fn range_in(&self, unit: &Unit) -> String {
        let [low, high] = [self.range.0, self.range.1].map(|limit| number(limit / unit.factor));
        format!("{low} to {high} {}", unit.symbol)
    }

    /// The unit in which a number that is not possible as written would be.
    pub(super) fn unit_that_fits(&self, written: f64) -> Option<&'static Unit> {
        self.units.iter().find(|unit| written != 0.0 && self.allows(written * unit.factor))
    }
}

/// The quantity and the unit of a key.
pub(super) fn of_key(section: &str, key: &str) -> Option<(usize, &'static Unit)> {
    let quantities = QUANTITIES.iter().enumerate().filter(|(_, quantity)| quantity.section == section);
    let mut found = quantities.filter_map(|(index, quantity)| {
        let suffix = key.strip_prefix(quantity.stem)?.strip_prefix('_')?;
        Some((index, quantity.units.iter().find(|unit| unit.suffix == suffix)?))
    });
    found.next()
}

/// A number as a person would write it: five digits, no zeros behind.
pub fn number(value: f64) -> String {
    let rounded: f64 = format!("{value:.4e}").parse().unwrap_or(value);
    format!("{rounded}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_key_leads_to_its_quantity_and_no_other() {
        for (index, quantity) in QUANTITIES.iter().enumerate() {
            for (unit, key) in quantity.units.iter().zip(quantity.keys()) {
                let (found, in_unit) = of_key(quantity.section, &key).unwrap();
                assert_eq!((found, in_unit.suffix), (index, unit.suffix), "{key}");
            }
        }
    }

    #[test]
    fn indices_are_those_of_their_quantities() {
        let stems = [
            (RESISTANCE, "resistance"),
            (INDUCTANCE, "inductance"),
            (RATED_CURRENT, "rated_current"),
            (PEAK_CURRENT, "peak_current"),
            (HOLDING_TORQUE, "holding_torque"),
            (BACK_EMF, "back_emf"),
            (DETENT_TORQUE, "detent_torque"),
            (ROTOR_INERTIA, "rotor_inertia"),
            (FRICTION, "friction"),
            (DRAG, "drag"),
            (LOAD_INERTIA, "inertia"),
            (SUPPLY_VOLTAGE, "voltage"),
        ];
        assert_eq!(stems.map(|(index, _)| QUANTITIES[index].stem), stems.map(|(_, stem)| stem));
    }

    #[test]
    fn numbers_are_short() {
        assert_eq!(
            [0.1 + 0.2, 2500.0, 1e-7 / 1e-7, 20e-6 / 1e-3].map(number),
            ["0.3", "2500", "1", "0.02"]
        );
    }
}
