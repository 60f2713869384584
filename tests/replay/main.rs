//! Recorded conversations of masters with drives, held again without a network: what the drives answer now, byte for byte.
//!
//! A capture is made with any master at the drives' end of a wire, which is new drives' whole life from their first frame on:
//! ```text
//! usr2556e exec --record tests/captures/NAME.pcapng -- MASTER...
//! ```
//! The ones here come from
//! ```text
//! ... -- target/python/bin/python tests/python/pysoem_session.py --sessions 1 --parts default clocks --distance 200
//! ... --drives 2 -- target/python/bin/python tests/python/pysoem_session.py --drives 2 --sessions 1 --parts clocks --distance 200
//! ... -- usr2556e move --by 300
//! ... --drives 2 -- usr2556e scan
//! ```
//! and are made anew when drives are meant to answer differently. [`comparison::compare`] says what depends on more than a capture tells.

mod capture;
mod comparison;
mod rerun;

use capture::Capture;
use comparison::{Verdict, compare};
use rerun::{CaughtUp, Rerun, switched_on};

/// SOEM lays the outputs of all drives (7 bytes each) out before their inputs; ethercrab puts the inputs first.
const PYSOEM_ONE_DRIVE: Capture = Capture {
    name: "pysoem-one-drive.pcapng",
    drives: 1,
    inputs: &[7],
    least: 1000,
};

fn check(capture: &Capture) {
    let exchanges = capture.exchanges();
    assert!(
        exchanges.len() >= capture.least,
        "{}: only {} frames",
        capture.name,
        exchanges.len()
    );
    let switched_on = switched_on(capture.drives, &exchanges);
    let mut fully = Rerun::new(capture.drives, switched_on, CaughtUp::Fully);
    let mut hardly = Rerun::new(capture.drives, switched_on, CaughtUp::Hardly);
    let mut exact = 0;
    for (number, exchange) in exchanges.iter().enumerate() {
        let recorded = &exchange.answered;
        let (fully, hardly) = (fully.answer(exchange), hardly.answer(exchange));
        match compare(recorded, &fully, &hardly, capture.inputs) {
            Verdict::Exact => exact += 1,
            Verdict::Between => {}
            Verdict::Different => panic!(
                "{}, frames {} and {}:\nasked    {:02x?}\nrecorded {recorded:02x?}\nanswered {fully:02x?}\nor       {hardly:02x?}",
                capture.name,
                2 * number + 1,
                2 * number + 2,
                exchange.asked
            ),
        }
    }
    let between = exchanges.len() - exact;
    println!(
        "{}: {exact} answers the same in every byte, {between} in every byte but inputs between two ticks",
        capture.name
    );
    assert!(
        between * 20 <= exact,
        "{}: too many inputs depend on the moment: {between} beside {exact}",
        capture.name
    );
}

#[test]
fn pysoem_with_one_drive_gets_the_recorded_answers() {
    check(&PYSOEM_ONE_DRIVE);
}

#[test]
fn pysoem_with_two_drives_and_clocks_gets_the_recorded_answers() {
    check(&Capture {
        name: "pysoem-two-drives.pcapng",
        drives: 2,
        inputs: &[14, 25],
        least: 800,
    });
}

#[test]
fn ethercrab_moving_a_drive_gets_the_recorded_answers() {
    check(&Capture {
        name: "ethercrab-move.pcapng",
        drives: 1,
        inputs: &[0],
        least: 1500,
    });
}

#[test]
fn ethercrab_scanning_two_drives_gets_the_recorded_answers() {
    check(&Capture {
        name: "ethercrab-scan.pcapng",
        drives: 2,
        inputs: &[],
        least: 1300,
    });
}

#[test]
#[should_panic(expected = "recorded")]
fn another_drive_is_noticed() {
    check(&Capture {
        drives: 2,
        ..PYSOEM_ONE_DRIVE
    });
}
