//! The LEDs on the drive's front, led through the wire.

use std::time::Duration;

use drive::{Alarm, Light};
use ethercrab::RegisterAddress;
use rig::{CYCLE, Rig, operate};
use usr2556e::indicators::PortIndicators;
use usr2556e::master::axis::Operating;
use usr2556e::master::bring_up;
use usr2556e::master::process_data::mode;
use wire::indicator::Pattern;

const RUN_LED: u16 = 0x0138;

fn shown(rig: &Rig) -> String {
    rig.look(0, |drive| drive.indicators().to_string())
}

// manual: 1.4.1/run 1.4.1/err-general
#[test]
fn run_and_err_follow_the_state_and_the_refusals() {
    let rig = Rig::new(1);
    assert_eq!(
        shown(&rig),
        "RUN off, ERR off, alarm green, IN no link, OUT no link",
        "no time has passed yet"
    );
    rig.idle(Duration::from_millis(1));
    assert_eq!(shown(&rig), "RUN off, ERR off, alarm green, IN link, OUT no link");
    rig.in_preop(async |main, _, group| {
        assert_eq!(shown(&rig), "RUN blinking, ERR off, alarm green, IN active, OUT no link");
        let drive = group.subdevice(main, 0).unwrap();
        drive.register_write(RegisterAddress::AlControl, 0x08_u16).await.unwrap();
        assert_eq!(shown(&rig), "RUN blinking, ERR blinking, alarm green, IN active, OUT no link");
        drive.register_write(RegisterAddress::AlControl, 0x12_u16).await.unwrap();
        assert_eq!(shown(&rig), "RUN blinking, ERR off, alarm green, IN active, OUT no link");
    });
    rig.in_op(async |_| assert_eq!(shown(&rig), "RUN on, ERR off, alarm green, IN active, OUT no link"));
}

#[test]
fn a_master_makes_the_leds_of_a_drive_flicker_until_the_state_changes() {
    let rig = Rig::new(1);
    rig.in_preop(async |main, _, group| {
        let drive = group.subdevice(main, 0).unwrap();
        let patterns = || rig.look(0, |drive| [drive.indicators().run.pattern(), drive.indicators().err.pattern()]);
        drive.register_write(RUN_LED, [0x1E_u8, 0x1E]).await.unwrap();
        assert_eq!(patterns(), [Pattern::FLICKERING; 2]);
        drive.register_write(RUN_LED, [0_u8, 0]).await.unwrap();
        assert_eq!(patterns(), [Pattern::BLINKING, Pattern::OFF], "the state again");
        drive.register_write(RUN_LED, [0x13_u8, 0x1F]).await.unwrap();
        assert_eq!(patterns(), [Pattern::from_code(3), Pattern::ON]);
        drive.register_write(RegisterAddress::AlControl, 0x11_u16).await.unwrap();
        assert_eq!(patterns(), [Pattern::OFF, Pattern::OFF]);
    });
}

// manual: 1.4.1/err-watchdog
#[test]
fn silence_in_op_shows_as_watchdog_error_and_not_as_alarm() {
    let rig = Rig::new(1);
    rig.in_preop(async |main, pace, group| {
        let group = bring_up::to_op(main, pace, group, CYCLE).await.unwrap();
        operate(main, pace, Operating::Frames(group, CYCLE), 0, async |axis| {
            axis.outputs.mode = mode::PROFILE_POSITION;
            axis.enable().await.unwrap();
            assert_eq!(shown(&rig), "RUN on, ERR off, alarm green flashing, IN active, OUT no link");
        })
        .await;
    });
    rig.idle(Duration::from_secs(1));
    assert_eq!(shown(&rig), "RUN single flash, ERR double flash, alarm green, IN link, OUT no link");
}

#[test]
fn the_lamps_flash_in_the_drives_own_time() {
    let rig = Rig::new(1);
    rig.in_preop(async |_, _, _| ());
    rig.idle(Duration::from_millis(200));
    // PREOP blinks: each step of 200 ms finds the other half of it.
    let mut seen = Vec::new();
    for _ in 0..6 {
        seen.push(rig.look(0, |drive| drive.indicators().run.is_lit(drive.now())));
        rig.idle(Duration::from_millis(200));
    }
    assert!(seen.windows(2).all(|pair| pair[0] != pair[1]), "{seen:?}");
    let alarm = rig.look(0, |drive| (drive.indicators().alarm, drive.indicators().alarm_light));
    assert_eq!(alarm, (Alarm::Disabled, Light::Green));
}

// manual: 1.1.1/ports 1.4/order 1.4.1/link 1.4.1/activity
#[test]
fn each_port_shows_its_own_link_and_the_traffic() {
    let rig = Rig::new(2);
    rig.in_preop(async |_, _, _| ());
    let ports = |position| {
        rig.look(position, |drive| {
            drive.indicators().ports.map(|port| port.map(|port| port.to_string()))
        })
    };
    assert_eq!(ports(0), [Some("active".into()), Some("active".into()), None, None]);
    assert_eq!(ports(1), [Some("active".into()), Some("no link".into()), None, None]);
    rig.idle(Duration::from_millis(150));
    assert_eq!(ports(0)[1].as_deref(), Some("link"), "nothing came for a while");
    let quiet = rig.look(0, |drive| drive.indicators().without_activity());
    rig.in_preop(async |_, _, _| {
        rig.look(0, |drive| {
            assert_eq!(drive.indicators().without_activity(), quiet, "logs do not tell of traffic");
            assert!(drive.status().to_string().ends_with(&format!("LEDs: {}", drive.indicators())));
        });
    });
    rig.idle(Duration::from_millis(150));
    let in_port: PortIndicators = rig.look(0, |drive| drive.indicators().ports[0].unwrap());
    assert_eq!((in_port.link.pattern(), in_port.activity.pattern()), (Pattern::ON, Pattern::OFF));
}
