//! Round trip of a cyclic frame over a virtual cable (veth): a virtual drive in OP beside echoes that do nothing but send frames back.
//!
//! All of them answer in the same run, in turns, because figures from a shared machine compare only with figures of the same moment. Prints
//! median and 99th percentile of each, how they compare, and what part of a core the answering thread takes.
//!
//! | module | holds |
//! |---|---|
//! | here | the plan, and what is printed |
//! | `master` | the master's side: flat out and at 1 kHz |
//! | `cpus` | each of the two on a CPU of its own |
//! | `responder` | who answers: two echoes and the virtual drive, each in a thread |
//! | `plain_socket` | a packet socket that just blocks |
//! | `statistics` | median, percentile and ratios |

#[cfg(target_os = "linux")]
mod cpus;
#[cfg(target_os = "linux")]
mod master;
#[cfg(target_os = "linux")]
mod plain_socket;
#[cfg(target_os = "linux")]
mod responder;
#[cfg(target_os = "linux")]
mod statistics;

#[cfg(not(target_os = "linux"))]
fn main() {
    println!("round_trip: skipped, virtual cables and packet sockets are Linux's");
}

#[cfg(target_os = "linux")]
fn main() {
    // `cargo test --benches` starts benchmarks as well, without this argument.
    if !std::env::args().any(|argument| argument == "--bench") {
        return;
    }
    // Before any thread is started.
    if let Err(error) = usr2556e::namespace::enter() {
        println!("round_trip: skipped, {error}");
        return;
    }
    println!("{}", benchmarks::machine::describe());
    plan::run();
}

#[cfg(target_os = "linux")]
mod plan {
    use std::time::Duration;

    use crate::cpus::Cpus;
    use crate::master::{Master, Pace};
    use crate::responder::{Kind, Responder};
    use crate::statistics::{Round, Turn, summarize};

    /// How often each responder has its turn.
    const ROUNDS: usize = 11;

    /// How long a served segment is left alone to see what it takes then.
    const SILENCE: Duration = Duration::from_secs(3);

    /// What the master does: name, pace, exchanges that do not count, exchanges that do.
    const PACES: [(&str, Pace, usize, usize); 2] = [
        ("flat out", Pace::FlatOut, 300, 3000),
        ("1 kHz", Pace::Every(Duration::from_millis(1)), 100, 500),
    ];

    pub fn run() {
        for drives in [1, 10] {
            idle(drives);
        }
        for (name, pace, settling, counted) in PACES {
            println!("\n{name}, {ROUNDS} rounds of {counted} frames; round trip in us, CPU share of the answering thread");
            let mut rounds = Vec::new();
            for number in 0..ROUNDS {
                let mut kinds = Kind::ALL;
                kinds.rotate_left(number % Kind::ALL.len());
                let mut round = Round::default();
                for kind in kinds {
                    round.set(kind, turn(kind, pace, settling, counted));
                }
                println!("  {round}");
                rounds.push(round);
            }
            summarize(name, &rounds);
        }
    }

    /// What a served segment in INIT takes without traffic.
    fn idle(drives: usize) {
        let responder = Responder::start(Kind::Drive, drives);
        std::thread::sleep(Duration::from_millis(200));
        let share = responder.cpu_share(|| std::thread::sleep(SILENCE)).1;
        println!("served segment of {drives} without traffic: {:.2} % of a core", 100.0 * share);
        responder.stop();
    }

    /// One responder's turn.
    fn turn(kind: Kind, pace: Pace, settling: usize, counted: usize) -> Turn {
        let cpus = Cpus::available();
        // Started first, so that it sees more CPUs than the one it will be on; a link that sees only one does not look for frames.
        let responder = Responder::start(kind, 1);
        cpus.pin(0);
        let mut master = Master::open();
        if kind == Kind::Drive {
            master.bring_up();
        }
        let drives = u16::from(kind == Kind::Drive);
        master.exchange(pace, settling, drives);
        let (times, cpu_share) = responder.cpu_share(|| master.exchange(pace, counted, drives));
        responder.stop();
        cpus.release();
        Turn::new(times, cpu_share)
    }
}
