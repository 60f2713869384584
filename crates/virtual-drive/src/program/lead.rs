//! `scan`, `sdo` and `move`: the built-in master on an interface.

use std::io::{self, Write};
use std::process::ExitCode;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use anyhow::{Context, bail, ensure};
use drive::faults::Fault;
use ethercrab::MainDevice;
use ethercrab::subdevice_group::PreOp;
use indicatif::{ProgressBar, ProgressStyle};

use super::arguments::{Bus, Move, Scan, Sdo, Target, Transfer};
use crate::link::Link;
use crate::link::raw::{RawLink, Role};
use crate::link::udp::UdpLink;
use crate::master::axis::{Axis, Exchange, HANDSHAKE_LIMIT, Operating};
use crate::master::bring_up::{self, Group};
use crate::master::process_data::{Inputs, controlword, mode, statusword};
use crate::master::sdo::{Address, abort_code, parse};
use crate::master::{self, Pace, RealTimeLink, describe};

/// Exit status of a command ended with Ctrl-C, as shells have it.
const INTERRUPTED: u8 = 130;

/// A drive on a limit switch that has not moved for this long has been stopped by it.
const STANDSTILL: Duration = Duration::from_millis(200);

/// How often process data are exchanged: easily kept without real-time privileges, and well within the drive's watchdog of 100 ms.
const CYCLE: Duration = Duration::from_millis(2);

