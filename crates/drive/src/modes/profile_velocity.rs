//! Profile velocity mode, PV (manual 2.4.3).

use super::Context;
use crate::motion::Motion;
use crate::profile::{Acceleration, Command, Ramp, Speed};
use crate::statusword::{MODE_BIT_12, TARGET_REACHED, flag};

/// Runs at the target velocity 0x60FF, or stops while bit 8 is set.
///
/// Bit 10 tells that the target velocity is reached, with halt that the motor stands; bit 12 that the motor stands. A limit switch in
/// the way stops the motor with 0x6085; the other direction is free.
#[derive(Clone, Debug)]
pub struct ProfileVelocity {
    /// The direction in which a limit switch has stopped the motor, 1 or -1, until something else is commanded; else 0. The switch may
    /// lie behind already, or be released by hand.
    barred: i64,
}

impl ProfileVelocity {
    /// No limit switch has been met.
    pub const fn new() -> Self {
        Self { barred: 0 }
    }

    /// The mode or the state is left.
    pub const fn leave(&mut self) {
        self.barred = 0;
    }

    /// Moves on by a tick.
    pub fn tick(&mut self, context: &Context, motion: &mut Motion) -> u16 {
        let objects = context.objects;
        let target = Speed::from_pulses_per_second(objects.target_velocity.into());
        let halt = context.controlword.halt();
        let wanted = target.sub_pulses_per_tick().signum();
        let moving = motion.demand_velocity().sub_pulses_per_tick().signum();
        self.look_out(context, wanted, moving);

        let blocked = self.barred != 0 && self.barred == wanted;
        let velocity = if halt || blocked || !context.locked { Speed::ZERO } else { target };
        let mut ramp = Ramp::new(
            objects.profile_acceleration.unsigned_abs(),
            objects.profile_deceleration.unsigned_abs(),
        );
        if self.barred != 0 && self.barred == moving {
            ramp.deceleration = Acceleration::new(objects.quick_stop_deceleration.unsigned_abs());
        }
        motion.run(&Command::RunAt { velocity, ramp });
        let standing = motion.is_standing();
        let reached = match (halt, target) {
            (false, Speed::ZERO) | (true, _) => standing,
            (false, target) => motion.velocity() == target && motion.demand_velocity() == target,
        };
        flag(reached, TARGET_REACHED) | flag(standing, MODE_BIT_12)
    }

    /// Bars the direction in which a limit switch is in the way of what moves or is `wanted`, and frees it again once the motor stands
    /// and is no longer to go there.
    const fn look_out(&mut self, context: &Context, wanted: i64, moving: i64) {
        if context.signals.block(moving) {
            self.barred = moving;
        } else if moving == 0 && context.signals.block(wanted) {
            self.barred = wanted;
        } else if moving != self.barred && (context.controlword.halt() || wanted != self.barred) {
            self.barred = 0;
        }
    }
}
