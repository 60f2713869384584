//! What the process data follow: choice, sequence of outputs and SYNC0, cycle time (ETG.1020, synchronisation).

use wire::al::AlStatusCode;
use wire::register::{self, dc_activation};
use wire::{EscAccess, Nanos};

use crate::sync_parameters::{SyncParameters, sync_type};

/// What the process data follow.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Mode {
    /// A local timer for inputs; outputs take effect when they come.
    #[default]
    FreeRun,
    /// The event of sync manager 2.
    SyncManager,
    /// SYNC0 with this cycle in ns.
    Sync0 { cycle: u32 },
}

/// How the master has set up the SYNC unit of the chip.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct SyncUnit {
    activation: u8,
    sync0_cycle: u32,
    sync1_cycle: u32,
}

impl SyncUnit {
    /// Reads the set-up.
    pub(crate) fn read(esc: &mut impl EscAccess) -> Self {
        Self {
            activation: esc.read_u8(register::DC_ACTIVATION),
            sync0_cycle: esc.read_u32(register::DC_SYNC0_CYCLE),
            sync1_cycle: esc.read_u32(register::DC_SYNC1_CYCLE),
        }
    }

    const fn is_active(&self) -> bool {
        self.activation & (dc_activation::CYCLIC | dc_activation::AUTO) != 0
    }

    const fn generates(&self, signal: u8) -> bool {
        self.activation & signal != 0
    }

    /// Chooses the mode from the set-up and from what the master wrote to 0x1C32:01 and 0x1C33:01, and shows it there.
    ///
    /// # Errors
    /// 0x0030 for signals that are missing or that the device cannot follow, 0x0036 for a SYNC0 cycle that is too short or single shot.
    pub(crate) fn choose(
        &self,
        outputs: &mut SyncParameters,
        inputs: &mut SyncParameters,
        minimum_cycle: u32,
    ) -> Result<Mode, AlStatusCode> {
        if self.is_active() {
            self.check_signals()?;
        }
        let derived = if self.is_active() {
            sync_type::SYNC0
        } else {
            sync_type::SYNC_MANAGER
        };
        outputs.derive_type(derived);
        inputs.derive_type(match outputs.sync_type {
            sync_type::SYNC_MANAGER => sync_type::SYNC_MANAGER_2,
            sync_type::SYNC0 if self.generates(dc_activation::SYNC1) => sync_type::SYNC1,
            other => other,
        });
        self.check_choice(outputs.sync_type)?;
        self.check_choice(inputs.sync_type)?;
        let mode = match outputs.sync_type {
            sync_type::FREE_RUN => Mode::FreeRun,
            sync_type::SYNC0 if self.sync0_cycle == 0 || self.sync0_cycle < minimum_cycle => {
                return Err(AlStatusCode::InvalidSync0CycleTime);
            }
            sync_type::SYNC0 => Mode::Sync0 { cycle: self.sync0_cycle },
            _ => Mode::SyncManager,
        };
        let cycle = if let Mode::Sync0 { cycle } = mode { cycle } else { 0 };
        for parameters in [outputs, inputs] {
            (parameters.cycle, parameters.sync0_cycle) = (cycle, cycle);
        }
        Ok(mode)
    }

    /// SYNC1 needs SYNC0 and must not divide it: cycles below SYNC0 are not supported.
    const fn check_signals(&self) -> Result<(), AlStatusCode> {
        let subordinated = self.generates(dc_activation::SYNC1) && self.sync1_cycle != 0 && self.sync1_cycle >= self.sync0_cycle;
        if self.generates(dc_activation::SYNC0) && !subordinated {
            Ok(())
        } else {
            Err(AlStatusCode::InvalidDcSyncConfiguration)
        }
    }

    /// Whether the signal a type needs is there.
    const fn check_choice(&self, kind: u16) -> Result<(), AlStatusCode> {
        let available = match kind {
            sync_type::SYNC0 => self.is_active(),
            sync_type::SYNC1 => self.is_active() && self.generates(dc_activation::SYNC1),
            _ => true,
        };
        if available {
            Ok(())
        } else {
            Err(AlStatusCode::InvalidDcSyncConfiguration)
        }
    }
}

/// How many outputs in step with SYNC0 show that the master's cycle is running.
const STEPS_TO_ARM: u8 = 4;
/// How long a master may take from OP to a running cycle, in ns; then the check begins in any case.
const ARM_AFTER: u64 = 1_000_000_000;
/// What a SYNC0 without outputs counts.
const MISSED: u16 = 3;

/// Whether outputs and SYNC0 alternate.
///
/// Some masters send single frames until they see OP, and start their cycle then; the check is armed by the first few outputs in step.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Sequence {
    counter: u16,
    in_step: u8,
    output_came: bool,
    op_since: Nanos,
}

impl Sequence {
    /// OP begins, with the outputs that it took.
    pub(crate) fn start(&mut self, now: Nanos) {
        *self = Self {
            output_came: true,
            op_since: now,
            ..Self::default()
        };
    }

