use plant::motors::{AS1010, AS1050, MOTOR_17HS4401, QSH5718_56, QSH5718_76, THREE_PHASE_57};
use plant::{MotorParameters, PlantConfig};

use super::*;

/// With a tenth of the holding torque as the load.
fn tuned(motor: &MotorParameters, supply: f64) -> Result<Tuning, NotTuned> {
    let setup = Setup::of(motor, supply, motor.rated_current);
    tune(&setup, 0.1 * motor.holding_torque(motor.rated_current), &|_| ())
}

/// The ripple falls to a twentieth at least.
#[track_caller]
fn falls_to_a_twentieth(motor: &MotorParameters, supply: f64) -> Tuning {
    let tuning = tuned(motor, supply).unwrap_or_else(|reason| panic!("{reason}"));
    let Comparison { before, after, .. } = tuning.resonance;
    assert!(before > Ripple(0.2), "{before} is no resonance");
    assert!(tuning.resonance.factor() > 20.0, "from {before} to {after}");
    assert!(tuning.experiments < 200, "{} experiments", tuning.experiments);
    tuning
}

#[test]
fn the_ripple_of_a_17hs4401_falls_to_a_twentieth() {
    falls_to_a_twentieth(&MOTOR_17HS4401, 36.0);
}

#[test]
fn the_ripple_of_a_qsh5718_76_falls_to_a_twentieth() {
    let tuning = falls_to_a_twentieth(&QSH5718_76, 36.0);
    let off = tuning.resonance.conditions.speed / tuning.expected_speed - 1.0;
    assert!(off.abs() < 0.05, "{off} off the expected speed");
}

/// Of low resistance: dead time of the bridge, which grows with the supply's voltage, leaves more behind than with the others.
#[test]
fn the_ripple_of_an_as1050_falls_to_a_twentieth() {
    falls_to_a_twentieth(&AS1050, 24.0);
}

#[test]
fn the_same_setup_has_the_same_values_to_the_last_bit() {
    let tuning = falls_to_a_twentieth(&AS1010, 36.0);
    assert_eq!(tuned(&AS1010, 36.0).as_ref(), Ok(&tuning));
}

#[test]
fn the_comparison_tells_how_much_load_and_speed_matter() {
    let tuning = tuned(&QSH5718_56, 36.0).unwrap();
    let [none, given, threefold] = tuning.loads.as_slice() else {
        panic!("{:?}", tuning.loads)
    };
    assert_eq!(*given, tuning.resonance, "an experiment repeated is the same");
    for other in [none, threefold] {
        assert!(other.factor() > 1.0 && other.factor() < given.factor() / 3.0, "{other:?}");
    }
    let parts = tuning.speeds.iter().map(|at| at.conditions.speed / given.conditions.speed);
    assert!(parts.clone().fold(f64::MAX, f64::min) < 0.51 && parts.fold(0.0, f64::max) > 1.29);
    assert!(tuning.speeds.iter().all(|at| at.after < at.before), "{:?}", tuning.speeds);
}

#[test]
fn a_motor_of_three_phases_cannot_be_tuned() {
    let refused = tuned(&THREE_PHASE_57, 36.0).unwrap_err();
    assert_eq!(refused, NotTuned::ThreePhases);
    assert!(refused.to_string().contains("act on motors of two phases only"));
}

#[test]
fn a_motor_that_turns_evenly_has_nothing_to_be_tuned() {
    let setup = Setup::of(&QSH5718_56, 36.0, 3.96).without_losses();
    let motor = MotorParameters {
        detent_torque: 0.0,
        ..QSH5718_56
    };
    let setup = Setup {
        plant: PlantConfig { motor, ..setup.plant },
        ..setup
    };
    let refused = tune(&setup, 0.1, &|_| ()).unwrap_err();
    assert!(matches!(refused, NotTuned::Smooth(..)), "{refused}");
    assert!(refused.to_string().contains("there is nothing to be reduced"));
}

#[test]
fn a_load_too_heavy_or_too_inert_is_told() {
    let setup = Setup::of(&QSH5718_56, 36.0, 3.96);
    assert_eq!(tune(&setup, 1.2, &|_| ()), Err(NotTuned::Overloaded));
    let refused = tune(&setup.with_load_inertia(1.0), 0.1, &|_| ()).unwrap_err();
    assert!(matches!(refused, NotTuned::TooSlow { .. }), "{refused}");
    assert!(refused.to_string().contains("33334 times the motor's inertia"), "{refused}");
}

#[test]
fn a_drive_that_does_not_get_enabled_is_told() {
    let refused = tuned(&QSH5718_56, 70.0).unwrap_err();
    assert_eq!(refused.to_string(), "the drive reports a fault: Overvoltage, code 3110");
}

#[test]
fn values_that_do_not_halve_the_ripple_are_no_result() {
    let result = |before, after| {
        let conditions = Conditions {
            speed: 1.0,
            load_torque: 0.1,
        };
        worth_while(Comparison { conditions, before, after })
    };
    assert!(result(Ripple(0.44), Ripple(0.22)).is_ok());
    assert!(result(Ripple::OUT_OF_STEP, Ripple(0.3)).is_ok());
    assert!(result(Ripple::OUT_OF_STEP, Ripple::OUT_OF_STEP).is_err());
    let refused = result(Ripple(0.44), Ripple(0.23)).unwrap_err().to_string();
    assert!(refused.contains("to half: the best of them from 44.00 % to 23.00 %"), "{refused}");
}
