//! What cannot be meant: exit status 2, as every command line has it, and a word on what was expected.

use super::Case;
use super::program::{done, run};

pub const CASES: &[Case] = &[
    ("an_unknown_flag_is_named", || done(an_unknown_flag_is_named)),
    ("an_unknown_command_is_named", || done(an_unknown_command_is_named)),
    ("exec_without_a_command_asks_for_one", || done(exec_without_a_command_asks_for_one)),
    ("a_missing_interface_option_is_asked_for", || {
        done(a_missing_interface_option_is_asked_for)
    }),
    ("no_drives_or_too_many_are_refused", || done(no_drives_or_too_many_are_refused)),
    ("impossible_drifts_and_losses_are_refused", || {
        done(impossible_drifts_and_losses_are_refused)
    }),
    ("a_move_needs_one_target", || done(a_move_needs_one_target)),
    ("an_address_that_is_none_is_refused", || done(an_address_that_is_none_is_refused)),
    ("help_lists_every_command", || done(help_lists_every_command)),
];

fn an_unknown_flag_is_named() {
    run(["--frobnicate"]).with(2).says(&["'--frobnicate'", "Usage:", "--help"]);
    run(["run", "--interface", "lo", "--frobnicate"])
        .with(2)
        .says(&["'--frobnicate'", "Usage:"]);
}

fn an_unknown_command_is_named() {
    run(["frobnicate"]).with(2).says(&["'frobnicate'", "Usage:"]);
}

fn exec_without_a_command_asks_for_one() {
    run(["exec", "--drives", "1"]).with(2).says(&["<COMMAND>", "Usage:"]);
    run(["exec", "--"]).with(2).says(&["<COMMAND>"]);
}

fn a_missing_interface_option_is_asked_for() {
    for arguments in [&["run"][..], &["scan"], &["sdo", "read", "6041"], &["move", "--by", "1"]] {
        run(arguments).with(2).says(&["--interface <IFACE>"]);
    }
}

fn no_drives_or_too_many_are_refused() {
    for drives in ["0", "1001", "-1", "many"] {
        run(["run", "--interface", "lo", &format!("--drives={drives}")])
            .with(2)
            .says(&["--drives", drives]);
    }
}

fn impossible_drifts_and_losses_are_refused() {
    for (option, value) in [
        ("--clock-drift", "-1"),
        ("--clock-drift", "1001"),
        ("--clock-drift", "NaN"),
        ("--lose", "100.1"),
        ("--lose", "some"),
    ] {
        run(["run", "--interface", "lo", &format!("{option}={value}")])
            .with(2)
            .says(&[option, value, "a number from 0 to"]);
    }
    run(["run", "--interface", "lo", "--seed", "1"]).with(2).says(&["--lose"]);
}

fn a_move_needs_one_target() {
    run(["move", "--interface", "lo"]).with(2).says(&["--to", "--by"]);
    run(["move", "--interface", "lo", "--to", "1", "--by", "1"])
        .with(2)
        .says(&["--to", "--by"]);
    run(["move", "--interface", "lo", "--to", "2147483648"])
        .with(2)
        .says(&["2147483648"]);
}

fn an_address_that_is_none_is_refused() {
    run(["sdo", "--interface", "lo", "read", "position"]).with(2).says(&["position"]);
}

fn help_lists_every_command() {
    run(["--help"]).with(0).prints(&[
        "run",
        "exec",
        "cable",
        "fault",
        "motor",
        "tune",
        "scan",
        "sdo",
        "move",
        "esi",
        "sii",
        "--output",
        "--lock-step",
        "--motor",
        "--supply",
        "--load-inertia",
    ]);
}
