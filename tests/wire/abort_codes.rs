//! Every SDO abort code the drive answers (ETG.1000.6, SDO abort codes).

use std::collections::BTreeSet;

use dictionary::AbortCode::{self, *};
use rig::raw::RawMaster;
use wire::al::AlState::{self, Op, PreOp, SafeOp};

/// What it is, the state it happens in, SDO requests of which all but the last succeed, and the abort code of the last.
type Row = (&'static str, AlState, &'static [[u8; 8]], AbortCode);

/// SDO commands (ETG.1000.6): expedited downloads of so many bytes, a download that tells its size, an upload, and segments.
const ONE: u8 = 0x2F;
const TWO: u8 = 0x2B;
const FOUR: u8 = 0x23;
const SIZED: u8 = 0x21;
const UPLOAD: u8 = 0x40;
const COMPLETE: u8 = 0x10;
const DOWNLOAD_SEGMENT: u8 = 0x00;
const UPLOAD_SEGMENT: u8 = 0x60;
const TOGGLE: u8 = 0x10;
const LAST: u8 = 0x01;

/// An SDO request in which an object is named.
const fn sdo(command: u8, index: u16, sub: u8, data: u32) -> [u8; 8] {
    let [low, high] = index.to_le_bytes();
    let [a, b, c, d] = data.to_le_bytes();
    [command, low, high, sub, a, b, c, d]
}

/// A segment with seven bytes.
const fn segment(command: u8) -> [u8; 8] {
    [command, 0, 0, 0, 0, 0, 0, 0]
}

