//! The field turns as the counter counts, and never faster or harder than it was told.

use drive::{CurrentVector, Mode, PowerState};

use super::{Verdict, View, energy, must};
use crate::coverage::Coverage;

/// Sub-pulses of a pulse.
pub const SUB_PULSES: i64 = 400_000_000;
/// Sub-pulses a tick of 1 pulse/s.
pub const SPEED_UNIT: i64 = 20_000;
/// Sub-pulses of the counter's whole range.
const RANGE: i64 = SUB_PULSES << 32;
/// Electrical periods in a turn.
const PERIODS: i64 = 50;
/// Up to this speed the last part of a pulse is crept to, in pulses/s.
const CREEP: i64 = 100;
/// The angle is computed from travel and period cut to 32 bits, whose first may be the only one set: it may be three units too
/// small or two too large, at both ends, and this check rounds too.
const ANGLE_ROUNDING: i32 = 6;
/// The motion filter's divisions may round by this many sub-pulses a tick.
const ROUNDING: i64 = 2;

/// The integration, and an end stop that a slow shaft reaches, may be wrong by this much energy in a tick, in J.
const ENERGY_ROUNDING: f64 = 1e-6;

/// The motion in the tick before.
#[derive(Clone, Debug, Default)]
pub struct Motion {
    position: i64,
    velocity: i64,
    /// The energy of shaft and load without current in the windings, unless somebody has moved them.
    coasting: Option<f64>,
    powered: bool,
    /// The field while the power stage is on.
    field: Option<Field>,
    allowed: Allowed,
}

/// The field since it was last known not to follow from before.
#[derive(Clone, Debug)]
struct Field {
    resolution: u16,
    /// Its angle then.
    origin: u32,
    /// Travel since, in sub-pulses times electrical periods of a turn, within one period.
    travelled: i64,
}

/// What the objects have allowed since the axis last stood with nothing more to do.
#[derive(Clone, Debug, Default)]
struct Allowed {
    speed: i64,
    acceleration: i64,
    /// Targets of cyclic position lead it, whose speed and acceleration are the master's.
    led: bool,
}

/// The energy of a shaft that the drive leaves alone, with what it has given to its load: it may coast, fall into the next detent, or be
/// driven by a weight, but not gain any.
fn coasting_energy(view: &View) -> Option<f64> {
    let plant = view.drive.plant();
    let energy = plant.energy();
    (plant.motor().currents == [0.0; 2]).then_some(energy.kinetic + energy.elastic + energy.load)
}

impl Motion {
    /// Looks at a tick.
    ///
    /// # Errors
    /// What does not hold.
    pub fn tick(&mut self, view: &View, coverage: &mut Coverage) -> Verdict {
        let velocity = view.velocity();
        let position = view.drive.device().drive().position().sub_pulses();
        let coasting = coasting_energy(view);
        self.allowed.take(view);
        match view.drive.device().drive().current_vector() {
            None => {
                // The tick in which a fault is found switches the power stage off after the motion.
                let begins = view.state == PowerState::OperationEnabled && self.powered && !view.signals.offline;
                must(begins || velocity == 0, || format!("{velocity} sub-pulses without current"))?;
                must(begins || !view.is_moving(), || "moving without current".into())?;
                let gained = self.coasting.zip(coasting).map_or(0.0, |(before, after)| after - before);
                must(gained <= ENERGY_ROUNDING + energy::friction(view), || {
                    format!("the shaft gains {gained} J without current")
                })?;
                if self.velocity != 0 && view.signals.offline {
                    coverage.count("motor offline in motion");
                }
                self.field = None;
            }
            Some(CurrentVector { angle, amplitude }) => {
                must((0..=i32::from(view.objects.peak_current)).contains(&amplitude.0), || {
                    format!("{} mA of {}", amplitude.0, view.objects.peak_current)
                })?;
                self.turn(angle.0, velocity, view)?;
                self.check_speed(velocity)?;
            }
        }
        self.powered = view.is_powered();
        self.check_counter(position, velocity, view, coverage)?;
        self.allowed.forget_if_idle(view);
        (self.position, self.velocity, self.coasting) = (position, velocity, coasting);
        Ok(())
    }

