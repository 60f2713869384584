//! Changes of mode in flight, and whatever else a master changes in flight: the speed never jumps.

mod rig;

use board::Nanos;
use drive::PowerState::OperationEnabled;
use proptest::prelude::*;
use rig::Rig;

const MODES: [i8; 4] = [1, 3, 6, 8];
const CYCLE: Nanos = Nanos(1_000_000);

const PP: i8 = 1;
const PV: i8 = 3;
const HOMING: i8 = 6;
const CSP: i8 = 8;

/// The objects' ramps, in pulses/s^2; all accelerations are lower than all decelerations.
const ACCELERATION: i32 = 100_000;
const DECELERATION: i32 = 150_000;
const HOMING_RAMP: u32 = 120_000;

fn axis(filter_time: u16) -> Rig {
    let mut rig = Rig::new();
    rig.objects.filter_time = filter_time;
    rig.objects.profile_velocity = 20_000;
    rig.objects.profile_acceleration = ACCELERATION;
    rig.objects.profile_deceleration = DECELERATION;
    rig.objects.homing_speed_fast = 20_000;
    rig.objects.homing_acceleration = HOMING_RAMP;
    rig.objects.homing_method = 18;
    rig
}

/// Ticks, and checks that the speed has changed by no more than the steepest ramp; a tick of rounding is the filter's.
fn tick_within(rig: &mut Rig, steepest: i64) {
    let before = rig.drive.velocity().sub_pulses_per_tick();
    rig.tick();
    let change = rig.drive.velocity().sub_pulses_per_tick() - before;
    assert!(change.abs() <= steepest + 1, "{before} changed by {change}");
}

/// Brings a drive to 20 000 pulses/s in `mode`.
fn running(mode: i8, filter_time: u16) -> Rig {
    let mut rig = axis(filter_time);
    rig.objects.mode = mode;
    rig.objects.target_velocity = 20_000;
    rig.objects.target_position = if mode == CSP { 0 } else { 1_000_000 };
    rig.enable();
    if mode == CSP {
        (1..=200).for_each(|n| rig.cycle(n * 20, CYCLE));
    } else {
        rig.command(0x1F);
        rig.command(0x0F);
        rig.milliseconds(300);
    }
    assert_eq!(rig.pulses_per_second(), 20_000, "mode {mode}");
    rig
}

/// Gives the command of the new mode, with or without the change of mode itself.
fn command(rig: &mut Rig, mode: i8) {
    rig.objects.mode = mode;
    match mode {
        PP => rig.objects.target_position = -5_000,
        PV => rig.objects.target_velocity = -8_000,
        CSP => rig.objects.target_position = -77_777,
        _ => {}
    }
    if mode == CSP {
        rig.drive.synchronize(&rig.objects, Some(CYCLE));
    } else {
        rig.objects.controlword = 0x1F;
    }
}

#[test]
fn the_new_mode_goes_on_from_the_speed_there_is_or_brakes_and_its_command_counts_at_once() {
    for filter_time in [0, 6_400] {
        for from in MODES {
            for to in MODES.into_iter().filter(|to| *to != from) {
                let mut rig = running(from, filter_time);
                command(&mut rig, to);
                // In homing, and from it, the ramp of either mode may be the one; none is steeper than 0x6084.
                for _ in 0..20_000 {
                    tick_within(&mut rig, DECELERATION.into());
                    assert_eq!(rig.objects.mode_display, to);
                    assert_eq!(rig.state(), OperationEnabled);
                }
                match to {
                    PP => assert_eq!((rig.objects.position, rig.status(10)), (-5_000, true), "from {from}"),
                    PV => assert_eq!((rig.pulses_per_second(), rig.status(10)), (-8_000, true), "from {from}"),
                    HOMING => assert_eq!(rig.pulses_per_second(), 20_000, "from {from}: searching"),
                    _ => {
                        // The target came before the axis stood; it follows those that come from now on.
                        assert!(rig.status(12) && !rig.drive.is_moving(), "from {from}");
                        assert_ne!(rig.objects.position, -77_777);
                        let stop = rig.objects.position;
                        rig.cycle(stop + 20, CYCLE);
                        rig.cycle(stop + 20, Nanos(10_000_000));
                        assert_eq!(rig.objects.position, stop + 20);
                    }
                }
            }
        }
    }
}

