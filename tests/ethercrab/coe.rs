//! Complete access in the layout of the ESI, and emergencies of the drive's faults.

use std::time::Duration;

use ethercrab::subdevice_group::PreOp;
use ethercrab::{Command, MainDevice, SubIndex};
use rig::esi::Element;
use rig::{CYCLE, Rig, operate};
use usr2556e::master::Pace;
use usr2556e::master::axis::Operating;
use usr2556e::master::bring_up::{self, Group};
use usr2556e::master::process_data::mode;
use usr2556e::master::sdo::{self, Bytes};

use crate::raw_mailbox::{fetch, send};

/// An entry in the ESI's data type of an object: sub-index, bits, bit offset.
type Member = (u8, usize, usize);

/// The ESI's data types of objects with sub-indices; an array is its elements.
fn layouts() -> Vec<(u16, Vec<Member>)> {
    let esi = Element::document();
    let types = esi.all("Descriptions/Devices/Device/Profile/Dictionary/DataTypes/DataType");
    let members = |item: &&Element| -> Vec<Member> {
        let (bits, offset) = (item.number("BitSize") as usize, item.number("BitOffs") as usize);
        if item.find("SubIdx").is_some() {
            return vec![(item.number("SubIdx") as u8, bits, offset)];
        }
        let array = types.iter().find(|kind| kind.text("Name") == item.text("Type")).unwrap();
        let count = array.number("ArrayInfo/Elements") as usize;
        (0..count).map(|n| (n as u8 + 1, bits / count, offset + n * bits / count)).collect()
    };
    let objects = types.iter().filter(|kind| kind.find("ArrayInfo").is_none());
    objects
        .filter_map(|kind| {
            let index = kind.text("Name").strip_prefix("DT")?;
            let index = u16::from_str_radix(index, 16).unwrap();
            Some((index, kind.all("SubItem").iter().flat_map(members).collect()))
        })
        .collect()
}

#[test]
fn complete_access_has_the_layout_of_the_esi() {
    Rig::new(1).in_preop(async |main, _, group| {
        let drive = group.subdevice(main, 0).unwrap();
        let layouts = layouts();
        assert!(layouts.len() > 20);
        // The diagnosis history is read message by message.
        for (index, members) in layouts.into_iter().filter(|(index, _)| *index != 0x10F3) {
            // From sub-index 1 on: 16 bits fewer than the ESI has, which begins with sub-index 0.
            let Bytes(image) = drive.sdo_read(index, SubIndex::Complete).await.unwrap();
            let count = sdo::read(&drive, sdo::Address { index, sub: 0 }).await.unwrap()[0];
            let mut end = 0;
            for (sub, bits, offset) in members.into_iter().filter(|(sub, ..)| (1..=count).contains(sub)) {
                let value = sdo::read(&drive, sdo::Address { index, sub }).await.unwrap();
                let at = (offset - 16) / 8;
                assert_eq!(image[at..at + bits.div_ceil(8)], value, "{index:04X}:{sub:02X}");
                end = at + bits.div_ceil(8);
            }
            assert_eq!(image.len(), end, "{index:04X}");
        }
    });
}

#[test]
fn a_refused_value_undoes_what_was_written_before_it() {
    Rig::new(1).in_preop(async |main, _, group| {
        let drive = group.subdevice(main, 0).unwrap();
        // 0x200B: no automatic gains, Kp 500, Ki beyond its range, Kc 100.
        let write = |values: [u16; 4]| {
            let mut request = vec![0x31, 0x0B, 0x20, 0, 10, 0, 0, 0, 4, 0];
            request.extend(values.into_iter().flat_map(u16::to_le_bytes));
            request
        };
        let read = async || {
            let Bytes(image) = drive.sdo_read(0x200B, SubIndex::Complete).await.unwrap();
            image
        };
        let before = read().await;
        send(&drive, 2, &write([0, 500, 10_001, 100])).await;
        let (service, response) = fetch(&drive).await.unwrap();
        assert_eq!((service, &response[..8]), (2, &[0x80, 0x0B, 0x20, 0, 0x31, 0, 0x09, 0x06][..]));
        assert_eq!(read().await, before);
        send(&drive, 2, &write([0, 500, 10_000, 100])).await;
        assert_eq!(fetch(&drive).await.unwrap().1[0], 0x60);
        assert_eq!(read().await, [0_u16, 500, 10_000, 100].map(u16::to_le_bytes).concat());
    });
}

/// The CoE message that lies in the first drive's mailbox, without its mailbox header.
async fn lying_message(main: &MainDevice<'_>) -> [u8; 10] {
    let message: [u8; 128] = Command::fprd(0x1000, 0x1080).receive(main).await.unwrap();
    assert_eq!((message[0], message[5] & 0x0F), (10, 3));
    message[6..16].try_into().unwrap()
}

/// Brings the first drive to OP and enables it, and leaves it so.
async fn enable(main: &MainDevice<'_>, pace: &Pace, group: Group<PreOp>) {
    let group = bring_up::to_op(main, pace, group, CYCLE).await.unwrap();
    operate(main, pace, Operating::Frames(group, CYCLE), 0, async |axis| {
        axis.outputs.mode = mode::PROFILE_POSITION;
        axis.enable().await.unwrap();
    })
    .await;
}

// manual: 2.3.1/7500
#[test]
fn a_fault_and_its_end_are_told_by_emergencies_and_disturb_no_sdo() {
    let rig = Rig::new(1);
    rig.in_preop(async |main, pace, group| enable(main, pace, group).await);
    // The frames stop: the watchdog expires, and the drive stops with a communication fault.
    rig.idle(Duration::from_secs(1));
    assert_eq!(rig.look(0, |drive| drive.status().error_code), 0x7500);
    let fault = rig.converse(async |main, _| lying_message(main).await);
    assert_eq!(
        fault,
        [0, 0x10, 0x00, 0x75, 0x11, 0, 0, 0, 0, 0],
        "0x7500, generic and communication, no alarm bit"
    );
    rig.in_preop(async |main, pace, group| {
        let drive = group.subdevice(main, 0).unwrap();
        assert_eq!(drive.sdo_read(0x603F, 0).await, Ok(0x7500_u16), "still there, and not told again");
        assert_eq!(fetch(&drive).await, None);
        enable(main, pace, group).await;
        assert_eq!(lying_message(main).await, [0, 0x10, 0, 0, 0, 0, 0, 0, 0, 0], "all errors are gone");
    });
}

#[test]
fn an_sdo_over_an_unread_emergency_gets_its_response() {
    let rig = Rig::new(1);
    rig.in_preop(async |main, pace, group| enable(main, pace, group).await);
    rig.idle(Duration::from_secs(1));
    rig.converse(async |main, _| {
        // An upload of 0x603F from a master that has not looked into its mailbox.
        let mut request = [0; 128];
        request[..16].copy_from_slice(&[10, 0, 0, 0, 0, 3, 0, 0x20, 0x40, 0x3F, 0x60, 0, 0, 0, 0, 0]);
        Command::fpwr(0x1000, 0x1000).send(main, request).await.unwrap();
        assert_eq!(lying_message(main).await, [0, 0x30, 0x4B, 0x3F, 0x60, 0, 0x00, 0x75, 0, 0]);
        assert_eq!(lying_message(main).await[..4], [0, 0x10, 0x00, 0x75]);
    });
}
