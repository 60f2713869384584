//! Building frames of datagrams.

use super::{
    Command, DATAGRAM_HEADER, ETHERCAT_HEADER, ETHERNET_HEADER, ETHERTYPE, ETHERTYPE_VLAN, MAX_LENGTH, MORE_FOLLOWS, SOURCE_ADDRESS,
    TYPE_DATAGRAMS, VLAN_TAG, WORKING_COUNTER,
};

/// What a buffer or the EtherCAT header has no room for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NoRoom;

/// Builds a frame of datagrams in a buffer.
#[derive(Debug)]
pub struct FrameBuilder<'b> {
    buffer: &'b mut [u8],
    header: usize,
    end: usize,
    last: Option<usize>,
}

impl<'b> FrameBuilder<'b> {
    /// Begins a frame to everybody from `source`.
    pub fn new(buffer: &'b mut [u8], source: [u8; 6]) -> Result<Self, NoRoom> {
        Self::begin(buffer, source, None)
    }

    /// Begins a frame with an 802.1Q tag whose control information is `tag`.
    pub fn tagged(buffer: &'b mut [u8], source: [u8; 6], tag: u16) -> Result<Self, NoRoom> {
        Self::begin(buffer, source, Some(tag))
    }

    fn begin(buffer: &'b mut [u8], source: [u8; 6], tag: Option<u16>) -> Result<Self, NoRoom> {
        let header = ETHERNET_HEADER + if tag.is_some() { VLAN_TAG } else { 0 };
        let end = header + ETHERCAT_HEADER;
        let bytes = buffer.get_mut(..end).ok_or(NoRoom)?;
        bytes[..SOURCE_ADDRESS].fill(0xFF);
        bytes[SOURCE_ADDRESS..SOURCE_ADDRESS + 6].copy_from_slice(&source);
        if let Some(tag) = tag {
            bytes[12..14].copy_from_slice(&ETHERTYPE_VLAN.to_be_bytes());
            bytes[14..16].copy_from_slice(&tag.to_be_bytes());
        }
        bytes[header - 2..header].copy_from_slice(&ETHERTYPE.to_be_bytes());
        Ok(Self {
            buffer,
            header,
            end,
            last: None,
        })
    }

    /// Appends a datagram. `address` is a logical one or a [`physical_address`](super::physical_address).
    pub fn datagram(&mut self, command: Command, index: u8, address: u32, data: &[u8]) -> Result<&mut Self, NoRoom> {
        let start = self.end;
        let end = start + DATAGRAM_HEADER + data.len() + WORKING_COUNTER;
        if end - self.header - ETHERCAT_HEADER > MAX_LENGTH {
            return Err(NoRoom);
        }
        let bytes = self.buffer.get_mut(start..end).ok_or(NoRoom)?;
        bytes.fill(0);
        bytes[0] = command.into();
        bytes[1] = index;
        bytes[2..6].copy_from_slice(&address.to_le_bytes());
        // The check against MAX_LENGTH above keeps the length within its field.
        bytes[6..8].copy_from_slice(&(data.len() as u16).to_le_bytes());
        bytes[DATAGRAM_HEADER..DATAGRAM_HEADER + data.len()].copy_from_slice(data);
        if let Some(last) = self.last {
            self.buffer[last + 7] |= (MORE_FOLLOWS >> 8) as u8;
        }
        self.last = Some(start);
        self.end = end;
        Ok(self)
    }

    /// Writes the EtherCAT header; the frame's length in bytes, without padding.
    pub fn finish(&mut self) -> usize {
        let length = (self.end - self.header - ETHERCAT_HEADER) as u16;
        let word = length | u16::from(TYPE_DATAGRAMS) << 12;
        self.buffer[self.header..self.header + ETHERCAT_HEADER].copy_from_slice(&word.to_le_bytes());
        self.end
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SOURCE: [u8; 6] = [0x10; 6];

    #[test]
    fn builder_refuses_what_does_not_fit() {
        let mut buffer = [0; 3000];
        assert_eq!(FrameBuilder::new(&mut buffer[..15], SOURCE).err(), Some(NoRoom));
        let mut builder = FrameBuilder::new(&mut buffer, SOURCE).unwrap();
        assert!(builder.datagram(Command::Nop, 0, 0, &[0; MAX_LENGTH - 11]).is_err());
        assert!(builder.datagram(Command::Nop, 0, 0, &[0; MAX_LENGTH - 12]).is_ok());
        assert!(builder.datagram(Command::Nop, 0, 0, &[]).is_err());
    }
}
