//! Stack, chip and device together, and what masters do to them.

use slave::{Configuration, Identity, MailboxLimits, Report, Slave};
use wire::Nanos;

use crate::chip::Chip;
use crate::lamp::Lamp;

pub const MILLISECOND: u64 = 1_000_000;
pub const NAME: &str = "A device name of exactly sixty-four bytes, as long as can be!!!!";

pub fn configuration() -> Configuration {
    Configuration {
        device_type: 0x0004_0192,
        device_name: "Lamp",
        hardware_version: "A1",
        software_version: NAME,
        identity: Identity {
            vendor: 0xA88,
            product: 0x0A88_0001,
            revision: 0x204,
            serial: 77,
        },
        mailbox: MailboxLimits {
            min: 36,
            max: 128,
            window: 0x1000..0x1100,
        },
        process_window: 0x1000..0x3000,
        minimum_cycle_ns: 500_000,
        reaction_ns: 50_000,
        op_timeout_ms: 9000,
        mappings: &[
            (0x1600, &[0x2000_0010, 0x2005_0108]),
            (0x1601, &[0x2000_0010, 0x2005_0220]),
            (0x1A00, &[0x6041_0010, 0x2005_0220]),
        ],
        rx_assignment: &[0x1600],
        tx_assignment: &[0x1A00],
    }
}

/// One device on the bench.
pub struct Bench {
    pub chip: Chip,
    pub slave: Slave,
    pub lamp: Lamp,
    pub now: u64,
    counter: u8,
}

impl Bench {
    pub fn new() -> Self {
        Self::with(configuration())
    }

    pub fn with(configuration: Configuration) -> Self {
        Self {
            chip: Chip::new(),
            slave: Slave::new(configuration),
            lamp: Lamp::new(),
            now: 0,
            counter: 0,
        }
    }

    pub fn poll(&mut self) -> Report {
        self.slave.poll(&mut self.chip, &mut self.lamp, Nanos(self.now))
    }

    /// A control tick.
    pub fn tick(&mut self) -> Report {
        let report = self.poll();
        self.slave.publish_inputs(&mut self.chip, &self.lamp, Nanos(self.now));
        report
    }

    pub fn advance(&mut self, nanoseconds: u64) -> Report {
        self.now += nanoseconds;
        self.tick()
    }

    /// Writes AL control and returns AL status and code.
    pub fn request(&mut self, control: u16) -> (u16, u16) {
        self.chip.request(control);
        self.tick();
        (self.chip.status(), self.chip.code())
    }

    pub fn set_mailboxes(&mut self, length: u16) {
        self.chip.set_sm(0, 0x1000, length, 0x26, 1);
        self.chip.set_sm(1, 0x1080, length, 0x22, 1);
    }

    pub fn set_process_data(&mut self, outputs: u16, inputs: u16) {
        self.chip.set_sm(2, 0x1100, outputs, 0x64, u8::from(outputs != 0));
        self.chip.set_sm(3, 0x1400, inputs, 0x20, u8::from(inputs != 0));
    }

    pub fn preop() -> Self {
        Self::preop_with(configuration(), 128)
    }

    pub fn preop_with(configuration: Configuration, mailbox: u16) -> Self {
        let mut bench = Self::with(configuration);
        bench.set_mailboxes(mailbox);
        assert_eq!(bench.request(0x12), (0x02, 0));
        bench
    }

    /// SAFEOP with the process data of the delivery: 3 bytes out, 6 bytes in.
    pub fn safeop() -> Self {
        let mut bench = Self::preop();
        bench.set_process_data(3, 6);
        assert_eq!(bench.request(4), (0x04, 0));
        bench
    }

    pub fn op() -> Self {
        let mut bench = Self::safeop();
        bench.request(8);
        assert!(bench.chip.outputs(&[1, 0, 2]));
        bench.tick();
        assert_eq!(bench.chip.status(), 0x08);
        bench
    }

    /// OP with SYNC0 of 1 ms, and a master that sends before each.
    pub fn op_with_sync0() -> Self {
        let mut bench = Self::preop();
        bench.set_process_data(3, 6);
        bench.chip.set_sync_unit(3, 1_000_000, 0);
        assert_eq!(bench.request(4), (0x04, 0));
        bench.request(8);
        for _ in 0..8 {
            bench.cycle();
        }
        assert_eq!(bench.chip.status(), 0x08);
        bench
    }

