//! The picture of before and after: the speed over time at the resonance, and the ripple over the speed.

use plotters::coord::Shift;
use plotters::prelude::*;

use super::{Comparison, Ripple, Tuning};
use crate::curves::{self, Curve};

const SIZE: (u32, u32) = (1000, 1000);
const BEFORE: RGBColor = RGBColor(214, 39, 40);
const AFTER: RGBColor = RGBColor(31, 119, 180);
const NAMES: [&str; 2] = ["before", "after"];

/// A curve's points.
type Points = Vec<(f64, f64)>;

/// What a chart shows.
struct Chart {
    title: String,
    axes: [&'static str; 2],
    /// Before and after.
    curves: [Points; 2],
    /// Where a line stands upright.
    mark: Option<f64>,
}

/// Draws the picture as SVG.
///
/// # Errors
/// Drawing failed.
pub fn draw(title: &str, tuning: &Tuning) -> anyhow::Result<String> {
    let mut svg = String::new();
    {
        let area = SVGBackend::with_string(&mut svg, SIZE).into_drawing_area();
        area.fill(&WHITE)?;
        let area = area.titled(title, ("sans-serif", 20))?;
        let (upper, lower) = area.split_vertically(SIZE.1 / 2);
        courses(tuning).draw(&upper)?;
        ripples(tuning).draw(&lower)?;
        area.present()?;
    }
    Ok(svg)
}

fn courses(tuning: &Tuning) -> Chart {
    let in_milliseconds = |course: &Points| course.iter().map(|(time, speed)| (time * 1e3, *speed)).collect();
    Chart {
        title: format!(
            "Speed at the first resonance, {:.3} turns/s: ripple {} before, {} after",
            tuning.resonance.conditions.speed, tuning.resonance.before, tuning.resonance.after
        ),
        axes: ["time in ms", "speed in turns/s"],
        curves: tuning.courses.each_ref().map(in_milliseconds),
        mark: None,
    }
}

fn ripples(tuning: &Tuning) -> Chart {
    let curve = |ripple: fn(&Comparison) -> Ripple| {
        let points = tuning
            .speeds
            .iter()
            .map(|comparison| (comparison.conditions.speed, ripple(comparison).0 * 100.0));
        points.filter(|(_, percent)| percent.is_finite()).collect()
    };
    Chart {
        title: "Ripple of the speed, root mean square, with the same values at other speeds".into(),
        axes: ["speed in turns/s", "ripple in % of the speed"],
        curves: [curve(|comparison| comparison.before), curve(|comparison| comparison.after)],
        mark: Some(tuning.resonance.conditions.speed),
    }
}

impl Chart {
    fn draw(&self, area: &DrawingArea<SVGBackend<'_>, Shift>) -> anyhow::Result<()> {
        let all = || self.curves.iter().flatten();
        let (left, right) = range(all().map(|point| point.0));
        let (low, high) = range(all().map(|point| point.1).chain([0.0]));
        let margin = 0.05 * (high - low);
        let mut chart = ChartBuilder::on(area)
            .caption(&self.title, ("sans-serif", 18))
            .margin(12)
            .x_label_area_size(40)
            .y_label_area_size(60)
            .build_cartesian_2d(left..right, low - margin..high + margin)?;
        let [horizontal, vertical] = self.axes;
        chart
            .configure_mesh()
            .x_desc(horizontal)
            .y_desc(vertical)
            .light_line_style(WHITE)
            .draw()?;
        if let Some(mark) = self.mark {
            let style = RGBColor(200, 200, 200).stroke_width(1);
            chart.draw_series(LineSeries::new([(mark, low), (mark, high)], style))?;
        }
        let curves = self.curves.iter().zip(NAMES).zip([BEFORE, AFTER]);
        let curves: Vec<Curve> = curves
            .map(|((points, name), color)| Curve {
                name,
                color,
                width: 2,
                points: points.clone(),
            })
            .collect();
        curves::draw(&mut chart, &curves)
    }
}

/// Least and greatest of some values, a little apart at least.
fn range(values: impl Iterator<Item = f64>) -> (f64, f64) {
    let (low, high) = values.fold((f64::MAX, f64::MIN), |(low, high), value| (low.min(value), high.max(value)));
    (low, high.max(low + 1e-3))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tuning::vibration::Values;
    use crate::tuning::vibration::experiment::Conditions;

    #[test]
    fn a_picture_has_both_charts_with_before_and_after() {
        let at = |speed, before| Comparison {
            conditions: Conditions { speed, load_torque: 0.1 },
            before,
            after: Ripple(0.01),
        };
        let tuning = Tuning {
            values: Values::NONE,
            resonance: at(1.138, Ripple(0.5)),
            expected_speed: 1.15,
            experiments: 100,
            loads: Vec::new(),
            speeds: vec![at(0.5, Ripple(0.2)), at(1.138, Ripple::OUT_OF_STEP), at(1.5, Ripple(0.1))],
            courses: [vec![(0.0, 1.0), (0.001, 1.4)], Vec::new()],
        };
        let svg = draw("a motor & its load", &tuning).unwrap();
        for text in [
            "a motor &amp; its load",
            "1.138 turns/s",
            "50.00 % before",
            "time in ms",
            "ripple in %",
            "after",
        ] {
            assert!(svg.contains(text), "{text} is missing");
        }
        assert!(!svg.contains("inf") && !svg.contains("NaN"));
    }
}
