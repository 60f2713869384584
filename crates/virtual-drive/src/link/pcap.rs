//! Captures: every frame of a link into a .pcapng file that Wireshark opens, and back out of one for replays.
//!
//! A disk that is full or gone must not stop a drive: a [`Recorder`] goes on without its file, and [`Recorder::finish`] tells.
use pcap_file::pcapng::blocks::enhanced_packet::{EnhancedPacketBlock, EnhancedPacketOption};
use pcap_file::pcapng::blocks::interface_description::{InterfaceDescriptionBlock, InterfaceDescriptionOption};
use pcap_file::pcapng::{Block, PcapNgReader, PcapNgWriter};
use pcap_file::{DataLink, PcapError};
use std::borrow::Cow;
use std::fmt;
use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::time::Duration;

/// So many bytes of capture wait in memory before they are written: some 400 small frames.
const BUFFER: usize = 64 * 1024;

/// Which way a frame went, seen from the end that recorded it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Direction {
    /// The recording end received it.
    Inbound,
    /// The recording end sent it.
    Outbound,
}

/// Writes frames to a .pcapng file with nanosecond time stamps.
pub struct Recorder<W: Write = File> {
    /// `None` after the first failure; what was written until then stays readable.
    writer: Option<PcapNgWriter<BufWriter<W>>>,
    failure: Option<io::Error>,
}

impl Recorder<File> {
    /// Starts a capture in a new file at `path`, in place of one that is there. `interface` is what Wireshark shows as the interface's name.
    pub fn create(path: &Path, interface: &str) -> io::Result<Self> {
        Recorder::new(File::create(path)?, interface)
    }
}

impl<W: Write> Recorder<W> {
    /// Starts a capture in `destination`.
    pub fn new(destination: W, interface: &str) -> io::Result<Self> {
        let writer = PcapNgWriter::new(BufWriter::with_capacity(BUFFER, destination)).map_err(io_error)?;
        let recorder = Recorder {
            writer: Some(writer),
            failure: None,
        };
        recorder.with_interface(interface)
    }

    /// Adds one more interface; each gets the next number. The first has 0.
    pub fn with_interface(mut self, interface: &str) -> io::Result<Self> {
        let options = vec![
            InterfaceDescriptionOption::IfName(Cow::Owned(interface.to_string())),
            InterfaceDescriptionOption::IfTsResol(9),
        ];
        let description = InterfaceDescriptionBlock {
            linktype: DataLink::ETHERNET,
            snaplen: 0,
            options,
        };
        if let Some(writer) = &mut self.writer {
            writer.write_pcapng_block(description).map_err(io_error)?;
        }
        Ok(self)
    }

    /// Adds a frame that passed the first interface at `time`, counted from the Unix epoch. After a failure, does nothing.
    pub fn record(&mut self, time: Duration, direction: Direction, frame: &[u8]) {
        self.record_on(0, time, direction, frame);
    }

    /// Like [`Self::record`], for the interface of that number. Without such an interface, that is a failure.
    pub fn record_on(&mut self, interface: u32, time: Duration, direction: Direction, frame: &[u8]) {
        let Some(writer) = &mut self.writer else { return };
        let block = EnhancedPacketBlock {
            interface_id: interface,
            timestamp: time,
            original_len: u32::try_from(frame.len()).unwrap_or(u32::MAX),
            data: Cow::Borrowed(frame),
            options: vec![EnhancedPacketOption::Flags(direction.flags())],
        };
        if let Err(error) = writer.write_pcapng_block(block) {
            self.failure = Some(io_error(error));
            self.writer = None;
        }
    }

    /// Writes what is still in memory, and tells about the first failure of the whole capture. Dropping a recorder writes it as well, but tells nothing.
    pub fn finish(mut self) -> io::Result<()> {
        match (self.failure.take(), self.writer.take()) {
            (Some(failure), _) => Err(failure),
            (None, Some(mut writer)) => writer.get_mut().flush(),
            (None, None) => Ok(()),
        }
    }
}

impl Direction {
    /// The two lowest bits of a packet's flags (draft-ietf-opsawg-pcapng, 4.3.1).
    fn flags(self) -> u32 {
        match self {
            Direction::Inbound => 1,
            Direction::Outbound => 2,
        }
    }

    fn from_flags(flags: u32) -> Option<Self> {
        match flags & 3 {
            1 => Some(Direction::Inbound),
            2 => Some(Direction::Outbound),
            _ => None,
        }
    }
}

/// One frame of a capture.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Packet {
    /// The number of the interface that it passed.
    pub interface: u32,
    /// When it passed, in nanoseconds since the Unix epoch.
    pub timestamp_ns: u64,
    /// Which way it went, if the capture says.
    pub direction: Option<Direction>,
    /// The frame, from its destination address on.
    pub data: Vec<u8>,
}

/// Why a capture could not be read.
#[derive(Debug)]
pub struct ReadError {
    path: PathBuf,
    reason: Reason,
}

