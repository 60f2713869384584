//! The plant from its terminals.

use board::{Actuators, ElectricalAngle, InputLevels, Milliamps, Nanos, OutputLevels, PowerStage, TICK};
use plant::{Plant, PlantConfig, Turns, Wiring};

/// Turns the field from `from` to `to` at 5 turns a second and lets the shaft settle.
fn turn(plant: &mut Plant, from: f64, to: f64) {
    let ticks = ((to - from).abs() / (5.0 * 50e-6)) as u32;
    for tick in 0..=ticks + 100 {
        let turns = from + (to - from) * f64::from(tick.min(ticks)) / f64::from(ticks);
        plant.step(&field(turns));
    }
}

fn field(turns: f64) -> Actuators {
    Actuators {
        stage: PowerStage::Field {
            angle: ElectricalAngle((turns * 50.0 * 4_294_967_296.0) as i64 as u32),
            amplitude: Milliamps(3000),
        },
        outputs: OutputLevels(0),
    }
}

#[test]
fn switches_appear_on_the_terminals_they_are_wired_to() {
    let mut plant = Plant::new(PlantConfig::default());
    assert_eq!(plant.sensors().inputs, InputLevels(0));
    turn(&mut plant, 0.0, 1.2);
    assert_eq!(plant.sensors().inputs, InputLevels(0b01_0000), "home on IN5");
    turn(&mut plant, 1.2, 10.5);
    assert_eq!(plant.sensors().inputs, InputLevels(0b00_0100), "positive limit on IN3");
    turn(&mut plant, 10.5, -10.5);
    assert_eq!(plant.sensors().inputs, InputLevels(0b00_1000), "negative limit on IN4");
}

#[test]
fn hard_stops_hold_the_shaft_and_steps_are_lost() {
    let mut plant = Plant::new(PlantConfig::default());
    turn(&mut plant, 0.0, 13.0);
    assert_eq!(plant.shaft(), Turns(12.0));
    turn(&mut plant, 13.0, 0.0);
    assert!((plant.shaft().0 - -1.0).abs() < 1e-6, "one turn was lost: {:?}", plant.shaft());
}

#[test]
fn with_the_stage_off_the_shaft_is_free_and_carries_no_current() {
    let mut plant = Plant::new(PlantConfig::default());
    let sensors = plant.step(&Actuators::default());
    assert_eq!(sensors.phase_currents, [Milliamps(0); 2]);
    plant.place(Turns(3.0));
    plant.step(&Actuators::default());
    assert_eq!(plant.shaft(), Turns(3.0));
}

#[test]
fn inputs_held_by_hand_join_the_switches() {
    let config = PlantConfig {
        wiring: Wiring {
            home: 1,
            ..Wiring::default()
        },
        start: Turns(1.25),
        ..PlantConfig::default()
    };
    let mut plant = Plant::new(config);
    plant.hold_inputs(InputLevels(0b10_0000));
    assert_eq!(plant.sensors().inputs, InputLevels(0b10_0001));
}

#[test]
fn inputs_tell_when_within_the_step_they_changed() {
    let flag = (0.1234, 0.2);
    let mut config = PlantConfig::default();
    config.flags[1] = Some((Turns(flag.0), Turns(flag.1)));
    let mut plant = Plant::new(config);
    let mut seen = Vec::new();
    // There and back, 7 turns a second.
    for tick in 0..=2_000_i32 {
        let turns = f64::from(1_000 - (tick - 1_000).abs()) * 7.0 * 50e-6;
        let start = plant.shaft().0;
        let before = plant.sensors().inputs;
        let sensors = plant.step(&field(turns));
        let end = plant.shaft().0;
        if sensors.inputs != before {
            let age = sensors.level_ages[1].0 as f64 / TICK.0 as f64;
            seen.push((sensors.inputs.is_on(2), end - (end - start) * age));
        } else {
            assert_eq!(sensors.level_ages, [Nanos(0); 6]);
        }
    }
    let expected = [(true, flag.0), (false, flag.1), (true, flag.1), (false, flag.0)];
    assert_eq!(seen.len(), 4, "{seen:?}");
    for (seen, expected) in seen.iter().zip(expected) {
        // A nanosecond at seven turns a second.
        assert!(seen.0 == expected.0 && (seen.1 - expected.1).abs() < 1e-8, "{seen:?} {expected:?}");
    }
}

#[test]
fn a_hand_acts_at_the_start_of_a_step_and_only_where_nothing_else_does() {
    let mut config = PlantConfig::default();
    config.flags[0] = Some((Turns(0.5), Turns(1.0)));
    let mut plant = Plant::new(config);
    let step = |plant: &mut Plant| {
        let sensors = plant.step(&Actuators::default());
        (sensors.inputs.0, sensors.level_ages[0])
    };
    plant.hold_inputs(InputLevels(1));
    assert_eq!(step(&mut plant), (1, TICK));
    plant.place(Turns(0.7));
    plant.hold_inputs(InputLevels(0));
    assert_eq!(step(&mut plant), (1, Nanos(0)), "the flag has taken over");
    plant.place(Turns(0.2));
    assert_eq!(step(&mut plant), (0, TICK));
}
