//! The FoE server: one transfer at a time (ETG.1000.6, FoE).

use core::fmt::Arguments;

use heapless::Vec;
use wire::foe::{ErrorCode, HEADER_SIZE, Message};
use wire::mailbox;

use crate::application::Application;
use crate::configuration::MAX_MAILBOX;
use crate::device_objects::DeviceObjects;
use crate::event_log::Event;
use crate::event_log::report::{self, Span};
use crate::files::{FileError, Line};

/// Bytes of a message before the data.
const OVERHEAD: usize = mailbox::HEADER_SIZE + HEADER_SIZE;

/// The server of file transfers. What was written of a file has no effect if its transfer does not come to its end.
#[derive(Clone, Debug, Default)]
pub(crate) struct FileServer {
    transfer: Transfer,
}

/// The transfer under way, if there is one.
#[derive(Clone, Debug, Default)]
#[expect(clippy::large_enum_variant, reason = "there is one, and no allocator to box it")]
enum Transfer {
    #[default]
    None,
    Reading(Reading),
    Writing(Writing),
}

/// A file on its way to the master.
#[derive(Clone, Debug)]
struct Reading {
    source: Source,
    /// The next line of the file.
    line: usize,
    /// The line before it, and how much of it was sent: the end of a line is that of its beginning, whatever changes in between.
    begun: Line,
    sent: usize,
    /// The packet sent last.
    packet: u32,
    data: Vec<u8, MAX_MAILBOX>,
    /// Whether it was the last.
    last: bool,
}

/// What is read.
#[derive(Clone, Copy, Debug)]
enum Source {
    EventLog(Span),
    /// The file at a position of [`Application::files`].
    Application(usize),
}

/// A file on its way from the master.
#[derive(Clone, Copy, Debug)]
struct Writing {
    /// Its position in [`Application::files`].
    file: usize,
    /// The packet taken last.
    packet: u32,
    /// Whether it was the last.
    last: bool,
}

/// What a message leads to when nothing is wrong with it.
enum Step {
    /// The next packet of the file that is read.
    Next,
    /// The packet sent last.
    Again,
    /// The packet was taken.
    Ack(u32),
    /// Nothing.
    Done,
}

/// What a message is answered with.
pub(crate) enum FileAnswer<'s> {
    Message(Message<'s>),
    Error(FileError),
}

/// The lengths of both mailboxes, in bytes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Capacity {
    /// That of requests.
    pub(crate) request: usize,
    /// That of answers.
    pub(crate) answer: usize,
}

impl Capacity {
    /// Bytes of data that a request can carry.
    fn of_requests(self) -> usize {
        self.request.min(MAX_MAILBOX).saturating_sub(OVERHEAD)
    }

    /// Bytes of data, or of an error's text, that an answer can carry.
    pub(crate) fn of_answers(self) -> usize {
        self.answer.min(MAX_MAILBOX).saturating_sub(OVERHEAD)
    }
}

impl FileServer {
    /// Forgets the transfer under way.
    pub(crate) fn reset(&mut self) {
        self.transfer = Transfer::None;
    }