    /// Half a millisecond, outputs, half a millisecond, SYNC0.
    pub fn cycle(&mut self) -> Report {
        self.advance(MILLISECOND / 2);
        self.chip.outputs(&[1, 0, 2]);
        self.poll();
        self.now += MILLISECOND / 2;
        self.chip.sync0();
        self.tick()
    }

    /// Sends a mailbox message with the next counter and returns what comes back.
    pub fn exchange(&mut self, protocol: u8, body: &[u8]) -> Option<Vec<u8>> {
        self.counter = self.counter % 7 + 1;
        let mut message = vec![0, 0, 0, 0, 0, self.counter << 4 | protocol];
        message[..2].copy_from_slice(&(body.len() as u16).to_le_bytes());
        message.extend_from_slice(body);
        assert!(self.chip.send(&message));
        self.poll();
        self.chip.receive()
    }

    /// Sends an SDO request and returns the response's SDO bytes, without headers and padding.
    pub fn sdo(&mut self, request: &[u8]) -> Vec<u8> {
        let reply = self.exchange(3, &[&[0x00, 0x20], request].concat()).expect("a response");
        let length = usize::from(u16::from_le_bytes([reply[0], reply[1]]));
        assert_eq!(reply[5] & 0x0F, 3, "a CoE response: {reply:02X?}");
        assert!(length >= 10 && 6 + length <= reply.len(), "the response fits the mailbox");
        assert!(reply[6 + length..].iter().all(|&byte| byte == 0), "unused bytes are zero");
        let service = if reply[8] == 0x80 { 0x20 } else { 0x30 };
        assert_eq!(reply[6..8], [0, service]);
        reply[8..6 + length].to_vec()
    }

    /// Reads an object the way SOEM does, segments included; the abort code if there is one.
    pub fn upload(&mut self, index: u16, sub: u8) -> Result<Vec<u8>, u32> {
        self.upload_by(0x40, index, sub)
    }

    /// The same by complete access.
    pub fn upload_complete(&mut self, index: u16, sub: u8) -> Result<Vec<u8>, u32> {
        self.upload_by(0x50, index, sub)
    }

    fn upload_by(&mut self, command: u8, index: u16, sub: u8) -> Result<Vec<u8>, u32> {
        let [low, high] = index.to_le_bytes();
        let first = self.sdo(&[command, low, high, sub, 0, 0, 0, 0]);
        assert_eq!(first[1..4], [low, high, sub]);
        if let Some(code) = aborted(&first) {
            return Err(code);
        }
        assert_eq!(first[0] & 0x10, command & 0x10, "complete access is answered as such");
        if first[0] & 2 != 0 {
            return Ok(first[4..8 - usize::from(first[0] >> 2 & 3)].to_vec());
        }
        assert_eq!(first[0] & !0x10, 0x41);
        let size = u32::from_le_bytes(first[4..8].try_into().unwrap()) as usize;
        let mut value = first[8..].to_vec();
        let mut toggle = 0;
        while value.len() < size {
            let segment = self.sdo(&[0x60 | toggle, 0, 0, 0, 0, 0, 0, 0]);
            assert_eq!(segment[0] & 0xF0, toggle);
            let unused = if segment.len() == 8 { usize::from(segment[0] >> 1 & 7) } else { 0 };
            value.extend_from_slice(&segment[1..segment.len() - unused]);
            assert_eq!(segment[0] & 1 == 1, value.len() == size, "the last segment says so");
            toggle ^= 0x10;
        }
        assert_eq!(value.len(), size);
        Ok(value)
    }

    /// Writes an object: up to four bytes expedited, more in a normal download, in segments if the mailbox is too short.
    pub fn download(&mut self, index: u16, sub: u8, data: &[u8]) -> Result<(), u32> {
        self.download_by(0x20, index, sub, data)
    }

    /// The same by complete access.
    pub fn download_complete(&mut self, index: u16, sub: u8, data: &[u8]) -> Result<(), u32> {
        self.download_by(0x30, index, sub, data)
    }

