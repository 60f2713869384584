//! Motors with a name.
//!
//! Resistance, inductance, holding torque and inertia are those of data sheets. Friction and drag, which no data sheet gives, are estimates: a
//! drag of 2 W (NEMA 17) to 27 W (NEMA 24) at 1000 rpm.

use crate::motor::{MotorParameters, Phases};

/// A motor to be chosen by name.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NamedMotor {
    /// What to type.
    pub name: &'static str,
    /// What it is.
    pub description: &'static str,
    /// Its values.
    pub parameters: MotorParameters,
}

/// All of them.
pub const ALL: [NamedMotor; 8] = [
    NamedMotor {
        name: "17hs4401",
        description: "NEMA 17, 1.7 A: values of its data sheet; friction and drag are estimates",
        parameters: MOTOR_17HS4401,
    },
    NamedMotor {
        name: "as1010",
        description: "NEMA 17, 1 A, Beckhoff",
        parameters: AS1010,
    },
    NamedMotor {
        name: "as1050",
        description: "NEMA 23, 5 A, Beckhoff",
        parameters: AS1050,
    },
    NamedMotor {
        name: "qsh5718-56",
        description: "NEMA 23, 2.8 A, 56 mm, Trinamic; the detent torque is an estimate",
        parameters: QSH5718_56,
    },
    NamedMotor {
        name: "qsh5718-76",
        description: "NEMA 23, 2.8 A, 76 mm, Trinamic; the detent torque is an estimate",
        parameters: QSH5718_76,
    },
    NamedMotor {
        name: "qsh6018-86",
        description: "NEMA 24, 2.8 A, 86 mm, Trinamic; the detent torque is an estimate",
        parameters: QSH6018_86,
    },
    NamedMotor {
        name: "qsh6018-86-4a2",
        description: "NEMA 24, 4.2 A, 86 mm: the QSH6018-86 with another winding",
        parameters: QSH6018_86_4A2,
    },
    NamedMotor {
        name: "three-phase-57",
        description: "Three phases, 57 mm, 5.8 A: an estimate of what is usual in this class, not a certain motor",
        parameters: THREE_PHASE_57,
    },
];

/// NEMA 17, 1.7 A: values of its data sheet; friction and drag are estimates.
pub const MOTOR_17HS4401: MotorParameters = MotorParameters {
    phases: Phases::Two,
    resistance: 1.5,
    inductance: 2.8e-3,
    rated_current: 2.4,
    back_emf: 0.1664,
    detent_torque: 22.0e-3,
    inertia: 54.0e-7,
    friction: 10.0e-3,
    drag: 0.2e-3,
};

/// NEMA 17, 1 A, Beckhoff.
pub const AS1010: MotorParameters = MotorParameters {
    phases: Phases::Two,
    resistance: 4.1,
    inductance: 9.5e-3,
    rated_current: 1.41,
    back_emf: 0.2687,
    detent_torque: 15.0e-3,
    inertia: 56.0e-7,
    friction: 8.0e-3,
    drag: 0.2e-3,
};

/// NEMA 23, 5 A, Beckhoff.
pub const AS1050: MotorParameters = MotorParameters {
    phases: Phases::Two,
    resistance: 0.28,
    inductance: 0.86e-3,
    rated_current: 5.0,
    back_emf: 0.24,
    detent_torque: 52.0e-3,
    inertia: 360.0e-7,
    friction: 20.0e-3,
    drag: 1.0e-3,
};

/// NEMA 23, 2.8 A, 56 mm, Trinamic; the detent torque is an estimate.
#[expect(clippy::approx_constant, reason = "a data sheet's figure that happens to lie near 1 / pi")]
pub const QSH5718_56: MotorParameters = MotorParameters {
    phases: Phases::Two,
    resistance: 0.9,
    inductance: 2.5e-3,
    rated_current: 3.96,
    back_emf: 0.318,
    detent_torque: 40.0e-3,
    inertia: 300.0e-7,
    friction: 20.0e-3,
    drag: 1.2e-3,
};

/// NEMA 23, 2.8 A, 76 mm, Trinamic; the detent torque is an estimate.
pub const QSH5718_76: MotorParameters = MotorParameters {
    phases: Phases::Two,
    resistance: 1.13,
    inductance: 3.6e-3,
    rated_current: 3.96,
    back_emf: 0.477,
    detent_torque: 68.0e-3,
    inertia: 480.0e-7,
    friction: 30.0e-3,
    drag: 1.8e-3,
};

/// NEMA 24, 2.8 A, 86 mm, Trinamic; the detent torque is an estimate.
pub const QSH6018_86: MotorParameters = MotorParameters {
    phases: Phases::Two,
    resistance: 1.5,
    inductance: 6.8e-3,
    rated_current: 3.96,
    back_emf: 0.783,
    detent_torque: 100.0e-3,
    inertia: 840.0e-7,
    friction: 40.0e-3,
    drag: 2.5e-3,
};

/// NEMA 24, 4.2 A, 86 mm: the QSH6018-86 with another winding.
pub const QSH6018_86_4A2: MotorParameters = MotorParameters {
    phases: Phases::Two,
    resistance: 0.65,
    inductance: 3.2e-3,
    rated_current: 5.94,
    back_emf: 0.522,
    detent_torque: 100.0e-3,
    inertia: 840.0e-7,
    friction: 40.0e-3,
    drag: 2.5e-3,
};

/// Three phases, 57 mm, 5.8 A: an estimate of what is usual in this class, not a certain motor.
pub const THREE_PHASE_57: MotorParameters = MotorParameters {
    phases: Phases::Three,
    resistance: 0.65,
    inductance: 1.65e-3,
    rated_current: 5.8,
    back_emf: 0.172,
    detent_torque: 40.0e-3,
    inertia: 480.0e-7,
    friction: 30.0e-3,
    drag: 1.2e-3,
};
