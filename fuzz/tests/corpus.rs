//! The corpus again, without a fuzzer: every input that ever led a target to something new.

use std::fs;
use std::path::Path;

use fuzzing::target;

fn replay(name: &str) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("corpus").join(name);
    let (_, run) = target::ALL.into_iter().find(|(known, _)| *known == name).expect("a target");
    let mut count = 0;
    for entry in fs::read_dir(&folder).unwrap_or_else(|error| panic!("{}: {error}", folder.display())) {
        let path = entry.expect("the folder can be read").path();
        let bytes = fs::read(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        // Shown only if the input makes the target panic.
        println!("{}", path.display());
        run(&bytes);
        count += 1;
    }
    assert!(count > 0, "{} is empty", folder.display());
}

#[test]
fn frames_of_the_corpus_leave_the_drives_working() {
    replay("frame");
}

#[test]
fn mailbox_messages_of_the_corpus_leave_the_drive_working() {
    replay("mailbox");
}

#[test]
fn sdo_services_of_the_corpus_leave_the_drive_working() {
    replay("sdo");
}

#[test]
fn eeprom_contents_of_the_corpus_leave_the_drive_working() {
    replay("eeprom");
}
