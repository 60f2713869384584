//! From the first frame to OP, with or without distributed clocks.

use std::time::Duration;

use ethercrab::error::Error;
use ethercrab::subdevice_group::{DcConfiguration, HasDc, NoDc, Op, PreOp};
use ethercrab::{DcSync, DefaultLock, MainDevice, SubDeviceGroup};
use wire::Nanos;

use super::Pace;

/// Drives the built-in master can lead.
pub const MAX_DRIVES: usize = 64;
/// Bytes of process data the built-in master can exchange.
pub const MAX_PROCESS_DATA: usize = 2048;

/// Drives that all are in the state `S`.
pub type Group<S, DC = NoDc> = SubDeviceGroup<MAX_DRIVES, MAX_PROCESS_DATA, DefaultLock, S, DC>;

/// How long drives may take to OP before the master gives up: the 9 s of the ESI and one to spare.
const OP_TIMEOUT: Duration = Duration::from_secs(10);

/// From power-on to SYNC0's first pulse: time for the state changes in between.
const SYNC0_START_DELAY: Duration = Duration::from_millis(100);

/// Finds all drives and brings them to PREOP.
///
/// # Errors
/// The bus or a drive does not answer as it must.
pub async fn scan(main: &MainDevice<'_>, pace: &Pace) -> Result<Group<PreOp>, Error> {
    main.init_single_group(|| pace.now().0).await
}

/// Brings drives in PREOP to OP, their outputs taking effect with each frame; exchanges process data every `cycle` meanwhile.
///
/// # Errors
/// A drive refuses, or does not reach OP in time.
pub async fn to_op(main: &MainDevice<'_>, pace: &Pace, group: Group<PreOp>, cycle: Duration) -> Result<Group<Op>, Error> {
    let group = group.into_pre_op_pdi(main).await?.request_into_op(main).await?;
    let deadline = pace.now().after(OP_TIMEOUT);
    let mut next = pace.now();
    loop {
        let response = group.tx_rx(main).await?;
        if response.all_op() {
            return Ok(group);
        }
        give_up_after(pace, deadline)?;
        next = next.after(cycle);
        pace.until(next).await;
    }
}

/// Brings drives in PREOP to OP, their outputs taking effect with SYNC0 every `cycle`; process data are exchanged half a cycle before.
///
/// # Errors
/// A drive refuses, or does not reach OP in time.
pub async fn to_op_with_clocks(
    main: &MainDevice<'_>,
    pace: &Pace,
    mut group: Group<PreOp>,
    cycle: Duration,
) -> Result<Group<Op, HasDc>, Error> {
    for mut drive in group.iter_mut(main) {
        drive.set_dc_sync(DcSync::Sync0);
    }
    let configuration = DcConfiguration {
        start_delay: SYNC0_START_DELAY,
        sync0_period: cycle,
        sync0_shift: cycle / 2,
    };
    let group = group
        .into_pre_op_pdi(main)
        .await?
        .configure_dc_sync(main, configuration)
        .await?
        .request_into_op(main)
        .await?;
    let deadline = pace.now().after(OP_TIMEOUT);
    loop {
        let (all_op, next) = exchange_with_clocks(main, pace, &group).await?;
        if all_op {
            pace.until(next).await;
            return Ok(group);
        }
        give_up_after(pace, deadline)?;
        pace.until(next).await;
    }
}

/// Exchanges process data once; tells whether all drives are in OP and when to do it next to stay half a cycle before SYNC0.
///
/// # Errors
/// The bus or a drive does not answer as it must.
pub async fn exchange_with_clocks(main: &MainDevice<'_>, pace: &Pace, group: &Group<Op, HasDc>) -> Result<(bool, Nanos), Error> {
    let sent = pace.now();
    let response = group.tx_rx_dc(main).await?;
    Ok((response.all_op(), sent.after(response.extra.next_cycle_wait)))
}

fn give_up_after(pace: &Pace, deadline: Nanos) -> Result<(), Error> {
    if pace.now() > deadline {
        Err(Error::Timeout(ethercrab::error::TimeoutError::StateTransition))
    } else {
        Ok(())
    }
}