    /// Outputs came.
    pub(crate) fn output(&mut self) {
        self.output_came = true;
        self.counter = self.counter.saturating_sub(1);
    }

    /// SYNC0 came; returns whether outputs were missing before it.
    pub(crate) fn sync(&mut self, now: Nanos) -> bool {
        let missed = !core::mem::take(&mut self.output_came);
        if !missed {
            self.in_step = self.in_step.saturating_add(1);
        } else if self.is_armed(now) {
            self.counter = self.counter.saturating_add(MISSED);
        } else {
            self.in_step = 0;
        }
        missed
    }

    /// Whether outputs and SYNC0 are out of step by `limit` (0x10F1:02) or more.
    pub(crate) const fn is_broken(&self, limit: u16) -> bool {
        limit != 0 && self.counter >= limit
    }

    fn is_armed(&self, now: Nanos) -> bool {
        self.in_step >= STEPS_TO_ARM || now.since(self.op_since) >= ARM_AFTER
    }
}

/// How many intervals unlike the others make up a new cycle time.
const NEW_CYCLE_AFTER: u8 = 4;
/// Longer intervals are pauses, in ns.
const PAUSE: u64 = 1_000_000_000;

/// The time between two outputs, measured.
///
/// Intervals near the known cycle are averaged, which takes the jitter out; single others (a lost frame) are left out; several in
/// succession are a new cycle.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct CycleMeter {
    last: Option<Nanos>,
    cycle: Option<u32>,
    strange: u8,
}

impl CycleMeter {
    /// The cycle in ns; `None` before there was an interval.
    pub(crate) const fn cycle(&self) -> Option<u32> {
        self.cycle
    }

    /// Outputs came.
    pub(crate) fn output(&mut self, now: Nanos) {
        let Some(last) = self.last.replace(now) else { return };
        let interval = match u32::try_from(now.since(last)) {
            Ok(interval) if interval != 0 && u64::from(interval) <= PAUSE => interval,
            Ok(0) => return,
            _ => {
                return *self = Self {
                    last: Some(now),
                    ..Self::default()
                };
            }
        };
        let Some(cycle) = self.cycle else {
            self.cycle = Some(interval);
            return;
        };
        if interval.abs_diff(cycle) <= cycle / 2 {
            self.strange = 0;
            let step = (i64::from(interval) - i64::from(cycle)) / 8;
            self.cycle = u32::try_from(i64::from(cycle) + step).ok();
        } else {
            self.strange += 1;
            if self.strange >= NEW_CYCLE_AFTER {
                (self.cycle, self.strange) = (Some(interval), 0);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn meter(intervals: impl IntoIterator<Item = u64>) -> Option<u32> {
        let mut meter = CycleMeter::default();
        let mut now = 0;
        meter.output(Nanos(now));
        for interval in intervals {
            now += interval;
            meter.output(Nanos(now));
        }
        meter.cycle()
    }

    #[test]
    fn the_cycle_is_known_after_one_interval_and_jitter_is_averaged() {
        assert_eq!(meter([]), None);
        assert_eq!(meter([1_000_000]), Some(1_000_000));
        let cycle = meter((0..200).map(|k| if k % 2 == 0 { 900_000 } else { 1_100_000 })).unwrap();
        assert!(cycle.abs_diff(1_000_000) < 30_000, "{cycle}");
    }

    #[test]
    fn a_lost_frame_does_not_change_the_cycle_but_a_new_cycle_does() {
        assert_eq!(meter([1_000_000, 1_000_000, 2_000_000, 1_000_000]), Some(1_000_000));
        assert_eq!(meter([200_000_000, 1_000_000, 1_000_000, 1_000_000, 1_000_000]), Some(1_000_000));
        assert_eq!(meter([1_000_000, 2_000_000_000]), None);
    }

    #[test]
    fn two_missed_outputs_in_succession_break_the_default_limit_and_one_does_not() {
        let mut sequence = Sequence::default();
        sequence.start(Nanos(0));
        for _ in 0..STEPS_TO_ARM {
            sequence.output();
            assert!(!sequence.sync(Nanos(1)));
        }
        assert!(sequence.sync(Nanos(1)) && !sequence.is_broken(4));
        let mut recovered = sequence;
        for _ in 0..3 {
            recovered.output();
            recovered.sync(Nanos(1));
        }
        assert!(recovered.sync(Nanos(1)) && !recovered.is_broken(4));
        assert!(sequence.sync(Nanos(1)) && sequence.is_broken(4) && !sequence.is_broken(0));
    }

    #[test]
    fn the_check_waits_for_the_masters_cycle_but_not_for_ever() {
        let mut sequence = Sequence::default();
        sequence.start(Nanos(0));
        for _ in 0..100 {
            sequence.sync(Nanos(ARM_AFTER - 1));
        }
        assert!(!sequence.is_broken(4));
        sequence.sync(Nanos(ARM_AFTER));
        sequence.sync(Nanos(ARM_AFTER));
        assert!(sequence.is_broken(4));
    }
}
