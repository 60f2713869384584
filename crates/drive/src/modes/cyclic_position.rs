//! Cyclic synchronous position mode, CSP (manual 2.4.4).

use board::{Nanos, TICK};

use super::Context;
use crate::motion::Motion;
use crate::profile::{Acceleration, Interpolator, Position};
use crate::statusword::{MODE_BIT_12, TARGET_REACHED, flag};

/// The cycle that is assumed until one is known.
const FIRST_CYCLE: Nanos = Nanos(1_000_000);

/// The longest time that is taken for a cycle; longer ones leave the cycle as it was.
const LONGEST_CYCLE: Nanos = Nanos(1_000_000_000);

/// Follows the targets that the master sends in every cycle.
///
/// On entry the set-point is where the axis is. Bits 10 and 12 tell that the drive follows; they are 0 while it stops for a halt or a
/// limit switch, and while a target that leads further into a limit switch is ignored.
#[derive(Clone, Debug)]
pub struct CyclicPosition {
    /// The interpolation while the drive follows.
    interpolator: Option<Interpolator>,
    /// The target of the last synchronisation, until a tick takes it.
    latched: Option<i32>,
    cycle: Nanos,
    ticks_since_synchronisation: u32,
    /// Whether the last target was ignored.
    held: bool,
    /// Whether the stop under way is that of a limit switch, which may lie behind already.
    stopping_at_limit: bool,
    /// The direction in which a limit switch has stopped the axis, 1 or -1, until a target leads the other way; else 0. So the axis does
    /// not jump to where the master has gone on to when the switch is released.
    barred: i64,
}

impl CyclicPosition {
    /// Not following yet.
    pub const fn new() -> Self {
        Self {
            interpolator: None,
            latched: None,
            cycle: FIRST_CYCLE,
            ticks_since_synchronisation: 0,
            held: false,
            stopping_at_limit: false,
            barred: 0,
        }
    }

    /// The master's cycle: the nominal one, or else the time between the last two synchronisations.
    pub const fn cycle(&self) -> Nanos {
        self.cycle
    }

    /// Latches the target of the cycle that begins.
    pub const fn synchronize(&mut self, target: i32, cycle: Option<Nanos>) {
        self.latched = Some(target);
        let measured = Nanos(self.ticks_since_synchronisation as u64 * TICK.0);
        self.ticks_since_synchronisation = 0;
        match cycle {
            Some(nominal) if nominal.0 <= LONGEST_CYCLE.0 => self.cycle = nominal,
            None if measured.0 > 0 && measured.0 <= LONGEST_CYCLE.0 => self.cycle = measured,
            _ => {}
        }
    }

    /// Counts the time between synchronisations.
    pub const fn count_tick(&mut self) {
        self.ticks_since_synchronisation = self.ticks_since_synchronisation.saturating_add(1);
    }

    /// The mode or the state is left: the next target followed is one that is sent after the return.
    pub const fn leave(&mut self) {
        self.interpolator = None;
        self.latched = None;
        self.held = false;
        self.stopping_at_limit = false;
        self.barred = 0;
    }

    /// Moves on by a tick.
    pub fn tick(&mut self, context: &Context, motion: &mut Motion) -> u16 {
        let latched = self.latched.take();
        let velocity = motion.demand_velocity().sub_pulses_per_tick();
        if context.signals.block(velocity) {
            self.stopping_at_limit = true;
            self.barred = velocity.signum();
        }
        if self.stopping_at_limit || context.controlword.halt() {
            self.interpolator = None;
        }
        match &mut self.interpolator {
            Some(interpolator) => {
                if let Some(target) = latched {
                    let distance = Position::from_pulses(target).sub_pulses_from(interpolator.position());
                    if context.signals.block(distance) {
                        self.barred = distance.signum();
                    }
                    self.held = distance != 0 && distance.signum() == self.barred;
                    if !self.held {
                        interpolator.synchronise(target, self.cycle);
                        if distance != 0 {
                            self.barred = 0;
                        }
                    }
                }
                motion.follow(interpolator);
            }
            None => self.stop(context, motion),
        }
        flag(self.interpolator.is_some() && !self.held, TARGET_REACHED | MODE_BIT_12)
    }

    /// Stops, and follows from the next tick on if the motor stands and nothing keeps it.
    fn stop(&mut self, context: &Context, motion: &mut Motion) {
        let objects = context.objects;
        let deceleration = match self.stopping_at_limit {
            true => objects.quick_stop_deceleration,
            false => objects.profile_deceleration,
        };
        motion.stop(Acceleration::new(deceleration.unsigned_abs()));
        if motion.demand_velocity().sub_pulses_per_tick() == 0 && motion.demand_position().is_whole_pulse() {
            self.stopping_at_limit = false;
            if !context.controlword.halt() {
                self.interpolator = Some(Interpolator::at(motion.demand_position()));
            }
        }
    }
}
