//! Profile position mode, PP (manual 2.4.2).

use super::Context;
use crate::motion::Motion;
use crate::profile::{Acceleration, Command, Onward, Position, Progress, Ramp, Speed};
use crate::statusword::{MODE_BIT_12, TARGET_REACHED, flag};

/// Where to go and how, as it stood in the objects when the master set bit 4.
#[derive(Clone, Copy, Debug)]
struct SetPoint {
    target: Position,
    speed: Speed,
    ramp: Ramp,
    /// Whether the set-point before this one is run through without a stop (controlword bit 9).
    on_the_fly: bool,
}

/// A target that is not further away than the whole range of the counter, where relative set-points on top of one another could lead:
/// beyond it, it loses whole turns of the counter.
const fn within_reach(target: Position, position: Position) -> Position {
    let range = Position::from_pulses(i32::MIN).sub_pulses().unsigned_abs() * 2;
    if target.sub_pulses().abs_diff(position.sub_pulses()) <= range {
        return target;
    }
    Position::from_sub_pulses(position.sub_pulses() + target.sub_pulses_from(position))
}

/// The set-point under way and the one after it.
///
/// Bit 12 acknowledges a set-point, until bit 4 is taken back and there is room for another one. Bit 10 tells that the motor stands on
/// the last target, with halt that it stands. A limit switch in the way stops the motor with 0x6085 and drops the set-points; one that
/// leads away from it is then accepted, one that leads into it is dropped again.
#[derive(Clone, Debug)]
pub struct ProfilePosition {
    active: Option<SetPoint>,
    next: Option<SetPoint>,
    acknowledge: bool,
    /// Whether the last set-point was dropped at a limit switch: its target will not be reached.
    blocked: bool,
}

impl ProfilePosition {
    /// No set-point.
    pub const fn new() -> Self {
        Self {
            active: None,
            next: None,
            acknowledge: false,
            blocked: false,
        }
    }

    /// Forgets the set-points, as in every stop but a halt.
    pub const fn drop_set_points(&mut self) {
        self.active = None;
        self.next = None;
        self.acknowledge = false;
        self.blocked = false;
    }

    /// Moves on by a tick.
    pub fn tick(&mut self, context: &Context, motion: &mut Motion) -> u16 {
        if context.start {
            self.take(context, motion);
        }
        if self.leads_into_limit(context, motion) {
            self.active = None;
            self.next = None;
            self.blocked = true;
        }
        let halt = context.controlword.halt();
        match self.active {
            Some(active) if !halt && context.locked => self.travel(active, motion),
            _ => motion.stop(self.stop_deceleration(context)),
        }
        if !context.controlword.start() && self.next.is_none() {
            self.acknowledge = false;
        }
        let reached = motion.is_standing() && (halt || self.active.is_none() && !self.blocked);
        flag(reached, TARGET_REACHED) | flag(self.acknowledge, MODE_BIT_12)
    }

    /// Accepts a new set-point, unless the buffer is full.
    fn take(&mut self, context: &Context, motion: &mut Motion) {
        let controlword = context.controlword;
        if self.next.is_some() && !controlword.change_immediately() {
            return;
        }
        self.wrap(motion);
        let objects = context.objects;
        let base = match (self.next, self.active) {
            (None, None) => Position::from_pulses(motion.demand_position().pulses()),
            (None, Some(last)) | (Some(last), _) => last.target,
        };
        let target = match controlword.relative() {
            true => base.offset_by(objects.target_position),
            false => Position::from_pulses(objects.target_position),
        };
        let set_point = SetPoint {
            target: within_reach(target, motion.demand_position()),
            speed: Speed::from_pulses_per_second(objects.profile_velocity.into()),
            ramp: Ramp::new(
                objects.profile_acceleration.unsigned_abs(),
                objects.profile_deceleration.unsigned_abs(),
            ),
            on_the_fly: controlword.change_on_set_point(),
        };
        if self.active.is_none() || controlword.change_immediately() {
            self.active = Some(set_point);
            self.next = None;
        } else {
            self.next = Some(set_point);
        }
        self.acknowledge = true;
        self.blocked = false;
    }

    /// Brings positions back into the 32-bit range, which relative set-points may have left, so that absolute ones mean what they say.
    fn wrap(&mut self, motion: &mut Motion) {
        let shift = motion.wrap_demand();
        for set_point in [&mut self.active, &mut self.next].into_iter().flatten() {
            set_point.target = Position::from_sub_pulses(set_point.target.sub_pulses() + shift);
        }
    }

    fn leads_into_limit(&self, context: &Context, motion: &Motion) -> bool {
        let travel = match (motion.demand_velocity().sub_pulses_per_tick(), self.active) {
            (0, Some(active)) => active.target.sub_pulses() - motion.demand_position().sub_pulses(),
            (velocity, _) => velocity,
        };
        context.signals.block(travel)
    }

    fn travel(&mut self, active: SetPoint, motion: &mut Motion) {
        let onward = self.next.filter(|next| next.on_the_fly).map(|next| Onward {
            target: next.target,
            deceleration: next.ramp.deceleration,
        });
        let progress = motion.run(&Command::MoveTo {
            target: active.target,
            speed: active.speed,
            ramp: active.ramp,
            onward,
        });
        if progress == Progress::Reached && (self.next.is_some() || motion.is_standing()) {
            self.active = self.next.take();
        }
    }

    fn stop_deceleration(&self, context: &Context) -> Acceleration {
        let objects = context.objects;
        Acceleration::new(
            if self.blocked {
                objects.quick_stop_deceleration
            } else {
                objects.profile_deceleration
            }
            .unsigned_abs(),
        )
    }
}
