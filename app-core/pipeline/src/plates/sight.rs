//! The point of a receiver that a camera shows at a pixel, and the image position of a point.

use glam::{DMat3, DVec2};

use crate::geometry::anchored::AnchoredReceiver;
use crate::geometry::view::View;

/// A camera's homographies to and from the receivers.
pub(crate) struct Sight<'a> {
    receivers: &'a [AnchoredReceiver],
    planes: Vec<Plane>,
}

struct Plane {
    image_px_from_plane: DMat3,
    plane_from_image_px: DMat3,
    shows_front: bool,
}

/// A point of a receiver.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct PointOn {
    /// Index of the receiver.
    pub(crate) receiver: usize,
    /// (x, z) in its plane space.
    pub(crate) in_plane: DVec2,
}

impl<'a> Sight<'a> {
    pub(crate) fn new(view: &View, receivers: &'a [AnchoredReceiver]) -> Self {
        let plane = |receiver: &AnchoredReceiver| {
            let image_px_from_plane = view.image_px_from_plane(&receiver.world_from_plane);
            Plane {
                plane_from_image_px: image_px_from_plane.inverse(),
                shows_front: view.sees_front_of(&receiver.world_from_plane),
                image_px_from_plane,
            }
        };
        Self {
            receivers,
            planes: receivers.iter().map(plane).collect(),
        }
    }

    /// The point of the nearest receiver at a pixel; `None` if the pixel shows the receiver's back.
    pub(crate) fn nearest(&self, image_px: DVec2) -> Option<PointOn> {
        let planes = self.planes.iter().zip(self.receivers).enumerate();
        let hits = planes.filter_map(|(receiver, (plane, anchored))| {
            let at = plane.plane_from_image_px * image_px.extend(1.0);
            let in_plane = (at.z > 0.0).then(|| at.truncate() / at.z)?;
            let is_hit = anchored.rect.holds(in_plane);
            is_hit.then_some((at.z, PointOn { receiver, in_plane }))
        });
        hits.max_by(|a, b| a.0.total_cmp(&b.0))
            .map(|(_, point)| point)
            .filter(|point| self.planes[point.receiver].shows_front)
    }

    /// The image position of a point, possibly outside the picture; `None` if another receiver
    /// hides the point, or if its own receiver is visible from behind.
    pub(crate) fn image_px_of(&self, point: PointOn) -> Option<DVec2> {
        let at = self.planes[point.receiver].image_px_from_plane * point.in_plane.extend(1.0);
        let px = (at.z > 0.0).then(|| at.truncate() / at.z)?;
        let nearest = self.nearest(px)?;
        (nearest.receiver == point.receiver).then_some(px)
    }
}
