//! Frames through a line of chips.

mod bus;

use bus::{Bus, SOURCE, STATION, chip};
use esc::{Chip, Processed, Segment};
use wire::Nanos;
use wire::frame::{Command, FrameBuilder, Layout, physical_address};
use wire::register::*;

fn count_slaves(buffer: &mut [u8], tag: Option<u16>) -> usize {
    let mut builder = match tag {
        Some(tag) => FrameBuilder::tagged(buffer, SOURCE, tag),
        None => FrameBuilder::new(buffer, SOURCE),
    }
    .unwrap();
    builder.datagram(Command::Brd, 0x42, physical_address(0, TYPE), &[0]).unwrap();
    builder.finish()
}

#[test]
fn only_what_slaves_change_is_changed() {
    for tag in [None, Some(0x6001)] {
        let mut bus = Bus::new(3);
        let mut frame = [0xA5; 64];
        let length = count_slaves(&mut frame, tag);
        let before = frame;
        // Short as masters send on virtual interfaces, and padded.
        for end in [length, 64] {
            frame = before;
            assert_eq!(bus.segment.process(&mut frame[..end], Nanos(0)), Processed::Returned);
            let datagram = length - 13;
            let mut expected = before;
            expected[6] |= 0x02;
            expected[datagram + 2] = 3;
            expected[datagram + 10] = 0x11;
            expected[datagram + 11] = 3;
            assert_eq!(frame, expected);
        }
    }
}

#[test]
fn foreign_frames_are_left_alone() {
    let mut bus = Bus::new(2);
    let mut frame = [0xA5; 64];
    let length = count_slaves(&mut frame, None);
    for (at, value) in [(12, 0x08), (13, 0xA5)] {
        let mut foreign = frame;
        foreign[at] = value;
        let before = foreign;
        assert_eq!(bus.segment.process(&mut foreign, Nanos(0)), Processed::NotEtherCat);
        assert_eq!(foreign, before);
    }
    for short in 0..16 {
        assert_eq!(bus.segment.process(&mut frame[..short], Nanos(0)), Processed::NotEtherCat);
    }
    assert_eq!(bus.segment.process(&mut frame[..length], Nanos(0)), Processed::Returned);
    assert_eq!(bus.read_u8(0, PROCESSING_ERROR_COUNTER), 0);
}

#[test]
fn other_types_of_ethercat_frames_pass_unprocessed() {
    let mut bus = Bus::new(2);
    let mut frame = [0; 64];
    let length = count_slaves(&mut frame, None);
    for frame_type in [0, 4, 5, 15] {
        let mut other = frame;
        other[15] = frame_type << 4;
        let mut expected = other;
        expected[6] |= 2;
        assert_eq!(bus.segment.process(&mut other[..length], Nanos(0)), Processed::Malformed);
        assert_eq!(other, expected);
    }
}

#[test]
fn stated_length_may_be_short_of_the_frame_but_not_beyond_it() {
    let mut bus = Bus::new(1);
    let mut frame = [0; 64];
    let length = count_slaves(&mut frame, None);
    frame[14] += 1;
    let mut longer = frame;
    assert_eq!(bus.segment.process(&mut longer[..length], Nanos(0)), Processed::Malformed);
    assert_eq!(longer[length - 2], 1, "the datagram itself is whole");
    assert_eq!(bus.segment.process(&mut frame[..length + 1], Nanos(0)), Processed::Returned);
}

#[test]
fn each_slave_is_done_with_the_frame_before_the_next_begins() {
    let mut bus = Bus::new(2);
    let at = physical_address;
    bus.write(0, PROCESS_RAM, &[5]);
    // The second datagram reads from the first slave what the third writes into both.
    let answers = bus.send(&[
        (Command::Frmw, at(STATION, PROCESS_RAM), &[0]),
        (Command::Fprd, at(STATION + 1, PROCESS_RAM), &[0]),
        (Command::Bwr, at(0, PROCESS_RAM), &[9]),
    ]);
    assert_eq!((answers[0].data[0], answers[1].data[0]), (5, 5));
    assert_eq!(bus.read(1, PROCESS_RAM, 1).data, [9]);
}

#[test]
fn frames_of_many_datagrams_up_to_the_longest() {
    let mut bus = Bus::new(2);
    let datagrams: Vec<_> = (0..114).map(|_| (Command::Brd, 0, &[0u8; 1][..])).collect();
    assert!(bus.send(&datagrams).iter().all(|answer| answer.wkc == 2));
    let answer = bus.one(Command::Fpwr, physical_address(STATION, PROCESS_RAM), &[7; 1486]);
    assert_eq!(answer.wkc, 1);
    assert_eq!(bus.read(0, PROCESS_RAM, 1486).data, [7; 1486]);
}

#[test]
fn a_line_may_hold_anything_that_gives_out_a_chip() {
    struct Drive {
        chip: Chip,
    }
    impl AsMut<Chip> for Drive {
        fn as_mut(&mut self) -> &mut Chip {
            &mut self.chip
        }
    }
    let drives: Vec<Drive> = (0..3).map(|_| Drive { chip: chip(0, 0) }).collect();
    let mut segment = Segment::new(drives);
    let mut frame = [0; 64];
    let length = count_slaves(&mut frame, None);
    assert_eq!(segment.process(&mut frame[..length], Nanos(0)), Processed::Returned);
    let datagram = Layout::of(&frame)
        .unwrap()
        .walk()
        .next(&frame[..length])
        .map(|datagram| datagram.working_counter());
    assert_eq!(datagram, Some(3));

    let mut array = Segment::new([chip(0, 0), chip(0, 0)]);
    assert_eq!(array.process(&mut frame[..length], Nanos(0)), Processed::Returned);
    assert_eq!(frame[length - 2], 5);
    assert_eq!(array.drives().len(), 2);

    let mut empty = Segment::new(Vec::<Chip>::new());
    let before = frame;
    assert_eq!(empty.process(&mut frame[..length], Nanos(0)), Processed::Returned);
    assert_eq!(frame, before, "nobody there to change anything");
}
