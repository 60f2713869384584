//! The drive as a whole: one tick from sensors and objects to actuators.

use board::{Actuators, Nanos, PowerStage, Sensors};

use crate::alarm::{Alarm, AlarmLed, Light};
use crate::brake::Brake;
use crate::commissioning::{Commissioning, Order};
use crate::controlword::{Controlword, StartEdge};
use crate::current_loop::identification::Winding;
use crate::current_loop::{self, Bridge, CurrentLoop, ampere};
use crate::faults::{Fault, Faults, Measured};
use crate::inputs::{Inputs, Signals};
use crate::modes::{Context, Mode, Modes};
use crate::motion::Motion;
use crate::objects::DriveObjects;
use crate::outputs::{self, Indications};
use crate::power_control::{Activity, PowerControl, Situation, Stop};
use crate::power_stage::{Current, CurrentVector, Field, torque};
use crate::power_state::PowerState;
use crate::profile::{Acceleration, Position, Speed};
use crate::protection::{Protection, View};
use crate::statusword::{self, TARGET_REACHED, flag};
use crate::touch_probe::TouchProbes;

/// The firmware core.
#[derive(Clone, Debug)]
pub struct Drive {
    operational: bool,
    inputs: Inputs,
    signals: Signals,
    faults: Faults,
    power: PowerControl,
    start_edge: StartEdge,
    modes: Modes,
    motion: Motion,
    current: Current,
    field: Field,
    vector: Option<CurrentVector>,
    current_loop: CurrentLoop,
    commissioning: Commissioning,
    protection: Protection,
    /// A fault that the last tick has met while it drove the power stage.
    met: Option<Fault>,
    brake: Brake,
    probes: TouchProbes,
    alarm_led: AlarmLed,
}

impl Drive {
    /// A drive at power-up.
    pub fn new() -> Self {
        Self {
            operational: false,
            inputs: Inputs::default(),
            signals: Signals::default(),
            faults: Faults::default(),
            power: PowerControl::new(),
            start_edge: StartEdge::default(),
            modes: Modes::new(),
            motion: Motion::new(),
            current: Current::default(),
            field: Field::new(),
            vector: None,
            current_loop: CurrentLoop::default(),
            commissioning: Commissioning::default(),
            protection: Protection::default(),
            met: None,
            brake: Brake::default(),
            probes: TouchProbes::default(),
            alarm_led: AlarmLed::new(),
        }
    }

    /// One control tick, every [`board::TICK`]: reads the measurements and the writable objects, sets the others, commands the board.
    pub fn tick(&mut self, sensors: &Sensors, objects: &mut DriveObjects) -> Actuators {
        self.signals = self.inputs.tick(sensors.inputs, objects);
        self.modes.count_tick();
        self.modes.select(objects.mode);
        self.motion.set_filter_time(objects.filter_time);
        let controlword = Controlword(objects.controlword);
        self.start_edge.observe(controlword);

        self.commissioning.observe(sensors, self.vector.is_some());
        let currents = self.commissioning.corrected(sensors.phase_currents).map(ampere);
        let activity = self.control_power(sensors, currents, controlword, objects);
        let mode_bits = self.act(activity, controlword, objects);
        self.clear_position(objects);
        self.probes.tick(sensors, &self.signals, &self.motion, objects);

        let stage = self.drive_stage(activity, sensors, currents, objects);
        let indications = Indications {
            alarm: self.power.state().is_faulty(),
            brake_open: self.brake.is_open(),
            in_place: self.is_in_place(mode_bits),
        };
        let outputs = outputs::levels(indications, objects);
        objects.output_level = outputs::output_level(outputs);
        self.publish(sensors, currents, mode_bits, objects);
        self.alarm_led.tick(Alarm::of(self.power.state(), self.faults.latched()));
        Actuators { stage, outputs }
    }

    /// The instant of synchronisation, SYNC0 or the arrival of outputs, before the tick that follows it: CSP takes its target from
    /// 0x607A. `cycle` is the nominal time to the next one; if it is not known, the time since the last one counts.
    pub fn synchronize(&mut self, objects: &DriveObjects, cycle: Option<Nanos>) {
        self.modes.synchronize(objects.target_position, cycle);
    }

    /// The saved parameters could not be read at power-up, and the objects have their defaults: fault 0x5530.
    pub const fn parameters_lost(&mut self) {
        self.faults.lose_parameters();
    }

    /// Whether the AL state is OP. Leaving OP while the motor is enabled is a fault.
    pub const fn set_network(&mut self, operational: bool) {
        self.operational = operational;
    }

    /// Whether the motor moves.
    pub const fn is_moving(&self) -> bool {
        !self.motion.is_standing()
    }

    /// The state of the power state machine.
    pub const fn power_state(&self) -> PowerState {
        self.power.state()
    }

