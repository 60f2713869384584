//! The first resonance and the harmonic against it.

use crate::axis::Axis;

/// Root mean square of the speed's deviation as a share of the speed, with a tenth of the holding torque as the load.
fn ripple(name: &str, speed: f64, [amplitude, phase_a, phase_b]: [u16; 3]) -> f64 {
    let mut axis = Axis::with_inertia(crate::motor(name), 24.0, 0.0);
    axis.objects.harmonic_amplitude = amplitude;
    axis.objects.harmonic_phase_a = phase_a;
    axis.objects.harmonic_phase_b = phase_b;
    axis.enable();
    axis.load = 0.1 * axis.motor.holding_torque(axis.motor.rated_current);
    axis.run_at(speed, 1.0);
    axis.seconds(1.0);
    let wanted = speed * std::f64::consts::TAU;
    let sum: f64 = (0..10_000)
        .map(|_| {
            axis.tick();
            (axis.state().speed / wanted - 1.0).powi(2)
        })
        .sum();
    (sum / 10_000.0).sqrt()
}

// manual: 2.2.26/harmonic 2.2.27/phase 2.2.28/phase
#[test]
fn the_harmonic_quiets_the_first_resonance() {
    for (name, speed, registers) in [("17hs4401", 1.531, [58, 504, 4]), ("as1050", 0.99, [44, 492, 1_004])] {
        let before = ripple(name, speed, [0; 3]);
        let after = ripple(name, speed, registers);
        assert!(before > 0.1, "{name} resonates: {before:.4}");
        assert!(after < before / 20.0, "{name}: {before:.4} to {after:.4}");
    }
}
