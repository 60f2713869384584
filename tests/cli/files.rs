//! The demonstration, exports, kept files and captures.

use std::fs;
use std::io::pipe;
use std::path::Path;

use tempfile::tempdir;

use super::Case;
use super::program::{beside_drives, command, done, end_of, run, with_exec};

pub const CASES: &[Case] = &[
    ("the_demonstration_is_the_same_each_time", || {
        done(the_demonstration_is_the_same_each_time)
    }),
    ("an_unwritable_output_folder_is_told_before_anything_moves", || {
        done(an_unwritable_output_folder_is_told_before_anything_moves)
    }),
    ("exports_are_the_same_on_standard_output_and_in_a_file", || {
        done(exports_are_the_same_on_standard_output_and_in_a_file)
    }),
    ("an_export_that_cannot_be_written_is_told", || {
        done(an_export_that_cannot_be_written_is_told)
    }),
    ("a_reader_who_has_gone_is_no_error_worth_a_word", || {
        done(a_reader_who_has_gone_is_no_error_worth_a_word)
    }),
    ("a_bad_eeprom_file_is_told_and_left_as_it_is", || {
        done(a_bad_eeprom_file_is_told_and_left_as_it_is)
    }),
    ("a_parameter_file_of_wrong_size_is_told_and_left_as_it_is", || {
        done(a_parameter_file_of_wrong_size_is_told_and_left_as_it_is)
    }),
    ("saved_parameters_outlast_the_program", || {
        with_exec(saved_parameters_outlast_the_program)
    }),
    ("a_folder_to_keep_that_cannot_be_made_is_told", || {
        done(a_folder_to_keep_that_cannot_be_made_is_told)
    }),
    ("a_capture_that_cannot_be_written_is_told", || {
        with_exec(a_capture_that_cannot_be_written_is_told)
    }),
];

fn text(path: &Path) -> &str {
    path.to_str().expect("a path of letters")
}

/// Runs the demonstration into `folder`, and returns report, capture and picture.
fn demonstration(folder: &Path) -> (String, Vec<u8>, Vec<u8>) {
    let ended = run(["--lock-step", "--output", text(folder)]).with(0).prints(&[
        "Report",
        "homing",
        "profile position  ended at 30000 pulses (target 30000)",
        "no step lost",
    ]);
    let (capture, picture) = (folder.join("usr2556e-demo.pcapng"), folder.join("usr2556e-demo.svg"));
    for file in [&capture, &picture] {
        assert!(ended.out.contains(text(file)), "{}", ended.out);
    }
    let report = ended.out.replace(text(folder), "");
    (report, fs::read(capture).unwrap(), fs::read(picture).unwrap())
}

fn the_demonstration_is_the_same_each_time() {
    let folder = tempdir().unwrap();
    // Neither folder exists before, the second not even the one it is in.
    let (report, capture, picture) = demonstration(&folder.path().join("one"));
    let again = demonstration(&folder.path().join("two/deep"));
    assert_eq!(report, again.0);
    assert!(capture == again.1 && picture == again.2, "capture or picture differ");
    assert!(picture.starts_with(b"<svg"));
}

fn an_unwritable_output_folder_is_told_before_anything_moves() {
    let folder = tempdir().unwrap();
    let file = folder.path().join("file");
    fs::write(&file, "mine").unwrap();
    // Below a file, which is impossible for root as well; and where the capture's name is taken by a folder.
    let below = file.join("below");
    let ended = run(["--output", text(&below)]).with(1).says(&[text(&below), "--output DIR"]);
    assert_eq!(ended.out, "");
    assert_eq!(fs::read(&file).unwrap(), b"mine");

    fs::create_dir(folder.path().join("usr2556e-demo.pcapng")).unwrap();
    let ended = run(["--output", text(folder.path())])
        .with(1)
        .says(&["usr2556e-demo.pcapng", "--output DIR"]);
    assert_eq!(ended.out, "");
}

fn exports_are_the_same_on_standard_output_and_in_a_file() {
    let folder = tempdir().unwrap();
    for arguments in [&["esi"][..], &["sii"], &["sii", "--serial", "7", "--alias", "9"]] {
        let printed = command(arguments).output().unwrap();
        assert!(printed.status.success());
        let file = folder.path().join("export");
        fs::write(&file, "what was there before").unwrap();
        run(arguments.iter().copied().chain(["--output", text(&file)])).with(0);
        assert!(fs::read(&file).unwrap() == printed.stdout, "{arguments:?}");
    }
    run(["esi"])
        .with(0)
        .prints(&["<?xml", "<EtherCATInfo", "USR2556E", "</EtherCATInfo>"]);
    let image = command(["sii", "--serial", "7"]).output().unwrap().stdout;
    let image: [u8; device::sii::SIZE] = image.try_into().expect("the size of the EEPROM");
    assert!(wire::sii::is_intact(&image));
    assert_eq!(image, device::sii::image(7, 0));
}

fn an_export_that_cannot_be_written_is_told() {
    let folder = tempdir().unwrap();
    let file = folder.path().join("missing/export");
    for export in ["esi", "sii"] {
        run([export, "--output", text(&file)]).with(1).says(&["cannot write", text(&file)]);
    }
}

