//! The built-in EtherCAT master: `ethercrab` over any link.
//!
//! | module | holds |
//! |---|---|
//! | [`bring_up`] | from the first frame to OP, with or without distributed clocks |
//! | [`axis`] | one drive in OP under control: enabling, homing, set-points |
//! | [`process_data`] | its default process data and the words in them |
//! | [`describe`] | what a drive says of itself, for people |
//! | [`sdo`] | reading and writing any object |
//!
//! [`run`] drives an asynchronous conversation with the drives on the calling thread. It never waits for anything but frames and
//! [`Pace`], so in lock-step a conversation takes the same course every time.

pub mod axis;
pub mod bring_up;
pub mod describe;
pub mod process_data;
pub mod sdo;

use std::cell::Cell;
use std::cell::RefCell;
use std::pin::{Pin, pin};
use std::rc::Rc;
use std::sync::Arc;
use std::task::{Context, Poll, Wake, Waker};
use std::thread::{self, Thread};
use std::time::{Duration, Instant};

use ethercrab::{MainDevice, MainDeviceConfig, PduRx, PduStorage, PduTx, RetryBehaviour, Timeouts};
use wire::Nanos;

use crate::clock::sleep_precisely;
use crate::link::lossy::Lossy;
use crate::link::{Link, LinkError, MAX_FRAME, Received};
use crate::segment::InMemory;

/// Frames the master may have under way.
const FRAMES: usize = 16;
/// Bytes of datagrams in one frame.
const FRAME_DATA: usize = PduStorage::element_size(1100);
/// How often a waiting conversation is asked whether something else has made it ready, such as a time-out.
const POLL_INTERVAL: Duration = Duration::from_millis(1);
/// A frame that was not back after this time is lost.
const FRAME_LOST: Duration = Duration::from_millis(20);

/// How long a frame may take; on a busy computer, other programs come between.
const FRAME_TIMEOUT: Duration = Duration::from_millis(100);
/// How long a drive may take to answer, for the same reason far longer than any drive needs.
const ANSWER_TIMEOUT: Duration = Duration::from_secs(2);

/// A link that knows the time of the drives at its other end.
pub trait MasterLink: Link {
    /// The present instant.
    fn now(&self) -> Nanos;

    /// Lets time pass up to `instant`.
    fn wait_until(&mut self, instant: Nanos);

    /// Whether time moves only when somebody waits for an instant or for a frame.
    fn is_lock_step(&self) -> bool {
        false
    }
}

impl MasterLink for InMemory {
    fn now(&self) -> Nanos {
        InMemory::now(self)
    }

    fn wait_until(&mut self, instant: Nanos) {
        InMemory::wait_until(self, instant);
    }

    fn is_lock_step(&self) -> bool {
        InMemory::is_lock_step(self)
    }
}

impl<L: MasterLink> MasterLink for Lossy<L> {
    fn now(&self) -> Nanos {
        self.inner().now()
    }

    fn wait_until(&mut self, instant: Nanos) {
        self.inner_mut().wait_until(instant);
    }

    fn is_lock_step(&self) -> bool {
        self.inner().is_lock_step()
    }
}

/// A link to drives outside of this process, in the computer's own time.
pub struct RealTimeLink<L> {
    link: L,
    start: Instant,
}

impl<L> RealTimeLink<L> {
    /// Time starts now, for the calling thread, whose sleeps become precise.
    pub fn new(link: L) -> Self {
        sleep_precisely();
        Self {
            link,
            start: Instant::now(),
        }
    }
}

impl<L: Link> Link for RealTimeLink<L> {
    fn send(&mut self, frame: &[u8]) -> Result<(), LinkError> {
        self.link.send(frame)
    }

    fn receive(&mut self, buffer: &mut [u8], wait: Duration) -> Result<Received, LinkError> {
        self.link.receive(buffer, wait)
    }
}

impl<L: Link> MasterLink for RealTimeLink<L> {
    fn now(&self) -> Nanos {
        Nanos(0).after(self.start.elapsed())
    }

    fn wait_until(&mut self, instant: Nanos) {
        thread::sleep(Duration::from_nanos(instant.since(self.now())));
    }
}

/// A link that somebody else looks at between two frames.
impl<L: Link> Link for Rc<RefCell<L>> {
    fn send(&mut self, frame: &[u8]) -> Result<(), LinkError> {
        self.borrow_mut().send(frame)
    }

    fn receive(&mut self, buffer: &mut [u8], wait: Duration) -> Result<Received, LinkError> {
        self.borrow_mut().receive(buffer, wait)
    }
}

impl<L: MasterLink> MasterLink for Rc<RefCell<L>> {
    fn now(&self) -> Nanos {
        self.borrow().now()
    }

    fn wait_until(&mut self, instant: Nanos) {
        self.borrow_mut().wait_until(instant);
    }

    fn is_lock_step(&self) -> bool {
        self.borrow().is_lock_step()
    }
}

/// The conversation's sense of time.
#[derive(Debug, Default)]
pub struct Pace {
    now: Cell<Nanos>,
    until: Cell<Option<Nanos>>,
}

impl Pace {
    /// The present instant.
    pub fn now(&self) -> Nanos {
        self.now.get()
    }

