//! The step of a toy's motion that produces the measured displacements of its outline.

use glam::{DVec2, DVec3};
use nalgebra::SMatrix;

use super::contour::Element;
use crate::rigid_motion::{Matrix6, RigidMotion, Vector6, step_of};
use app_scene::scene::Intrinsics;

/// Shift of a piece of the outline along its normal, in pixels, per unit of each number of a step.
fn outward(motion: &RigidMotion, element: &Element, k: &Intrinsics) -> Vector6 {
    let (point, per_m) = element.rim(k);
    motion.row(point - motion.centre(), per_m)
}

/// A measured displacement of a piece of the outline.
#[derive(Clone, Copy, Debug)]
pub(super) struct Measured {
    /// The piece.
    pub(super) element: Element,
    /// Displacement, positive out of the toy.
    pub(super) offset_px: f64,
    /// Reliability of the pixels there, from 0.
    pub(super) precision: f64,
    /// Robust weight: less for outliers.
    pub(super) robust: f64,
}

/// The weighted least squares step to the measured displacements.
///
/// `damping` regularises unconstrained directions, for example the turn of a toy of revolution.
/// `None` if nothing was measured.
pub(super) fn solve(
    measured: &[Measured],
    k: &Intrinsics,
    motion: &RigidMotion,
    damping: &Matrix6,
) -> Option<Vector6> {
    let (information, gradient) = normal_equations(measured, k, motion, damping);
    let factor = information.cholesky()?;
    (!measured.is_empty()).then(|| factor.solve(&gradient))
}

fn normal_equations(
    measured: &[Measured],
    k: &Intrinsics,
    motion: &RigidMotion,
    damping: &Matrix6,
) -> (Matrix6, Vector6) {
    let mut information = *damping;
    let mut gradient = Vector6::zeros();
    for one in measured {
        let row = outward(motion, &one.element, k);
        let weight = one.precision * one.robust * one.element.length_px;
        information += weight * row * row.transpose();
        gradient += weight * one.offset_px * row;
    }
    (information, gradient)
}

/// Motions that keep a toy upright on its plane: a turn about the plane's normal and shifts in two
/// directions along it.
pub(super) struct Held {
    normal: DVec3,
    /// Directions of the plane.
    across: [DVec3; 2],
    freedoms: SMatrix<f64, 6, 3>,
}

impl Held {
    /// Motions on the plane with the given unit normal in camera space.
    pub(super) fn to_plane(normal: DVec3) -> Self {
        let (a, b) = normal.any_orthonormal_pair();
        let turn = |axis: DVec3| step_of(axis, DVec3::ZERO);
        let shift = |along: DVec3| step_of(DVec3::ZERO, along);
        Self {
            normal,
            across: [a, b],
            freedoms: SMatrix::from_columns(&[turn(normal), shift(a), shift(b)]),
        }
    }

    /// A turn about the normal.
    pub(super) fn turn(&self, angle_rad: f64, radius_m: f64) -> Vector6 {
        step_of(angle_rad * radius_m * self.normal, DVec3::ZERO)
    }

    /// A shift along the plane, in metres.
    pub(super) fn shift(&self, by_m: DVec2) -> Vector6 {
        step_of(DVec3::ZERO, by_m.x * self.across[0] + by_m.y * self.across[1])
    }

    /// Like [`solve`], with only these degrees of freedom.
    pub(super) fn solve(
        &self,
        measured: &[Measured],
        k: &Intrinsics,
        motion: &RigidMotion,
        damping: &Matrix6,
    ) -> Option<Vector6> {
        let (information, gradient) = normal_equations(measured, k, motion, damping);
        let factor = (self.freedoms.transpose() * information * self.freedoms).cholesky()?;
        let step = self.freedoms * factor.solve(&(self.freedoms.transpose() * gradient));
        (!measured.is_empty()).then_some(step)
    }
}
