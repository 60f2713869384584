//! Files: the parameters as a backup and from one, and the event log.

use drive::DriveObjects;
use wire::foe::{ErrorCode, Message};

use crate::Simulation;
use crate::acts::parameters::values;
use crate::invariants::{Verdict, must};
use crate::mailbox::PACKET;

const PARAMETERS: &[u8] = b"parameters.txt";
const EVENT_LOG: &[u8] = b"eventlog.txt";
/// Packets that a file has at the most.
const MOST_PACKETS: u32 = 400;

impl Simulation {
    /// Reads the parameters, and mostly writes them back: as they are, with a mistake, or not to the end.
    pub(crate) fn back_up(&mut self) -> Verdict {
        let Some(backup) = self.read_file(PARAMETERS)? else { return Ok(()) };
        self.check_backup(&backup)?;
        self.coverage.count("parameters read as a file");
        if self.random.chance(50) {
            self.change_parameters()?;
        }
        match self.random.below(4) {
            0 => self.restore_broken(&backup),
            1 => self.restore_half(&backup),
            _ => self.restore(&backup),
        }
    }

    /// Reads the event log.
    pub(crate) fn read_event_log(&mut self) -> Verdict {
        self.note(|| "event log".into());
        let Some(log) = self.read_file(EVENT_LOG)? else { return Ok(()) };
        must(log.ends_with(b"\n") && std::str::from_utf8(&log).is_ok(), || {
            format!("event log {:?}", String::from_utf8_lossy(&log))
        })?;
        self.coverage.count("event log read");
        Ok(())
    }

    /// A whole file; nothing if there is no cable or no mailbox.
    fn read_file(&mut self, name: &[u8]) -> Result<Option<Vec<u8>>, String> {
        let mut file = Vec::new();
        let mut message = Message::Read { password: 0, name };
        for packet in 1..MOST_PACKETS {
            let Some(answer) = self.file_message(message)? else {
                return Ok(None);
            };
            let data = match Message::parse(&answer) {
                Some(Message::Data { packet: number, data }) if number == packet => data.to_vec(),
                _ => return Err(format!("packet {packet} of a file answered by {answer:02X?}")),
            };
            file.extend_from_slice(&data);
            if data.len() < PACKET {
                let answer = self.file_message(Message::Ack { packet })?;
                must(answer.is_none(), || format!("a file's end answered by {answer:02X?}"))?;
                return Ok(Some(file));
            }
            message = Message::Ack { packet };
        }
        Err("a file without an end".into())
    }

    /// Writes a file, or its first packets. Returns the error code if it was refused; nothing if there is no cable or no mailbox.
    fn write_file(&mut self, name: &[u8], file: &[u8], packets: usize) -> Result<Option<Result<(), u32>>, String> {
        let mut message = Message::Write { password: 0, name };
        let mut rest = file;
        for packet in 0..=packets as u32 {
            let Some(answer) = self.file_message(message)? else {
                return Ok(None);
            };
            match Message::parse(&answer) {
                Some(Message::Ack { packet: number }) if number == packet => {}
                Some(Message::Error { code, .. }) => return Ok(Some(Err(code))),
                _ => return Err(format!("packet {packet} of a file answered by {answer:02X?}")),
            }
            let (data, behind) = rest.split_at(rest.len().min(PACKET));
            message = Message::Data { packet: packet + 1, data };
            rest = behind;
        }
        Ok(Some(Ok(())))
    }

    /// Every saved object is in its line, with the value that it has.
    fn check_backup(&self, backup: &[u8]) -> Verdict {
        let text = String::from_utf8_lossy(backup);
        let mut lines = text.lines().filter(|line| !line.starts_with('#'));
        for entry in DriveObjects::ENTRIES.iter().filter(|entry| entry.access.is_saved()) {
            let unused = 64 - 8 * entry.size() as u32;
            let raw = i64::from_le_bytes(self.present(entry.index, entry.sub)) << unused;
            let value = match entry.data_type.is_signed() {
                true => raw >> unused,
                false => (raw as u64 >> unused) as i64,
            };
            let line = lines.next().unwrap_or_default();
            let expected = format!("{:04X}:{:02X} = {value} #", entry.index, entry.sub);
            must(line.starts_with(&expected), || format!("{line:?} in a backup, not {expected}"))?;
        }
        must(lines.next().is_none(), || "more lines in a backup than parameters".into())
    }

    /// A backup is taken as a whole while the motor stands.
    fn restore(&mut self, backup: &[u8]) -> Verdict {
        let moving = self.bus.drive().device().drive().is_moving();
        let answer = self.write_file(PARAMETERS, backup, backup.len() / PACKET + 1)?;
        self.note(|| format!("backup restored: {answer:X?}, moving: {moving}"));
        match answer {
            None => Ok(()),
            Some(Ok(())) => {
                self.coverage.count("parameters restored from a file");
                must(!moving, || "a file sets parameters of a motor that moves".into())?;
                self.check_backup(backup)?;
                self.cycle()
            }
            Some(Err(code)) => must(moving && code == ErrorCode::AccessDenied.code(), || {
                format!("a backup is refused with {code:X}")
            }),
        }
    }

    /// A file with a mistake sets nothing.
    fn restore_broken(&mut self, backup: &[u8]) -> Verdict {
        let before = values(self.objects());
        let mut broken = backup.to_vec();
        let mistake = self
            .random
            .pick(&["2000:00 = 99\n", "1234:00 = 1\n", "2001:00 = 1 2\n", "6064:00 = 0\n"]);
        let at = broken.iter().position(|byte| *byte == b'\n').map_or(0, |end| end + 1);
        broken.splice(at..at, mistake.bytes());
        let answer = self.write_file(PARAMETERS, &broken, broken.len() / PACKET + 1)?;
        self.note(|| format!("backup with {mistake:?}: {answer:X?}"));
        must(answer != Some(Ok(())), || format!("a file with {mistake:?} is taken"))?;
        must(values(self.objects()) == before, || "a wrong file has set something".into())
    }

    /// Half of a file sets nothing, now or later.
    fn restore_half(&mut self, backup: &[u8]) -> Verdict {
        let before = values(self.objects());
        let packets = self.random.below((backup.len() / PACKET) as u64) as usize;
        let answer = self.write_file(PARAMETERS, backup, packets)?;
        self.note(|| format!("{packets} packets of a backup: {answer:X?}"));
        must(values(self.objects()) == before, || "half a file has set something".into())
    }
}
