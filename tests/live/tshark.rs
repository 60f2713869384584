//! Wireshark's dissector on captures: no frame may be malformed.

use std::path::Path;
use std::process::{Command, Stdio};

use libtest_mimic::Completion;
use tempfile::tempdir;

use super::Case;
use super::program::{Outcome, end_of, is_installed, run};
use super::pysoem;

pub const CASES: &[Case] = &[
    ("every_frame_of_a_pysoem_session_passes_tshark", || {
        with_tshark(every_frame_of_a_pysoem_session)
    }),
    ("every_frame_of_the_demonstration_passes_tshark", || {
        with_tshark(every_frame_of_the_demonstration)
    }),
];

fn with_tshark(test: fn() -> Outcome) -> Outcome {
    if is_installed("tshark") {
        test()
    } else {
        Ok(Completion::ignored_with("needs tshark (package tshark)"))
    }
}

fn every_frame_of_a_pysoem_session() -> Outcome {
    let folder = tempdir()?;
    let capture = folder.path().join("session.pcapng");
    if let Err(reason) = pysoem::recorded_session(&capture) {
        return Ok(Completion::ignored_with(reason));
    }
    // Bring-up and some 300 cycles of process data, in both directions.
    check(&capture, 1000);
    Ok(Completion::Completed)
}

fn every_frame_of_the_demonstration() -> Outcome {
    let folder = tempdir()?;
    run(["--lock-step", "--output", &folder.path().display().to_string()]).with(0);
    check(&folder.path().join("usr2556e-demo.pcapng"), 10_000);
    Ok(Completion::Completed)
}

/// Checks that there are at least so many EtherCAT frames, and that the dissector has no complaint about any.
pub fn check(capture: &Path, least: usize) {
    let frames = listed(capture, "eth.type == 0x88a4");
    assert!(frames.len() >= least, "only {} frames", frames.len());
    let complaint = "_ws.malformed || _ws.short || _ws.expert.severity == 8388608";
    let malformed = listed(capture, &format!("eth.type == 0x88a4 && ({complaint})"));
    assert!(malformed.is_empty(), "{}", malformed.join("\n"));
}

/// The frames of a capture that a filter lets pass, a line each.
fn listed(capture: &Path, filter: &str) -> Vec<String> {
    let fields = ["frame.number", "_ws.col.Info", "_ws.expert.message"]
        .map(|field| ["-e", field])
        .concat();
    let mut tshark = Command::new("tshark");
    tshark
        .args(["-n", "-Y", filter, "-T", "fields"])
        .args(fields)
        .arg("-r")
        .arg(capture);
    let ended = end_of(tshark.stdin(Stdio::null())).with(0);
    ended.out.lines().map(str::to_owned).collect()
}
