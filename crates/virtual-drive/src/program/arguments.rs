//! What can be typed.

pub mod motor;
pub mod tune;

use std::net::SocketAddr;
use std::path::PathBuf;

use clap::{Args, Parser, Subcommand};

use crate::breakdown::LARGEST_OFFSET;
use crate::control::CONTROL_VARIABLE;
use crate::master::sdo::Address;
use motor::{Equipment, MotorOptions};
use tune::TuneOptions;

/// The address of `--udp` alone: this computer, the port of EtherCAT.
const LOCAL_UDP: &str = "127.0.0.1:34980";

/// A virtual USR2556E EtherCAT stepper drive, for any EtherCAT master.
///
/// Without a command, shows the drive at work: one virtual drive and the built-in master in this process, no network and no privileges.
#[derive(Debug, Parser)]
#[command(name = "usr2556e", version, args_conflicts_with_subcommands = true)]
pub struct Arguments {
    /// What to do.
    #[command(subcommand)]
    pub command: Option<Command>,
    /// The demonstration's options.
    #[command(flatten)]
    pub demonstration: Demonstration,
}

/// The commands.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Serve drives to the master on a network interface, until Ctrl-C (needs the right to send raw frames)
    Run(Run),
    /// Serve drives to a command in a network of its own (needs no root)
    Exec(Exec),
    /// Cut, repair or list the cables of drives that are being served
    ///
    /// Cable N leads to drive N from the one before it, cable 1 from the interface; a ring has one more, from its last drive to the redundant
    /// interface. The exit status is 0 when the order was carried out, and 1 when not.
    Cable(Cable),
    /// List motors, show their values, and draw the torque they have at each speed
    Motor(MotorOptions),
    /// Find values for a drive by experiment on a virtual one
    Tune(TuneOptions),
    /// Break winding, motor or supply of a drive that is being served, list what is broken, or mend it
    ///
    /// The drive finds out by itself, as a real one does, or does not. The exit status is 0 when the order was carried out, and 1 when not.
    Fault(Fault),
    /// List the drives on an interface, with the built-in master
    Scan(Scan),
    /// Read or write one object of a drive on an interface, with the built-in master
    Sdo(Sdo),
    /// Move a drive on an interface to a position and disable it again, with the built-in master
    Move(Move),
    /// Write the device description (ESI XML) for engineering tools
    Esi(Esi),
    /// Write the EEPROM image (SII) of a new unit
    Sii(Sii),
}

/// Options of the demonstration.
#[derive(Debug, Args)]
pub struct Demonstration {
    /// Folder for the capture and the picture
    #[arg(long, value_name = "DIR", default_value = ".")]
    pub output: PathBuf,
    /// Let simulated time run as fast as it can: the same result on every machine
    #[arg(long)]
    pub lock_step: bool,
    /// What hangs on the drive.
    #[command(flatten)]
    pub equipment: Equipment,
}

/// What is served, for `run` and `exec`.
#[derive(Debug, Args)]
pub struct Served {
    /// Number of drives, each plugged into the one before it
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..=1000))]
    pub drives: u16,
    /// Folder that keeps the drives' EEPROMs and saved parameters, two files a drive; without it every start is a new unit's
    #[arg(long, value_name = "DIR")]
    pub keep: Option<PathBuf>,
    /// Write every frame to this .pcapng file
    #[arg(long, value_name = "FILE")]
    pub record: Option<PathBuf>,
    /// Let the drives' clocks drift by up to this many parts per million; each drive has a drift of its own between -PPM and +PPM, the same
    /// at every start. Crystals are within 100 [default: 0]
    #[arg(long, value_name = "PPM", value_parser = drift)]
    pub clock_drift: Option<f64>,
    /// Lose this share of the frames of each direction, to test what the master does then
    #[arg(long, value_name = "PERCENT", value_parser = percentage)]
    pub lose: Option<f64>,
    /// Lose the same frames as the run that named this number [default: others each time]
    #[arg(long, value_name = "N", requires = "lose")]
    pub seed: Option<u64>,
    /// What hangs on every drive.
    #[command(flatten)]
    pub equipment: Equipment,
}

fn drift(text: &str) -> Result<f64, String> {
    within(text, 1000.0)
}

fn percentage(text: &str) -> Result<f64, String> {
    within(text, 100.0)
}

