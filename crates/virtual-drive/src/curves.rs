//! Curves with a legend, as every picture of the program has them.

use plotters::coord::types::RangedCoordf64;
use plotters::prelude::*;

/// A chart with a plain scale both ways.
pub(crate) type Plane<'a, 'b> = ChartContext<'a, SVGBackend<'b>, Cartesian2d<RangedCoordf64, RangedCoordf64>>;

/// A curve: name, colour, width, points.
pub(crate) struct Curve {
    pub name: &'static str,
    pub color: RGBColor,
    pub width: u32,
    pub points: Vec<(f64, f64)>,
}

/// Draws curves over what is in the chart already, and the legend.
///
/// # Errors
/// Drawing failed.
pub(crate) fn draw<'a, 'b: 'a>(chart: &mut Plane<'a, 'b>, curves: &[Curve]) -> anyhow::Result<()> {
    for curve in curves {
        let style = curve.color.stroke_width(curve.width);
        chart
            .draw_series(LineSeries::new(curve.points.iter().copied(), style))?
            .label(curve.name)
            .legend(move |(x, y)| PathElement::new([(x, y), (x + 24, y)], style));
    }
    chart
        .configure_series_labels()
        .background_style(WHITE.mix(0.8))
        .border_style(RGBColor(200, 200, 200))
        .draw()?;
    Ok(())
}
