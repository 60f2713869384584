//! SDO uploads and downloads (ETG.1000.6, SDO services).

use super::Service;

/// Bytes of an SDO request or response without data beyond its first eight bytes, and the least a segment has.
pub const SDO_SIZE: usize = 8;
/// Data bytes in the shortest segment.
pub const SHORT_SEGMENT: usize = 7;

/// What an SDO service is about.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Address {
    /// Index of the object.
    pub index: u16,
    /// Sub-index.
    pub sub: u8,
}

/// A request to an SDO server.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SdoRequest<'a> {
    /// Starts a download, expedited or normal.
    Download {
        /// What to write.
        address: Address,
        /// Whether all sub-indices from `address.sub` on are meant.
        complete: bool,
        /// Bytes of the whole value.
        size: u32,
        /// The first bytes of the value; all of them when expedited.
        data: &'a [u8],
    },
    /// Goes on with a download.
    DownloadSegment {
        /// Alternates from segment to segment.
        toggle: bool,
        /// Whether this segment is the last.
        last: bool,
        /// The next bytes of the value.
        data: &'a [u8],
    },
    /// Starts an upload.
    Upload {
        /// What to read.
        address: Address,
        /// Whether all sub-indices from `address.sub` on are meant.
        complete: bool,
    },
    /// Goes on with an upload.
    UploadSegment {
        /// Alternates from segment to segment.
        toggle: bool,
    },
    /// Ends a transfer.
    Abort,
    /// A command specifier that does not exist.
    Unknown(Address),
}

impl<'a> SdoRequest<'a> {
    /// The request in `body`, the bytes after the CoE header; `None` if there are fewer than [`SDO_SIZE`].
    pub fn parse(body: &'a [u8]) -> Option<Self> {
        let &[command, i0, i1, sub, s0, s1, s2, s3] = body.first_chunk::<SDO_SIZE>()?;
        let address = Address {
            index: u16::from_le_bytes([i0, i1]),
            sub,
        };
        let complete = command & 0x10 != 0;
        let toggle = command & 0x10 != 0;
        Some(match command >> 5 {
            0 => Self::DownloadSegment {
                toggle,
                last: command & 1 != 0,
                data: segment_data(command, body),
            },
            1 if command & 2 != 0 => {
                // Without a size indication all four bytes count.
                let unused = if command & 1 != 0 { usize::from(command >> 2 & 3) } else { 0 };
                let data = &body[4..SDO_SIZE - unused];
                Self::Download {
                    address,
                    complete,
                    size: 4 - unused as u32,
                    data,
                }
            }
            1 => {
                let data = &body[SDO_SIZE..];
                let size = if command & 1 != 0 {
                    u32::from_le_bytes([s0, s1, s2, s3])
                } else {
                    u32::try_from(data.len()).unwrap_or(u32::MAX)
                };
                Self::Download {
                    address,
                    complete,
                    size,
                    data,
                }
            }
            2 => Self::Upload { address, complete },
            3 => Self::UploadSegment { toggle },
            4 => Self::Abort,
            _ => Self::Unknown(address),
        })
    }
}

/// The bytes a segment carries: all after the command, but in a segment of the shortest form bits 3:1 tell how many of seven are not used.
fn segment_data(command: u8, body: &[u8]) -> &[u8] {
    let unused = if body.len() == SDO_SIZE { usize::from(command >> 1 & 7) } else { 0 };
    &body[1..body.len() - unused]
}

/// An answer of an SDO server.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SdoResponse<'a> {
    /// A download was taken or started.
    Downloaded(Address),
    /// A segment of a download was taken.
    SegmentTaken {
        /// The segment's toggle.
        toggle: bool,
    },
    /// A value of one to four bytes.
    Expedited {
        /// What was read.
        address: Address,
        /// Whether all sub-indices from `address.sub` on were read.
        complete: bool,
        /// The value.
        data: &'a [u8],
    },
    /// The first bytes of a longer, or empty, value.
    Normal {
        /// What is read.
        address: Address,
        /// Whether all sub-indices from `address.sub` on are read.
        complete: bool,
        /// Bytes of the whole value.
        size: u32,
        /// The first bytes.
        data: &'a [u8],
    },
    /// More bytes of a value.
    Segment {
        /// The request's toggle.
        toggle: bool,
        /// Whether the value ends here.
        last: bool,
        /// The bytes.
        data: &'a [u8],
    },
    /// The transfer failed.
    Abort {
        /// What was to be read or written.
        address: Address,
        /// Why not.
        code: u32,
    },
}

impl SdoResponse<'_> {
    /// The service masters expect in the CoE header: aborts are requests, which IgH insists on.
    pub const fn service(&self) -> Service {
        match self {
            Self::Abort { .. } => Service::SdoRequest,
            _ => Service::SdoResponse,
        }
    }

    /// The response's first eight bytes and the data that follow them.
    pub fn parts(&self) -> ([u8; SDO_SIZE], &[u8]) {
        match *self {
            Self::Downloaded(address) => (initiate(0x60, address, [0; 4]), &[]),
            Self::SegmentTaken { toggle } => ([0x20 | u8::from(toggle) << 4, 0, 0, 0, 0, 0, 0, 0], &[]),
            Self::Expedited { address, complete, data } => {
                let mut value = [0; 4];
                let used = data.len().min(4);
                value[..used].copy_from_slice(&data[..used]);
                (
                    initiate(0x43 | (4 - used as u8) << 2 | complete_access(complete), address, value),
                    &[],
                )
            }
            Self::Normal {
                address,
                complete,
                size,
                data,
            } => (initiate(0x41 | complete_access(complete), address, size.to_le_bytes()), data),
            Self::Segment { toggle, last, data } => segment(toggle, last, data),
            Self::Abort { address, code } => (initiate(0x80, address, code.to_le_bytes()), &[]),
        }
    }
}

