//! Every homing method in both variants, from every side of every switch and at several speeds: legs, edges, speeds and status bits, and
//! home at the deciding edge to the pulse.

mod expected;
#[path = "../rig/mod.rs"]
mod rig;
mod run;

use drive::PowerState;
use expected::{Legs, legs_from, methods, starts};
use rig::Rig;
use run::{DONE, IDLE, Moment, OFFSET, PACE, Pace, RUNNING, follow, ready, ready_at, record};

/// Homes with every method from every start, and checks all there is to see.
fn check(pace: &Pace) {
    let ready = ready(pace);
    for (variant, method, kinds) in methods() {
        for start in starts(&pace.axis) {
            std::println!("variant {variant}, method {method} from {start}, {pace:?}");
            let mut rig = ready_at(&ready, start, variant, method);
            let moments = record(&mut rig);
            let legs = legs_from(start, &pace.axis, method, &kinds);
            let seen = follow(&moments, &legs, pace);
            check_bits(&moments, seen);

            let home = rig.shaft - f64::from(rig.objects.position - OFFSET);
            assert!((home - f64::from(moments[seen].pulse)).abs() < 1e-3, "home at {home}");
            let late = pace.past(legs.last().unwrap(), &moments[seen]);
            let delay = &moments[seen - 1 - usize::from(pace.filter)..seen];
            let explained = pace.delay(delay.iter().map(|moment| moment.velocity.unsigned_abs()).max().unwrap());
            assert!(
                (-1e-6..=explained + 1e-6).contains(&late),
                "{late} pulses late, {explained} explained"
            );
            assert_ne!(rig.objects.status_code & 0x10, 0);
        }
    }
}

/// Running until the edge is seen, for 10 ms at least; then attained, with bit 10 once the axis stands.
fn check_bits(moments: &[Moment], seen: usize) {
    for (tick, moment) in moments.iter().enumerate() {
        let standing = tick + 1 == moments.len();
        let expected = if tick < seen.max(199) { RUNNING } else { (false, true, standing) };
        assert_eq!(moment.bits, expected, "tick {tick}, edge seen in {seen}");
        assert!(tick < seen || standing || moment.velocity != 0 || tick < 199);
    }
}

// manual: 2.2.25/variant 2.4.6.1/17 2.4.6.1/18 2.4.6.1/19 2.4.6.1/20 2.4.6.1/21 2.4.6.1/22 2.4.6.1/23 2.4.6.1/24 2.4.6.1/25
// manual: 2.4.6.1/26 2.4.6.1/27 2.4.6.1/28 2.4.6.1/29 2.4.6.1/30 2.4.6.2/17 2.4.6.2/18 2.4.6.2/19 2.4.6.2/20 2.4.6.2/21
// manual: 2.4.6.2/22 2.4.6.2/23 2.4.6.2/24 2.4.6.2/25 2.4.6.2/26 2.4.6.2/27 2.4.6.2/28 2.4.6.2/29 2.4.6.2/30
#[test]
fn every_method_goes_by_its_legs_from_every_start() {
    check(&PACE);
}

#[test]
fn slow_may_be_faster_than_fast_or_the_same() {
    check(&Pace {
        fast: 2_000,
        slow: 8_000,
        ..PACE
    });
    check(&Pace {
        fast: 3_000,
        slow: 3_000,
        ..PACE
    });
}

#[test]
fn far_overruns_and_speeds_of_a_few_pulses_do_not_mislead_it() {
    check(&Pace {
        fast: 60_000,
        slow: 1_000,
        ..PACE
    });
    check(&Pace {
        fast: 100,
        slow: 20,
        axis: [-6, 0, 5, 11],
        ..PACE
    });
}

#[test]
fn the_input_filter_delays_each_edge_by_its_time() {
    check(&Pace { filter: 60, ..PACE });
    check(&Pace {
        fast: 1_000,
        slow: 4_000,
        filter: 7,
        ..PACE
    });
}

