//! An hour in every run of the tests; many more are run by hand, see docs/src/simulation.md.

use std::thread;
use std::time::Duration;

use simulation::Simulation;
use simulation::campaign::Campaign;
use simulation::coverage::REQUIRED;

/// What happens less often in an hour is not simulated, whatever the name of the act says.
const LEAST: u64 = 5;

#[test]
fn nothing_goes_wrong_in_an_hour_and_everything_is_visited() {
    let campaign = Campaign {
        first_seed: 1,
        seeds: 20,
        span: Duration::from_secs(180),
        threads: thread::available_parallelism().map_or(1, usize::from),
    };
    let coverage = campaign.run(|| ()).unwrap_or_else(|failure| panic!("{failure}"));
    let seldom: Vec<_> = REQUIRED.iter().filter(|what| coverage.of(what) < LEAST).collect();
    assert!(seldom.is_empty(), "less than {LEAST} times: {seldom:?} in\n{coverage}");
}

#[test]
fn a_seed_does_the_same_again() {
    let run = |seed| Simulation::run(seed, Duration::from_secs(10)).unwrap_or_else(|failure| panic!("{failure}"));
    assert_eq!(run(3), run(3));
    assert_ne!(run(3), run(4));
}
