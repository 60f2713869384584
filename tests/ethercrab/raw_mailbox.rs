//! CoE messages that `ethercrab` has no function for, sent and fetched as mailbox memory.

use ethercrab::{SubDevice, SubDeviceRef};

/// The mailboxes as the SII sets them up.
const OUT: u16 = 0x1000;
const BACK: u16 = 0x1080;
const BACK_STATUS: u16 = 0x080D;
const FULL: u8 = 1 << 3;
const SIZE: usize = 128;
const HEADERS: usize = 8;

/// Sends a CoE message of `service`; a counter of 0 is never taken for a repetition.
pub async fn send(drive: &SubDeviceRef<'_, &SubDevice>, service: u8, body: &[u8]) {
    let mut message = [0; SIZE];
    message[0] = body.len() as u8 + 2;
    message[5] = 3;
    message[7] = service << 4;
    message[HEADERS..HEADERS + body.len()].copy_from_slice(body);
    drive.register_write(OUT, message).await.unwrap();
}

/// The next CoE message that lies in the mailbox: its service and its bytes.
pub async fn fetch(drive: &SubDeviceRef<'_, &SubDevice>) -> Option<(u8, Vec<u8>)> {
    if drive.register_read::<u8>(BACK_STATUS).await.unwrap() & FULL == 0 {
        return None;
    }
    let message: [u8; SIZE] = drive.register_read(BACK).await.unwrap();
    assert_eq!(message[5] & 0x0F, 3, "a CoE message");
    Some((message[7] >> 4, message[HEADERS..6 + usize::from(message[0])].to_vec()))
}

/// Sends a request for SDO information and returns the answer's messages, from the opcode on.
pub async fn inform(drive: &SubDeviceRef<'_, &SubDevice>, request: &[u8]) -> Vec<Vec<u8>> {
    send(drive, 8, request).await;
    let mut messages = Vec::new();
    while let Some((service, message)) = fetch(drive).await {
        assert_eq!(service, 8, "SDO information");
        messages.push(message);
    }
    messages
}
