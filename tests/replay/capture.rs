//! Captures of `tests/captures`.

use std::path::Path;

use usr2556e::link::pcap::{Direction, Packet, read_pcapng};

/// What was captured of one master's conversation with new drives.
pub struct Capture {
    /// The file's name.
    pub name: &'static str,
    /// How many drives there were.
    pub drives: usize,
    /// Where the inputs of each drive begin in the data of a logical datagram: as the master has laid them out, each in the drive's default mapping.
    pub inputs: &'static [usize],
    /// How many frames are in it at least.
    pub least: usize,
}

/// A frame and its answer.
pub struct Exchange {
    /// When it reached the drives, in ns since the Unix epoch.
    pub arrived: u64,
    /// Up to when the drives were simulated behind it.
    pub simulated: u64,
    /// The frame as it came.
    pub asked: Vec<u8>,
    /// The frame as it went back.
    pub answered: Vec<u8>,
}

impl Capture {
    /// Reads the file.
    pub fn exchanges(&self) -> Vec<Exchange> {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("captures").join(self.name);
        let packets = read_pcapng(&path).unwrap_or_else(|error| panic!("{error}"));
        let (pairs, rest) = packets.as_chunks::<2>();
        assert!(rest.is_empty(), "{}: a frame without an answer", self.name);
        pairs.iter().map(exchange).collect()
    }
}

fn exchange([asked, answered]: &[Packet; 2]) -> Exchange {
    assert_eq!(asked.direction, Some(Direction::Inbound));
    assert_eq!(answered.direction, Some(Direction::Outbound));
    Exchange {
        arrived: asked.timestamp_ns,
        simulated: answered.timestamp_ns,
        asked: asked.data.clone(),
        answered: answered.data.clone(),
    }
}
