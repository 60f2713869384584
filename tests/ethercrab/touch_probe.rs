//! Touch probe and latch units over the bus, with a flag on the axis that both see.

use ethercrab::MainDevice;
use ethercrab::subdevice_group::{Op, PreOp};
use plant::{MotorParameters, Turns};
use rig::{CYCLE, Rig};
use usr2556e::drive::DriveConfig;
use usr2556e::master::axis::Axis;
use usr2556e::master::bring_up::{self, Group};
use usr2556e::master::process_data::{mode, statusword};
use usr2556e::master::{Pace, process_data};

/// Edges of the flag in pulses.
const LEFT: f64 = 5_123.4;
const RIGHT: f64 = 7_500.8;

/// Drag of the motor in Nm s/rad. It has neither friction nor detent, so that its lag is one of time.
const DRAG: f64 = 6e-3;
/// How far the shaft is behind the commanded position, in seconds: drag over 50 electrical periods a turn and the torque of 3 A, and the
/// tick (50 us) at whose end the field has the position that probes take for that of its start.
const SHAFT_LAG: f64 = DRAG / (50.0 * 0.954) + 50e-6;

/// Times of the positive edges of latch units 0 and 1, and the system time.
const LATCH_TIME: u16 = 0x09B0;
const SYSTEM_TIME: u16 = 0x0910;

fn with_flag() -> Rig {
    let mut config = DriveConfig::numbered(0);
    config.plant.motor = MotorParameters {
        detent_torque: 0.0,
        friction: 0.0,
        drag: DRAG,
        ..plant::motors::QSH5718_56
    };
    config.plant.flags[0] = Some((Turns(LEFT / rig::PULSES_PER_TURN), Turns(RIGHT / rig::PULSES_PER_TURN)));
    Rig::with([config])
}

/// Makes IN1 probe 1 and takes the motion filter away, so that speeds are steady.
async fn prepare(main: &MainDevice<'_>, group: &Group<PreOp>) {
    let drive = group.subdevice(main, 0).unwrap();
    drive.sdo_write(0x2007, 1, 7_u16).await.unwrap();
    drive.sdo_write(0x2009, 0, 0_u16).await.unwrap();
}

/// Asserts that a latched position is where the command was when the shaft, `speed` pulses/s fast, passed the edge.
fn assert_at(latched: u32, edge: f64, speed: f64, what: &str) {
    let expected = edge + speed * SHAFT_LAG;
    let latched = f64::from(latched as i32);
    assert!((latched - expected).abs() <= 0.6, "{what}: {latched} for {expected}");
}

/// Process data of its own: outputs 6040 6060 60FF 60B8, inputs 6041 6064 60B9 60BA 60BB.
#[derive(Debug, Default)]
struct Exchanged {
    controlword: u16,
    velocity: i32,
    function: u16,
    statusword: u16,
    position: i32,
    status: u16,
    rising: u32,
    falling: u32,
}

async fn map(main: &MainDevice<'_>, group: &Group<PreOp>) {
    let drive = group.subdevice(main, 0).unwrap();
    for (assignment, pdo, objects) in [
        (0x1C12, 0x1600_u16, &[0x6040_0010_u32, 0x6060_0008, 0x60FF_0020, 0x60B8_0010][..]),
        (0x1C13, 0x1A00, &[0x6041_0010, 0x6064_0020, 0x60B9_0010, 0x60BA_0020, 0x60BB_0020]),
    ] {
        drive.sdo_write_array::<u16>(assignment, []).await.unwrap();
        drive.sdo_write_array(pdo, objects).await.unwrap();
        drive.sdo_write_array(assignment, [pdo]).await.unwrap();
    }
}

impl Exchanged {
    async fn cycle(&mut self, main: &MainDevice<'_>, pace: &Pace, group: &Group<Op>) {
        let drive = group.subdevice(main, 0).unwrap();
        {
            let mut bytes = drive.outputs_raw_mut();
            bytes[..2].copy_from_slice(&self.controlword.to_le_bytes());
            bytes[2] = mode::PROFILE_VELOCITY as u8;
            bytes[3..7].copy_from_slice(&self.velocity.to_le_bytes());
            bytes[7..9].copy_from_slice(&self.function.to_le_bytes());
        }
        assert_eq!(group.tx_rx(main).await.unwrap().working_counter, 3);
        let bytes = drive.inputs_raw();
        let word = |at: usize| u16::from_le_bytes([bytes[at], bytes[at + 1]]);
        let double = |at: usize| u32::from(word(at)) | u32::from(word(at + 2)) << 16;
        self.statusword = word(0);
        self.position = double(2) as i32;
        self.status = word(6);
        (self.rising, self.falling) = (double(8), double(12));
        pace.pause(CYCLE).await;
    }

    async fn until(&mut self, main: &MainDevice<'_>, pace: &Pace, group: &Group<Op>, what: &str, met: impl Fn(&Self) -> bool) {
        for _ in 0..5_000 {
            self.cycle(main, pace, group).await;
            if met(self) {
                return;
            }
        }
        panic!("never {what}: {self:?}");
    }

    async fn enable(&mut self, main: &MainDevice<'_>, pace: &Pace, group: &Group<Op>) {
        for _ in 0..100 {
            self.controlword = process_data::towards_enabled(self.statusword, self.controlword);
            self.cycle(main, pace, group).await;
            if statusword::is_enabled(self.statusword) {
                return;
            }
        }
        panic!("never enabled: {self:?}");
    }
}

