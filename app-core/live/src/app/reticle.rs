//! The sign that a table was found: a reticle on it, and a grid of dots around the reticle.

use glam::DVec2;

use super::App;
use super::event::{PlatformCommand, ShellCommand};
use super::ghost::{circle, pixel_of, seen_at};
use super::step::Step;
use super::table::table_at;
use app_scene::camera_frame::{CameraFrame, FoundPlane};
use app_scene::scene::Camera;

/// Radius of the reticle, in metres, and its corners.
const RADIUS_M: f64 = 0.04;
const N_CORNERS: u32 = 40;
/// Distance of the dots, and their reach around the reticle, in metres.
const PITCH_M: f64 = 0.05;
const REACH_M: f64 = 0.35;

/// The reticle on a table, in pixels of the camera's picture.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Reticle {
    /// Corners of its circle, in order.
    pub ring_px: Vec<DVec2>,
    /// Places of the grid with their opacity: 1 at the reticle, and less farther away.
    pub dots_px: Vec<(DVec2, f64)>,
}

impl App {
    /// The reticle on the table in the middle of the picture; `None` if no table was found, and in
    /// steps other than [`Step::FindTable`].
    #[must_use]
    pub fn reticle(&self) -> Option<Reticle> {
        let latest = self.latest.as_ref().filter(|_| self.step == Step::FindTable)?;
        let camera = latest.camera()?;
        let (plane, place_m) = hit(latest, &camera)?;
        let pixel = |at_m: DVec2| pixel_of(&plane.world_from_plane, &camera, at_m);
        let ring = circle(place_m, RADIUS_M, N_CORNERS).filter_map(pixel);
        let dots = grid(place_m, plane.half_extent_m).filter_map(|at_m| {
            let seen = 1.0 - at_m.distance(place_m) / REACH_M;
            (seen > 0.0).then_some((pixel(at_m)?, seen))
        });
        Some(Reticle {
            ring_px: ring.collect(),
            dots_px: dots.collect(),
        })
    }

    /// Gives a haptic pulse when the reticle reaches a table.
    pub(super) fn follow_reticle(&mut self, commands: &mut Vec<ShellCommand>) {
        let has_reticle = self.step == Step::FindTable && self.reticle_px().is_some();
        let had_reticle = std::mem::replace(&mut self.had_reticle, has_reticle);
        if has_reticle && !had_reticle {
            commands.push(PlatformCommand::Knock.into());
        }
    }

    /// The pixel at which the reticle points.
    pub(super) fn reticle_px(&self) -> Option<DVec2> {
        let latest = self.latest.as_ref()?;
        let camera = latest.camera()?;
        hit(latest, &camera).map(|_| middle_px(latest))
    }
}

fn middle_px(frame: &CameraFrame) -> DVec2 {
    0.5 * DVec2::from(frame.image.size_px().map(f64::from))
}

/// The table in the middle of the picture, and the place on it.
fn hit(frame: &CameraFrame, camera: &Camera) -> Option<(FoundPlane, DVec2)> {
    let middle_px = middle_px(frame);
    let plane = table_at(frame, camera, middle_px)?;
    let place_m = seen_at(&plane.world_from_plane, camera, middle_px)?;
    Some((plane, place_m))
}

/// Places of a plane's grid around a point, within its extent. They belong to the plane, and stay
/// when the reticle moves.
fn grid(around_m: DVec2, half_extent_m: DVec2) -> impl Iterator<Item = DVec2> {
    #[allow(clippy::cast_possible_truncation, reason = "a dozen")]
    let n = (REACH_M / PITCH_M).ceil() as i32;
    let first = (around_m / PITCH_M).round();
    let all = (-n..=n).flat_map(move |y| (-n..=n).map(move |x| DVec2::new(x.into(), y.into())));
    all.map(move |step| PITCH_M * (first + step))
        .filter(move |at| at.abs().cmple(half_extent_m).all())
}