#[derive(Debug)]
enum Reason {
    Io(io::Error),
    NotPcapng,
    /// After so many readable frames.
    Corrupt(usize, PcapError),
    CutOff(usize),
    NotEthernet(DataLink),
}

/// Reads all Ethernet frames of a .pcapng file, in the order of the file.
pub fn read_pcapng(path: &Path) -> Result<Vec<Packet>, ReadError> {
    let failed = |reason| ReadError { path: path.into(), reason };
    let file = File::open(path).map_err(|error| failed(Reason::Io(error)))?;
    read(file).map_err(failed)
}

fn read(source: impl io::Read) -> Result<Vec<Packet>, Reason> {
    let mut reader = PcapNgReader::new(source).map_err(|error| match error {
        PcapError::IoError(error) if error.kind() != io::ErrorKind::UnexpectedEof => Reason::Io(error),
        _ => Reason::NotPcapng,
    })?;
    let mut packets = Vec::new();
    loop {
        // One after the other, as the reader lends its buffer to each block.
        let packet = match reader.next_block() {
            None => return Ok(packets),
            Some(Ok(Block::EnhancedPacket(packet))) => packet.into_owned(),
            Some(Ok(_)) => continue,
            Some(Err(PcapError::IoError(error))) if error.kind() == io::ErrorKind::UnexpectedEof => {
                return Err(Reason::CutOff(packets.len()));
            }
            Some(Err(PcapError::IoError(error))) => return Err(Reason::Io(error)),
            Some(Err(error)) => return Err(Reason::Corrupt(packets.len(), error)),
        };
        let Some(interface) = reader.packet_interface(&packet) else {
            return Err(Reason::Corrupt(packets.len(), PcapError::InvalidInterfaceId(packet.interface_id)));
        };
        if interface.linktype != DataLink::ETHERNET {
            return Err(Reason::NotEthernet(interface.linktype));
        }
        let direction = packet.options.iter().find_map(|option| match option {
            EnhancedPacketOption::Flags(flags) => Direction::from_flags(*flags),
            _ => None,
        });
        packets.push(Packet {
            interface: packet.interface_id,
            timestamp_ns: nanoseconds(packet.timestamp, interface),
            direction,
            data: packet.data.into_owned(),
        });
    }
}

/// The reader takes every time stamp for nanoseconds; what its unit is, the interface's description says (6: microseconds, without one as well).
fn nanoseconds(timestamp: Duration, interface: &InterfaceDescriptionBlock<'_>) -> u64 {
    let units = timestamp.as_nanos();
    let resolution = interface.options.iter().find_map(|option| match option {
        InterfaceDescriptionOption::IfTsResol(resolution) => Some(*resolution),
        _ => None,
    });
    let exponent = u32::from(resolution.unwrap_or(6) & 0x7F);
    let nanoseconds = match resolution {
        // The highest bit makes it a power of two.
        Some(resolution) if resolution & 0x80 != 0 => units.saturating_mul(1_000_000_000).checked_shr(exponent).unwrap_or(0),
        _ if exponent <= 9 => units.saturating_mul(10_u128.pow(9 - exponent)),
        _ => units / 10_u128.checked_pow(exponent - 9).unwrap_or(u128::MAX),
    };
    u64::try_from(nanoseconds).unwrap_or(u64::MAX)
}

fn io_error(error: PcapError) -> io::Error {
    match error {
        PcapError::IoError(error) => error,
        other => io::Error::other(other),
    }
}

impl fmt::Display for ReadError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let path = self.path.display();
        match &self.reason {
            Reason::Io(error) => write!(f, "could not read capture {path}: {error}"),
            Reason::NotPcapng => {
                write!(
                    f,
                    "{path} is not a .pcapng capture; from another format, Wireshark's \"editcap -F pcapng {path} NEW\" makes one"
                )
            }
            Reason::Corrupt(frames, error) => write!(f, "capture {path} is corrupt after {frames} frames: {error}"),
            Reason::CutOff(frames) => {
                write!(
                    f,
                    "capture {path} is cut off after {frames} frames: whatever recorded it did not get to the end"
                )
            }
            Reason::NotEthernet(kind) => write!(f, "capture {path} holds {kind:?} packets, not Ethernet frames"),
        }
    }
}

impl std::error::Error for ReadError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match &self.reason {
            Reason::Io(error) => Some(error),
            Reason::Corrupt(_, error) => Some(error),
            Reason::NotPcapng | Reason::CutOff(_) | Reason::NotEthernet(_) => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// A disk with this many bytes left.
    struct SmallDisk(usize);