/// Bit 4 of the command of an upload or download.
const fn complete_access(complete: bool) -> u8 {
    (complete as u8) << 4
}

/// A command with address and four more bytes.
fn initiate(command: u8, address: Address, rest: [u8; 4]) -> [u8; SDO_SIZE] {
    let [i0, i1] = address.index.to_le_bytes();
    let [r0, r1, r2, r3] = rest;
    [command, i0, i1, address.sub, r0, r1, r2, r3]
}

/// An upload segment; one of fewer than seven bytes is filled up and says by how much.
fn segment(toggle: bool, last: bool, data: &[u8]) -> ([u8; SDO_SIZE], &[u8]) {
    let (front, rest) = data.split_at(data.len().min(SHORT_SEGMENT));
    let unused = (SHORT_SEGMENT - front.len()) as u8;
    let mut bytes = [0; SDO_SIZE];
    bytes[0] = u8::from(toggle) << 4 | unused << 1 | u8::from(last);
    bytes[1..=front.len()].copy_from_slice(front);
    (bytes, rest)
}

#[cfg(test)]
mod tests {
    use super::*;

    const CONTROLWORD: Address = Address { index: 0x6040, sub: 0 };

    #[test]
    fn expedited_downloads_carry_as_many_bytes_as_they_say() {
        for (command, size) in [(0x2F, 1), (0x2B, 2), (0x27, 3), (0x23, 4), (0x22, 4), (0x2E, 4)] {
            let body = [command, 0x40, 0x60, 0, 1, 2, 3, 4];
            let expected = SdoRequest::Download {
                address: CONTROLWORD,
                complete: false,
                size,
                data: &[1, 2, 3, 4][..size as usize],
            };
            assert_eq!(SdoRequest::parse(&body), Some(expected), "{command:02X}");
        }
    }

    #[test]
    fn normal_downloads_carry_their_size_and_what_fits() {
        let body = [0x21, 0x40, 0x60, 0, 20, 0, 0, 0, 9, 8, 7];
        assert_eq!(
            SdoRequest::parse(&body),
            Some(SdoRequest::Download {
                address: CONTROLWORD,
                complete: false,
                size: 20,
                data: &[9, 8, 7]
            })
        );
        let unsized_body = [0x20, 0x40, 0x60, 0, 20, 0, 0, 0, 9, 8, 7];
        assert!(matches!(
            SdoRequest::parse(&unsized_body),
            Some(SdoRequest::Download { size: 3, .. })
        ));
    }

    #[test]
    fn short_segments_tell_their_unused_bytes_and_long_ones_have_none() {
        let short = [0x0B, 1, 2, 0, 0, 0, 0, 0];
        assert_eq!(
            SdoRequest::parse(&short),
            Some(SdoRequest::DownloadSegment {
                toggle: false,
                last: true,
                data: &[1, 2]
            })
        );
        let long = [0x10, 1, 2, 3, 4, 5, 6, 7, 8];
        let expected = SdoRequest::DownloadSegment {
            toggle: true,
            last: false,
            data: &long[1..],
        };
        assert_eq!(SdoRequest::parse(&long), Some(expected));
    }

    #[test]
    fn responses_are_laid_out_as_masters_parse_them() {
        let expedited = SdoResponse::Expedited {
            address: CONTROLWORD,
            complete: false,
            data: &[7],
        };
        assert_eq!(expedited.parts(), ([0x4F, 0x40, 0x60, 0, 7, 0, 0, 0], &[][..]));
        let complete = SdoResponse::Normal {
            address: CONTROLWORD,
            complete: true,
            size: 6,
            data: &[1, 2, 3, 4, 5, 6],
        };
        assert_eq!(complete.parts(), ([0x51, 0x40, 0x60, 0, 6, 0, 0, 0], &[1, 2, 3, 4, 5, 6][..]));
        let segment = SdoResponse::Segment {
            toggle: true,
            last: true,
            data: &[1, 2, 3, 4, 5, 6, 7, 8],
        };
        assert_eq!(segment.parts(), ([0x11, 1, 2, 3, 4, 5, 6, 7], &[8][..]));
        let short = SdoResponse::Segment {
            toggle: false,
            last: true,
            data: &[1],
        };
        assert_eq!(short.parts().0, [0x0D, 1, 0, 0, 0, 0, 0, 0]);
        let abort = SdoResponse::Abort {
            address: CONTROLWORD,
            code: 0x0602_0000,
        };
        assert_eq!((abort.parts().0[0], abort.service()), (0x80, Service::SdoRequest));
    }

    #[test]
    fn no_bytes_make_a_request_panic() {
        for command in 0..=255 {
            for length in 0..24 {
                let mut body = [0xFF; 24];
                body[0] = command;
                assert_eq!(SdoRequest::parse(&body[..length]).is_some(), length >= SDO_SIZE);
            }
        }
    }
}
