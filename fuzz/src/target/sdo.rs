//! SDO services against one drive in PREOP or OP: uploads and downloads in all forms, segments, aborts, complete access and SDO
//! information, mostly about objects that exist, with arbitrary values, which may be saved.
//!
//! What must hold: a request has one answer, or an announced number of them for a list; the answer is of the request's kind and about its
//! object, or an abort with a known code; no object ever has a value outside of its range, nor after switching off and on; whatever the
//! parameters are, the drive lives on; and after INIT and PREOP the mailbox works as if nothing had been.

use std::sync::LazyLock;

use device::layout::{MAILBOX_MAX, MAILBOX_MIN};
use dictionary::{AbortCode, DataType, Entry, MAX_VALUE_SIZE, Objects};
use drive::DriveObjects;
use slave::objects::FixedObjects;
use usr2556e::drive::DriveConfig;
use wire::coe::{self, SDO_SIZE, Service};
use wire::mailbox::HEADER_SIZE;

use crate::bring_up;
use crate::bus::Bus;
use crate::input::{Input, Patience};
use crate::mail::{self, Letter, Postbox};

/// Steps of an input at the most.
const MOST_STEPS: usize = 96;
/// Segments of an upload at the most.
const MOST_SEGMENTS: usize = 64;
/// Command of an upload of one entry.
const UPLOAD: u8 = 0x40;
/// Complete access, in the command of an upload or download; and the toggle, in that of a segment.
const BIT_4: u8 = 0x10;
/// Command of an abort.
const ABORT: u8 = 0x80;
/// Opcode of an error of SDO information.
const INFORMATION_ERROR: u8 = 7;

/// All entries of the device's dictionary.
static ENTRIES: LazyLock<Vec<&'static Entry>> = LazyLock::new(|| {
    let own = FixedObjects::ENTRIES.iter().chain(slave::objects::ENTRIES);
    own.chain(DriveObjects::ENTRIES).collect()
});

/// A drive in PREOP with the longest and the shortest mailboxes, and one in OP.
static PREPARED: LazyLock<[(Bus, u16); 3]> = LazyLock::new(|| {
    let [long, mut short] = [MAILBOX_MAX, MAILBOX_MIN].map(|length| {
        let mut bus = Bus::new([DriveConfig::numbered(0)]);
        bring_up::to_preop(&mut bus, length);
        bus
    });
    let preop = short.clone();
    bring_up::to_safeop(&mut short);
    bring_up::to_op(&mut short);
    [(long, MAILBOX_MAX), (preop, MAILBOX_MIN), (short, MAILBOX_MIN)]
});

/// A conversation with the drive.
struct Client {
    bus: Bus,
    postbox: Postbox,
    /// Entries that were meant.
    touched: Vec<&'static Entry>,
}

/// Runs an input.
///
/// # Panics
/// If the drive is not as it must be.
pub fn run(bytes: &[u8]) {
    let mut input = Input::new(bytes);
    let (bus, length) = PREPARED[usize::from(input.u8()) % PREPARED.len()].clone();
    let mut client = Client {
        bus,
        postbox: Postbox::new(length),
        touched: Vec::new(),
    };
    let mut patience = Patience::default();
    for _ in 0..MOST_STEPS {
        if input.is_empty() {
            break;
        }
        client.step(&mut input, &mut patience);
    }
    client.assert_ranges();
    client.bus.drives_mut()[0].power_cycle();
    client.assert_ranges_of_drive();
    bring_up::to_preop(&mut client.bus, length);
    mail::assert_answers(&mut client.bus, length);
}

impl Client {
    fn step(&mut self, input: &mut Input<'_>, patience: &mut Patience) {
        match input.u8() % 16 {
            0 => {
                let request = self.initiate(UPLOAD | input.u8() & BIT_4, input, [0; 4]);
                self.ask_about(request, &[]);
            }
            1..=3 => {
                let request = self.expedited(input);
                self.ask_about(request, &[]);
            }
            4 => {
                let size = u32::from(input.u8());
                let request = self.initiate(0x20 | input.u8() & 0x11, input, size.to_le_bytes());
                let data = self.value(input);
                self.ask_about(request, data);
            }
            5 => _ = self.ask_for_segment(0x60 | input.u8() & BIT_4, &[0; 7]),
            6 => {
                let command = input.u8() & 0x1F;
                let mut data = self.value(input).to_vec();
                data.resize(data.len().max(7), 0);
                self.ask_for_segment(command, &data);
            }
            7 => {
                let answers = self.ask(Service::SdoRequest, &[ABORT, 0, 0, 0, 0, 0, 0, 0]);
                assert_eq!(answers, [], "an abort has no answer");
            }
            8 => self.ask_for_information(1, &[input.u8() % 8, 0]),
            9 => {
                let entry = self.entry(input);
                self.ask_for_information(3, &entry.0.to_le_bytes());
            }
            10 => {
                let (index, sub) = self.entry(input);
                let [low, high] = index.to_le_bytes();
                self.ask_for_information(5, &[low, high, sub, input.u8()]);
            }
            11 => {
                let body: [u8; 8] = input.array();
                let answers = self.ask(Service::SdoRequest, &body);
                assert_eq!(answers.len(), usize::from(body[0] >> 5 != 4), "{body:02X?}");
            }
            12 => {
                let (object, signature) = input.one_of(&[(0x10, b"save"), (0x11, b"load")]);
                let [s0, s1, s2, s3] = *signature;
                self.ask_about([0x23, object, 0x10, 1, s0, s1, s2, s3], &[]);
            }
            13 => {
                let span = patience.span(input);
                self.bus.wait(span);
            }
            _ => {
                let request = self.initiate(UPLOAD | input.u8() & BIT_4, input, [0; 4]);
                self.upload(request);
            }
        }
    }

