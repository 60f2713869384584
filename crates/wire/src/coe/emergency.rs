//! Emergency messages (ETG.1000.6, emergency; error codes by CiA 301 and CiA 402).

/// Bytes of an emergency message after the CoE header.
pub const SIZE: usize = 8;

/// An error that has come, or with code 0 that all errors are gone.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Emergency {
    /// The error code, 0 for "error reset".
    pub code: u16,
    /// The error register, 0x1001.
    pub register: u8,
    /// Data of the manufacturer's choice.
    pub vendor: [u8; 5],
}

impl Emergency {
    /// The message as it crosses the wire.
    pub const fn bytes(&self) -> [u8; SIZE] {
        let [low, high] = self.code.to_le_bytes();
        let [v0, v1, v2, v3, v4] = self.vendor;
        [low, high, self.register, v0, v1, v2, v3, v4]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_emergency_is_laid_out_as_masters_read_it() {
        let emergency = Emergency {
            code: 0x3110,
            register: 0x05,
            vendor: [4, 0, 0, 0, 1],
        };
        assert_eq!(emergency.bytes(), [0x10, 0x31, 0x05, 4, 0, 0, 0, 1]);
    }
}
