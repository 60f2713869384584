//! Scan, states, clocks, several drives, a master that comes back.

use std::time::Duration;

use ethercrab::subdevice_group::{HasDc, Op};
use ethercrab::{MainDevice, RegisterAddress, SubDeviceState};
use rig::{CYCLE, Rig, operate};
use usr2556e::drive::DriveConfig;
use usr2556e::master::Pace;
use usr2556e::master::axis::{AxisError, Operating};
use usr2556e::master::bring_up::{self, Group};
use usr2556e::master::process_data::{mode, statusword};
use wire::al::{AlState, AlStatusCode};

#[test]
fn scan_finds_each_drive_with_its_identity() {
    Rig::new(3).in_preop(async |main, _, group| {
        assert_eq!(group.len(), 3);
        for (position, drive) in group.iter(main).enumerate() {
            let identity = drive.identity();
            assert_eq!((identity.vendor_id, identity.product_id), (0xA88, 0x0A88_0001));
            assert_eq!((identity.revision, identity.serial), (0x204, position as u32 + 1));
            assert_eq!((drive.name(), drive.configured_address()), ("USR2556E", 0x1000 + position as u16));
            let mut read = [0_u32; 4];
            for (sub, number) in (1..=4).zip(&mut read) {
                *number = drive.sdo_read(0x1018, sub).await.unwrap();
            }
            assert_eq!(
                read,
                [0xA88, 0x0A88_0001, 0x204, position as u32 + 1],
                "0x1018 says what the SII says"
            );
        }
    });
}

#[test]
fn a_drive_identifies_itself_by_its_alias_while_the_master_asks() {
    let mut config = DriveConfig::numbered(0);
    config.eeprom = Some(device::sii::image(1, 1001));
    Rig::with([config]).in_preop(async |main, _, group| {
        let drive = group.subdevice(main, 0).unwrap();
        for (control, status, code) in [(0x22_u16, 0x22_u16, 1001_u16), (0x02, 0x02, 0)] {
            drive.register_write(RegisterAddress::AlControl, control).await.unwrap();
            assert_eq!(drive.register_read(RegisterAddress::AlStatus).await, Ok(status));
            assert_eq!(drive.register_read(RegisterAddress::AlStatusCode).await, Ok(code));
        }
    });
}

#[test]
fn run_and_err_led_are_read_from_their_registers() {
    const LEDS: u16 = 0x0138;
    Rig::new(1).in_preop(async |main, _, group| {
        let drive = group.subdevice(main, 0).unwrap();
        assert_eq!(drive.register_read(LEDS).await, Ok([0x1D_u8, 0x10]), "PREOP blinks");
        drive.register_write(RegisterAddress::AlControl, 0x08_u16).await.unwrap();
        assert_eq!(drive.register_read(LEDS).await, Ok([0x1D_u8, 0x1D]), "OP is refused, ERR blinks");
        drive.register_write(RegisterAddress::AlControl, 0x12_u16).await.unwrap();
        assert_eq!(drive.register_read(LEDS).await, Ok([0x1D_u8, 0x10]));
    });
}

#[test]
fn propagation_delays_grow_evenly_along_the_line() {
    Rig::new(4).in_preop(async |main, _, group| {
        let delays: Vec<u32> = group.iter(main).map(|drive| drive.propagation_delay()).collect();
        assert_eq!(delays[0], 0);
        let step = delays[1];
        assert!((100..1000).contains(&step), "{delays:?}");
        assert_eq!(delays, [0, step, 2 * step, 3 * step]);
    });
}

#[test]
fn op_without_clocks_exchanges_process_data_with_full_working_counter() {
    Rig::new(1).in_preop(async |main, pace, group| {
        let group = bring_up::to_op(main, pace, group, CYCLE).await.unwrap();
        let response = group.tx_rx(main).await.unwrap();
        assert_eq!(response.working_counter, 3, "one drive read and written");
        let drive = group.subdevice(main, 0).unwrap();
        assert_eq!((drive.inputs_raw().len(), drive.outputs_raw().len()), (11, 7));
        let (state, code) = drive.status().await.unwrap();
        assert_eq!((state, code.into()), (SubDeviceState::Op, 0_u16));
    });
}

/// Exchanges process data for so many cycles and asserts that all system times then agree within a microsecond.
async fn assert_in_step(main: &MainDevice<'_>, pace: &Pace, group: &Group<Op, HasDc>, cycles: u32) {
    for _ in 0..cycles {
        let (all_op, next) = bring_up::exchange_with_clocks(main, pace, group).await.unwrap();
        assert!(all_op);
        pace.until(next).await;
    }
    for drive in group.iter(main) {
        let difference: u32 = drive.register_read(RegisterAddress::DcSystemTimeDifference).await.unwrap();
        assert!(difference & 0x7FFF_FFFF < 1000, "system time difference {difference:#x}");
    }
}

