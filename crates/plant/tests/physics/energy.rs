//! The energy account.

use plant::{Coupling, EnergyAccount, Load, Plant, PlantConfig, motors};

use crate::controller::Field;

fn unaccounted(energy: &EnergyAccount) -> f64 {
    energy.source + energy.hand - energy.stored() - energy.spent()
}

#[test]
fn the_balance_closes_over_acceleration_braking_and_standstill() {
    for motor in motors::ALL {
        let couplings = [
            None,
            Some(Coupling {
                stiffness: 50.0,
                damping: 0.01,
            }),
        ];
        for coupling in couplings {
            let load = Load {
                inertia: 4.0 * motor.parameters.inertia,
                friction: motor.parameters.friction,
                drag: motor.parameters.drag,
                torque: 0.1 * motor.parameters.holding_torque(motor.parameters.rated_current),
                coupling,
            };
            let mut config = PlantConfig {
                motor: motor.parameters,
                load,
                ..PlantConfig::default()
            };
            config.travel.stops = (plant::Turns(-1e3), plant::Turns(1e3));
            let mut plant = Plant::new(config);
            let mut field = Field::new(&plant, motor.parameters.rated_current);
            let mut most = 0.0_f64;
            for acceleration in [20.0, 0.0, -20.0, 0.0] {
                for _ in 0..20 {
                    field.run(&mut plant, 0.01, acceleration);
                    most = most.max(unaccounted(&plant.energy()).abs());
                }
            }
            let energy = plant.energy();
            println!("{} {coupling:?}: {most:.1e} J of {:.2} J", motor.name, energy.source);
            assert!(energy.source > 1.0 && plant.shaft().0 > 0.5);
            assert!(most < 1e-3 * energy.source, "{}: {most} J unaccounted for, {energy:?}", motor.name);
        }
    }
}
