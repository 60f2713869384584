//! The picture of a demonstration: commanded and actual position and velocity, lag, torque in reserve, currents and bus over time.

use plotters::coord::Shift;
use plotters::prelude::*;

use super::samples::{Phase, Sample, Samples};
use crate::curves::{self, Curve};

const SIZE: (u32, u32) = (1200, 2250);
/// Velocities are taken over this many cycles, so that whole pulses a cycle do not show as steps.
const VELOCITY_WINDOW: usize = 8;

const BLUE_INK: RGBColor = RGBColor(31, 119, 180);
const RED_INK: RGBColor = RGBColor(214, 39, 40);

/// Draws the picture as SVG.
///
/// # Errors
/// There is nothing to draw, or drawing failed.
pub fn draw(samples: &Samples) -> anyhow::Result<String> {
    anyhow::ensure!(samples.cycles.len() > VELOCITY_WINDOW, "there are too few samples for a picture");
    let mut svg = String::new();
    {
        let area = SVGBackend::with_string(&mut svg, SIZE).into_drawing_area();
        area.fill(&WHITE)?;
        let charts = [
            ("Position", "pulses", positions(samples)),
            ("Velocity", "pulses/s", velocities(samples)),
            ("Lag of the shaft behind the field", "electrical degrees", lags(samples)),
            ("Torque in reserve", "% of the pull-out torque", reserves(samples)),
            ("Currents", "A", currents(samples)),
            ("Voltage at the power stage", "V", voltages(samples)),
        ];
        for (area, (title, unit, curves)) in area.split_evenly((charts.len(), 1)).iter().zip(&charts) {
            chart(area, title, unit, curves)?;
        }
        area.present()?;
    }
    Ok(svg)
}

fn seconds(samples: &Samples, sample: &Sample) -> f64 {
    sample.time.since(samples.cycles[0].time) as f64 / 1e9
}

fn curve(samples: &Samples, name: &'static str, color: RGBColor, width: u32, value: impl Fn(&Sample) -> Option<f64>) -> Curve {
    let points = samples
        .cycles
        .iter()
        .filter_map(|sample| Some((seconds(samples, sample), value(sample)?)))
        .collect();
    Curve {
        name,
        color,
        width,
        points,
    }
}

fn positions(samples: &Samples) -> Vec<Curve> {
    vec![
        curve(samples, "target from the master (0x607A)", RGBColor(160, 160, 160), 5, |sample| {
            sample.target.map(f64::from)
        }),
        curve(samples, "commanded by the drive (0x6064)", BLUE_INK, 3, |sample| {
            Some(f64::from(sample.commanded))
        }),
        curve(samples, "actual, of the motor shaft", RED_INK, 1, |sample| {
            Some(samples.shaft_from_home(sample))
        }),
    ]
}

fn velocities(samples: &Samples) -> Vec<Curve> {
    let [_, commanded, shaft]: [Curve; 3] = positions(samples)
        .try_into()
        .unwrap_or_else(|_| unreachable!("there are three positions"));
    [commanded, shaft].map(derivative).into()
}

/// Beyond 90 degrees the motor falls out of step; each period lost after homing adds 360.
fn lags(samples: &Samples) -> Vec<Curve> {
    let lost_before = samples.of(Phase::Homing).last().map_or(0, |sample| sample.motor.lost_periods);
    vec![curve(
        samples,
        "lag; all torque at 90, a lost period is 360",
        RED_INK,
        1,
        |sample| {
            let periods = (sample.motor.lost_periods - lost_before) as f64 + sample.motor.lag;
            Some(periods * 360.0)
        },
    )]
}

fn reserves(samples: &Samples) -> Vec<Curve> {
    vec![curve(samples, "at this speed, current and voltage", BLUE_INK, 1, |sample| {
        sample.motor.torque_reserve.map(|reserve| reserve * 100.0)
    })]
}

fn voltages(samples: &Samples) -> Vec<Curve> {
    vec![curve(samples, "bus", RGBColor(40, 40, 40), 1, |sample| {
        Some(sample.motor.bus_voltage)
    })]
}

fn currents(samples: &Samples) -> Vec<Curve> {
    vec![
        curve(samples, "winding A", BLUE_INK, 1, |sample| Some(sample.motor.currents[0])),
        curve(samples, "winding B", RED_INK, 1, |sample| Some(sample.motor.currents[1])),
        curve(samples, "out of the supply", RGBColor(40, 40, 40), 2, |sample| {
            Some(sample.motor.supply_current)
        }),
    ]
}

/// The velocity of a position. Jumps of the position counter, as homing sets it, leave a gap.
fn derivative(position: Curve) -> Curve {
    const JUMP: f64 = 2_000.0;
    let steady = |window: &&[(f64, f64)]| window.windows(2).all(|pair| (pair[1].1 - pair[0].1).abs() < JUMP);
    let slope = |window: &[(f64, f64)]| {
        let (first, last) = (window[0], window[window.len() - 1]);
        let middle = (first.0 + last.0) / 2.0;
        (middle, (last.1 - first.1) / (last.0 - first.0).max(1e-6))
    };
    Curve {
        points: position.points.windows(VELOCITY_WINDOW).filter(steady).map(slope).collect(),
        ..position
    }
}

fn chart(area: &DrawingArea<SVGBackend, Shift>, title: &str, unit: &str, drawn: &[Curve]) -> anyhow::Result<()> {
    let all = || drawn.iter().flat_map(|curve| &curve.points);
    let end = all().map(|point| point.0).fold(0.0, f64::max);
    let (low, high) = all().fold((f64::MAX, f64::MIN), |(low, high), point| (low.min(point.1), high.max(point.1)));
    let margin = ((high - low) * 0.05).max(1.0);
    let mut chart = ChartBuilder::on(area)
        .caption(title, ("sans-serif", 22))
        .margin(12)
        .x_label_area_size(36)
        .y_label_area_size(80)
        .build_cartesian_2d(0.0..end, low - margin..high + margin)?;
    chart
        .configure_mesh()
        .x_desc("time in OP, s")
        .y_desc(unit)
        .light_line_style(WHITE)
        .draw()?;
    curves::draw(&mut chart, drawn)
}
