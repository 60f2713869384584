//! The mailbox header and mailbox error replies (ETG.1000.4, mailbox; ETG.1000.6, mailbox error).

/// Bytes of the mailbox header.
pub const HEADER_SIZE: usize = 6;

/// The protocol a mailbox message belongs to: bits 3:0 of the header's last byte.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Protocol(pub u8);

impl Protocol {
    /// Mailbox error reply.
    pub const ERROR: Self = Self(0);
    /// ADS over EtherCAT.
    pub const AOE: Self = Self(1);
    /// Ethernet over EtherCAT.
    pub const EOE: Self = Self(2);
    /// CANopen over EtherCAT.
    pub const COE: Self = Self(3);
    /// File access over EtherCAT.
    pub const FOE: Self = Self(4);
    /// Servo drive profile over EtherCAT.
    pub const SOE: Self = Self(5);
    /// Vendor specific.
    pub const VOE: Self = Self(15);
}

/// The header before every mailbox message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Header {
    /// Bytes after the header.
    pub length: u16,
    /// Station address of the originator, 0 for the master.
    pub address: u16,
    /// Channel in bits 5:0, priority in bits 7:6.
    pub channel: u8,
    /// Who the message is for.
    pub protocol: Protocol,
    /// 1 to 7 tells a repeated message from a new one; 0 switches that off.
    pub counter: u8,
}

impl Header {
    /// The header at the front of `message`; `None` if the message is shorter than one.
    pub fn parse(message: &[u8]) -> Option<Self> {
        let &[l0, l1, a0, a1, channel, kind] = message.first_chunk::<HEADER_SIZE>()?;
        Some(Self {
            length: u16::from_le_bytes([l0, l1]),
            address: u16::from_le_bytes([a0, a1]),
            channel,
            protocol: Protocol(kind & 0x0F),
            counter: kind >> 4 & 0x07,
        })
    }

    /// The header as it crosses the wire.
    pub const fn bytes(&self) -> [u8; HEADER_SIZE] {
        let [l0, l1] = self.length.to_le_bytes();
        let [a0, a1] = self.address.to_le_bytes();
        [l0, l1, a0, a1, self.channel, (self.protocol.0 & 0x0F) | (self.counter & 0x07) << 4]
    }
}

macro_rules! mailbox_errors {
    ($($(#[$meta:meta])* $name:ident = $code:literal,)+) => {
        /// Why a mailbox message was not processed (ETG.1000.6, mailbox error detail).
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        #[repr(u16)]
        pub enum MailboxError {
            $($(#[$meta])* $name = $code,)+
        }

        impl MailboxError {
            /// All errors.
            pub const ALL: &'static [Self] = &[$(Self::$name),+];
        }
    };
}

mailbox_errors! {
    /// The header's syntax is wrong.
    Syntax = 1,
    /// The protocol is not supported.
    UnsupportedProtocol = 2,
    /// The channel is not valid.
    InvalidChannel = 3,
    /// The protocol's service is not supported.
    ServiceNotSupported = 4,
    /// The protocol's header is wrong.
    InvalidHeader = 5,
    /// The message is shorter than its protocol needs.
    SizeTooShort = 6,
    /// No memory for the message.
    NoMemory = 7,
    /// The length does not fit the mailbox.
    InvalidSize = 8,
    /// A service is being processed already.
    ServiceInWork = 9,
}

impl MailboxError {
    /// The four bytes after the header of an error reply.
    pub const fn bytes(self) -> [u8; 4] {
        let [low, high] = (self as u16).to_le_bytes();
        [1, 0, low, high]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_header_survives_the_wire() {
        for counter in 0..8 {
            for protocol in 0..16 {
                let header = Header {
                    length: 0x1234,
                    address: 0x5678,
                    channel: 0xC1,
                    protocol: Protocol(protocol),
                    counter,
                };
                assert_eq!(Header::parse(&header.bytes()), Some(header));
            }
        }
        assert_eq!(Header::parse(&[0; HEADER_SIZE - 1]), None);
    }

    #[test]
    fn a_header_is_laid_out_as_masters_send_it() {
        let header = Header {
            length: 10,
            address: 0,
            channel: 0,
            protocol: Protocol::COE,
            counter: 7,
        };
        assert_eq!(header.bytes(), [10, 0, 0, 0, 0, 0x73]);
        assert_eq!(MailboxError::InvalidSize.bytes(), [1, 0, 8, 0]);
    }
}
