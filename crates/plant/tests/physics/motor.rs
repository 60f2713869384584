//! The motor against formulas.

use std::f64::consts::TAU;

use board::Duty;
use plant::{Load, MotorParameters, MotorState, Phases, Plant, motors};

use crate::controller::{self, Field, PERIODS, TICK};

/// A motor without friction, drag and detent, whose windings hold their current whatever happens, as ideal current sources: without resistance and with a
/// huge inductance.
fn undamped(motor: MotorParameters) -> MotorParameters {
    MotorParameters {
        resistance: 0.0,
        inductance: 1e6,
        ..frictionless(motor)
    }
}

fn frictionless(motor: MotorParameters) -> MotorParameters {
    MotorParameters {
        detent_torque: 0.0,
        friction: 0.0,
        drag: 0.0,
        ..motor
    }
}

/// A plant with rated current in the direction of the rotor.
fn held(motor: MotorParameters) -> Plant {
    let mut config = controller::ideal(motor, 24_000);
    config.load = Load::inertia(motor.inertia);
    let mut plant = Plant::new(config);
    plant.set_motor(MotorState {
        currents: [motor.rated_current, 0.0],
        ..MotorState::default()
    });
    plant
}

/// A tick without voltage.
fn coast(plant: &mut Plant) {
    controller::step(plant, [Duty(0); 4]);
}

#[test]
fn under_load_the_shaft_lags_by_the_arc_sine() {
    for motor in motors::ALL {
        let parameters = frictionless(motor.parameters);
        for share in [-0.9, -0.3, 0.1, 0.5, 0.8] {
            let mut plant = Plant::new(controller::ideal(parameters, 36_000));
            let mut field = Field::new(&plant, parameters.rated_current);
            for step in 0..=100 {
                plant.set_load_torque(share * f64::from(step) / 100.0 * parameters.holding_torque(parameters.rated_current));
                field.run(&mut plant, 0.002, 0.0);
            }
            field.run(&mut plant, 2.0, 0.0);
            let lag = -plant.shaft().0 * 360.0;
            let expected = share.asin().to_degrees() / PERIODS;
            assert!(
                (lag - expected).abs() < 1e-3,
                "{} at {share}: {lag} and not {expected} degrees",
                motor.name
            );
        }
    }
}

#[test]
fn a_held_shaft_swings_at_its_natural_frequency() {
    for motor in motors::ALL {
        let parameters = undamped(motor.parameters);
        let mut plant = held(parameters);
        plant.set_motor(MotorState {
            turns: 0.01 / PERIODS,
            ..plant.motor()
        });
        let mut crossings = 0;
        let ticks = 20_000;
        for _ in 0..ticks {
            let before = plant.shaft().0;
            coast(&mut plant);
            crossings += u32::from((before < 0.0) != (plant.shaft().0 < 0.0));
        }
        let frequency = f64::from(crossings) / 2.0 / (f64::from(ticks) * TICK);
        let stiffness = PERIODS * parameters.holding_torque(parameters.rated_current);
        let expected = (stiffness / (2.0 * parameters.inertia)).sqrt() / TAU;
        assert!(
            (frequency / expected - 1.0).abs() < 0.03,
            "{}: {frequency} and not {expected} Hz",
            motor.name
        );
    }
}

#[test]
fn a_sudden_load_of_more_than_72_percent_throws_an_undamped_shaft_out_of_step() {
    for motor in motors::ALL {
        for (share, holds) in [(0.7226, true), (0.7266, false)] {
            let parameters = undamped(motor.parameters);
            let mut plant = held(parameters);
            plant.set_load_torque(share * parameters.holding_torque(parameters.rated_current));
            for _ in 0..20_000 {
                coast(&mut plant);
            }
            assert_eq!(plant.shaft().0.abs() < 0.5 / PERIODS, holds, "{} at {share}", motor.name);
        }
    }
}

