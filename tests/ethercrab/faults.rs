//! Faults as a master sees them: objects, emergencies and the alarm LED, and both ways to clear them.

use std::time::Duration;

use board::{InputLevels, Millivolts};
use drive::{Alarm, PowerState};
use ethercrab::Command;
use rig::Rig;
use usr2556e::drive::{DriveConfig, VirtualDrive};
use usr2556e::flash;
use usr2556e::master::axis::AxisError;
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

const CASES: [Case; 2] = [
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

/// A fault that takes an enabled motor.
struct Enabled {
    code: u16,
    error_register: u8,
    alarm_code: u16,
    red: u8,
    /// What is wrong with the motor.
    motor: fn(&mut plant::MotorParameters),
    /// What goes wrong after the motor was enabled.
    provoke: fn(&Rig),
}

const ENABLED: [Enabled; 3] = [
    Enabled {
        code: 0x7122,
        error_register: 0x01,
        alarm_code: 0,
        red: 7,
        motor: |motor| (motor.resistance, motor.inductance) = (1e6, 1e3),
        provoke: |_| (),
    },
    Enabled {
        code: 0x2211,
        error_register: 0x03,
        alarm_code: 0x0002,
        red: 1,
        motor: |motor| (motor.resistance, motor.inductance) = (0.1, 20e-6),
        provoke: |_| (),
    },
    Enabled {
        code: 0x3210,
        error_register: 0x05,
        alarm_code: 0x0001,
        red: 3,
        motor: |_| (),
        provoke: |rig| rig.touch(0, |drive| drive.plant_mut().set_supply(Millivolts(14_000))),
    },
];

// manual: 1.6/overcurrent 1.6/internal-voltage 1.6/phase-loss 2.2.14/overcurrent 2.2.14/internal-voltage 2.3.1/2211 2.3.1/3210 2.3.1/7122
#[test]
fn faults_of_an_enabled_motor_are_told_by_objects_emergency_and_led() {
    for case in &ENABLED {
        let mut config = DriveConfig::numbered(0);
        (case.motor)(&mut config.plant.motor);
        let rig = Rig::with([config]);
        rig.in_op(async |axis| {
            axis.enable().await.unwrap();
            (case.provoke)(&rig);
            let end = axis.until("no fault", Duration::from_secs(1), |_| false).await;
            assert!(matches!(end, Err(AxisError::Fault { .. })), "{:04X}: {end:?}", case.code);
        });
        assert_eq!(rig.look(0, |drive| drive.indicators().alarm), Alarm::Fault { red: case.red });
        // It lies in the mailbox, which the next scan empties.
        rig.converse(async |main, _| {
            let message: [u8; 128] = Command::fprd(0x1000, 0x1080).receive(main).await.unwrap();
            let told = emergency(case.code, case.error_register, case.alarm_code);
            assert_eq!(message[8..16], told, "{:04X}", case.code);
        });
        rig.in_preop(async |main, _, group| {
            let drive = group.subdevice(main, 0).unwrap();
            assert_eq!(drive.sdo_read(0x603F, 0).await, Ok(case.code));
            assert_eq!(drive.sdo_read(0x1001, 0).await, Ok(case.error_register));
            assert_eq!(drive.sdo_read(0x200E, 0).await, Ok(case.alarm_code));
        });
    }
}
