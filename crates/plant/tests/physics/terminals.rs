//! The plant from its terminals: switches, end stops, inputs and when they change.

use board::{Actuators, InputLevels, Milliamps, Nanos, TICK as CONTROL_TICK};
use plant::{Plant, PlantConfig, Turns, Wiring};

use crate::controller::{Field, TICK, commands};

/// An axis with a current of 3 A in its motor, to be moved to and fro.
struct Axis {
    plant: Plant,
    field: Field,
}

impl Axis {
    fn new(config: PlantConfig) -> Self {
        let plant = Plant::new(config);
        let field = Field::new(&plant, 3.0);
        let mut axis = Self { plant, field };
        axis.field.run(&mut axis.plant, 0.05, 0.0);
        axis
    }

    /// Turns the field by so many turns, half of the way accelerating by 40 turns/s a second, and lets the shaft settle.
    fn turn(&mut self, turns: f64) {
        let half = (turns.abs() / 40.0).sqrt();
        let acceleration = 40.0_f64.copysign(turns);
        self.field.run(&mut self.plant, half, acceleration);
        self.field.run(&mut self.plant, half, -acceleration);
        self.field.speed = 0.0;
        self.field.run(&mut self.plant, 0.1, 0.0);
    }

    fn inputs(&self) -> InputLevels {
        self.plant.sensors().inputs
    }
}

#[test]
fn switches_appear_on_the_terminals_they_are_wired_to() {
    let mut axis = Axis::new(PlantConfig::default());
    assert_eq!(axis.inputs(), InputLevels(0));
    axis.turn(1.2);
    assert_eq!(axis.inputs(), InputLevels(0b01_0000), "home on IN5");
    axis.turn(9.3);
    assert_eq!(axis.inputs(), InputLevels(0b00_0100), "positive limit on IN3");
    axis.turn(-21.0);
    assert_eq!(axis.inputs(), InputLevels(0b00_1000), "negative limit on IN4");
}

#[test]
fn hard_stops_hold_the_shaft_and_steps_are_lost() {
    let mut axis = Axis::new(PlantConfig::default());
    axis.turn(13.0);
    let shaft = axis.plant.shaft().0;
    assert!((11.97..=12.0).contains(&shaft), "the shaft went to {shaft}");
    axis.turn(-13.0);
    let lost = axis.plant.shaft().0 * 50.0;
    assert!(lost < -40.0, "{lost} electrical periods");
    assert!((lost - lost.round()).abs() < 0.03, "whole electrical periods were lost: {lost}");
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
    let mut axis = Axis::new(config);
    let mut seen = Vec::new();
    // Out of the flag and back again, at up to 4 turns a second.
    for acceleration in [40.0, -40.0, -40.0, 40.0] {
        for _ in 0..(0.1 / TICK) as u32 {
            let start = axis.plant.shaft().0;
            let before = axis.inputs();
            let duties = axis.field.duties(&axis.plant);
            let sensors = axis.plant.step(&commands(duties));
            axis.field.advance(acceleration);
            let end = axis.plant.shaft().0;
            if sensors.inputs != before {
                let age = sensors.level_ages[1].0 as f64 / CONTROL_TICK.0 as f64;
                seen.push((sensors.inputs.is_on(2), end - (end - start) * age));
            } else {
                assert_eq!(sensors.level_ages, [Nanos(0); 6]);
            }
        }
    }
    let expected = [(true, flag.0), (false, flag.1), (true, flag.1), (false, flag.0)];
    assert_eq!(seen.len(), 4, "{seen:?}");
    for (seen, expected) in seen.iter().zip(expected) {
        // A nanosecond at four turns a second.
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
    assert_eq!(step(&mut plant), (1, CONTROL_TICK));
    plant.place(Turns(0.7));
    plant.hold_inputs(InputLevels(0));
    assert_eq!(step(&mut plant), (1, Nanos(0)), "the flag has taken over");
    plant.place(Turns(0.2));
    assert_eq!(step(&mut plant), (0, CONTROL_TICK));
}

#[test]
fn inputs_are_what_the_switches_say_wherever_a_hand_moves_the_axis() {
    let mut plant = Plant::new(PlantConfig::default());
    let (mut random, mut position, mut changes, mut last) = (1_u64, 0.0_f64, 0, 0);
    for step in 0..20_000 {
        random = random
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        let way = (random >> 33) as f64 / f64::from(1 << 30) - 1.0;
        position = (position + way * [0.01, 0.3, 8.0][step % 3]).clamp(-12.0, 12.0);
        plant.place(Turns(position));
        let inputs = plant.step(&Actuators::default()).inputs.0;
        let switches = plant.switches();
        let expected = u8::from(switches.positive_limit) << 2 | u8::from(switches.negative_limit) << 3 | u8::from(switches.home) << 4;
        assert_eq!(inputs, expected, "at {position}, step {step}");
        changes += u32::from(inputs != last);
        last = inputs;
    }
    assert!(changes > 1000, "{changes} changes");
}