#[test]
fn an_overloaded_move_loses_whole_electrical_periods() {
    for motor in motors::ALL {
        let parameters = motor.parameters;
        let mut plant = Plant::new(controller::ideal(parameters, 36_000));
        let mut field = Field::new(&plant, parameters.rated_current);
        let torque = parameters.holding_torque(parameters.rated_current);
        let too_much = 2.0 * torque / (parameters.inertia + plant.config().load.inertia) / TAU;
        field.run(&mut plant, 0.03, too_much);
        field.run(&mut plant, 0.03, -too_much);
        field.run(&mut plant, 1.0, 0.0);
        let lost = field.phase - plant.shaft().0 * PERIODS;
        assert!(lost > 0.5, "{}: {lost} periods lost", motor.name);
        assert!((lost - lost.round()).abs() < 0.01, "{}: {lost} periods lost", motor.name);
    }
}

/// Three phases one by one, with a star that is connected to nothing, in small steps: currents of U, V, W, speed and angle.
fn three_phases(motor: &MotorParameters, inertia: f64, state: [f64; 5], voltages: [f64; 3]) -> [f64; 5] {
    const STEPS: u32 = 20;
    let slope = |[u, v, w, speed, angle]: [f64; 5]| {
        let currents = [u, v, w];
        let phase = |winding: usize| PERIODS * angle - winding as f64 * TAU / 3.0;
        let emf = [0, 1, 2].map(|winding| -motor.back_emf * speed * phase(winding).sin());
        let star = voltages.iter().zip(emf).map(|(voltage, emf)| voltage - emf).sum::<f64>() / 3.0;
        let torque: f64 = (0..3)
            .map(|winding| -motor.back_emf * currents[winding] * phase(winding).sin())
            .sum();
        let torque = torque - motor.detent_torque * (4.0 * PERIODS * angle).sin() - motor.drag * speed;
        let rise = |k: usize| (voltages[k] - star - motor.resistance * currents[k] - emf[k]) / motor.inductance;
        [rise(0), rise(1), rise(2), torque / inertia, speed]
    };
    let step = TICK / f64::from(STEPS);
    (0..STEPS).fold(state, |at, _| {
        let ahead = |slope: [f64; 5], time: f64| std::array::from_fn(|part| at[part] + time * slope[part]);
        let k1 = slope(at);
        let k2 = slope(ahead(k1, step / 2.0));
        let k3 = slope(ahead(k2, step / 2.0));
        let k4 = slope(ahead(k3, step));
        std::array::from_fn(|part| at[part] + step / 6.0 * (k1[part] + 2.0 * k2[part] + 2.0 * k3[part] + k4[part]))
    })
}

#[test]
fn three_phases_one_by_one_do_the_same_as_their_vector() {
    let motor = MotorParameters {
        friction: 0.0,
        ..motors::THREE_PHASE_57
    };
    assert_eq!(motor.phases, Phases::Three);
    let mut config = controller::ideal(motor, 36_000);
    config.load = Load::inertia(motor.inertia);
    let mut plant = Plant::new(config);
    let mut field = Field::new(&plant, motor.rated_current);
    let mut state = [0.0; 5];
    let mut acting = [Duty(1 << 15); 4];
    for _ in 0..4_000 {
        let [u, v, w, _] = acting.map(|duty| f64::from(duty.0) / 65_536.0 * 36.0);
        acting = field.duties(&plant);
        state = three_phases(&motor, 2.0 * motor.inertia, state, [u, v, w]);
        field.tick(&mut plant, 20.0);
        let [iu, iw] = plant.currents();
        let off = (iu - state[0]).abs().max((iw - state[2]).abs());
        assert!(off < 1e-3, "{off} A off at {} turns", plant.shaft().0);
        assert!((plant.shaft().0 - state[4] / TAU).abs() * 360.0 < 1e-3);
    }
    assert!(plant.shaft().0 > 0.35, "it has turned");
}