fn within(text: &str, most: f64) -> Result<f64, String> {
    between(text, 0.0, most)
}

fn between(text: &str, least: f64, most: f64) -> Result<f64, String> {
    let number = text.parse::<f64>().ok().filter(|number| (least..=most).contains(number));
    number.ok_or_else(|| format!("a number from {least} to {most} is needed"))
}

/// Options of `run`.
#[derive(Debug, Args)]
pub struct Run {
    /// Network interface of the master's cable, or one end of a veth pair
    #[arg(long, value_name = "IFACE", required_unless_present = "udp")]
    pub interface: Option<String>,
    /// Serve EtherCAT over UDP at this address instead; needs no privileges [without ADDRESS: 127.0.0.1:34980]
    #[arg(long, value_name = "ADDRESS:PORT", num_args = 0..=1, default_missing_value = LOCAL_UDP, conflicts_with = "interface")]
    pub udp: Option<SocketAddr>,
    /// Network interface of the master's second cable, for a ring: it is plugged into the last drive
    #[arg(long, value_name = "IFACE", conflicts_with = "udp")]
    pub redundant: Option<String>,
    /// Take orders of `usr2556e cable` and `usr2556e fault` at this Unix socket, made for the time of serving
    #[arg(long, value_name = "PATH")]
    pub control: Option<PathBuf>,
    /// What is served.
    #[command(flatten)]
    pub served: Served,
}

/// Options of `exec`.
#[derive(Debug, Args)]
pub struct Exec {
    /// Make a ring of the drives: a second cable from the last one to the interface USR2556E_REDUNDANT_INTERFACE
    #[arg(long)]
    pub ring: bool,
    /// What is served.
    #[command(flatten)]
    pub served: Served,
    /// The command and its arguments; it finds the interface's name in USR2556E_INTERFACE, and `usr2556e cable` and `fault` their socket in
    /// USR2556E_CONTROL
    #[arg(last = true, required = true, value_name = "COMMAND")]
    pub command: Vec<std::ffi::OsString>,
}

/// Options of `cable`.
#[derive(Debug, Args)]
pub struct Cable {
    /// Socket of the drive server, as given to `run --control`; `exec` names it to its command
    #[arg(long, value_name = "PATH", env = CONTROL_VARIABLE)]
    pub control: PathBuf,
    /// What to do.
    #[command(subcommand)]
    pub action: CableAction,
}

/// What `cable` does.
#[derive(Clone, Copy, Debug, Subcommand)]
pub enum CableAction {
    /// List all cables with their state
    List,
    /// Cut a cable: the link is lost at both ends
    Cut {
        /// Number of the cable
        #[arg(value_name = "N")]
        cable: usize,
    },
    /// Make a cable whole that was cut
    Repair {
        /// Number of the cable
        #[arg(value_name = "N")]
        cable: usize,
    },
    /// Pull both plugs of a drive, which stays under supply; the drives behind it are cut off with it, or reached from the ring's other end
    Unplug {
        /// Number of the drive
        #[arg(value_name = "N")]
        drive: usize,
    },
    /// Put both plugs of a drive in again
    Plug {
        /// Number of the drive
        #[arg(value_name = "N")]
        drive: usize,
    },
}

/// Options of `fault`.
#[derive(Debug, Args)]
pub struct Fault {
    /// Socket of the drive server, as given to `run --control`; `exec` names it to its command
    #[arg(long, value_name = "PATH", env = CONTROL_VARIABLE)]
    pub control: PathBuf,
    /// Number of the drive, counted from 1
    #[arg(long, global = true, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..))]
    pub drive: u16,
    /// What to do.
    #[command(subcommand)]
    pub action: FaultAction,
}

/// What `fault` does.
#[derive(Clone, Copy, Debug, Subcommand)]
pub enum FaultAction {
    /// List what is broken at all drives
    List,
    /// Break the wire of winding A (of U with three phases)
    OpenA,
    /// Break the wire of winding B (of W with three phases)
    OpenB,
    /// Short most turns of winding A (of U with three phases)
    ShortedA,
    /// Short most turns of winding B (of W with three phases)
    ShortedB,
    /// Let the sensor of winding A's current (U's with three phases) read 1 A too much
    SensorA,
    /// Let the sensor of winding B's current (W's with three phases) read 1 A too much
    SensorB,
    /// Keep the rotor from turning
    StuckRotor,
    /// Let the supply be off by some volts: a sag below 0, a surge above
    Supply {
        /// By how much
        #[arg(value_name = "VOLTS", allow_negative_numbers = true, value_parser = offset)]
        volts: f64,
    },
    /// Mend everything at the drive
    Mend,
}

