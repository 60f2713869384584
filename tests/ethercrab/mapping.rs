//! PDO assignment and mapping by the master.

use dictionary::AbortCode;
use ethercrab::SubDeviceState;
use rig::{CYCLE, Rig};
use usr2556e::master::bring_up;
use usr2556e::master::sdo::abort_code;

#[test]
fn a_mapping_of_the_masters_own_is_exchanged_bit_for_bit() {
    let rig = Rig::new(1);
    rig.in_preop(async |main, pace, group| {
        let drive = group.subdevice(main, 0).unwrap();
        drive.sdo_write_array::<u16>(0x1C12, []).await.unwrap();
        drive
            .sdo_write_array(0x1600, [0x6040_0010_u32, 0x0000_0008, 0x6060_0008, 0x60FF_0020])
            .await
            .unwrap();
        drive.sdo_write_array(0x1C12, [0x1600_u16]).await.unwrap();
        drive.sdo_write_array::<u16>(0x1C13, []).await.unwrap();
        drive.sdo_write_array(0x1A00, [0x2048_0010_u32, 0x6041_0010]).await.unwrap();
        drive.sdo_write_array(0x1A01, [0x200F_0010_u32, 0x6061_0008]).await.unwrap();
        drive.sdo_write_array(0x1C13, [0x1A00_u16, 0x1A01]).await.unwrap();
        let group = bring_up::to_op(main, pace, group, CYCLE).await.unwrap();
        {
            let drive = group.subdevice(main, 0).unwrap();
            let mut outputs = drive.outputs_raw_mut();
            assert_eq!(outputs.len(), 8);
            outputs.copy_from_slice(&[0, 0, 0xAA, 3, 0x78, 0x56, 0x34, 0x12]);
        }
        for _ in 0..5 {
            group.tx_rx(main).await.unwrap();
            pace.pause(CYCLE).await;
        }
        let drive = group.subdevice(main, 0).unwrap();
        assert_eq!(drive.inputs_raw().len(), 7);
        assert_eq!(drive.inputs_raw()[..2], [0x10, 0x0E], "the bus voltage, 36.00 V");
        assert_eq!(drive.inputs_raw()[6], 3, "profile velocity mode is accepted");
        assert_eq!(drive.sdo_read::<i32>(0x60FF, 0).await, Ok(0x1234_5678));
    });
}

#[test]
fn all_pdos_are_assigned_together_although_they_share_objects() {
    Rig::new(1).in_preop(async |main, pace, group| {
        let drive = group.subdevice(main, 0).unwrap();
        drive.sdo_write_array(0x1C12, [0x1600_u16, 0x1601, 0x1602]).await.unwrap();
        drive.sdo_write_array(0x1C13, [0x1A00_u16, 0x1A01, 0x1A02]).await.unwrap();
        let group = bring_up::to_op(main, pace, group, CYCLE).await.unwrap();
        let drive = group.subdevice(main, 0).unwrap();
        assert_eq!((drive.outputs_raw().len(), drive.inputs_raw().len()), (7 + 19 + 15, 11 + 11));
    });
}

#[test]
fn a_mapping_that_cannot_be_is_refused_with_its_reason() {
    Rig::new(1).in_preop(async |main, _, group| {
        let drive = group.subdevice(main, 0).unwrap();
        let refusal = |result: Result<(), ethercrab::error::Error>| result.err().as_ref().and_then(abort_code);
        assert_eq!(
            refusal(drive.sdo_write(0x1600, 1, 0x6040_0010_u32).await),
            Some(AbortCode::SubIndexZeroNotCleared)
        );
        drive.sdo_write(0x1600, 0, 0_u8).await.unwrap();
        for (mapping, reason) in [
            (0x5FFF_0010_u32, AbortCode::ObjectNotFound),
            (0x6099_0320, AbortCode::SubIndexNotFound),
            (0x6041_0010, AbortCode::NotMappable),
            (0x1018_0120, AbortCode::NotMappable),
            (0x6040_0020, AbortCode::NotMappable),
        ] {
            assert_eq!(refusal(drive.sdo_write(0x1600, 1, mapping).await), Some(reason), "{mapping:#010x}");
        }
        drive.sdo_write(0x1C12, 0, 0_u8).await.unwrap();
        assert!(
            refusal(drive.sdo_write(0x1C12, 1, 0x1A00_u16).await).is_some(),
            "a TxPDO cannot be an RxPDO"
        );
        assert!(refusal(drive.sdo_write(0x1C12, 0, 4_u8).await).is_some(), "at most three PDOs");
    });
}

#[test]
fn mappings_are_writable_in_preop_only() {
    Rig::new(1).in_preop(async |main, pace, group| {
        let group = bring_up::to_op(main, pace, group, CYCLE).await.unwrap();
        let drive = group.subdevice(main, 0).unwrap();
        for index in [0x1600, 0x1A00, 0x1C12, 0x1C13] {
            let error = drive.sdo_write(index, 0, 0_u8).await.unwrap_err();
            assert_eq!(abort_code(&error), Some(AbortCode::DeviceState), "{index:#06x}");
        }
        assert_eq!(drive.status().await.unwrap().0, SubDeviceState::Op);
    });
}
