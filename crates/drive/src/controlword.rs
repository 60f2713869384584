//! The controlword 0x6040 (manual 2.3.2).

/// A controlword as the master wrote it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Controlword(pub u16);

/// What bits 0 to 3 and 7 ask of the power state machine (manual 2.3.2, table of commands).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Command {
    /// x110: to Ready To Switch On.
    Shutdown,
    /// 0111: to Switched On; from Operation Enabled the same bits are called Disable Operation.
    SwitchOn,
    /// 1111: to Operation Enabled.
    EnableOperation,
    /// xx0x: power off at once.
    DisableVoltage,
    /// x01x: quick stop.
    QuickStop,
}

impl Controlword {
    /// The command; none while bit 7 is set, which belongs to no command but the fault reset.
    pub const fn command(self) -> Option<Command> {
        if self.fault_reset() {
            return None;
        }
        Some(match self.0 & 0x000F {
            bits if bits & 0b0010 == 0 => Command::DisableVoltage,
            bits if bits & 0b0100 == 0 => Command::QuickStop,
            bits if bits & 0b0001 == 0 => Command::Shutdown,
            0b1111 => Command::EnableOperation,
            _ => Command::SwitchOn,
        })
    }

    /// Bit 3, which a command to enable has.
    pub const fn enable_operation(self) -> bool {
        self.bit(3)
    }

    /// Bit 4: new set-point in PP, start in homing; it acts by its rising edge.
    pub const fn start(self) -> bool {
        self.bit(4)
    }

    /// Bit 5 in PP: the new set-point replaces the one under way.
    pub const fn change_immediately(self) -> bool {
        self.bit(5)
    }

    /// Bit 6 in PP: the target is relative.
    pub const fn relative(self) -> bool {
        self.bit(6)
    }

    /// Bit 7; it acts by its rising edge.
    pub const fn fault_reset(self) -> bool {
        self.bit(7)
    }

    /// Bit 8: stop and stay enabled.
    pub const fn halt(self) -> bool {
        self.bit(8)
    }

    /// Bit 9 in PP: run through the set-point under way to the new one without a stop.
    pub const fn change_on_set_point(self) -> bool {
        self.bit(9)
    }

    const fn bit(self, number: u8) -> bool {
        self.0 >> number & 1 == 1
    }
}

/// Watches bit 4 for a rising edge that has not acted yet.
///
/// An edge in the controlword that enables counts too and waits for Operation Enabled: the manual starts a PP motion by 0x001F
/// (manual 2.4.2). It is forgotten when bit 4 or bit 3 falls.
#[derive(Clone, Copy, Debug, Default)]
pub struct StartEdge {
    previous: bool,
    pending: bool,
}

impl StartEdge {
    /// Takes the controlword of a tick.
    pub const fn observe(&mut self, controlword: Controlword) {
        let start = controlword.start();
        if !start || !controlword.enable_operation() {
            self.pending = false;
        } else if !self.previous {
            self.pending = true;
        }
        self.previous = start;
    }

    /// Whether there is an edge to act on; it acts once.
    pub const fn take(&mut self) -> bool {
        core::mem::replace(&mut self.pending, false)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_edge_acts_once_and_waits_for_the_state_to_follow_the_same_controlword() {
        let mut edge = StartEdge::default();
        for word in [0x06, 0x1F, 0x1F] {
            edge.observe(Controlword(word));
        }
        assert!(edge.take());
        edge.observe(Controlword(0x1F));
        assert!(!edge.take());
    }

    #[test]
    fn an_edge_before_the_enable_command_or_taken_back_does_not_act() {
        let mut edge = StartEdge::default();
        for word in [0x06, 0x16, 0x1F] {
            edge.observe(Controlword(word));
        }
        assert!(!edge.take());
        for word in [0x0F, 0x1F, 0x0F] {
            edge.observe(Controlword(word));
        }
        assert!(!edge.take());
    }
}
