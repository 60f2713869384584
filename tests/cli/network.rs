//! Interfaces and privileges: every message tells what to type.

use std::process::Command;

use libtest_mimic::Completion;

use super::Case;
use super::program::{Outcome, beside_drives, done, end_of, is_installed, path, run, with_exec};
use super::serving::Serving;

pub const CASES: &[Case] = &[
    ("an_interface_that_is_not_there_lists_the_others", || {
        done(an_interface_that_is_not_there_lists_the_others)
    }),
    ("an_interface_that_is_down_is_told", an_interface_that_is_down_is_told),
    ("a_second_server_on_an_interface_names_the_first", || {
        with_exec(a_second_server_on_an_interface_names_the_first)
    }),
    ("a_missing_privilege_names_the_ways_out", a_missing_privilege_names_the_ways_out),
    ("drives_are_served_and_led_over_udp", || done(drives_are_served_and_led_over_udp)),
    ("an_address_that_cannot_be_served_is_told", || {
        done(an_address_that_cannot_be_served_is_told)
    }),
    ("a_silent_interface_is_told", || with_exec(a_silent_interface_is_told)),
];

fn an_interface_that_is_not_there_lists_the_others() {
    for arguments in [&["run"][..], &["scan"], &["sdo", "read", "6041"], &["move", "--by", "1"]] {
        let interface = ["--interface", "no-such-one"];
        let arguments = arguments[..1].iter().chain(&interface).chain(&arguments[1..]);
        run(arguments).with(1).says(&[
            "no network interface \"no-such-one\"",
            "Existing ones: ",
            "lo",
            "sudo ip link add veth-drive type veth",
        ]);
    }
}

fn an_interface_that_is_down_is_told() -> Outcome {
    if !is_installed("ip") {
        return Ok(Completion::ignored_with("needs ip (package iproute2) to switch an interface off"));
    }
    with_exec(|| {
        let script = r#"ip link set lo down && "$USR2556E" run --interface lo"#;
        beside_drives(&[], script)
            .with(1)
            .says(&["\"lo\" is down", "sudo ip link set lo up"]);
    })
}

fn a_second_server_on_an_interface_names_the_first() {
    let script = r#"echo "kill $PPID"; "$USR2556E" run --interface usr2556e0"#;
    let ended = beside_drives(&[], script)
        .with(1)
        .says(&["another drive server", "already running", "--interface"]);
    let kill = ended.out.lines().next().expect("a line").to_owned();
    ended.says(&[&kill]);
}

fn a_missing_privilege_names_the_ways_out() -> Outcome {
    let is_root = end_of(Command::new("id").arg("-u")).out.trim() == "0";
    if is_root && !is_installed("setpriv") {
        return Ok(Completion::ignored_with(
            "needs setpriv (package util-linux) to give root's rights up",
        ));
    }
    for arguments in [["run", "--interface", "lo"], ["scan", "--interface", "lo"]] {
        let ended = if is_root {
            end_of(
                Command::new("setpriv")
                    .args(["--bounding-set=-all", "--inh-caps=-all", "--"])
                    .arg(path())
                    .args(arguments),
            )
        } else {
            run(arguments)
        };
        if !is_root && !ended.err.contains("no permission") {
            return Ok(Completion::ignored_with("this user may use raw Ethernet, or lo is down"));
        }
        let program = path().display();
        ended.with(1).says(&[
            "no permission",
            &format!("sudo {program} {}", arguments.join(" ")),
            &format!("sudo setcap cap_net_raw+ep {program}"),
            &format!("{program} exec --drives 1 -- COMMAND"),
        ]);
    }
    Ok(Completion::Completed)
}

fn drives_are_served_and_led_over_udp() {
    let serving = Serving::over_udp(&["--drives", "2"]);
    let address = serving.address.as_str();
    assert_eq!(serving.line, format!("Serving 2 drives on UDP {address}; Ctrl-C ends.\n"));
    run(["scan", "--udp", address])
        .with(0)
        .prints(&["serial number 1", "serial number 2"]);
    run(["sdo", "--udp", address, "--drive", "2", "write", "2000", "2500"])
        .with(0)
        .prints(&["2500"]);
    run(["run", "--udp", address]).with(1).says(&["is in use", "--udp ADDRESS:PORT"]);
}

fn an_address_that_cannot_be_served_is_told() {
    run(["run", "--udp", "192.0.2.1:34980"])
        .with(1)
        .says(&["no address of this computer", "0.0.0.0:34980"]);
    run(["run", "--udp", "here"]).with(2).says(&["invalid value 'here'"]);
    run(["run"]).with(2).says(&["--interface"]);
}

fn a_silent_interface_is_told() {
    beside_drives(&[], r#""$USR2556E" scan --interface lo"#)
        .with(1)
        .says(&["lo", "cable and supply", "usr2556e run --interface"]);
}
