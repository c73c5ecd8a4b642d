//! The height that things before the toy are taken to have, such as a hand that lies on the table.
//!
//! Nothing tells the shape of what no plate shows. But what hides the toy's feet alone mostly lies on the
//! table, and a head that the toy lowers there is in front of it. It is taken to be as high as the highest
//! part of the toy that it hides; in truth it is nearer to the camera, and so higher, by up to its distance
//! from the toy.

use glam::{DVec3, IVec2};

use super::feet::WITHIN_PX;
use super::found::Found;
use super::groups::cross;
use super::sight::Sight;
use crate::picture::{Level, index_in, places, square};
use crate::pose::covered;
use app_scene::things::{Front, Mark};

/// Part of the toy's height below which a thing hides it, if the thing is a low one.
const LOW: f64 = 0.35;

impl Sight<'_> {
    /// The level plane at the highest point of the toy that things hide, in the first receiver's space, if they hide
    /// only its lower part, and no plate shows them. `marks` are those of the largest level.
    pub(super) fn front_of_low(
        &self,
        level: &Level,
        found: &Found<'_>,
        (size_px, marks): (IVec2, &[Mark]),
    ) -> Option<Front> {
        let plane_from_camera = &self.receivers.first()?.plane_from_camera;
        let is_before =
            |at: IVec2| index_in(size_px, at).and_then(|index| marks.get(index)) == Some(&Mark::BeforeToy);
        let per_px = self.per_px(level);
        let is_in_plate = |at: IVec2| found.at((at.as_dvec2() + 0.5) * per_px) == Mark::BeforeToy;
        if found.in_frame.is_none() || places(size_px).any(|at| is_before(at) && is_in_plate(at)) {
            return None;
        }
        let intrinsics = &self.pyramid.level(0).intrinsics;
        let toy = covered(self.shape, self.pyramid.level(0));
        let is_hidden = |at: &IVec2| cross(*at, WITHIN_PX).all(|at| is_before(at) && toy.at(at) >= 1.0);
        let height_m = |at: IVec2| {
            let point = f64::from(toy.depth_m(at)) * intrinsics.ray(at.as_dvec2() + 0.5);
            plane_from_camera.transform_point3(point).y
        };
        // The next pixels may show the thing, too.
        let around = toy
            .pixels()
            .filter(is_hidden)
            .flat_map(|at| square(at, WITHIN_PX + 1));
        let covered = around.filter(|at| toy.depth_m(*at).is_finite());
        let top_m = covered.map(height_m).reduce(f64::max)?;
        let of_toy = self
            .shape
            .points
            .iter()
            .map(|point| plane_from_camera.transform_point3(*point).y);
        let front = Front::at(top_m * DVec3::Y, DVec3::Y)?;
        (top_m > 0.0 && top_m < LOW * of_toy.reduce(f64::max)?).then_some(front)
    }
}
