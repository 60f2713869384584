//! What the master does in a demonstration.

use std::cell::{Cell, RefCell};
use std::time::Duration;

use anyhow::{Context, ensure};
use ethercrab::MainDevice;
use ethercrab::subdevice_group::PreOp;
use wire::Nanos;

use super::samples::{Phase, Sample, Samples};
use crate::master::axis::{Axis, AxisError, Exchange, HANDSHAKE_LIMIT, Operating};
use crate::master::bring_up::{self, Group};
use crate::master::process_data::{controlword, mode, statusword};
use crate::master::{Pace, describe, sdo};
use crate::motor::commissioning::Commissioning;
use crate::motor_view::MotorView;

/// Period of process data and SYNC0.
pub const CYCLE: Duration = Duration::from_millis(1);
/// Pulses of one turn at delivery (0x2001).
pub const PULSES_PER_TURN: f64 = 10_000.0;
/// Where the profile position move goes, in pulses from home.
pub const MOVE_TARGET: i32 = 30_000;
/// Half the travel of the sine, in pulses.
const SINE_AMPLITUDE: f64 = 8_000.0;
/// Period of the sine in cycles.
const SINE_PERIOD: u32 = 2_000;
/// Periods of the sine.
const SINE_COUNT: u32 = 2;
/// How long homing or a move may take.
const MOTION_LIMIT: Duration = Duration::from_secs(30);
/// Cycles in which the shaft settles before its place is compared with the counter.
const SETTLING: u32 = 20;

/// Process data watchdog (0x0420) in units of 100 us: 1 s, since other programs may keep a PC's master waiting for longer than the usual 100 ms.
const WATCHDOG: u16 = 10_000;

/// Objects set in PREOP: homing on the home switch (method 19), its speeds, and speed and acceleration of the move. For the same reason as the
/// watchdog, cycles without outputs are no error (0x10F1:02).
const SETTINGS: [(&str, &[u8]); 6] = [
    ("10F1:2", &0_u16.to_le_bytes()),
    ("6098", &[19]),
    ("6099:1", &20_000_u32.to_le_bytes()),
    ("6099:2", &4_000_u32.to_le_bytes()),
    ("6081", &50_000_u32.to_le_bytes()),
    ("6083", &200_000_u32.to_le_bytes()),
];

/// Who is told how far the demonstration is.
pub trait Progress {
    /// Something new begins, expected to take `expected`.
    fn begin(&mut self, what: &str, expected: Duration);

    /// The present part has been going on for `elapsed`.
    fn advance(&mut self, elapsed: Duration);

    /// Something worth a line.
    fn note(&mut self, line: &str);
}

/// What the parts of a demonstration share: who is told, and what was seen.
struct Stage<'a> {
    progress: RefCell<&'a mut dyn Progress>,
    phase: Cell<Phase>,
    began: Cell<Nanos>,
    samples: RefCell<Samples>,
    motor: &'a dyn Fn() -> MotorView,
}

impl Stage<'_> {
    fn begin(&self, phase: Phase, now: Nanos, what: &str, expected: Duration) {
        self.phase.set(phase);
        self.began.set(now);
        self.progress.borrow_mut().begin(what, expected);
    }

    fn shaft_in_pulses(&self) -> f64 {
        (self.motor)().shaft.0 * PULSES_PER_TURN
    }

    fn see(&self, exchange: &Exchange) {
        let target = (exchange.outputs.mode != mode::HOMING).then_some(exchange.outputs.target_position);
        self.samples.borrow_mut().cycles.push(Sample {
            time: exchange.time,
            due: exchange.due,
            phase: self.phase.get(),
            target,
            commanded: exchange.inputs.position,
            motor: (self.motor)(),
        });
        self.progress
            .borrow_mut()
            .advance(Duration::from_nanos(exchange.time.since(self.began.get())));
    }
}

/// Leads the drive from power-on through homing, a move and a sine, and back to PREOP.
///
/// `motor` tells how the motor really is, `commissioning` what the drive is told about its motor first.
///
/// # Errors
/// The drive does not do what it should.
pub async fn hold(
    main: &MainDevice<'_>,
    pace: &Pace,
    motor: &dyn Fn() -> MotorView,
    commissioning: Option<Commissioning>,
    progress: &mut dyn Progress,
) -> anyhow::Result<Samples> {
    progress.begin("scanning the bus", Duration::from_millis(100));
    let group = bring_up::scan(main, pace).await.context("scanning the bus")?;
    ensure!(!group.is_empty(), "no drive answers on the bus");
    for line in describe_first(main, &group).await? {
        progress.note(&line);
    }
    set_up(main, &group, commissioning).await?;
    progress.begin("PREOP to OP with distributed clocks", Duration::from_millis(200));
    let group = bring_up::to_op_with_clocks(main, pace, group, CYCLE)
        .await
        .context("bringing the drive to OP")?;
    let stage = Stage {
        progress: RefCell::new(progress),
        phase: Cell::new(Phase::Enabling),
        began: Cell::new(pace.now()),
        samples: RefCell::default(),
        motor,
    };
    let mut see = |exchange: &Exchange| stage.see(exchange);
    let mut axis = Axis::new(main, pace, Operating::Clocks(group), 0, &mut see);
    stage.begin(Phase::Enabling, pace.now(), "enabling the drive", Duration::from_millis(120));
    axis.outputs.mode = mode::HOMING;
    axis.enable().await.context("enabling")?;
    home(&mut axis, &stage, pace).await.context("homing")?;
    profile_position(&mut axis, &stage, pace)
        .await
        .context("moving in profile position mode")?;
    cyclic_position(&mut axis, &stage, pace)
        .await
        .context("following a sine in cyclic position mode")?;
    stage.begin(Phase::Disabling, pace.now(), "disabling the drive", CYCLE * 20);
    axis.leave().await.context("disabling")?;
    Ok(stage.samples.into_inner())
}

