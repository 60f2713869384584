//! What the stack does with the chip's events, and in which order.

use dictionary::{AbortCode, Entry};
use wire::al::{AlState, AlStatus, AlStatusCode};
use wire::coe::Address;
use wire::mailbox::{Header, MailboxError, Protocol};
use wire::{AlEvents, EscAccess, Nanos, foe, register};

use crate::application::Application;
use crate::coe::{Answer, Servers};
use crate::communication_area::CommunicationArea;
use crate::configuration::{Configuration, MAX_MAILBOX};
use crate::device_objects::{self, DeviceObjects};
use crate::foe::{Capacity, FileAnswer, FileServer};
use crate::indicators::{Leds, Patterns};
use crate::mailbox::{Mailbox, REQUEST_EVENT};
use crate::process_data::ProcessData;
use crate::sync_managers::{INPUTS, OUTPUTS};
use crate::synchronization::{CycleMeter, Mode, Sequence};
use crate::timing::{Event, unserved};

/// How often inputs are renewed when nothing synchronises them, in ns.
const FREE_RUN_PERIOD: u64 = 1_000_000;

/// The slave stack of one device.
#[derive(Clone, Debug)]
pub struct Slave {
    pub(crate) configuration: Configuration,
    pub(crate) area: CommunicationArea,
    pub(crate) status: AlStatus,
    pub(crate) code: AlStatusCode,
    pub(crate) mailbox: Mailbox,
    pub(crate) servers: Servers,
    pub(crate) files: FileServer,
    pub(crate) process: ProcessData,
    pub(crate) mode: Mode,
    pub(crate) sequence: Sequence,
    pub(crate) meter: CycleMeter,
    /// When SYNC0 came last.
    pub(crate) last_sync0: Option<Nanos>,
    /// Since when the master waits for OP.
    pub(crate) pending_op: Option<Nanos>,
    /// Whether the master asks for the device's identification.
    pub(crate) identifies: bool,
    /// The events that matter in the present state.
    pub(crate) interest: u32,
    /// The event whose inputs are not ready yet.
    pub(crate) inputs_due: Option<Event>,
    /// What the LEDs are to tell.
    pub(crate) patterns: Patterns,
    /// What they show.
    pub(crate) leds: Leds,
    inputs_at: Nanos,
}

/// What a poll has brought about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Report {
    /// The AL state now.
    pub state: AlState,
    /// Whether an error is pending that the master has not acknowledged.
    pub error: bool,
    /// The AL status code.
    pub status_code: AlStatusCode,
    /// Outputs take effect now.
    pub sync: Option<Sync>,
}

/// The instant at which outputs take effect, in OP.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sync {
    /// Nominal time to the next in ns: the SYNC0 cycle, or the measured time between outputs; `None` while that is unknown.
    pub cycle: Option<u32>,
    /// Whether the master sent outputs since the last one; if not, the objects are unchanged.
    pub fresh: bool,
}

impl Slave {
    /// A stack just switched on, in INIT.
    ///
    /// # Panics
    /// On a configuration the stack has no memory for, see the limits in [`crate::configuration`].
    pub fn new(configuration: Configuration) -> Self {
        configuration.assert_valid();
        Self {
            area: CommunicationArea::new(&configuration),
            configuration,
            status: AlStatus::default(),
            code: AlStatusCode::None,
            mailbox: Mailbox::at_power_on(),
            servers: Servers::default(),
            files: FileServer::default(),
            process: ProcessData::new(),
            mode: Mode::FreeRun,
            sequence: Sequence::default(),
            meter: CycleMeter::default(),
            last_sync0: None,
            pending_op: None,
            identifies: false,
            interest: AlEvents::AL_CONTROL | AlEvents::SM_ACTIVATION,
            inputs_due: None,
            patterns: Patterns::default(),
            leds: Leds::default(),
            inputs_at: Nanos(0),
        }
    }

    /// The AL state.
    pub const fn state(&self) -> AlState {
        self.status.state
    }

    /// The AL status code.
    pub const fn status_code(&self) -> AlStatusCode {
        self.code
    }

    /// Copies the value of any object of the device to `out` and returns its length, as an upload would, without regard to access rights.
    ///
    /// # Errors
    /// The abort code of the upload; 0x06010005 if `out` is too short.
    pub fn read_object(&self, application: &impl Application, index: u16, sub: u8, now: Nanos, out: &mut [u8]) -> Result<usize, AbortCode> {
        let value = device_objects::load(&self.area, application, Address { index, sub }, now)?;
        out.get_mut(..value.len()).ok_or(AbortCode::ObjectTooLong)?.copy_from_slice(&value);
        Ok(value.len())
    }

