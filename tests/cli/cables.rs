//! Rings, and cables that are cut while drives are served.

use std::fs;
use std::io::{BufRead, BufReader};
use std::process::{Command, Stdio};

use libtest_mimic::Completion;
use tempfile::tempdir;

use super::Case;
use super::program::{Outcome, beside_drives, command, done, end_of, is_installed, run, with_exec};

pub const CASES: &[Case] = &[
    ("an_order_without_a_server_tells_how_to_start_one", || {
        done(an_order_without_a_server_tells_how_to_start_one)
    }),
    ("an_order_that_cannot_be_meant_is_refused", || {
        done(an_order_that_cannot_be_meant_is_refused)
    }),
    ("a_ring_needs_two_interfaces", || done(a_ring_needs_two_interfaces)),
    ("a_file_in_the_place_of_the_socket_is_told_and_stays", || {
        done(a_file_in_the_place_of_the_socket_is_told_and_stays)
    }),
    ("run_takes_orders_and_tells_which_cables_are_cut", || {
        done(run_takes_orders_and_tells_which_cables_are_cut)
    }),
    ("a_command_cuts_cables_and_reaches_the_drives_before_them", || {
        with_exec(a_command_cuts_cables_and_reaches_the_drives_before_them)
    }),
    ("a_command_finds_both_ends_of_a_ring", || {
        with_exec(a_command_finds_both_ends_of_a_ring)
    }),
    (
        "an_interface_that_goes_down_is_a_broken_cable_of_a_ring",
        an_interface_that_goes_down_is_a_broken_cable_of_a_ring,
    ),
];

fn an_order_without_a_server_tells_how_to_start_one() {
    run(["cable", "cut", "1"]).with(2).says(&["--control <PATH>"]);
    let path = "/no/such/socket";
    run(["cable", "--control", path, "list"]).with(1).says(&[
        "no drive server takes orders at",
        "usr2556e run --interface ... --control /no/such/socket",
    ]);
}

fn an_order_that_cannot_be_meant_is_refused() {
    for order in [&["cut"][..], &["cut", "-1"], &["cut", "two"], &["break", "1"], &[]] {
        run(["cable", "--control", "x"].iter().chain(order)).with(2).says(&["--help"]);
    }
}

fn a_ring_needs_two_interfaces() {
    run(["run", "--redundant", "lo"]).with(2).says(&["--interface <IFACE>"]);
    run(["run", "--udp", "--redundant", "lo"]).with(2).says(&["cannot be used with"]);
    run(["run", "--interface", "lo", "--redundant", "lo"])
        .with(1)
        .says(&["two interfaces, not lo twice"]);
}

fn a_file_in_the_place_of_the_socket_is_told_and_stays() {
    let folder = tempdir().unwrap();
    let file = folder.path().join("file");
    fs::write(&file, "precious").unwrap();
    run(["run", "--udp", "127.0.0.1:0", "--control", file.to_str().unwrap()])
        .with(1)
        .says(&["is no socket", "--control PATH"]);
    assert_eq!(fs::read(file).unwrap(), b"precious");
}

fn run_takes_orders_and_tells_which_cables_are_cut() {
    let folder = tempdir().unwrap();
    let path = folder.path().join("control");
    let path = path.to_str().unwrap();
    let mut serving = command(["run", "--udp", "127.0.0.1:0", "--drives", "2", "--control", path])
        .stdout(Stdio::piped())
        .spawn()
        .expect("the program starts");
    let mut lines = BufReader::new(serving.stdout.take().expect("a pipe"))
        .lines()
        .map(|line| line.expect("text"));
    lines.next();
    run(["cable", "--control", path, "cut", "2"]).with(0);
    let told = lines.find(|line| line.starts_with("cable "));
    run(["cable", "--control", path, "cut", "2"])
        .with(1)
        .says(&["cable 2 is cut already"]);
    run(["cable", "--control", path, "cut", "3"])
        .with(1)
        .says(&["there is no cable 3: there are 2"]);
    let second = run(["run", "--udp", "127.0.0.1:0", "--control", path]);
    // Ctrl-C.
    end_of(Command::new("kill").args(["-INT", &serving.id().to_string()])).with(0);
    assert!(serving.wait().expect("an end").success());
    assert_eq!(told.as_deref(), Some("cable 2 (drive 1 to drive 2): cut"));
    second.with(1).says(&["another drive server is controlled by"]);
    assert!(!fs::exists(path).unwrap());
}

fn a_command_cuts_cables_and_reaches_the_drives_before_them() {
    let script = r#"cable() { "$USR2556E" cable "$@"; }; drives() { "$USR2556E" scan | grep -c USR2556E:; }
        cable list; drives; cable cut 3; drives; cable cut 3; echo $?; cable unplug 2; drives; cable repair 3; cable plug 2; drives
        echo "$USR2556E_CONTROL""#;
    let ended = beside_drives(&["--drives", "3"], script)
        .with(0)
        .says(&["usr2556e: cable 3 is cut already"]);
    let lines: Vec<_> = ended.out.lines().collect();
    assert_eq!(
        lines[..lines.len() - 1],
        [
            "cable 1 (interface to drive 1): whole",
            "cable 2 (drive 1 to drive 2): whole",
            "cable 3 (drive 2 to drive 3): whole",
            "3",
            "2",
            "1",
            "1",
            "3",
        ]
    );
    let control = std::path::Path::new(lines[lines.len() - 1]);
    assert!(!control.exists() && !control.parent().unwrap().exists(), "left behind: {control:?}");
}

fn a_command_finds_both_ends_of_a_ring() {
    // The built-in master has one card only, to which no frame comes back in a whole ring.
    let script = r#"echo "$USR2556E_INTERFACE $USR2556E_REDUNDANT_INTERFACE"; grep -c "$USR2556E_REDUNDANT_INTERFACE:" /proc/net/dev
        for cable in 4 2; do "$USR2556E" cable cut $cable; "$USR2556E" scan | grep -c USR2556E:; done"#;
    let ended = beside_drives(&["--ring", "--drives", "3"], script).with(0);
    assert_eq!(ended.out.lines().collect::<Vec<_>>(), ["usr2556e1 usr2556e3", "1", "3", "1"]);
}

fn an_interface_that_goes_down_is_a_broken_cable_of_a_ring() -> Outcome {
    if !is_installed("ip") {
        return Ok(Completion::ignored_with("needs ip (package iproute2) to switch an interface off"));
    }
    with_exec(|| {
        // Waits for a state of a cable, as long as it takes.
        let script = r#"await() { until "$USR2556E" cable list | grep "$1"; do sleep 0.02; done; }
            for end in "$USR2556E_REDUNDANT_INTERFACE" usr2556e2; do
                ip link set $end down; await "cable 3 .* down"; "$USR2556E" scan | grep -c USR2556E:
                ip link set $end up; await "cable 3 .* whole"
            done"#;
        let ended = beside_drives(&["--ring", "--drives", "2"], script).with(0);
        let down = "cable 3 (drive 2 to redundant interface): the interface is down";
        let up = "cable 3 (drive 2 to redundant interface): whole";
        assert_eq!(ended.out.lines().collect::<Vec<_>>(), [down, "2", up, down, "2", up]);
    })
}