async fn describe_first(main: &MainDevice<'_>, group: &Group<PreOp>) -> anyhow::Result<Vec<String>> {
    let drive = group.subdevice(main, 0)?;
    let mut lines = vec![describe::identity(&drive)];
    lines.extend(describe::mapping(&drive).await.context("reading the PDO mapping")?);
    Ok(lines)
}

async fn set_up(main: &MainDevice<'_>, group: &Group<PreOp>, commissioning: Option<Commissioning>) -> anyhow::Result<()> {
    let drive = group.subdevice(main, 0)?;
    drive
        .register_write(wire::register::PROCESS_WATCHDOG_TIME, WATCHDOG)
        .await
        .context("setting the process data watchdog")?;
    let downloads = commissioning.map_or(Vec::new(), |told| told.downloads().to_vec());
    let of_the_motor = downloads.iter().map(|(address, value)| (*address, &value[..]));
    for (address, value) in SETTINGS.into_iter().chain(of_the_motor) {
        let address = address.parse().map_err(anyhow::Error::msg)?;
        sdo::write(&drive, address, value)
            .await
            .with_context(|| format!("writing {address}"))?;
    }
    Ok(())
}

async fn home(axis: &mut Axis<'_>, stage: &Stage<'_>, pace: &Pace) -> anyhow::Result<()> {
    stage.begin(
        Phase::Homing,
        pace.now(),
        "homing on the home switch (method 19)",
        Duration::from_millis(1500),
    );
    ensure!(axis.home(MOTION_LIMIT).await?, "the home switch was not found");
    for _ in 0..SETTLING {
        axis.cycle().await?;
    }
    stage.samples.borrow_mut().home = stage.shaft_in_pulses() - f64::from(axis.inputs.position);
    Ok(())
}

async fn profile_position(axis: &mut Axis<'_>, stage: &Stage<'_>, pace: &Pace) -> Result<(), AxisError> {
    let what = format!("profile position move to {MOVE_TARGET} pulses");
    stage.begin(Phase::ProfilePosition, pace.now(), &what, Duration::from_millis(1000));
    axis.outputs.controlword = controlword::ENABLE_OPERATION;
    axis.outputs.mode = mode::PROFILE_POSITION;
    axis.outputs.target_position = MOVE_TARGET;
    axis.until("change to profile position mode", HANDSHAKE_LIMIT, |inputs| {
        inputs.mode == mode::PROFILE_POSITION
    })
    .await?;
    axis.set_point(MOVE_TARGET, 0).await?;
    axis.until("reach the target", MOTION_LIMIT, |inputs| {
        inputs.statusword & statusword::TARGET_REACHED != 0
    })
    .await
}

async fn cyclic_position(axis: &mut Axis<'_>, stage: &Stage<'_>, pace: &Pace) -> Result<(), AxisError> {
    let cycles = SINE_PERIOD * SINE_COUNT;
    stage.begin(
        Phase::CyclicPosition,
        pace.now(),
        "cyclic position: following a sine",
        CYCLE * cycles,
    );
    let start = axis.inputs.position;
    axis.outputs.mode = mode::CYCLIC_POSITION;
    axis.outputs.target_position = start;
    axis.until("change to cyclic position mode", HANDSHAKE_LIMIT, |inputs| {
        inputs.mode == mode::CYCLIC_POSITION
    })
    .await?;
    for cycle in 0..=cycles {
        let angle = f64::from(cycle) / f64::from(SINE_PERIOD) * std::f64::consts::TAU;
        // A raised cosine starts and ends at rest.
        axis.outputs.target_position = start - (SINE_AMPLITUDE * (1.0 - angle.cos())).round() as i32;
        axis.cycle().await?;
    }
    axis.until("return to where the sine began", HANDSHAKE_LIMIT, |inputs| inputs.position == start)
        .await?;
    for _ in 0..SETTLING {
        axis.cycle().await?;
    }
    Ok(())
}
