//! Faults as a master sees them: objects, emergencies and the alarm LED, and both ways to clear them.

use std::time::Duration;

use board::{InputLevels, Millivolts};
use drive::{Alarm, PowerState};
use ethercrab::subdevice_group::PreOp;
use ethercrab::{Command, MainDevice};
use plant::Faults;
use rig::Rig;
use usr2556e::breakdown::Breakdown;
use usr2556e::drive::{DriveConfig, VirtualDrive};
use usr2556e::flash;
use usr2556e::master::axis::AxisError;
use usr2556e::master::bring_up::Group;
use usr2556e::master::process_data::{mode, statusword};
use usr2556e::master::sdo;

use crate::raw_mailbox::fetch;

const SETTLING: Duration = Duration::from_millis(5);

struct Case {
    code: u16,
    error_register: u8,
    alarm_code: u16,
    alarm: Alarm,
    provoke: fn(&Rig),
    /// Takes the cause away.
    cure: fn(&Rig),
}

/// A current sensor that breaks; what the drive reads of it while the power stage is off gives it away.
const fn broken_sensor(code: u16, provoke: fn(&Rig)) -> Case {
    Case {
        code,
        error_register: 0x05,
        alarm_code: 0x0001,
        alarm: Alarm::Fault { red: 3 },
        provoke,
        cure: |rig| rig.touch(0, |drive| drive.plant_mut().set_faults(Faults::default())),
    }
}

const CASES: [Case; 4] = [
    broken_sensor(0x3150, |rig| broken(rig, Breakdown::SensorA)),
    broken_sensor(0x3151, |rig| broken(rig, Breakdown::SensorB)),
    Case {
        code: 0x3110,
        error_register: 0x05,
        alarm_code: 0x0004,
        alarm: Alarm::Fault { red: 2 },
        provoke: |rig| rig.touch(0, |drive| drive.plant_mut().set_supply(Millivolts(61_000))),
        cure: |rig| rig.touch(0, |drive| drive.plant_mut().set_supply(Millivolts(36_000))),
    },
    Case {
        code: 0x5530,
        error_register: 0x01,
        alarm_code: 0,
        alarm: Alarm::Fault { red: 6 },
        provoke: |rig| {
            rig.touch(0, |drive| *drive.memory_mut() = damaged());
            rig.touch(0, VirtualDrive::power_cycle);
        },
        cure: |_| (),
    },
];

/// A memory whose parameters are lost.
fn damaged() -> flash::Flash {
    flash::Flash::with([0x55; flash::SIZE])
}

/// The bytes of an emergency.
fn emergency(code: u16, error_register: u8, alarm_code: u16) -> Vec<u8> {
    let ([low, high], [first, second]) = (code.to_le_bytes(), alarm_code.to_le_bytes());
    vec![low, high, error_register, first, second, 0, 0, 0]
}

// manual: 1.6/internal-voltage 2.2.14/internal-voltage 2.3.1/3150 2.3.1/3151
// manual: 1.6/overvoltage 1.6/parameters 2.2.14/overvoltage 2.2.14/cleared 2.3.1/3110 2.3.1/5530 2.3.1/cleared
#[test]
fn faults_are_told_by_objects_emergency_and_led_and_cleared_by_controlword_or_input() {
    for case in &CASES {
        for by_input in [false, true] {
            let rig = Rig::with([DriveConfig::numbered(0)]);
            rig.idle(SETTLING);
            (case.provoke)(&rig);
            rig.idle(SETTLING);
            assert_eq!(rig.look(0, |drive| drive.indicators().alarm), case.alarm);
            (case.cure)(&rig);
            rig.in_preop(async |main, pace, group| {
                let drive = group.subdevice(main, 0).unwrap();
                let read = async |address: &str| sdo::read(&drive, address.parse().unwrap()).await.unwrap();
                let write = async |address: &str, value: u16| {
                    let bytes = value.to_le_bytes();
                    sdo::write(&drive, address.parse().unwrap(), &bytes).await.unwrap();
                };
                let told = emergency(case.code, case.error_register, case.alarm_code);
                assert_eq!(fetch(&drive).await, Some((1, told)));
                assert_eq!(read("603F").await, case.code.to_le_bytes());
                assert_eq!(read("1001").await, [case.error_register]);
                assert_eq!(read("200E").await, case.alarm_code.to_le_bytes());
                assert_eq!(read("6041").await[0] & 0x4F, 0x08, "Fault");
                if by_input {
                    write("2007:1", 4).await;
                    rig.touch(0, |drive| drive.plant_mut().hold_inputs(InputLevels(1)));
                } else {
                    write("6040", 0x0080).await;
                }
                pace.until(pace.now().after(SETTLING)).await;
                assert_eq!(fetch(&drive).await, Some((1, emergency(0, 0, 0))), "cleared");
                assert_eq!(
                    (read("603F").await, read("1001").await, read("200E").await),
                    (vec![0; 2], vec![0], vec![0; 2])
                );
            });
            assert_eq!(rig.look(0, |drive| drive.status().power_state), PowerState::SwitchOnDisabled);
            assert_eq!(rig.look(0, |drive| drive.indicators().alarm), Alarm::Disabled);
        }
    }
}

