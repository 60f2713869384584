//! Options of `tune`.

use std::net::SocketAddr;
use std::path::PathBuf;

use clap::{ArgGroup, Args, Subcommand};

use super::motor::{BenchOptions, find_motor};
use super::{Bus, LOCAL_UDP, between};
use crate::motor::Motor;

/// The largest load torque that can be given, in Nm: more than any motor of this drive holds.
const MOST_TORQUE: f64 = 60.0;

/// Options of `tune`.
#[derive(Debug, Args)]
pub struct TuneOptions {
    /// What to find.
    #[command(subcommand)]
    pub action: TuneAction,
}

/// What `tune` finds.
#[derive(Debug, Subcommand)]
pub enum TuneAction {
    /// Find the first resonance of a motor with its load, and the values of 0x2060 to 0x2062 that quiet it
    ///
    /// Some 150 experiments on a virtual drive: the motor is brought to a speed, and the ripple of its speed measured. Leaves a picture of
    /// before and after, usr2556e-vibration.svg, and the values as a file, usr2556e-vibration.txt, which the drive takes as parameters.txt
    /// by FoE. With --interface or --udp they are written to a drive too.
    ///
    /// The manual calls the three objects amplitude and phases of a harmonic, and does not say of which. That it is the third harmonic of
    /// the current is this project's interpretation: the values are for this drive, and may do nothing or harm at another.
    ///
    /// The exit status is 1, and nothing is written, if there are no values that halve the ripple.
    Vibration(TuneVibration),
}

/// Options of `tune vibration`.
#[derive(Debug, Args)]
#[command(group(ArgGroup::new("bus").args(["interface", "udp"])))]
pub struct TuneVibration {
    /// One of `usr2556e motor list`, or a TOML file as examples/motor.toml
    #[arg(long, value_name = "NAME|FILE", value_parser = find_motor)]
    pub motor: Motor,
    /// What is on the test bench with it.
    #[command(flatten)]
    pub bench: BenchOptions,
    /// Torque of the load against the motion, 0 to 60 [default: a tenth of the motor's at this current]
    #[arg(long, value_name = "NM", value_parser = load_torque)]
    pub load_torque: Option<f64>,
    /// Folder for the picture and the parameter file
    #[arg(long, value_name = "DIR", default_value = ".")]
    pub output: PathBuf,
    /// Write the values to a drive on this network interface too, by SDO
    #[arg(long, value_name = "IFACE")]
    pub interface: Option<String>,
    /// Write them by EtherCAT over UDP to this address instead [without ADDRESS: 127.0.0.1:34980]
    #[arg(long, value_name = "ADDRESS:PORT", num_args = 0..=1, default_missing_value = LOCAL_UDP)]
    pub udp: Option<SocketAddr>,
    /// Position of that drive on the bus, counted from 1 [default: 1]
    #[arg(long, value_name = "N", requires = "bus", value_parser = clap::value_parser!(u16).range(1..))]
    pub drive: Option<u16>,
    /// Let that drive save its parameters (0x1010), all of them, so that the values outlast its power-off
    #[arg(long, requires = "bus")]
    pub save: bool,
}

impl TuneVibration {
    /// The bus of the drive to write to, if there is one.
    pub fn bus(&self) -> Option<Bus> {
        let is_given = self.interface.is_some() || self.udp.is_some();
        is_given.then(|| Bus {
            interface: self.interface.clone(),
            udp: self.udp,
        })
    }
}

fn load_torque(text: &str) -> Result<f64, String> {
    between(text, 0.0, MOST_TORQUE)
}
