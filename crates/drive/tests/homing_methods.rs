//! The interpreter of the homing methods on an axis with two limit switches and a home switch in mid travel: ramps, limits, errors.

use drive::homing::{Action, Homing, HomingError, Outcome, Parameters, Signals};
use drive::profile::{Acceleration, Command, Generator, Position, Ramp, Speed};
use proptest::prelude::*;

const ALL: Signals = Signals {
    negative_limit: true,
    positive_limit: true,
    home: true,
};

const PARAMETERS: Parameters = Parameters {
    fast: 10_000,
    slow: 2000,
    acceleration: 100_000,
    stop_deceleration: 500_000,
};

/// The switches along the axis, in pulses: each is on from its first to its last position.
#[derive(Clone, Copy, Debug)]
struct Axis {
    /// The negative limit is on up to here.
    negative: i32,
    home: (i32, i32),
    /// The positive limit is on from here.
    positive: i32,
}

const AXIS: Axis = Axis {
    negative: -3000,
    home: (0, 500),
    positive: 3000,
};

/// An edge that homing may decide by.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Place {
    NegativeLimit,
    PositiveLimit,
    HomeLeft,
    HomeRight,
}

impl Axis {
    fn signals(&self, position: Position) -> Signals {
        let at = |pulses| Position::from_pulses(pulses);
        Signals {
            negative_limit: position <= at(self.negative),
            positive_limit: position >= at(self.positive),
            home: position >= at(self.home.0) && position <= at(self.home.1),
        }
    }

    fn edge(&self, place: Place) -> i32 {
        match place {
            Place::NegativeLimit => self.negative,
            Place::PositiveLimit => self.positive,
            Place::HomeLeft => self.home.0,
            Place::HomeRight => self.home.1,
        }
    }
}

/// What a run did.
#[derive(Debug)]
struct Run {
    /// The velocities commanded, in pulses/s, without repetition.
    legs: Vec<i64>,
    /// The edge's position and the velocity at which it was passed.
    attained: Option<(Position, Speed)>,
    last: Outcome,
    generator: Generator,
    ticks: u32,
}

/// Runs a method of variant 0 until it is finished or failed and the axis stands.
fn run(axis: &Axis, method: i8, generator: Generator, parameters: &Parameters) -> Run {
    run_in(0, axis, method, generator, parameters)
}

fn run_in(variant: u8, axis: &Axis, method: i8, mut generator: Generator, parameters: &Parameters) -> Run {
    let signals = axis.signals(generator.position());
    let mut homing = Homing::start(method, variant, ALL, signals).expect("a method of the drive");
    let (mut legs, mut attained) = (Vec::new(), None);
    for ticks in 0..2_000_000 {
        let position = generator.position();
        let Action { command, outcome } = homing.step(axis.signals(position), position, generator.is_standing(), parameters);
        if let Command::RunAt { velocity, ramp } = command {
            assert_eq!(ramp, Ramp::new(parameters.acceleration, parameters.acceleration));
            let velocity = i64::from(velocity.pulses_per_second());
            if legs.last() != Some(&velocity) {
                legs.push(velocity);
            }
        }
        match outcome {
            Outcome::Attained { edge } => {
                assert!(attained.is_none(), "attained twice");
                attained = Some((edge, generator.velocity()));
            }
            Outcome::Running => assert!(attained.is_none(), "running again"),
            Outcome::Stopping => assert!(attained.is_some()),
            Outcome::Finished | Outcome::Failed(_) if generator.is_standing() => {
                return Run {
                    legs,
                    attained,
                    last: outcome,
                    generator,
                    ticks,
                };
            }
            Outcome::Finished => panic!("finished while moving"),
            Outcome::Failed(_) => {}
        }
        if attained.is_some() && outcome != Outcome::Finished && method != 35 {
            assert_eq!(
                command,
                Command::Stop {
                    deceleration: Acceleration::new(parameters.stop_deceleration)
                }
            );
        }
        generator.step(&command);
    }
    panic!("endless search: method {method}, {generator:?}");
}

