//! Bridge and converter.

use board::{Actuators, Duty, Milliamps, Millivolts, OutputLevels, PowerStage, Sensors};
use plant::{Load, MotorParameters, MotorState, Plant, PlantConfig, Sensing, SupplyParameters, motors};

use crate::controller::TICK;

fn legs(duties: [u16; 4]) -> Actuators {
    Actuators {
        stage: PowerStage::Legs(duties.map(Duty)),
        outputs: OutputLevels(0),
    }
}

/// A plant whose rotor does not induce anything.
fn without_magnets(motor: MotorParameters) -> PlantConfig {
    let motor = MotorParameters {
        back_emf: 1e-9,
        detent_torque: 0.0,
        ..motor
    };
    PlantConfig {
        motor,
        ..PlantConfig::default()
    }
}

fn settled(config: PlantConfig, duties: [u16; 4]) -> Plant {
    let mut plant = Plant::new(config);
    for _ in 0..10_000 {
        plant.step(&legs(duties));
    }
    plant
}

#[test]
fn two_transistors_and_both_legs_dead_time_take_from_a_winding() {
    let config = without_magnets(motors::QSH5718_56);
    let middle = 1 << 15;
    for sign in [1, -1] {
        let offset = sign * 3_000;
        let plant = settled(
            config,
            [middle, middle, (middle as i32 + offset) as u16, (middle as i32 - offset) as u16],
        );
        let bus = plant.bus_voltage();
        let lost = 2.0 * 400e-9 / 50e-6 * bus * f64::from(sign);
        let expected = (f64::from(2 * offset) / 65_536.0 * bus - lost) / (0.9 + 0.06);
        let [a, b] = plant.currents();
        assert!(a == 0.0 && (b / expected - 1.0).abs() < 2e-4, "{b} and not {expected} A");
    }
}

#[test]
fn near_zero_the_ripple_takes_the_edge_off_the_dead_time() {
    let config = without_magnets(motors::QSH5718_56);
    let current = |difference: u16| settled(config, [(1 << 15) + difference, (1 << 15) - difference, 0, 0]).currents()[0];
    // With 36 V, both legs' dead time would eat 0.58 V, 524 steps of each leg, whole.
    let small = current(200);
    assert!(small > 0.005 && small < 0.05, "{small} A");
    let mut last = 0.0;
    for difference in 1..60 {
        let next = current(20 * difference);
        assert!(next > last, "{next} A after {last} A");
        last = next;
    }
}

#[test]
fn a_leg_that_does_not_switch_loses_nothing_to_dead_time() {
    let mut config = without_magnets(motors::QSH5718_56);
    config.motor.resistance = 9.0;
    let plant = settled(config, [u16::MAX, 0, 0, 0]);
    let expected = plant.bus_voltage() / 9.06;
    assert!((plant.currents()[0] / expected - 1.0).abs() < 1e-4);
}

#[test]
fn a_leg_of_a_star_has_one_transistor_in_its_way() {
    let config = without_magnets(motors::THREE_PHASE_57);
    let duties = [(1 << 15) + 4_000, (1 << 15) - 2_000, (1 << 15) - 2_000, 0];
    let plant = settled(config, duties);
    let bus = plant.bus_voltage();
    let dead = 400e-9 / 50e-6 * bus;
    // Legs lose against their current: U one way, V and W the other; the star takes a third of the sum.
    let expected = (4_000.0 / 65_536.0 * bus - 4.0 / 3.0 * dead) / (0.65 + 0.03);
    let [u, w] = plant.currents();
    assert!(
        (u / expected - 1.0).abs() < 2e-4 && (w / expected + 0.5).abs() < 2e-4,
        "{u} and not {expected} A"
    );
}

