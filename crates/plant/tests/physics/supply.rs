//! Source, impedance and bus capacitor.

use board::{Actuators, Millivolts};
use plant::{Faults, Load, MotorState, Plant, PlantConfig, motors};

use crate::controller::Field;

#[test]
fn braking_a_big_inertia_pumps_the_bus_up() {
    let mut plant = Plant::new(PlantConfig {
        load: Load::inertia(40e-4),
        ..PlantConfig::default()
    });
    let mut field = Field::new(&plant, 3.96);
    field.run(&mut plant, 1.0, 7.0);
    assert!((plant.motor().speed - 44.0).abs() < 2.0, "{} rad/s", plant.motor().speed);
    assert!(plant.supply_current() > 0.08 && plant.bus_voltage() < 36.0);
    let mut highest = 0.0_f64;
    for _ in 0..4_000 {
        field.tick(&mut plant, -35.0);
        highest = highest.max(plant.bus_voltage());
        assert!(plant.supply_current() >= 0.0, "nothing flows back into the source");
    }
    assert!(highest > 60.0, "{highest} V");
    let shown = f64::from(plant.sensors().bus_voltage.0) / 1000.0;
    assert!((shown - plant.bus_voltage()).abs() <= 0.011 || plant.bus_voltage() > 81.9);
}

#[test]
fn a_higher_supply_lifts_the_bus_at_once_and_a_lower_one_is_reached_by_consumption() {
    let mut plant = Plant::new(PlantConfig::default());
    let mut shown = |supply: i32, ticks: u32| {
        plant.set_supply(Millivolts(supply));
        for _ in 0..ticks {
            plant.step(&Actuators::default());
        }
        plant.sensors().bus_voltage.0
    };
    assert!((shown(61_000, 20) - 61_000).abs() <= 20, "within a millisecond");
    let sinking = shown(36_000, 1_000);
    assert!(sinking > 45_000 && sinking < 60_000, "{sinking} mV after 50 ms");
    assert!((shown(36_000, 3_000) - 36_000).abs() <= 20);
    assert!(shown(0, 6_000) < 20, "it ends with the last charge");
    assert!((shown(24_000, 20) - 24_000).abs() <= 20);
}

#[test]
fn the_source_gives_what_the_windings_and_the_drive_take() {
    let mut plant = Plant::new(PlantConfig::default());
    let mut field = Field::new(&plant, 3.0);
    field.run(&mut plant, 0.2, 0.0);
    let expected = 0.08 + 3.0 * 3.0 * (0.9 + 0.06) / plant.bus_voltage();
    let current = plant.supply_current();
    assert!((current / expected - 1.0).abs() < 0.05, "{current} and not {expected} A");
    assert!((36.0 - 0.1 * current - plant.bus_voltage()).abs() < 1e-3);
}

#[test]
fn sag_and_surge_come_and_go() {
    let mut plant = Plant::new(PlantConfig::default());
    let mut with = |offset: i32| {
        plant.set_faults(Faults {
            supply_offset: Millivolts(offset),
            ..Faults::default()
        });
        for _ in 0..5_000 {
            plant.step(&Actuators::default());
        }
        plant.sensors().bus_voltage.0
    };
    for (offset, expected) in [(-20_000, 16_000), (0, 36_000), (30_000, 66_000), (0, 36_000)] {
        let shown = with(offset);
        assert!((shown - expected).abs() <= 20, "{shown} and not {expected} mV");
    }
}

#[test]
fn any_supply_and_any_capacitor_keep_the_bus_finite_and_positive() {
    for impedance in [0.0, 1e-3, 0.1, 10.0] {
        for capacitance in [10e-6, 470e-6, 1.0] {
            let mut config = PlantConfig {
                motor: motors::AS1050,
                ..PlantConfig::default()
            };
            (config.source.impedance, config.source.capacitance) = (impedance, capacitance);
            let mut plant = Plant::new(config);
            let mut field = Field::new(&plant, 5.0);
            for acceleration in [100.0, -100.0] {
                for _ in 0..2_000 {
                    field.tick(&mut plant, acceleration);
                    let bus = plant.bus_voltage();
                    assert!((0.0..1e3).contains(&bus), "{bus} V with {impedance} ohm and {capacitance} F");
                }
            }
            plant.set_motor(MotorState::default());
            for _ in 0..100 {
                plant.step(&Actuators::default());
                assert!(plant.bus_voltage().is_finite());
            }
        }
    }
}
