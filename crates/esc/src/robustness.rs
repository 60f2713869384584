//! Whatever comes in from either side, in whatever order: nothing panics, and the chip works afterwards.

extern crate std;

use std::vec;
use std::vec::Vec;

use proptest::prelude::*;
use wire::frame::{Command, ETHERNET_HEADER, FrameBuilder, Layout, physical_address};
use wire::register::*;
use wire::{AlEvents, EscAccess, Nanos};

use crate::{Chip, ChipConfig, EEPROM_SIZE, Processed, Segment};

const SOURCE: [u8; 6] = [0x10; 6];

fn line(count: usize) -> Segment<Vec<Chip>> {
    let chip = |position: usize| {
        Chip::new(ChipConfig {
            eeprom: [0xFF; EEPROM_SIZE],
            clock_offset_ns: position as u64,
            clock_ppb: 0,
        })
    };
    Segment::new((0..count).map(chip).collect())
}

/// Addresses where something happens.
fn address() -> impl Strategy<Value = u16> {
    prop_oneof![
        any::<u16>(),
        0..0x0A00u16,
        prop::sample::select(
            &[
                STATION_ADDRESS,
                RESET,
                DL_CONTROL + 1,
                AL_CONTROL,
                AL_STATUS,
                EEPROM_CONFIGURATION,
                EEPROM_CONTROL,
                DC_SYSTEM_TIME
            ][..]
        ),
        FMMU..FMMU + 0x80,
        SM..SM + 0x40,
        DC_RECEIVE_TIMES..0x0A00,
        0x0F70..0x1020u16,
        0x2FF0..0x3010u16,
    ]
}

fn data() -> impl Strategy<Value = Vec<u8>> {
    prop_oneof![
        prop::collection::vec(any::<u8>(), 0..40),
        prop::collection::vec(0..4u8, 0..300),
        prop::sample::select(&b"RES"[..]).prop_map(|letter| vec![letter]),
        (0..600usize).prop_map(|length| vec![0; length]),
        sync_manager_settings(),
    ]
}

/// Settings of eight sync managers that overlap here and there.
fn sync_manager_settings() -> impl Strategy<Value = Vec<u8>> {
    prop::collection::vec((0xFF8..0x1020u16, 0..24u16, any::<u8>(), 0..4u8), 1..=8).prop_map(|all| {
        let settings = all.into_iter().map(|(start, length, control, activate)| {
            let ([s0, s1], [l0, l1]) = (start.to_le_bytes(), length.to_le_bytes());
            [s0, s1, l0, l1, control, 0, activate, 0]
        });
        settings.flatten().collect()
    })
}

#[derive(Clone, Debug)]
struct Request {
    command: u8,
    adp: u16,
    ado: u16,
    data: Vec<u8>,
}

fn request() -> impl Strategy<Value = Request> {
    (0..17u8, prop_oneof![Just(0), Just(0xFFFF), any::<u16>()], address(), data()).prop_map(|(command, adp, ado, data)| Request {
        command,
        adp,
        // The settings of sync managers are of use at one place only.
        ado: if data.len() % 8 == 0 && data.len() > 6 && ado % 3 == 0 {
            SM
        } else {
            ado
        },
        data,
    })
}

#[derive(Clone, Debug)]
enum Step {
    Frame {
        requests: Vec<Request>,
        damage: Option<(usize, u8)>,
        cut: usize,
    },
    Raw(Vec<u8>),
    Read(u16, usize),
    Write(u16, Vec<u8>),
    Advance(u64),
    Wait(u64),
    PowerCycle,
    Link(usize, bool),
}

fn step() -> impl Strategy<Value = Step> {
    let damage = prop::option::weighted(0.3, (ETHERNET_HEADER - 2..200, any::<u8>()));
    let cut = prop_oneof![4 => Just(0), 1 => 0..60usize];
    prop_oneof![
        8 => (prop::collection::vec(request(), 1..6), damage, cut).prop_map(|(requests, damage, cut)| Step::Frame { requests, damage, cut }),
        1 => prop::collection::vec(any::<u8>(), 0..200).prop_map(Step::Raw),
        3 => (address(), 0..64usize).prop_map(|(at, length)| Step::Read(at, length)),
        3 => (address(), data()).prop_map(|(at, data)| Step::Write(at, data)),
        2 => prop_oneof![0..1_000_000u64, any::<u64>()].prop_map(Step::Advance),
        2 => prop_oneof![0..200_000_000u64, any::<u64>()].prop_map(Step::Wait),
        1 => Just(Step::PowerCycle),
        1 => (0..6usize, any::<bool>()).prop_map(|(port, up)| Step::Link(port, up)),
    ]
}

