//! The machine that a drive is built into: motor, load and supply, by chance.

use board::Millivolts;
use plant::motors::ALL;
use plant::{Coupling, Load, Phases, PlantConfig, Sensing};

use crate::random::Random;

/// Keeps the machine's chance apart from the master's.
const APART: u64 = 0x6D61_6368_696E_6521;

/// The machine of a seed: any named motor, within what a user would put on its shaft and at its supply.
pub fn of(seed: u64) -> PlantConfig {
    let mut random = Random::new(seed ^ APART);
    let motor = ALL[random.below(ALL.len() as u64) as usize].parameters;
    let part = |random: &mut Random, most: i64| random.within(0, most) as f64 / 100.0;
    let inertia = motor.inertia * part(&mut random, 800);
    let torque = motor.holding_torque(motor.rated_current);
    let coupling = coupling(&mut random, 1.0 / motor.inertia + 1.0 / inertia);
    let load = Load {
        inertia,
        friction: torque * part(&mut random, 10),
        drag: motor.drag * part(&mut random, 100),
        torque: torque * random.pick(&[0.0, 0.0, 0.1, -0.1, 0.2]),
        coupling,
    };
    PlantConfig {
        motor,
        load,
        supply: Millivolts(random.pick(&[20_000, 24_000, 36_000, 36_000, 48_000])),
        sensing: Sensing {
            noise: random.pick(&[0.0, 0.5, 1.0]),
            seed: random.bits(),
            ..Sensing::default()
        },
        ..PlantConfig::default()
    }
}

/// None for a rigid coupling, or one that swings at up to 700 Hz: the integration, at 20 kHz, would damp faster swings. `lightness` is the sum
/// of both inertias' reciprocals.
fn coupling(random: &mut Random, lightness: f64) -> Option<Coupling> {
    const SWINGS: [f64; 3] = [5e5, 4e6, 2e7];
    let stiffness = random.pick(&SWINGS) / lightness;
    let damping = random.pick(&[0.0, 1e-5, 1e-4]) * stiffness;
    (random.chance(30) && stiffness > 0.0).then_some(Coupling { stiffness, damping })
}

/// The value of 0x200C:01 that fits a motor.
pub const fn motor_type(phases: Phases) -> u16 {
    match phases {
        Phases::Two => 0,
        Phases::Three => 1,
    }
}
