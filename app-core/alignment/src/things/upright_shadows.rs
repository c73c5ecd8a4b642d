//! The shadows that things cast on the first receiver, as if each thing were upright.

use glam::{DVec2, DVec3, IVec2};

use super::feet::{Bodies, Feet, pixel_of, shadow_of};
use super::grown::Grown;
use super::seeds::Colored;
use super::sight::Sight;
use crate::picture::{Level, Mask, places};

/// Distance in pixels by which a shadow is grown, so that the lines of adjacent pixels meet.
const APART_PX: i32 = 1;

impl Sight<'_> {
    /// For each thing, the pixels of a level on which its shadow falls; empty without a receiver, or
    /// with several lights.
    pub(super) fn upright_shadows(&self, things: &Grown, level: &Level) -> Vec<Mask> {
        let ([light], Some(table)) = (self.lights, self.receivers.first()) else {
            return Vec::new();
        };
        let size_px = level.frame.size_px;
        let body = |at: IVec2| things.body_at(at.as_dvec2() + 0.5, Colored::Otherwise);
        let bodies = Bodies {
            size_px,
            thing: places(size_px).map(body).collect(),
            per_px: 1.0,
        };
        let feet = Feet::of(&bodies, level, table);
        let light = light.moved(&self.plane_from_world(table));
        let mut shadows = vec![Mask::new(size_px); things.n_things()];
        for at in places(size_px) {
            // The shadow of what is below a top lies between the foot's and the top's.
            let Some(thing) = bodies.of(at).filter(|_| feet.is_top(at)) else {
                continue;
            };
            let line = feet.point_above(at).and_then(|point| {
                let foot = DVec3::new(point.x, 0.0, point.z);
                let ends = [foot, shadow_of(point, &light)?].map(|end| pixel_of(end, table, level));
                Some([ends[0]?, ends[1]?])
            });
            if let Some(line) = line {
                mark(&mut shadows[thing], line, size_px);
            }
        }
        shadows.into_iter().map(|shadow| shadow.grown(APART_PX)).collect()
    }
}

/// Marks the pixels of a line, up to the length of a picture.
fn mark(shadow: &mut Mask, [from, to]: [DVec2; 2], size_px: IVec2) {
    let length_px = (to - from).abs().max_element();
    let longest_px = f64::from(size_px.element_sum());
    #[allow(clippy::cast_possible_truncation, reason = "at most a picture's length")]
    let n_steps = length_px.min(longest_px).ceil() as i32;
    let step = (to - from) / length_px.max(1.0);
    for k in 0..=n_steps {
        shadow.mark((from + f64::from(k) * step).floor().as_ivec2());
    }
}
