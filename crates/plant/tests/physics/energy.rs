//! The energy account.

use board::Actuators;
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

#[test]
fn an_end_stop_takes_what_a_falling_weight_brings_and_nothing_from_one_that_rests_on_it() {
    let coupling = Coupling {
        stiffness: 200.0,
        damping: 0.01,
    };
    for coupling in [None, Some(coupling)] {
        let mut config = PlantConfig {
            load: Load {
                torque: 0.06,
                coupling,
                ..Load::inertia(300e-7)
            },
            ..PlantConfig::default()
        };
        config.motor.friction = 0.0;
        config.travel.stops = (plant::Turns(-1.0), plant::Turns(1.0));
        let mut plant = Plant::new(config);
        let mut run = |seconds: f64| {
            for _ in 0..(seconds * 20_000.0) as u32 {
                plant.step(&Actuators::default());
            }
            (plant.energy(), plant.axis())
        };
        let (fallen, _) = run(1.0);
        let (rested, axis) = run(10.0);
        assert!((axis.0 + 1.0).abs() < 1e-6, "{axis:?}");
        assert!(unaccounted(&fallen).abs() < 1e-3 * fallen.load.abs(), "{coupling:?}: {fallen:?}");
        let since = unaccounted(&rested) - unaccounted(&fallen);
        assert!(since.abs() < 1e-5, "{coupling:?}: {since} J in 10 s of rest");
    }
}
