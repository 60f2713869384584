//! `usr2556e tune vibration`.

use std::fs;
use std::path::Path;
use std::thread::sleep;
use std::time::Duration;

use tempfile::tempdir;

use super::Case;
use super::program::{Ended, done, run};
use super::serving::Serving;

pub const CASES: &[Case] = &[
    ("the_help_of_tuning_says_whose_interpretation_it_is", || {
        done(the_help_of_tuning_says_whose_interpretation_it_is)
    }),
    ("a_tuning_that_cannot_be_meant_is_refused", || {
        done(a_tuning_that_cannot_be_meant_is_refused)
    }),
    ("a_motor_that_cannot_be_tuned_leaves_nothing", || {
        done(a_motor_that_cannot_be_tuned_leaves_nothing)
    }),
    ("what_stands_in_the_way_of_tuning_is_told_before_the_work", || {
        done(what_stands_in_the_way_of_tuning_is_told_before_the_work)
    }),
    ("tuning_leaves_picture_and_file_and_writes_the_drive", || {
        done(tuning_leaves_picture_and_file_and_writes_the_drive)
    }),
];

fn tune(options: &[&str]) -> Ended {
    run(["tune", "vibration"].iter().chain(options))
}

fn text(path: &Path) -> &str {
    path.to_str().expect("a path of letters")
}

fn the_help_of_tuning_says_whose_interpretation_it_is() {
    tune(&["--help"])
        .with(0)
        .prints(&["--load-torque", "--save", "third harmonic", "this project's interpretation"]);
}

fn a_tuning_that_cannot_be_meant_is_refused() {
    tune(&[]).with(2).says(&["--motor"]);
    let motor = ["--motor", "as1010"];
    for (option, value) in [
        ("--supply", "12"),
        ("--current", "7"),
        ("--load-inertia", "-1"),
        ("--load-torque", "NaN"),
    ] {
        tune(&[&motor[..], &[&format!("{option}={value}")]].concat())
            .with(2)
            .says(&[option, "a number from"]);
    }
    for alone in [&["--save"][..], &["--drive", "2"]] {
        tune(&[&motor[..], alone].concat()).with(2).says(&["--interface <IFACE>", "--udp"]);
    }
    tune(&[&motor[..], &["--interface", "lo", "--udp"]].concat())
        .with(2)
        .says(&["cannot be used with"]);
}

fn a_motor_that_cannot_be_tuned_leaves_nothing() {
    let folder = tempdir().unwrap();
    for (options, reason) in [
        (&["--motor", "three-phase-57"][..], "on motors of two phases only"),
        (&["--motor", "as1010", "--load-torque", "0.4"], "lessen --load-torque"),
        (&["--motor", "as1010", "--load-torque", "0.36"], "falls out of step at every speed"),
        (&["--motor", "as1010", "--load-inertia", "1000000"], "times the motor's inertia"),
    ] {
        tune(&[options, &["--output", text(folder.path())]].concat())
            .with(1)
            .says(&[reason]);
    }
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
}

fn what_stands_in_the_way_of_tuning_is_told_before_the_work() {
    let folder = tempdir().unwrap();
    let file = folder.path().join("file");
    fs::write(&file, "mine").unwrap();
    fs::create_dir(folder.path().join("usr2556e-vibration.svg")).unwrap();
    for output in [text(&file), text(folder.path())] {
        let ended = tune(&["--motor", "as1010", "--output", output]).with(1);
        assert_eq!(ended.out, "");
        ended.says(&[output, "--output DIR"]);
    }
    let elsewhere = folder.path().join("elsewhere");
    let options = ["--motor", "as1010", "--output", text(&elsewhere), "--interface", "no-such-one"];
    let ended = tune(&options).with(1);
    assert_eq!(ended.out, "");
    ended.says(&["no network interface \"no-such-one\""]);

    let serving = Serving::over_udp(&[]);
    let bus = ["--motor", "as1010", "--output", text(&elsewhere), "--udp", &serving.address];
    tune(&[&bus[..], &["--drive", "2"]].concat()).with(1).says(&["there is no drive 2"]);
    run(["sdo", "--udp", &serving.address, "write", "200C:1", "1"]).with(0);
    tune(&bus).with(1).says(&["three phases (0x200C:01)"]);
    assert_eq!(fs::read_dir(&elsewhere).unwrap().count(), 0);
}

/// The values in the file are those on standard output and in the drive, which keeps them.
fn tuning_leaves_picture_and_file_and_writes_the_drive() {
    let folder = tempdir().unwrap();
    let (output, kept) = (folder.path().join("deep/down"), folder.path().join("kept"));
    let options = ["--keep", text(&kept)];
    let serving = Serving::over_udp(&options);
    let bus = ["--udp", &serving.address];
    let ended = tune(&[&["--motor", "as1010", "--output", text(&output), "--save"][..], &bus].concat()).with(0);
    let ended = ended.prints(&[
        "Drive 1 has a current of 3000 mA (0x2000); the values are going to be for 1410 mA.",
        "as1010: 36 V, 1.41 A peak, load 0 g cm^2 and 0.037887 Nm",
        "First resonance at 1.4",
        "The same values with other loads",
        "Written to drive 1",
        "and saved",
    ]);

    let file = fs::read_to_string(output.join("usr2556e-vibration.txt")).unwrap();
    let lines: Vec<&str> = file.lines().filter(|line| !line.starts_with('#')).collect();
    let value = |line: &str| line.split([' ', '#']).nth(2).unwrap().parse::<u16>().unwrap();
    let values: Vec<u16> = lines.iter().map(|line| value(line)).collect();
    assert!(lines[0].starts_with("2060:00 = ") && lines[2].starts_with("2062:00 = "), "{file}");
    for (object, value) in ["2060", "2061", "2062"].iter().zip(&values) {
        assert!(ended.out.contains(&format!("0x{object}:00 = {value} ")), "{}", ended.out);
    }
    assert!(
        fs::read_to_string(output.join("usr2556e-vibration.svg"))
            .unwrap()
            .starts_with("<svg")
    );

    // The program writes what is kept shortly after the drive has saved it, and in one step.
    let saved = (0..600).any(|_| {
        sleep(Duration::from_millis(50));
        kept.join("drive-1.flash").exists()
    });
    assert!(saved, "the drive has saved nothing");
    drop(serving);
    let serving = Serving::over_udp(&options);
    for (object, value) in ["2060", "2061", "2062"].iter().zip(&values) {
        run(["sdo", "--udp", &serving.address, "read", object])
            .with(0)
            .prints(&[&format!(" = {value} (")]);
    }
}