fn build(requests: &[Request], buffer: &mut [u8]) -> usize {
    let mut builder = FrameBuilder::new(buffer, SOURCE).unwrap();
    for (index, request) in requests.iter().enumerate() {
        let address = physical_address(request.adp, request.ado);
        // A full frame is long enough for the purpose.
        let _ = builder.datagram(Command::from(request.command), index as u8, address, &request.data);
    }
    builder.finish()
}

/// Sends a frame, however broken, and checks what holds for every frame.
fn send(segment: &mut Segment<Vec<Chip>>, frame: &mut [u8], now: u64) {
    let before = frame.to_vec();
    let layout = Layout::of(frame);
    let processed = segment.process(frame, Nanos(now));
    match layout {
        None => {
            assert_eq!(processed, Processed::NotEtherCat);
            assert_eq!(frame, before);
        }
        Some(layout) => {
            let lost = processed == Processed::Lost;
            assert!(lost || (processed == Processed::Returned) == layout.is_intact(&before));
            assert_eq!(frame[..6], before[..6], "destination");
            assert!(frame[6] == before[6] | 2 || lost && frame[6] == before[6]);
            assert_eq!(frame[7..16], before[7..16], "the rest of the headers");
            let (mut now, mut then) = (layout.walk(), layout.walk());
            let mut counted = ETHERNET_HEADER + 2;
            while let (Some(now), Some(then)) = (now.next(frame), then.next(&before)) {
                assert_eq!(
                    (now.command(), now.index(), now.data().len()),
                    (then.command(), then.index(), then.data().len())
                );
                assert!(now.working_counter().wrapping_sub(then.working_counter()) <= 3 * 3);
                counted += 12 + now.data().len();
            }
            assert_eq!(
                frame[counted.min(frame.len())..],
                before[counted.min(frame.len())..],
                "what is behind the datagrams"
            );
        }
    }
}

fn run(segment: &mut Segment<Vec<Chip>>, step: Step, position: usize, now: &mut u64) {
    match step {
        Step::Frame { requests, damage, cut } => {
            let mut buffer = [0; 2100];
            let length = build(&requests, &mut buffer);
            if let Some((at, value)) = damage {
                buffer[at] = value;
            }
            send(segment, &mut buffer[..length - cut.min(length)], *now);
        }
        Step::Raw(mut bytes) => send(segment, &mut bytes, *now),
        Step::Wait(time) => *now = now.saturating_add(time),
        Step::Read(at, length) => segment.drives_mut()[position].read(at, &mut vec![0; length]),
        Step::Write(at, data) => segment.drives_mut()[position].write(at, &data),
        Step::Advance(time) => segment.drives_mut()[position].advance(Nanos(time)),
        Step::PowerCycle => segment.drives_mut()[position].power_cycle(),
        Step::Link(port, up) => segment.drives_mut()[position].set_link(port, up),
    }
}

fn one(segment: &mut Segment<Vec<Chip>>, command: Command, address: u32, data: &[u8], now: u64) -> (Vec<u8>, u16) {
    let mut buffer = [0; 100];
    let mut builder = FrameBuilder::new(&mut buffer, SOURCE).unwrap();
    builder.datagram(command, 0, address, data).unwrap();
    let length = builder.finish();
    let frame = &mut buffer[..length];
    assert_eq!(segment.process(frame, Nanos(now)), Processed::Returned);
    let answer = Layout::of(frame)
        .unwrap()
        .walk()
        .next(frame)
        .map(|answer| (answer.data().to_vec(), answer.working_counter()));
    answer.unwrap()
}

/// Everybody's cables are plugged, and no loop is closed by hand.
fn mend(segment: &mut Segment<Vec<Chip>>) {
    let count = segment.drives().len();
    for (position, chip) in segment.drives_mut().iter_mut().enumerate() {
        chip.ports.forget_temporary();
        chip.ports.control(0);
        chip.set_link(0, true);
        chip.set_link(1, position + 1 < count);
    }
}