    /// The mode of operation, if one was chosen since power-up.
    pub const fn mode(&self) -> Option<Mode> {
        self.modes.active()
    }

    /// The fault that waits to be reset.
    pub const fn fault(&self) -> Option<Fault> {
        self.faults.latched()
    }

    /// What the alarm LED tells.
    pub const fn alarm(&self) -> Alarm {
        self.alarm_led.alarm()
    }

    /// What the alarm LED shows in this tick, for the board to switch it so.
    pub const fn alarm_light(&self) -> Light {
        self.alarm_led.light()
    }

    /// The commanded position, which in open loop is the motor's.
    pub const fn position(&self) -> Position {
        self.motion.position()
    }

    /// The commanded speed.
    pub const fn velocity(&self) -> Speed {
        self.motion.velocity()
    }

    /// The current vector that the last tick has commanded; none while the power stage is off.
    pub const fn current_vector(&self) -> Option<CurrentVector> {
        self.vector
    }

    /// Whether the motor is on and its shaft lock (0x200A) is over.
    pub const fn is_shaft_locked(&self) -> bool {
        self.current.is_locked()
    }

    /// Whether the motor's windings are being identified.
    pub const fn is_identifying(&self) -> bool {
        self.commissioning.is_running()
    }

    /// The motor's windings as identified in the last identification since power-up.
    pub const fn winding(&self) -> Option<Winding> {
        self.commissioning.winding()
    }

    /// The loop that makes this vector's current in the windings.
    pub const fn current_loop(&self) -> &CurrentLoop {
        &self.current_loop
    }

    /// The inputs after filter, polarity and function.
    pub const fn signals(&self) -> &Signals {
        &self.signals
    }

    fn control_power(&mut self, sensors: &Sensors, currents: [f32; 2], controlword: Controlword, objects: &DriveObjects) -> Activity {
        let before = self.power.state();
        let measured = Measured {
            bus_voltage: sensors.bus_voltage,
            operational: self.operational,
            enabled: before.is_enabled(),
            currents: self.fault_of_currents(sensors, currents, objects),
        };
        let fault_detected = self.faults.observe(&measured);
        if fault_detected && self.faults.latched().is_some_and(Fault::is_uncontrolled) {
            self.commissioning.doubt();
        }
        let situation = Situation {
            controlword,
            operational: self.operational,
            fault_detected,
            fault_persists: self.faults.persists(),
            fault_forbids_stop: self.faults.forbids_stop(),
            fault_clear: self.signals.fault_clear,
            emergency_stop: self.signals.emergency_stop,
            standing: self.motion.is_standing() && (self.brake.holds() || !outputs::has_brake(objects)),
        };
        let activity = self.power.tick(&situation, objects);
        if before == PowerState::Fault && self.power.state() != PowerState::Fault {
            self.faults.reset();
        }
        // The motor offline input frees the shaft whatever the state.
        if self.signals.offline { Activity::Off } else { activity }
    }

    /// What the currents of the last tick tell.
    fn fault_of_currents(&mut self, sensors: &Sensors, currents: [f32; 2], objects: &DriveObjects) -> Option<Fault> {
        let met = self.met.take();
        if self.vector.is_none() {
            self.protection.off();
            return met.or(self.commissioning.broken_circuit());
        }
        let due = self.vector.filter(|_| !self.commissioning.is_running());
        self.protection.tick(&View::new(currents, sensors.bus_voltage, due, objects))
    }

    /// Moves the commanded position on and returns the mode's bits of the statusword.
    fn act(&mut self, activity: Activity, controlword: Controlword, objects: &DriveObjects) -> u16 {
        // A motor without current cannot follow.
        let waits = activity == Activity::Operate && self.commissioning.awaits_offsets(objects);
        let activity = if waits { Activity::Off } else { activity };
        let start = !waits && self.power.state() == PowerState::OperationEnabled && self.start_edge.take();
        if activity != Activity::Operate {
            self.modes.interrupt();
        }
        match activity {
            Activity::Operate => {
                let context = Context {
                    objects,
                    controlword,
                    start,
                    signals: &self.signals,
                    locked: self.current.is_locked(),
                };
                return self.modes.operate(&context, &mut self.motion);
            }
            Activity::Stop(stop) => {
                let quick = Acceleration::new(objects.quick_stop_deceleration.unsigned_abs());
                let in_the_way = self.signals.block(self.motion.demand_velocity().sub_pulses_per_tick());
                let quickly = stop == Stop::Quick || in_the_way;
                self.motion.stop(if quickly { quick } else { self.modes.deceleration(objects) });
            }
            Activity::Off => self.motion.rest(),
        }
        let stopped = self.power.state() == PowerState::QuickStopActive && self.motion.is_standing();
        flag(stopped, TARGET_REACHED)
    }

