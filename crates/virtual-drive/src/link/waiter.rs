//! Waiting for a frame at several interfaces at once.
use super::socket::PacketSocket;
use super::wait::{Plan, Predictor};
use super::{LinkError, Received};
use crate::clock::sleep_precisely;
use nix::errno::Errno;
use nix::poll::{PollFd, PollFlags, ppoll};
use std::thread::{self, ThreadId};
use std::time::{Duration, Instant};

/// No wait needs to be longer; keeps instants from overflowing.
const LONGEST_WAIT: Duration = Duration::from_secs(3600);

/// What is known about the next frame, whichever interface it comes to.
#[derive(Debug)]
pub(super) struct Waiter {
    predictor: Option<Predictor>,
    /// The thread whose timers were made precise.
    precise: Option<ThreadId>,
    /// The interface that is asked first: another one than the last time, so that a busy one does not keep the other waiting.
    first: usize,
}

impl Waiter {
    /// Waits until shortly before the next frame of a cycle and spins for it.
    pub(super) fn predictive() -> Self {
        Self {
            predictor: Some(new_predictor()),
            ..Self::blocking()
        }
    }

    /// Just waits.
    pub(super) const fn blocking() -> Self {
        Self {
            predictor: None,
            precise: None,
            first: 0,
        }
    }

    /// See [`super::Link::receive`]; tells also at which of the interfaces.
    pub(super) fn receive<const N: usize>(
        &mut self,
        sockets: &mut [PacketSocket; N],
        buffer: &mut [u8],
        wait: Duration,
    ) -> Result<(usize, Received), LinkError> {
        let deadline = Instant::now() + wait.min(LONGEST_WAIT);
        if self.predictor.is_some() {
            self.be_precise();
        }
        let received = self.next(sockets, buffer, deadline)?;
        if let Some(predictor) = &mut self.predictor {
            match received.1 {
                Received::Frame(_) => predictor.arrived(Instant::now()),
                Received::Up => *predictor = new_predictor(),
                Received::Soon | Received::Timeout | Received::Down => {}
            }
        }
        Ok(received)
    }

    /// The next frame, or what else comes first.
    fn next<const N: usize>(
        &mut self,
        sockets: &mut [PacketSocket; N],
        buffer: &mut [u8],
        deadline: Instant,
    ) -> Result<(usize, Received), LinkError> {
        loop {
            if let Some(found) = self.poll(sockets, buffer)? {
                return Ok(found);
            }
            let now = Instant::now();
            for (place, socket) in sockets.iter_mut().enumerate() {
                if let Some(change) = socket.check(now)? {
                    return Ok((place, change));
                }
            }
            let plan = self.predictor.as_mut().map_or(Plan::Block, |predictor| predictor.plan(now));
            if now >= deadline && plan != Plan::Announce {
                return Ok((0, Received::Timeout));
            }
            let latest = sockets.iter().filter_map(PacketSocket::next_check).fold(deadline, Instant::min);
            match plan {
                Plan::SleepUntil(time) => sleep(sockets, time.min(latest))?,
                Plan::Announce => return Ok((0, Received::Soon)),
                Plan::SpinUntil(time) => {
                    if let Some(found) = self.spin(sockets, buffer, time.min(latest))? {
                        return Ok(found);
                    }
                }
                Plan::Block => sleep(sockets, latest)?,
            }
        }
    }

    /// What is there already.
    fn poll<const N: usize>(&mut self, sockets: &mut [PacketSocket; N], buffer: &mut [u8]) -> Result<Option<(usize, Received)>, LinkError> {
        for place in (0..N).map(|offset| (self.first + offset) % N) {
            if let Some(received) = sockets[place].poll(buffer)? {
                self.first = (place + 1) % N;
                return Ok(Some((place, received)));
            }
        }
        Ok(None)
    }

    /// Looks for a frame without sleeping.
    fn spin<const N: usize>(
        &mut self,
        sockets: &mut [PacketSocket; N],
        buffer: &mut [u8],
        until: Instant,
    ) -> Result<Option<(usize, Received)>, LinkError> {
        loop {
            let found = self.poll(sockets, buffer)?;
            if found.is_some() || Instant::now() >= until {
                return Ok(found);
            }
            // Yielding costs next to nothing while no one else wants this core, and lets a master on the same core send what is looked for.
            thread::yield_now();
        }
    }

    /// Frames are announced late where sleeps are not precise; a link may change threads.
    fn be_precise(&mut self) {
        let thread = Some(thread::current().id());
        if self.precise != thread {
            self.precise = thread;
            sleep_precisely();
        }
    }
}

/// Sleeps until `until`, or until something happens at a socket.
fn sleep<const N: usize>(sockets: &[PacketSocket; N], until: Instant) -> Result<(), LinkError> {
    let left = until.saturating_duration_since(Instant::now());
    let mut descriptors = sockets.each_ref().map(|socket| PollFd::new(socket.descriptor(), PollFlags::POLLIN));
    match ppoll(&mut descriptors, Some(left.into()), None) {
        Ok(_) | Err(Errno::EINTR) => Ok(()),
        Err(error) => Err(sockets[0].failed("wait", error)),
    }
}

/// On a single core, spinning would keep a master on the same machine from sending what is spun for.
fn new_predictor() -> Predictor {
    // Cores that are online, not those this process may use: a server bound to one core leaves the master another.
    let cores = nix::unistd::sysconf(nix::unistd::SysconfVar::_NPROCESSORS_ONLN);
    Predictor::new(Instant::now(), cores.is_ok_and(|cores| cores > Some(1)))
}
