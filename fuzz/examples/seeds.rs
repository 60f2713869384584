//! Writes inputs for the fuzzer to start from: frames of real masters out of the captures, and a plain session for every other target.
//!
//! `cargo run -p fuzz --example seeds FOLDER` puts them into a folder a target below FOLDER; `cargo fuzz cmin` then keeps of them what leads
//! to something new.
#![forbid(unsafe_code)]

use std::collections::BTreeSet;
use std::error::Error;
use std::fs;
use std::path::Path;

use usr2556e::link::pcap::read_pcapng;

/// Frames in one input.
const FRAMES: usize = 12;
/// A frame as it is, and the drives see to it: a step of the target `frame`.
const WHOLE_FRAME: u8 = 3;

fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::args().nth(1).ok_or("name the folder")?;
    let folder = Path::new(&folder);
    write(folder, "frame", &frames()?)?;
    write(folder, "mailbox", &mailbox())?;
    write(folder, "sdo", &sdo())?;
    write(folder, "eeprom", &eeprom())
}

fn write(folder: &Path, target: &str, seeds: &[Vec<u8>]) -> Result<(), Box<dyn Error>> {
    let folder = folder.join(target);
    fs::create_dir_all(&folder)?;
    for (number, seed) in seeds.iter().enumerate() {
        fs::write(folder.join(format!("seed-{number:03}")), seed)?;
    }
    Ok(())
}

/// Runs of frames that masters sent, none twice, to each of the prepared segments in turn.
fn frames() -> Result<Vec<Vec<u8>>, Box<dyn Error>> {
    let captures = Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/captures");
    let mut seen = BTreeSet::new();
    let mut seeds = Vec::new();
    for capture in fs::read_dir(captures)? {
        let packets = read_pcapng(&capture?.path())?;
        let sent = packets.chunks(2).filter_map(|pair| pair.first());
        let new: Vec<_> = sent.map(|packet| &packet.data).filter(|frame| seen.insert(shape(frame))).collect();
        for (number, run) in new.chunks(FRAMES).enumerate() {
            let mut seed = vec![number as u8 % 8];
            for frame in run {
                seed.push(WHOLE_FRAME);
                seed.extend((frame.len() as u16).to_le_bytes());
                seed.extend_from_slice(frame);
            }
            seeds.push(seed);
        }
    }
    Ok(seeds)
}

/// What tells a frame from others: the first datagram's command, register and length, and the frame's length.
fn shape(frame: &[u8]) -> (Vec<u8>, usize) {
    let bytes = [16, 20, 21, 22, 23].map(|at| frame.get(at).copied().unwrap_or(0));
    (bytes.to_vec(), frame.len())
}

/// An upload, a repeat request, a list, a foreign protocol, file access, an error and a change of state, in each prepared state.
fn mailbox() -> Vec<Vec<u8>> {
    let steps: [&[u8]; 14] = [
        &[0, 0, 8, 0x40, 0x00, 0x10, 0, 0, 0, 0, 0],
        &[7],
        &[10],
        &[7],
        &[0, 1, 6, 1, 0, 0, 0, 1, 0],
        &[7, 7, 7, 11, 4],
        &[3, 0, 0, 0x40, 7, 3, 3, 0, 0, 7, 3, 3, 0, 0, 7],
        &[3, 1, 0, 0x40, 7, 3, 2, 0, 15],
        b"2000:00 = 2500\n\x07",
        &[5, 2, 4, 1, 0, 0, 0],
        &[6, 3, 0xFF, 0xFF, 0xFF],
        &[13, 6, 0, 8, 0, 0, 0, 0],
        &[14, 0, 4, 1, 2, 3, 4],
        &[12, 0x12, 11, 2, 12, 0x14],
    ];
    (0..12).map(|state| [&[state][..], &steps.concat()].concat()).collect()
}

/// Uploads, downloads, segments, an abort and SDO information, in each prepared state.
fn sdo() -> Vec<Vec<u8>> {
    let transfers: [&[u8]; 10] = [
        &[14, 0, 0, 0],
        &[14, 0x10, 5, 0],
        &[1, 0x20, 60, 0, 1],
        &[4, 4, 1, 70, 0, 4, 1, 2, 3, 4],
        &[5, 0x00],
        &[6, 0x01, 7, 1, 2, 3, 4, 5, 6, 7],
        &[7],
        &[8, 1, 9, 3, 0, 10, 3, 0, 0xFF],
        &[12, 0],
        &[13, 4],
    ];
    let every_entry = |from: u8| {
        (from..from.saturating_add(60))
            .flat_map(|entry| [1, 0x20, entry, 0, 1])
            .collect::<Vec<u8>>()
    };
    (0..3)
        .flat_map(|state| {
            let mixed = [&[state][..], &transfers.concat()].concat();
            [0, 60, 120, 180]
                .into_iter()
                .map(move |from| [&[state][..], &every_entry(from)].concat())
                .chain([mixed])
        })
        .collect()
}

/// Contents as delivered, changed, broken and erased, each with a read, a write and a reload.
fn eeprom() -> Vec<Vec<u8>> {
    let accesses = [
        3, 4, 0, 0, 0, 4, 7, 7, 3, 4, 0, 1, 1, 3, 0, 0, 2, 0, 0, 1, 2, 0, 1, 0, 5, 4, 6, 2, 7,
    ];
    let images: [&[u8]; 4] = [&[0], &[1, 8, 0, 2, 1, 2], &[0x41, 0, 0, 1, 0xEE], &[0x80]];
    images.map(|image| [image, &accesses[..]].concat()).to_vec()
}
