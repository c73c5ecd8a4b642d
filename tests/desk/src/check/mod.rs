//! The mistakes of a session that can be found without any truth.

pub mod aligned_session;
mod icc;
mod keys;
pub mod overlay;
mod pictures;
mod sense;
mod upright;

use std::path::{Path, PathBuf};

use app_core::alignment::{Alignment, LightAlignment, Outlines, PoseAlignment};
use app_core::frame::FrameInput;
use app_core::lens::Distortion;
use app_core::probe::ProbeReport;
use app_core::scene::Image;
use app_core::session::{Capture, Session, SessionWarning};

use crate::alignment::{Aligned, Alignments, Asked, LightError, Lights, Source};
use crate::files::index_of;
use crate::gizmo;
use crate::gizmo::Gizmo;
use crate::lens::through_lens;
use crate::opened;
use crate::opened::Opened;
use crate::output::{remove_file, write_png};
use crate::stored::Stored;

pub use icc::name as profile_name;
pub use pictures::{foreign as foreign_colours, wrong_of_picture};

/// File name of the drawing.
const DRAWING: &str = "check.png";

/// The result of a check.
#[derive(Clone, Debug, Default)]
pub struct Findings {
    /// Relations between the poses of toy, lights and camera.
    pub facts: Vec<String>,
    /// Mistakes; empty for a good session.
    pub wrong: Vec<String>,
    /// The drawing over the first frame.
    pub drawing: Option<PathBuf>,
}

/// Checks a session's index, files, numbers and pictures, and draws its predictions into `out`.
///
/// # Errors
/// When folder or recording cannot be opened, or the drawing cannot be written. Mistakes of the
/// session are no errors.
pub fn check(session: &Path, out: &Path, (asked, lens): (Asked, Source)) -> anyhow::Result<Findings> {
    let stored = Stored::open(session)?;
    // An old drawing in the folder may be of another session.
    remove_file(&out.join(DRAWING))?;
    let mut findings = Findings::default();
    let index = index_of(&stored);
    findings.wrong.extend(index.iter().flat_map(keys::unknown));
    findings
        .wrong
        .extend(stored.losses().iter().map(ToString::to_string));
    let of_pictures = index.iter().flat_map(|index| pictures::wrong(&stored, index));
    findings.wrong.extend(of_pictures);
    let capture = match Capture::open(stored) {
        Ok(capture) => capture,
        Err(error) => {
            findings.wrong.push(error.to_string());
            return Ok(findings);
        }
    };
    if let Err(error) = index {
        let message = format!("{error:#}, so that its keys and its pictures' files are not checked");
        findings.wrong.push(message);
    }
    let capture = match lens {
        Source::Given => capture,
        Source::Found => findings.freed_of_lens(session, asked.lights)?,
    };
    findings.wrong.extend(messages(capture.warnings()));
    findings.facts.extend(sense::without(capture.scene()));
    findings.facts.extend(sense::place_mesh(capture.scene()));
    findings.wrong.extend(sense::wrong(capture.scene()));
    let frames = (0..capture.n_frames()).map(|index| (index, capture.frame(index)));
    for (index, frame) in frames {
        match frame {
            Ok(frame) => {
                findings.wrong.extend(messages(&frame.warnings));
                findings
                    .wrong
                    .extend(sense::wrong_of_frame(capture.scene(), index, &frame));
            }
            Err(error) => findings.wrong.push(format!("frame {index}: {error}")),
        }
    }
    if let Ok(first) = capture.frame(0) {
        findings.facts.extend(sense::depth(&first));
        let given = FrameInput::from(&first);
        match Alignments::find(&capture, 0..1, asked) {
            Ok(alignments) => {
                if let Some(aligned) = alignments.of(0) {
                    findings.aligned(aligned);
                    if upright::is_misaligned(&alignments, 0) {
                        findings.wrong.extend(upright::offered(&capture, 0, asked));
                    }
                    let picture = drawn(&capture, &given, &aligned.alignment)?;
                    let path = out.join(DRAWING);
                    write_png(&path, &picture)?;
                    findings.drawing = Some(path);
                }
            }
            Err(error) => findings.wrong.push(error.to_string()),
        }
    }
    Ok(findings)
}

/// The difference between an estimated light and the nearest light of the ignored list.
fn against_listed(error: &LightError) -> String {
    let times = |ratio: Option<f64>, what: &str| {
        ratio.map_or(String::new(), |ratio| format!(", {ratio:.2} times its {what}"))
    };
    format!(
        "; {:.2} degrees from lights[{}]{}{}",
        error.direction_rad.to_degrees(),
        error.index,
        times(error.distance_ratio, "distance"),
        times(error.size_ratio, "angular size"),
    )
}

