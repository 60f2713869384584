//! Profile position, profile velocity and cyclic position over the bus.

use std::time::Duration;

use rig::{CYCLE, Rig};
use usr2556e::master::axis::{Axis, HANDSHAKE_LIMIT};
use usr2556e::master::bring_up;
use usr2556e::master::process_data::{Inputs, controlword, mode, statusword};

const LIMIT: Duration = Duration::from_secs(20);

fn arrived(inputs: &Inputs) -> bool {
    inputs.statusword & statusword::TARGET_REACHED != 0
}

async fn enabled_in(axis: &mut Axis<'_>, wanted: i8) {
    axis.outputs.mode = wanted;
    axis.enable().await.unwrap();
    axis.until("change mode", HANDSHAKE_LIMIT, |inputs| inputs.mode == wanted)
        .await
        .unwrap();
}

// manual: 1.1.1/modes 2.3.6/position 2.3.8/pp 2.4.2/mode
#[test]
fn absolute_and_relative_moves_end_on_the_pulse() {
    let rig = Rig::new(1);
    rig.in_op(async |axis| {
        enabled_in(axis, mode::PROFILE_POSITION).await;
        let mut expected = 0;
        for (target, bits) in [
            (12_345, 0),
            (-777, 0),
            (1_000, controlword::RELATIVE),
            (-223, controlword::RELATIVE),
            (0, 0),
            (1, controlword::RELATIVE),
        ] {
            expected = if bits == 0 { target } else { expected + target };
            axis.set_point(target, bits).await.unwrap();
            axis.until("arrive", LIMIT, arrived).await.unwrap();
            assert_eq!(axis.inputs.position, expected);
        }
    });
    // Friction and detent hold a shaft that comes to rest up to a pulse and a half from where the field points.
    assert!(
        (rig.shaft() - 1.0).abs() < 1.5,
        "the shaft is where the counter says: {}",
        rig.shaft()
    );
}

#[test]
fn a_set_point_that_takes_effect_at_once_replaces_the_one_under_way() {
    Rig::new(1).in_op(async |axis| {
        enabled_in(axis, mode::PROFILE_POSITION).await;
        axis.set_point(50_000, 0).await.unwrap();
        for _ in 0..500 {
            axis.cycle().await.unwrap();
        }
        assert!(!arrived(&axis.inputs));
        axis.set_point(8_000, controlword::IMMEDIATELY).await.unwrap();
        axis.until("arrive", LIMIT, arrived).await.unwrap();
        assert_eq!(axis.inputs.position, 8_000);
    });
}

#[test]
fn halt_stops_the_move_and_its_end_lets_it_go_on() {
    Rig::new(1).in_op(async |axis| {
        enabled_in(axis, mode::PROFILE_POSITION).await;
        axis.set_point(30_000, 0).await.unwrap();
        for _ in 0..800 {
            axis.cycle().await.unwrap();
        }
        axis.outputs.controlword |= controlword::HALT;
        axis.until("halt", LIMIT, arrived).await.unwrap();
        let halted = axis.inputs.position;
        assert!((1_000..29_000).contains(&halted), "{halted}");
        for _ in 0..100 {
            axis.cycle().await.unwrap();
            assert_eq!(axis.inputs.position, halted);
        }
        axis.outputs.controlword &= !controlword::HALT;
        axis.until("go on", LIMIT, |inputs| !arrived(inputs)).await.unwrap();
        axis.until("arrive", LIMIT, arrived).await.unwrap();
        assert_eq!(axis.inputs.position, 30_000);
    });
}

