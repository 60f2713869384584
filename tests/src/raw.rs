//! A master that does nothing by itself: single datagrams, single mailbox messages, and the steps that tables of cases are made of.

use std::time::Duration;

use raw_master::Datagram;
use usr2556e::drive::VirtualDrive;
use usr2556e::segment::VirtualSegment;
use wire::Nanos;
use wire::al::AlState;
use wire::frame::{self, Command};
use wire::register as reg;

/// Bytes of process data from the master at delivery.
pub const OUTPUT_SIZE: usize = 7;
/// Bytes of process data to the master at delivery.
pub const INPUT_SIZE: u16 = 11;
const MAILBOX_OUT: u16 = 0x1000;
const MAILBOX_IN: u16 = 0x1080;
const OUTPUTS: u16 = 0x1100;
const INPUTS: u16 = 0x1400;
const MAILBOX_FULL: u8 = 1 << 3;
/// Bit of an SDO command that means an abort.
const ABORT: u8 = 0x80;

/// One drive and its master.
pub struct RawMaster {
    segment: VirtualSegment,
    now: Nanos,
    counter: u8,
    mailbox: u16,
}

impl RawMaster {
    /// One new drive, in INIT, its sync managers not set up.
    pub fn new() -> Self {
        Self {
            segment: VirtualSegment::of(1),
            now: Nanos(0),
            counter: 0,
            mailbox: 128,
        }
    }

    /// The drive in a state, with the process data of the delivery and without distributed clocks.
    pub fn in_state(state: AlState) -> Self {
        let mut master = Self::new();
        master.set_mailboxes(128);
        master.set_process_data(OUTPUT_SIZE as u16, INPUT_SIZE);
        for step in [AlState::PreOp, AlState::SafeOp, AlState::Op] {
            if state < step || state == AlState::Boot {
                break;
            }
            master.request(step.code().into());
            master.send_outputs();
            assert_eq!(master.al_status(), (step.code().into(), 0), "on the way to {}", state.name());
        }
        master
    }

    /// The drive, to lay a hand on it.
    pub fn drive(&mut self) -> &mut VirtualDrive {
        &mut self.segment.drives_mut()[0]
    }

    /// One datagram in a frame of its own. Returns its data and its working counter; the drive is simulated behind it.
    pub fn datagram(&mut self, command: Command, address: u32, data: &[u8]) -> (Vec<u8>, u16) {
        let mut datagrams = [Datagram::new(command, address, data.to_vec())];
        let returned = raw_master::exchange(&mut datagrams, |frame| {
            let returned = self.segment.process(frame, self.now);
            self.segment.catch_up(self.now);
            returned
        });
        assert!(returned, "the frame comes back");
        let [Datagram { data, counter, .. }] = datagrams;
        (data, counter)
    }

    /// Reads registers or memory; `None` if nothing there can be read.
    pub fn read(&mut self, register: u16, count: usize) -> Option<Vec<u8>> {
        let (data, counter) = self.datagram(Command::Aprd, frame::physical_address(0, register), &vec![0; count]);
        (counter != 0).then_some(data)
    }

    /// Writes registers or memory. Returns whether something there could be written.
    pub fn write(&mut self, register: u16, data: &[u8]) -> bool {
        self.datagram(Command::Apwr, frame::physical_address(0, register), data).1 != 0
    }

    fn read_u16(&mut self, register: u16) -> u16 {
        let bytes = self.read(register, 2).expect("a readable register");
        u16::from_le_bytes([bytes[0], bytes[1]])
    }

    /// Lets time pass without a frame.
    pub fn wait(&mut self, span: Duration) {
        self.now = self.now.after(span);
        self.segment.catch_up(self.now);
    }

    /// AL status and AL status code.
    pub fn al_status(&mut self) -> (u16, u16) {
        (self.read_u16(reg::AL_STATUS), self.read_u16(reg::AL_STATUS_CODE))
    }

    /// Writes AL control and returns AL status and code right after.
    pub fn request(&mut self, control: u16) -> (u16, u16) {
        assert!(
            self.write(reg::AL_CONTROL, &control.to_le_bytes()),
            "AL control takes every request"
        );
        self.al_status()
    }

    /// Sets a sync manager up, from off.
    pub fn set_sync_manager(&mut self, number: u16, start: u16, length: u16, control: u8, active: bool) {
        let at = reg::SM + number * reg::SM_SIZE;
        let mut bytes = [0; 8];
        assert!(self.write(at + 6, &[0]));
        bytes[..2].copy_from_slice(&start.to_le_bytes());
        bytes[2..4].copy_from_slice(&length.to_le_bytes());
        bytes[4] = control;
        bytes[6] = active.into();
        assert!(self.write(at, &bytes));
    }

    /// Sets both mailboxes up with this length.
    pub fn set_mailboxes(&mut self, length: u16) {
        self.mailbox = length;
        self.set_sync_manager(0, MAILBOX_OUT, length, 0x26, true);
        self.set_sync_manager(1, MAILBOX_IN, length, 0x22, true);
    }