#[test]
fn op_with_clocks_runs_on_sync0_in_all_drives() {
    Rig::new(3).in_preop(async |main, pace, group| {
        let group = bring_up::to_op_with_clocks(main, pace, group, CYCLE).await.unwrap();
        assert_in_step(main, pace, &group, 500).await;
        for drive in group.iter(main) {
            assert_eq!(drive.sdo_read::<u16>(0x1C32, 1).await, Ok(2), "synchronised to SYNC0");
            assert_eq!(drive.sdo_read::<u16>(0x1C32, 0x0B).await, Ok(0), "no SM event missed");
        }
    });
}

#[test]
fn drives_with_drifting_clocks_are_pulled_together() {
    let drifting = |position: usize, ppb| {
        let mut config = DriveConfig::numbered(position);
        config.clock_ppb = ppb;
        config
    };
    Rig::with([drifting(0, 20_000), drifting(1, -30_000), drifting(2, 5_000)]).in_preop(async |main, pace, group| {
        let group = bring_up::to_op_with_clocks(main, pace, group, CYCLE).await.unwrap();
        assert_in_step(main, pace, &group, 4000).await;
    });
}

#[test]
fn three_drives_on_one_segment_move_each_for_itself() {
    let rig = Rig::new(3);
    rig.in_preop(async |main, pace, group| {
        let group = bring_up::to_op(main, pace, group, CYCLE).await.unwrap();
        operate(main, pace, Operating::Frames(group, CYCLE), 1, async |axis| {
            axis.outputs.mode = mode::PROFILE_POSITION;
            axis.enable().await.unwrap();
            axis.set_point(5000, 0).await.unwrap();
            axis.until("arrive", Duration::from_secs(5), |inputs| {
                inputs.statusword & statusword::TARGET_REACHED != 0
            })
            .await
            .unwrap();
        })
        .await;
    });
    let positions = [0, 1, 2].map(|position| rig.look(position, |drive| drive.status().position));
    assert_eq!(positions, [0, 5000, 0]);
}

#[test]
fn a_master_restarted_without_a_power_cycle_finds_the_drive_ready() {
    let rig = Rig::new(2);
    for with_clocks in [true, false, true] {
        // Each master stops dead in OP with the first drive enabled: nothing is taken back.
        rig.in_preop(async |main, pace, group| {
            let drives = if with_clocks {
                Operating::Clocks(bring_up::to_op_with_clocks(main, pace, group, CYCLE).await.unwrap())
            } else {
                Operating::Frames(bring_up::to_op(main, pace, group, CYCLE).await.unwrap(), CYCLE)
            };
            operate(main, pace, drives, 0, async |axis| {
                axis.outputs.mode = mode::PROFILE_POSITION;
                axis.enable().await.unwrap();
            })
            .await;
        });
        assert_eq!(rig.look(0, |drive| drive.status().al_state), AlState::Op);
    }
}

#[test]
fn silence_in_op_ends_in_safeop_with_the_watchdogs_code_and_a_communication_fault() {
    let rig = Rig::new(1);
    rig.in_preop(async |main, pace, group| {
        let group = bring_up::to_op(main, pace, group, CYCLE).await.unwrap();
        operate(main, pace, Operating::Frames(group, CYCLE), 0, async |axis| {
            axis.outputs.mode = mode::PROFILE_POSITION;
            axis.enable().await.unwrap();
        })
        .await;
    });
    rig.idle(Duration::from_millis(90));
    assert_eq!(
        rig.look(0, |drive| drive.status().al_state),
        AlState::Op,
        "the watchdog's 100 ms are not over"
    );
    rig.idle(Duration::from_millis(20));
    let status = rig.look(0, |drive| drive.status());
    assert_eq!(
        (status.al_state, status.al_status_code),
        (AlState::SafeOp, AlStatusCode::SyncManagerWatchdog)
    );
    rig.idle(Duration::from_secs(1));
    assert_eq!(rig.look(0, |drive| drive.status().error_code), 0x7500);
    // A new master leads it out again.
    rig.in_op(async |axis| {
        axis.outputs.mode = mode::PROFILE_POSITION;
        axis.enable().await.unwrap();
    });
}

#[test]
fn a_power_cycle_in_op_is_seen_by_the_master() {
    let rig = Rig::new(1);
    rig.in_preop(async |main, pace, group| {
        let group = bring_up::to_op(main, pace, group, CYCLE).await.unwrap();
        operate(main, pace, Operating::Frames(group, CYCLE), 0, async |axis| {
            axis.cycle().await.unwrap();
            rig.touch(0, |drive| drive.power_cycle());
            assert!(matches!(axis.cycle().await, Err(AxisError::Bus(_) | AxisError::LeftOp { .. })));
        })
        .await;
    });
    assert_eq!(rig.look(0, |drive| drive.status().al_state), AlState::Init);
}
