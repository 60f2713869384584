//! A USR2556E EtherCAT stepper drive as software: the drive's firmware with a slave controller, a motor and a wire around it.
//!
//! | module | holds |
//! |---|---|
//! | [`drive`] | [`drive::VirtualDrive`]: slave controller, device and plant on one time line |
//! | [`segment`] | drives plugged together; [`segment::InMemory`], a wire that ends in this process |
//! | [`cables`] | the cables of a line or ring, to be cut and repaired |
//! | [`breakdown`] | windings, motor and supply, to be broken and mended |
//! | [`control`] | orders to both from outside, through a Unix socket |
//! | [`motor_view`] | what only a simulation can see of the motor |
//! | [`synchronism`] | whether the shaft is where the drive believes it to be |
//! | [`indicators`] | the LEDs on a drive's front |
//! | [`clock`] | real time and lock-step |
//! | [`link`] | wires: the trait, raw Ethernet on an interface, captures |
//! | [`server`] | serving a segment to whatever master is on a link, or on two |
//! | [`namespace`] | a network of one's own without root |
//! | [`master`] | the built-in master |
//! | [`motor`] | motors by name and by file, and their torque at each speed |
//! | `curves` | curves with a legend, for all pictures |
//! | [`demo`] | the demonstration |
//! | [`esi`] | the device description for engineering tools |
//! | [`flash`] | the memory of a drive's parameters |
//! | [`kept_folder`] | EEPROMs and parameters that outlast the program |
//! | [`status`] | status lines |
//! | [`test_bench`] | a drive and a motor without a network, with a load of any torque |
//! | [`tuning`] | values of objects found by experiment |
//! | `parallel` | work on all cores |
//! | [`program`] | the command line |
//!
//! A test of one's own needs [`segment::VirtualSegment`] and [`segment::InMemory`], and no privileges:
//!
//! ```
//! use usr2556e::clock::Clock;
//! use usr2556e::master;
//! use usr2556e::segment::{InMemory, VirtualSegment};
//!
//! let mut wire = InMemory::new(VirtualSegment::of(2), Clock::lock_step());
//! let found = master::run(&mut wire, async |main, pace| master::bring_up::scan(main, pace).await.map(|group| group.len()));
//! assert_eq!(found.unwrap().unwrap(), 2);
//! ```

pub mod breakdown;
pub mod cables;
pub mod clock;
pub mod control;
mod curves;
pub mod demo;
pub mod drive;
pub mod esi;
pub mod flash;
pub mod indicators;
pub mod kept_folder;
pub mod link;
pub mod master;
pub mod motor;
pub mod motor_view;
pub mod namespace;
mod parallel;
pub mod program;
pub mod segment;
pub mod server;
pub mod status;
pub mod synchronism;
pub mod test_bench;
pub mod tuning;
