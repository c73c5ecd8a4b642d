//! Sweeps as drawings (SVG).

use std::path::Path;

use plotters::prelude::{
    ChartBuilder, Color, IntoDrawingArea, LineSeries, Palette, Palette99, PathElement, SVGBackend, WHITE,
};

use super::row::Sweep;
use desk::output::{WriteError, write_whole};

const SIZE_PX: (u32, u32) = (900, 480);
const FONT: (&str, i32) = ("sans-serif", 14);

/// Draws a sweep into a folder, as a file of its name.
///
/// # Errors
/// When the file cannot be written.
pub fn draw(folder: &Path, sweep: &Sweep) -> Result<(), WriteError> {
    let path = folder.join(format!("{}.svg", sweep.name));
    let svg = drawing(sweep).map_err(|reason| WriteError {
        path: path.clone(),
        reason,
    })?;
    write_whole(&path, svg.as_bytes())
}

fn drawing(sweep: &Sweep) -> Result<String, String> {
    let mut svg = String::new();
    render(sweep, &mut svg).map_err(|error| error.to_string())?;
    Ok(svg)
}

fn render(sweep: &Sweep, svg: &mut String) -> Result<(), Box<dyn std::error::Error>> {
    let points = || sweep.lines.iter().flat_map(|(_, points)| points);
    let [left, right] = range(points().map(|point| point[0]));
    let [_, top] = range(points().map(|point| point[1]).chain([0.0]));
    let area = SVGBackend::with_string(svg, SIZE_PX).into_drawing_area();
    area.fill(&WHITE)?;
    let mut chart = ChartBuilder::on(&area)
        .caption(&sweep.name, FONT)
        .margin(10)
        .x_label_area_size(40)
        .y_label_area_size(60)
        .build_cartesian_2d(left..right, 0.0..1.05 * top)?;
    chart
        .configure_mesh()
        .max_light_lines(2)
        .x_desc(sweep.along)
        .y_desc(sweep.measure)
        .draw()?;
    for (index, (name, points)) in sweep.lines.iter().enumerate() {
        let color = Palette99::pick(index).to_rgba();
        let finite = points.iter().filter(|point| point[1].is_finite());
        let line = LineSeries::new(finite.map(|point| (point[0], point[1])), color.stroke_width(2));
        chart
            .draw_series(line)?
            .label(*name)
            .legend(move |(x, y)| PathElement::new([(x, y), (x + 20, y)], color));
    }
    chart.configure_series_labels().background_style(WHITE).draw()?;
    area.present()?;
    Ok(())
}

/// Smallest and largest finite number, with a gap between them.
fn range(numbers: impl Iterator<Item = f64>) -> [f64; 2] {
    let finite = numbers.filter(|number| number.is_finite());
    let [low, high] = finite.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], number| {
        [low.min(number), high.max(number)]
    });
    if low < high {
        [low, high]
    } else {
        [low.min(0.0), high.max(low) + 1.0]
    }
}
