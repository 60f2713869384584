//! The ports: links, loops, and when a frame came by (ESC data sheet, section I, 3).
//!
//! A port whose loop is open sends frames out and takes them in; a closed one hands them on inside the chip. What a frame writes to the
//! loop control (0x0101) acts behind that frame, so that a frame under way finds every port as it was when it entered the segment.

use wire::Nanos;
use wire::register::*;

use crate::chip::Chip;
use crate::live::ecat_event;
use crate::segment::End;

/// Ports that the register map knows.
pub(crate) const PORTS: usize = 4;

/// How long a temporary loop control lasts, in ns.
const TEMPORARY_NS: u64 = 1_000_000_000;
/// How long a frame shows as activity: one period of flickering, in ns.
const ACTIVITY_NS: u64 = 100_000_000;
/// Temporary use of the loop control, in the first byte of the DL control.
const TEMPORARY: u8 = 1 << 1;
/// Stands for ports that ask for a closer look.
const IRREGULAR: u8 = 0xFF;

/// What the loop control says about one port.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Mode {
    /// Open while there is a link.
    Auto,
    /// Closed when the link is lost, and open again only when the master says so or a frame comes in.
    AutoClose,
    /// Open, link or not.
    Open,
    /// Closed, link or not.
    Closed,
}

/// The ports of one chip. Sets of ports are a bit each.
#[derive(Clone, Debug)]
pub(crate) struct Ports {
    count: usize,
    links: u8,
    open: u8,
    control: u8,
    requested: Option<u8>,
    temporary: Option<(u8, Nanos)>,
    regular: u8,
    /// Where the cable of each port ends.
    pub(crate) peers: [Option<End>; PORTS],
    frame: u64,
    seen: u8,
    arrivals: [Nanos; PORTS],
    latched: u64,
    /// When a frame came by last, whichever port it came to.
    pub(crate) last_frame: Option<Nanos>,
}

impl Ports {
    /// The first `count` ports, none with a cable.
    pub(crate) fn new(count: usize) -> Self {
        Self {
            count: count.clamp(1, PORTS),
            links: 0,
            open: 0,
            control: 0,
            requested: None,
            temporary: None,
            regular: 0,
            peers: [None; PORTS],
            frame: 0,
            seen: 0,
            arrivals: [Nanos(0); PORTS],
            latched: 0,
            last_frame: None,
        }
    }

    pub(crate) const fn count(&self) -> usize {
        self.count
    }

    /// Two bits a port: 3 for MII, 0 for none.
    pub(crate) const fn descriptor(&self) -> u8 {
        0xFF >> (8 - 2 * self.count)
    }

    /// Whether exactly these ports are linked and open, and nothing is about to change.
    pub(crate) const fn are(&self, open: u8) -> bool {
        self.regular == open
    }

    /// Whether the receive times were latched by this frame.
    pub(crate) const fn latched(&self, frame: u64) -> bool {
        self.latched == frame
    }

    pub(crate) const fn has_link(&self, port: usize) -> bool {
        self.links >> port & 1 != 0
    }

    /// The ports that frames pass. When all are closed, port 0 stands in for them, lest the master never reach the chip again.
    pub(crate) const fn passable(&self) -> u8 {
        if self.open == 0 { 1 } else { self.open }
    }

    /// Whether a frame that comes in here gets any further.
    pub(crate) const fn takes_in(&self, port: usize) -> bool {
        (self.links & self.passable()) >> port & 1 != 0
    }

    /// Whether port 0 is closed because its link is lost, not because the master said so.
    pub(crate) fn is_upstream_lost(&self) -> bool {
        !self.has_link(0) && self.mode(0) != Mode::Closed
    }

    fn mode(&self, port: usize) -> Mode {
        match self.control >> (2 * port) & 0b11 {
            0 => Mode::Auto,
            1 => Mode::AutoClose,
            2 => Mode::Open,
            _ => Mode::Closed,
        }
    }

    fn set_open(&mut self, port: usize, open: bool) {
        self.open = self.open & !(1 << port) | u8::from(open) << port;
        self.settle();
    }

    fn settle(&mut self) {
        let regular = self.requested.is_none() && self.temporary.is_none() && self.open == self.links;
        self.regular = if regular { self.open } else { IRREGULAR };
    }

    /// Puts a loop control into force.
    pub(crate) fn control(&mut self, control: u8) {
        (self.control, self.requested) = (control, None);
        for port in 0..self.count {
            let open = match self.mode(port) {
                Mode::Auto | Mode::AutoClose => self.has_link(port),
                Mode::Open => true,
                Mode::Closed => false,
            };
            self.set_open(port, open);
        }
    }

    /// Puts a loop control into force behind the frame that brought it.
    pub(crate) fn request(&mut self, control: u8, frame: u64) {
        self.begin(frame);
        self.requested = Some(control);
        self.settle();
    }

    /// Ends a temporary loop control without its being taken back.
    pub(crate) fn forget_temporary(&mut self) {
        self.temporary = None;
        self.settle();
    }

    /// Begins a frame; whether it has not been here before.
    fn begin(&mut self, frame: u64) -> bool {
        let new = self.frame != frame;
        if new {
            (self.frame, self.seen) = (frame, 0);
        }
        new
    }
}