fn a_reader_who_has_gone_is_no_error_worth_a_word() {
    let folder = tempdir().unwrap();
    for arguments in [&["esi"][..], &["sii"], &["--lock-step", "--output", text(folder.path())]] {
        let (reader, writer) = pipe().unwrap();
        drop(reader);
        let ended = end_of(command(arguments).stdout(writer));
        assert_eq!((ended.code, ended.err.as_str()), (Some(1), ""), "{arguments:?}");
    }
    // The files are there all the same.
    assert!(fs::metadata(folder.path().join("usr2556e-demo.svg")).unwrap().len() > 0);
}

fn a_bad_eeprom_file_is_told_and_left_as_it_is() {
    let folder = tempdir().unwrap();
    let (good, bad) = (folder.path().join("drive-1.sii"), folder.path().join("drive-2.sii"));
    let image = device::sii::image(1, 0);
    fs::write(&good, image).unwrap();
    let mut corrupt = image;
    corrupt[8] ^= 1;
    for (contents, reason) in [
        (&corrupt[..], "is corrupt: its checksum"),
        (&image[..100], "is 100 bytes long"),
        (&[], "is 0 bytes long"),
    ] {
        fs::write(&bad, contents).unwrap();
        // Told before the interface is looked for, which is not there.
        run(["run", "--interface", "no-such-one", "--drives", "2", "--keep", text(folder.path())])
            .with(1)
            .says(&[text(&bad), reason, "nothing was changed", "usr2556e sii --output"]);
        assert_eq!(fs::read(&bad).unwrap(), contents);
        assert_eq!(fs::read(&good).unwrap(), image);
    }
}

fn a_parameter_file_of_wrong_size_is_told_and_left_as_it_is() {
    let folder = tempdir().unwrap();
    let file = folder.path().join("drive-1.flash");
    for size in [0, 100, usr2556e::flash::SIZE + 1] {
        fs::write(&file, vec![7; size]).unwrap();
        let reason = format!("is {size} bytes long instead of {}", usr2556e::flash::SIZE);
        run(["run", "--interface", "no-such-one", "--keep", text(folder.path())])
            .with(1)
            .says(&[text(&file), &reason, "nothing was changed; move it away"]);
        assert_eq!(fs::read(&file).unwrap(), vec![7; size]);
    }
}

/// Saved in one run and read in the next, for the second drive only; then damaged, which the drive itself tells.
fn saved_parameters_outlast_the_program() {
    let folder = tempdir().unwrap();
    let kept = folder.path().join("kept");
    let options = ["--drives", "2", "--keep", text(&kept)];
    let save = r#"set -e
        "$USR2556E" sdo --drive 2 write 2000 2500
        "$USR2556E" sdo --drive 2 write 2151 1
        "$USR2556E" sdo --drive 2 write 2150 4660
        "$USR2556E" sdo --drive 2 write 1010:1 1
        "$USR2556E" sdo --drive 2 write 2000 2600"#;
    beside_drives(&options, save).with(0);
    let files = || {
        let mut names: Vec<_> = fs::read_dir(&kept).unwrap().map(|entry| entry.unwrap().file_name()).collect();
        names.sort();
        names
    };
    assert_eq!(files(), ["drive-2.flash"]);

    let show = r#"set -e; for drive in 1 2; do for object in 2000 2150 603F; do "$USR2556E" sdo --drive $drive read $object; done; done"#;
    let values = || -> Vec<String> {
        let ended = beside_drives(&options, show).with(0);
        ended
            .out
            .lines()
            .filter_map(|line| line.rsplit(" = ").next())
            .map(String::from)
            .collect()
    };
    assert_eq!(
        values(),
        [
            "3000 (0x0BB8)",
            "0 (0x0000)",
            "0 (0x0000)",
            "2500 (0x09C4)",
            "4660 (0x1234)",
            "0 (0x0000)"
        ]
    );
    assert_eq!(files(), ["drive-2.flash"], "starting and reading change no file");

    let file = kept.join("drive-2.flash");
    let mut contents = fs::read(&file).unwrap();
    let index = contents
        .windows(2)
        .position(|bytes| bytes == 0x2150_u16.to_le_bytes())
        .expect("0x2150 is saved");
    contents[index] ^= 1;
    fs::write(&file, contents).unwrap();
    assert_eq!(
        values(),
        [
            "3000 (0x0BB8)",
            "0 (0x0000)",
            "0 (0x0000)",
            "3000 (0x0BB8)",
            "0 (0x0000)",
            "21808 (0x5530)"
        ]
    );
}

fn a_folder_to_keep_that_cannot_be_made_is_told() {
    let folder = tempdir().unwrap();
    let file = folder.path().join("file");
    fs::write(&file, "mine").unwrap();
    run(["run", "--interface", "no-such-one", "--keep", text(&file)])
        .with(1)
        .says(&[text(&file), "--keep DIR"]);
    assert_eq!(fs::read(&file).unwrap(), b"mine");
}

fn a_capture_that_cannot_be_written_is_told() {
    let folder = tempdir().unwrap();
    let file = folder.path().join("missing/capture.pcapng");
    let ended = run(["exec", "--record", text(&file), "--", "echo", "started"])
        .with(1)
        .says(&[text(&file), "--record FILE"]);
    assert_eq!(ended.out, "");
}
