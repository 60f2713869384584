//! Values of the drive's objects that are found by experiment on a virtual drive.
//!
//! | module | finds |
//! |---|---|
//! | [`vibration`] | the harmonic against the first resonance, 0x2060 to 0x2062 |

pub mod vibration;