fn offset(text: &str) -> Result<f64, String> {
    let most = f64::from(LARGEST_OFFSET) / 1000.0;
    let number = text.parse::<f64>().ok().filter(|number| number.abs() <= most);
    number.ok_or_else(|| format!("a number of volts from -{most} to {most} is needed"))
}

/// Where the drives are, for `scan`, `sdo` and `move`.
#[derive(Debug, Args)]
pub struct Bus {
    /// Network interface of the drives' cable
    #[arg(long, value_name = "IFACE", env = "USR2556E_INTERFACE", required_unless_present = "udp")]
    pub interface: Option<String>,
    /// Reach the drives by EtherCAT over UDP at this address instead [without ADDRESS: 127.0.0.1:34980]
    #[arg(long, value_name = "ADDRESS:PORT", num_args = 0..=1, default_missing_value = LOCAL_UDP)]
    pub udp: Option<SocketAddr>,
}

/// Options of `scan`.
#[derive(Debug, Args)]
pub struct Scan {
    /// Where the drives are.
    #[command(flatten)]
    pub bus: Bus,
}

/// Options of `sdo`.
#[derive(Debug, Args)]
pub struct Sdo {
    /// Where the drives are.
    #[command(flatten)]
    pub bus: Bus,
    /// Position of the drive on the bus, counted from 1
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..))]
    pub drive: u16,
    /// What to do with the object.
    #[command(subcommand)]
    pub transfer: Transfer,
}

/// What `sdo` does.
#[derive(Debug, Subcommand)]
pub enum Transfer {
    /// Read an object
    Read {
        /// Index and sub-index in hexadecimal, as in 6041 or 1018:1
        address: Address,
    },
    /// Write an object of up to four bytes
    Write {
        /// Index and sub-index in hexadecimal, as in 2000 or 6099:1
        address: Address,
        /// The value, decimal or 0x
        #[arg(allow_negative_numbers = true)]
        value: String,
    },
}

/// Options of `move`.
#[derive(Debug, Args)]
pub struct Move {
    /// Where the drives are.
    #[command(flatten)]
    pub bus: Bus,
    /// Position of the drive on the bus, counted from 1
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..))]
    pub drive: u16,
    /// Where to, or how far.
    #[command(flatten)]
    pub target: Target,
    /// Profile velocity in pulses/s (0x6081)
    #[arg(long, value_name = "PULSES/S", default_value_t = 10_000, value_parser = clap::value_parser!(u32).range(1..=2_147_483_647))]
    pub velocity: u32,
    /// Profile acceleration in pulses/s^2 (0x6083)
    #[arg(long, value_name = "PULSES/S2", default_value_t = 100_000, value_parser = clap::value_parser!(u32).range(1..=2_147_483_647))]
    pub acceleration: u32,
    /// Profile deceleration in pulses/s^2 (0x6084)
    #[arg(long, value_name = "PULSES/S2", default_value_t = 100_000, value_parser = clap::value_parser!(u32).range(1..=2_147_483_647))]
    pub deceleration: u32,
}

/// Where to, or how far.
#[derive(Clone, Copy, Debug, Args)]
#[group(required = true, multiple = false)]
pub struct Target {
    /// Move to this position in pulses
    #[arg(long, value_name = "PULSES", allow_negative_numbers = true)]
    pub to: Option<i32>,
    /// Move by this distance in pulses
    #[arg(long, value_name = "PULSES", allow_negative_numbers = true)]
    pub by: Option<i32>,
}

/// Options of `esi`.
#[derive(Debug, Args)]
pub struct Esi {
    /// File to write instead of standard output
    #[arg(long, value_name = "FILE")]
    pub output: Option<PathBuf>,
}

/// Options of `sii`.
#[derive(Debug, Args)]
pub struct Sii {
    /// File to write instead of standard output
    #[arg(long, value_name = "FILE")]
    pub output: Option<PathBuf>,
    /// Serial number
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub serial: u32,
    /// Station alias
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub alias: u16,
}
