//! The place of a toy relative to the given one: a rigid motion, and a size.

use glam::{DMat4, DVec3};
use nalgebra::{SMatrix, SVector};

use super::contour::Element;
use crate::rigid_motion::{RigidMotion, Vector6};
use app_scene::scene::{Intrinsics, PoseUncertainty};

/// Number of unknowns: six numbers of a rigid step, then the logarithm of the size, then the offset
/// of the whole outline in pixels.
pub(super) const N_UNKNOWNS: usize = 8;
/// Index of the size, and of the offset.
pub(super) const SIZE: usize = 6;
pub(super) const OFFSET: usize = 7;

pub(super) type Unknowns = SVector<f64, N_UNKNOWNS>;
pub(super) type Information = SMatrix<f64, N_UNKNOWNS, N_UNKNOWNS>;

/// A similarity in camera space.
#[derive(Clone, Copy, Debug)]
pub(super) struct Placement {
    pub(super) motion: RigidMotion,
    /// Size over the given one, about the pivot.
    pub(super) size: f64,
    /// Outward offset of the whole outline, in pixels.
    pub(super) offset_px: f64,
}

impl Placement {
    pub(super) fn of(motion: RigidMotion) -> Self {
        Self {
            motion,
            size: 1.0,
            offset_px: 0.0,
        }
    }

    pub(super) fn apply(&self, point: DVec3) -> DVec3 {
        let centre = self.motion.centre();
        centre + self.size * (self.motion.apply(point) - centre)
    }

    /// Transform from camera space to camera space.
    pub(super) fn matrix(&self) -> DMat4 {
        let centre = self.motion.centre();
        DMat4::from_translation(centre)
            * DMat4::from_scale(DVec3::splat(self.size))
            * DMat4::from_translation(-centre)
            * self.motion.matrix()
    }

    /// Followed by a step, within a pose's uncertainty.
    pub(super) fn then(&self, step: &Unknowns, uncertainty: &PoseUncertainty) -> Self {
        let rigid = Vector6::from_iterator(step.iter().take(6).copied());
        Self {
            motion: self.motion.then(&rigid).within(uncertainty),
            size: self.size * step[SIZE].exp(),
            offset_px: self.offset_px + step[OFFSET],
        }
    }

    /// The derivative by each unknown at a point of the toy, if a metre along each axis counts
    /// `per_m`.
    pub(super) fn row(&self, point: DVec3, per_m: DVec3) -> Unknowns {
        let from_centre = point - self.motion.centre();
        let rigid = self.motion.row(from_centre, per_m);
        let mut row = Unknowns::zeros();
        row.fixed_rows_mut::<6>(0).copy_from(&rigid);
        row[SIZE] = from_centre.dot(per_m);
        row
    }

    /// Shift of a piece of the outline along its normal, in pixels, per unit of each unknown.
    pub(super) fn outward(&self, element: &Element, k: &Intrinsics) -> Unknowns {
        let (point, per_m) = element.rim(k);
        let mut row = self.row(point, per_m);
        row[OFFSET] = 1.0;
        row
    }
}