    fn download_by(&mut self, command: u8, index: u16, sub: u8, data: &[u8]) -> Result<(), u32> {
        let mailbox = usize::from(self.chip.length(0));
        let [low, high] = index.to_le_bytes();
        let mut request = vec![command | 1, low, high, sub];
        let mut rest = &[][..];
        if (1..=4).contains(&data.len()) {
            request[0] |= 2 | (4 - data.len() as u8) << 2;
            request.extend_from_slice(data);
            request.resize(8, 0);
        } else {
            let first;
            (first, rest) = data.split_at(data.len().min(mailbox - 16));
            request.extend_from_slice(&(data.len() as u32).to_le_bytes());
            request.extend_from_slice(first);
        }
        let response = self.sdo(&request);
        assert_eq!(response[1..4], [low, high, sub]);
        if let Some(code) = aborted(&response) {
            return Err(code);
        }
        assert_eq!(response, [0x60, low, high, sub, 0, 0, 0, 0]);
        let mut toggle = 0;
        while !rest.is_empty() {
            let (now, later) = rest.split_at(rest.len().min(mailbox - 9));
            let response = self.sdo(&segment(toggle | u8::from(later.is_empty()), now));
            if let Some(code) = aborted(&response) {
                return Err(code);
            }
            assert_eq!(response[0], 0x20 | toggle);
            rest = later;
            toggle ^= 0x10;
        }
        Ok(())
    }

    /// Sends a message of FoE, operation, number and what follows, and returns the answer in the same form.
    pub fn foe(&mut self, operation: u8, number: u32, rest: &[u8]) -> Option<(u8, u32, Vec<u8>)> {
        let reply = self.exchange(4, &[&[operation, 0], &number.to_le_bytes()[..], rest].concat())?;
        let length = usize::from(u16::from_le_bytes([reply[0], reply[1]]));
        assert_eq!((reply[5] & 0x0F, reply[7]), (4, 0), "a message of FoE: {reply:02X?}");
        assert!(6 + length <= reply.len(), "the answer fits the mailbox");
        let number = u32::from_le_bytes(reply[8..12].try_into().unwrap());
        Some((reply[6], number, reply[12..6 + length].to_vec()))
    }

    /// Reads a file the way SOEM does; the error code and text if there is one.
    pub fn read_file(&mut self, name: &str) -> Result<Vec<u8>, (u32, String)> {
        let room = usize::from(self.chip.length(1)) - 12;
        let mut file = vec![];
        let mut answer = self.foe(1, 0, name.as_bytes()).expect("the first packet");
        for packet in 1.. {
            let (operation, number, data) = answer;
            if operation == 5 {
                return Err((number, String::from_utf8(data).unwrap()));
            }
            assert_eq!((operation, number), (3, packet));
            assert!(data.len() <= room);
            file.extend_from_slice(&data);
            let next = self.foe(4, packet, &[]);
            if data.len() < room {
                assert_eq!(next, None, "the last acknowledgement has no answer");
                break;
            }
            answer = next.expect("the next packet");
        }
        Ok(file)
    }

    /// Writes a file the way SOEM does; the error code and text if there is one.
    pub fn write_file(&mut self, name: &str, file: &[u8]) -> Result<(), (u32, String)> {
        let room = usize::from(self.chip.length(0)) - 12;
        let packets = file.chunks(room).chain(file.len().is_multiple_of(room).then_some(&[][..]));
        let mut answer = self.foe(2, 0, name.as_bytes()).expect("an answer");
        for (packet, data) in (0..).zip(packets) {
            match answer {
                (4, number, _) => assert_eq!(number, packet),
                (5, code, text) => return Err((code, String::from_utf8(text).unwrap())),
                other => panic!("{other:?}"),
            }
            answer = self.foe(3, packet + 1, data).expect("an answer");
        }
        match answer {
            (4, ..) => Ok(()),
            (5, code, text) => Err((code, String::from_utf8(text).unwrap())),
            other => panic!("{other:?}"),
        }
    }

    /// Sends a request for SDO information and returns the messages of the answer, from opcode on, without padding.
    pub fn inform(&mut self, request: &[u8]) -> Vec<Vec<u8>> {
        let mut messages = vec![];
        let mut reply = self.exchange(3, &[&[0x00, 0x80], request].concat());
        while let Some(message) = reply {
            assert_eq!((message[5] & 0x0F, &message[6..8]), (3, &[0, 0x80][..]));
            let length = usize::from(u16::from_le_bytes([message[0], message[1]]));
            messages.push(message[8..6 + length].to_vec());
            self.poll();
            reply = self.chip.receive();
        }
        messages
    }
}

/// A download segment: the shortest form for up to seven bytes.
pub fn segment(command: u8, data: &[u8]) -> Vec<u8> {
    let mut bytes = vec![command];
    bytes.extend_from_slice(data);
    if data.len() < 7 {
        bytes[0] |= (7 - data.len() as u8) << 1;
        bytes.resize(8, 0);
    }
    bytes
}

/// The abort code of a response that is an abort.
pub fn aborted(response: &[u8]) -> Option<u32> {
    (response[0] == 0x80).then(|| u32::from_le_bytes(response[4..8].try_into().unwrap()))
}
