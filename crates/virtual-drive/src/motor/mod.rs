//! Motors: those with a name, those of a file, what follows from their values, and the torque they have at each speed.
//!
//! | module | holds |
//! |---|---|
//! | [`mod@file`] | a motor as a TOML file |
//! | [`text`] | the same file from a motor's values |
//! | `quantity` | the keys of such a file, with units and ranges |
//! | [`mistake`] | what is wrong with such a file |
//! | [`pull_out`] | the torque at each speed, by formula and by simulation |
//! | [`picture`] | the picture of it |
//! | [`commissioning`] | what the drive has to be told about its motor |
//! | [`figures`] | what follows from a motor's values |

pub mod commissioning;
pub mod figures;
pub mod file;
pub mod mistake;
pub mod picture;
pub mod pull_out;
mod quantity;
pub mod text;

pub(crate) use quantity::number;
pub use quantity::{LOAD_INERTIAS, SUPPLIES};

use std::path::Path;

use anyhow::bail;
use plant::motors::{ALL, NamedMotor};
use plant::{MotorParameters, PlantConfig};

/// A motor that somebody has chosen, by name or by file.
#[derive(Clone, Debug, PartialEq)]
pub struct Motor {
    /// What it is called.
    pub name: String,
    /// What it is.
    pub description: String,
    /// Its values.
    pub parameters: MotorParameters,
    /// Inertia that turns with the shaft, in kg m^2, if the file tells it.
    pub load_inertia: Option<f64>,
    /// Voltage of the supply in V, if the file tells it.
    pub supply: Option<f64>,
    /// Which of the values the file does not tell, and are estimated.
    pub estimates: Vec<&'static str>,
}

impl From<&NamedMotor> for Motor {
    fn from(named: &NamedMotor) -> Self {
        Self {
            name: named.name.to_owned(),
            description: named.description.to_owned(),
            parameters: named.parameters,
            load_inertia: None,
            supply: None,
            estimates: Vec::new(),
        }
    }
}

impl Motor {
    /// The motor of this name, in capitals or not, or of the file at this path.
    ///
    /// # Errors
    /// There is no such motor, or something is wrong with the file.
    pub fn find(name_or_file: &str) -> anyhow::Result<Self> {
        if let Some(named) = ALL.iter().find(|motor| motor.name.eq_ignore_ascii_case(name_or_file)) {
            return Ok(named.into());
        }
        let path = Path::new(name_or_file);
        if path.extension().is_some() || path.components().count() > 1 || path.exists() {
            return file::read(path);
        }
        let names = ALL.iter().map(|motor| motor.name);
        let remedy = match mistake::nearest(&name_or_file.to_lowercase(), names) {
            Some(name) => format!("did you mean `{name}`?"),
            None => "`usr2556e motor list` lists all of them; a motor of your own is named by its file, as in ./motor.toml".to_owned(),
        };
        bail!("there is no motor `{name_or_file}`; {remedy}");
    }

    /// Puts the motor, and what its file tells of load and supply, into a plant.
    pub fn install(&self, plant: &mut PlantConfig) {
        plant.motor = self.parameters;
        if let Some(inertia) = self.load_inertia {
            plant.load.inertia = inertia;
        }
        if let Some(volts) = self.supply {
            plant.supply = board::Millivolts((volts * 1000.0).round() as i32);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_named_motor_is_found_whatever_its_capitals() {
        for named in &ALL {
            let motor = Motor::find(&named.name.to_uppercase()).unwrap();
            assert_eq!((motor.name.as_str(), motor.parameters), (named.name, named.parameters));
        }
    }

    #[test]
    fn a_name_with_a_slip_is_answered_with_the_nearest_one() {
        let message = Motor::find("qsh5718-65").unwrap_err().to_string();
        assert_eq!(message, "there is no motor `qsh5718-65`; did you mean `qsh5718-56`?");
    }

    #[test]
    fn a_name_like_no_other_is_answered_with_where_to_look() {
        let message = Motor::find("warp-drive").unwrap_err().to_string();
        assert!(
            message.contains("`usr2556e motor list`") && message.contains("./motor.toml"),
            "{message}"
        );
    }

    #[test]
    fn what_the_file_leaves_out_stays_as_it_was() {
        let mut plant = PlantConfig::default();
        let before = plant;
        Motor::find("as1010").unwrap().install(&mut plant);
        assert_eq!((plant.supply, plant.load), (before.supply, before.load));
        assert_eq!(plant.motor, plant::motors::AS1010);
    }
}
