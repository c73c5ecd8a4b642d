//! Basin of convergence of alignment: pose and lights of a session's first frame are disturbed by
//! growing amounts, and aligned.
//!
//! Errors are relative to the recorded values, so the session must be recorded exactly.

use app_core::alignment::Aligner;
use app_core::frame::FrameInput;
use app_core::scene::{Light, Scene};
use app_core::session::Session;
use glam::{DMat4, DQuat, DVec3};
use plotters::coord::Shift;
use plotters::prelude::{
    BLACK, BLUE, ChartBuilder, Circle, Color, DrawingArea, IntoDrawingArea, IntoLogRange, LineSeries,
    SVGBackend, WHITE,
};

use super::pull::{Pull, summary};
use super::table::aligned;
use crate::median::median;
use crate::random::Random;
use desk::alignment::middle;
use desk::replay::ReplayError;

/// The largest disturbance: of the pose in millimetres and degrees, of each light's direction in
/// degrees.
const MOST: PoseAndLightErrors = PoseAndLightErrors {
    pose_mm: 30.0,
    pose_deg: 18.0,
    light_deg: Some(30.0),
};
/// Largest number of rows in the table, each with as many starts but for the last.
const N_PARTS: usize = 6;
/// Lower bound of drawn errors, on a logarithmic axis.
const LEAST_DRAWN: f64 = 0.01;
const PANEL_PX: (u32, u32) = (1680, 420);
const FONT: (&str, i32) = ("sans-serif", 14);

/// Errors of pose and lights relative to the recorded ones.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PoseAndLightErrors {
    /// Distance of the toy's centre.
    pub pose_mm: f64,
    /// Error of its rotation.
    pub pose_deg: f64,
    /// Angle of the worst light, seen from the toy's centre; `None` without lights.
    pub light_deg: Option<f64>,
}

/// One start, and its result.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Draw {
    /// Error of the start.
    pub start: PoseAndLightErrors,
    /// Error after alignment.
    pub end: PoseAndLightErrors,
    /// Errors of the pose with their claimed deviations; `None` if no pose was applied.
    pub pull: Option<Pull>,
}

/// Disturbs and aligns the first frame that many times, each time by a larger amount.
///
/// # Errors
/// When the frame cannot be read or aligned.
pub fn basin(session: &dyn Session, seed: u64, n_draws: u16) -> Result<Vec<Draw>, ReplayError> {
    let scene = session.scene();
    let recorded = FrameInput::from(&session.frame(0)?);
    let mut random = Random::new(seed);
    let draws = (1..=n_draws).map(|index| {
        let part = f64::from(index) / f64::from(n_draws);
        let given = disturbed(scene, &recorded, part, &mut random);
        let found = Aligner::new(scene.clone())
            .align(&given)
            .map_err(|reason| ReplayError::Align {
                index: 0,
                reason: Box::new(reason),
            })?;
        let pose = found.report.pose.filter(|pose| pose.is_applied);
        let found = found.applied_to(&given);
        let end = off(scene, &recorded, &found);
        let places = [&recorded, &found].map(|input| middle(scene, &input.world_from_object));
        Ok(Draw {
            start: off(scene, &recorded, &given),
            pull: pose.map(|pose| Pull::of(&recorded, places, end.pose_deg, &pose.deviation)),
            end,
        })
    });
    draws.collect()
}

/// The toy moved and turned about its centre, and each light about that, all in random directions.
fn disturbed(scene: &Scene, recorded: &FrameInput, part: f64, random: &mut Random) -> FrameInput {
    let place = middle(scene, &recorded.world_from_object);
    let turn = |axis: DVec3, deg: f64| DQuat::from_axis_angle(axis, (part * deg).to_radians());
    let moved = place + 1e-3 * part * MOST.pose_mm * random.direction();
    let object = DMat4::from_rotation_translation(turn(random.direction(), MOST.pose_deg), moved)
        * DMat4::from_translation(-place);
    let lights = scene.lights.iter().map(|light| {
        let direction = light.direction_from(place).unwrap_or(DVec3::Y);
        let across = random.direction().cross(direction);
        let axis = across
            .try_normalize()
            .unwrap_or_else(|| direction.any_orthonormal_vector());
        let turn = turn(axis, MOST.light_deg.unwrap_or_default());
        light.map(
            |position| place + turn * (position - place),
            |direction| turn * direction,
        )
    });
    recorded
        .clone()
        .with_world_from_object(object * recorded.world_from_object)
        .with_lights((!scene.lights.is_empty()).then(|| lights.collect()))
}

fn off(scene: &Scene, recorded: &FrameInput, input: &FrameInput) -> PoseAndLightErrors {
    let place = middle(scene, &recorded.world_from_object);
    let [there, here] = [recorded, input].map(|input| input.world_from_object);
    let rotation = |matrix: &DMat4| matrix.to_scale_rotation_translation().1;
    let turn = rotation(&here) * rotation(&there).inverse();
    let direction = |light: &Light| light.direction_from(place).unwrap_or(DVec3::Y);
    let lights = input.lights.as_deref().unwrap_or(&scene.lights);
    let apart = scene
        .lights
        .iter()
        .zip(lights)
        .map(|(recorded, light)| direction(recorded).angle_between(direction(light)).to_degrees());
    PoseAndLightErrors {
        pose_mm: 1e3 * middle(scene, &here).distance(place),
        pose_deg: turn.to_scaled_axis().length().to_degrees(),
        light_deg: apart.reduce(f64::max),
    }
}

impl PoseAndLightErrors {
    /// In the order of columns and panels; NaN without a light.
    fn numbers(&self) -> [f64; 3] {
        [self.pose_mm, self.pose_deg, self.light_deg.unwrap_or(f64::NAN)]
    }
}

