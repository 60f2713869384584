//! One drive in OP under control over its default process data.

use std::fmt;
use std::time::Duration;

use ethercrab::error::Error;
use ethercrab::subdevice_group::{HasDc, Op};
use ethercrab::{MainDevice, SubDeviceState};
use wire::Nanos;

use super::Pace;
use super::bring_up::{self, Group};
use super::process_data::{Inputs, Outputs, controlword, statusword, towards_enabled};

/// How long a drive may take to be enabled, to be disabled or to acknowledge.
pub const HANDSHAKE_LIMIT: Duration = Duration::from_secs(5);

/// Why an axis could not be led further.
#[derive(Debug)]
pub enum AxisError {
    /// The bus or a drive does not answer as it must.
    Bus(Error),
    /// A drive has left OP by itself.
    LeftOp {
        /// Its position on the bus, counted from 1.
        drive: usize,
        /// Its AL status code (0x0134), in words.
        reason: String,
    },
    /// The drive went into fault; 0x603F tells why.
    Fault {
        /// Its statusword.
        statusword: u16,
    },
    /// The drive did not do in time what was asked.
    TimedOut {
        /// What was asked, to complete "the drive does not ...".
        what: &'static str,
        /// Its statusword.
        statusword: u16,
    },
}

impl fmt::Display for AxisError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Bus(error) => write!(f, "exchanging process data: {error}"),
            Self::LeftOp { drive, reason } => write!(f, "drive {drive} has left OP: {reason}"),
            Self::Fault { statusword } => write!(f, "the drive went into fault (statusword 0x{statusword:04X}); 0x603F tells why"),
            Self::TimedOut { what, statusword } => write!(f, "the drive does not {what} (statusword 0x{statusword:04X})"),
        }
    }
}

impl std::error::Error for AxisError {}

impl From<Error> for AxisError {
    fn from(error: Error) -> Self {
        Self::Bus(error)
    }
}

/// Drives in OP, and what makes their outputs take effect.
pub enum Operating {
    /// Each frame (SM-synchronous), at this interval.
    Frames(Group<Op>, Duration),
    /// SYNC0 of the distributed clocks, whose cycle the group knows.
    Clocks(Group<Op, HasDc>),
}

/// One exchange of process data as an observer sees it.
#[derive(Clone, Copy, Debug)]
pub struct Exchange {
    /// When it began.
    pub time: Nanos,
    /// When it should have begun.
    pub due: Nanos,
    /// What was sent.
    pub outputs: Outputs,
    /// What came back.
    pub inputs: Inputs,
}

/// One drive in OP; the others on the bus are kept in OP with the outputs they have.
pub struct Axis<'a> {
    main: &'a MainDevice<'a>,
    pace: &'a Pace,
    drives: Operating,
    position: usize,
    due: Nanos,
    observer: &'a mut dyn FnMut(&Exchange),
    /// What is sent from the next exchange on.
    pub outputs: Outputs,
    /// What the last exchange brought.
    pub inputs: Inputs,
}

impl<'a> Axis<'a> {
    /// Takes control of the drive at `position`, counted from 0. `observer` is called with every exchange.
    pub fn new(
        main: &'a MainDevice<'a>,
        pace: &'a Pace,
        drives: Operating,
        position: usize,
        observer: &'a mut dyn FnMut(&Exchange),
    ) -> Self {
        let due = pace.now();
        Self {
            main,
            pace,
            drives,
            position,
            due,
            observer,
            outputs: Outputs::default(),
            inputs: Inputs::default(),
        }
    }

    /// One exchange of process data, and the wait until the next is due.
    ///
    /// # Errors
    /// The bus fails, or a drive has left OP.
    pub async fn cycle(&mut self) -> Result<(), AxisError> {
        let (time, due) = (self.pace.now(), self.due);
        let (all_op, next) = self.exchange().await?;
        if !all_op {
            return Err(self.why_left().await?);
        }
        (self.observer)(&Exchange {
            time,
            due,
            outputs: self.outputs,
            inputs: self.inputs,
        });
        self.due = next;
        self.pace.until(next).await;
        Ok(())
    }

    async fn exchange(&mut self) -> Result<(bool, Nanos), Error> {
        match &self.drives {
            Operating::Frames(group, interval) => {
                self.put_outputs(group)?;
                let response = group.tx_rx(self.main).await?;
                self.inputs = self.take_inputs(group)?;
                // A cycle that was missed is left out, not made up for.
                Ok((response.all_op(), self.due.after(*interval).max(self.pace.now())))
            }
            Operating::Clocks(group) => {
                self.put_outputs(group)?;
                let response = bring_up::exchange_with_clocks(self.main, self.pace, group).await?;
                self.inputs = self.take_inputs(group)?;
                Ok(response)
            }
        }
    }

    fn put_outputs<DC>(&self, group: &Group<Op, DC>) -> Result<(), Error> {
        self.outputs.put(&mut group.subdevice(self.main, self.position)?.outputs_raw_mut());
        Ok(())
    }

    fn take_inputs<DC>(&self, group: &Group<Op, DC>) -> Result<Inputs, Error> {
        Ok(Inputs::take(&group.subdevice(self.main, self.position)?.inputs_raw()))
    }

    /// Asks the drives which of them has left OP, and why.
    async fn why_left(&self) -> Result<AxisError, Error> {
        match &self.drives {
            Operating::Frames(group, _) => self.why_left_group(group).await,
            Operating::Clocks(group) => self.why_left_group(group).await,
        }
    }

