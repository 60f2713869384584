//! Files that are right, and each kind of mistake with what is said of it.

use proptest::prelude::*;

use plant::Phases;

use super::reader::SHORTEST_TIME_CONSTANT;
use super::*;
use crate::motor::quantity::QUANTITIES;
use crate::motor::{figures, quantity};

const EXAMPLE: &str = include_str!("../../../../../examples/motor.toml");

/// A file that is right, in which one line is another. Line 1 is [motor].
const LINES: [&str; 6] = [
    "[motor]",
    "resistance_ohm = 0.9",
    "inductance_mh = 2.5",
    "peak_current_a = 3.96",
    "holding_torque_nm = 1.26",
    "rotor_inertia_gcm2 = 300",
];

fn with(number: usize, line: &str) -> String {
    let mut lines = LINES;
    lines[number - 1] = line;
    lines.join("\n")
}

fn and(line: &str) -> String {
    format!("{}\n{line}\n", LINES.join("\n"))
}

/// What is said of a file.
fn said(text: &str) -> Vec<String> {
    match parse(text) {
        Ok(_) => vec![],
        Err(Mistakes(mistakes)) => mistakes.iter().map(ToString::to_string).collect(),
    }
}

#[test]
fn the_shipped_example_is_the_motor_it_says() {
    let motor = parse(EXAMPLE).unwrap();
    assert_eq!((motor.name.as_str(), motor.supply), ("my-nema-23", Some(36.0)));
    let (found, named) = (motor.parameters, plant::motors::QSH5718_56);
    assert_eq!((found.phases, motor.estimates.len()), (Phases::Two, 0));
    let pairs = [
        (found.resistance, named.resistance),
        (found.inductance, named.inductance),
        (found.rated_current, named.rated_current),
        (found.back_emf, named.back_emf),
        (found.detent_torque, named.detent_torque),
        (found.inertia, named.inertia),
        (found.friction, named.friction),
        (found.drag, named.drag),
        (motor.load_inertia.unwrap(), 300e-7),
    ];
    for (found, named) in pairs {
        assert!((found / named - 1.0).abs() < 1e-3, "{found}, not {named}");
    }
}

#[test]
fn torque_by_current_is_the_back_emf_with_two_phases_and_one_and_a_half_times_it_with_three() {
    let two = parse(&LINES.join("\n")).unwrap().parameters;
    assert!((two.back_emf - 1.26 / 3.96).abs() < 1e-12);
    let three = parse(&and("phases = 3")).unwrap().parameters;
    assert!((three.back_emf - 1.26 / 3.96 / 1.5).abs() < 1e-12);
    assert!((three.holding_torque(3.96) - 1.26).abs() < 1e-12);
}

#[test]
fn a_current_of_a_data_sheet_has_a_peak_higher_by_the_root_of_two() {
    let motor = parse(&with(4, "rated_current_a = 2.8")).unwrap().parameters;
    assert!((motor.rated_current - 2.8 * 2.0_f64.sqrt()).abs() < 1e-12);
}

#[test]
fn a_measured_voltage_takes_the_place_of_the_holding_torque() {
    let motor = parse(&with(5, "back_emf_v_per_krpm = 33.3")).unwrap().parameters;
    assert!((motor.back_emf - 33.3 / (1000.0 / 60.0 * std::f64::consts::TAU)).abs() < 1e-12);
}

#[test]
fn what_is_not_told_is_estimated_and_said_to_be() {
    let motor = parse(&and("friction_mnm = 20")).unwrap();
    assert_eq!(motor.estimates, ["detent torque", "drag"]);
    assert!((motor.parameters.detent_torque - 0.04 * 1.26).abs() < 1e-12);
    assert!((motor.parameters.drag - 0.001 * 1.26).abs() < 1e-12);
    assert_eq!(motor.parameters.friction, 0.020);
}

#[test]
fn units_say_the_same_in_other_words() {
    let usual = parse(&LINES.join("\n")).unwrap().parameters;
    for (number, line) in [
        (2, "resistance_mohm = 900"),
        (3, "inductance_uh = 2500"),
        (4, "peak_current_ma = 3960"),
        (5, "holding_torque_ncm = 126"),
        (6, "rotor_inertia_kgcm2 = 0.3"),
    ] {
        let other = parse(&with(number, line)).unwrap().parameters;
        let pairs = [
            (usual.resistance, other.resistance),
            (usual.inductance, other.inductance),
            (usual.rated_current, other.rated_current),
            (usual.back_emf, other.back_emf),
            (usual.inertia, other.inertia),
        ];
        assert!(pairs.iter().all(|(a, b)| (a / b - 1.0).abs() < 1e-12), "{line}");
    }
}

