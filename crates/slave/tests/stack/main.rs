//! The stack over a chip made of memory, with a master that writes its registers.

mod chip;
mod lamp;
mod mailbox;
mod pdo;
mod robustness;
mod sdo;
mod states;
mod synchronization;
mod workbench;
