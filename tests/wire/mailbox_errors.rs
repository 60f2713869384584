//! Every mailbox error the drive answers (ETG.1000.6, mailbox error detail).

use rig::raw::RawMaster;
use wire::al::AlState;
use wire::mailbox::MailboxError::{self, *};

const AOE: u8 = 1;
const EOE: u8 = 2;
const COE: u8 = 3;
const SOE: u8 = 5;
const VOE: u8 = 15;

/// What it is, the protocol, the bytes behind the mailbox header, and the error.
// A row a line.
#[rustfmt::skip]
const ROWS: [(&str, u8, &[u8], MailboxError); 20] = [
    ("AoE", AOE, &[0; 10], UnsupportedProtocol),
    ("EoE", EOE, &[0; 10], UnsupportedProtocol),
    ("SoE", SOE, &[0; 10], UnsupportedProtocol),
    ("a protocol without a name", 9, &[0; 10], UnsupportedProtocol),
    ("VoE", VOE, &[0; 10], UnsupportedProtocol),
    ("an emergency to the drive", COE, &[0, 0x10, 0, 0, 0, 0, 0, 0, 0, 0], ServiceNotSupported),
    ("an SDO response to the drive", COE, &[0, 0x30, 0x60, 0, 0x20, 0, 0, 0, 0, 0], ServiceNotSupported),
    ("a TxPDO", COE, &[0, 0x40, 0, 0], ServiceNotSupported),
    ("an RxPDO", COE, &[0, 0x50, 0, 0], ServiceNotSupported),
    ("a remote request for a TxPDO", COE, &[0, 0x60], ServiceNotSupported),
    ("a remote request for an RxPDO", COE, &[0, 0x70], ServiceNotSupported),
    ("CoE service 0", COE, &[0; 10], InvalidHeader),
    ("CoE service 9", COE, &[0, 0x90, 0, 0, 0, 0, 0, 0, 0, 0], InvalidHeader),
    ("CoE service 15", COE, &[0, 0xF0, 0, 0, 0, 0, 0, 0, 0, 0], InvalidHeader),
    ("an empty message", COE, &[], SizeTooShort),
    ("half a CoE header", COE, &[0], SizeTooShort),
    ("an SDO request without data", COE, &[0, 0x20, 0x40, 0, 0x20, 0, 0, 0, 0], SizeTooShort),
    ("SDO information without a request", COE, &[0, 0x80, 1, 0, 0, 0], SizeTooShort),
    ("a list request of one byte", COE, &[0, 0x80, 1, 0, 0, 0, 1], SizeTooShort),
    ("a request for an entry without value info", COE, &[0, 0x80, 5, 0, 0, 0, 0, 0x20, 0], SizeTooShort),
];

/// Errors that other devices answer.
const NOT_ANSWERED: [(MailboxError, &str); 4] = [
    (Syntax, "every header of six bytes can be read"),
    (InvalidChannel, "the channel is reserved, and echoed"),
    (NoMemory, "a request that finds no room waits in the chip"),
    (ServiceInWork, "a new transfer takes the place of the old one"),
];

/// The error in an answer, which must be an error reply of its exact size.
fn error_of(answer: &[u8]) -> u16 {
    assert_eq!(answer[..2], [4, 0], "length");
    assert_eq!(answer[5] & 0x0F, 0, "type");
    assert_eq!(answer[6..8], [1, 0], "error command");
    assert!(answer[10..].iter().all(|&byte| byte == 0), "nothing behind the message");
    u16::from_le_bytes([answer[8], answer[9]])
}

#[test]
fn messages_that_cannot_be_served_are_answered_with_their_error() {
    for (what, protocol, body, error) in ROWS {
        for state in [AlState::PreOp, AlState::SafeOp, AlState::Op] {
            let mut master = RawMaster::in_state(state);
            let answer = master.exchange(protocol, body).unwrap_or_else(|| panic!("no answer to {what}"));
            assert_eq!(error_of(&answer), error as u16, "{what} in {}", state.name());
            assert_eq!(master.upload(0x1000, 0), Ok(vec![0x92, 0x01, 0x04, 0x00]), "after {what}");
        }
    }
}

#[test]
fn a_message_longer_than_the_mailbox_is_of_invalid_size() {
    for mailbox in [36_u16, 64, 128] {
        let mut master = RawMaster::new();
        master.set_mailboxes(mailbox);
        master.request(2);
        for (length, refused) in [(mailbox - 6, false), (mailbox - 5, true), (0xFFFF, true)] {
            let [low, high] = length.to_le_bytes();
            assert!(master.send(&[low, high, 0, 0, 0, COE, 0, 0x20, 0x40, 0x00, 0x10, 0]));
            let answer = master.receive().expect("an answer");
            if refused {
                assert_eq!(error_of(&answer), InvalidSize as u16, "{length} bytes in a mailbox of {mailbox}");
            } else {
                assert_eq!(answer[5] & 0x0F, COE, "a message that fills the mailbox of {mailbox} bytes");
            }
        }
    }
}

#[test]
fn what_a_repetition_or_an_error_says_is_not_answered() {
    let mut master = RawMaster::in_state(AlState::PreOp);
    let request = [10, 0, 0, 0, 0, 5 << 4 | COE, 0, 0x20, 0x40, 0x00, 0x10, 0, 0, 0, 0, 0];
    assert!(master.send(&request));
    assert!(master.receive().is_some());
    assert!(master.send(&request));
    assert_eq!(master.receive(), None, "counter 5 was answered already");
    assert_eq!(master.exchange(0, &[1, 0, 2, 0]), None, "two devices could go on for ever");
}

#[test]
fn in_init_the_mailbox_is_not_served() {
    let mut master = RawMaster::in_state(AlState::PreOp);
    master.request(1);
    master.send(&[10, 0, 0, 0, 0, COE, 0, 0x20, 0x40, 0x00, 0x10, 0, 0, 0, 0, 0]);
    assert_eq!(master.receive(), None);
    assert_eq!(master.request(2), (2, 0));
    assert_eq!(master.receive(), None, "and what lay there is gone");
}

#[test]
fn every_error_has_a_row_or_a_reason() {
    for error in MailboxError::ALL {
        let provoked = *error == InvalidSize || ROWS.iter().any(|row| row.3 == *error);
        let excused = NOT_ANSWERED.iter().any(|row| row.0 == *error);
        assert!(provoked != excused, "{error:?}");
    }
}