#[test]
fn with_the_transistors_off_currents_go_back_to_the_bus_and_end() {
    for motor in [motors::QSH5718_56, motors::THREE_PHASE_57] {
        let mut plant = Plant::new(without_magnets(motor));
        plant.set_motor(MotorState {
            currents: [4.0, -2.5],
            ..MotorState::default()
        });
        let before = plant.energy();
        let drive_takes = plant.supply_current();
        let longest = motor.inductance * 4.0 / (plant.bus_voltage() / 2.0);
        let mut ticks = 0;
        while plant.currents() != [0.0; 2] {
            plant.step(&Actuators::default());
            assert!(plant.supply_current() <= drive_takes + 1e-9);
            ticks += 1;
            assert!(f64::from(ticks) * TICK < longest + TICK, "{:?}", plant.currents());
        }
        let after = plant.energy();
        let returned = after.capacitor - before.capacitor;
        assert!(
            returned > 0.8 * before.magnetic && returned < before.magnetic,
            "{returned} J of {}",
            before.magnetic
        );
        for _ in 0..100 {
            plant.step(&Actuators::default());
            assert_eq!(plant.currents(), [0.0; 2]);
        }
        assert_eq!(plant.energy().magnetic, 0.0);
    }
}

#[test]
fn with_the_transistors_off_a_shaft_spun_fast_charges_the_bus_to_its_back_emf() {
    for (motor, lines) in [(motors::QSH5718_56, 1.0), (motors::THREE_PHASE_57, 3_f64.sqrt())] {
        for back_emf in [30.0, 60.0] {
            let mut plant = Plant::new(PlantConfig {
                motor: MotorParameters {
                    detent_torque: 0.0,
                    friction: 0.0,
                    drag: 0.0,
                    ..motor
                },
                load: Load::inertia(1.0),
                source: SupplyParameters {
                    consumption: 0.005,
                    ..SupplyParameters::default()
                },
                travel: plant::Travel {
                    stops: (plant::Turns(-1e3), plant::Turns(1e3)),
                    ..plant::Travel::default()
                },
                ..PlantConfig::default()
            });
            plant.set_motor(MotorState {
                speed: back_emf / lines / motor.back_emf,
                ..MotorState::default()
            });
            for _ in 0..4_000 {
                plant.step(&Actuators::default());
            }
            let expected = (back_emf - 1.6_f64).max(36.0);
            let bus = plant.bus_voltage();
            // The inductance delays what comes out of the rectifier.
            assert!(bus > 0.93 * expected && bus <= expected, "{bus} and not {expected} V");
            if back_emf < 36.0 {
                assert_eq!(plant.currents(), [0.0; 2]);
            }
        }
    }
}

#[test]
fn the_converter_shows_steps_and_ends() {
    let mut plant = Plant::new(without_magnets(motors::QSH5718_56));
    assert_eq!(plant.sensors().bus_voltage, Millivolts(36_000));
    let mut shown = |ampere: f64| {
        plant.set_motor(MotorState {
            currents: [ampere, 0.0],
            ..MotorState::default()
        });
        let Sensors { phase_currents, .. } = plant.step(&legs([1 << 15; 4]));
        (phase_currents[0], plant.currents()[0])
    };
    for step in 0..100 {
        let (Milliamps(shown), real) = shown(f64::from(step) * 0.0137 - 0.7);
        let (steps, off) = (f64::from(shown) / 6.25, f64::from(shown) - real * 1000.0);
        assert!(off.abs() <= 3.625, "{shown} mA for {real} A");
        assert!((steps - steps.round()).abs() * 6.25 < 0.51, "{shown} mA is between steps");
    }
    assert_eq!(shown(30.0).0, Milliamps(12_794));
    assert_eq!(shown(-30.0).0, Milliamps(-12_800));
}

#[test]
fn noise_is_as_strong_as_it_says_and_the_same_for_the_same_seed() {
    let sensing = Sensing {
        noise: 3.0,
        seed: 7,
        ..Sensing::default()
    };
    let samples = |sensing: Sensing| -> Vec<i32> {
        let mut plant = Plant::new(PlantConfig {
            sensing,
            ..PlantConfig::default()
        });
        (0..4_000).map(|_| plant.step(&Actuators::default()).phase_currents[0].0).collect()
    };
    let first = samples(sensing);
    assert_eq!(first, samples(sensing));
    assert_ne!(first, samples(Sensing { seed: 8, ..sensing }));
    let deviation = (first.iter().map(|&x| f64::from(x).powi(2)).sum::<f64>() / first.len() as f64).sqrt() / 6.25;
    assert!((deviation - 3.0).abs() < 0.15, "{deviation} steps");
}