    /// Handles what has happened on the bus: AL control, sync managers, process data, SYNC signals, watchdog, mailbox, time-outs.
    ///
    /// To be called every control tick and right after each frame.
    pub fn poll(&mut self, esc: &mut impl EscAccess, application: &mut impl Application, now: Nanos) -> Report {
        let fault = application.emergency();
        self.area.log.observe(self.area.device_time(now), fault);
        let mut sync = None;
        let mut events = esc.events();
        if events.has(self.interest) {
            // A request for INIT goes before changes of sync managers: masters clear these right after it.
            if events.has(AlEvents::AL_CONTROL) {
                self.al_control(esc, application, now);
                events = esc.events();
            }
            if events.has(AlEvents::SM_ACTIVATION) {
                self.sync_managers_changed(esc);
                events = esc.events();
            }
            sync = self.process_events(esc, application, events, now);
            if events.has(self.interest & REQUEST_EVENT) && self.mailbox.has_room() {
                self.serve_mailbox(esc, application, now);
            }
        }
        if self.status.state >= AlState::SafeOp {
            sync = self.supervise(esc, application, now).or(sync);
        }
        if self.status.state != AlState::Init {
            self.mailbox.observe(fault);
            self.send(esc, application.entries());
        }
        Report {
            state: self.status.state,
            error: self.status.error,
            status_code: self.code,
            sync,
        }
    }

    /// Copies the mapped inputs to the chip if they are due: after each event of synchronisation, and every millisecond without such
    /// events. To be called after the control tick.
    pub fn publish_inputs(&mut self, esc: &mut impl EscAccess, application: &impl Application, now: Nanos) {
        if self.status.state < AlState::SafeOp {
            return;
        }
        if self.inputs_due.is_some() || now.since(self.inputs_at) >= self.longest_input_age() {
            self.publish(esc, application, now);
        }
    }

    /// Copies the mapped inputs to the chip.
    pub(crate) fn publish(&mut self, esc: &mut impl EscAccess, application: &impl Application, now: Nanos) {
        self.process.publish(esc, &self.area, application, now);
        if let Some(event) = self.inputs_due.take() {
            self.area.inputs.reacted(event.age(now));
        }
        self.inputs_at = now;
    }

    /// While events of synchronisation come, inputs wait for them, so that they are those of one instant of the cycle.
    fn longest_input_age(&self) -> u64 {
        let cycle = match self.mode {
            Mode::FreeRun => None,
            Mode::SyncManager => self.meter.cycle(),
            Mode::Sync0 { cycle } => Some(cycle),
        };
        FREE_RUN_PERIOD.max(2 * u64::from(cycle.unwrap_or(0)))
    }

    /// Handles watchdog, SYNC signals and process data, in this order: a frame is polled at once, so a SYNC0 seen together with outputs
    /// came before them.
    fn process_events(
        &mut self,
        esc: &mut impl EscAccess,
        application: &mut impl Application,
        events: AlEvents,
        now: Nanos,
    ) -> Option<Sync> {
        let mut sync = None;
        let events = AlEvents(events.0 & self.interest);
        if events.has(AlEvents::PROCESS_WATCHDOG) {
            self.watchdog_expired(esc);
        }
        if events.has(AlEvents::SYNC0) {
            esc.read_u8(register::DC_SYNC0_STATUS);
            sync = self.sync0(esc, application, now);
        }
        if events.has(AlEvents::SYNC1) {
            esc.read_u8(register::DC_SYNC1_STATUS);
            if let Mode::Sync0 { cycle } = self.mode {
                self.inputs_due = Some(self.date(esc, register::DC_NEXT_SYNC1, cycle, now));
            }
        }
        if events.has(AlEvents::sync_manager(OUTPUTS)) {
            sync = self.outputs_came(esc, application, now).or(sync);
        }
        if events.has(AlEvents::sync_manager(INPUTS)) && self.mode == Mode::SyncManager && !self.process.has_outputs() {
            self.synchronized(Event::found(now));
        }
        sync
    }

