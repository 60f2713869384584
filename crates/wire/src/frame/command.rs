//! Commands of datagrams (ETG.1000.4, 5.4.1).

/// What a datagram asks of the slaves it passes (ETG.1000.4, 5.4.1).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Command {
    /// No operation.
    Nop,
    /// Auto increment physical read.
    Aprd,
    /// Auto increment physical write.
    Apwr,
    /// Auto increment physical read and write.
    Aprw,
    /// Configured address physical read.
    Fprd,
    /// Configured address physical write.
    Fpwr,
    /// Configured address physical read and write.
    Fprw,
    /// Broadcast read.
    Brd,
    /// Broadcast write.
    Bwr,
    /// Broadcast read and write.
    Brw,
    /// Logical memory read.
    Lrd,
    /// Logical memory write.
    Lwr,
    /// Logical memory read and write.
    Lrw,
    /// Auto increment physical read, multiple write.
    Armw,
    /// Configured address physical read, multiple write.
    Frmw,
    /// A code that no slave knows; treated as no operation.
    Unknown(u8),
}

impl Command {
    /// The known commands, in the order of their codes.
    pub const ALL: [Self; 15] = [
        Self::Nop,
        Self::Aprd,
        Self::Apwr,
        Self::Aprw,
        Self::Fprd,
        Self::Fpwr,
        Self::Fprw,
        Self::Brd,
        Self::Bwr,
        Self::Brw,
        Self::Lrd,
        Self::Lwr,
        Self::Lrw,
        Self::Armw,
        Self::Frmw,
    ];
}

impl From<u8> for Command {
    fn from(code: u8) -> Self {
        Self::ALL.get(usize::from(code)).copied().unwrap_or(Self::Unknown(code))
    }
}

impl From<Command> for u8 {
    fn from(command: Command) -> Self {
        match command {
            Command::Nop => 0,
            Command::Aprd => 1,
            Command::Apwr => 2,
            Command::Aprw => 3,
            Command::Fprd => 4,
            Command::Fpwr => 5,
            Command::Fprw => 6,
            Command::Brd => 7,
            Command::Bwr => 8,
            Command::Brw => 9,
            Command::Lrd => 10,
            Command::Lwr => 11,
            Command::Lrw => 12,
            Command::Armw => 13,
            Command::Frmw => 14,
            Command::Unknown(code) => code,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn command_codes_survive_the_round_trip() {
        for code in 0..=255u8 {
            assert_eq!(u8::from(Command::from(code)), code);
        }
        assert_eq!(Command::from(14), Command::Frmw);
        assert_eq!(Command::from(15), Command::Unknown(15));
    }
}