    impl Write for SmallDisk {
        fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
            if self.0 < bytes.len() {
                return Err(io::ErrorKind::StorageFull.into());
            }
            self.0 -= bytes.len();
            Ok(bytes.len())
        }

        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }

    fn capture(frames: &[(u64, Direction, Vec<u8>)]) -> Vec<u8> {
        let mut file = Vec::new();
        let mut recorder = Recorder::new(&mut file, "veth-drive").unwrap();
        for (time, direction, frame) in frames {
            recorder.record(Duration::from_nanos(*time), *direction, frame);
        }
        recorder.finish().unwrap();
        file
    }

    #[test]
    fn a_dropped_recorder_loses_nothing() {
        let mut file = Vec::new();
        let mut recorder = Recorder::new(&mut file, "veth-drive").unwrap();
        recorder.record(Duration::from_secs(1), Direction::Inbound, &[7; 60]);
        drop(recorder);
        assert_eq!(read(&file[..]).unwrap().len(), 1);
    }

    #[test]
    fn frames_of_two_interfaces_stay_apart_and_a_third_is_a_failure() {
        let mut file = Vec::new();
        let mut recorder = Recorder::new(&mut file, "one").unwrap().with_interface("other").unwrap();
        for interface in [1, 0, 1] {
            recorder.record_on(interface, Duration::from_secs(1), Direction::Inbound, &[7; 60]);
        }
        recorder.finish().unwrap();
        let interfaces: Vec<u32> = read(&file[..]).unwrap().iter().map(|packet| packet.interface).collect();
        assert_eq!(interfaces, [1, 0, 1]);

        let mut recorder = Recorder::new(Vec::new(), "one").unwrap();
        recorder.record_on(1, Duration::from_secs(1), Direction::Inbound, &[7; 60]);
        assert!(recorder.finish().is_err());
    }

    #[test]
    fn a_full_disk_stops_the_recording_and_the_end_tells() {
        let mut recorder = Recorder::new(SmallDisk(100_000), "veth-drive").unwrap();
        for second in 0..200 {
            recorder.record(Duration::from_secs(second), Direction::Inbound, &[0; 1500]);
        }
        assert_eq!(recorder.finish().unwrap_err().kind(), io::ErrorKind::StorageFull);
    }

    #[test]
    fn time_stamps_come_back_in_nanoseconds_whatever_their_unit() {
        for (resolution, units, expected) in [
            (Some(9), 1_234, 1_234),
            (Some(6), 5, 5_000),
            (None, 5, 5_000),
            (Some(12), 5_000, 5),
            (Some(0x80 | 10), 1024, 1_000_000_000),
        ] {
            let options = resolution.map(InterfaceDescriptionOption::IfTsResol).into_iter().collect();
            let interface = InterfaceDescriptionBlock {
                linktype: DataLink::ETHERNET,
                snaplen: 0,
                options,
            };
            assert_eq!(nanoseconds(Duration::from_nanos(units), &interface), expected, "{resolution:?}");
        }
    }

    #[test]
    fn what_is_no_capture_is_refused_with_its_path_and_a_remedy() {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("Cargo.toml");
        let text = read_pcapng(&path).unwrap_err().to_string();
        assert!(text.contains("Cargo.toml") && text.contains("editcap -F pcapng"), "{text}");
        let text = read_pcapng(Path::new("/no/such/file.pcapng")).unwrap_err().to_string();
        assert!(text.starts_with("could not read capture /no/such/file.pcapng: "), "{text}");
    }

    #[test]
    fn a_cut_off_capture_says_how_much_of_it_was_readable() {
        let file = capture(&[(1, Direction::Inbound, vec![0; 60]), (2, Direction::Outbound, vec![0; 60])]);
        assert!(matches!(read(&file[..file.len() - 5]), Err(Reason::CutOff(1))));
    }

    fn frames() -> impl Strategy<Value = Vec<(u64, Direction, Vec<u8>)>> {
        let direction = prop_oneof![Just(Direction::Inbound), Just(Direction::Outbound)];
        proptest::collection::vec((any::<u64>(), direction, proptest::collection::vec(any::<u8>(), 0..1522)), 0..8)
    }

    proptest! {
        // Each run reads with the 8 MB buffer that the reader takes.
        #![proptest_config(ProptestConfig::with_cases(64))]

        #[test]
        fn every_frame_comes_back_as_it_was_recorded(frames in frames()) {
            let packets = read(&capture(&frames)[..]).unwrap();
            let back: Vec<_> = packets.into_iter().map(|packet| (packet.timestamp_ns, packet.direction.unwrap(), packet.data)).collect();
            prop_assert_eq!(back, frames);
        }

        #[test]
        fn a_corrupt_capture_is_an_error_or_fewer_frames_but_never_a_panic(
            frames in frames(),
            damage in proptest::collection::vec((any::<proptest::sample::Index>(), any::<u8>()), 1..8),
        ) {
            let mut file = capture(&frames);
            for (place, value) in damage {
                let place = place.index(file.len());
                file[place] = value;
            }
            if let Ok(packets) = read(&file[..]) {
                prop_assert!(packets.iter().map(|packet| packet.data.len()).sum::<usize>() <= file.len());
            }
        }
    }
}
