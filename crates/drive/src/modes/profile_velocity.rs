//! Profile velocity mode, PV (manual 2.4.3).

use super::Context;
use crate::motion::Motion;
use crate::profile::{Acceleration, Command, Ramp, Speed};
use crate::statusword::{MODE_BIT_12, TARGET_REACHED, flag};

/// Moves on by a tick at the target velocity 0x60FF, or to a stop while bit 8 is set.
///
/// Bit 10 tells that the target velocity is reached, with halt that the motor stands; bit 12 that the motor stands. A limit switch in
/// the way stops the motor with 0x6085; the other direction is free.
pub fn tick(context: &Context, motion: &mut Motion) -> u16 {
    let objects = context.objects;
    let target = Speed::from_pulses_per_second(objects.target_velocity.into());
    let halt = context.controlword.halt();
    let blocked = context.signals.block(target.sub_pulses_per_tick());
    let velocity = if halt || blocked || !context.locked { Speed::ZERO } else { target };
    let mut ramp = Ramp::new(
        objects.profile_acceleration.unsigned_abs(),
        objects.profile_deceleration.unsigned_abs(),
    );
    if context.signals.block(motion.demand_velocity().sub_pulses_per_tick()) {
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
