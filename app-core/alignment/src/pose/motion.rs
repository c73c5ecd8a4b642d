//! Small rigid motions of the toy, and the one that moves its outline as measured.

use glam::{DMat4, DQuat, DVec2, DVec3};
use nalgebra::{SMatrix, SVector};

use super::contour::Element;
use app_scene::scene::{Intrinsics, PoseUncertainty};

/// Rotation vector times the toy's radius, then translation: six lengths in metres.
pub(super) type Vector6 = SVector<f64, 6>;
/// Information about them: one over metres squared.
pub(super) type Matrix6 = SMatrix<f64, 6, 6>;

/// A rotation about a pivot, then a translation, in camera space.
#[derive(Clone, Copy, Debug)]
pub(super) struct Motion {
    pivot: DVec3,
    /// Turns six lengths into angles: the toy's radius, in metres.
    radius_m: f64,
    /// About the pivot.
    rotation: DQuat,
    /// In metres.
    translation: DVec3,
}

impl Motion {
    /// No motion of a toy around `pivot`.
    pub(super) fn none(pivot: DVec3, radius_m: f64) -> Self {
        Self {
            pivot,
            radius_m,
            rotation: DQuat::IDENTITY,
            translation: DVec3::ZERO,
        }
    }

    /// As a matrix, camera space to camera space.
    pub(super) fn matrix(&self) -> DMat4 {
        DMat4::from_translation(self.centre())
            * DMat4::from_quat(self.rotation)
            * DMat4::from_translation(-self.pivot)
    }

    /// Moves points.
    pub(super) fn apply(&self, points: &[DVec3]) -> Vec<DVec3> {
        let to = self.centre();
        points
            .iter()
            .map(|point| self.rotation * (*point - self.pivot) + to)
            .collect()
    }

    /// Where the pivot is now.
    fn centre(&self) -> DVec3 {
        self.pivot + self.translation
    }

    /// Followed by a step.
    pub(super) fn then(&self, step: &Vector6) -> Self {
        let turn = DVec3::new(step[0], step[1], step[2]) / self.radius_m;
        Self {
            rotation: (DQuat::from_scaled_axis(turn) * self.rotation).normalize(),
            translation: self.translation + DVec3::new(step[3], step[4], step[5]),
            ..*self
        }
    }

    /// The nearest motion that goes no farther than a pose is uncertain.
    pub(super) fn within(self, uncertainty: &PoseUncertainty) -> Self {
        let mut within = self;
        if let Some(most_m) = uncertainty.position_m {
            within.translation = within.translation.clamp_length_max(most_m);
        }
        let turn = within.rotation.to_scaled_axis();
        if let Some(most_rad) = uncertainty
            .rotation_rad
            .filter(|most_rad| turn.length() > *most_rad)
        {
            within.rotation = DQuat::from_scaled_axis(turn.clamp_length_max(most_rad));
        }
        within
    }

    /// How far a piece of the outline moves along its normal, in pixels, for each part of a step.
    ///
    /// That a rim slides over a curved surface as it turns counts only in the second order.
    fn outward(&self, element: &Element, k: &Intrinsics) -> Vector6 {
        let depth_m = element.depth_m;
        let slope_x = (element.at_px.x - k.cx_px) / k.fx_px;
        let slope_y = -(element.at_px.y - k.cy_px) / k.fy_px;
        let point = DVec3::new(slope_x, slope_y, -1.0) * depth_m;
        let (across, down) = (element.normal.x * k.fx_px, -element.normal.y * k.fy_px);
        let per_m = DVec3::new(across, down, across * slope_x + down * slope_y) / depth_m;
        let turn = (point - self.centre()).cross(per_m) / self.radius_m;
        Vector6::new(turn.x, turn.y, turn.z, per_m.x, per_m.y, per_m.z)
    }
}

/// A measured displacement of a piece of the outline.
#[derive(Clone, Copy, Debug)]
pub(super) struct Measured {
    /// The piece.
    pub(super) element: Element,
    /// Out of the toy.
    pub(super) offset_px: f64,
    /// How far the pixels can be trusted there, from 0.
    pub(super) precision: f64,
    /// That of robust estimation: less for what does not fit.
    pub(super) robust: f64,
}

/// The step that moves all pieces as measured, in weighted least squares, with the information that there is on it.
///
/// `damping` holds what the outline does not tell, such as how a toy of revolution is turned. None where nothing was measured.
pub(super) fn solve(
    measured: &[Measured],
    k: &Intrinsics,
    motion: &Motion,
    damping: &Matrix6,
) -> Option<(Vector6, Matrix6)> {
    let (information, gradient) = normal_equations(measured, k, motion, damping);
    let factor = information.cholesky()?;
    (!measured.is_empty()).then(|| (factor.solve(&gradient), information))
}

fn normal_equations(
    measured: &[Measured],
    k: &Intrinsics,
    motion: &Motion,
    damping: &Matrix6,
) -> (Matrix6, Vector6) {
    let mut information = *damping;
    let mut gradient = Vector6::zeros();
    for one in measured {
        let row = motion.outward(&one.element, k);
        let weight = one.precision * one.robust * one.element.length_px;
        information += weight * row * row.transpose();
        gradient += weight * one.offset_px * row;
    }
    (information, gradient)
}

/// Motions that keep a toy upright on its plane: a turn about the plane's normal and shifts in two directions of it.
pub(super) struct Held {
    normal: DVec3,
    /// Directions of the plane.
    across: [DVec3; 2],
    freedoms: SMatrix<f64, 6, 3>,
}

impl Held {
    /// By the plane's unit normal in camera space.
    pub(super) fn to_plane(normal: DVec3) -> Self {
        let (a, b) = normal.any_orthonormal_pair();
        let turn = |axis: DVec3| Vector6::new(axis.x, axis.y, axis.z, 0.0, 0.0, 0.0);
        let shift = |along: DVec3| Vector6::new(0.0, 0.0, 0.0, along.x, along.y, along.z);
        Self {
            normal,
            across: [a, b],
            freedoms: SMatrix::from_columns(&[turn(normal), shift(a), shift(b)]),
        }
    }

    /// A turn about the normal.
    pub(super) fn turn(&self, angle_rad: f64, radius_m: f64) -> Vector6 {
        let turn = angle_rad * radius_m * self.normal;
        Vector6::new(turn.x, turn.y, turn.z, 0.0, 0.0, 0.0)
    }

    /// A shift along the plane, in metres.
    pub(super) fn shift(&self, by_m: DVec2) -> Vector6 {
        let shift = by_m.x * self.across[0] + by_m.y * self.across[1];
        Vector6::new(0.0, 0.0, 0.0, shift.x, shift.y, shift.z)
    }

    /// As [`solve`] with these freedoms alone.
    pub(super) fn solve(
        &self,
        measured: &[Measured],
        k: &Intrinsics,
        motion: &Motion,
        damping: &Matrix6,
    ) -> Option<Vector6> {
        let (information, gradient) = normal_equations(measured, k, motion, damping);
        let factor = (self.freedoms.transpose() * information * self.freedoms).cholesky()?;
        let step = self.freedoms * factor.solve(&(self.freedoms.transpose() * gradient));
        (!measured.is_empty()).then_some(step)
    }
}