    async fn why_left_group<DC>(&self, group: &Group<Op, DC>) -> Result<AxisError, Error> {
        for position in 0..group.len() {
            let (state, code) = group.subdevice(self.main, position)?.status().await?;
            if state != SubDeviceState::Op {
                let (drive, reason) = (position + 1, format!("{code} (AL status code 0x{:04X})", u16::from(code)));
                return Ok(AxisError::LeftOp { drive, reason });
            }
        }
        let (drive, reason) = (self.position + 1, "it is back by now".into());
        Ok(AxisError::LeftOp { drive, reason })
    }

    /// Exchanges process data until the inputs meet a condition.
    ///
    /// # Errors
    /// They do not within `limit`, the drive goes into fault, or [`Axis::cycle`] fails.
    pub async fn until(&mut self, what: &'static str, limit: Duration, met: impl Fn(&Inputs) -> bool) -> Result<(), AxisError> {
        let deadline = self.pace.now().after(limit);
        loop {
            self.cycle().await?;
            let statusword = self.inputs.statusword;
            if met(&self.inputs) {
                return Ok(());
            }
            if statusword & statusword::FAULT != 0 {
                return Err(AxisError::Fault { statusword });
            }
            if self.pace.now() > deadline {
                return Err(AxisError::TimedOut { what, statusword });
            }
        }
    }

    /// Reads 0x603F, which tells why a drive went into fault, while process data rest.
    ///
    /// # Errors
    /// The mailbox does not answer.
    pub async fn error_code(&self) -> Result<u16, Error> {
        let read = async || match &self.drives {
            Operating::Frames(group, _) => group.subdevice(self.main, self.position)?.sdo_read(0x603F, 0).await,
            Operating::Clocks(group) => group.subdevice(self.main, self.position)?.sdo_read(0x603F, 0).await,
        };
        // The fault's emergency message lies before the answer in the mailbox, and ethercrab takes it for an error.
        match read().await {
            Err(_) => read().await,
            code => code,
        }
    }

    /// Leads the drive to Operation Enabled, out of a fault too if its cause is gone.
    ///
    /// # Errors
    /// It does not get there in time.
    pub async fn enable(&mut self) -> Result<(), AxisError> {
        let deadline = self.pace.now().after(HANDSHAKE_LIMIT);
        loop {
            self.cycle().await?;
            let statusword = self.inputs.statusword;
            if statusword::is_enabled(statusword) {
                return Ok(());
            }
            if self.pace.now() > deadline {
                return Err(AxisError::TimedOut {
                    what: "reach Operation Enabled",
                    statusword,
                });
            }
            self.outputs.controlword = towards_enabled(statusword, self.outputs.controlword);
        }
    }

    /// Hands a new set-point to profile position mode: target, rising edge of bit 4, acknowledge, falling edge.
    ///
    /// `bits` are further bits of the controlword, such as [`controlword::RELATIVE`].
    ///
    /// # Errors
    /// The drive does not acknowledge.
    pub async fn set_point(&mut self, target: i32, bits: u16) -> Result<(), AxisError> {
        self.outputs.target_position = target;
        self.outputs.controlword = controlword::ENABLE_OPERATION | controlword::START | bits;
        let acknowledge = |inputs: &Inputs| inputs.statusword & statusword::ACKNOWLEDGE != 0;
        self.until("acknowledge the set-point", HANDSHAKE_LIMIT, acknowledge).await?;
        self.outputs.controlword = controlword::ENABLE_OPERATION | bits;
        self.until("take the acknowledge back", HANDSHAKE_LIMIT, |inputs| !acknowledge(inputs))
            .await
    }

    /// Starts homing and waits until it has ended and the drive stands. Returns whether home was found.
    ///
    /// # Errors
    /// It does not end within `limit`.
    pub async fn home(&mut self, limit: Duration) -> Result<bool, AxisError> {
        const ENDED: u16 = statusword::ACKNOWLEDGE | statusword::TARGET_REACHED;
        const FAILED: u16 = statusword::HOMING_ERROR | statusword::TARGET_REACHED;
        self.outputs.controlword = controlword::ENABLE_OPERATION;
        self.cycle().await?;
        self.outputs.controlword |= controlword::START;
        // The bits of an earlier homing drop in the cycle in which this one is accepted.
        self.until("start homing", HANDSHAKE_LIMIT, |inputs| {
            inputs.statusword & ENDED == 0 || inputs.statusword & FAILED == FAILED
        })
        .await?;
        let ended = |inputs: &Inputs| inputs.statusword & ENDED == ENDED || inputs.statusword & FAILED == FAILED;
        self.until("end homing", limit, ended).await?;
        Ok(self.inputs.statusword & statusword::HOMING_ERROR == 0)
    }

    /// Disables the drive and brings all drives back to PREOP.
    ///
    /// # Errors
    /// The drive stays enabled, or a state is refused.
    pub async fn leave(mut self) -> Result<(), AxisError> {
        self.outputs.controlword = controlword::SHUTDOWN;
        self.until("leave Operation Enabled", HANDSHAKE_LIMIT, |inputs| {
            !statusword::is_enabled(inputs.statusword)
        })
        .await?;
        match self.drives {
            Operating::Frames(group, _) => drop(group.into_safe_op(self.main).await?.into_pre_op(self.main).await?),
            Operating::Clocks(group) => drop(group.into_safe_op(self.main).await?.into_pre_op(self.main).await?),
        }
        Ok(())
    }
}
