//! The program's own master on a wire.

use super::Case;
use super::program::{beside_drives, with_exec};

pub const CASES: &[Case] = &[
    ("scan_lists_every_drive_with_its_mapping", || {
        with_exec(scan_lists_every_drive_with_its_mapping)
    }),
    ("sdo_reads_what_it_has_written", || with_exec(sdo_reads_what_it_has_written)),
    ("sdo_tells_why_the_drive_refuses", || with_exec(sdo_tells_why_the_drive_refuses)),
    ("move_goes_by_and_to", || with_exec(move_goes_by_and_to)),
    ("move_ends_at_a_limit_switch", || with_exec(move_ends_at_a_limit_switch)),
    ("move_halts_on_ctrl_c", || with_exec(move_halts_on_ctrl_c)),
    ("a_drive_that_is_not_on_the_bus_is_told", || {
        with_exec(a_drive_that_is_not_on_the_bus_is_told)
    }),
];

const TWO_DRIVES: &[&str] = &["--drives", "2"];

fn scan_lists_every_drive_with_its_mapping() {
    let ended = beside_drives(TWO_DRIVES, r#""$USR2556E" scan"#).with(0);
    let heads: Vec<_> = ended.out.lines().filter(|line| line.contains("USR2556E: vendor")).collect();
    assert_eq!(
        heads,
        [1, 2]
            .map(|drive| format!("  {drive}  USR2556E: vendor 0x00000A88, product 0x0A880001, revision 0x00000204, serial number {drive}"))
    );
    for (line, times) in [
        ("RxPDO 0x1600: 0x6040:00 Control Word (16 bits)", 2),
        ("TxPDO 0x1A00: 0x6041:00 Status Word (16 bits)", 2),
        ("station address 0x1000", 1),
        ("station address 0x1001", 1),
    ] {
        assert_eq!(ended.out.matches(line).count(), times, "{line}:\n{}", ended.out);
    }
}

fn sdo_reads_what_it_has_written() {
    let script = r#""$USR2556E" sdo --drive 2 write 2000 0x9C4 && "$USR2556E" sdo --drive 2 read 2000 && "$USR2556E" sdo read 2000 &&
        "$USR2556E" sdo read 1008 && "$USR2556E" sdo --drive 2 read 1018:4"#;
    let ended = beside_drives(TWO_DRIVES, script).with(0);
    let values: Vec<_> = ended.out.lines().map(|line| line.split(" = ").last().unwrap_or_default()).collect();
    assert_eq!(
        values,
        ["2500 (0x09C4)", "2500 (0x09C4)", "3000 (0x0BB8)", "\"ECR60\"", "2 (0x00000002)"]
    );
}

fn sdo_tells_why_the_drive_refuses() {
    for (transfer, answer) in [
        ("write 2000 6001", "writing 0x2000:00: the drive answers 0x06090031"),
        ("write 6041 0", "writing 0x6041:00: the drive answers 0x06010002"),
        ("read 605D", "reading 0x605D:00: the drive answers 0x06020000"),
        ("read 1018:5", "reading 0x1018:05: the drive answers 0x06090011"),
    ] {
        beside_drives(&[], &format!(r#""$USR2556E" sdo {transfer}"#))
            .with(1)
            .says(&[answer]);
    }
}

fn move_goes_by_and_to() {
    let script = r#""$USR2556E" move --by 5000 && "$USR2556E" move --to=-1000 --velocity 20000 && "$USR2556E" sdo read 6064 &&
        "$USR2556E" sdo read 6041 && "$USR2556E" sdo --drive 2 read 6064"#;
    let ended = beside_drives(TWO_DRIVES, script)
        .with(0)
        .prints(&["Moved from 0 to 5000 pulses.", "Moved from 5000 to -1000 pulses."]);
    let values: Vec<_> = ended
        .out
        .lines()
        .skip(2)
        .map(|line| line.split(" = ").last().unwrap_or_default())
        .collect();
    // The drive is left disabled, where it was sent; the other has not moved.
    assert!(values[0].starts_with("-1000 "), "{values:?}");
    assert!(values[1].ends_with("(0x0050)") || values[1].ends_with("(0x0250)"), "{values:?}");
    assert!(values[2].starts_with("0 "), "{values:?}");
}

fn move_ends_at_a_limit_switch() {
    // The positive limit is ten turns away.
    beside_drives(&[], r#""$USR2556E" move --to 150000 --velocity 200000 --acceleration 400000"#)
        .with(1)
        .says(&["a limit switch has stopped the drive at 1"]);
}

fn move_halts_on_ctrl_c() {
    let script = r#"timeout --preserve-status --signal INT 3 "$USR2556E" move --to 90000 --velocity 10000"#;
    beside_drives(&[], script).with(130).prints(&["Halted at "]);
}

fn a_drive_that_is_not_on_the_bus_is_told() {
    for command in ["sdo --drive 3 read 6041", "move --drive 3 --by 1"] {
        beside_drives(TWO_DRIVES, &format!(r#""$USR2556E" {command}"#))
            .with(1)
            .says(&["there is no drive 3: the bus has 2"]);
    }
}
