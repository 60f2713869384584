//! File access over EtherCAT (ETG.1000.6, FoE).

/// Bytes of the FoE header.
pub const HEADER_SIZE: usize = 6;

/// Operation codes.
mod operation {
    pub(super) const READ: u8 = 1;
    pub(super) const WRITE: u8 = 2;
    pub(super) const DATA: u8 = 3;
    pub(super) const ACK: u8 = 4;
    pub(super) const ERROR: u8 = 5;
    pub(super) const BUSY: u8 = 6;
}

/// A message of either side.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Message<'a> {
    /// Asks to read a file.
    Read {
        /// The password; 0 for none.
        password: u32,
        /// The file's name.
        name: &'a [u8],
    },
    /// Asks to write a file.
    Write {
        /// The password; 0 for none.
        password: u32,
        /// The file's name.
        name: &'a [u8],
    },
    /// The next bytes of the file; fewer than fit are the last.
    Data {
        /// Counts from 1.
        packet: u32,
        /// The bytes.
        data: &'a [u8],
    },
    /// Data were taken, or with packet 0 that they may come.
    Ack {
        /// The packet that was taken.
        packet: u32,
    },
    /// The transfer failed.
    Error {
        /// Why, one of [`ErrorCode`] or another.
        code: u32,
        /// The same in words.
        text: &'a [u8],
    },
    /// The message before this one shall be sent again later.
    Busy {
        /// How much is done of `entire`.
        done: u16,
        /// All there is to do.
        entire: u16,
        /// What is being done, in words.
        text: &'a [u8],
    },
    /// An operation that does not exist.
    Unknown(u8),
}

impl<'a> Message<'a> {
    /// The message in `body`, the bytes after the mailbox header; `None` if there are fewer than [`HEADER_SIZE`].
    pub fn parse(body: &'a [u8]) -> Option<Self> {
        let (&[code, _, n0, n1, n2, n3], rest) = body.split_first_chunk::<HEADER_SIZE>()?;
        let number = u32::from_le_bytes([n0, n1, n2, n3]);
        Some(match code {
            operation::READ => Self::Read {
                password: number,
                name: rest,
            },
            operation::WRITE => Self::Write {
                password: number,
                name: rest,
            },
            operation::DATA => Self::Data {
                packet: number,
                data: rest,
            },
            operation::ACK => Self::Ack { packet: number },
            operation::ERROR => Self::Error { code: number, text: rest },
            operation::BUSY => Self::Busy {
                done: u16::from_le_bytes([n0, n1]),
                entire: u16::from_le_bytes([n2, n3]),
                text: rest,
            },
            unknown => Self::Unknown(unknown),
        })
    }

    /// The message's header and the bytes that follow it.
    pub fn parts(&self) -> ([u8; HEADER_SIZE], &'a [u8]) {
        let (code, number, rest) = match *self {
            Self::Read { password, name } => (operation::READ, password, name),
            Self::Write { password, name } => (operation::WRITE, password, name),
            Self::Data { packet, data } => (operation::DATA, packet, data),
            Self::Ack { packet } => (operation::ACK, packet, &[][..]),
            Self::Error { code, text } => (operation::ERROR, code, text),
            Self::Busy { done, entire, text } => (operation::BUSY, u32::from(entire) << 16 | u32::from(done), text),
            Self::Unknown(code) => (code, 0, &[][..]),
        };
        let [n0, n1, n2, n3] = number.to_le_bytes();
        ([code, 0, n0, n1, n2, n3], rest)
    }
}

/// Why a transfer failed (ETG.1000.6, FoE error codes; ETG.1020).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub enum ErrorCode {
    /// None of the others.
    NotDefined = 0x8000,
    /// No such file.
    NotFound = 0x8001,
    /// The file cannot be read or written now, or never.
    AccessDenied = 0x8002,
    /// No room for the file.
    DiskFull = 0x8003,
    /// The operation does not exist, or does not belong to a transfer.
    Illegal = 0x8004,
    /// The packet is not the one that is due.
    PacketNumber = 0x8005,
    /// There is such a file already.
    AlreadyExists = 0x8006,
    /// No such user.
    NoUser = 0x8007,
    /// The file is for the bootstrap state only.
    BootstrapOnly = 0x8008,
    /// The file is not for the bootstrap state.
    NotInBootstrap = 0x8009,
    /// The password is wrong.
    NoRights = 0x800A,
    /// The program cannot say why.
    ProgramError = 0x800B,
    /// The file's checksum is wrong.
    InvalidChecksum = 0x800C,
    /// The firmware is not for this hardware.
    InvalidFirmware = 0x800D,
    /// The file's header is missing or wrong.
    NoFileHeader = 0x8010,
    /// The flash memory cannot be accessed.
    FlashError = 0x8011,
}

impl ErrorCode {
    /// The code as it crosses the wire.
    pub const fn code(self) -> u32 {
        self as u32
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn messages_are_laid_out_as_masters_send_and_parse_them() {
        for (bytes, message) in [
            (
                &b"\x01\x00\x04\x03\x02\x01log"[..],
                Message::Read {
                    password: 0x0102_0304,
                    name: b"log",
                },
            ),
            (b"\x02\x00\x00\x00\x00\x00par", Message::Write { password: 0, name: b"par" }),
            (b"\x03\x00\x01\x00\x00\x00\xAA", Message::Data { packet: 1, data: &[0xAA] }),
            (b"\x04\x00\x00\x01\x00\x00", Message::Ack { packet: 0x100 }),
            (
                b"\x05\x00\x01\x80\x00\x00no",
                Message::Error {
                    code: ErrorCode::NotFound.code(),
                    text: b"no",
                },
            ),
            (
                b"\x06\x00\x01\x00\x03\x00wait",
                Message::Busy {
                    done: 1,
                    entire: 3,
                    text: b"wait",
                },
            ),
        ] {
            assert_eq!(Message::parse(bytes), Some(message));
            let (header, rest) = message.parts();
            assert_eq!((&header[..], rest), bytes.split_at(HEADER_SIZE));
        }
    }

    #[test]
    fn other_operations_are_unknown_and_less_than_a_header_is_nothing() {
        for code in (0..=255).filter(|code| !(1..=6).contains(code)) {
            assert_eq!(Message::parse(&[code, 0, 0, 0, 0, 0]), Some(Message::Unknown(code)));
        }
        assert_eq!(Message::parse(&[3, 0, 1, 0, 0]), None);
    }
}