    pub(crate) fn may_clear_position(&self) -> bool {
        let led = self.modes.active() == Some(Mode::CyclicPosition) && self.power.state() == PowerState::OperationEnabled;
        !self.is_moving() && !led
    }

    /// Obeys 0x2010, which may also have been written by PDO, unchecked.
    fn clear_position(&mut self, objects: &mut DriveObjects) {
        if core::mem::take(&mut objects.zero_position) != 0 && self.may_clear_position() {
            self.motion.shift_counter(self.motion.position().pulses().wrapping_neg());
            self.modes.interrupt();
        }
    }

    fn drive_stage(&mut self, activity: Activity, sensors: &Sensors, currents: [f32; 2], objects: &DriveObjects) -> PowerStage {
        self.field.turn(self.motion.travel(), objects.resolution, objects.run_reverse != 0);
        let moving = self.is_moving();
        let stage = if activity == Activity::Off {
            self.switch_off()
        } else {
            self.drive_windings(moving, sensors, currents, objects)
        };
        let leaving = matches!(activity, Activity::Stop(_)) && !moving && self.power.stop_switches_off(objects);
        self.brake.tick(self.current.is_locked(), leaving);
        stage
    }

    fn switch_off(&mut self) -> PowerStage {
        self.current.off();
        self.current_loop.off();
        self.commissioning.off();
        self.vector = None;
        PowerStage::Off
    }

    /// The motor is on: the identification drives it if this is its first time, and otherwise the current loop.
    fn drive_windings(&mut self, moving: bool, sensors: &Sensors, currents: [f32; 2], objects: &DriveObjects) -> PowerStage {
        let angle = self.field.angle();
        let settings = current_loop::Settings::from_objects(objects);
        match self.commissioning.tick(angle, moving, currents, sensors.bus_voltage, objects) {
            Some(Order::Wait) => return PowerStage::Off,
            Some(Order::Fault(fault)) => {
                self.met = Some(fault);
                return self.switch_off();
            }
            Some(Order::Drive(vector, voltage)) => {
                self.current.await_identification(vector.amplitude, objects);
                self.vector = Some(vector);
                let bridge = Bridge::at(sensors.bus_voltage, settings.phases);
                return PowerStage::Legs(bridge.duties(bridge.limited(voltage)));
            }
            Some(Order::TakeOver(vector, voltage)) => self.current_loop.resume(vector, voltage),
            None => (),
        }
        let vector = CurrentVector {
            angle,
            amplitude: self.current.tick(moving, objects),
        };
        self.vector = Some(vector);
        self.current_loop.tick(vector, currents, sensors.bus_voltage, &settings)
    }

    fn is_in_place(&self, mode_bits: u16) -> bool {
        let enabled = self.power.state() == PowerState::OperationEnabled;
        enabled && !self.is_moving() && mode_bits & TARGET_REACHED != 0
    }

    /// Sets the objects that tell about the drive.
    fn publish(&mut self, sensors: &Sensors, currents: [f32; 2], mode_bits: u16, objects: &mut DriveObjects) {
        self.commissioning.publish(objects);
        let state = self.power.state();
        let bus = sensors.bus_voltage;
        objects.statusword = statusword::compose(state, bus, self.operational, self.signals.at_limit(), mode_bits);
        objects.mode_display = self.modes.active().map_or(0, |mode| mode as i8);
        objects.error_code = self.faults.latched().map_or(0, Fault::error_code);
        objects.alarm_code = self.faults.latched().map_or(0, Fault::alarm_bit);
        objects.status_code = self.status_code(mode_bits);

        let resolution = objects.resolution.into();
        objects.position = self.motion.position().pulses();
        objects.velocity = self.motion.velocity().revolutions_per_minute(resolution);
        objects.speed_feedback = objects.velocity.clamp(-3000, 3000) as i16;
        objects.speed_reference = self.motion.demand_velocity().revolutions_per_minute(resolution).clamp(-3000, 3000) as i16;

        objects.digital_inputs = self.signals.digital_inputs();
        objects.input_level = u16::from(sensors.inputs.0 & 0x3F);
        objects.bus_voltage = (bus.0 / 10).clamp(0, 0xFFFF) as u16;
        objects.torque = torque(currents, objects);
    }

    /// The value of 0x200F (manual 2.2.15).
    fn status_code(&self, mode_bits: u16) -> u16 {
        let state = self.power.state();
        let ready = state != PowerState::NotReadyToSwitchOn && !state.is_faulty();
        flag(state == PowerState::OperationEnabled, 0x0001)
            | flag(state.is_faulty(), 0x0002)
            | flag(self.is_in_place(mode_bits), 0x0004)
            | flag(self.is_moving(), 0x0008)
            | flag(self.modes.is_homed(), 0x0010)
            | flag(ready, 0x0020)
    }
}

impl Default for Drive {
    fn default() -> Self {
        Self::new()
    }
}