// manual: 1.1.1/modes 2.3.7/speed 2.4.3/direction
#[test]
fn profile_velocity_runs_reverses_and_halts() {
    Rig::new(1).in_preop(async |main, pace, group| {
        let drive = group.subdevice(main, 0).unwrap();
        drive.sdo_write_array(0x1C12, [0x1602_u16]).await.unwrap();
        drive.sdo_write_array(0x1C13, [0x1A01_u16]).await.unwrap();
        let group = bring_up::to_op(main, pace, group, CYCLE).await.unwrap();
        // 1602: 6040, 6083, 6084, 60FF, 6060. 1A01: 6041, 6061, 606C, 60FD.
        let exchange = async |word: u16, velocity: i32, cycles: u32| {
            for _ in 0..cycles {
                let drive = group.subdevice(main, 0).unwrap();
                {
                    let mut outputs = drive.outputs_raw_mut();
                    outputs[..2].copy_from_slice(&word.to_le_bytes());
                    outputs[2..6].copy_from_slice(&100_000_u32.to_le_bytes());
                    outputs[6..10].copy_from_slice(&100_000_u32.to_le_bytes());
                    outputs[10..14].copy_from_slice(&velocity.to_le_bytes());
                    outputs[14] = mode::PROFILE_VELOCITY as u8;
                }
                group.tx_rx(main).await.unwrap();
                pace.pause(CYCLE).await;
            }
            let drive = group.subdevice(main, 0).unwrap();
            let inputs = drive.inputs_raw();
            (
                u16::from_le_bytes([inputs[0], inputs[1]]),
                i32::from_le_bytes([inputs[3], inputs[4], inputs[5], inputs[6]]),
            )
        };
        exchange(controlword::SHUTDOWN, 0, 5).await;
        let (status, rpm) = exchange(controlword::ENABLE_OPERATION | controlword::HALT, 20_000, 300).await;
        assert!(statusword::is_enabled(status));
        assert_eq!(rpm, 0, "the manual enables with halt set and the motor stands");
        let (status, rpm) = exchange(controlword::ENABLE_OPERATION, 20_000, 400).await;
        assert_eq!(rpm, 120, "20 000 pulses/s are 120 rpm");
        assert!(status & statusword::TARGET_REACHED != 0 && status & statusword::ACKNOWLEDGE == 0);
        let (_, rpm) = exchange(controlword::ENABLE_OPERATION, -10_000, 600).await;
        assert_eq!(rpm, -60, "reversed through zero");
        let (status, rpm) = exchange(controlword::ENABLE_OPERATION | controlword::HALT, -10_000, 300).await;
        assert_eq!(rpm, 0);
        assert!(
            status & statusword::TARGET_REACHED != 0 && status & statusword::ACKNOWLEDGE != 0,
            "halted, speed is zero"
        );
    });
}

/// Follows a sine and returns for each cycle what was sent and what had been reached.
async fn follow_sine(axis: &mut Axis<'_>) -> Vec<(i32, i32)> {
    enabled_in(axis, mode::CYCLIC_POSITION).await;
    let start = axis.inputs.position;
    let mut track = Vec::new();
    for cycle in 0..2000 {
        let angle = f64::from(cycle) / 1000.0 * std::f64::consts::TAU;
        axis.outputs.target_position = start + (5_000.0 * (1.0 - angle.cos())) as i32;
        axis.cycle().await.unwrap();
        track.push((axis.outputs.target_position, axis.inputs.position));
    }
    for _ in 0..20 {
        axis.cycle().await.unwrap();
    }
    assert_eq!(axis.inputs.position, axis.outputs.target_position);
    track
}

/// Whether the positions are the targets of a whole number of cycles before, and of how many.
fn delay(track: &[(i32, i32)]) -> Option<usize> {
    (0..20).find(|&delay| track[500..].iter().zip(&track[500 - delay..]).all(|(now, then)| now.1 == then.0))
}

/// The motion filter off, so that positions can be compared to the pulse.
macro_rules! without_filter {
    () => {
        async |main, group| group.subdevice(main, 0).unwrap().sdo_write(0x2009, 0, 0_u16).await.unwrap()
    };
}

// manual: 1.1.1/modes 2.3.8/csp 2.4.4/targets
#[test]
fn cyclic_position_passes_through_every_target_on_sync0() {
    let track = Rig::new(1).in_op_with_clocks(without_filter!(), follow_sine);
    let delay = delay(&track).expect("each target is reached, one a cycle");
    assert!(delay <= 4, "{delay} cycles behind");
}

#[test]
fn cyclic_position_passes_through_every_target_on_frames() {
    let track = Rig::new(1).in_op_after(without_filter!(), follow_sine);
    let largest = track[500..]
        .iter()
        .zip(&track[497..])
        .map(|(now, then)| (now.1 - then.0).abs())
        .max()
        .unwrap();
    assert!(largest <= 64, "{largest} pulses off the target of three cycles before");
}

#[test]
fn a_limit_switch_stops_the_move_and_only_the_way_back_is_open() {
    let rig = Rig::standing_at(9.0);
    rig.in_op(async |axis| {
        enabled_in(axis, mode::PROFILE_POSITION).await;
        axis.set_point(50_000, 0).await.unwrap();
        axis.until("meet the limit", LIMIT, |inputs| inputs.digital_inputs & 0b10 != 0)
            .await
            .unwrap();
        for _ in 0..500 {
            axis.cycle().await.unwrap();
        }
        let stopped = axis.inputs.position;
        assert!((10_000..11_000).contains(&stopped), "{stopped}");
        assert!(axis.inputs.statusword & 1 << 11 != 0, "internal limit active");
        assert!(statusword::is_enabled(axis.inputs.statusword), "a limit is no fault");
        axis.set_point(5_000, 0).await.unwrap();
        axis.until("come back", LIMIT, arrived).await.unwrap();
        assert_eq!(axis.inputs.position, 5_000);
        assert!(axis.inputs.statusword & 1 << 11 == 0);
    });
}
