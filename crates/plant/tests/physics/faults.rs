//! What breaks, on a running plant.

use board::Actuators;
use plant::{Faults, MotorParameters, Phases, Plant, PlantConfig, Turns, motors};

use crate::controller::{self, Field, PERIODS};

/// A plant with its field in motion.
fn running(motor: MotorParameters) -> (Plant, Field) {
    let mut plant = Plant::new(PlantConfig {
        motor,
        ..PlantConfig::default()
    });
    let mut field = Field::new(&plant, 0.75 * motor.rated_current);
    field.run(&mut plant, 0.1, 20.0);
    (plant, field)
}

#[test]
fn an_open_winding_carries_no_current_until_it_is_mended() {
    for motor in [motors::QSH5718_56, motors::THREE_PHASE_57] {
        for winding in 0..2 {
            let (mut plant, mut field) = running(motor);
            let mut faults = Faults::default();
            faults.open[winding] = true;
            plant.set_faults(faults);
            let mut other = 0.0_f64;
            for _ in 0..4_000 {
                field.tick(&mut plant, 0.0);
                let currents = plant.currents();
                assert!(currents[winding].abs() < 1e-12, "{currents:?}");
                other = other.max(currents[1 - winding].abs());
            }
            assert!(other > 0.4 * motor.rated_current, "{other} A in the other one");
            plant.set_faults(Faults::default());
            let mut mended = 0.0_f64;
            for _ in 0..4_000 {
                field.tick(&mut plant, 0.0);
                mended = mended.max(plant.currents()[winding].abs());
            }
            assert!(mended > 0.5 * motor.rated_current);
        }
    }
}

#[test]
fn with_both_windings_open_nothing_flows() {
    for motor in [motors::QSH5718_56, motors::THREE_PHASE_57] {
        let (mut plant, mut field) = running(motor);
        plant.set_faults(Faults {
            open: [true; 2],
            ..Faults::default()
        });
        for _ in 0..1_000 {
            field.tick(&mut plant, 0.0);
            assert_eq!(controller::vector(&plant), [0.0; 2]);
        }
        plant.step(&Actuators::default());
        assert_eq!(controller::vector(&plant), [0.0; 2]);
    }
}

#[test]
fn a_shorted_winding_lets_the_current_out_of_hand_within_two_ticks() {
    for motor in motors::ALL {
        for winding in 0..2 {
            let (mut plant, _) = running(motor.parameters);
            let mut field = Field::new(&plant, 0.75 * motor.parameters.rated_current);
            // A commanded vector in the direction of the winding, or of the two together.
            field.phase = plant.shaft().0.round() * PERIODS
                + match (motor.parameters.phases, winding) {
                    (Phases::Two, 0) => 0.0,
                    (Phases::Two, _) => 0.25,
                    (Phases::Three, 0) => -1.0 / 12.0,
                    (Phases::Three, _) => -0.25,
                };
            field.run(&mut plant, 0.5, 0.0);
            let before = plant.currents()[winding];
            let mut faults = Faults::default();
            faults.shorted[winding] = true;
            plant.set_faults(faults);
            // Two ticks with the voltage that a current loop may give a whole winding, and one in which it waits for its PWM period.
            let duties = controller::duties(&plant, 2.0 * field.amplitude, field.phase, 0.0);
            for _ in 0..3 {
                controller::step(&mut plant, duties);
            }
            let after = plant.currents()[winding];
            assert!(after > 12.0, "{}: from {before} to {after} A", motor.name);
            for _ in 0..2_000 {
                field.tick(&mut plant, 0.0);
                assert!(
                    plant.currents().iter().all(|current| current.abs() < 500.0),
                    "{:?}",
                    plant.currents()
                );
                assert!(plant.bus_voltage() >= 0.0);
            }
            plant.set_faults(Faults::default());
            field.run(&mut plant, 0.5, 0.0);
            assert!(
                (plant.currents()[winding] / before - 1.0).abs() < 0.05,
                "mended: {:?}",
                plant.currents()
            );
        }
    }
}

#[test]
fn a_stuck_rotor_stands_and_its_currents_flow() {
    let (mut plant, mut field) = running(motors::QSH5718_56);
    plant.set_faults(Faults {
        stuck_rotor: true,
        ..Faults::default()
    });
    let shaft = plant.shaft();
    let energy = plant.energy();
    let mut most = 0.0_f64;
    for _ in 0..2_000 {
        field.tick(&mut plant, 0.0);
        assert_eq!((plant.shaft(), plant.motor().speed), (shaft, 0.0));
        most = most.max(plant.currents()[0]);
    }
    assert!(most > 2.5, "{most} A");
    assert_eq!(plant.energy().drag, energy.drag);
    plant.set_faults(Faults::default());
    field.run(&mut plant, 0.1, -20.0);
    field.run(&mut plant, 0.5, 0.0);
    let lost = field.phase - plant.shaft().0 * PERIODS;
    assert!(lost > 0.5 && (lost - lost.round()).abs() < 0.01, "{lost} periods lost");
    assert_ne!(plant.shaft(), Turns(0.0));
}