fn standing(pulses: i32) -> Generator {
    Generator::at(Position::from_pulses(pulses), Speed::ZERO)
}

/// Runs from standstill and checks legs, edge, and the direction in which it was passed.
fn expect(method: i8, start: i32, legs: &[i64], place: Place) {
    let run = run(&AXIS, method, standing(start), &PARAMETERS);
    let context = format!("method {method} from {start}: {run:?}");
    assert_eq!(run.last, Outcome::Finished, "{context}");
    assert_eq!(run.legs, legs, "{context}");
    let (edge, velocity) = run.attained.expect("an edge");
    let last = *legs.last().expect("a leg");
    let passed = edge.sub_pulses_from(Position::from_pulses(AXIS.edge(place))) * last.signum();
    // Signals follow the position at the start of a tick, so the edge is behind by less than the tick before travelled; a falling
    // edge comes after the switch's last position.
    assert!((0..=velocity.sub_pulses_per_tick().abs()).contains(&passed), "{context}");
    assert_eq!(velocity.sub_pulses_per_tick().signum(), last.signum(), "{context}");
    assert!(i64::from(velocity.pulses_per_second().abs()) <= last.abs(), "{context}");
    let overrun = run.generator.position().sub_pulses_from(edge) * last.signum();
    let most = last.pow(2) as f64 / 2.0 / f64::from(PARAMETERS.stop_deceleration) + 1.0;
    assert!((0.0..=most * 4e8).contains(&(overrun as f64)), "{context}");
    assert!(run.generator.position().is_whole_pulse());
}

const H: i64 = PARAMETERS.fast as i64;
const L: i64 = PARAMETERS.slow as i64;

/// Starts outside HOME to its left, next to it and at the edge of the limit switch included.
const LEFT: [i32; 4] = [-2999, -1500, -100, -1];
/// Starts outside HOME to its right, likewise.
const RIGHT: [i32; 4] = [501, 600, 1500, 2999];
/// Starts on HOME, its first and last positions included.
const ON_HOME: [i32; 5] = [0, 1, 250, 499, 500];
/// Starts on the negative limit switch.
const ON_NEGATIVE: [i32; 3] = [-3200, -3001, -3000];
/// Starts on the positive limit switch.
const ON_POSITIVE: [i32; 3] = [3000, 3001, 3200];

#[test]
fn method_17_finds_the_negative_limit_fast_from_outside_and_slowly_from_on_it() {
    for start in LEFT.into_iter().chain(ON_HOME).chain(RIGHT).chain(ON_POSITIVE) {
        expect(17, start, &[-H], Place::NegativeLimit);
    }
    for start in ON_NEGATIVE {
        expect(17, start, &[L], Place::NegativeLimit);
    }
}

#[test]
fn method_18_finds_the_positive_limit_fast_from_outside_and_slowly_from_on_it() {
    for start in RIGHT.into_iter().chain(ON_HOME).chain(LEFT).chain(ON_NEGATIVE) {
        expect(18, start, &[H], Place::PositiveLimit);
    }
    for start in ON_POSITIVE {
        expect(18, start, &[-L], Place::PositiveLimit);
    }
}

#[test]
fn method_19_leaves_home_slowly_to_the_left() {
    for start in LEFT.into_iter().chain(ON_NEGATIVE) {
        expect(19, start, &[H, -L], Place::HomeLeft);
    }
    for start in ON_HOME {
        expect(19, start, &[-L], Place::HomeLeft);
    }
}

#[test]
fn method_20_enters_home_slowly_from_the_left() {
    for start in LEFT.into_iter().chain(ON_NEGATIVE) {
        expect(20, start, &[L], Place::HomeLeft);
    }
    for start in ON_HOME {
        expect(20, start, &[-H, L], Place::HomeLeft);
    }
}

