//! The light behind a thing that is known by its top, such as a book.

use glam::{DVec2, DVec3, DVec4, Vec3Swizzles};

use super::lamp::Lamp;
use super::receiver_pixels::ReceiverPixel;
use crate::receivers::SeenReceiver;
use app_scene::geometry::opaque::{hidden_light, is_top};

/// Receivers that may hide a lamp from each other.
pub(super) struct Behind<'a> {
    receivers: &'a [SeenReceiver],
    /// For each receiver, those that stand on it, with its normal in their space.
    tops: Vec<Vec<(usize, DVec3)>>,
    /// The lamp's centre in the space of each receiver, homogeneous.
    middles: Vec<DVec4>,
    /// Radius of the lamp's disc in metres, or as a slope of one at infinity.
    radius: f64,
}

impl<'a> Behind<'a> {
    /// `middles` are the lamp's centre in the space of each receiver.
    pub(super) fn new(receivers: &'a [SeenReceiver], lamp: &Lamp, middles: Vec<DVec4>) -> Self {
        let up = |below: &SeenReceiver, top: &SeenReceiver| {
            let top_from_below = top.own_from_plane(&below.plane_from_camera);
            is_top(&top_from_below.inverse()).then(|| top_from_below.y_axis.truncate())
        };
        let tops = (0..receivers.len()).map(|below| {
            let others = (0..receivers.len()).filter(|top| *top != below);
            others
                .filter_map(|top| Some((top, up(&receivers[below], &receivers[top])?)))
                .collect()
        });
        Self {
            receivers,
            tops: tops.collect(),
            middles,
            radius: if lamp.is_far() {
                lamp.spread
            } else {
                lamp.spread / lamp.inverse_distance
            },
        }
    }

    /// The part of the lamp that a pixel sees, 0 to 1: what the top that hides most of it leaves; if two
    /// tops hide different parts, the shader adds both. A pixel that would show its receiver through a
    /// side of the thing shows that side, which the top does not describe: there it is 1.
    pub(super) fn seen(&self, pixel: &ReceiverPixel) -> f64 {
        let hidden = self.tops[pixel.receiver].iter().map(|(top, up)| {
            let receiver = &self.receivers[*top];
            let here = receiver.plane_from_camera.transform_point3(pixel.point);
            let eye = receiver.plane_from_camera.w_axis.truncate();
            let half_m = receiver.half_extent_m();
            if is_below([here, eye], half_m) {
                0.0
            } else {
                hidden_light(here, *up, self.middles[*top], self.radius, [-half_m, half_m])
            }
        });
        1.0 - hidden.fold(0.0, f64::max)
    }
}

/// Whether the line from a point below a top, in its space, to an eye above it is somewhere below the
/// rectangle.
fn is_below([here, eye]: [DVec3; 2], half_m: DVec2) -> bool {
    if here.y >= 0.0 || eye.y <= 0.0 {
        return false;
    }
    let rises = eye.xz() - here.xz();
    let [a, b] = [-half_m, half_m].map(|end| (end - here.xz()) / rises);
    let through = here.y / (here.y - eye.y);
    // A line that is parallel to an edge divides by 0: it is between both edges, or beyond them.
    a.min(b).max_element().max(0.0) < a.max(b).min_element().min(through)
}
