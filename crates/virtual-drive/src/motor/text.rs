//! A motor's file from its values: to begin one of one's own with.

use plant::Phases;

use super::Motor;
use super::quantity::{
    BACK_EMF, DETENT_TORQUE, DRAG, FRICTION, INDUCTANCE, LOAD_INERTIA, PEAK_CURRENT, QUANTITIES, RESISTANCE, ROTOR_INERTIA, SUPPLY_VOLTAGE,
};

/// The file of a motor.
pub fn of(motor: &Motor) -> String {
    let values = &motor.parameters;
    let phases = match values.phases {
        Phases::Two => 2,
        Phases::Three => 3,
    };
    let mut lines = vec![
        format!("name = {}", quoted(&motor.name)),
        format!("description = {}", quoted(&motor.description)),
        "\n[motor]".to_owned(),
        format!("phases = {phases}"),
    ];
    lines.extend(
        [
            (RESISTANCE, values.resistance),
            (INDUCTANCE, values.inductance),
            (PEAK_CURRENT, values.rated_current),
            (BACK_EMF, values.back_emf),
            (DETENT_TORQUE, values.detent_torque),
            (ROTOR_INERTIA, values.inertia),
            (FRICTION, values.friction),
            (DRAG, values.drag),
        ]
        .map(|(index, value)| line(index, value)),
    );
    if let Some(inertia) = motor.load_inertia {
        lines.extend(["\n[load]".to_owned(), line(LOAD_INERTIA, inertia)]);
    }
    if let Some(volts) = motor.supply {
        lines.extend(["\n[supply]".to_owned(), line(SUPPLY_VOLTAGE, volts)]);
    }
    lines.join("\n") + "\n"
}

/// A line in the quantity's usual unit, to twelve digits: what the change of units leaves behind them is not the motor's.
fn line(index: usize, value: f64) -> String {
    let quantity = &QUANTITIES[index];
    let number = value / quantity.units[0].factor;
    let rounded: f64 = format!("{number:.11e}").parse().unwrap_or(number);
    format!("{} = {rounded:?}", quantity.usual_key())
}

/// A text within quotation marks.
fn quoted(text: &str) -> String {
    format!("\"{}\"", text.replace('\\', "\\\\").replace('"', "\\\""))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motor::file;
    use plant::motors::ALL;

    #[test]
    fn what_is_written_reads_as_the_same_motor() {
        for named in &ALL {
            let mut motor = Motor::from(named);
            motor.description = "with \"quotes\" and \\".to_owned();
            (motor.load_inertia, motor.supply) = (Some(1e-4), Some(24.0));
            let read = file::parse(&of(&motor)).unwrap();
            let (found, wanted) = (read.parameters, motor.parameters);
            assert_eq!(
                (&read.name, &read.description, found.phases),
                (&motor.name, &motor.description, wanted.phases)
            );
            let pairs = [
                (found.resistance, wanted.resistance),
                (found.inductance, wanted.inductance),
                (found.rated_current, wanted.rated_current),
                (found.back_emf, wanted.back_emf),
                (found.detent_torque, wanted.detent_torque),
                (found.inertia, wanted.inertia),
                (found.friction, wanted.friction),
                (found.drag, wanted.drag),
                (read.load_inertia.unwrap(), 1e-4),
                (read.supply.unwrap(), 24.0),
            ];
            assert!(
                pairs.iter().all(|(a, b)| (a / b - 1.0).abs() < 1e-11),
                "{}:\n{}",
                motor.name,
                of(&motor)
            );
        }
    }
}
