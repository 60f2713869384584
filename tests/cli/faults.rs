//! Windings, motor and supply that break while drives are served.

use super::Case;
use super::program::{beside_drives, done, run, with_exec};

pub const CASES: &[Case] = &[
    ("a_breakdown_that_cannot_be_meant_is_refused", || {
        done(a_breakdown_that_cannot_be_meant_is_refused)
    }),
    ("a_command_breaks_lists_and_mends", || with_exec(a_command_breaks_lists_and_mends)),
    ("a_supply_that_sags_is_seen_by_the_master", || {
        with_exec(a_supply_that_sags_is_seen_by_the_master)
    }),
    ("a_move_over_a_broken_cable_ends_with_the_faults_name", || {
        with_exec(a_move_over_a_broken_cable_ends_with_the_faults_name)
    }),
];

fn a_breakdown_that_cannot_be_meant_is_refused() {
    for order in [
        &["open-c"][..],
        &["supply"],
        &["supply", "1000"],
        &["supply", "nan"],
        &["open-a", "--drive", "0"],
        &[],
    ] {
        run(["fault", "--control", "x"].iter().chain(order)).with(2).says(&["--help"]);
    }
}

fn a_command_breaks_lists_and_mends() {
    let script = r#"fault() { "$USR2556E" fault "$@"; }
        fault stuck-rotor; fault supply 3.5; fault open-b --drive 2; fault list; fault mend; fault list; fault mend --drive 3; echo $?"#;
    let ended = beside_drives(&["--drives", "2"], script)
        .with(0)
        .says(&["usr2556e: there is no drive 3: there are 2, counted from 1"]);
    assert_eq!(
        ended.out.lines().collect::<Vec<_>>(),
        [
            "drive 1: stuck-rotor, supply 3500",
            "drive 2: open-b",
            "drive 1: whole",
            "drive 2: open-b",
            "1",
        ]
    );
}

fn a_supply_that_sags_is_seen_by_the_master() {
    // In 10 mV; the capacitors keep their voltage for a while.
    let script = r#"voltage() { "$USR2556E" sdo read 2048 | grep -o '\b[0-9]\{4\}\b' | tail -1; }
        voltage; "$USR2556E" fault supply -10; while [ "$(voltage)" -gt 2700 ]; do :; done; voltage
        "$USR2556E" fault mend; while [ "$(voltage)" -lt 3500 ]; do :; done; voltage"#;
    let ended = beside_drives(&[], script).with(0);
    let volts: Vec<u32> = ended.out.lines().map(|line| line.parse().unwrap()).collect();
    assert_eq!(volts.len(), 3, "{volts:?}");
    assert!(
        (3_500..3_700).contains(&volts[0]) && (2_500..2_700).contains(&volts[1]) && (3_500..3_700).contains(&volts[2]),
        "{volts:?}"
    );
}

fn a_move_over_a_broken_cable_ends_with_the_faults_name() {
    let script = r#""$USR2556E" fault open-a; "$USR2556E" move --by 1000; echo "exit $?"
        "$USR2556E" fault mend; "$USR2556E" move --by 1000"#;
    let ended = beside_drives(&[], script)
        .with(0)
        .says(&["the drive went into fault 0x7122: phase loss"]);
    assert_eq!(ended.out.lines().next(), Some("exit 1"));
    assert!(ended.out.contains("Moved from 0 to 1000 pulses."), "{}", ended.out);
}
