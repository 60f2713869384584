//! What the drive says of itself in one tick agrees with itself.

use board::PowerStage;
use drive::{Mode, PowerState};

use super::{Verdict, View, must};

/// Bits 0 to 3, 5 and 6 of the statusword.
const STATE_BITS: u16 = 0x006F;

/// The mode display follows 0x6060 where that names a mode.
#[derive(Clone, Debug, Default)]
pub struct Modes {
    display: i8,
}

impl Modes {
    /// Looks at a tick.
    ///
    /// # Errors
    /// What does not hold.
    pub fn tick(&mut self, view: &View) -> Verdict {
        if [1, 3, 6, 8].contains(&view.objects.mode) {
            self.display = view.objects.mode;
        }
        must(view.objects.mode_display == self.display, || {
            format!("6061 = {}, not {}", view.objects.mode_display, self.display)
        })?;
        must(view.mode.map_or(0, |mode| mode as i8) == self.display, || {
            "mode and 6061 differ".into()
        })
    }
}

/// Checks everything else.
///
/// # Errors
/// What does not hold.
pub fn check(view: &View) -> Verdict {
    statusword(view)?;
    mode_bits(view)?;
    faults(view)?;
    status_code(view)?;
    outputs(view)
}

/// The standard's masks and the bits that do not depend on the mode.
fn statusword(view: &View) -> Verdict {
    let word = view.objects.statusword;
    let expected = match view.state {
        PowerState::NotReadyToSwitchOn => 0x00,
        PowerState::SwitchOnDisabled => 0x40,
        PowerState::ReadyToSwitchOn => 0x21,
        PowerState::SwitchedOn => 0x23,
        PowerState::OperationEnabled => 0x27,
        PowerState::QuickStopActive => 0x07,
        PowerState::FaultReactionActive => 0x0F,
        PowerState::Fault => 0x08,
    };
    must(word & STATE_BITS == expected, || {
        format!("statusword {word:04X} in {}", view.state.name())
    })?;
    let millivolts = view.sensors.bus_voltage.0;
    let switches = view.signals.switches;
    let bits = [
        (4, (18_000..=50_000).contains(&millivolts)),
        (9, view.operational),
        (11, switches.positive_limit || switches.negative_limit),
        (7, false),
        (8, false),
        (14, false),
        (15, false),
    ];
    for (bit, expected) in bits {
        must(view.status(bit) == expected, || {
            format!("statusword {word:04X}: bit {bit} is not {expected}")
        })?;
    }
    Ok(())
}

/// Bits 10, 12 and 13, whose meaning is the mode's.
fn mode_bits(view: &View) -> Verdict {
    let word = view.objects.statusword;
    let (reached, twelve, thirteen) = (view.status(10), view.status(12), view.status(13));
    let standing = !view.is_moving();
    let holds = match (view.state, view.mode) {
        (PowerState::OperationEnabled, _) if view.signals.offline => !twelve && !thirteen && !reached,
        (PowerState::OperationEnabled, Some(Mode::ProfilePosition)) => !thirteen && (!reached || standing),
        (PowerState::OperationEnabled, Some(Mode::ProfileVelocity)) => !thirteen,
        (PowerState::OperationEnabled, Some(Mode::Homing)) => !(twelve && thirteen) && (!reached || standing),
        (PowerState::OperationEnabled, Some(Mode::CyclicPosition)) => !thirteen && (twelve == reached),
        (PowerState::QuickStopActive, _) => !twelve && !thirteen && (reached == standing),
        _ => !twelve && !thirteen && !reached,
    };
    must(holds, || {
        let mode = view.mode.map_or("none", Mode::name);
        format!("statusword {word:04X} in {}, mode {mode}, standing: {standing}", view.state.name())
    })
}

/// 0x603F and 0x200E (manual 2.3.1, 2.2.14).
fn faults(view: &View) -> Verdict {
    let (error, alarm) = (view.objects.error_code, view.objects.alarm_code);
    let is_faulty = matches!(view.state, PowerState::FaultReactionActive | PowerState::Fault);
    must(is_faulty == (error != 0), || format!("603F = {error:04X} in {}", view.state.name()))?;
    let expected = match error {
        0 | 0x7500 | 0x5530 => Some((0x0000, if error == 0x7500 { 0x11 } else { (error != 0).into() })),
        0x7122 => Some((0x0000, 0x01)),
        0x2211 => Some((0x0002, 0x03)),
        0x3150 | 0x3151 | 0x3210 => Some((0x0001, 0x05)),
        0x3110 => Some((0x0004, 0x05)),
        _ => None,
    };
    let register = view.drive.device().drive().fault().map_or(0, |fault| fault.error_register());
    must(expected == Some((alarm, register)), || {
        format!("603F = {error:04X} with 200E = {alarm:04X} and 1001 = {register:02X}")
    })
}

/// 0x200F (manual 2.2.15).
fn status_code(view: &View) -> Verdict {
    let code = view.objects.status_code;
    let is_faulty = matches!(view.state, PowerState::FaultReactionActive | PowerState::Fault);
    let bits = [
        (0, view.state == PowerState::OperationEnabled),
        (1, is_faulty),
        (3, view.is_moving()),
        (5, !is_faulty && view.state != PowerState::NotReadyToSwitchOn),
    ];
    for (bit, expected) in bits {
        must((code >> bit & 1 != 0) == expected, || {
            format!("200F = {code:04X}: bit {bit} is not {expected}")
        })?;
    }
    let in_place = code >> 2 & 1 != 0;
    must(!in_place || view.status(10) && !view.is_moving(), || {
        format!("200F = {code:04X}: in place without a target reached")
    })?;
    must(code >> 6 == 0, || format!("200F = {code:04X} has bits without a meaning"))
}

/// The outputs by function and polarity, and 0x204A (manual 2.2.5, 2.2.6, 2.2.23, 2.3.24).
fn outputs(view: &View) -> Verdict {
    let objects = view.objects;
    let conducts = view.actuators.outputs.0;
    must(objects.output_level == u16::from(!conducts & 3), || {
        format!("204A = {:04X} while {conducts:02b} conduct", objects.output_level)
    })?;
    let functions = [objects.output_1_function, objects.output_2_function];
    for (number, function) in functions.into_iter().enumerate() {
        let normally_open = objects.output_polarity >> number & 1 != 0;
        let active = (conducts >> number & 1 != 0) == normally_open;
        let expected = match function {
            1 => Some(matches!(view.state, PowerState::FaultReactionActive | PowerState::Fault)),
            // The brake opens some time after the power stage is on, and closes with it.
            2 if view.actuators.stage == PowerStage::Off => Some(false),
            2 => None,
            3 => Some(objects.status_code >> 2 & 1 != 0),
            _ => Some((objects.physical_outputs & objects.output_mask) >> (16 + number) & 1 != 0),
        };
        must(expected.is_none_or(|expected| expected == active), || {
            format!("OUT{} of function {function} is active: {active}", number + 1)
        })?;
    }
    Ok(())
}
