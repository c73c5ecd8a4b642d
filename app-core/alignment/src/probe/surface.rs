//! The mirror in a picture: the reflected direction of each pixel's line of sight.

use glam::{DVec2, DVec3};

use super::ProbeView;
use super::ball::Ball;
use super::lens::Lens;
use super::reflection::Reflection;
use super::viewpoint::Viewpoint;
use app_scene::scene::ProbeShape;

/// A mirror, in the probe's space.
#[derive(Clone, Debug)]
pub(super) enum Surface<'a> {
    Lens(Lens<'a>),
    Ball(Ball),
}

impl<'a> Surface<'a> {
    pub(super) fn new(view: &ProbeView<'a>) -> Self {
        let viewpoint = Viewpoint::new(&view.picture.camera, &view.picture.world_from_probe);
        match view.shape {
            ProbeShape::FresnelLens { radius_m, slope } => Self::Lens(Lens {
                viewpoint,
                radius_m: *radius_m,
                slope,
            }),
            ProbeShape::MirrorBall { radius_m } => Self::Ball(Ball {
                viewpoint,
                radius_m: *radius_m,
            }),
        }
    }

    /// The reflection of a pixel's line of sight; `None` beside the mirror.
    pub(super) fn reflect(&self, at_px: DVec2) -> Option<Reflection> {
        match self {
            Self::Lens(lens) => lens.reflect(at_px),
            Self::Ball(ball) => ball.reflect(at_px),
        }
    }

    /// Whether a pixel shows the probe's front.
    pub(super) fn is_at(&self, at_px: DVec2) -> bool {
        match self {
            Self::Lens(lens) => lens.place(at_px).is_some(),
            Self::Ball(ball) => ball.reflect(at_px).is_some(),
        }
    }

    /// Corners of a box around it in front of the camera; `None` if one is behind it.
    pub(super) fn corners_px(&self) -> Option<[DVec2; 8]> {
        let (viewpoint, radius_m, height) = match self {
            Self::Lens(lens) => (&lens.viewpoint, lens.radius_m, 0.0),
            Self::Ball(ball) => (&ball.viewpoint, ball.radius_m, 1.0),
        };
        let mut corners = [DVec2::ZERO; 8];
        for (index, corner) in corners.iter_mut().enumerate() {
            let side = |bit: usize| if index & bit == 0 { -radius_m } else { radius_m };
            *corner = viewpoint.pixel(DVec3::new(side(1), height * side(2), side(4)))?;
        }
        Some(corners)
    }
}
