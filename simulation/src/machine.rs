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
    let stiff = random.chance(70);
    let load = Load {
        inertia,
        friction: torque * part(&mut random, 10),
        drag: motor.drag * part(&mut random, 100),
        torque: torque * random.pick(&[0.0, 0.0, 0.1, -0.1, 0.2]),
        coupling: (!stiff).then_some(Coupling {
            stiffness: random.pick(&[20.0, 200.0, 1000.0]),
            damping: random.pick(&[0.0, 1e-3, 1e-2]),
        }),
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

/// The value of 0x200C:01 that fits a motor.
pub const fn motor_type(phases: Phases) -> u16 {
    match phases {
        Phases::Two => 0,
        Phases::Three => 1,
    }
}