// manual: 2.3.17/edges 2.3.19/position 2.3.20/position
#[test]
fn by_pdo_both_edges_are_latched_to_the_pulse_from_both_sides() {
    with_flag().in_preop(async |main, pace, group| {
        prepare(main, &group).await;
        map(main, &group).await;
        let group = bring_up::to_op(main, pace, group, CYCLE).await.unwrap();
        let mut data = Exchanged::default();
        data.enable(main, pace, &group).await;
        for (velocity, rising, falling) in [(3_000, LEFT, RIGHT), (-8_000, RIGHT, LEFT)] {
            let before = (data.rising, data.falling);
            data.function = 0;
            data.until(main, pace, &group, "disabled", |data| data.status == 0).await;
            assert_eq!((data.rising, data.falling), before, "latched positions stay");
            data.function = 0x31;
            data.velocity = velocity;
            data.until(main, pace, &group, "risen", |data| data.status == 0b011).await;
            data.until(main, pace, &group, "fallen", |data| data.status == 0b111).await;
            assert_at(data.rising, rising, velocity.into(), "rising");
            assert_at(data.falling, falling, velocity.into(), "falling");
            // On, out of the flag's reach.
            for _ in 0..300 {
                data.cycle(main, pace, &group).await;
            }
        }
    });
}

async fn move_to(axis: &mut Axis<'_>, target: i32) {
    axis.outputs.mode = mode::PROFILE_POSITION;
    axis.enable().await.unwrap();
    axis.set_point(target, 0).await.unwrap();
    axis.until("arrive", std::time::Duration::from_secs(5), |inputs| {
        inputs.statusword & statusword::TARGET_REACHED != 0
    })
    .await
    .unwrap();
}

#[test]
fn by_sdo_both_edges_are_latched_to_the_pulse_from_both_sides() {
    let rig = with_flag();
    for (target, speed, rising, falling) in [(12_000, 10_000.0, LEFT, RIGHT), (0, -10_000.0, RIGHT, LEFT)] {
        let arm = async |main: &MainDevice<'_>, group: &Group<PreOp>| {
            prepare(main, group).await;
            let drive = group.subdevice(main, 0).unwrap();
            drive.sdo_write(0x60B8, 0, 0_u16).await.unwrap();
            rig.idle(CYCLE);
            assert_eq!(drive.sdo_read::<u16>(0x60B9, 0).await, Ok(0));
            drive.sdo_write(0x60B8, 0, 0x31_u16).await.unwrap();
            rig.idle(CYCLE);
            assert_eq!(drive.sdo_read::<u16>(0x60B9, 0).await, Ok(1));
        };
        rig.in_op_after(arm, async |axis| move_to(axis, target).await);
        rig.in_preop(async |main, _, group| {
            let drive = group.subdevice(main, 0).unwrap();
            assert_eq!(drive.sdo_read::<u16>(0x60B9, 0).await, Ok(0b111));
            assert_at(drive.sdo_read(0x60BA, 0).await.unwrap(), rising, speed, "rising");
            assert_at(drive.sdo_read(0x60BB, 0).await.unwrap(), falling, speed, "falling");
        });
    }
    assert_eq!(rig.look(0, |drive| drive.device().objects().probe_1_positive_count), 2);
}

#[test]
fn the_latch_unit_tells_the_system_time_at_which_the_position_was_the_latched_one() {
    const SPEED: i32 = 20_000;
    let rig = with_flag();
    rig.in_preop(async |main, pace, group| {
        prepare(main, &group).await;
        map(main, &group).await;
        let group = bring_up::to_op(main, pace, group, CYCLE).await.unwrap();
        let mut data = Exchanged::default();
        data.enable(main, pace, &group).await;
        (data.function, data.velocity) = (0x31, SPEED);
        data.until(main, pace, &group, "over the flag", |data| data.status == 0b111).await;
        let drive = group.subdevice(main, 0).unwrap();
        let system: u64 = drive.register_read(SYSTEM_TIME).await.unwrap();
        let now = pace.now().0;
        for (index, latched) in [(0, data.rising), (1, data.falling)] {
            let time: u64 = drive.register_read(LATCH_TIME + 8 * index).await.unwrap();
            // The drive's last tick and where it was then; the speed is steady.
            let tick = pace.now().0 / board::TICK.0 * board::TICK.0;
            let there = rig.look(0, |drive| drive.device().drive().position().sub_pulses() as f64 / 4e8);
            let edge = now as f64 - (system - time) as f64;
            let expected = there - (tick as f64 - edge) * 1e-9 * f64::from(SPEED);
            assert!((f64::from(latched) - expected).abs() <= 0.55, "{latched} for {expected}");
        }
        let other: u64 = drive.register_read(LATCH_TIME + 16).await.unwrap();
        assert_eq!(other, 0, "nothing happened at IN2");
    });
}

#[test]
fn a_hand_on_in2_reaches_latch_unit_1_whatever_the_inputs_function() {
    let rig = Rig::new(1);
    rig.in_preop(async |main, pace, group| {
        let drive = group.subdevice(main, 0).unwrap();
        let before: u64 = drive.register_read(SYSTEM_TIME).await.unwrap();
        rig.touch(0, |drive| drive.plant_mut().hold_inputs(board::InputLevels(0b10)));
        pace.pause(CYCLE).await;
        let times: [u8; 32] = drive.register_read(LATCH_TIME).await.unwrap();
        let times: Vec<u64> = times.chunks(8).map(|bytes| u64::from_le_bytes(bytes.try_into().unwrap())).collect();
        assert!((before..before + 110_000).contains(&times[2]), "{times:?} after {before}");
        assert_eq!((times[0], times[1], times[3]), (0, 0, 0));
        assert_eq!(drive.register_read(0x09AF_u16).await, Ok(4_u8), "the level");
    });
}