    /// The address of an entry, or any other.
    fn entry(&mut self, input: &mut Input<'_>) -> (u16, u8) {
        let choice = input.u16();
        if choice & 0x8000 != 0 {
            return (choice & 0x7FFF, input.u8());
        }
        let entry = ENTRIES[usize::from(choice & 0x03FF) % ENTRIES.len()];
        self.touched.push(entry);
        // A few address the count, or beside the entry.
        let sub = match choice >> 13 {
            0 | 1 => entry.sub,
            _ => input.u8() % 4,
        };
        (entry.index, sub)
    }

    fn initiate(&mut self, command: u8, input: &mut Input<'_>, rest: [u8; 4]) -> [u8; 8] {
        let (index, sub) = self.entry(input);
        let ([i0, i1], [r0, r1, r2, r3]) = (index.to_le_bytes(), rest);
        [command, i0, i1, sub, r0, r1, r2, r3]
    }

    /// An expedited download, most often of the entry's own length.
    fn expedited(&mut self, input: &mut Input<'_>) -> [u8; 8] {
        let command = input.u8();
        let data = input_value(command, input);
        let mut request = self.initiate(0x22 | command & 0x1D, input, data);
        if command & 0x80 == 0
            && let Some(entry) = self.touched.last().filter(|entry| (1..=4).contains(&entry.size()))
        {
            request[0] = 0x23 | (4 - entry.size() as u8) << 2;
        }
        request
    }