#[test]
fn without_a_command_of_its_own_the_new_mode_brakes_with_0x6084_or_0x609a() {
    for from in MODES {
        for (to, deceleration) in [
            (PP, DECELERATION),
            (PV, DECELERATION),
            (HOMING, HOMING_RAMP as i32),
            (CSP, DECELERATION),
        ] {
            if to == from {
                continue;
            }
            let mut rig = running(from, 0);
            rig.objects.target_velocity = 0;
            rig.objects.mode = to;
            let ticks = rig.until("standing", |rig| !rig.drive.is_moving()) as i32;
            let expected = 20_000 * 20_000 / deceleration;
            assert!((expected - 2..expected + 220).contains(&ticks), "{from} to {to}: {ticks}");
            rig.milliseconds(10);
            assert!(rig.status(10) && rig.status(12) == (to == PV || to == CSP), "{from} to {to}");
            assert_eq!(rig.objects.statusword & 0x2000, 0);
        }
    }
}

/// What a master does in flight.
#[derive(Clone, Copy, Debug)]
enum Deed {
    SetPoint { target: i32, flags: u16 },
    TargetVelocity(i32),
    Speed(i32),
    Ramps([i32; 2]),
    Controlword(u16),
    Mode(i8),
    FilterTime(u16),
}

fn deeds() -> impl Strategy<Value = Vec<(Deed, usize)>> {
    let ramp = 1_000..ACCELERATION;
    let deed = prop_oneof![
        4 => (-30_000..30_000i32, 0u16..16).prop_map(|(target, bits)| Deed::SetPoint {
            target,
            flags: (bits & 7) << 5 & 0x60 | (bits & 4) << 7 | (bits & 8) << 5,
        }),
        3 => (-60_000..60_000i32).prop_map(Deed::TargetVelocity),
        2 => (0..60_000i32).prop_map(Deed::Speed),
        2 => [ramp.clone(), ramp].prop_map(Deed::Ramps),
        // Halt, disable and take back, quick stop that stays and is taken back.
        3 => prop::sample::select(vec![0x0F, 0x10F, 0x07, 0x02]).prop_map(Deed::Controlword),
        2 => prop::sample::select(vec![PP, PV, HOMING]).prop_map(Deed::Mode),
        1 => (0u16..25_600).prop_map(Deed::FilterTime),
    ];
    prop::collection::vec((deed, 1usize..2_000), 1..25)
}

fn act(rig: &mut Rig, deed: Deed) {
    match deed {
        Deed::SetPoint { target, flags } => {
            rig.objects.target_position = target;
            rig.objects.controlword = 0x0F;
            tick_within(rig, DECELERATION.into());
            rig.objects.controlword = 0x1F | flags;
        }
        Deed::TargetVelocity(velocity) => rig.objects.target_velocity = velocity,
        Deed::Speed(speed) => rig.objects.profile_velocity = speed,
        Deed::Ramps([acceleration, deceleration]) => {
            rig.objects.profile_acceleration = acceleration;
            rig.objects.profile_deceleration = deceleration;
        }
        Deed::Controlword(word) => rig.objects.controlword = word,
        Deed::Mode(mode) => rig.objects.mode = mode,
        Deed::FilterTime(time) => rig.objects.filter_time = time,
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn whatever_is_changed_in_flight_the_speed_changes_by_no_more_than_the_steepest_ramp(deeds in deeds()) {
        let mut rig = axis(0);
        rig.objects.mode = PP;
        rig.objects.quick_stop_option = 6;
        rig.objects.quick_stop_deceleration = DECELERATION;
        // Disabling would free the shaft at once where it stands; a ramp is taken back before its end, or ends standing.
        rig.objects.disable_operation_option = 1;
        rig.enable();
        for (deed, ticks) in deeds {
            act(&mut rig, deed);
            for _ in 0..ticks {
                tick_within(&mut rig, DECELERATION.into());
            }
        }
        // Field, counter and speed have gone the same way.
        let apart = rig.shaft - f64::from(rig.objects.position);
        prop_assert!(apart.abs() < 1.0, "{apart}");
    }
}
