//! Errors of poses over their claimed deviations, of all sessions and starts together.

use plotters::coord::Shift;
use plotters::prelude::{
    BLACK, BLUE, ChartBuilder, Circle, Color, DrawingArea, IntoDrawingArea, IntoLogRange, LineSeries,
    SVGBackend, WHITE,
};

use super::basin::Draw;
use super::pull::{Pull, WITHIN, calibration, summary};

const PANEL_PX: (u32, u32) = (1260, 440);
const FONT: (&str, i32) = ("sans-serif", 14);
/// Lower bound of drawn deviations and errors, on logarithmic axes: millimetres and degrees.
const LEAST_DRAWN: f64 = 3e-3;
const ROOM: f64 = 1.3;
const NAMES: [&str; 3] = ["along the view, mm", "across it, mm", "turn, degrees"];

/// A sentence: the number of sessions and applied poses, the fraction of errors within two claimed
/// deviations, and the median of error over deviation. `None` if nothing was applied.
#[must_use]
pub fn claims_summary(sessions: &[Vec<Draw>]) -> Option<String> {
    let n_draws: usize = sessions.iter().map(Vec::len).sum();
    let pulls: Vec<Pull> = pulls(sessions).collect();
    let claims = summary(pulls.iter().copied())?;
    let (n_sessions, n_applied) = (sessions.len(), pulls.len());
    Some(format!(
        "{n_sessions} sessions, {n_applied} of {n_draws} poses applied: {claims}"
    ))
}

/// A panel for each error of a pose (SVG): true error over claimed deviation, with lines where they
/// are equal and where the error is two deviations.
///
/// # Errors
/// The error of the drawing.
pub fn claims_drawing(sessions: &[Vec<Draw>]) -> Result<String, String> {
    let mut svg = String::new();
    render(sessions, &mut svg).map_err(|error| error.to_string())?;
    Ok(svg)
}

fn pulls(sessions: &[Vec<Draw>]) -> impl Iterator<Item = Pull> {
    sessions.iter().flatten().filter_map(|draw| draw.pull)
}

fn render(sessions: &[Vec<Draw>], svg: &mut String) -> Result<(), Box<dyn std::error::Error>> {
    let area = SVGBackend::with_string(svg, PANEL_PX).into_drawing_area();
    area.fill(&WHITE)?;
    let title = claims_summary(sessions).unwrap_or_else(|| "no pose was applied".to_owned());
    let panels = area.titled(&title, FONT)?.split_evenly((1, NAMES.len()));
    for (column, (panel, of)) in panels.iter().zip(NAMES).enumerate() {
        let points: Vec<[f64; 2]> = pulls(sessions)
            .map(|pull| [pull.claimed[column], pull.errors[column]])
            .collect();
        panel_of(panel, of, &points)?;
    }
    area.present()?;
    Ok(())
}

fn panel_of(
    panel: &DrawingArea<SVGBackend<'_>, Shift>,
    of: &str,
    points: &[[f64; 2]],
) -> Result<(), Box<dyn std::error::Error>> {
    let caption = match calibration(points.iter().map(|[claimed, error]| error / claimed)) {
        Some(calibration) => format!(
            "{of}: {:.0} % within {WITHIN}, median {:.2}",
            100.0 * calibration.within,
            calibration.median
        ),
        None => of.to_owned(),
    };
    let drawn = |number: f64| number.max(LEAST_DRAWN);
    let most = points.iter().flatten().copied().fold(LEAST_DRAWN, f64::max) * ROOM;
    let least = LEAST_DRAWN / ROOM;
    let mut chart = ChartBuilder::on(panel)
        .margin(10)
        .caption(caption, FONT)
        .x_label_area_size(40)
        .y_label_area_size(60)
        .build_cartesian_2d((least..most).log_scale(), (least..most).log_scale())?;
    chart
        .configure_mesh()
        .max_light_lines(1)
        .x_labels(5)
        .x_desc("claimed deviation")
        .y_desc("true error")
        .draw()?;
    for times in [1.0, WITHIN] {
        let line = [(least, times * least), (most / times, most)];
        chart.draw_series(LineSeries::new(line, BLACK.stroke_width(1)))?;
    }
    let circles = points.iter().map(|[claimed, error]| {
        let at = (drawn(*claimed), drawn(*error));
        Circle::new(at, 2, BLUE.mix(0.5).filled())
    });
    chart.draw_series(circles)?;
    Ok(())
}