/// Angle within which a direction is listed as well as it can be measured, in radians: half a
/// degree, which is 4 mm of the middle of a lamp at half a metre.
const LISTED_RAD: f64 = 0.5 * std::f64::consts::PI / 180.0;
/// The same for a lamp's distance, as a logarithm: a tenth.
const LISTED_RATIO: f64 = 0.1;

/// Whether an estimate agrees with the list as well as a list can be measured. It may move the
/// shadow visibly all the same, so that the estimate is used. A size is listed well if it does
/// not differ visibly.
#[must_use]
pub fn is_as_listed(light: &LightAlignment) -> bool {
    light.turned_rad <= LISTED_RAD && light.distance_ratio.ln().abs() <= LISTED_RATIO && !light.is_resized
}

/// Ratios of sizes that differ from 1 by rounding.
const SAME_SIZE: f64 = 1e-6;

/// The accuracy of an estimated pose, and the size and softness of the picture.
fn how_well(pose: &PoseAlignment) -> String {
    let texture = pose.texture_correlation.map_or_else(String::new, |correlation| {
        format!("; the model's texture and the picture's correlate by {correlation:.2}")
    });
    let size = match pose.size_ratio {
        ratio if (ratio - 1.0).abs() < SAME_SIZE => String::new(),
        ratio => format!(", {ratio:.4} times the size given"),
    };
    format!(
        "toy.world_from_object: the outline's position is known to {:.2} mm along the view, {:.2} mm beside it and {:.2} degrees, one deviation each{size}; the model's outline is off by {:.2} px, and edges are spread by {:.1} px{texture}",
        1e3 * pose.deviation.depth_m,
        1e3 * pose.deviation.lateral_m,
        pose.deviation.rotation_rad.to_degrees(),
        pose.model_px,
        pose.spread_px,
    )
}

/// The reader's warnings, without those of files that were checked before.
fn messages(warnings: &[SessionWarning]) -> impl Iterator<Item = String> {
    let others = warnings
        .iter()
        .filter(|warning| !matches!(warning, SessionWarning::Turned { .. }));
    others.map(ToString::to_string)
}

impl Findings {
    fn tell(&mut self, message: String, is_wrong: bool) {
        let list = if is_wrong {
            &mut self.wrong
        } else {
            &mut self.facts
        };
        list.push(message);
    }

    /// The session with the lens as estimated from its pictures.
    fn freed_of_lens(&mut self, session: &Path, lights: Lights) -> anyhow::Result<Capture> {
        let Opened { capture, lens } = opened::open(session, Source::Found, lights)?;
        if let Some(found) = lens {
            let Distortion { k1, k2 } = found.distortion;
            let message = match found.errors {
                Some(_) => format!(
                    "lens: the estimate from toy and shadow is k1 {k1:.4} and k2 {k2:.4}: {}",
                    found.outcome
                ),
                None => format!("lens: {}", found.outcome),
            };
            self.tell(message, found.is_applied());
        }
        Ok(capture)
    }

