//! Cables that are cut and repaired under SOEM in OP: `tests/python/ring.py` checks what becomes of the drives.

use tempfile::tempdir;
use usr2556e::link::pcap::read_pcapng;

use super::Case;
use super::python::{exec, exec_recorded, outcome, script};

pub const CASES: &[Case] = &[
    ("pysoem_leads_a_ring_whichever_cable_is_cut", || {
        outcome(a_ring_whichever_cable_is_cut())
    }),
    ("pysoem_takes_back_the_drives_behind_a_cut_in_a_line", || {
        outcome(the_drives_behind_a_cut_in_a_line())
    }),
];

fn a_ring_whichever_cable_is_cut() -> Result<(), String> {
    let folder = tempdir().expect("a folder");
    let capture = folder.path().join("ring.pcapng");
    let script = script("pysoem", "ring.py", &["ring"])?;
    let session = exec_recorded(&capture, &["--ring", "--drives", "3"], script, 2000)?;
    session.with(0).prints(&["OK   cut 2", "OK   repair 4", "OK   everything"]);

    let packets = read_pcapng(&capture).expect("a whole capture");
    for interface in 0..2 {
        let frames = packets.iter().filter(|packet| packet.interface == interface).count();
        assert!(frames > 1000, "only {frames} frames on interface {interface}");
    }
    Ok(())
}

fn the_drives_behind_a_cut_in_a_line() -> Result<(), String> {
    let session = exec(&["--drives", "3"], script("pysoem", "ring.py", &["line"])?, 2000)?;
    session.with(0).prints(&[
        "OK   working counter with cable 2 cut = 3",
        "OK   states after the repair",
        "OK   everything",
    ]);
    Ok(())
}