    /// The bytes of a value, as many as fit a message behind the rest of it.
    fn value<'a>(&self, input: &mut Input<'a>) -> &'a [u8] {
        let room = usize::from(self.postbox.length) - HEADER_SIZE - coe::HEADER_SIZE - SDO_SIZE;
        let length = usize::from(input.u8()) % (room + 1);
        input.bytes(length)
    }

    /// Sends a message and returns what is answered; emergencies may come between.
    fn ask(&mut self, service: Service, body: &[u8]) -> Vec<Letter> {
        assert!(self.postbox.send_coe(&mut self.bus, service, body), "the mailbox is full");
        let mut answers = self.postbox.fetch_all(&mut self.bus);
        answers.retain(|answer| answer.service() != Some(Service::Emergency));
        answers
    }

    /// Sends an SDO request that has one answer: an abort with a known code, which is `None`, or a response.
    fn ask_one(&mut self, request: &[u8]) -> Option<Vec<u8>> {
        let answers = self.ask(Service::SdoRequest, request);
        let [answer] = answers.as_slice() else {
            panic!("{answers:?} to {request:02X?}")
        };
        let body = answer.body.get(2..).filter(|body| body.len() >= 8);
        let body = body.unwrap_or_else(|| panic!("{answer:?} to {request:02X?}"));
        if body[0] != ABORT {
            assert_eq!(answer.service(), Some(Service::SdoResponse));
            return Some(body.to_vec());
        }
        let code = u32::from_le_bytes([body[4], body[5], body[6], body[7]]);
        assert!(AbortCode::from_code(code).is_some(), "abort code {code:08X}");
        if matches!(request[0] >> 5, 1 | 2) {
            assert_eq!(body[1..4], request[1..4], "aborted what was not asked for");
        }
        None
    }

    /// Begins an upload or a download; the answer, unless it is an abort.
    fn ask_about(&mut self, request: [u8; 8], data: &[u8]) -> Option<Vec<u8>> {
        let answer = self.ask_one(&[&request[..], data].concat())?;
        let expected = if request[0] >> 5 == 2 { 2 } else { 3 };
        assert_eq!(answer[0] >> 5, expected, "{answer:02X?} to {request:02X?}");
        assert_eq!(answer[1..4], request[1..4], "answered what was not asked for");
        Some(answer)
    }

    /// Sends a segment or asks for one; the answer, unless it is an abort.
    fn ask_for_segment(&mut self, command: u8, data: &[u8]) -> Option<Vec<u8>> {
        let answer = self.ask_one(&[&[command][..], data].concat())?;
        let expected = if command >> 5 == 3 { 0 } else { 1 };
        assert_eq!(answer[0] >> 5, expected, "{answer:02X?} to {command:02X}");
        assert_eq!(answer[0] & BIT_4, command & BIT_4, "toggle");
        Some(answer)
    }

    /// A whole upload: the value, unless it is aborted.
    fn upload(&mut self, request: [u8; 8]) -> Option<Vec<u8>> {
        let first = self.ask_about(request, &[])?;
        if first[0] & 2 != 0 {
            let unused = usize::from(first[0] >> 2 & 3);
            return Some(first[4..8 - unused].to_vec());
        }
        let size = u32::from_le_bytes([first[4], first[5], first[6], first[7]]) as usize;
        let mut value = first[8..].to_vec();
        let mut toggle = 0;
        for _ in 0..MOST_SEGMENTS {
            if value.len() == size {
                return Some(value);
            }
            let segment = self.ask_for_segment(0x60 | toggle, &[0; 7]).expect("the rest of the value");
            let unused = if segment.len() == 8 { usize::from(segment[0] >> 1 & 7) } else { 0 };
            value.extend(&segment[1..segment.len() - unused]);
            assert_eq!(segment[0] & 1 != 0, value.len() == size, "{value:02X?} of {size}");
            toggle ^= BIT_4;
        }
        panic!("there is no end of segments");
    }

    /// Asks for SDO information, and sees that as many messages come as are announced.
    fn ask_for_information(&mut self, opcode: u8, request: &[u8]) {
        let answers = self.ask(Service::SdoInformation, &[&[opcode, 0, 0, 0], request].concat());
        assert!(!answers.is_empty(), "no answer to {opcode} {request:02X?}");
        for (left, answer) in (0..answers.len()).rev().zip(&answers) {
            let &[_, _, answered, _, low, high, ref rest @ ..] = answer.body.as_slice() else {
                panic!("{answer:?}")
            };
            assert_eq!(usize::from(u16::from_le_bytes([low, high])), left);
            assert_eq!(answered & 0x80 != 0, left != 0);
            if answered == INFORMATION_ERROR {
                let code = rest.first_chunk().copied().map(u32::from_le_bytes);
                assert!(code.and_then(AbortCode::from_code).is_some(), "abort code {code:08X?}");
            } else {
                assert_eq!(answered & 0x7F, opcode + 1);
            }
        }
    }

    /// Reads back what was meant, and looks at everything else.
    fn assert_ranges(&mut self) {
        let mut touched = std::mem::take(&mut self.touched);
        touched.sort_by_key(|entry| (entry.index, entry.sub));
        touched.dedup();
        for entry in touched {
            let [i0, i1] = entry.index.to_le_bytes();
            if let Some(value) = self.upload([UPLOAD, i0, i1, entry.sub, 0, 0, 0, 0]) {
                assert_in_range(entry, &value);
            }
        }
        self.assert_ranges_of_drive();
    }

    fn assert_ranges_of_drive(&self) {
        let objects = self.bus.drives()[0].device().objects();
        for (slot, entry) in objects.entries().iter().enumerate() {
            let mut value = [0; MAX_VALUE_SIZE];
            let size = objects.load(slot, &mut value);
            assert_in_range(entry, &value[..size]);
        }
    }
}

/// Four bytes of data; small numbers are more often within a range.
fn input_value(command: u8, input: &mut Input<'_>) -> [u8; 4] {
    match command & 0x60 {
        0 => input.array(),
        0x20 => u32::from(input.u8()).to_le_bytes(),
        0x40 => u32::from(input.u16()).to_le_bytes(),
        _ => i32::from(input.u16() as i16).to_le_bytes(),
    }
}

/// Sees that a value is within the range of its entry.
fn assert_in_range(entry: &Entry, value: &[u8]) {
    if matches!(entry.data_type, DataType::VisibleString | DataType::OctetString) {
        return;
    }
    assert_eq!(value.len(), entry.size(), "length of {:04X}:{:02X}", entry.index, entry.sub);
    let negative = entry.data_type.is_signed() && value.last().is_some_and(|&last| last & 0x80 != 0);
    let mut bytes = [if negative { 0xFF } else { 0 }; 16];
    bytes[..value.len()].copy_from_slice(value);
    let number = i128::from_le_bytes(bytes).min(i64::MAX.into());
    let range = i128::from(entry.min)..=i128::from(entry.max);
    assert!(
        range.contains(&number),
        "{:04X}:{:02X} is {number}, not in {range:?}",
        entry.index,
        entry.sub
    );
}