    /// Somebody moves the axis by hand.
    pub const fn forget_shaft(&mut self) {
        self.coasting = None;
    }

    /// The field has turned by exactly what was travelled since the power stage was switched on or the resolution changed.
    fn turn(&mut self, angle: u32, velocity: i64, view: &View) -> Verdict {
        let resolution = view.objects.resolution;
        let period = i64::from(resolution) * SUB_PULSES;
        let field = self.field.get_or_insert(Field {
            resolution,
            origin: angle,
            travelled: 0,
        });
        if field.resolution != resolution {
            *field = Field {
                resolution,
                origin: angle,
                travelled: 0,
            };
            return Ok(());
        }
        if self.powered {
            let direction = if view.objects.run_reverse != 0 { -1 } else { 1 };
            field.travelled = (field.travelled + direction * velocity * PERIODS).rem_euclid(period);
        }
        let expected = ((i128::from(field.travelled) << 32) / i128::from(period)) as u32;
        let turned = angle.wrapping_sub(field.origin);
        must((turned.wrapping_sub(expected) as i32).abs() <= ANGLE_ROUNDING, || {
            format!("the field turned by {turned:08X} instead of {expected:08X}")
        })
    }

    fn check_speed(&self, velocity: i64) -> Verdict {
        let Allowed { speed, acceleration, led } = self.allowed;
        if led {
            return Ok(());
        }
        must(velocity.abs() <= speed * SPEED_UNIT + ROUNDING, || {
            format!("{} pulses/s of {speed}", velocity / SPEED_UNIT)
        })?;
        let change = (velocity - self.velocity).abs();
        must(change <= acceleration + ROUNDING, || {
            format!(
                "acceleration of {change} pulses/s^2 of {acceleration}, at {} pulses/s",
                velocity / SPEED_UNIT
            )
        })
    }

    /// The counter counts what is travelled, but for homing and 0x2010.
    fn check_counter(&self, position: i64, velocity: i64, view: &View, coverage: &mut Coverage) -> Verdict {
        let surplus = (position - self.position - velocity).rem_euclid(RANGE);
        if surplus == 0 {
            return Ok(());
        }
        // Without current the axis is taken to be on the nearest whole pulse.
        let settles = !view.is_powered() && (surplus <= SUB_PULSES / 2 || RANGE - surplus <= SUB_PULSES / 2);
        let homed = view.mode == Some(Mode::Homing) && view.objects.status_code >> 4 & 1 != 0;
        let cleared = view.objects.position == 0 && velocity == 0;
        if homed {
            coverage.count("homing attained");
        } else if cleared {
            coverage.count("position cleared");
        }
        let whole = surplus % SUB_PULSES == 0;
        must(settles || whole && homed || cleared, || {
            format!("the counter jumped by {} sub-pulses to {}", surplus, view.objects.position)
        })
    }
}

impl Allowed {
    /// Takes what the objects allow in this tick.
    fn take(&mut self, view: &View) {
        let objects = view.objects;
        let speeds = [
            i64::from(objects.profile_velocity),
            i64::from(objects.target_velocity).abs(),
            objects.homing_speed_fast.into(),
            objects.homing_speed_slow.into(),
            CREEP,
        ];
        let accelerations = [
            i64::from(objects.profile_acceleration),
            objects.profile_deceleration.into(),
            objects.quick_stop_deceleration.into(),
            objects.homing_acceleration.into(),
            1,
        ];
        self.speed = speeds.into_iter().fold(self.speed, i64::max);
        self.acceleration = accelerations.into_iter().fold(self.acceleration, i64::max);
        self.led |= view.mode == Some(Mode::CyclicPosition) && view.state == PowerState::OperationEnabled;
    }

    /// Forgets what was allowed before, once no set-point can remember it.
    fn forget_if_idle(&mut self, view: &View) {
        let halted = view.objects.controlword >> 8 & 1 != 0;
        let may_hold_set_points =
            view.state == PowerState::OperationEnabled && view.mode == Some(Mode::ProfilePosition) && (halted || !view.status(10));
        if !view.is_moving() && !may_hold_set_points {
            *self = Self::default();
        }
    }
}
