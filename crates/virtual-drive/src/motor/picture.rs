//! The picture of a motor's torque over its speed.

use plotters::prelude::*;

use super::pull_out::{self, Point};
use crate::test_bench::Setup;

const SIZE: (u32, u32) = (1000, 640);
/// Points of the formula's curve.
const CURVE_POINTS: u32 = 400;
const CORNER: RGBColor = RGBColor(150, 150, 220);
const FORMULA: RGBColor = RGBColor(120, 120, 120);
const SIMULATION: RGBColor = RGBColor(214, 39, 40);

/// Draws the formula's curve and the simulated points as SVG.
///
/// # Errors
/// Drawing failed.
pub fn draw(title: &str, setup: &Setup, points: &[Point]) -> anyhow::Result<String> {
    let envelope = pull_out::envelope(setup);
    let fastest = points.iter().map(|point| point.speed).fold(1.0, f64::max);
    let simulated: Vec<(f64, f64)> = points.iter().filter_map(|point| Some((point.speed, point.simulated?))).collect();
    let formula: Vec<(f64, f64)> = (0..=CURVE_POINTS)
        .map(|step| fastest * f64::from(step) / f64::from(CURVE_POINTS))
        .map(|speed| (speed, envelope.torque_at(speed)))
        .filter(|(_, torque)| *torque >= 0.0)
        .collect();
    let most = formula.iter().chain(&simulated).map(|(_, torque)| *torque).fold(1e-3, f64::max) * 1.1;
    let corner = envelope.corner_speed();

    let mut svg = String::new();
    {
        let area = SVGBackend::with_string(&mut svg, SIZE).into_drawing_area();
        area.fill(&WHITE)?;
        let mut chart = ChartBuilder::on(&area)
            .caption(title, ("sans-serif", 22))
            .margin(15)
            .x_label_area_size(45)
            .y_label_area_size(70)
            .build_cartesian_2d(0.0..fastest, 0.0..most)?;
        chart
            .configure_mesh()
            .x_desc("speed in turns/s (times 60: rpm)")
            .y_desc("torque in Nm")
            .light_line_style(WHITE)
            .draw()?;
        chart
            .draw_series(LineSeries::new([(corner, 0.0), (corner, most)], CORNER.stroke_width(1)))?
            .label(format!("corner speed, {corner:.1} turns/s"))
            .legend(|(x, y)| PathElement::new([(x, y), (x + 24, y)], CORNER.stroke_width(1)));
        chart
            .draw_series(LineSeries::new(formula, FORMULA.stroke_width(2)))?
            .label("closed form")
            .legend(|(x, y)| PathElement::new([(x, y), (x + 24, y)], FORMULA.stroke_width(2)));
        chart
            .draw_series(LineSeries::new(simulated.clone(), SIMULATION.stroke_width(2)))?
            .label("simulated: the drive's control law on the motor")
            .legend(|(x, y)| PathElement::new([(x, y), (x + 24, y)], SIMULATION.stroke_width(2)));
        chart.draw_series(simulated.into_iter().map(|place| Circle::new(place, 3, SIMULATION.filled())))?;
        chart
            .configure_series_labels()
            .position(SeriesLabelPosition::UpperRight)
            .background_style(WHITE.mix(0.8))
            .border_style(BLACK)
            .draw()?;
        area.present()?;
    }
    Ok(svg)
}

#[cfg(test)]
mod tests {
    use super::*;
    use plant::motors::QSH5718_56;

    #[test]
    fn a_picture_has_both_curves_and_no_point_for_a_speed_beyond_reach() {
        let setup = Setup::of(&QSH5718_56, 36.0, 3.96);
        let point = |speed, simulated| Point {
            speed,
            envelope: 0.5,
            simulated,
        };
        let points = [point(1.0, Some(1.2)), point(10.0, Some(0.9)), point(50.0, None)];
        let svg = draw("qsh5718-56, 36 V", &setup, &points).unwrap();
        for text in ["qsh5718-56, 36 V", "closed form", "simulated", "torque in Nm"] {
            assert!(svg.contains(text), "{text} is missing");
        }
        assert_eq!(svg.matches("<circle").count(), 2);
    }
}