// A row a line.
#[rustfmt::skip]
const ROWS: [Row; 57] = [
    ("first segment with toggle", PreOp, &[sdo(SIZED, 0x607A, 0, 4), segment(DOWNLOAD_SEGMENT | TOGGLE)], ToggleNotAlternated),
    ("segment of a download without one", PreOp, &[segment(DOWNLOAD_SEGMENT)], UnknownCommand),
    ("segment of an upload without one", PreOp, &[segment(UPLOAD_SEGMENT)], UnknownCommand),
    ("segment the wrong way", PreOp, &[sdo(SIZED, 0x607A, 0, 4), segment(UPLOAD_SEGMENT)], UnknownCommand),
    ("segment behind the last", PreOp, &[sdo(UPLOAD, 0x6041, 0, 0), segment(UPLOAD_SEGMENT)], UnknownCommand),
    ("command 5", PreOp, &[sdo(0xA0, 0x6041, 0, 0)], UnknownCommand),
    ("command 7", PreOp, &[sdo(0xE0, 0x6041, 0, 0)], UnknownCommand),
    ("complete access to one value", PreOp, &[sdo(UPLOAD | COMPLETE, 0x2000, 0, 0)], UnsupportedAccess),
    ("complete access from sub-index 2", PreOp, &[sdo(UPLOAD | COMPLETE, 0x1018, 2, 0)], UnsupportedAccess),
    ("download of one value completely", PreOp, &[sdo(TWO | COMPLETE, 0x2000, 0, 3000)], UnsupportedAccess),
    ("statusword", Op, &[sdo(TWO, 0x6041, 0, 0)], ReadOnly),
    ("vendor", PreOp, &[sdo(FOUR, 0x1018, 1, 0xA88)], ReadOnly),
    ("highest sub-index of a record", PreOp, &[sdo(ONE, 0x2005, 0, 2)], ReadOnly),
    ("device name", PreOp, &[sdo(FOUR, 0x1008, 0, 0)], ReadOnly),
    ("closed-loop parameter", PreOp, &[sdo(TWO, 0x2020, 0, 4000)], ReadOnly),
    ("identity completely", PreOp, &[sdo(FOUR | COMPLETE, 0x1018, 1, 0)], ReadOnly),
    ("type of a sync manager", PreOp, &[sdo(ONE, 0x1C00, 1, 1)], ReadOnly),
    ("mapping entry that counts", PreOp, &[sdo(FOUR, 0x1600, 1, 0x6040_0010)], SubIndexZeroNotCleared),
    ("assignment that counts", PreOp, &[sdo(TWO, 0x1C12, 1, 0x1601)], SubIndexZeroNotCleared),
    ("index below all objects", PreOp, &[sdo(UPLOAD, 0x0005, 0, 0)], ObjectNotFound),
    ("option the drive does not have", PreOp, &[sdo(UPLOAD, 0x605D, 0, 0)], ObjectNotFound),
    ("torque of the servo family", Op, &[sdo(TWO, 0x6071, 0, 0)], ObjectNotFound),
    ("complete access to nothing", PreOp, &[sdo(UPLOAD | COMPLETE, 0x2FFF, 0, 0)], ObjectNotFound),
    ("object behind all others", SafeOp, &[sdo(UPLOAD, 0xFFFF, 255, 0)], ObjectNotFound),
    ("unknown object in a mapping", PreOp, &[sdo(ONE, 0x1600, 0, 0), sdo(FOUR, 0x1600, 1, 0x2FFF_0010)], ObjectNotFound),
    ("input in an RxPDO", PreOp, &[sdo(ONE, 0x1600, 0, 0), sdo(FOUR, 0x1600, 1, 0x6041_0010)], NotMappable),
    ("wrong length in a mapping", PreOp, &[sdo(ONE, 0x1600, 0, 0), sdo(FOUR, 0x1600, 1, 0x6040_0008)], NotMappable),
    ("highest sub-index in a mapping", PreOp, &[sdo(ONE, 0x1A00, 0, 0), sdo(FOUR, 0x1A00, 1, 0x2005_0008)], NotMappable),
    ("thirteen entries", PreOp, &[sdo(ONE, 0x1600, 0, 13)], PdoLengthExceeded),
    ("one PDO twice", PreOp, &[sdo(ONE, 0x1C12, 0, 0), sdo(TWO, 0x1C12, 2, 0x1600), sdo(ONE, 0x1C12, 0, 2)], ParameterIncompatible),
    ("4 bytes to an object of 2", PreOp, &[sdo(FOUR, 0x2000, 0, 3000)], LengthMismatch),
    ("2 bytes to an object of 4", Op, &[sdo(TWO, 0x607A, 0, 3000)], LengthMismatch),
    ("1 byte to an object of 2", Op, &[sdo(ONE, 0x6040, 0, 6)], LengthMismatch),
    ("4 bytes to an object of 1", PreOp, &[sdo(FOUR, 0x6060, 0, 1)], LengthMismatch),
    ("five bytes announced for four", PreOp, &[sdo(SIZED, 0x607A, 0, 5)], LengthMismatch),
    ("billions of bytes announced", PreOp, &[sdo(SIZED, 0x607A, 0, u32::MAX)], LengthMismatch),
    ("more bytes than announced", PreOp, &[sdo(SIZED, 0x607A, 0, 4), segment(DOWNLOAD_SEGMENT)], LengthMismatch),
    ("fewer bytes than announced", PreOp, &[sdo(SIZED, 0x607A, 0, 4), segment(DOWNLOAD_SEGMENT | LAST | 5 << 1)], LengthMismatch),
    ("half of a record completely", PreOp, &[sdo(TWO | COMPLETE, 0x2005, 1, 0)], LengthMismatch),
    ("sub-index of one value", PreOp, &[sdo(UPLOAD, 0x6041, 1, 0)], SubIndexNotFound),
    ("sub-index behind the last", PreOp, &[sdo(UPLOAD, 0x1018, 5, 0)], SubIndexNotFound),
    ("mapping entry that does not count", PreOp, &[sdo(UPLOAD, 0x1600, 4, 0)], SubIndexNotFound),
    ("hole in a record", PreOp, &[sdo(UPLOAD, 0x1C32, 0x1F, 0)], SubIndexNotFound),
    ("download behind the last sub-index", PreOp, &[sdo(FOUR, 0x6099, 3, 0)], SubIndexNotFound),
    ("mode 4, torque", Op, &[sdo(ONE, 0x6060, 0, 4)], ValueRange),
    ("quick stop at the current limit", PreOp, &[sdo(TWO, 0x605A, 0, 3)], ValueRange),
    ("2 to store parameters", PreOp, &[sdo(TWO, 0x1010, 1, 2)], ValueRange),
    ("sync type 9", PreOp, &[sdo(TWO, 0x1C32, 1, 9)], ValueRange),
    ("TxPDO among RxPDOs", PreOp, &[sdo(ONE, 0x1C12, 0, 0), sdo(TWO, 0x1C12, 1, 0x1A00)], ValueRange),
    ("6001 mA", PreOp, &[sdo(TWO, 0x2000, 0, 6001)], ValueTooHigh),
    ("four assigned PDOs", PreOp, &[sdo(ONE, 0x1C12, 0, 4)], ValueTooHigh),
    ("closed loop", PreOp, &[sdo(TWO, 0x2011, 0, 1)], ValueTooHigh),
    ("99 mA", Op, &[sdo(TWO, 0x2000, 0, 99)], ValueTooLow),
    ("homing method 16", PreOp, &[sdo(ONE, 0x6098, 0, 16)], ValueTooLow),
    ("mapping in SAFEOP", SafeOp, &[sdo(ONE, 0x1600, 0, 0)], DeviceState),
    ("assignment in OP", Op, &[sdo(ONE, 0x1C13, 0, 0)], DeviceState),
    ("gain that the drive sets", PreOp, &[sdo(TWO, 0x200B, 2, 500)], DeviceState),
];

