//! Identification of motors that nobody has seen before.

use plant::motors;

use crate::bench::{Bench, Random};

/// A named motor, wound anew and with another load, at another supply.
fn unknown_motor(seed: u64) -> Bench {
    let mut random = Random(seed);
    let mut motor = motors::ALL[random.between(0.0, motors::ALL.len() as f64) as usize].parameters;
    // More turns of thinner wire, or fewer of thicker.
    let turns = random.between(0.8, 1.3);
    motor.resistance *= turns * turns * random.between(0.8, 1.25);
    motor.inductance *= turns * turns * random.between(0.8, 1.25);
    motor.back_emf *= turns;
    motor.rated_current /= turns;
    motor.inertia *= random.between(0.7, 1.5);
    motor.friction *= random.between(0.5, 2.0);
    let mut bench = Bench::new(motor, random.between(0.0, 1e15) as u64);
    bench.objects.peak_current = (random.between(0.6, 1.1) * 1000.0 * motor.rated_current).min(6000.0) as u16;
    bench.supply = random.between(20.0, 50.0);
    bench.load_inertia = motor.inertia * random.between(0.0, 2.0);
    bench.offsets = [random.between(-0.2, 0.2), random.between(-0.2, 0.2)];
    bench.dead = random.between(0.0, 0.02);
    bench.state.turns = random.between(0.0, 0.02);
    bench
}

/// What is below 95 of 100 values, and the greatest.
fn percentiles(mut values: Vec<f64>) -> (f64, f64) {
    values.sort_by(f64::total_cmp);
    (values[values.len() * 95 / 100], values[values.len() - 1])
}

// manual: 2.2.11/automatic 2.2.12/identified 2.2.12/type
#[test]
fn three_hundred_motors_are_identified_within_105_ms_to_1_percent_in_resistance_and_3_in_inductance() {
    let (mut resistances, mut inductances, mut times) = (vec![], vec![], vec![]);
    for seed in 0..300 {
        let mut bench = unknown_motor(seed);
        bench.enable(1);
        let powered = bench.until(|bench| bench.drive.current_vector().is_some());
        let ticks = bench.until(|bench| bench.drive.winding().is_some());
        assert!(
            powered.is_some() && bench.objects.error_code == 0,
            "seed {seed}: {:04X}",
            bench.objects.error_code
        );
        let ticks = ticks.unwrap_or_else(|| panic!("seed {seed}: never identified"));
        let winding = bench.drive.winding().unwrap();
        let (motor, objects) = (&bench.motor, &bench.objects);
        let resistance = f64::from(objects.resistance_auto) / 1000.0 / motor.resistance - 1.0;
        let inductance = f64::from(winding.inductance) / motor.inductance - 1.0;
        println!(
            "seed {seed}: R {:+.2} % L {:+.2} % {} ms {}",
            100.0 * resistance,
            100.0 * inductance,
            ticks as f64 / 20.0,
            winding.settled
        );
        resistances.push(resistance.abs());
        inductances.push(inductance.abs());
        times.push(ticks as f64 / 20.0);
        let millihenry = (winding.inductance * 1e3).round().min(10.0) as u16;
        assert_eq!(objects.inductance_auto, millihenry, "seed {seed}");
        assert!(
            (f32::from(objects.current_loop_kp) - winding.inductance * 1e6).abs() <= 0.6,
            "seed {seed}"
        );
        assert!(
            (f32::from(objects.current_loop_ki) - winding.resistance * 200.0).abs() <= 0.6,
            "seed {seed}"
        );
    }
    let (resistances, inductances, times) = (percentiles(resistances), percentiles(inductances), percentiles(times));
    println!("95th percentile, greatest: R {resistances:?}, L {inductances:?}, {times:?} ms");
    assert!(resistances.0 < 0.01 && inductances.0 < 0.03 && times.1 <= 105.0);
}