#[test]
fn method_21_leaves_home_slowly_to_the_right() {
    for start in RIGHT.into_iter().chain(ON_POSITIVE) {
        expect(21, start, &[-H, L], Place::HomeRight);
    }
    for start in ON_HOME {
        expect(21, start, &[L], Place::HomeRight);
    }
}

#[test]
fn from_the_wrong_side_it_turns_round_once_at_the_limit() {
    for start in RIGHT.into_iter().chain([2000]) {
        expect(19, start, &[H, -L], Place::HomeLeft);
        expect(20, start, &[L, -H, L], Place::HomeLeft);
    }
    for start in LEFT {
        expect(21, start, &[-H, L], Place::HomeRight);
    }
}

#[test]
fn started_on_the_limit_in_its_way_it_turns_round_without_moving_into_it() {
    for start in ON_POSITIVE {
        expect(19, start, &[-L], Place::HomeLeft);
        expect(20, start, &[-H, L], Place::HomeLeft);
    }
    for start in ON_NEGATIVE {
        expect(21, start, &[L], Place::HomeRight);
    }
}

#[test]
fn method_35_takes_the_position_where_it_stands() {
    let run = run(&AXIS, 35, standing(-1234), &PARAMETERS);
    assert_eq!(run.attained, Some((Position::from_pulses(-1234), Speed::ZERO)));
    assert_eq!((run.last, run.legs, run.generator), (Outcome::Finished, vec![], standing(-1234)));
    assert!(run.ticks <= 1);
}

#[test]
fn a_home_switch_narrower_than_the_overrun_is_still_left_by_its_proper_edge() {
    let narrow = Axis { home: (0, 5), ..AXIS };
    for (method, start, edge, direction) in [(19, -1000, 0, -1), (20, 3, 0, 1), (21, 1000, 5, 1)] {
        let run = run(&narrow, method, standing(start), &PARAMETERS);
        let (position, velocity) = run.attained.expect("an edge");
        let passed = position.sub_pulses_from(Position::from_pulses(edge)) * direction;
        assert!(
            (0..=velocity.sub_pulses_per_tick().abs()).contains(&passed),
            "method {method}: {run:?}"
        );
        assert_eq!(velocity.sub_pulses_per_tick().signum(), direction);
    }
}

#[test]
fn an_axis_under_way_is_stopped_before_the_search() {
    let moving = Generator::at(Position::from_pulses(-500), Speed::from_pulses_per_second(9000));
    let run = run(&AXIS, 21, moving, &PARAMETERS);
    // It comes to rest left of HOME, 405 pulses on, and looks for the negative limit first.
    assert_eq!(run.legs, [-H, L]);
    assert_eq!(run.attained.expect("an edge").0.pulses(), AXIS.home.1);
}

/// Both variants of the methods that look for the home switch.
fn home_methods() -> impl Iterator<Item = (u8, i8)> {
    (0..=1).flat_map(|variant| (19..=30).map(move |method| (variant, method)))
}

#[test]
fn a_second_limit_without_the_edge_is_an_error() {
    let homeless = Axis { home: (1, 0), ..AXIS };
    for (variant, method) in home_methods() {
        let run = run_in(variant, &homeless, method, standing(0), &PARAMETERS);
        assert_eq!((run.last, run.attained), (Outcome::Failed(HomingError::LimitInTheWay), None));
        let away = if matches!(method, 19 | 20 | 23..=26) { 1 } else { -1 };
        let directions: Vec<i64> = run.legs.iter().map(|leg| leg.signum()).collect();
        assert_eq!(directions, [away, -away], "variant {variant}, method {method}");
    }
}