/// What a breakdown leads to while the motor is enabled.
struct Enabled {
    breakdown: Breakdown,
    code: u16,
    error_register: u8,
    alarm_code: u16,
    red: u8,
}

const ENABLED: [Enabled; 6] = [
    lost_phase(Breakdown::OpenA),
    lost_phase(Breakdown::OpenB),
    overcurrent(Breakdown::ShortedA),
    overcurrent(Breakdown::ShortedB),
    Enabled {
        breakdown: Breakdown::Supply(Millivolts(-22_000)),
        code: 0x3210,
        error_register: 0x05,
        alarm_code: 0x0001,
        red: 3,
    },
    Enabled {
        breakdown: Breakdown::Supply(Millivolts(26_000)),
        code: 0x3110,
        error_register: 0x05,
        alarm_code: 0x0004,
        red: 2,
    },
];

const fn lost_phase(breakdown: Breakdown) -> Enabled {
    Enabled {
        breakdown,
        code: 0x7122,
        error_register: 0x01,
        alarm_code: 0,
        red: 7,
    }
}

const fn overcurrent(breakdown: Breakdown) -> Enabled {
    Enabled {
        breakdown,
        code: 0x2211,
        error_register: 0x03,
        alarm_code: 0x0002,
        red: 1,
    }
}

/// When it breaks.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Moment {
    /// Before the motor is enabled for the first time.
    Before,
    /// At standstill, locked.
    Standing,
    /// At one turn a second.
    Moving,
}

fn broken(rig: &Rig, breakdown: Breakdown) {
    rig.touch(0, |drive| {
        let mut faults = drive.plant().faults();
        breakdown.add_to(&mut faults);
        drive.plant_mut().set_faults(faults);
    });
}

/// Enables, moves and breaks; the drive is expected to find out by itself, within a second of motion at the latest.
fn break_at(rig: &Rig, moment: Moment, case: &Enabled) {
    let slowly = async |main: &MainDevice<'_>, group: &Group<PreOp>| {
        let drive = group.subdevice(main, 0).unwrap();
        drive.sdo_write(0x6081, 0, 10_000_u32).await.unwrap();
    };
    rig.in_op_after(slowly, async |axis| {
        axis.outputs.mode = mode::PROFILE_POSITION;
        if moment == Moment::Before {
            broken(rig, case.breakdown);
        }
        let mut end = axis.enable().await;
        if moment == Moment::Standing && end.is_ok() {
            for _ in 0..200 {
                axis.cycle().await.unwrap();
            }
            broken(rig, case.breakdown);
        }
        if end.is_ok() {
            end = axis.set_point(90_000, 0).await;
        }
        if moment == Moment::Moving && end.is_ok() {
            for _ in 0..500 {
                axis.cycle().await.unwrap();
            }
            broken(rig, case.breakdown);
        }
        if end.is_ok() {
            end = axis.until("no fault", Duration::from_secs(1), |_| false).await;
        }
        assert!(
            matches!(end, Err(AxisError::Fault { .. })),
            "{} {moment:?}: {end:?}",
            case.breakdown
        );
    });
}

