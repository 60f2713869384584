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

/// Runs an input.
///
/// # Panics
/// If the drive is not as it must be.
pub fn run(bytes: &[u8]) {
    let mut input = Input::new(bytes);
    let (mut bus, length) = PREPARED[usize::from(input.u8()) % PREPARED.len()].clone();
    let mut postbox = Postbox::new(length);
    let mut sequence = Sequence::default();
    let mut patience = Patience::default();
    for _ in 0..MOST_STEPS {
        if input.is_empty() {
            break;
        }
        step(&mut bus, &mut postbox, &mut sequence, &mut input, &mut patience);
    }
    for letter in postbox.fetch_all(&mut bus) {
        sequence.take(letter.header.counter);
    }
    bring_up::to_preop(&mut bus, length);
    mail::assert_answers(&mut bus, length);
}

fn step(bus: &mut Bus, postbox: &mut Postbox, sequence: &mut Sequence, input: &mut Input<'_>, patience: &mut Patience) {
    let [out, back, outputs, _] = SYNC_MANAGERS.map(|manager| manager.start);
    match input.u8() % 16 {
        0..=3 => {
            let service = input.one_of(&[
                Service::SdoRequest,
                Service::SdoInformation,
                Service::SdoRequest,
                Service::Emergency,
            ]);
            let body = message(input, postbox.length);
            postbox.send_coe(bus, service, body);
        }
        4 | 5 => {
            let protocol = Protocol(input.u8() % 16);
            let body = message(input, postbox.length);
            postbox.send(bus, protocol, body);
        }
        6 => {
            let bytes = message(input, postbox.length);
            postbox.put(bus, bytes);
        }
        7..=9 => {
            if let Some(letter) = postbox.fetch(bus) {
                sequence.take(letter.header.counter);
            }
        }
        10 => {
            let mut activate = [0];
            bus.read(ACTIVATE, &mut activate);
            bus.write(ACTIVATE, &[activate[0] ^ sync_manager::ACTIVATE_REPEAT]);
            sequence.repeated = true;
        }
        11 => bus.wait(patience.span(input)),
        12 => {
            let control = input.u8();
            bus.write(AL_CONTROL, &[control, 0]);
            // Communication begins anew, or the mailbox to the master is read from a drive that has none.
            sequence.restart();
        }
        13 => {
            let data: [u8; 7] = input.array();
            bus.write(outputs, &data);
        }
        14 => {
            let offset = u16::from(input.u8()) % postbox.length;
            let data = message(input, postbox.length - offset);
            bus.write(out + offset, data);
        }
        _ => {
            let offset = u16::from(input.u8()) % postbox.length;
            let length = (1 + u16::from(input.u8())).min(postbox.length - offset);
            bus.read(back + offset, &mut vec![0; length.into()]);
            // The last byte of a message says that it was fetched.
            sequence.restart();
        }
    }
}

/// Up to `most` bytes, as many as the input says.
fn message<'a>(input: &mut Input<'a>, most: u16) -> &'a [u8] {
    let length = usize::from(input.u8()).min(most.into());
    input.bytes(length)
}