    fn aligned(&mut self, aligned: &Aligned) {
        let alignment = &aligned.alignment;
        let report = &alignment.report;
        if let Some(found) = &report.focal_length {
            let message = match found.errors {
                Some(_) => format!(
                    "intrinsics: the estimate from toy and shadow is {:.4} times the focal length, +- {:.4}: {}",
                    found.ratio, found.deviation, found.outcome
                ),
                None => format!("intrinsics: {}", found.outcome),
            };
            self.tell(message, found.is_applied());
        }
        if let Some(found) = &report.world_scale {
            let message = match found.errors {
                Some(_) => format!(
                    "toy.world_from_object: by toy and shadow the world is {:.4} times as large as by the toy's model, +- {:.4}: {}",
                    found.ratio, found.deviation, found.outcome
                ),
                None => format!("toy.world_from_object: its scale: {}", found.outcome),
            };
            self.tell(message, found.is_applied());
        }
        if let Some(camera) = &report.camera {
            let message = format!(
                "world_from_camera: the table moves by {:.2} px in the picture if the camera is moved by {:.2} mm and turned by {:.2} degrees",
                camera.moved_px,
                1e3 * camera.moved_m,
                camera.turned_rad.to_degrees(),
            );
            self.tell(message, camera.is_applied);
        }
        self.pose(report.pose.as_ref());
        for plane in &report.planes {
            self.facts
                .push(format!("receivers: {plane}, is found by the toy's shadow on it"));
        }
        for (index, light) in report.lights.iter().enumerate() {
            let size = light.size_ratio.map_or(String::new(), |ratio| {
                format!(", {ratio:.2} times its angular size")
            });
            let message = format!(
                "lights[{index}]: the estimate from its shadow is {:.2} degrees from the direction given, at {:.2} times its distance{size}",
                light.turned_rad.to_degrees(),
                light.distance_ratio
            );
            self.tell(
                message,
                light.is_applied && light.is_moved && !is_as_listed(light),
            );
        }
        if let Some(probe) = &report.probe {
            self.probe(probe, report.no_light.is_some());
        }
        for (index, light) in report.discovered.iter().enumerate() {
            let distance = light.distance_m.map_or("far away".to_owned(), |distance_m| {
                format!("{distance_m:.2} m away")
            });
            let error = aligned.error_of_estimated(light);
            let against = error.as_ref().map(against_listed).unwrap_or_default();
            self.facts.push(format!(
                "light {index} is found by its shadow: {:.1} degrees wide, {distance}, {:.0} % of the light, its direction known to {:.2} degrees{against}",
                2.0 * light.angular_radius_rad.to_degrees(),
                100.0 * light.share,
                light.deviation.direction_rad.to_degrees()
            ));
        }
        self.wrong.extend(
            alignment
                .warnings
                .iter()
                .map(|warning| format!("frames[0]: {warning}")),
        );
    }
}

impl Findings {
    fn pose(&mut self, pose: Option<&PoseAlignment>) {
        match pose {
            None => self.wrong.push(
                "frames[0]: too little of the toy's outline is visible to align it: check toy.world_from_object and world_from_camera"
                    .to_owned(),
            ),
            Some(pose) => {
                let message = format!(
                    "toy.world_from_object: the outline is {:.2} px from the photograph's as given, {:.2} px if the toy is moved by {:.2} mm and turned by {:.2} degrees",
                    pose.given_outline_px,
                    pose.outline_px,
                    1e3 * pose.moved_m,
                    pose.turned_rad.to_degrees(),
                );
                self.tell(message, pose.is_applied);
                self.facts.push(how_well(pose));
            }
        }
    }

    fn probe(&mut self, probe: &ProbeReport, stands: bool) {
        for (index, light) in probe.lights.iter().enumerate() {
            let [u, v] = light.seen.at_px.to_array();
            let distance = light
                .distance_m
                .map_or("not told".to_owned(), |distance_m| format!("{distance_m:.2} m"));
            let then = if stands {
                ", which no shadow confirms or corrects"
            } else {
                ""
            };
            self.facts.push(format!(
                "probe: light {index} at ({u:.1}, {v:.1}) px, its direction known to {:.2} degrees, its distance {distance}{then}",
                light.seen.deviation_rad.to_degrees(),
            ));
        }
        for rejected in &probe.rejected {
            let [u, v] = rejected.at_px.to_array();
            self.facts.push(format!(
                "probe: the bright spot at ({u:.1}, {v:.1}) px is no light: {}",
                rejected.reason
            ));
        }
        if probe.lights.is_empty() {
            self.wrong.push(
                "probe: its pictures show no light: check probe.world_from_lens, probe.radius and whether the pictures are too dark"
                    .to_owned(),
            );
        }
        if probe.n_unseen > 0 {
            self.facts.push(format!(
                "probe: its last {} pictures do not show the light, so that the earlier estimate is kept",
                probe.n_unseen
            ));
        }
    }
}

fn drawn(capture: &Capture, given: &FrameInput, alignment: &Alignment) -> anyhow::Result<Image> {
    let scene = capture.scene();
    let aligned = &alignment.applied_to(given);
    let mut picture = Image::clone(given.image.rgba());
    let shown = alignment.scene.as_deref().unwrap_or(scene);
    overlay::receivers(&mut picture, shown, given);
    overlay::outlines(&mut picture, &Outlines::of(scene, given)?, overlay::GIVEN);
    overlay::outlines(&mut picture, &Outlines::of(shown, aligned)?, overlay::ALIGNED);
    gizmo::rays(
        &mut picture,
        (scene, given),
        &Gizmo::listed(scene, given),
        gizmo::GIVEN,
    );
    let found = Gizmo::aligned(scene, aligned, &alignment.report);
    gizmo::rays(&mut picture, (scene, aligned), &found, gizmo::FOUND);
    Ok(through_lens(capture, 0, picture)?)
}