#[test]
fn an_unknown_key_is_answered_with_the_nearest_one() {
    assert_eq!(
        said(&and("frction_mnm = 20")),
        ["line 7: `frction_mnm` is unknown in [motor]; did you mean `friction_mnm`?"]
    );
    assert_eq!(
        said(&and("[suply]\nvoltage_v = 24")),
        ["line 7: `suply` is unknown here; did you mean [supply]?"]
    );
    assert_eq!(
        said(&and("colour = 1")),
        [
            "line 7: `colour` is unknown in [motor]; known are resistance_ohm, inductance_mh, rated_current_a, peak_current_a, \
             holding_torque_nm, back_emf_v_s_per_rad, detent_torque_mnm, rotor_inertia_gcm2, friction_mnm, drag_mnms_per_rad, phases"
        ]
    );
}

#[test]
fn a_key_without_its_unit_is_answered_with_the_units() {
    assert_eq!(
        said(&and("friction = 20")),
        [
            "line 7: `friction` is unknown in [motor]; a key carries its unit: `friction_mnm`, `friction_ncm`, `friction_nm`, `friction_kgcm`"
        ]
    );
}

#[test]
fn a_key_at_another_place_is_told_its_own() {
    assert_eq!(
        said(&format!("friction_mnm = 20\n{}", LINES.join("\n"))),
        ["line 1: `friction_mnm` is unknown here; it belongs below a line [motor]"]
    );
    assert_eq!(
        said(&and("[load]\nvoltage_v = 24")),
        ["line 8: `voltage_v` is unknown in [load]; it belongs below a line [supply]"]
    );
}

#[test]
fn a_missing_key_is_told_with_where_to_find_it() {
    assert_eq!(
        said(&with(3, "")),
        ["line 1: `inductance_mh` is missing in [motor]; add a line inductance_mh = ..., the inductance per phase of the data sheet"]
    );
    assert_eq!(
        said(&with(5, "")),
        [
            "line 1: both `holding_torque_nm` and `back_emf_v_s_per_rad` are missing in [motor]; add one: the holding torque of the data \
             sheet, with all phases on, or the peak of a phase's open-circuit voltage by the speed, as measured"
        ]
    );
}

#[test]
fn an_empty_file_misses_all_that_is_needed() {
    assert_eq!(said("").len(), 5);
}

#[test]
fn a_wrong_order_of_magnitude_is_answered_with_the_unit_that_fits() {
    assert_eq!(
        said(&with(3, "inductance_mh = 2500")),
        ["line 3: `inductance_mh` is 2500, and 0.02 to 200 mH are possible; did you mean inductance_uh = 2500?"]
    );
    assert_eq!(
        said(&with(5, "holding_torque_nm = 126")),
        ["line 5: `holding_torque_nm` is 126, and 0.002 to 60 Nm are possible; did you mean holding_torque_ncm = 126?"]
    );
    assert_eq!(
        said(&and("[supply]\nvoltage_v = 24000")),
        ["line 8: `voltage_v` is 24000, and 10 to 80 V are possible; did you mean voltage_mv = 24000?"]
    );
}

#[test]
fn what_no_unit_makes_possible_is_answered_with_where_to_look() {
    assert_eq!(
        said(&with(2, "resistance_ohm = -1")),
        ["line 2: `resistance_ohm` is -1, and 0.01 to 100 ohm are possible; see the resistance per phase of the data sheet"]
    );
    for number in ["nan", "inf", "-inf", "1e400", "0"] {
        let mistakes = said(&with(2, &format!("resistance_ohm = {number}")));
        assert_eq!(mistakes.len(), 1, "{number}: {mistakes:?}");
    }
}

#[test]
fn values_that_do_not_belong_together_are_told() {
    assert_eq!(
        said(&and("detent_torque_nm = 0.7")),
        [
            "line 7: detent_torque_nm is more than half of the holding torque of 1.26 Nm; a few percent are usual: check both numbers and \
             their units"
        ]
    );
    assert_eq!(
        said(&with(3, "inductance_uh = 80")),
        [
            "line 3: inductance by resistance is 0.088889 ms, and the simulation follows 0.1 ms or more; a few ms are usual: check both \
             numbers and their units"
        ]
    );
    assert_eq!(
        said(&with(6, "rotor_inertia_gcm2 = 3")),
        [
            "line 6: this rotor and this torque swing with 2306 Hz, and the simulation follows 2000 Hz at the most; some 200 to 400 Hz are \
             usual: check the rotor's inertia and the torque"
        ]
    );
}

#[test]
fn a_quantity_told_twice_is_one_too_many() {
    assert_eq!(
        said(&and("inductance_uh = 2500")),
        ["line 7: the inductance is given in line 3 already, in another unit; leave one of them out"]
    );
    assert_eq!(
        said(&and("rated_current_a = 2.8")),
        ["line 7: `rated_current_a` and `peak_current_a` tell the same; leave one of them out"]
    );
    assert_eq!(
        said(&and("resistance_ohm = 0.9")),
        ["line 7: duplicate key; each key and each section can be there once"]
    );
}