// manual: 1.6/overcurrent 1.6/overvoltage 1.6/internal-voltage 1.6/phase-loss 2.2.14/overcurrent 2.2.14/overvoltage 2.2.14/internal-voltage
// manual: 2.3.1/2211 2.3.1/3110 2.3.1/3210 2.3.1/7122
#[test]
fn what_breaks_at_an_enabled_motor_is_told_by_objects_emergency_and_led() {
    for case in &ENABLED {
        for moment in [Moment::Before, Moment::Standing, Moment::Moving] {
            let is_supply = matches!(case.breakdown, Breakdown::Supply(_));
            if is_supply && moment == Moment::Before {
                // A supply out of range keeps the motor from being enabled, or is a fault before.
                continue;
            }
            let rig = Rig::new(1);
            let what = format!("{} {moment:?}", case.breakdown);
            break_at(&rig, moment, case);
            assert_eq!(
                rig.look(0, |drive| drive.indicators().alarm),
                Alarm::Fault { red: case.red },
                "{what}"
            );
            // It lies in the mailbox, which the next scan empties.
            rig.converse(async |main, _| {
                let message: [u8; 128] = Command::fprd(0x1000, 0x1080).receive(main).await.unwrap();
                let told = emergency(case.code, case.error_register, case.alarm_code);
                assert_eq!(message[8..16], told, "{what}");
            });
            rig.in_preop(async |main, _, group| {
                let drive = group.subdevice(main, 0).unwrap();
                assert_eq!(drive.sdo_read(0x603F, 0).await, Ok(case.code), "{what}");
                assert_eq!(drive.sdo_read(0x1001, 0).await, Ok(case.error_register), "{what}");
                assert_eq!(drive.sdo_read(0x200E, 0).await, Ok(case.alarm_code), "{what}");
            });
        }
    }
}

#[test]
fn a_rotor_that_is_stuck_loses_its_steps_and_an_open_loop_drive_does_not_know() {
    let rig = Rig::new(1);
    rig.in_op(async |axis| {
        axis.outputs.mode = mode::PROFILE_POSITION;
        axis.enable().await.unwrap();
        broken(&rig, Breakdown::StuckRotor);
        axis.set_point(20_000, 0).await.unwrap();
        axis.until("arrive", Duration::from_secs(10), |inputs| {
            inputs.statusword & statusword::TARGET_REACHED != 0
        })
        .await
        .unwrap();
        assert_eq!(axis.inputs.position, 20_000);
        assert_eq!(rig.look(0, |drive| drive.motor().lost_periods), 100, "two turns of fifty periods");
    });
}

// manual: 2.3.1/3110
#[test]
fn braking_a_great_inertia_hard_pumps_the_supply_up_until_the_drive_lets_go() {
    let mut config = DriveConfig::numbered(0);
    config.plant.load.inertia = 4e-3;
    let rig = Rig::with([config]);
    let ramps = async |main: &MainDevice<'_>, group: &Group<PreOp>| {
        let drive = group.subdevice(main, 0).unwrap();
        for (index, value) in [(0x6081, 90_000), (0x6083, 120_000), (0x6084, 200_000)] {
            drive.sdo_write(index, 0, value).await.unwrap();
        }
    };
    rig.in_op_after(ramps, async |axis| {
        axis.outputs.mode = mode::PROFILE_POSITION;
        axis.enable().await.unwrap();
        axis.set_point(90_000, 0).await.unwrap();
        let end = axis.until("no fault", Duration::from_secs(3), |_| false).await;
        assert!(matches!(end, Err(AxisError::Fault { .. })), "{end:?}");
        let (code, pumped) = rig.look(0, |drive| (drive.status().error_code, drive.motor().bus_voltage));
        assert_eq!(code, 0x3110);
        assert!(pumped > 40.0, "the energy is still in the capacitor: {pumped} V");
    });
}