    /// Serves a message; `device` is the name in reports. The acknowledgement of the last packet has no answer, nor has an error.
    ///
    /// Whatever fails ends the transfer. A new request ends it too: its master may have gone.
    pub(crate) fn serve(
        &mut self,
        message: Message<'_>,
        objects: &mut DeviceObjects<'_, impl Application>,
        device: &str,
        capacity: Capacity,
    ) -> Option<FileAnswer<'_>> {
        let step = match message {
            Message::Read { name, .. } => self.begin_reading(name, objects),
            Message::Write { name, .. } => self.begin_writing(name, objects),
            Message::Data { packet, data } => self.take(packet, data, capacity.of_requests(), objects),
            Message::Ack { packet } => self.acknowledged(packet),
            Message::Busy { .. } => self.repeat(),
            Message::Error { .. } => {
                self.reset();
                Ok(Step::Done)
            }
            Message::Unknown(code) => Err(illegal(format_args!("there is no operation {code}"))),
        };
        match step {
            Ok(Step::Next) => {
                self.fill(objects, device, capacity.of_answers());
                self.packet()
            }
            Ok(Step::Again) => self.packet(),
            Ok(Step::Ack(packet)) => Some(FileAnswer::Message(Message::Ack { packet })),
            Ok(Step::Done) => None,
            Err(error) => {
                self.reset();
                Some(FileAnswer::Error(error))
            }
        }
    }

    fn begin_reading(&mut self, name: &[u8], objects: &DeviceObjects<'_, impl Application>) -> Result<Step, FileError> {
        let source = if trimmed(name) == report::FILE.as_bytes() {
            Source::EventLog(objects.area.log.span())
        } else {
            Source::Application(position(name, objects)?)
        };
        self.transfer = Transfer::Reading(Reading {
            source,
            line: 0,
            begun: Line::new(),
            sent: 0,
            packet: 0,
            data: Vec::new(),
            last: false,
        });
        Ok(Step::Next)
    }

    fn begin_writing(&mut self, name: &[u8], objects: &mut DeviceObjects<'_, impl Application>) -> Result<Step, FileError> {
        let read_only = || FileError::new(ErrorCode::AccessDenied, format_args!("this file can be read only"));
        if trimmed(name) == report::FILE.as_bytes() {
            return Err(read_only());
        }
        let file = position(name, objects)?;
        if !objects.application.files()[file].writable {
            return Err(read_only());
        }
        objects.application.begin_file(file)?;
        self.transfer = Transfer::Writing(Writing {
            file,
            packet: 0,
            last: false,
        });
        Ok(Step::Ack(0))
    }

    /// Takes a packet of at most `room` bytes; one with fewer is the last. A packet that was taken already is acknowledged once more.
    fn take(
        &mut self,
        packet: u32,
        data: &[u8],
        room: usize,
        objects: &mut DeviceObjects<'_, impl Application>,
    ) -> Result<Step, FileError> {
        let Transfer::Writing(writing) = &mut self.transfer else {
            return Err(illegal(format_args!("no file is being written")));
        };
        if packet == writing.packet && packet != 0 {
            return Ok(Step::Ack(packet));
        }
        if writing.last {
            return Err(illegal(format_args!("the file has ended")));
        }
        let due = writing.packet.wrapping_add(1);
        if packet != due {
            return Err(wrong_packet(packet, due));
        }
        writing.packet = packet;
        objects.application.write_file(writing.file, data)?;
        if data.len() < room {
            objects.application.finish_file(writing.file)?;
            writing.last = true;
            objects
                .area
                .log
                .add(Event::FileWritten(objects.application.files()[writing.file].name));
        }
        Ok(Step::Ack(packet))
    }

    fn acknowledged(&mut self, packet: u32) -> Result<Step, FileError> {
        let Transfer::Reading(reading) = &self.transfer else {
            return Err(illegal(format_args!("no file is being read")));
        };
        if packet != reading.packet {
            return Err(wrong_packet(packet, reading.packet));
        }
        if reading.last {
            self.reset();
            return Ok(Step::Done);
        }
        Ok(Step::Next)
    }

    /// The master was busy: it wants the last packet again.
    fn repeat(&self) -> Result<Step, FileError> {
        match self.transfer {
            Transfer::Reading(_) => Ok(Step::Again),
            Transfer::None | Transfer::Writing(_) => Err(illegal(format_args!("no file is being read"))),
        }
    }

    /// Makes the next packet of the file that is read: of `room` bytes, or fewer at the end of the file.
    fn fill(&mut self, objects: &DeviceObjects<'_, impl Application>, device: &str, room: usize) {
        let Transfer::Reading(reading) = &mut self.transfer else { return };
        reading.packet = reading.packet.wrapping_add(1);
        reading.data.clear();
        while reading.data.len() < room {
            if reading.sent == reading.begun.len() {
                reading.begun.clear();
                reading.sent = 0;
                let there_is = match reading.source {
                    Source::EventLog(span) => objects.area.log.line(span, device, reading.line, &mut reading.begun),
                    Source::Application(file) => objects.application.file_line(file, reading.line, &mut reading.begun),
                };
                reading.last = !there_is;
                if reading.last {
                    return;
                }
                reading.line += 1;
            }
            let rest = &reading.begun.as_bytes()[reading.sent..];
            let rest = &rest[..rest.len().min(room - reading.data.len())];
            // `room` is less than the longest mailbox.
            _ = reading.data.extend_from_slice(rest);
            reading.sent += rest.len();
        }
    }

    fn packet(&self) -> Option<FileAnswer<'_>> {
        match &self.transfer {
            Transfer::Reading(Reading { packet, data, .. }) => Some(FileAnswer::Message(Message::Data { packet: *packet, data })),
            Transfer::None | Transfer::Writing(_) => None,
        }
    }
}

/// The position of the file with this name among the application's.
fn position(name: &[u8], objects: &DeviceObjects<'_, impl Application>) -> Result<usize, FileError> {
    let name = trimmed(name);
    let found = objects.application.files().iter().position(|file| file.name.as_bytes() == name);
    found.ok_or_else(|| FileError::new(ErrorCode::NotFound, format_args!("there is no such file")))
}

/// A name without the zeros that some masters send behind it.
fn trimmed(name: &[u8]) -> &[u8] {
    let end = name.iter().position(|&byte| byte == 0).unwrap_or(name.len());
    &name[..end]
}

fn illegal(reason: Arguments<'_>) -> FileError {
    FileError::new(ErrorCode::Illegal, reason)
}

fn wrong_packet(packet: u32, due: u32) -> FileError {
    FileError::new(ErrorCode::PacketNumber, format_args!("packet {packet} came where {due} was due"))
}