pub(super) fn on_bus<T>(bus: &Bus, conversation: impl AsyncFnOnce(&MainDevice<'_>, &Pace) -> anyhow::Result<T>) -> anyhow::Result<T> {
    let link: Box<dyn Link> = match (bus.udp, &bus.interface) {
        (Some(drives), _) => Box::new(UdpLink::connect(drives)?),
        (None, Some(interface)) => Box::new(RawLink::open(interface, Role::Master)?),
        (None, None) => bail!("name the drives' interface with --interface IFACE, or their address with --udp ADDRESS:PORT"),
    };
    master::run(&mut RealTimeLink::new(link), conversation)?
}

/// The bus as messages name it.
pub(super) fn name(bus: &Bus) -> String {
    match (bus.udp, &bus.interface) {
        (Some(drives), _) => format!("UDP {drives}"),
        (None, interface) => interface.clone().unwrap_or_default(),
    }
}

/// Scans, and makes sure that there is somebody.
pub(super) async fn found(main: &MainDevice<'_>, pace: &Pace, interface: &str) -> anyhow::Result<Group<PreOp>> {
    let group = bring_up::scan(main, pace).await.with_context(|| {
        format!("scanning the bus on {interface}; if no drive is there, check its cable and supply, or start one with: usr2556e run --interface ...")
    })?;
    ensure!(
        !group.is_empty(),
        "no drive answers on {interface}; check cable and supply, or start one with: usr2556e run --interface ..."
    );
    Ok(group)
}

pub(super) fn position(group: &Group<PreOp>, drive: u16) -> anyhow::Result<usize> {
    ensure!(
        usize::from(drive) <= group.len(),
        "there is no drive {drive}: the bus has {}, counted from 1",
        group.len()
    );
    Ok(usize::from(drive) - 1)
}

pub(super) fn scan(options: &Scan) -> anyhow::Result<()> {
    on_bus(&options.bus, async |main, pace| {
        let group = found(main, pace, &name(&options.bus)).await?;
        let mut out = io::stdout().lock();
        for (position, drive) in group.iter(main).enumerate() {
            writeln!(out, "{:>3}  {}", position + 1, describe::identity(&drive))?;
            writeln!(
                out,
                "     station address 0x{:04X}, alias {}, propagation delay {} ns",
                drive.configured_address(),
                drive.alias_address(),
                drive.propagation_delay()
            )?;
            match describe::mapping(&drive).await {
                Ok(lines) => lines.iter().try_for_each(|line| writeln!(out, "     {line}"))?,
                Err(error) => writeln!(out, "     its PDO mapping cannot be read: {error}")?,
            }
        }
        Ok(())
    })
}

pub(super) fn sdo(options: &Sdo) -> anyhow::Result<()> {
    // What was typed is checked before the bus is touched.
    let (address, value) = match &options.transfer {
        Transfer::Read { address } => (*address, None),
        Transfer::Write { address, value } => (*address, Some(value_bytes(*address, value)?)),
    };
    on_bus(&options.bus, async |main, pace| {
        let group = found(main, pace, &name(&options.bus)).await?;
        let drive = group.subdevice(main, position(&group, options.drive)?)?;
        if let Some(bytes) = value {
            master::sdo::write(&drive, address, &bytes)
                .await
                .map_err(|error| refused("writing", address, error))?;
        }
        let line = describe::value(&drive, address)
            .await
            .map_err(|error| refused("reading", address, error))?;
        Ok(writeln!(io::stdout(), "{line}")?)
    })
}

pub(super) fn value_bytes(address: Address, text: &str) -> anyhow::Result<Vec<u8>> {
    let Some(data_type) = address.data_type() else {
        bail!("the type of {address} is not known, so its length is not either; only objects of this drive's dictionary can be written");
    };
    let bytes = parse(text, data_type).map_err(anyhow::Error::msg)?;
    ensure!(
        bytes.len() <= 4,
        "{address} has more than four bytes; the built-in master writes no longer objects"
    );
    Ok(bytes)
}

/// An SDO error with the abort code's meaning where the drive has sent one.
pub(super) fn refused(doing: &str, address: Address, error: ethercrab::error::Error) -> anyhow::Error {
    match abort_code(&error) {
        Some(code) => anyhow::anyhow!("{doing} {address}: the drive answers {code}"),
        None => anyhow::Error::new(error).context(format!("{doing} {address}")),
    }
}

pub(super) fn move_axis(options: &Move) -> anyhow::Result<ExitCode> {
    let interrupted = super::on_signal()?;
    on_bus(&options.bus, async |main, pace| {
        let group = found(main, pace, &name(&options.bus)).await?;
        let drive = position(&group, options.drive)?;
        set_up(main, &group, drive, options).await?;
        let group = bring_up::to_op(main, pace, group, CYCLE)
            .await
            .context("bringing the drives to OP")?;
        let mut unobserved = |_: &Exchange| ();
        let mut axis = Axis::new(main, pace, Operating::Frames(group, CYCLE), drive, &mut unobserved);
        let mut arrived = travel(&mut axis, options.target, &interrupted).await;
        if let Err(error) = arrived {
            arrived = Err(why(error, &axis).await);
        }
        // Whatever has happened, the drive is left disabled and the bus in PREOP.
        let left = axis.leave().await;
        let arrived = arrived?;
        left?;
        Ok(if arrived { ExitCode::SUCCESS } else { ExitCode::from(INTERRUPTED) })
    })
}

/// The mapping `move` works with, whatever the drive's own default is, and the profile.
async fn set_up(main: &MainDevice<'_>, group: &Group<PreOp>, drive: usize, options: &Move) -> anyhow::Result<()> {
    let drive = group.subdevice(main, drive)?;
    for (assignment, pdos) in [(0x1C12, &device::layout::RX_PDOS), (0x1C13, &device::layout::TX_PDOS)] {
        let pdo = pdos[0];
        drive
            .sdo_write_array::<u16>(assignment, [])
            .await
            .context("clearing the PDO assignment")?;
        drive
            .sdo_write_array::<u32>(pdo.index, pdo.entries)
            .await
            .context("writing the PDO mapping")?;
        drive
            .sdo_write_array::<u16>(assignment, [pdo.index])
            .await
            .context("writing the PDO assignment")?;
    }
    for (index, value) in [
        (0x6081, options.velocity),
        (0x6083, options.acceleration),
        (0x6084, options.deceleration),
    ] {
        let address = Address { index, sub: 0 };
        drive
            .sdo_write(index, 0, value)
            .await
            .map_err(|error| refused("writing", address, error))?;
    }
    Ok(())
}

/// An error of an axis, with what the drive says of it if that is a fault.
async fn why(error: anyhow::Error, axis: &Axis<'_>) -> anyhow::Error {
    let is_fault = axis.inputs.statusword & statusword::FAULT != 0;
    match axis.error_code().await {
        Ok(code) if is_fault => {
            let name = Fault::of_code(code).map_or("unknown", Fault::name);
            anyhow::anyhow!("the drive went into fault 0x{code:04X}: {name}")
        }
        _ => error,
    }
}

/// Moves to the target. Returns whether the drive got there; Ctrl-C halts it.
async fn travel(axis: &mut Axis<'_>, target: Target, interrupted: &AtomicBool) -> anyhow::Result<bool> {
    axis.outputs.mode = mode::PROFILE_POSITION;
    axis.enable().await?;
    axis.until("change to profile position mode", HANDSHAKE_LIMIT, |inputs| {
        inputs.mode == mode::PROFILE_POSITION
    })
    .await?;
    let start = axis.inputs.position;
    let (set_point, bits, goal) = match target {
        Target { to: Some(to), .. } => (to, 0, to),
        Target { by, .. } => (by.unwrap_or(0), controlword::RELATIVE, start.wrapping_add(by.unwrap_or(0))),
    };
    axis.set_point(set_point, bits).await?;
    let bar = progress_bar(start, goal);
    let mut standing = Standing::default();
    while axis.inputs.statusword & statusword::TARGET_REACHED == 0 {
        if interrupted.load(Ordering::Relaxed) {
            bar.finish_and_clear();
            return halt(axis).await.map(|()| false);
        }
        let Inputs {
            statusword: status,
            position,
            ..
        } = axis.inputs;
        ensure!(
            statusword::is_enabled(status),
            "the drive was disabled on its way (statusword 0x{status:04X})"
        );
        let limited = status & statusword::INTERNAL_LIMIT != 0 && standing.since(position) >= STANDSTILL;
        ensure!(
            !limited,
            "a limit switch has stopped the drive at {position} pulses; it can be moved away from there only"
        );
        bar.set_position(u64::from(start.abs_diff(position)));
        axis.cycle().await?;
    }
    bar.finish_and_clear();
    let end = axis.inputs.position;
    ensure!(end == goal, "the drive stopped at {end} pulses");
    writeln!(io::stdout(), "Moved from {start} to {goal} pulses.")?;
    Ok(true)
}

async fn halt(axis: &mut Axis<'_>) -> anyhow::Result<()> {
    axis.outputs.controlword |= controlword::HALT;
    axis.until("halt", HANDSHAKE_LIMIT, |inputs| {
        inputs.statusword & statusword::TARGET_REACHED != 0
    })
    .await?;
    Ok(writeln!(io::stdout(), "Halted at {} pulses.", axis.inputs.position)?)
}

/// For how many cycles the drive has been standing.
#[derive(Default)]
struct Standing {
    position: i32,
    cycles: u32,
}

impl Standing {
    fn since(&mut self, position: i32) -> Duration {
        self.cycles = if position == self.position { self.cycles + 1 } else { 0 };
        self.position = position;
        CYCLE * self.cycles
    }
}

fn progress_bar(start: i32, goal: i32) -> ProgressBar {
    let bar = ProgressBar::new(u64::from(start.abs_diff(goal)));
    let style = ProgressStyle::with_template("[{bar:40}] {pos} of {len} pulses").unwrap_or_else(|_| ProgressStyle::default_bar());
    bar.set_style(style.progress_chars("=> "));
    bar
}