/// Write protection ends, as a master that knows of it would have it.
fn unlock(segment: &mut Segment<Vec<Chip>>, now: u64) {
    let mut buffer = [0; 100];
    let mut builder = FrameBuilder::new(&mut buffer, SOURCE).unwrap();
    for (ado, data) in [
        (WRITE_REGISTER_ENABLE, &[1][..]),
        (ESC_WRITE_ENABLE, &[1, 0]),
        (WRITE_REGISTER_PROTECTION, &[0]),
    ] {
        builder.datagram(Command::Bwr, 0, physical_address(0, ado), data).unwrap();
    }
    let length = builder.finish();
    assert_eq!(segment.process(&mut buffer[..length], Nanos(now)), Processed::Returned);
}

/// A master comes, finds the chip as it should be and brings a mailbox and process data up.
fn check(segment: &mut Segment<Vec<Chip>>, now: u64) {
    let count = segment.drives().len();
    mend(segment);
    unlock(segment, now);
    for chip in segment.drives_mut() {
        assert!((0..8).all(|index| chip.sync_managers.get(index).is_consistent()));
        assert!(chip.shadow.is_empty() && chip.touched == 0 && chip.acknowledged == 0);
        chip.advance(Nanos(now));
        chip.read_u16(AL_CONTROL);
    }
    assert_eq!(one(segment, Command::Brd, 0, &[0], now), (vec![0x11], count as u16));
    assert_eq!(
        one(segment, Command::Bwr, physical_address(0, AL_CONTROL), &[0x11, 0], now).1,
        count as u16
    );
    for position in 0..count {
        let adp = 0u16.wrapping_sub(position as u16);
        let at = |ado| physical_address(adp, ado);
        let chip = &mut segment.drives_mut()[position];
        chip.advance(Nanos(now));
        assert!(chip.events().has(AlEvents::AL_CONTROL));
        assert_eq!(chip.read_u16(AL_CONTROL), 0x11);
        chip.write_u16(AL_STATUS, 1);
        chip.write(SM + sync_manager::PDI_CONTROL, &[0]);
        assert_eq!(one(segment, Command::Apwr, at(STATION_ADDRESS), &[0x01, 0x20], now).1, 1);
        assert_eq!(one(segment, Command::Aprd, at(AL_STATUS), &[0; 2], now), (vec![1, 0], 1));
        assert_eq!(one(segment, Command::Apwr, at(SM), &[0; 64], now).1, 1);
        assert_eq!(one(segment, Command::Apwr, at(SM), &[0x80, 0x10, 8, 0, 0x26, 0, 1, 0], now).1, 1);
        assert_eq!(one(segment, Command::Apwr, at(0x1080), &[7; 8], now).1, 1);
        let mut mail = [0; 8];
        let chip = &mut segment.drives_mut()[position];
        chip.advance(Nanos(now));
        assert!(chip.events().has(AlEvents::sync_manager(0)));
        chip.read(0x1080, &mut mail);
        assert_eq!(mail, [7; 8]);
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1_500))]

    #[test]
    fn any_sequence_leaves_the_chips_working(steps in prop::collection::vec((step(), 0..3usize), 1..40)) {
        let mut segment = line(3);
        let mut now = 1_000;
        for (step, position) in steps {
            run(&mut segment, step, position, &mut now);
        }
        check(&mut segment, now);
    }

    #[test]
    fn any_frame_that_claims_to_be_ethercat_is_survived(mut bytes in prop::collection::vec(any::<u8>(), 16..200), length in any::<u16>()) {
        let mut segment = line(2);
        bytes[12..14].copy_from_slice(&[0x88, 0xA4]);
        bytes[14..16].copy_from_slice(&(length & 0x07FF | 0x1000).to_le_bytes());
        send(&mut segment, &mut bytes, 5);
        check(&mut segment, 6);
    }

    #[test]
    fn every_truncation_of_a_good_frame_is_survived(requests in prop::collection::vec(request(), 1..4)) {
        let mut buffer = [0; 2100];
        let length = build(&requests, &mut buffer);
        let mut segment = line(1);
        for end in (0..length).step_by(1 + length / 64) {
            let mut frame = buffer[..end].to_vec();
            send(&mut segment, &mut frame, 5);
        }
        check(&mut segment, 6);
    }
}
