//! Sync managers 0 to 3 and what is required of them.

use core::ops::Range;

use wire::EscAccess;
use wire::al::AlStatusCode;
use wire::register::{self, sync_manager};

use crate::configuration::MailboxLimits;

/// Sync manager of the mailbox from the master.
pub(crate) const MAILBOX_OUT: usize = 0;
/// Sync manager of the mailbox to the master.
pub(crate) const MAILBOX_IN: usize = 1;
/// Sync manager of the process data from the master.
pub(crate) const OUTPUTS: usize = 2;
/// Sync manager of the process data to the master.
pub(crate) const INPUTS: usize = 3;

/// How many sync managers the stack uses.
const USED: usize = 4;
/// How many sync managers a chip has whose activate registers a master may write.
const PRESENT: usize = 8;
const SIZE: usize = register::SM_SIZE as usize;

/// A sync manager's registers as the master set them up.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct SyncManager {
    /// Start address.
    pub(crate) start: u16,
    /// Length in bytes.
    pub(crate) length: u16,
    /// Mode, direction, interrupts, watchdog.
    pub(crate) control: u8,
    /// Enable and repeat request.
    pub(crate) activate: u8,
}

impl SyncManager {
    fn parse(bytes: &[u8]) -> Self {
        Self {
            start: u16::from_le_bytes([bytes[0], bytes[1]]),
            length: u16::from_le_bytes([bytes[2], bytes[3]]),
            control: bytes[sync_manager::CONTROL as usize],
            activate: bytes[sync_manager::ACTIVATE as usize],
        }
    }

    /// Whether the master enabled it.
    pub(crate) const fn is_enabled(&self) -> bool {
        self.activate & sync_manager::ACTIVATE_ENABLE != 0
    }

    /// The level of the repeat request.
    pub(crate) const fn repeat_requested(&self) -> bool {
        self.activate & sync_manager::ACTIVATE_REPEAT != 0
    }

    /// Whether a write triggers the process data watchdog.
    pub(crate) const fn triggers_watchdog(&self) -> bool {
        self.control & sync_manager::CONTROL_WATCHDOG != 0
    }

    /// Whether it has one buffer with handshake instead of three.
    pub(crate) const fn has_one_buffer(&self) -> bool {
        self.control & sync_manager::CONTROL_MODE == sync_manager::MODE_MAILBOX
    }

    /// Whether both lie at the same place in the same way; interrupts and the repeat request may differ.
    pub(crate) const fn same_area(&self, other: &Self) -> bool {
        self.start == other.start && self.length == other.length && self.is_enabled() == other.is_enabled()
    }

    const fn mode(&self) -> u8 {
        self.control & sync_manager::CONTROL_MODE
    }

    const fn direction(&self) -> u8 {
        self.control & sync_manager::CONTROL_DIRECTION
    }

    /// The memory it takes, all buffers together.
    fn memory(&self) -> Range<u32> {
        let buffers = if self.mode() == sync_manager::MODE_BUFFERED { 3 } else { 1 };
        let length = if self.is_enabled() { u32::from(self.length) * buffers } else { 0 };
        u32::from(self.start)..u32::from(self.start) + length
    }

    fn lies_in(&self, window: &Range<u16>) -> bool {
        let memory = self.memory();
        memory.start >= u32::from(window.start) && memory.end <= u32::from(window.end)
    }

    fn overlaps(&self, other: &Self) -> bool {
        let (a, b) = (self.memory(), other.memory());
        !a.is_empty() && !b.is_empty() && a.start < b.end && b.start < a.end
    }
}

/// Reads the sync managers, which acknowledges the event that one of them was changed.
pub(crate) fn read(esc: &mut impl EscAccess) -> [SyncManager; USED] {
    let mut bytes = [0; PRESENT * SIZE];
    esc.read(register::SM, &mut bytes);
    core::array::from_fn(|index| SyncManager::parse(&bytes[index * SIZE..]))
}

/// Writes the PDI control byte of a sync manager.
pub(crate) fn write_pdi_control(esc: &mut impl EscAccess, index: usize, value: u8) {
    esc.write_u8(register::SM + index as u16 * register::SM_SIZE + sync_manager::PDI_CONTROL, value);
}

/// Checks the mailboxes.
///
/// # Errors
/// [`AlStatusCode::InvalidMailboxConfiguration`]: disabled, wrong mode, direction, length or place, or one on top of the other.
pub(crate) fn check_mailboxes(all: &[SyncManager; USED], limits: &MailboxLimits) -> Result<(), AlStatusCode> {
    let fits = |sm: &SyncManager, direction: u8| {
        sm.is_enabled()
            && sm.mode() == sync_manager::MODE_MAILBOX
            && sm.direction() == direction
            && (limits.min..=limits.max).contains(&sm.length)
            && sm.lies_in(&limits.window)
    };
    let (out, back) = (&all[MAILBOX_OUT], &all[MAILBOX_IN]);
    if fits(out, sync_manager::DIRECTION_WRITE) && fits(back, sync_manager::DIRECTION_READ) && !out.overlaps(back) {
        Ok(())
    } else {
        Err(AlStatusCode::InvalidMailboxConfiguration)
    }
}

/// Checks the sync managers of the process data, inputs first, against the sizes of the mapped images in bytes.
///
/// # Errors
/// [`AlStatusCode::InvalidInputConfiguration`] or [`AlStatusCode::InvalidOutputConfiguration`].
pub(crate) fn check_process_data(
    all: &[SyncManager; USED],
    output_size: usize,
    input_size: usize,
    window: &Range<u16>,
) -> Result<(), AlStatusCode> {
    use AlStatusCode::{InvalidInputConfiguration, InvalidOutputConfiguration};
    let [mailbox_out, mailbox_in, outputs, inputs] = all;
    ensure(
        fits(inputs, input_size, sync_manager::DIRECTION_READ, window),
        InvalidInputConfiguration,
    )?;
    ensure(
        fits(outputs, output_size, sync_manager::DIRECTION_WRITE, window),
        InvalidOutputConfiguration,
    )?;
    let on_mailbox = |sm: &SyncManager| sm.overlaps(mailbox_out) || sm.overlaps(mailbox_in);
    ensure(!on_mailbox(outputs), InvalidOutputConfiguration)?;
    ensure(!on_mailbox(inputs) && !inputs.overlaps(outputs), InvalidInputConfiguration)
}

/// Whether a process data sync manager carries exactly `size` bytes, and is off when there are none.
fn fits(sm: &SyncManager, size: usize, direction: u8, window: &Range<u16>) -> bool {
    if usize::from(sm.length) != size || sm.is_enabled() == (size == 0) {
        return false;
    }
    let mode_exists = matches!(sm.mode(), sync_manager::MODE_BUFFERED | sync_manager::MODE_MAILBOX);
    size == 0 || (sm.direction() == direction && mode_exists && sm.lies_in(window))
}

/// `code` unless `condition` holds.
fn ensure(condition: bool, code: AlStatusCode) -> Result<(), AlStatusCode> {
    if condition { Ok(()) } else { Err(code) }
}