    /// Sets the process data up; a direction of 0 bytes is off.
    pub fn set_process_data(&mut self, outputs: u16, inputs: u16) {
        self.set_sync_manager(2, OUTPUTS, outputs, 0x64, outputs != 0);
        self.set_sync_manager(3, INPUTS, inputs, 0x20, inputs != 0);
    }

    /// Sends outputs of the default mapping that command nothing. Returns whether the drive took them.
    pub fn send_outputs(&mut self) -> bool {
        self.write(OUTPUTS, &[0; OUTPUT_SIZE])
    }

    /// Reads the inputs of the default mapping; `None` if the drive has none to give.
    pub fn read_inputs(&mut self) -> Option<Vec<u8>> {
        self.read(INPUTS, INPUT_SIZE.into())
    }

    /// Sets the SYNC unit up: cycle times in ns and the activation register; the first SYNC0 comes after one cycle.
    pub fn set_sync_unit(&mut self, activation: u8, sync0: u32, sync1: u32) {
        let system_time = self.read(reg::DC_SYSTEM_TIME, 8).expect("a distributed clock");
        let system_time = u64::from_le_bytes(system_time.try_into().expect("eight bytes"));
        let start = system_time + u64::from(sync0);
        for (register, bytes) in [
            (reg::DC_ACTIVATION, vec![0]),
            (reg::DC_SYNC0_CYCLE, sync0.to_le_bytes().to_vec()),
            (reg::DC_SYNC1_CYCLE, sync1.to_le_bytes().to_vec()),
            (reg::DC_START_TIME, start.to_le_bytes().to_vec()),
            (reg::DC_ACTIVATION, vec![activation]),
        ] {
            assert!(self.write(register, &bytes));
        }
    }

    /// `count` cycles of 1 ms: half of it, outputs, the other half.
    pub fn cycles(&mut self, count: u32) {
        for _ in 0..count {
            self.wait(Duration::from_micros(500));
            self.send_outputs();
            self.wait(Duration::from_micros(500));
        }
    }

    /// Puts bytes into the drive's mailbox as they are, filled up with zeros. Returns whether the mailbox took them.
    pub fn send(&mut self, message: &[u8]) -> bool {
        let mut whole = message.to_vec();
        whole.resize(self.mailbox.into(), 0);
        self.write(MAILBOX_OUT, &whole)
    }

    /// What lies in the master's mailbox.
    pub fn receive(&mut self) -> Option<Vec<u8>> {
        let status = self.read(reg::SM + reg::SM_SIZE + 5, 1).expect("a sync manager");
        if status[0] & MAILBOX_FULL == 0 {
            return None;
        }
        self.read(MAILBOX_IN, self.mailbox.into())
    }

    /// Sends a message of a protocol with the next counter and fetches the answer.
    pub fn exchange(&mut self, protocol: u8, body: &[u8]) -> Option<Vec<u8>> {
        self.counter = self.counter % 7 + 1;
        let length = (body.len() as u16).to_le_bytes();
        let header = [length[0], length[1], 0, 0, 0, self.counter << 4 | protocol];
        assert!(self.send(&[&header, body].concat()), "the mailbox is free");
        self.receive()
    }

    /// Sends an SDO request and returns the response's bytes from the command on, or the abort code.
    ///
    /// # Panics
    /// If there is no answer, or if it is no SDO response.
    pub fn sdo(&mut self, request: &[u8]) -> Result<Vec<u8>, u32> {
        let answer = self.exchange(3, &[&[0, 0x20], request].concat()).expect("an answer");
        let length = usize::from(u16::from_le_bytes([answer[0], answer[1]]));
        assert_eq!(answer[5] & 0x0F, 3, "a CoE message: {answer:02X?}");
        let body = &answer[8..6 + length];
        if body[0] == ABORT {
            Err(u32::from_le_bytes(body[4..8].try_into().expect("four bytes")))
        } else {
            Ok(body.to_vec())
        }
    }

    /// Reads an object of up to four bytes.
    pub fn upload(&mut self, index: u16, sub: u8) -> Result<Vec<u8>, u32> {
        let [low, high] = index.to_le_bytes();
        let response = self.sdo(&[0x40, low, high, sub, 0, 0, 0, 0])?;
        assert_eq!(response[0] & 3, 3, "an expedited response of known size");
        Ok(response[4..8 - usize::from(response[0] >> 2 & 3)].to_vec())
    }

    /// Writes an object of one to four bytes.
    pub fn download(&mut self, index: u16, sub: u8, value: &[u8]) -> Result<(), u32> {
        let [low, high] = index.to_le_bytes();
        let unused = 4 - value.len();
        let mut request = vec![0x23 | (unused as u8) << 2, low, high, sub];
        request.extend_from_slice(value);
        request.resize(8, 0);
        self.sdo(&request).map(|_| ())
    }
}

impl Default for RawMaster {
    fn default() -> Self {
        Self::new()
    }
}
