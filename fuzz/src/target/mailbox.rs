//! Mailbox messages against one drive in PREOP, SAFEOP or OP, with mailboxes of several lengths: any bytes, any protocol, whole and in
//! parts, with repeat requests, changes of state and time between them.
//!
//! What must hold: whatever the drive sends is a message that may be sent, its counter one further than that of the one before; there is
//! an end of messages; and after INIT and PREOP the mailbox works as if nothing had been.

use std::sync::LazyLock;

use device::layout::{MAILBOX_MAX, MAILBOX_MIN, SYNC_MANAGERS};
use usr2556e::drive::DriveConfig;
use wire::coe::Service;
use wire::mailbox::Protocol;
use wire::register::*;

use crate::bring_up;
use crate::bus::Bus;
use crate::input::{Input, Patience};
use crate::mail::{self, Postbox};

/// Steps of an input at the most.
const MOST_STEPS: usize = 96;
/// Lengths of the mailboxes.
const LENGTHS: [u16; 4] = [MAILBOX_MAX, 64, 41, MAILBOX_MIN];
/// The activate byte of the mailbox to the master.
const ACTIVATE: u16 = SM + SM_SIZE + sync_manager::ACTIVATE;

/// A drive in PREOP, in SAFEOP and in OP, for each length of the mailboxes.
static PREPARED: LazyLock<Vec<(Bus, u16)>> = LazyLock::new(|| LENGTHS.into_iter().flat_map(in_each_state).collect());

fn in_each_state(length: u16) -> [(Bus, u16); 3] {
    let mut bus = Bus::new([DriveConfig::numbered(0)]);
    bring_up::to_preop(&mut bus, length);
    let preop = bus.clone();
    bring_up::to_safeop(&mut bus);
    let safeop = bus.clone();
    bring_up::to_op(&mut bus);
    [preop, safeop, bus].map(|bus| (bus, length))
}

/// What was fetched last, for comparison of counters.
#[derive(Default)]
struct Sequence {
    last: Option<u8>,
    repeated: bool,
}

impl Sequence {
    /// Looks at the counter of the next message.
    fn take(&mut self, counter: u8) {
        if let Some(last) = self.last {
            let again = self.repeated && counter == last;
            assert!(again || counter == last % 7 + 1, "counter {counter} after {last}");
        }
        (self.last, self.repeated) = (Some(counter), false);
    }

    /// Mailbox communication may begin anew.
    fn restart(&mut self) {
        *self = Self::default();
    }
}

/// A conversation with the drive.
struct Client {
    bus: Bus,
    postbox: Postbox,
    sequence: Sequence,
    /// The number of the last packet of a file.
    packet: u32,
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
        sequence: Sequence::default(),
        packet: 0,
    };
    let mut patience = Patience::default();
    for _ in 0..MOST_STEPS {
        if input.is_empty() {
            break;
        }
        client.step(&mut input, &mut patience);
    }
    for letter in client.postbox.fetch_all(&mut client.bus) {
        client.sequence.take(letter.header.counter);
    }
    bring_up::to_preop(&mut client.bus, length);
    mail::assert_answers(&mut client.bus, length);
}

impl Client {
    fn step(&mut self, input: &mut Input<'_>, patience: &mut Patience) {
        let kind = input.u8() % 16;
        match kind {
            0..=6 => self.send(kind, input),
            7..=9 => {
                if let Some(letter) = self.postbox.fetch(&mut self.bus) {
                    self.sequence.take(letter.header.counter);
                }
            }
            10 => {
                let mut activate = [0];
                self.bus.read(ACTIVATE, &mut activate);
                self.bus.write(ACTIVATE, &[activate[0] ^ sync_manager::ACTIVATE_REPEAT]);
                self.sequence.repeated = true;
            }
            11 => self.bus.wait(patience.span(input)),
            12 => {
                self.bus.write(AL_CONTROL, &[input.u8(), 0]);
                // Communication begins anew, or the mailbox to the master is read from a drive that has none.
                self.sequence.restart();
            }
            13 => _ = self.bus.write(SYNC_MANAGERS[2].start, &input.array::<7>()),
            14 => {
                let offset = u16::from(input.u8()) % self.postbox.length;
                let data = message(input, self.postbox.length - offset);
                self.bus.write(SYNC_MANAGERS[0].start + offset, data);
            }
            _ => {
                let offset = u16::from(input.u8()) % self.postbox.length;
                let length = (1 + u16::from(input.u8())).min(self.postbox.length - offset);
                self.bus.read(SYNC_MANAGERS[1].start + offset, &mut vec![0; length.into()]);
                // The last byte of a message says that it was fetched.
                self.sequence.restart();
            }
        }
    }

    /// Sends a message, more or less like those of masters.
    fn send(&mut self, kind: u8, input: &mut Input<'_>) {
        let length = self.postbox.length;
        match kind {
            0..=2 => {
                let service = input.one_of(&[Service::SdoRequest, Service::SdoInformation, Service::Emergency]);
                self.postbox.send_coe(&mut self.bus, service, message(input, length));
            }
            3 | 4 => {
                let body = self.file_access(input);
                self.postbox.send(&mut self.bus, Protocol::FOE, &body);
            }
            5 => {
                let protocol = Protocol(input.u8() % 16);
                self.postbox.send(&mut self.bus, protocol, message(input, length));
            }
            _ => _ = self.postbox.put(&mut self.bus, message(input, length)),
        }
    }

    /// A message of file access: about a file that exists or another, or the next packet, if it is not a wrong one.
    fn file_access(&mut self, input: &mut Input<'_>) -> Vec<u8> {
        let operation = 1 + input.u8() % 8;
        let begins = operation <= 2;
        self.packet = if begins { 0 } else { self.packet.wrapping_add(1) };
        let number = match input.u8() {
            0xFF => u32::from_le_bytes(input.array()),
            beside @ 0xF8.. => self.packet.wrapping_sub(u32::from(beside - 0xF8)),
            _ => self.packet,
        };
        let rest = match input.u8() {
            0..=0x3F if begins => &b"eventlog.txt"[..],
            0x40..=0xBF if begins => &b"parameters.txt"[..],
            length => input.bytes(length.into()),
        };
        [&[operation, 0], &number.to_le_bytes()[..], rest].concat()
    }
}

/// Up to `most` bytes, as many as the input says.
fn message<'a>(input: &mut Input<'a>, most: u16) -> &'a [u8] {
    let length = usize::from(input.u8()).min(most.into());
    input.bytes(length)
}