/// Codes that other devices answer, and the master's tools can print.
const NOT_ANSWERED: [(AbortCode, &str); 10] = [
    (ProtocolTimeout, "a transfer waits for its master as long as it takes"),
    (OutOfMemory, "memory for every transfer is there from the start"),
    (WriteOnly, "every object can be read"),
    (CompleteAccessUnsupported, "every record and array fits a transfer"),
    (ObjectTooLong, "every object fits a transfer"),
    (CannotStore, "there is a memory; boards without one answer it"),
    (LengthTooHigh, "a wrong length is answered as such, too long or too short"),
    (LengthTooLow, "a wrong length is answered as such, too long or too short"),
    (General, "every reason has a code of its own"),
    (LocalControl, "the drive has no local control"),
];

#[test]
fn every_refused_request_ends_with_its_code_and_changes_nothing() {
    for (what, state, requests, code) in ROWS {
        let mut master = RawMaster::in_state(state);
        let (last, before) = requests.split_last().expect("a request");
        for request in before {
            master.sdo(request).unwrap_or_else(|code| panic!("{what}: 0x{code:08X} too early"));
        }
        let [_, low, high, sub, ..] = *last;
        let read = [UPLOAD, low, high, sub, 0, 0, 0, 0];
        // Between requests that belong together, reading would end the transfer.
        let value = before.is_empty().then(|| master.sdo(&read));
        assert_eq!(master.sdo(last), Err(code.code()), "{what}");
        if let Some(value) = value {
            assert_eq!(master.sdo(&read), value, "{what}: the old value stays");
        }
        assert_eq!(
            master.upload(0x1000, 0),
            Ok(vec![0x92, 0x01, 0x04, 0x00]),
            "{what}: the next transfer works"
        );
    }
}

#[test]
fn a_memory_that_fails_is_a_hardware_error() {
    let mut master = RawMaster::in_state(PreOp);
    for object in [0x1010, 0x1011] {
        assert_eq!(master.download(object, 1, &[1, 0]), Ok(()));
        master.drive().memory_mut().break_down();
        assert_eq!(master.download(object, 1, &[1, 0]), Err(HardwareError.code()));
        master = RawMaster::in_state(PreOp);
    }
}

#[test]
fn every_code_has_a_row_or_a_reason() {
    let provoked = ROWS.iter().map(|row| row.3);
    let others = NOT_ANSWERED.iter().map(|(code, reason)| {
        assert!(!reason.is_empty());
        *code
    });
    let covered: Vec<u32> = provoked.chain(others).chain([HardwareError]).map(AbortCode::code).collect();
    let known: BTreeSet<u32> = AbortCode::ALL.iter().map(|code| code.code()).collect();
    assert_eq!(covered.iter().copied().collect::<BTreeSet<_>>(), known);
    assert!(NOT_ANSWERED.iter().all(|(code, _)| ROWS.iter().all(|row| row.3 != *code)));
}