#[test]
fn a_text_for_a_number_is_told() {
    assert_eq!(
        said(&with(2, "resistance_ohm = \"0.9 ohm\"")),
        [
            "line 2: `resistance_ohm` is a string, and a number is needed; write the number alone, for the unit is in the key: \
             resistance_ohm = 1.5"
        ]
    );
    assert_eq!(
        said(&format!("name = 1\n{}", LINES.join("\n"))),
        ["line 1: `name` is no text; write name = \"...\""]
    );
    assert_eq!(
        said("motor = 1").first().map(String::as_str),
        Some("line 1: `motor` is a section; write [motor] on a line of its own")
    );
}

#[test]
fn a_number_of_phases_that_is_not_simulated_is_told() {
    assert_eq!(
        said(&and("phases = 5")),
        ["line 7: `phases` is neither 2 nor 3; write phases = 2, or leave it out; motors of 5 phases are not simulated"]
    );
}

#[test]
fn a_decimal_comma_is_recognised() {
    let mistakes = said(&with(2, "resistance_ohm = 0,9"));
    assert_eq!(mistakes.len(), 1);
    assert!(
        mistakes[0].starts_with("line 2: ") && mistakes[0].ends_with("; decimals are written with a point, as in 0.9"),
        "{mistakes:?}"
    );
}

#[test]
fn what_is_no_toml_is_told_how_lines_look() {
    let mistakes = said("[motor]\nresistance 0.9\n");
    assert_eq!(mistakes.len(), 1);
    assert!(
        mistakes[0].starts_with("line 2: ") && mistakes[0].contains("`key = number`"),
        "{mistakes:?}"
    );
}

#[test]
fn all_mistakes_are_told_at_once_in_the_order_of_their_lines() {
    let text = "[motor]\nresistance_ohm = 900\ninductance = 2.5\npeak_current_a = 3.96\nholding_torque_nm = 1.26\n";
    let lines: Vec<String> = said(text).iter().map(|mistake| mistake.chars().take(24).collect()).collect();
    assert_eq!(
        lines,
        [
            "line 1: `inductance_mh` ",
            "line 1: `rotor_inertia_g",
            "line 2: `resistance_ohm`",
            "line 3: `inductance` is "
        ]
    );
}

#[test]
fn of_very_many_mistakes_the_number_is_told() {
    let many: String = (0..50).map(|number| format!("colour_{number} = 1\n")).collect();
    let message = parse(&and(&many)).unwrap_err().to_string();
    assert_eq!(message.trim_start().lines().count(), 11);
    assert!(message.ends_with("\n  and 40 more"), "{message}");
}

#[test]
fn files_too_large_and_files_of_other_bytes_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("motor.toml");
    std::fs::write(&file, "#".repeat(SIZE_LIMIT as usize + 1)).unwrap();
    assert!(
        read(&file)
            .unwrap_err()
            .to_string()
            .ends_with("has more than 64 KiB; a motor takes less than one")
    );
    std::fs::write(&file, [0xFF, 0xFE]).unwrap();
    assert!(
        read(&file)
            .unwrap_err()
            .to_string()
            .ends_with("is no text in UTF-8; save it as such")
    );
    let missing = folder.path().join("missing.toml");
    assert!(format!("{:#}", read(&missing).unwrap_err()).contains("cannot open the motor's file"));
    assert!(read(folder.path()).is_err());
}

#[test]
fn a_file_without_a_name_is_called_as_the_file_is() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("spindle.toml");
    std::fs::write(&file, LINES.join("\n")).unwrap();
    assert_eq!(read(&file).unwrap().name, "spindle");
}

/// Lines as somebody might type them, right and wrong.
fn any_line() -> impl Strategy<Value = String> {
    let keys = QUANTITIES.iter().flat_map(quantity::Quantity::keys).collect::<Vec<_>>();
    let key = prop_oneof![proptest::sample::select(keys), "[a-z_]{0,12}"];
    let value = prop_oneof![
        any::<f64>().prop_map(|number| number.to_string()),
        (-10.0..10_000.0_f64).prop_map(|number| number.to_string()),
        any::<i64>().prop_map(|number| number.to_string()),
        ".{0,12}",
    ];
    prop_oneof![
        4 => (key, value).prop_map(|(key, value)| format!("{key} = {value}")),
        1 => proptest::sample::select(vec!["[motor]", "[load]", "[supply]", "name = \"x\"", "phases = 3"]).prop_map(str::to_owned),
    ]
}

proptest! {
    #[test]
    fn any_text_is_a_motor_or_told_its_mistakes(text in ".{0,400}") {
        prop_assert!(parse(&text).map_or_else(|mistakes| !mistakes.0.is_empty(), |_| true));
    }

    #[test]
    fn any_lines_are_a_motor_that_can_be_simulated_or_told_their_mistakes(lines in prop::collection::vec(any_line(), 0..12)) {
        match parse(&lines.join("\n")) {
            Ok(motor) => prop_assert!(figures::electrical_time_constant(&motor.parameters) >= SHORTEST_TIME_CONSTANT),
            Err(Mistakes(mistakes)) => {
                prop_assert!(!mistakes.is_empty());
                prop_assert!(mistakes.iter().all(|mistake| (1..=lines.len().max(1) + 24).contains(&mistake.line)));
            }
        }
    }
}