/// Where home may lie, whatever happened before: at the edge of the method's last leg, passed at no more than `pace.fast`.
fn assert_home(rig: &Rig, kinds: &[Legs], pace: &Pace) {
    let last = kinds[0].last().unwrap();
    let home = rig.shaft - f64::from(rig.objects.position - OFFSET);
    let off = home - f64::from(pace.axis[last.edge.place]);
    assert!(off.abs() <= pace.delay(pace.fast) + 1.0, "home is {off} pulses off");
}

#[test]
fn a_switch_narrower_than_the_overrun_and_the_filter_is_left_by_its_proper_edge() {
    for width in (31..200).step_by(7) {
        let pace = Pace {
            axis: [-600, 0, width, 800],
            filter: 60,
            ..PACE
        };
        let mut ready = ready(&pace);
        ready.objects.quick_stop_deceleration = 1_000_000;
        // With the motion filter as delivered, and without it.
        ready.objects.filter_time = if width % 2 == 0 { 6_400 } else { 0 };
        for (variant, method, kinds) in methods().into_iter().filter(|(_, method, _)| *method > 18) {
            for start in [-250, width / 2, width + 250] {
                std::println!("width {width}, variant {variant}, method {method} from {start}");
                let mut rig = ready_at(&ready, start, variant, method);
                record(&mut rig);
                assert_eq!(rig.homing_bits(), DONE);
                assert_home(&rig, &kinds, &pace);
            }
        }
    }
}

/// A way to end homing before it is over, and back to where it can be started again.
type Interruption = (&'static str, fn(&mut Rig), fn(&mut Rig));

const INTERRUPTIONS: [Interruption; 6] = [
    ("halt", |rig| rig.command(0x11F), |_| {}),
    ("mode", |rig| rig.objects.mode = 1, |rig| rig.objects.mode = 6),
    ("quick stop", |rig| rig.command(0x0B), Rig::enable),
    ("disabling", |rig| rig.command(0x07), Rig::enable),
    ("shutdown", |rig| rig.command(0x06), Rig::enable),
    ("disabling voltage", |rig| rig.command(0x00), Rig::enable),
];

#[test]
fn every_method_can_be_interrupted_anywhere_and_started_again() {
    let ready = ready(&PACE);
    for (variant, method, kinds) in methods() {
        for start in [-150, 50, 250] {
            let case = ready_at(&ready, start, variant, method);
            let ticks = record(&mut case.clone()).iter().filter(|moment| moment.bits == RUNNING).count();
            for (name, interrupt, resume) in INTERRUPTIONS {
                for part in [1, 5, 9] {
                    std::println!("variant {variant}, method {method} from {start}: {name} in tick {part}/10 of {ticks}");
                    let mut rig = case.clone();
                    rig.objects.controlword = 0x1F;
                    rig.ticks(ticks * part / 10 + 1);
                    // Home may be there already, but for the time that it is shown as running.
                    if rig.objects.status_code & 0x10 != 0 {
                        continue;
                    }
                    interrupt_and_resume(&mut rig, interrupt, resume);
                    let moments = record(&mut rig);
                    assert_eq!(moments[0].bits, RUNNING);
                    assert_eq!(rig.homing_bits(), DONE);
                    assert_home(&rig, &kinds, &PACE);
                }
            }
        }
    }
}

fn interrupt_and_resume(rig: &mut Rig, interrupt: fn(&mut Rig), resume: fn(&mut Rig)) {
    interrupt(rig);
    rig.tick();
    while rig.drive.is_moving() {
        assert!(rig.objects.mode != 6 || rig.homing_bits() == RUNNING, "neither attained nor failed");
        rig.tick();
    }
    rig.ticks(2);
    let counter = rig.objects.position;
    resume(rig);
    rig.command(0x0F);
    rig.milliseconds(20);
    assert_eq!((rig.state(), rig.homing_bits()), (PowerState::OperationEnabled, IDLE));
    assert_eq!(
        (rig.objects.position, rig.objects.status_code & 0x10),
        (counter, 0),
        "it does not go on by itself"
    );
}
