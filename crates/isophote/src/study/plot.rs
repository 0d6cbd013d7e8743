//! Plots on logarithmic axes, as SVG.

use anyhow::{Result, anyhow};
use plotters::prelude::*;

/// Size of a plot, pixels.
const SIZE: (u32, u32) = (560, 380);

/// Colours of the series, told apart by those who see fewer (Okabe and Ito, 2008).
const COLOURS: [RGBColor; 7] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(230, 159, 0),
    RGBColor(86, 180, 233),
    RGBColor(0, 0, 0),
];

/// A named line of points.
#[derive(Debug, Clone)]
pub struct Series {
    /// What the legend says.
    pub name: String,
    /// (x, y); those that a logarithm does not take are left out.
    pub points: Vec<(f64, f64)>,
}

/// What a plot shows.
#[derive(Debug, Clone)]
pub struct Plot {
    /// Above it.
    pub title: &'static str,
    /// Along the axes.
    pub axes: [&'static str; 2],
    /// Its lines.
    pub series: Vec<Series>,
    /// Where the legend has room.
    pub legend: SeriesLabelPosition,
}

/// The plot as an SVG element; `None` where no point can be shown.
///
/// # Errors
/// Where it cannot be drawn.
pub fn svg(plot: &Plot) -> Result<Option<String>> {
    let shown = |point: &(f64, f64)| point.0 > 0.0 && point.1 > 0.0 && point.0.is_finite() && point.1.is_finite();
    let points = |series: &Series| -> Vec<(f64, f64)> {
        let mut points: Vec<(f64, f64)> = series.points.iter().copied().filter(shown).collect();
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        points
    };
    let all: Vec<(f64, f64)> = plot.series.iter().flat_map(points).collect();
    if all.is_empty() {
        return Ok(None);
    }
    let range = |of: fn(&(f64, f64)) -> f64| {
        let ends = all.iter().map(of).fold((f64::MAX, 0.0f64), |(low, high), x| (low.min(x), high.max(x)));
        (ends.0 / 1.5)..(ends.1 * 1.5)
    };
    let mut text = String::new();
    draw(plot, &mut text, points, [range(|p| p.0), range(|p| p.1)])
        .map_err(|error| anyhow!("{}: {error}", plot.title))?;
    Ok(Some(text))
}

fn draw(
    plot: &Plot,
    text: &mut String,
    points: impl Fn(&Series) -> Vec<(f64, f64)>,
    [x, y]: [std::ops::Range<f64>; 2],
) -> Result<(), DrawingAreaErrorKind<std::io::Error>> {
    let area = SVGBackend::with_string(text, SIZE).into_drawing_area();
    area.fill(&WHITE)?;
    let mut chart = ChartBuilder::on(&area)
        .caption(plot.title, ("sans-serif", 16))
        .margin(10)
        .x_label_area_size(40)
        .y_label_area_size(60)
        .build_cartesian_2d(x.log_scale(), y.log_scale())?;
    let label = |value: &f64| super::table::number(*value);
    chart
        .configure_mesh()
        .light_line_style(RGBColor(238, 238, 238))
        .bold_line_style(RGBColor(210, 210, 210))
        .x_desc(plot.axes[0])
        .y_desc(plot.axes[1])
        .x_label_formatter(&label)
        .y_label_formatter(&label)
        .draw()?;
    for (index, (series, colour)) in plot.series.iter().zip(COLOURS.into_iter().cycle()).enumerate() {
        let points = points(series);
        if points.is_empty() {
            continue;
        }
        // A line that another covers shows on either side of it.
        let width = 2 + (plot.series.len() - 1 - index).min(2) as u32;
        let drawn = chart.draw_series(LineSeries::new(points, colour.stroke_width(width)).point_size(2 + width))?;
        drawn
            .label(&series.name)
            .legend(move |(x, y)| PathElement::new(vec![(x, y), (x + 18, y)], colour.stroke_width(2)));
    }
    chart
        .configure_series_labels()
        .position(plot.legend.clone())
        .background_style(WHITE.mix(0.85))
        .border_style(RGBColor(200, 200, 200))
        .label_font(("sans-serif", 12))
        .draw()?;
    area.present()
}
