//! An EtherCAT slave stack over any slave controller ([`wire::EscAccess`]) and any object dictionary ([`dictionary::Objects`]).
//!
//! | module | holds |
//! |---|---|
//! | [`stack`] | [`Slave`]: what [`Slave::poll`] does with the chip's events, and in which order |
//! | [`configuration`] | [`Configuration`]: what makes a device of the stack |
//! | [`application`] | [`Application`]: what the stack asks of the device |
//! | [`esm`] | the EtherCAT state machine as a total function of status and request |
//! | `transitions` | the checked steps of each change of state |
//! | [`indicators`] | RUN and ERR LED |
//! | `supervision` | what makes the stack leave a state by itself |
//! | `sync_managers` | sync managers 0 to 3 and what is required of them |
//! | `mailbox` | receiving, answering, counting and repeating mailbox messages |
//! | [`event_log`] | what has happened since power-on: 0x10F3 and a file |
//! | `emergency` | emergency messages on their way to the master |
//! | `coe` | which CoE service a message is for |
//! | `sdo` | the SDO server: uploads and downloads, expedited, normal and segmented |
//! | `information` | SDO information: which objects there are, and what is known of them |
//! | `foe` | the FoE server: files read and written |
//! | [`files`] | what a file is |
//! | [`objects`] | the table of objects 0x1000 to 0x1FFF |
//! | `communication_area` | the values of these objects |
//! | `device_objects` | both dictionaries as one, with access rights by state |
//! | `complete_access` | all entries of an object in one transfer |
//! | `bits` | values at any bit of an image |
//! | `sync_parameters` | 0x1C32 and 0x1C33 |
//! | `timing` | how long events of synchronisation wait |
//! | `pdo` | PDO mapping and assignment, and the process image made from them |
//! | `process_data` | sync manager 2 to objects, objects to sync manager 3 |
//! | `synchronization` | free run, sync manager and SYNC0: choice, sequence check, cycle time |
//!
//! The stack knows nothing of the device it is part of; time comes in as an argument.
#![no_std]
#![forbid(unsafe_code)]

#[cfg(test)]
extern crate std;

pub mod application;
mod bits;
mod coe;
mod communication_area;
mod complete_access;
pub mod configuration;
mod device_objects;
mod emergency;
pub mod esm;
pub mod event_log;
pub mod files;
mod foe;
pub mod indicators;
mod information;
mod mailbox;
pub mod objects;
mod pdo;
mod process_data;
mod sdo;
pub mod stack;
mod supervision;
mod sync_managers;
mod sync_parameters;
mod synchronization;
mod timing;
mod transitions;

pub use application::Application;
pub use configuration::{Configuration, Identity, MAX_MAILBOX, MAX_OBJECT_SIZE, MAX_PROCESS_DATA, MailboxLimits};
pub use indicators::Leds;
pub use objects::{MAX_MAPPING_ENTRIES, PDOS_PER_DIRECTION};
pub use stack::{Report, Slave, Sync};