    /// SYNC0: outputs take effect, inputs are taken.
    fn sync0(&mut self, esc: &mut impl EscAccess, application: &mut impl Application, now: Nanos) -> Option<Sync> {
        let last = self.last_sync0.replace(now);
        let Mode::Sync0 { cycle } = self.mode else { return None };
        let event = self.date(esc, register::DC_START_TIME, cycle, now);
        self.synchronized(event);
        self.count_too_small(last.map_or(0, |last| unserved(now.since(last), cycle)));
        if self.status.state != AlState::Op {
            return None;
        }
        if self.process.has_outputs() && self.sequence.sync(now) {
            self.output_missed(esc);
        }
        (self.status.state == AlState::Op).then(|| {
            let fresh = self.process.fresh;
            if fresh {
                self.process.apply(application);
                self.area.outputs.reacted(event.age(now));
            }
            Sync { cycle: Some(cycle), fresh }
        })
    }

    /// Outputs came: they wait for SYNC0, or take effect at once.
    fn outputs_came(&mut self, esc: &mut impl EscAccess, application: &mut impl Application, now: Nanos) -> Option<Sync> {
        self.process.latch(esc);
        self.meter.output(now);
        match self.mode {
            Mode::Sync0 { .. } => {
                self.sequence.output();
                return None;
            }
            Mode::SyncManager => {
                self.synchronized(Event::found(now));
                let cycle = self.meter.cycle().unwrap_or(0);
                for parameters in self.area.sync_parameters() {
                    parameters.cycle = cycle;
                }
            }
            Mode::FreeRun => {}
        }
        (self.status.state == AlState::Op).then(|| self.take_effect(application))
    }

    /// Outputs latched last take effect.
    pub(crate) fn take_effect(&mut self, application: &mut impl Application) -> Sync {
        self.process.apply(application);
        let cycle = if let Mode::Sync0 { cycle } = self.mode {
            Some(cycle)
        } else {
            self.meter.cycle()
        };
        Sync { cycle, fresh: true }
    }

    /// Answers the request that lies in the mailbox.
    fn serve_mailbox(&mut self, esc: &mut impl EscAccess, application: &mut impl Application, now: Nanos) {
        let mut buffer = [0; MAX_MAILBOX];
        let Some((header, body)) = self.mailbox.receive(esc, &mut buffer) else {
            return;
        };
        let mut objects = DeviceObjects {
            area: &mut self.area,
            application,
            state: self.status.state,
            now,
        };
        // A master that asks for something else does not wait for the rest of a list.
        self.servers.information.reset();
        let outcome = match body {
            Ok(body) if header.protocol == Protocol::FOE => return self.serve_file(&header, body, application, now),
            Ok(body) if header.protocol == Protocol::COE => {
                self.servers
                    .serve(body, &header, &mut objects, &self.configuration, self.mailbox.capacity())
            }
            Ok(_) => Err(MailboxError::UnsupportedProtocol),
            Err(error) => Err(error),
        };
        match outcome {
            Ok(Answer::Sdo(response)) => self.mailbox.respond(&header, &response),
            Ok(Answer::Information(information)) => self.mailbox.inform(&header, &information),
            Ok(Answer::None) => {}
            Err(error) => self.mailbox.refuse(&header, error),
        }
    }

    /// Answers a message of FoE.
    fn serve_file(&mut self, header: &Header, body: &[u8], application: &mut impl Application, now: Nanos) {
        let Some(message) = foe::Message::parse(body) else {
            return self.mailbox.refuse(header, MailboxError::SizeTooShort);
        };
        let capacity = Capacity {
            request: self.mailbox.request_capacity(),
            answer: self.mailbox.capacity(),
        };
        let mut objects = DeviceObjects {
            area: &mut self.area,
            application,
            state: self.status.state,
            now,
        };
        match self.files.serve(message, &mut objects, self.configuration.device_name, capacity) {
            Some(FileAnswer::Message(answer)) => self.mailbox.transfer(header, &answer),
            Some(FileAnswer::Error(error)) => {
                let text = error.text.as_bytes();
                let text = &text[..text.len().min(capacity.of_answers())];
                let code = error.code.code();
                self.mailbox.transfer(header, &foe::Message::Error { code, text });
            }
            None => {}
        }
    }

    /// Puts the next message into the mailbox to the master: answers, then the rest of a list, then emergencies.
    fn send(&mut self, esc: &mut impl EscAccess, application: &'static [Entry]) {
        let information = &mut self.servers.information;
        if information.has_more()
            && self.mailbox.is_idle(esc)
            && let Some((request, next)) = information.next(application, self.mailbox.capacity())
        {
            self.mailbox.inform(&request, &next);
        }
        self.mailbox.send(esc);
    }
}