#[test]
fn a_home_switch_that_never_goes_off_is_an_error() {
    let stuck = Axis {
        home: (i32::MIN, i32::MAX),
        ..AXIS
    };
    for (variant, method) in home_methods() {
        let run = run_in(variant, &stuck, method, standing(0), &PARAMETERS);
        assert_eq!((run.last, run.attained), (Outcome::Failed(HomingError::LimitInTheWay), None));
        assert_eq!(run.legs.len(), 1, "variant {variant}, method {method}");
    }
}

#[test]
fn a_limit_that_fails_to_go_off_before_the_other_one_is_an_error() {
    let stuck = Axis { negative: 4000, ..AXIS };
    for (variant, method) in [(0, 17), (1, 17), (1, 18)] {
        let run = run_in(variant, &stuck, method, standing(0), &PARAMETERS);
        assert_eq!((run.last, run.attained), (Outcome::Failed(HomingError::BothLimitsActive), None));
    }
}

#[test]
fn what_cannot_be_run_is_refused_at_the_start() {
    let both = Signals { home: false, ..ALL };
    let off = Signals::default();
    for method in i8::MIN..=i8::MAX {
        let start = |variant, assigned, signals| Homing::start(method, variant, assigned, signals).err();
        for variant in [0, 1] {
            let (bare, blocked, ready) = match method {
                17..=30 => (Some(HomingError::SignalNotAssigned), Some(HomingError::BothLimitsActive), None),
                35 => (None, None, None),
                _ => [Some(HomingError::UnsupportedMethod); 3].into(),
            };
            assert_eq!(start(variant, off, off), bare);
            assert_eq!(start(variant, ALL, both), blocked);
            assert_eq!(start(variant, ALL, off), ready);
        }
        assert_eq!(start(2, ALL, off), Some(HomingError::UnsupportedMethod));
    }
    assert!(Homing::start(35, 0, off, both).is_ok());
    assert!(Homing::start(19, 0, Signals { home: true, ..off }, off).is_ok());
}

proptest! {
    #[test]
    fn every_search_ends_at_its_edge(
        method in prop::sample::select(vec![17i8, 18, 19, 20, 21]),
        left in 500i32..4000,
        width in 100i32..2000,
        right in 500i32..4000,
        part in -0.05f64..1.05,
        fast in 1000u32..60_000,
        slow in 500u32..5000,
        acceleration in 50_000u32..2_000_000,
        stop_deceleration in 50_000u32..5_000_000,
    ) {
        let axis = Axis { negative: -left, home: (0, width), positive: width + right };
        let start = (f64::from(axis.negative) + f64::from(axis.positive - axis.negative) * part) as i32;
        let parameters = Parameters { fast, slow, acceleration, stop_deceleration };
        let (place, direction) = match method {
            17 => (Place::NegativeLimit, if start <= axis.negative { 1 } else { -1 }),
            18 => (Place::PositiveLimit, if start >= axis.positive { -1 } else { 1 }),
            19 => (Place::HomeLeft, -1),
            20 => (Place::HomeLeft, 1),
            _ => (Place::HomeRight, 1),
        };
        let run = run(&axis, method, standing(start), &parameters);
        prop_assert_eq!(run.last, Outcome::Finished);
        let (edge, velocity) = run.attained.expect("an edge");
        let passed = edge.sub_pulses_from(Position::from_pulses(axis.edge(place))) * direction;
        prop_assert!((0..=velocity.sub_pulses_per_tick().abs()).contains(&passed), "{:?}", run);
        let pace = if method <= 18 && run.legs == [i64::from(fast) * direction] { fast } else { slow };
        prop_assert_eq!(*run.legs.last().unwrap(), i64::from(pace) * direction);
        let length = f64::from(axis.positive - axis.negative) + f64::from(fast).powi(2) / f64::from(stop_deceleration);
        let ramps = 8.0 * f64::from(fast) / f64::from(acceleration.min(stop_deceleration));
        prop_assert!(f64::from(run.ticks) / 20_000.0 <= 3.0 * length / f64::from(slow.min(fast)) + ramps + 1.0);
    }
}
