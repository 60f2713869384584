//! The stack over a chip made of memory, with a master that writes its registers.

mod chip;
mod complete_access;
mod emergency;
mod event_log;
mod foe;
mod indicators;
mod information;
mod lamp;
mod mailbox;
mod pdo;
mod robustness;
mod sdo;
mod states;
mod synchronization;
mod workbench;
