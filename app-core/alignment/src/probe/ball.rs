//! A mirror ball.

use glam::{DVec2, DVec3};

use super::reflection::Reflection;
use super::viewpoint::Viewpoint;

/// A ball around the origin of its space.
#[derive(Clone, Debug)]
pub(super) struct Ball {
    pub(super) viewpoint: Viewpoint,
    pub(super) radius_m: f64,
}

impl Ball {
    /// The reflection of a pixel's line of sight; `None` beside the ball, or inside it.
    pub(super) fn reflect(&self, at_px: DVec2) -> Option<Reflection> {
        let (from, along) = (self.viewpoint.place(), self.viewpoint.sight(at_px));
        let nearest = -from.dot(along);
        // From the foot of the perpendicular: the difference of squares would lose a far camera's
        // digits.
        let foot = from + nearest * along;
        let half_squared = self.radius_m * self.radius_m - foot.length_squared();
        let is_before = from.length() > self.radius_m && nearest > 0.0;
        if half_squared < 0.0 || !is_before {
            return None;
        }
        let at = foot - half_squared.sqrt() * along;
        Reflection::of(at, at.try_normalize()?, -along)
    }

    /// Normal at a pixel for a viewer at infinity, and the direction to that viewer.
    pub(super) fn normal_for_far_viewer(&self, at_px: DVec2) -> Option<(DVec3, DVec3)> {
        let viewer = self.viewpoint.place().try_normalize()?;
        let along = self.viewpoint.sight(at_px);
        // Intersection of the line of sight with the plane through the centre that faces the
        // viewer.
        let from = self.viewpoint.place();
        let steep = along.dot(viewer);
        if steep >= 0.0 {
            return None;
        }
        let across = (from - along * (from.dot(viewer) / steep)) / self.radius_m;
        let squared = across.length_squared();
        (squared <= 1.0).then(|| (across + (1.0 - squared).sqrt() * viewer, viewer))
    }
}
