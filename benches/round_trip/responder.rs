//! Who answers at the other end of the cable, each in a thread of its own.

use std::fs;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc;
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use nix::unistd::{Pid, gettid};
use usr2556e::link::raw::{RawLink, Role};
use usr2556e::link::{Link, MAX_FRAME, Received};
use usr2556e::namespace::DRIVE_INTERFACE;
use usr2556e::segment::VirtualSegment;
use usr2556e::server;
use wire::frame::SOURCE_ADDRESS;

use crate::cpus::Cpus;
use crate::plain_socket::PlainSocket;

/// How long a link waits before it comes back to see whether there is something else to do.
const WAIT: Duration = Duration::from_millis(10);

/// Kinds of responders.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// An echo on a socket that just blocks.
    BlockingEcho,
    /// An echo on the link that the drives use, with its predictive wait.
    LinkEcho,
    /// Virtual drives.
    Drive,
}

impl Kind {
    /// All kinds, in the order in which they are printed.
    pub const ALL: [Self; 3] = [Self::BlockingEcho, Self::LinkEcho, Self::Drive];

    /// For tables.
    pub const fn name(self) -> &'static str {
        match self {
            Self::BlockingEcho => "blocking echo",
            Self::LinkEcho => "echo on the link",
            Self::Drive => "virtual drive",
        }
    }
}

/// A thread that answers.
pub struct Responder {
    thread: JoinHandle<()>,
    id: Pid,
    stop: Arc<AtomicBool>,
}

impl Responder {
    /// Starts a responder; `drives` counts for virtual drives only.
    pub fn start(kind: Kind, drives: usize) -> Self {
        let stop = Arc::new(AtomicBool::new(false));
        let (ready, is_ready) = mpsc::channel();
        let thread = thread::spawn({
            let stop = stop.clone();
            move || match kind {
                Kind::BlockingEcho => blocking_echo(&stop, &ready),
                Kind::LinkEcho => link_echo(&stop, &ready),
                Kind::Drive => drive(drives, &stop, &ready),
            }
        });
        let id = is_ready.recv().expect("the responder opens its end of the cable");
        Self { thread, id, stop }
    }

    /// What part of a core the responder takes while `activity` goes on.
    pub fn cpu_share<T>(&self, activity: impl FnOnce() -> T) -> (T, f64) {
        let (begin, cpu_begin) = (Instant::now(), self.cpu_time());
        let result = activity();
        let share = (self.cpu_time() - cpu_begin).as_secs_f64() / begin.elapsed().as_secs_f64();
        (result, share)
    }

    fn cpu_time(&self) -> Duration {
        let text = fs::read_to_string(format!("/proc/self/task/{}/schedstat", self.id)).unwrap_or_default();
        let nanoseconds = text.split_whitespace().next().and_then(|number| number.parse().ok());
        Duration::from_nanos(nanoseconds.expect("a kernel that accounts CPU time by thread"))
    }

    /// Ends it.
    pub fn stop(self) {
        self.stop.store(true, Ordering::Relaxed);
        self.thread.join().expect("a responder does not fail");
    }
}

/// Takes the second CPU, and tells who this is.
fn settle(ready: &mpsc::Sender<Pid>) {
    Cpus::available().pin(1);
    ready.send(gettid()).expect("somebody waits");
}

fn blocking_echo(stop: &AtomicBool, ready: &mpsc::Sender<Pid>) {
    let socket = PlainSocket::open(DRIVE_INTERFACE).expect("an interface of this namespace's own");
    settle(ready);
    let mut buffer = [0; MAX_FRAME];
    while !stop.load(Ordering::Relaxed) {
        if let Some(length) = socket.receive(&mut buffer) {
            buffer[SOURCE_ADDRESS] |= 2;
            socket.send(&buffer[..length]).expect("the cable stays");
        }
    }
}

fn link_echo(stop: &AtomicBool, ready: &mpsc::Sender<Pid>) {
    let mut link = RawLink::open(DRIVE_INTERFACE, Role::DriveServer).expect("an interface of this namespace's own");
    settle(ready);
    let mut buffer = [0; MAX_FRAME];
    while !stop.load(Ordering::Relaxed) {
        if let Received::Frame(length) = link.receive(&mut buffer, WAIT).expect("the cable stays") {
            buffer[SOURCE_ADDRESS] |= 2;
            link.send(&buffer[..length]).expect("the cable stays");
        }
    }
}

fn drive(drives: usize, stop: &AtomicBool, ready: &mpsc::Sender<Pid>) {
    let mut link = RawLink::open(DRIVE_INTERFACE, Role::DriveServer).expect("an interface of this namespace's own");
    let mut segment = VirtualSegment::of(drives);
    settle(ready);
    server::serve(&mut link, &mut segment, stop, |_, _| ()).expect("the cable stays");
}
