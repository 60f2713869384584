//! SDO transfers of every object of the dictionary.

use std::collections::BTreeMap;

use dictionary::{AbortCode, DataType, Entry};
use drive::DriveObjects;
use ethercrab::SubDevice;
use ethercrab::error::Error;
use rig::Rig;
use usr2556e::master::sdo::{self, Address, abort_code};

type Drive<'a> = ethercrab::SubDeviceRef<'a, &'a SubDevice>;

fn entries() -> impl Iterator<Item = &'static Entry> {
    slave::objects::ENTRIES.iter().chain(DriveObjects::ENTRIES)
}

fn address(entry: &Entry) -> Address {
    Address {
        index: entry.index,
        sub: entry.sub,
    }
}

fn in_preop(test: impl AsyncFnOnce(&Drive<'_>)) {
    Rig::new(1).in_preop(async |main, _, group| {
        let drive = group.subdevice(main, 0).unwrap();
        test(&drive).await;
    });
}

/// Objects whose write has further conditions than type, range and access: they have tests of their own.
fn has_its_own_rules(entry: &Entry) -> bool {
    matches!(entry.index, 0x1010..=0x1011 | 0x1600..=0x1AFF | 0x1C12..=0x1C33)
}

fn refusal<T>(result: Result<T, Error>) -> Option<AbortCode> {
    abort_code(&result.err()?)
}

fn bytes(value: i64, entry: &Entry) -> Vec<u8> {
    value.to_le_bytes()[..entry.size()].to_vec()
}

// manual: 1.1.1/coe
#[test]
fn every_object_is_read_with_its_length() {
    in_preop(async |drive| {
        for entry in entries().filter(|entry| !matches!(entry.index, 0x10F3 | 0x1600..=0x1AFF | 0x1C12 | 0x1C13)) {
            let value = sdo::read(drive, address(entry))
                .await
                .unwrap_or_else(|error| panic!("{}: {error}", address(entry)));
            if entry.data_type == DataType::VisibleString {
                assert!(!value.is_empty(), "{}", address(entry));
            } else {
                assert_eq!(value.len(), entry.size(), "{}", address(entry));
            }
        }
    });
}

// manual: 2.1.1/value 2.1.2/value 2.1.3/value 2.1.4/value 2.3.26/value
#[test]
fn the_identity_and_names_are_those_of_the_device() {
    in_preop(async |drive| {
        for (address, expected) in [
            ("1000", &[0x92, 0x01, 0x04, 0x00][..]),
            ("1008", b"ECR60"),
            ("1009", b"A1"),
            ("100A", b"101B"),
            ("1018", &[4]),
            ("1018:1", &[0x88, 0x0A, 0, 0]),
            ("1018:2", &[0x01, 0x00, 0x88, 0x0A]),
            ("1018:3", &[0x04, 0x02, 0, 0]),
            ("1018:4", &[1, 0, 0, 0]),
            ("1C00", &[4]),
            ("1C00:3", &[3]),
            ("6502", &[0xA5, 0, 0, 0]),
        ] {
            assert_eq!(sdo::read(drive, address.parse().unwrap()).await, Ok(expected.to_vec()), "{address}");
        }
    });
}

#[test]
fn sub_index_0_of_every_record_is_its_highest_sub_index() {
    let mut highest = BTreeMap::new();
    for entry in entries().filter(|entry| entry.in_record() && !matches!(entry.index, 0x10F3 | 0x1600..=0x1AFF | 0x1C12 | 0x1C13)) {
        highest.insert(entry.index, entry.sub);
    }
    in_preop(async |drive| {
        for (index, sub) in highest {
            assert_eq!(sdo::read(drive, Address { index, sub: 0 }).await, Ok(vec![sub]), "{index:#06x}");
            let beyond = sdo::read(drive, Address { index, sub: sub + 1 }).await;
            assert_eq!(refusal(beyond), Some(AbortCode::SubIndexNotFound), "{index:#06x}");
        }
    });
}

/// The value of a new unit: 0x2150 shows the alias in the EEPROM, and there is none yet.
fn at_delivery(entry: &Entry) -> i64 {
    if entry.index == 0x2150 { 0 } else { entry.default }
}

#[test]
fn defaults_are_those_of_the_table() {
    in_preop(async |drive| {
        for entry in DriveObjects::ENTRIES.iter().filter(|entry| entry.access.is_writable()) {
            assert_eq!(
                sdo::read(drive, address(entry)).await,
                Ok(bytes(at_delivery(entry), entry)),
                "{}",
                address(entry)
            );
        }
    });
}

#[test]
fn a_download_of_wrong_length_is_refused_and_changes_nothing() {
    in_preop(async |drive| {
        for entry in entries().filter(|entry| entry.access.is_writable() && entry.size() <= 4 && !has_its_own_rules(entry)) {
            let before = sdo::read(drive, address(entry)).await.unwrap();
            for length in (1..=4).filter(|length| *length != entry.size()) {
                let answer = sdo::write(drive, address(entry), &vec![0; length]).await;
                assert_eq!(
                    refusal(answer),
                    Some(AbortCode::LengthMismatch),
                    "{} with {length} bytes",
                    address(entry)
                );
            }
            assert_eq!(sdo::read(drive, address(entry)).await, Ok(before), "{}", address(entry));
        }
    });
}

#[test]
fn values_beyond_the_range_are_refused_and_those_at_its_ends_are_taken() {
    let mut bounded = 0;
    in_preop(async |drive| {
        for entry in DriveObjects::ENTRIES.iter().filter(|entry| entry.access.is_writable()) {
            // Values that act, or that the state of the drive forbids, are left to tests of their own.
            if matches!(
                (entry.index, entry.sub),
                (0x200B, 2..) | (0x2010, 0) | (0x6040, 0) | (0x6060, 0) | (0x60B8, 0)
            ) {
                continue;
            }
            let (low, high) = if entry.data_type.is_signed() {
                (-(1_i64 << (entry.bits - 1)), (1_i64 << (entry.bits - 1)) - 1)
            } else {
                (0, (1_i64 << entry.bits) - 1)
            };
            if entry.max < high {
                bounded += 1;
                let answer = sdo::write(drive, address(entry), &bytes(entry.max + 1, entry)).await;
                assert_eq!(refusal(answer), Some(AbortCode::ValueTooHigh), "{}", address(entry));
            }
            if entry.min > low {
                bounded += 1;
                let answer = sdo::write(drive, address(entry), &bytes(entry.min - 1, entry)).await;
                assert_eq!(refusal(answer), Some(AbortCode::ValueTooLow), "{}", address(entry));
            }
            assert_eq!(
                sdo::read(drive, address(entry)).await,
                Ok(bytes(at_delivery(entry), entry)),
                "{}",
                address(entry)
            );
            for end in [entry.min, entry.max, entry.default] {
                assert_eq!(
                    sdo::write(drive, address(entry), &bytes(end, entry)).await,
                    Ok(()),
                    "{} = {end}",
                    address(entry)
                );
                assert_eq!(
                    sdo::read(drive, address(entry)).await,
                    Ok(bytes(end, entry)),
                    "{} = {end}",
                    address(entry)
                );
            }
        }
    });
    assert!(bounded > 40, "only {bounded} ends of ranges were tried");
}

// manual: 2.1.1/value 2.1.2/value 2.1.3/value 2.1.4/value 2.2.18/reserved 2.3.26/value
#[test]
fn read_only_objects_refuse_downloads() {
    in_preop(async |drive| {
        for entry in entries().filter(|entry| !entry.access.is_writable() && entry.size() <= 4) {
            let answer = sdo::write(drive, address(entry), &vec![0; entry.size().max(1)]).await;
            assert_eq!(refusal(answer), Some(AbortCode::ReadOnly), "{}", address(entry));
        }
    });
}

#[test]
fn objects_the_real_unit_does_not_have_do_not_exist() {
    in_preop(async |drive| {
        for index in [
            0x605D, 0x607B, 0x607D, 0x6071, 0x60B0, 0x60C2, 0x60E6, 0x60F2, 0x1003, 0x1A03, 0x1603, 0x5FFF,
        ] {
            let address = Address { index, sub: 0 };
            assert_eq!(
                refusal(sdo::read(drive, address).await),
                Some(AbortCode::ObjectNotFound),
                "{address}"
            );
            assert_eq!(
                refusal(sdo::write(drive, address, &[0, 0]).await),
                Some(AbortCode::ObjectNotFound),
                "{address}"
            );
        }
    });
}

// manual: 1.1.1/modes 2.3.4/modes 2.4.1/modes
#[test]
fn modes_the_drive_does_not_have_are_refused() {
    in_preop(async |drive| {
        let mode = "6060".parse().unwrap();
        for unsupported in [2_i8, 4, 5, 7, 9, 10, -1] {
            assert_eq!(
                refusal(sdo::write(drive, mode, &[unsupported as u8]).await),
                Some(AbortCode::ValueRange),
                "{unsupported}"
            );
        }
        for supported in [1_u8, 3, 6, 8] {
            assert_eq!(sdo::write(drive, mode, &[supported]).await, Ok(()), "{supported}");
        }
    });
}

// manual: 2.2.11/gains
#[test]
fn gains_can_be_written_only_while_the_drive_does_not_compute_them() {
    in_preop(async |drive| {
        let (auto, kp) = ("200B:1".parse().unwrap(), "200B:2".parse().unwrap());
        assert_eq!(refusal(sdo::write(drive, kp, &[0xE9, 3]).await), Some(AbortCode::DeviceState));
        sdo::write(drive, auto, &[0, 0]).await.unwrap();
        assert_eq!(sdo::write(drive, kp, &[0xE9, 3]).await, Ok(()));
    });
}

#[test]
fn what_is_missing_is_refused_and_does_not_pretend() {
    in_preop(async |drive| {
        // Touch probe 1 by a trigger other than its input.
        let answer = sdo::write(drive, "60B8".parse().unwrap(), &[0x15, 0]).await;
        assert_eq!(refusal(answer), Some(AbortCode::ValueRange));
    });
}
