//! Wireshark's dissector on captures: no frame may be malformed.

use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};

use libtest_mimic::Completion;
use tempfile::tempdir;

use super::Case;
use super::program::{Outcome, beside_drives, end_of, is_installed, run};

pub const CASES: &[Case] = &[
    ("every_frame_of_the_demonstration_passes_tshark", || {
        with_tshark(every_frame_of_the_demonstration)
    }),
    ("every_frame_of_the_programs_own_master_passes_tshark", || {
        with_tshark(every_frame_of_the_programs_own_master)
    }),
    ("every_frame_of_the_captures_for_replay_passes_tshark", || {
        with_tshark(every_frame_of_the_captures_for_replay)
    }),
];

/// Whether there is a dissector.
pub fn is_here() -> bool {
    is_installed("tshark")
}

fn with_tshark(test: fn() -> Outcome) -> Outcome {
    if is_here() {
        test()
    } else {
        Ok(Completion::ignored_with("needs tshark (package tshark)"))
    }
}

fn every_frame_of_the_demonstration() -> Outcome {
    let folder = tempdir()?;
    run(["--lock-step", "--output", &folder.path().display().to_string()]).with(0);
    check(&folder.path().join("usr2556e-demo.pcapng"), 10_000);
    Ok(Completion::Completed)
}

fn every_frame_of_the_programs_own_master() -> Outcome {
    if let Some(reason) = super::program::forbidden(&run(["exec", "--", "true"])) {
        return Ok(Completion::ignored_with(reason));
    }
    let folder = tempdir()?;
    let capture = folder.path().join("own.pcapng");
    let script =
        r#""$USR2556E" scan && "$USR2556E" sdo --drive 2 write 2000 2500 && ! "$USR2556E" sdo read 605D && "$USR2556E" move --by 500"#;
    beside_drives(&["--drives", "2", "--record", &capture.display().to_string()], script).with(0);
    check(&capture, 2000);
    Ok(Completion::Completed)
}

fn every_frame_of_the_captures_for_replay() -> Outcome {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("captures");
    let mut captures = 0;
    for entry in fs::read_dir(folder)? {
        check(&entry?.path(), 500);
        captures += 1;
    }
    assert!(captures > 0);
    Ok(Completion::Completed)
}

/// Checks that there are at least so many EtherCAT frames, and that the dissector has no complaint about any.
pub fn check(capture: &Path, least: usize) {
    let fields = ["frame.number", "_ws.col.Info", "_ws.malformed", "_ws.short", "_ws.expert.severity"];
    let mut tshark = Command::new("tshark");
    tshark
        .args(["-n", "-Y", "eth.type == 0x88a4", "-T", "fields"])
        .args(fields.map(|field| ["-e", field]).concat())
        .arg("-r")
        .arg(capture);
    let ended = end_of(tshark.stdin(Stdio::null())).with(0);
    assert!(ended.out.lines().count() >= least, "only {} frames", ended.out.lines().count());
    let complaints: Vec<_> = ended.out.lines().filter(|line| is_complaint(line)).collect();
    assert!(complaints.is_empty(), "{}", complaints.join("\n"));
}

/// Whether the dissector finds a frame malformed, too short or in error.
fn is_complaint(line: &str) -> bool {
    /// Expert information that is an error (PI_ERROR).
    const ERROR: &str = "8388608";
    let mut fields = line.split('\t').skip(2);
    let mut next = || fields.next().unwrap_or_default();
    !next().is_empty() || !next().is_empty() || next().split(',').any(|severity| severity == ERROR)
}
