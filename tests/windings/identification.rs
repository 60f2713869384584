//! Identification of motors that nobody has seen before.

use board::Nanos;
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

/// A drive with the motor of the plant, before it is enabled.
fn known_motor(seed: u64) -> Bench {
    Bench::new(motors::QSH5718_56, seed)
}

fn gains(bench: &Bench) -> (u16, u16) {
    (bench.objects.current_loop_kp, bench.objects.current_loop_ki)
}

/// Ticks from enabling to the end of the shaft lock, which lets a motion begin.
fn lock_ticks(bench: &mut Bench) -> usize {
    bench.objects.target_velocity = 10_000;
    bench.enable(3);
    bench.until(|bench| bench.drive.current_vector().is_some()).expect("powered");
    let ticks = bench.until(|bench| bench.drive.is_moving()).expect("moving");
    bench.objects.target_velocity = 0;
    bench.until(|bench| !bench.drive.is_moving()).expect("standing");
    ticks
}

// manual: 2.2.11/automatic 2.2.11/gains
#[test]
fn the_first_enabling_identifies_the_next_does_not_and_0x200b_01_asks_for_it_anew() {
    let mut bench = known_motor(1);
    let first = lock_ticks(&mut bench);
    let identified = gains(&bench);
    assert!((1_990..=2_110).contains(&first), "{first}");
    assert!(
        identified.0.abs_diff(2_500) < 75 && identified.1.abs_diff(192) < 4,
        "{identified:?}"
    );

    // What a process image writes there does not count while the drive sets the gains.
    (bench.objects.current_loop_kp, bench.objects.current_loop_ki) = (100, 1);
    bench.tick();
    assert_eq!(gains(&bench), identified);

    // The motor is another one, but nobody tells the drive.
    bench.motor.inductance = 3.2e-3;
    bench.objects.soft_lock_time = 100;
    assert!(lock_ticks(&mut bench) < 210);
    assert_eq!(gains(&bench), identified);

    bench.objects.auto_pi = 0;
    bench.tick();
    (bench.objects.current_loop_kp, bench.objects.current_loop_ki) = (1_500, 300);
    assert!(lock_ticks(&mut bench) < 210);
    assert_eq!(gains(&bench), (1_500, 300), "the user's");

    // Not before the motor is enabled the next time.
    bench.objects.auto_pi = 1;
    bench.ticks(4_000);
    assert_eq!(gains(&bench), (1_500, 300));
    assert!(lock_ticks(&mut bench) > 1_000, "whatever 0x200A says");
    assert!(gains(&bench).0.abs_diff(3_200) < 96, "{:?}", gains(&bench));
}

#[test]
fn with_0x200b_01_at_0_nothing_is_identified() {
    let mut bench = known_motor(2);
    bench.objects.auto_pi = 0;
    assert!(lock_ticks(&mut bench) < 2_010);
    assert_eq!(gains(&bench), (1_000, 200));
    assert_eq!((bench.drive.winding(), bench.objects.resistance_auto), (None, 1_000));
}

#[test]
fn a_longer_shaft_lock_goes_on_after_the_identification() {
    let mut bench = known_motor(3);
    bench.objects.soft_lock_time = 5_000;
    let ticks = lock_ticks(&mut bench);
    assert!((9_990..=10_010).contains(&ticks), "{ticks}");
    assert!(bench.drive.winding().is_some_and(|winding| winding.settled));
}

#[test]
fn an_identification_that_is_cut_short_begins_anew_at_the_next_enabling() {
    for cut_at in [1, 30, 100, 700, 1_300, 1_700] {
        let mut bench = known_motor(4);
        bench.enable(1);
        bench.until(|bench| bench.drive.current_vector().is_some());
        bench.ticks(cut_at);
        bench.objects.controlword = 0;
        bench.ticks(100);
        assert_eq!((bench.drive.current_vector(), bench.drive.winding()), (None, None));
        let ticks = lock_ticks(&mut bench);
        assert!((1_990..=2_110).contains(&ticks), "{ticks}");
        assert!(gains(&bench).0.abs_diff(2_500) < 75);
    }
}

#[test]
fn a_motor_that_is_turned_meanwhile_is_no_fault_and_is_identified_once_it_is_left_alone() {
    let mut bench = known_motor(5);
    bench.load_inertia = 1.0;
    bench.state.speed = 6.0;
    bench.enable(1);
    bench.ticks(3_000);
    assert_eq!(bench.objects.error_code, 0);
    assert!(bench.drive.winding().is_none_or(|winding| !winding.settled));
    bench.objects.controlword = 0;
    bench.tick();
    (bench.load_inertia, bench.state.speed) = (30e-6, 0.0);
    bench.enable(1);
    bench.lock();
    assert!(bench.drive.winding().is_some_and(|winding| winding.settled));
    assert!(gains(&bench).0.abs_diff(2_500) < 75 && gains(&bench).1.abs_diff(192) < 4);
}

#[test]
fn a_field_that_turns_ends_the_identification_until_the_next_enabling() {
    let mut bench = known_motor(6);
    bench.enable(8);
    bench.until(|bench| bench.drive.current_vector().is_some());
    for cycle in 1..200 {
        bench.objects.target_position = 10 * cycle;
        bench.drive.synchronize(&bench.objects, Some(Nanos(1_000_000)));
        bench.ticks(20);
        assert_eq!(bench.objects.error_code, 0, "cycle {cycle}");
    }
    assert_eq!((bench.drive.winding(), bench.drive.is_identifying()), (None, false));
    assert!(bench.drive.is_shaft_locked());
    bench.objects.controlword = 0;
    bench.ticks(2_000);
    bench.enable(1);
    bench.lock();
    assert!(bench.drive.winding().is_some_and(|winding| winding.settled));
}

#[test]
fn no_current_exceeds_the_operating_current_by_more_than_a_tenth_while_the_motor_is_identified_and_taken_over() {
    for (seed, named) in motors::ALL.iter().enumerate() {
        let mut bench = Bench::new(named.parameters, seed as u64);
        bench.enable(1);
        let most = f64::from(bench.objects.peak_current) / 1000.0 * 1.1;
        for tick in 0..4_000 {
            bench.tick();
            let [a, b] = bench.state.currents;
            assert!(a.hypot(b) < most, "{} in tick {tick}: {a} {b}", named.name);
        }
        let [a, b] = bench.state.currents;
        let held = f64::from(bench.objects.peak_current) / 1000.0;
        assert!((a.hypot(b) / held - 1.0).abs() < 0.02, "{}: {a} {b} of {held}", named.name);
    }
}