    /// Waits for an instant.
    pub async fn until(&self, instant: Nanos) {
        std::future::poll_fn(|_| {
            if self.now() >= instant {
                self.until.set(None);
                return Poll::Ready(());
            }
            self.until.set(Some(instant));
            Poll::Pending
        })
        .await;
    }

    /// Waits for a span of time from now on.
    pub async fn pause(&self, span: Duration) {
        self.until(self.now().after(span)).await;
    }
}

/// What the master does about a frame that does not come back.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Retries {
    /// When to send it again. In lock-step, as much simulated time passes, and then none until the computer's own has.
    pub after: Duration,
    /// How often, before its loss is an error.
    pub times: usize,
}

impl Default for Retries {
    /// For a wire that loses nothing, beside other programs on a busy computer.
    fn default() -> Self {
        Self {
            after: FRAME_TIMEOUT,
            times: 2,
        }
    }
}

/// Holds a conversation with the drives at the other end of `link`, to its end.
///
/// # Errors
/// The link failed. What the drives refuse is the conversation's own result.
pub fn run<L: MasterLink, T>(link: &mut L, conversation: impl AsyncFnOnce(&MainDevice<'_>, &Pace) -> T) -> Result<T, LinkError> {
    run_with(Retries::default(), link, conversation)
}

/// Like [`run`], over a link that loses frames.
///
/// # Errors
/// The link failed. What the drives refuse is the conversation's own result.
pub fn run_with<L: MasterLink, T>(
    retries: Retries,
    link: &mut L,
    conversation: impl AsyncFnOnce(&MainDevice<'_>, &Pace) -> T,
) -> Result<T, LinkError> {
    let storage = PduStorage::<FRAMES, FRAME_DATA>::new();
    let (tx, rx, pdu_loop) = storage.try_split().expect("this storage was made just now and never split");
    let timeouts = Timeouts {
        pdu: retries.after,
        eeprom: ANSWER_TIMEOUT,
        mailbox_echo: ANSWER_TIMEOUT,
        mailbox_response: ANSWER_TIMEOUT,
        ..Timeouts::default()
    };
    let config = MainDeviceConfig {
        dc_static_sync_iterations: 1000,
        retry_behaviour: RetryBehaviour::Count(retries.times),
    };
    let main = MainDevice::new(pdu_loop, timeouts, config);
    let pace = Pace::default();
    let mut pump = Pump {
        tx,
        rx,
        link,
        pace: &pace,
        under_way: 0,
        lost: false,
        lost_after: FRAME_LOST.min(retries.after),
        last_sent: Nanos(0),
        buffer: [0; MAX_FRAME],
    };
    pump.drive(pin!(conversation(&main, &pace)))
}

/// Moves frames between the conversation and the link.
struct Pump<'a, L> {
    tx: PduTx<'a>,
    rx: PduRx<'a>,
    link: &'a mut L,
    pace: &'a Pace,
    under_way: usize,
    /// Whether the last frames sent are lost.
    lost: bool,
    lost_after: Duration,
    last_sent: Nanos,
    buffer: [u8; MAX_FRAME],
}

impl<L: MasterLink> Pump<'_, L> {
    fn drive<F: Future>(&mut self, mut conversation: Pin<&mut F>) -> Result<F::Output, LinkError> {
        let waker = Waker::from(Arc::new(Unpark(thread::current())));
        let mut context = Context::from_waker(&waker);
        loop {
            self.pace.now.set(self.link.now());
            if let Poll::Ready(result) = conversation.as_mut().poll(&mut context) {
                return Ok(result);
            }
            self.send_all()?;
            self.wait()?;
        }
    }

    fn send_all(&mut self) -> Result<(), LinkError> {
        while let Some(frame) = self.tx.next_sendable_frame() {
            let mut result = Ok(());
            let claimed = frame.send_blocking(|bytes| {
                result = self.link.send(bytes);
                Ok(bytes.len())
            });
            result?;
            if claimed.is_ok() {
                self.under_way += 1;
                self.lost = false;
                self.last_sent = self.link.now();
            }
        }
        Ok(())
    }

    /// Waits for what the conversation may be waiting for: a frame, or an instant.
    fn wait(&mut self) -> Result<(), LinkError> {
        if self.link.now() > self.last_sent.after(self.lost_after) {
            self.lost |= self.under_way != 0;
            self.under_way = 0;
        }
        match self.pace.until.get() {
            Some(instant) if self.under_way == 0 => {
                self.link.wait_until(instant);
                Ok(())
            }
            // The master waits for its own time-out, of which simulated time must not see how fast this computer is.
            None if self.lost && self.link.is_lock_step() => {
                thread::park_timeout(POLL_INTERVAL);
                Ok(())
            }
            Some(instant) => self.fetch(POLL_INTERVAL.min(Duration::from_nanos(instant.since(self.link.now())))),
            None => self.fetch(POLL_INTERVAL),
        }
    }

    fn fetch(&mut self, wait: Duration) -> Result<(), LinkError> {
        if let Received::Frame(length) = self.link.receive(&mut self.buffer, wait)? {
            self.under_way = self.under_way.saturating_sub(1);
            // A frame that is not an answer to one of ours is somebody else's.
            let _ = self.rx.receive_frame(&self.buffer[..length]);
        }
        Ok(())
    }
}

/// Wakes the thread that holds the conversation.
struct Unpark(Thread);

impl Wake for Unpark {
    fn wake(self: Arc<Self>) {
        self.0.unpark();
    }
}
