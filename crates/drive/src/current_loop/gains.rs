//! The gains of the current loop in volt and ampere (manual 2.2.11).

use crate::objects::DriveObjects;

/// Most of the excess that back-calculation takes off the integrator in one tick. More than 1 would turn its sign and not settle.
const MOST_TRACKING: f32 = 1.0;

/// Gains of the two PI regulators.
///
/// The registers are fixed-point numbers: 0x200B:02 in 1/256 V/A, 0x200B:03 in 1/1024 V/A per tick, 0x200B:04 in 1/256 of the loop's own
/// integration time. With these scales the values at delivery, 1000 and 200, cancel the pole of a winding of 1 ohm and 1 mH, the values
/// at delivery of 0x200C, exactly; in general the gains for a winding are its inductance in microhenry and a fifth of its resistance in
/// milliohm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gains {
    /// Volt for an ampere of error.
    pub proportional: f32,
    /// Volt for an ampere of error, each tick.
    pub integral: f32,
    /// Share of the voltage beyond the limit that is taken off the integrator each tick.
    pub tracking: f32,
}

impl Gains {
    /// The gains that 0x200B:02 to 04 hold.
    pub fn from_objects(objects: &DriveObjects) -> Self {
        let proportional = f32::from(objects.current_loop_kp.max(1)) / 256.0;
        let integral = f32::from(objects.current_loop_ki) / 1024.0;
        let tracking = f32::from(objects.current_loop_kc) / 256.0 * integral / proportional;
        Self {
            proportional,
            integral,
            tracking: tracking.min(MOST_TRACKING),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn at_delivery_the_pole_of_one_ohm_and_one_millihenry_is_cancelled() {
        let gains = Gains::from_objects(&DriveObjects::new());
        assert_eq!((gains.proportional, gains.integral), (3.906_25, 0.195_312_5));
        // R Ts / L.
        assert!((gains.integral / gains.proportional - 1.0 * 50e-6 / 1e-3).abs() < 1e-8);
        assert_eq!(gains.tracking, 0.05);
    }

    #[test]
    fn tracking_never_overshoots_at_the_ends_of_the_ranges() {
        let mut objects = DriveObjects::new();
        (objects.current_loop_kp, objects.current_loop_ki, objects.current_loop_kc) = (100, 10_000, 1_024);
        assert_eq!(Gains::from_objects(&objects).tracking, 1.0);
        objects.current_loop_kp = 0;
        assert!(Gains::from_objects(&objects).proportional > 0.0);
    }
}
