//! `usr2556e motor`, and the motor of a drive.

use std::fs;

use tempfile::tempdir;

use super::Case;
use super::program::{done, run};

pub const CASES: &[Case] = &[
    ("named_motors_are_listed", || done(named_motors_are_listed)),
    ("a_motor_shows_its_values_and_what_follows", || {
        done(a_motor_shows_its_values_and_what_follows)
    }),
    ("a_named_motor_written_as_a_file_is_the_same_motor", || {
        done(a_named_motor_written_as_a_file_is_the_same_motor)
    }),
    ("a_motor_that_is_none_is_refused", || done(a_motor_that_is_none_is_refused)),
    ("mistakes_in_a_motors_file_are_told_with_their_lines", || {
        done(mistakes_in_a_motors_file_are_told_with_their_lines)
    }),
    ("pull_out_leaves_a_table_and_a_picture", || {
        done(pull_out_leaves_a_table_and_a_picture)
    }),
    ("a_picture_that_cannot_be_written_is_told_first", || {
        done(a_picture_that_cannot_be_written_is_told_first)
    }),
    ("the_demonstration_takes_another_motor", || {
        done(the_demonstration_takes_another_motor)
    }),
    ("impossible_supplies_and_loads_are_refused", || {
        done(impossible_supplies_and_loads_are_refused)
    }),
];

fn named_motors_are_listed() {
    run(["motor", "list"]).with(0).prints(&[
        "qsh5718-56",
        "three-phase-57",
        "1.26 Nm",
        "3.96 A",
        "0.90 ohm",
        "2.50 mH",
        "300 gcm2",
    ]);
}

fn a_motor_shows_its_values_and_what_follows() {
    run(["motor", "show", "qsh5718-56"]).with(0).prints(&[
        "0.318 V s/rad",
        "electrical time constant      2.7778 ms",
        "natural frequency, 3.96 A      230.6 Hz",
        "24 V     5.6",
    ]);
}

fn a_named_motor_written_as_a_file_is_the_same_motor() {
    let folder = tempdir().unwrap();
    let file = folder.path().join("copy.toml");
    let shown = run(["motor", "show", "as1050"]).with(0).out;
    fs::write(&file, run(["motor", "show", "as1050", "--toml"]).with(0).out).unwrap();
    assert_eq!(run(["motor", "show", file.to_str().unwrap()]).with(0).out, shown);
}

fn a_motor_that_is_none_is_refused() {
    run(["motor", "show", "as1011"])
        .with(2)
        .says(&["there is no motor `as1011`; did you mean `as1010`?"]);
    run(["run", "--interface", "lo", "--motor", "no/such/file.toml"])
        .with(2)
        .says(&["--motor", "cannot open the motor's file no/such/file.toml"]);
}

fn mistakes_in_a_motors_file_are_told_with_their_lines() {
    let folder = tempdir().unwrap();
    let file = folder.path().join("motor.toml");
    fs::write(
        &file,
        "[motor]\nresistance_ohm = 900\ninductance_mh = 2500\npeak_current_a = 3.96\nholding_torque_nm = 1.26\n",
    )
    .unwrap();
    run(["motor", "show", file.to_str().unwrap()]).with(2).says(&[
        "line 1: `rotor_inertia_gcm2` is missing",
        "line 2: `resistance_ohm` is 900, and 0.01 to 100 ohm are possible; did you mean resistance_mohm = 900?",
        "line 3: `inductance_mh` is 2500, and 0.02 to 200 mH are possible; did you mean inductance_uh = 2500?",
    ]);
}

fn pull_out_leaves_a_table_and_a_picture() {
    let folder = tempdir().unwrap();
    let picture = folder.path().join("torque.svg");
    let arguments = [
        "motor",
        "pull-out",
        "as1050",
        "--supply",
        "24",
        "--current",
        "4",
        "--points",
        "3",
        "--output",
    ];
    let ended = run(arguments.into_iter().chain([picture.to_str().unwrap()])).with(0);
    ended.prints(&["as1050: 24 V, 4.00 A peak, load 0 g cm^2", "closed form  simulated", "not reached"]);
    assert!(fs::read_to_string(picture).unwrap().contains("closed form"));
}

fn a_picture_that_cannot_be_written_is_told_first() {
    let ended = run(["motor", "pull-out", "as1010", "--output", "/no/such/folder/torque.svg"]).with(1);
    assert_eq!(ended.out, "");
    ended.says(&["cannot write /no/such/folder/torque.svg; choose another file with --output FILE.svg"]);
}

fn the_demonstration_takes_another_motor() {
    let folder = tempdir().unwrap();
    let demonstration = [
        "--lock-step",
        "--motor",
        "three-phase-57",
        "--supply",
        "48",
        "--load-inertia",
        "100",
        "--output",
    ];
    run(demonstration.into_iter().chain([folder.path().to_str().unwrap()]))
        .with(0)
        .prints(&["ended at 30000 pulses", "no step lost"]);
}

fn impossible_supplies_and_loads_are_refused() {
    for (option, value) in [
        ("--supply", "9"),
        ("--supply", "NaN"),
        ("--load-inertia", "-1"),
        ("--load-inertia", "1e9"),
    ] {
        run(["run", "--interface", "lo", &format!("{option}={value}")])
            .with(2)
            .says(&[option, value, "a number from"]);
    }
    run(["motor", "pull-out", "as1010", "--supply", "60"])
        .with(2)
        .says(&["a number from 18 to 50"]);
    run(["motor", "pull-out", "as1010", "--current", "7"])
        .with(2)
        .says(&["a number from 0.1 to 6"]);
}
