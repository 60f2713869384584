//! What drives do: for each mode and each kind of surprise, a run of the firmware core with everything on.
//!
//! | module | holds |
//! |---|---|
//! | `acts` | what master and world do in them |

mod acts;

use usr2556e::master::process_data::mode;
use usr2556e::master::process_data::statusword::{ACKNOWLEDGE, HOMING_ERROR, TARGET_REACHED};

use crate::firmware_core::Core;
use acts::{
    all_inputs, all_inputs_ready, axis, changing_modes, cyclic_1_ms, cyclic_500_us, enabled, faults, homing, parameters, power_up,
    profile_position, profile_velocity, start_once, three_phase_axis, three_phases,
};

/// A run of the firmware core.
#[derive(Clone, Copy, Debug)]
pub struct Scenario {
    /// Its name.
    pub name: &'static str,
    /// How many instructions its worst tick may take.
    pub limit: u64,
    /// How many ticks it lasts.
    pub ticks: u32,
    /// What happens before it and does not count.
    pub begin: fn() -> Core,
    /// What master and world do before each tick, counted from 0.
    pub before_tick: fn(&mut Core, u32),
    /// Whether the drive has done what the scenario is there for.
    pub succeeded: fn(&Core) -> bool,
}

impl Scenario {
    /// What comes after the begin.
    pub fn follow(&self, core: &mut Core) {
        for tick in 0..self.ticks {
            (self.before_tick)(core, tick);
            core.step();
        }
    }

    /// Runs it; with `counted`, its ticks go through [`counted_tick`](crate::firmware_core::counted_tick).
    ///
    /// # Panics
    /// The drive does not do what it should.
    pub fn run(&self, counted: bool) {
        let mut core = (self.begin)();
        core.counted = counted;
        self.follow(&mut core);
        let objects = &core.objects;
        assert!(
            (self.succeeded)(&core),
            "{}: ends with statusword {:04X}, position {}",
            self.name,
            objects.statusword,
            objects.position
        );
    }
}

/// What a tick may take.
const BUDGET: u64 = 2000;
/// What a tick may take in which more comes together than at a machine: six inputs without a filter that all change within it and are all
/// probes, or a change of mode in flight on top of all else.
const EXTREME: u64 = 2200;

/// All of them.
pub const SCENARIOS: &[Scenario] = &[
    Scenario {
        name: "power-up and enabling",
        limit: BUDGET,
        ticks: 3000,
        begin: || Core::new(axis()),
        before_tick: power_up,
        succeeded: is_known,
    },
    Scenario {
        name: "three phases, power-up and PP",
        limit: EXTREME,
        ticks: 6000,
        begin: || Core::new(three_phase_axis()),
        before_tick: three_phases,
        succeeded: |core| is_known(core) && has_latched(core),
    },
    Scenario {
        name: "standing, parameters changing",
        limit: BUDGET,
        ticks: 1200,
        begin: || enabled(mode::PROFILE_POSITION),
        before_tick: parameters,
        succeeded: |core| core.objects.resolution == 51_200 && core.objects.run_reverse == 1,
    },
    Scenario {
        name: "PP, set-points on the fly",
        limit: BUDGET,
        ticks: 4800,
        begin: || enabled(mode::PROFILE_POSITION),
        before_tick: profile_position,
        succeeded: has_latched,
    },
    Scenario {
        name: "PV, reversals and halts",
        limit: BUDGET,
        ticks: 5000,
        begin: || enabled(mode::PROFILE_VELOCITY),
        before_tick: profile_velocity,
        succeeded: has_latched,
    },
    Scenario {
        name: "CSP, 1 ms",
        limit: BUDGET,
        ticks: 4000,
        begin: || enabled(mode::CYCLIC_POSITION),
        before_tick: cyclic_1_ms,
        succeeded: follows,
    },
    Scenario {
        name: "CSP, 500 us, late and missing",
        limit: BUDGET,
        ticks: 3000,
        begin: || enabled(mode::CYCLIC_POSITION),
        before_tick: cyclic_500_us,
        succeeded: follows,
    },
    Scenario {
        name: "homing, turned at a limit",
        limit: BUDGET,
        ticks: 11_000,
        begin: || homing(24),
        before_tick: start_once,
        succeeded: is_homed,
    },
    Scenario {
        name: "homing, switch inside",
        limit: BUDGET,
        ticks: 10_000,
        begin: || homing(30),
        before_tick: start_once,
        succeeded: is_homed,
    },
    Scenario {
        name: "modes changing in flight",
        limit: EXTREME,
        ticks: 3600,
        begin: || enabled(mode::PROFILE_VELOCITY),
        before_tick: changing_modes,
        succeeded: |core| core.is_ready() && is_in_step(core),
    },
    Scenario {
        name: "faults and stops",
        limit: BUDGET,
        ticks: 8000,
        begin: || enabled(mode::PROFILE_VELOCITY),
        before_tick: faults,
        succeeded: Core::is_ready,
    },
    Scenario {
        name: "all inputs at once, in PP",
        limit: EXTREME,
        ticks: 3000,
        begin: all_inputs_ready,
        before_tick: all_inputs,
        succeeded: has_latched,
    },
];

/// The drive has identified its motor and is enabled.
fn is_known(core: &Core) -> bool {
    core.is_ready() && core.drive.winding().is_some()
}

/// All four edges of the probes, by a shaft that has followed.
fn has_latched(core: &Core) -> bool {
    let objects = &core.objects;
    let counts = [
        objects.probe_1_positive_count,
        objects.probe_1_negative_count,
        objects.probe_2_positive_count,
        objects.probe_2_negative_count,
    ];
    counts.iter().all(|count| *count > 0) && is_in_step(core)
}

/// The shaft is where the drive's counter says, within half an electrical period.
fn is_in_step(core: &Core) -> bool {
    const HALF_A_PERIOD: f64 = 0.5 / board::ELECTRICAL_PERIODS_PER_TURN as f64;
    let counter = f64::from(core.objects.position) / f64::from(core.objects.resolution);
    (core.plant.shaft().0 - counter).abs() < HALF_A_PERIOD
}

/// CSP leads, and the drive is not further behind than filter and interpolation explain.
fn follows(core: &Core) -> bool {
    const MOST_LAG: u32 = 8000;
    let objects = &core.objects;
    let lag = objects.position.abs_diff(objects.target_position);
    objects.statusword & ACKNOWLEDGE != 0 && lag < MOST_LAG && has_latched(core)
}

/// Homing is attained and the axis stands.
fn is_homed(core: &Core) -> bool {
    core.objects.statusword & (ACKNOWLEDGE | TARGET_REACHED | HOMING_ERROR) == ACKNOWLEDGE | TARGET_REACHED
}
