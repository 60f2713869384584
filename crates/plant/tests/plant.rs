//! The plant from its terminals.

use board::{Actuators, ElectricalAngle, InputLevels, Milliamps, OutputLevels, PowerStage};
use plant::{Plant, PlantConfig, Turns, Wiring};

/// Turns the field from `from` to `to` at 5 turns a second and lets the shaft settle.
fn turn(plant: &mut Plant, from: f64, to: f64) {
    let ticks = ((to - from).abs() / (5.0 * 50e-6)) as u32;
    for tick in 0..=ticks + 100 {
        let turns = from + (to - from) * f64::from(tick.min(ticks)) / f64::from(ticks);
        let angle = ElectricalAngle((turns * 50.0 * 4_294_967_296.0) as i64 as u32);
        plant.step(&Actuators {
            stage: PowerStage::Field {
                angle,
                amplitude: Milliamps(3000),
            },
            outputs: OutputLevels(0),
        });
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
