//! RUN and ERR LED in 0x0138 and 0x0139, and the device's identification in 0x0134.

use wire::Nanos;
use wire::indicator::Pattern;
use wire::register as reg;

use crate::workbench::{Bench, MILLISECOND};

fn leds(bench: &Bench) -> (u8, u8) {
    (bench.chip.byte(reg::RUN_LED), bench.chip.byte(reg::ERR_LED))
}

// manual: 1.4.1/run 1.4.1/err-off
#[test]
fn the_run_led_shows_the_state() {
    let mut bench = Bench::op();
    assert_eq!(leds(&bench), (0x1F, 0x10), "on");
    for (control, run) in [(4, 0x11), (2, 0x1D), (1, 0x10)] {
        bench.request(control);
        assert_eq!(leds(&bench), (run, 0x10), "state {control}");
    }
}

// manual: 1.4.1/err-off 1.4.1/err-general 1.4.1/err-sync 1.4.1/err-watchdog
#[test]
fn the_err_led_shows_why_until_the_error_is_acknowledged() {
    let mut refused = Bench::preop();
    assert_eq!(refused.request(8), (0x12, 0x11));
    assert_eq!(leds(&refused), (0x1D, 0x1D), "a request was refused: blinking");
    refused.request(0x12);
    assert_eq!(leds(&refused), (0x1D, 0x10));

    let mut no_outputs = Bench::safeop();
    no_outputs.request(8);
    no_outputs.advance(9000 * MILLISECOND);
    assert_eq!((no_outputs.chip.code(), leds(&no_outputs)), (0x1B, (0x11, 0x12)));

    let mut watchdog = Bench::op();
    watchdog.chip.expire_watchdog();
    watchdog.tick();
    assert_eq!((watchdog.chip.code(), leds(&watchdog)), (0x1B, (0x11, 0x12)), "double flash");

    let mut sync = Bench::op_with_sync0();
    sync.advance(10 * MILLISECOND);
    assert_eq!((sync.chip.code(), leds(&sync)), (0x2C, (0x11, 0x11)), "single flash");

    let mut moved = Bench::safeop();
    moved.set_process_data(4, 6);
    moved.tick();
    assert_eq!(
        (moved.chip.code(), leds(&moved)),
        (0x1D, (0x1D, 0x11)),
        "left by itself: single flash"
    );
}

#[test]
fn the_alias_is_shown_as_identification_while_it_is_asked_for() {
    let mut bench = Bench::preop();
    bench.chip.set(reg::STATION_ALIAS, &[0xE9, 0x03]);
    assert_eq!(bench.request(0x22), (0x22, 1001));
    assert_eq!(bench.request(0x02), (0x02, 0));
    bench.set_process_data(3, 6);
    assert_eq!(bench.request(0x24), (0x24, 1001), "together with a change of state");
    bench.request(0x28);
    bench.chip.outputs(&[1, 0, 2]);
    bench.tick();
    assert_eq!((bench.chip.status(), bench.chip.code()), (0x28, 1001), "also when OP comes later");
}

#[test]
fn an_error_goes_before_the_identification() {
    let mut bench = Bench::preop();
    bench.chip.set(reg::STATION_ALIAS, &[0xE9, 0x03]);
    assert_eq!(bench.request(0x28), (0x12, 0x11));
    assert_eq!(bench.request(0x22), (0x12, 0x11), "not acknowledged: nothing changes");
    assert_eq!(bench.request(0x32), (0x22, 1001));
    bench.set_mailboxes(20);
    bench.tick();
    assert_eq!((bench.chip.status(), bench.chip.code()), (0x11, 0x16));
}

fn shown(bench: &mut Bench) -> (Pattern, Pattern) {
    let leds = bench.slave.leds(&mut bench.chip, Nanos(bench.now));
    (leds.run.pattern(), leds.err.pattern())
}

#[test]
fn both_leds_can_be_driven_from_the_stack() {
    let mut bench = Bench::new();
    assert_eq!(shown(&mut bench), (Pattern::OFF, Pattern::OFF), "INIT");
    bench = Bench::preop();
    bench.now = 330 * MILLISECOND;
    assert_eq!(shown(&mut bench), (Pattern::BLINKING, Pattern::OFF));
    let mut lit = |ms: u64| {
        bench
            .slave
            .leds(&mut bench.chip, Nanos(ms * MILLISECOND))
            .run
            .is_lit(Nanos(ms * MILLISECOND))
    };
    assert_eq!([330, 529, 530, 729, 730].map(&mut lit), [true, true, false, false, true]);
    bench.request(8);
    assert_eq!(shown(&mut bench), (Pattern::BLINKING, Pattern::BLINKING), "a refused request");
}

#[test]
fn the_master_can_make_the_leds_show_something_else() {
    let mut bench = Bench::preop();
    bench.chip.set(reg::RUN_LED, &[0x1E, 0x13]);
    assert_eq!(shown(&mut bench), (Pattern::FLICKERING, Pattern::from_code(3)));
    bench.chip.set(reg::RUN_LED, &[0x0E, 0x03]);
    assert_eq!(
        shown(&mut bench),
        (Pattern::BLINKING, Pattern::OFF),
        "without the override bit, the stack's own"
    );
    bench.chip.set(reg::RUN_LED, &[0x1F, 0x1F]);
    bench.request(1);
    assert_eq!(shown(&mut bench), (Pattern::OFF, Pattern::OFF), "until the state changes");
}
