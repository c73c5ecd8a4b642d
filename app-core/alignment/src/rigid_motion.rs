//! Small rigid motions of points in camera space, and their steps of six numbers.

use glam::{DMat4, DQuat, DVec3};
use nalgebra::{SMatrix, SVector};

use app_scene::scene::PoseUncertainty;

/// A step: rotation vector times a motion's lever, then translation in metres.
pub(super) type Vector6 = SVector<f64, 6>;
/// Information about steps.
pub(super) type Matrix6 = SMatrix<f64, 6, 6>;

/// A rotation about a pivot, then a translation, in camera space.
#[derive(Clone, Copy, Debug)]
pub(super) struct RigidMotion {
    pivot: DVec3,
    /// Conversion of a step's first three numbers to radians: 1, or a length in metres for steps of
    /// six lengths.
    lever: f64,
    rotation: DQuat,
    /// In metres.
    translation: DVec3,
}

impl RigidMotion {
    /// The identity, for points around `pivot`.
    pub(super) fn none(pivot: DVec3, lever: f64) -> Self {
        Self {
            pivot,
            lever,
            rotation: DQuat::IDENTITY,
            translation: DVec3::ZERO,
        }
    }

    /// A turn about the camera, by a rotation vector in radians; its steps are in radians, too.
    pub(super) fn about_camera(turn: DVec3) -> Self {
        Self {
            rotation: DQuat::from_scaled_axis(turn),
            ..Self::none(DVec3::ZERO, 1.0)
        }
    }

    /// The matrix from camera space to camera space.
    pub(super) fn matrix(&self) -> DMat4 {
        DMat4::from_translation(self.centre())
            * DMat4::from_quat(self.rotation)
            * DMat4::from_translation(-self.pivot)
    }

    /// Turns a direction.
    pub(super) fn turn_of(&self, direction: DVec3) -> DVec3 {
        self.rotation * direction
    }

    /// Distance in metres that the pivot moves.
    pub(super) fn moved_m(&self) -> f64 {
        self.translation.length()
    }

    /// Angle in radians.
    pub(super) fn turned_rad(&self) -> f64 {
        self.rotation.to_scaled_axis().length()
    }

    /// Moves a point.
    pub(super) fn apply(&self, point: DVec3) -> DVec3 {
        self.rotation * (point - self.pivot) + self.centre()
    }

    /// The present place of the pivot.
    pub(super) fn centre(&self) -> DVec3 {
        self.pivot + self.translation
    }

    /// Followed by a step whose turn is about the present pivot.
    pub(super) fn then(&self, step: &Vector6) -> Self {
        self.turned(self.turn(step), self.translation + shift(step))
    }

    /// Followed by a step whose turn is about the camera.
    pub(super) fn then_about_camera(&self, step: &Vector6) -> Self {
        let turn = self.turn(step);
        self.turned(turn, turn * self.centre() + shift(step) - self.pivot)
    }

    /// The nearest motion within a pose's uncertainty.
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

    /// The motion itself as a step.
    pub(super) fn numbers(&self) -> Vector6 {
        step_of(self.lever * self.rotation.to_scaled_axis(), self.translation)
    }

    /// The derivative by each number of a step at a point at that distance from the centre of its
    /// turn, if a metre along each axis counts `per_m`.
    pub(super) fn row(&self, from_centre: DVec3, per_m: DVec3) -> Vector6 {
        step_of(from_centre.cross(per_m) / self.lever, per_m)
    }

    fn turn(&self, step: &Vector6) -> DQuat {
        DQuat::from_scaled_axis(DVec3::new(step[0], step[1], step[2]) / self.lever)
    }

    fn turned(&self, turn: DQuat, translation: DVec3) -> Self {
        Self {
            rotation: (turn * self.rotation).normalize(),
            translation,
            ..*self
        }
    }
}

/// From its first and its last three numbers.
pub(super) fn step_of(turn: DVec3, shift: DVec3) -> Vector6 {
    Vector6::new(turn.x, turn.y, turn.z, shift.x, shift.y, shift.z)
}

fn shift(step: &Vector6) -> DVec3 {
    DVec3::new(step[3], step[4], step[5])
}
