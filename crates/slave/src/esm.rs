//! The EtherCAT state machine: what a request means in a state (ETG.1000.6, EtherCAT state machine).

use wire::al::{AlControl, AlState, AlStatus, AlStatusCode};

/// What becomes of a request in AL control.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Decision {
    /// Nothing: an error is pending and not acknowledged.
    Ignore,
    /// A pending error is acknowledged; the state stays.
    Stay,
    /// A pending error is acknowledged; this transition begins.
    Change(AlState),
    /// The request is answered with this code; the state stays.
    Refuse(AlStatusCode),
}

/// What a request means in a state.
///
/// A request for INIT acknowledges a pending error by itself; every other needs the acknowledge bit. The bit without a pending error
/// means nothing.
pub const fn decide(status: AlStatus, control: AlControl) -> Decision {
    let requested = AlState::from_code(control.state_code());
    if status.error && !control.acknowledges_error() && !matches!(requested, Some(AlState::Init)) {
        return Decision::Ignore;
    }
    match requested {
        None => Decision::Refuse(AlStatusCode::UnknownState),
        Some(target) => transition(status.state, target),
    }
}

/// The transition matrix.
const fn transition(from: AlState, to: AlState) -> Decision {
    use AlState::{Boot, Init, Op, PreOp, SafeOp};
    match (from, to) {
        (Init, Init) | (PreOp, PreOp) | (Boot, Boot) | (SafeOp, SafeOp) | (Op, Op) => Decision::Stay,
        // IP, PS, SO: one step up at a time.
        (Init, PreOp) | (PreOp, SafeOp) | (SafeOp, Op) => Decision::Change(to),
        // OS, OP, OI, SP, SI, PI, BI: down over any number of steps.
        (Op, SafeOp) | (Op | SafeOp, PreOp) | (_, Init) => Decision::Change(to),
        (Init, Boot) => Decision::Refuse(AlStatusCode::BootNotSupported),
        _ => Decision::Refuse(AlStatusCode::InvalidStateChange),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use AlState::{Boot, Init, Op, PreOp, SafeOp};

    fn request(code: u16) -> AlControl {
        AlControl(code)
    }

    #[test]
    fn a_pending_error_waits_for_its_acknowledge_or_init() {
        for state in AlState::ALL {
            let status = AlStatus {
                state,
                error: true,
                ..AlStatus::default()
            };
            for code in 0..16 {
                let decision = decide(status, request(code));
                assert_eq!(decision == Decision::Ignore, code != 1, "{state:?} {code}");
                assert_ne!(decide(status, request(code | 0x10)), Decision::Ignore);
            }
        }
    }

    #[test]
    fn without_a_pending_error_the_acknowledge_bit_means_nothing() {
        for state in AlState::ALL {
            let status = AlStatus {
                state,
                ..AlStatus::default()
            };
            for code in 0..16 {
                assert_eq!(decide(status, request(code)), decide(status, request(code | 0x10)));
            }
        }
    }

    #[test]
    fn the_matrix_is_the_standards() {
        let up = [(Init, PreOp), (PreOp, SafeOp), (SafeOp, Op)];
        let down = [
            (Op, SafeOp),
            (Op, PreOp),
            (Op, Init),
            (SafeOp, PreOp),
            (SafeOp, Init),
            (PreOp, Init),
            (Boot, Init),
        ];
        for from in AlState::ALL {
            for to in AlState::ALL {
                let expected = if from == to {
                    Decision::Stay
                } else if up.contains(&(from, to)) || down.contains(&(from, to)) {
                    Decision::Change(to)
                } else if (from, to) == (Init, Boot) {
                    Decision::Refuse(AlStatusCode::BootNotSupported)
                } else {
                    Decision::Refuse(AlStatusCode::InvalidStateChange)
                };
                let status = AlStatus {
                    state: from,
                    ..AlStatus::default()
                };
                assert_eq!(decide(status, request(to.code().into())), expected, "{from:?} -> {to:?}");
            }
        }
    }

    #[test]
    fn codes_that_are_no_state_are_refused() {
        for code in [0, 5, 6, 7, 9, 10, 11, 12, 13, 14, 15] {
            let status = AlStatus::default();
            assert_eq!(decide(status, request(code)), Decision::Refuse(AlStatusCode::UnknownState));
        }
    }
}