impl Chip {
    /// Plugs or unplugs the cable of a port; ports that the chip does not have are ignored. [`crate::Segment::connect`] and
    /// [`crate::Segment::disconnect`] do it at both ends; this is for a fault of one side.
    pub fn set_link(&mut self, port: usize, up: bool) {
        if port >= self.ports.count || self.ports.has_link(port) == up {
            return;
        }
        self.settle_ports(self.now);
        let was_open = self.ports.open >> port & 1 != 0;
        self.ports.links ^= 1 << port;
        let open = match self.ports.mode(port) {
            Mode::Auto => up,
            Mode::AutoClose => up && was_open,
            Mode::Open | Mode::Closed => was_open,
        };
        self.ports.set_open(port, open);
        self.ecat_events |= ecat_event::DL_STATUS;
        if !up && was_open {
            self.registers.count(LOST_LINK_COUNTERS + port as u16);
        }
    }

    /// Whether a port's link LED is on: there is a cable with something at its other end.
    pub fn has_link(&self, port: usize) -> bool {
        port < self.ports.count && self.ports.has_link(port)
    }

    /// Whether a port's activity LED flickers at `now`: it has a link, its loop is open, and a frame came by within the last 100 ms.
    pub fn is_active(&self, port: usize, now: Nanos) -> bool {
        let recent = self.ports.last_frame.is_some_and(|last| now.since(last) < ACTIVITY_NS);
        recent && self.has_link(port) && self.ports.open >> port & 1 != 0
    }

    /// DL status: what the ports' links and loops are.
    pub(crate) fn dl_status(&self) -> u16 {
        let timeout = self.watchdog_timeout(PDI_WATCHDOG_TIME);
        let pdi_alive = !self.pdi_watchdog.was_triggered() || self.pdi_watchdog.is_content(self.now, timeout);
        let mut status = u16::from(self.is_eeprom_loaded()) | u16::from(pdi_alive) << 1;
        for port in 0..PORTS {
            let link = u16::from(self.ports.has_link(port));
            let closed = u16::from(self.ports.open >> port & 1 == 0);
            status |= link << (4 + port) | closed << (8 + 2 * port) | link << (9 + 2 * port);
        }
        status
    }

    /// Takes over what a frame wrote to the DL control.
    pub(crate) fn commit_loop_control(&mut self, entered: Nanos, frame: u64) {
        let Some(control) = self.shadow.get(DL_CONTROL + 1) else {
            return;
        };
        let before = self.ports.temporary.map_or(self.ports.control, |(before, _)| before);
        let ends = Nanos(entered.0.saturating_add(TEMPORARY_NS));
        let temporary = self.registers.u8(DL_CONTROL) & TEMPORARY != 0;
        self.ports.temporary = temporary.then_some((before, ends));
        self.ports.request(control, frame);
    }

    /// Brings the loops up to date: what the last frame asked for, and what was temporary.
    pub(crate) fn settle_ports(&mut self, now: Nanos) {
        if self.ports.regular != IRREGULAR {
            return;
        }
        let before = self.ports.open;
        if let Some(control) = self.ports.requested {
            self.ports.control(control);
        }
        if let Some((restored, ends)) = self.ports.temporary
            && ends <= now
        {
            let forwarding = self.registers.u8(DL_CONTROL) & !TEMPORARY;
            self.registers.set(DL_CONTROL, &[forwarding, restored]);
            self.ports.temporary = None;
            self.ports.control(restored);
        }
        if self.ports.open != before {
            self.ecat_events |= ecat_event::DL_STATUS;
        }
    }

    /// Begins a frame at this chip, whichever port it comes to first.
    pub(crate) fn begin_frame(&mut self, frame: u64, now: Nanos) {
        self.ports.last_frame = Some(now);
        if self.ports.begin(frame) {
            self.settle_ports(now);
        }
    }

    /// A frame comes in where the loop is closed, and is lost; a port that only waited for one opens.
    pub(crate) fn refuse_frame(&mut self, port: usize) {
        if self.ports.mode(port) == Mode::AutoClose && self.ports.has_link(port) {
            self.ports.set_open(port, true);
            self.ecat_events |= ecat_event::DL_STATUS;
        }
    }

    /// The start of a frame reaches a port.
    pub(crate) fn note_arrival(&mut self, port: usize, at: Nanos) {
        self.ports.seen |= 1 << port;
        self.ports.arrivals[port] = at;
        if self.ports.latched(self.ports.frame) {
            self.show_receive_time(port);
        }
    }

    /// Latches when this frame came by: at the ports where it has been, and at the others as it gets there.
    pub(crate) fn latch_receive_times(&mut self, frame: u64, at: Nanos) {
        if self.ports.begin(frame) {
            self.note_arrival(0, at);
        }
        self.ports.latched = frame;
        for port in 0..PORTS {
            if self.ports.seen >> port & 1 != 0 {
                self.show_receive_time(port);
            }
        }
        self.registers.set(DC_PROCESSING_TIME, &self.clock.local(at).to_le_bytes());
    }

    fn show_receive_time(&mut self, port: usize) {
        let time = self.clock.local(self.ports.arrivals[port]) as u32;
        self.registers.set(DC_RECEIVE_TIMES + 4 * port as u16, &time.to_le_bytes());
    }
}
