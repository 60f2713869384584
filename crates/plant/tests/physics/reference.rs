//! The motor against an independent solver: reference/generate.py makes the tables.

use plant::{Load, MotorState, Plant, motors};

use crate::controller;

struct Run {
    motor: motors::NamedMotor,
    supply: i32,
    /// Turns a second at the start, of field and shaft.
    first: f64,
    acceleration: f64,
    ticks: u32,
    friction: bool,
}

/// Ticks from a line to the next.
const EVERY: u32 = 40;

fn run(line: &str) -> Run {
    let parts: Vec<&str> = line.split(',').collect();
    Run {
        motor: motors::ALL.into_iter().find(|motor| motor.name == parts[0]).expect("a named motor"),
        supply: parts[1].parse::<i32>().unwrap() * 1000,
        first: parts[2].parse().unwrap(),
        acceleration: parts[3].parse().unwrap(),
        ticks: parts[4].parse().unwrap(),
        friction: parts[5] == "1",
    }
}

#[test]
fn every_named_motor_moves_as_an_independent_solver_says() {
    let mut lines = include_str!("reference/tables.csv").lines();
    let mut runs = 0;
    let (mut most_degrees, mut most_ampere) = (0.0_f64, 0.0_f64);
    while let Some(line) = lines.next() {
        let run = run(line);
        let mut motor = run.motor.parameters;
        motor.friction *= f64::from(u8::from(run.friction));
        let mut config = controller::ideal(motor, run.supply);
        config.load = Load::inertia(motor.inertia);
        let mut plant = Plant::new(config);
        plant.set_motor(MotorState {
            currents: [motor.rated_current, 0.0],
            speed: run.first * std::f64::consts::TAU,
            ..MotorState::default()
        });
        for tick in 0..run.ticks {
            // What is commanded now acts in the next period.
            let time = f64::from(tick + 1) * controller::TICK;
            let phase = controller::PERIODS * (run.first * time + run.acceleration * time * time / 2.0);
            let speed = run.first + run.acceleration * time;
            let duties = controller::duties(&plant, motor.rated_current, phase, speed);
            controller::step(&mut plant, duties);
            if (tick + 1) % EVERY == 0 {
                let row: Vec<f64> = lines.next().unwrap().split(',').map(|part| part.parse().unwrap()).collect();
                let [a, b] = controller::vector(&plant);
                let ampere = (a - row[0]).abs().max((b - row[1]).abs());
                let degrees = (plant.shaft().0 * 360.0 - row[2]).abs();
                assert!(
                    degrees < 1e-3 && ampere < 1e-3,
                    "{line}: {degrees} degrees, {ampere} A off after {} ticks",
                    tick + 1
                );
                (most_degrees, most_ampere) = (most_degrees.max(degrees), most_ampere.max(ampere));
            }
        }
        runs += 1;
    }
    assert_eq!(runs, 4 * motors::ALL.len());
    println!("at most {most_degrees:.1e} degrees and {most_ampere:.1e} A off");
}
