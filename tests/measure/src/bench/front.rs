//! Error against time: presets, and the governor's quality steps one after the other.

use plotters::coord::Shift;
use plotters::prelude::{
    BLACK, BLUE, ChartBuilder, Circle, Color, DrawingArea, IntoDrawingArea, LineSeries, SVGBackend, Text,
    WHITE,
};

use app_core::governor::{BALANCED_QUALITY_LADDER, QualitySetting, QualityStep};
use app_core::preset::Preset;

use super::{FRAME_KINDS, FrameKind, Row};

const PANEL_PX: (u32, u32) = (1500, 520);
const FONT: (&str, i32) = ("sans-serif", 14);
/// Margin around the points, as a factor of the axes.
const ROOM: f64 = 1.15;

/// A setting, averaged over sessions.
#[derive(Clone, Debug, PartialEq)]
pub struct Point {
    /// Preset, and number of quality steps off it.
    pub name: String,
    /// Time over that of the published method.
    pub time: f64,
    /// RMSE in the shadow, 8-bit codes.
    pub error: f64,
}

/// The governor's quality steps off preset `balanced`, cumulatively; the frame rate costs no error.
pub(super) fn quality_reductions() -> impl Iterator<Item = &'static [QualityStep]> {
    let n_steps = BALANCED_QUALITY_LADDER
        .iter()
        .take_while(|step| step.setting != QualitySetting::FramesPerSecond)
        .count();
    (1..=n_steps).map(|n| &BALANCED_QUALITY_LADDER[..n])
}

/// Name of a row.
pub(super) fn named(preset: Preset, steps: &[QualityStep]) -> String {
    match steps.len() {
        0 => preset.name().to_owned(),
        n => format!("{preset}-{n}"),
    }
}

/// Every setting that was timed and scored in all sessions, for one kind of frame, fastest first.
/// Times are geometric means of ratios.
#[must_use]
pub fn points(rows: &[Row], kind: FrameKind) -> Vec<Point> {
    let mut names: Vec<&str> = Vec::new();
    for row in rows {
        if !names.contains(&row.preset.as_str()) {
            names.push(&row.preset);
        }
    }
    let mut points: Vec<Point> = names
        .into_iter()
        .filter_map(|name| point(rows, name, kind))
        .collect();
    points.sort_by(|a, b| a.time.total_cmp(&b.time));
    points
}

fn point(rows: &[Row], name: &str, kind: FrameKind) -> Option<Point> {
    let (mut log_time, mut error, mut n) = (0.0, 0.0, 0.0);
    for row in rows.iter().filter(|row| row.preset == name) {
        let times = row.times.iter().find(|times| times.kind == kind)?;
        log_time += times.ratio_to_paper.filter(|ratio| *ratio > 0.0)?.ln();
        error += row.scores.as_ref()?.shadow.rmse;
        n += 1.0;
    }
    (n > 0.0).then(|| Point {
        name: name.to_owned(),
        time: (log_time / n).exp(),
        error: error / n,
    })
}

/// The Pareto front, fastest first: points without a faster one of equal or less error.
#[must_use]
pub fn front(points: &[Point]) -> Vec<&Point> {
    let mut least = f64::INFINITY;
    let better = points.iter().filter(|point| {
        let is_better = point.error < least;
        least = least.min(point.error);
        is_better
    });
    better.collect()
}

/// Error over time, a panel for each kind of frame, with a line along the front (SVG).
///
/// # Errors
/// The error of the drawing.
pub fn front_drawing(rows: &[Row]) -> Result<String, String> {
    let mut svg = String::new();
    render(rows, &mut svg).map_err(|error| error.to_string())?;
    Ok(svg)
}

fn render(rows: &[Row], svg: &mut String) -> Result<(), Box<dyn std::error::Error>> {
    let area = SVGBackend::with_string(svg, PANEL_PX).into_drawing_area();
    area.fill(&WHITE)?;
    for (panel, kind) in area.split_evenly((1, FRAME_KINDS.len())).iter().zip(FRAME_KINDS) {
        panel_of(panel, kind, &points(rows, kind))?;
    }
    area.present()?;
    Ok(())
}

fn panel_of(
    panel: &DrawingArea<SVGBackend<'_>, Shift>,
    kind: FrameKind,
    points: &[Point],
) -> Result<(), Box<dyn std::error::Error>> {
    let most = |of: fn(&Point) -> f64| points.iter().map(of).fold(0.1, f64::max) * ROOM;
    // Labels are spread if errors are similar.
    let least_error = points
        .iter()
        .map(|point| point.error)
        .fold(f64::INFINITY, f64::min)
        / ROOM;
    let errors = least_error.min(most(|point| point.error))..most(|point| point.error);
    let mut chart = ChartBuilder::on(panel)
        .margin(10)
        .caption(format!("new {}", kind.name()), FONT)
        .x_label_area_size(40)
        .y_label_area_size(50)
        .build_cartesian_2d(0.0..most(|point| point.time), errors)?;
    chart
        .configure_mesh()
        .max_light_lines(1)
        .x_desc("time over that of paper")
        .y_desc("shadow RMSE, codes")
        .draw()?;
    let line = front(points).into_iter().map(|point| (point.time, point.error));
    chart.draw_series(LineSeries::new(line, BLACK.stroke_width(1)))?;
    chart.draw_series(
        points
            .iter()
            .map(|point| Circle::new((point.time, point.error), 3, BLUE.filled())),
    )?;
    chart.draw_series(
        points
            .iter()
            .map(|point| Text::new(point.name.clone(), (point.time, point.error), FONT)),
    )?;
    Ok(())
}