/// Result for a pose that was not applied.
const NO_PULL: Pull = Pull {
    errors: [f64::NAN; 3],
    claimed: [f64::NAN; 3],
};

/// A line for each start, under a header. Without a light its fields are empty, and without an
/// applied pose the last six.
#[must_use]
pub fn basin_csv(draws: &[Draw]) -> String {
    let cell = |number: f64| {
        if number.is_nan() {
            String::new()
        } else {
            format!("{number:.4}")
        }
    };
    let mut csv =
        "start_pose_mm,start_pose_deg,start_light_deg,end_pose_mm,end_pose_deg,end_light_deg,along_mm,beside_mm,turn_deg,claimed_along_mm,claimed_beside_mm,claimed_turn_deg\n".to_owned();
    for draw in draws {
        let pull = draw.pull.unwrap_or(NO_PULL);
        let cells = [
            draw.start.numbers(),
            draw.end.numbers(),
            pull.errors,
            pull.claimed,
        ]
        .concat();
        let cells: Vec<String> = cells.into_iter().map(cell).collect();
        csv.push_str(&(cells.join(",") + "\n"));
    }
    csv
}

/// The median and the worst result of starts up to a distance, and their ratio to the poses'
/// claimed deviations.
#[must_use]
pub fn basin_table(draws: &[Draw]) -> String {
    let heads = [
        "starts", "up to mm", "degrees", "light", "end mm", "worst", "degrees", "worst", "light", "worst",
    ];
    let mut cells = vec![heads.map(str::to_owned).to_vec()];
    for part in draws.chunks(draws.len().div_ceil(N_PARTS).max(1)) {
        let mut line = vec![part.len().to_string()];
        let number = |number: Option<f64>| match number {
            Some(number) if number.is_finite() => format!("{number:.2}"),
            _ => "-".to_owned(),
        };
        line.extend(
            part.last()
                .into_iter()
                .flat_map(|last| last.start.numbers())
                .map(|most| number(Some(most))),
        );
        for column in 0..3 {
            let ends: Vec<f64> = part.iter().map(|draw| draw.end.numbers()[column]).collect();
            let worst = ends.iter().copied().max_by(f64::total_cmp);
            line.extend([median(ends), worst].map(number));
        }
        cells.push(line);
    }
    let claims = summary(draws.iter().filter_map(|draw| draw.pull));
    let claims = claims.map_or(String::new(), |claims| claims + "\n");
    aligned(&cells) + &claims
}

/// Results over starts, with the line of no correction, and errors of poses over their claimed
/// deviations (SVG).
///
/// # Errors
/// The error of the drawing.
pub fn basin_drawing(name: &str, draws: &[Draw]) -> Result<String, String> {
    let mut svg = String::new();
    render(name, draws, &mut svg).map_err(|error| error.to_string())?;
    Ok(svg)
}

fn render(name: &str, draws: &[Draw], svg: &mut String) -> Result<(), Box<dyn std::error::Error>> {
    let area = SVGBackend::with_string(svg, PANEL_PX).into_drawing_area();
    area.fill(&WHITE)?;
    let panels = area.titled(name, FONT)?.split_evenly((1, 4));
    let names = ["pose, mm", "pose, degrees", "light, degrees"];
    for (column, (panel, (of, most))) in panels.iter().zip(names.iter().zip(&MOST.numbers())).enumerate() {
        let points: Vec<[f64; 2]> = draws
            .iter()
            .map(|draw| [draw.start, draw.end].map(|off| drawn(off.numbers()[column])))
            .filter(|point| point.iter().all(|number| number.is_finite()))
            .collect();
        panel_of(panel, (of, "as given", "as aligned"), *most, &points)?;
    }
    let pulls = draws.iter().filter_map(|draw| draw.pull);
    let pulls: Vec<[f64; 2]> = pulls
        .flat_map(|pull| pull.claimed.into_iter().zip(pull.errors))
        .map(|(claimed, error)| [claimed, error].map(drawn))
        .collect();
    let most = pulls
        .iter()
        .map(|[claimed, _]| *claimed)
        .fold(LEAST_DRAWN, f64::max);
    let labels = ("pose, mm and degrees", "claimed deviation", "true error");
    panel_of(&panels[3], labels, most, &pulls)?;
    area.present()?;
    Ok(())
}

/// NaN stays NaN.
fn drawn(number: f64) -> f64 {
    if number < LEAST_DRAWN { LEAST_DRAWN } else { number }
}

fn panel_of(
    panel: &DrawingArea<SVGBackend<'_>, Shift>,
    (of, across, along): (&str, &str, &str),
    most: f64,
    points: &[[f64; 2]],
) -> Result<(), Box<dyn std::error::Error>> {
    let least = points.iter().map(|[start, _]| *start).fold(most, f64::min);
    let top = points.iter().map(|[_, end]| *end).fold(most, f64::max);
    let (left, right) = (0.8 * least, 1.2 * most);
    let mut chart = ChartBuilder::on(panel)
        .margin(10)
        .x_label_area_size(40)
        .y_label_area_size(60)
        .build_cartesian_2d(
            (left..right).log_scale(),
            (0.8 * LEAST_DRAWN..1.5 * top).log_scale(),
        )?;
    chart
        .configure_mesh()
        .max_light_lines(1)
        .x_labels(5)
        .x_desc(format!("{of}: {across}"))
        .y_desc(along)
        .draw()?;
    chart.draw_series(LineSeries::new(
        [(left, left), (right, right)],
        BLACK.stroke_width(1),
    ))?;
    chart.draw_series(
        points
            .iter()
            .map(|[start, end]| Circle::new((*start, *end), 3, BLUE.filled())),
    )?;
    Ok(())
}
