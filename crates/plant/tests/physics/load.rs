//! What hangs on the shaft.

use std::f64::consts::TAU;

use board::{Actuators, ElectricalAngle};
use plant::{Coupling, Faults, Load, MotorParameters, MotorState, Plant, PlantConfig, Turns, motors};

use crate::controller::{self, Field, PERIODS, TICK};

/// A motor whose rotor is nothing but an inertia.
const INERT: MotorParameters = MotorParameters {
    detent_torque: 0.0,
    friction: 0.0,
    drag: 0.0,
    back_emf: 1e-6,
    ..motors::QSH5718_56
};

/// How often a second the coupling twists to and fro after the load's torque has set in.
fn swings(plant: &mut Plant, torque: f64, stiffness: f64, share: f64) -> f64 {
    plant.set_load_torque(torque);
    let mean = torque * share / stiffness / TAU;
    let twist = |plant: &Plant| plant.shaft().0 - plant.axis().0 - mean;
    let mut crossings = 0;
    for _ in 0..20_000 {
        let before = twist(plant);
        plant.step(&Actuators::default());
        crossings += u32::from((before < 0.0) != (twist(plant) < 0.0));
    }
    f64::from(crossings) / 2.0
}

#[test]
fn an_elastic_coupling_swings_at_the_frequency_of_its_two_masses() {
    for stiffness in [20.0, 300.0, 3_000.0] {
        let inertia = 500e-7;
        let coupling = Some(Coupling { stiffness, damping: 0.0 });
        let mut config = controller::ideal(INERT, 36_000);
        config.load = Load {
            coupling,
            ..Load::inertia(inertia)
        };
        let free = swings(&mut Plant::new(config), 0.1, stiffness, INERT.inertia / (INERT.inertia + inertia));
        let expected = (stiffness * (1.0 / INERT.inertia + 1.0 / inertia)).sqrt() / TAU;
        assert!((free / expected - 1.0).abs() < 0.01, "{free} and not {expected} Hz");
        let mut plant = Plant::new(config);
        plant.set_faults(Faults {
            stuck_rotor: true,
            ..Faults::default()
        });
        let held = swings(&mut plant, 0.1, stiffness, 1.0);
        let expected = (stiffness / inertia).sqrt() / TAU;
        assert!((held / expected - 1.0).abs() < 0.01, "{held} and not {expected} Hz");
        assert_eq!(plant.shaft(), Turns(0.0));
    }
}

#[test]
fn a_coupling_too_stiff_for_a_tick_is_rigid() {
    let mut config = controller::ideal(INERT, 36_000);
    let coupling = |stiffness, damping| Some(Coupling { stiffness, damping });
    for coupling in [coupling(1e6, 0.0), coupling(100.0, 10.0)] {
        config.load = Load {
            torque: 0.1,
            coupling,
            ..Load::inertia(500e-7)
        };
        let mut plant = Plant::new(config);
        for _ in 0..100 {
            plant.step(&Actuators::default());
        }
        assert_eq!(plant.shaft(), plant.axis());
        let expected = -0.1 / 800e-7 * 100.0 * TICK;
        assert!((plant.motor().speed / expected - 1.0).abs() < 1e-9);
    }
}

#[test]
fn friction_holds_a_resting_shaft_against_less_torque_and_slows_a_turning_one_to_rest() {
    for friction_of_load in [0.0, 0.1] {
        let mut config = controller::ideal(INERT, 36_000);
        config.motor.friction = 0.1 - friction_of_load;
        config.load.friction = friction_of_load;
        let mut plant = Plant::new(config);
        plant.set_load_torque(0.0999);
        for _ in 0..20_000 {
            plant.step(&Actuators::default());
        }
        assert!(plant.shaft().0.abs() < 1e-12, "held: {:?}", plant.shaft());
        plant.set_load_torque(0.0);
        plant.set_motor(MotorState {
            speed: 100.0,
            ..MotorState::default()
        });
        let inertia = config.motor.inertia + config.load.inertia;
        let ticks = (100.0 * inertia / 0.1 / TICK) as u32;
        for _ in 0..ticks + 2 {
            plant.step(&Actuators::default());
        }
        assert_eq!(plant.motor().speed, 0.0);
        let way = 100.0 * 100.0 * inertia / (2.0 * 0.1);
        assert!((plant.shaft().0 * TAU / way - 1.0).abs() < 1e-3);
    }
}

#[test]
fn an_end_stop_holds_the_axis_and_costs_whole_electrical_periods() {
    let coupling = Coupling {
        stiffness: 100.0,
        damping: 0.01,
    };
    for coupling in [None, Some(coupling)] {
        let mut config = PlantConfig::default();
        config.load.coupling = coupling;
        config.load.friction = 0.02;
        config.start = Turns(11.0);
        let mut plant = Plant::new(config);
        let mut field = Field::new(&plant, 3.0);
        for (seconds, acceleration) in [(0.2, 10.0), (0.6, 0.0), (0.2, -10.0), (0.2, -10.0), (0.6, 0.0), (0.2, 10.0)] {
            for _ in 0..(seconds / TICK) as u32 {
                field.tick(&mut plant, acceleration);
                assert!(plant.axis().0 <= 12.0, "the axis never passes the stop: {:?}", plant.axis());
                assert!(plant.motor().speed.abs() < 100.0, "{} rad/s", plant.motor().speed);
            }
        }
        field.run(&mut plant, 0.3, 0.0);
        let lost = field.phase - plant.shaft().0 * PERIODS;
        assert!(lost > 20.0, "{lost} periods lost");
        assert!((lost - lost.round()).abs() < 0.01, "{lost} periods lost");
    }
}

#[test]
fn the_lag_is_told_against_a_commanded_angle() {
    let mut plant = Plant::new(PlantConfig::default());
    plant.place(Turns(-3.0 - 0.1 / 50.0));
    assert!((plant.lag(ElectricalAngle(0)) - 0.1).abs() < 1e-6);
    assert!((plant.lag(ElectricalAngle(1 << 31)) - -0.4).abs() < 1e-6);
}
