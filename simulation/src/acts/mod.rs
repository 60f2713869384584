//! What the master does: half of it what a machine's program would do, half of it what none should.
//!
//! | module | holds |
//! |---|---|
//! | [`bring_up`] | states, mapping, enabling |
//! | [`motions`] | set-points, speeds, cyclic targets, homing, probes |
//! | [`commissioning`] | what the drive is told of its motor |
//! | [`breakdowns`] | what breaks, and is mended |
//! | [`nonsense`] | any controlword, any download, any request |
//! | [`surroundings`] | inputs, supply, cable, axis, power |
//! | [`files`] | backups of the parameters, and the event log |
//! | [`transfers`] | segments and complete access |
//! | [`parameters`] | saved parameters and what the next power-on must find |

pub mod breakdowns;
pub mod bring_up;
pub mod commissioning;
pub mod files;
pub mod motions;
pub mod nonsense;
pub mod parameters;
pub mod surroundings;
pub mod transfers;

use crate::Simulation;
use crate::invariants::Verdict;

type Act = fn(&mut Simulation) -> Verdict;

/// The acts and how often each is chosen.
const ACTS: &[(u64, Act)] = &[
    (10, Simulation::move_by_set_points),
    (7, Simulation::turn_at_speeds),
    (7, Simulation::follow_targets),
    (6, Simulation::home),
    (5, Simulation::change_modes),
    (4, Simulation::arm_probes),
    (3, Simulation::clear_position),
    (3, Simulation::save_parameters),
    (3, Simulation::begin_anew),
    (4, Simulation::change_parameters),
    (5, Simulation::send_any_controlwords),
    (5, Simulation::download_anything),
    (3, Simulation::request_any_state),
    (4, Simulation::hold_inputs),
    (3, Simulation::disturb_supply),
    (3, Simulation::cut_cable),
    (2, Simulation::fall_silent),
    (2, Simulation::lose_frames),
    (2, Simulation::push_axis),
    (2, Simulation::cycle_power),
    (1, Simulation::reset_controller),
    (2, Simulation::back_up),
    (1, Simulation::read_event_log),
    (2, Simulation::download_segments),
    (2, Simulation::access_completely),
    (5, Simulation::break_down),
    (3, Simulation::tune_current_loop),
    (1, Simulation::mistake_the_motor),
    (2, Simulation::read_objects),
    (2, Simulation::stand_idle),
];

impl Simulation {
    /// One act.
    pub(crate) fn act(&mut self) -> Verdict {
        let mut chosen = self.random.below(ACTS.iter().map(|(weight, _)| weight).sum());
        for (weight, act) in ACTS {
            if chosen < *weight {
                return act(self);
            }
            chosen -= weight;
        }
        Ok(())
    }

    /// Lets cycles pass until something holds, but not more than these. Returns whether it does.
    pub(crate) fn until(&mut self, cycles: u64, holds: impl Fn(&Self) -> bool) -> Result<bool, String> {
        for _ in 0..cycles {
            if holds(self) {
                return Ok(true);
            }
            self.cycle()?;
        }
        Ok(holds(self))
    }

    /// Cycles of about so many milliseconds.
    pub(crate) fn milliseconds(&mut self, span: u64) -> Verdict {
        self.cycles((span * 20 / self.master.cycle).max(1))
    }

    pub(crate) fn cycles_of(&self, milliseconds: u64) -> u64 {
        (milliseconds * 20 / self.master.cycle).max(1)
    }

    /// A bit of the statusword.
    pub(crate) fn status(&self, bit: u32) -> bool {
        self.objects().statusword >> bit & 1 != 0
    }
}
