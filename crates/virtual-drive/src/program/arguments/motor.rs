//! Options of `motor`, and of the motor that a drive has.

use std::path::PathBuf;

use board::Millivolts;
use clap::{Args, Subcommand};
use plant::PlantConfig;

use super::between;
use crate::motor::{self, Motor};

/// What hangs on every drive's terminals.
#[derive(Debug, Args)]
pub struct Equipment {
    /// Motor: one of `usr2556e motor list`, or a TOML file as examples/motor.toml. A drive that is served has to be told about it as a real one:
    /// current 0x2000, number of phases 0x200C:01; the demonstration does so [default: qsh5718-56]
    #[arg(long, value_name = "NAME|FILE", value_parser = find_motor)]
    pub motor: Option<Motor>,
    /// Supply voltage, 10 to 80; the drive works from 18 to 50 [default: the motor file's, or 36]
    #[arg(long, value_name = "V", value_parser = supply)]
    pub supply: Option<f64>,
    /// Inertia that turns with the shaft, 0 to 10000000 [default: the motor file's, or 300]
    #[arg(long, value_name = "G_CM2", value_parser = load_inertia)]
    pub load_inertia: Option<f64>,
}

impl Equipment {
    /// The plant of a drive.
    pub fn plant(&self) -> PlantConfig {
        let mut plant = PlantConfig::default();
        if let Some(motor) = &self.motor {
            motor.install(&mut plant);
        }
        if let Some(volts) = self.supply {
            plant.supply = Millivolts((volts * 1e3).round() as i32);
        }
        if let Some(inertia) = self.load_inertia {
            plant.load.inertia = inertia;
        }
        plant
    }
}

pub(super) fn find_motor(text: &str) -> Result<Motor, String> {
    Motor::find(text).map_err(|error| format!("{error:#}"))
}

fn supply(text: &str) -> Result<f64, String> {
    let (low, high) = motor::SUPPLIES;
    between(text, low, high)
}

/// An inertia in g cm^2, as one in kg m^2.
pub(super) fn load_inertia(text: &str) -> Result<f64, String> {
    let (low, high) = motor::LOAD_INERTIAS;
    between(text, low * GRAM_SQUARE_CENTIMETRES, high * GRAM_SQUARE_CENTIMETRES).map(|inertia| inertia / GRAM_SQUARE_CENTIMETRES)
}

/// In one kg m^2.
const GRAM_SQUARE_CENTIMETRES: f64 = 1e7;

/// Options of `motor`.
#[derive(Debug, Args)]
pub struct MotorOptions {
    /// What to do.
    #[command(subcommand)]
    pub action: MotorAction,
}

/// What `motor` does.
#[derive(Debug, Subcommand)]
pub enum MotorAction {
    /// List the motors with a name
    List,
    /// Show a motor's values and what follows from them
    Show(MotorShow),
    /// Find the torque that a motor carries at each speed, and draw it
    ///
    /// Simulates the drive's own control law on the motor: brings it to each speed, loads it more and more until it falls out of step, and puts
    /// the formula's torque beside it. A bridge loses voltage by dead time and resistance, which the formula does not know.
    PullOut(MotorPullOut),
}

/// Options of `motor show`.
#[derive(Debug, Args)]
pub struct MotorShow {
    /// One of `usr2556e motor list`, or a TOML file as examples/motor.toml
    #[arg(value_name = "NAME|FILE", value_parser = find_motor)]
    pub motor: Motor,
    /// Write the values as such a file instead, to begin one of your own with
    #[arg(long)]
    pub toml: bool,
}

/// What is on a test bench with a motor.
#[derive(Debug, Args)]
pub struct BenchOptions {
    /// Supply voltage, 18 to 50 [default: the motor file's, or 36]
    #[arg(long, value_name = "V", value_parser = working_supply)]
    pub supply: Option<f64>,
    /// Peak of the phase current, 0.1 to 6 (0x2000) [default: the motor's rated one, 6 at the most]
    #[arg(long, value_name = "A", value_parser = peak_current)]
    pub current: Option<f64>,
    /// Inertia that turns with the shaft, 0 to 10000000 [default: the motor file's, or 0]
    #[arg(long, value_name = "G_CM2", value_parser = load_inertia)]
    pub load_inertia: Option<f64>,
}

/// Options of `motor pull-out`.
#[derive(Debug, Args)]
pub struct MotorPullOut {
    /// One of `usr2556e motor list`, or a TOML file as examples/motor.toml
    #[arg(value_name = "NAME|FILE", value_parser = find_motor)]
    pub motor: Motor,
    /// What is on the test bench with it.
    #[command(flatten)]
    pub bench: BenchOptions,
    /// Number of speeds
    #[arg(long, value_name = "N", default_value_t = 24, value_parser = clap::value_parser!(u16).range(2..=500))]
    pub points: u16,
    /// Picture to write
    #[arg(long, value_name = "FILE.svg", default_value = "usr2556e-pull-out.svg")]
    pub output: PathBuf,
}

fn working_supply(text: &str) -> Result<f64, String> {
    between(text, 18.0, 50.0)
}

fn peak_current(text: &str) -> Result<f64, String> {
    between(text, 0.1, 6.0)
}
