//! A photograph with its plate, and the estimates of a toy's pose and lights from it.

mod base;
mod conditions;
mod unlit;

use std::sync::{Arc, OnceLock};

use glam::{DMat4, DVec3};

use super::lights::{FoundLight, Hints, InitialLight, Relight};
use super::picture::{Mask, Picture, Pyramid};
use super::receivers::{SeenReceiver, plate_for};
use super::report::{AssumedLight, EstimatedLight, LightAlignment, PoseAlignment, PoseDeviation};
use super::rigid_motion::Matrix6;
use super::shape::Shape;
use super::softness::is_motion;
use super::without_people::people;
use super::{lights, pose};
use crate::no_light::NoLight;
use crate::probe::TrackedLight;
use app_scene::frame::FrameInput;
use app_scene::scene::{Light, LightUncertainty, PoseUncertainty, Scene, check};
use app_scene::sharpness::{Sharpness, Spread};
use app_scene::toy::ToyError;
use unlit::UnlitToy;

/// Largest distance between the outlines of pose and picture, in pixels of the largest level, of a successful estimate.
pub(super) const MOST_OUTLINE_PX: f64 = 1.0;
/// Largest distance of the lowest point of a resting toy from its plane, over its radius.
const RESTING: f64 = 0.05;
/// Estimated lights are applied if the loss falls to less than this fraction of the given lights'.
const LIGHT_GAIN: f64 = 0.96;

/// Rounding tolerance of a bound.
const ROUNDING: f64 = 1e-6;

/// A photograph with its plate, and the receivers in its camera space.
pub(super) struct Photograph {
    pyramid: Arc<Pyramid>,
    receivers: Vec<SeenReceiver>,
    /// The place of each in the scene's list.
    in_scene: Vec<usize>,
    camera_from_world: DMat4,
    /// What does not depend on lights, once lights were judged.
    unlit: OnceLock<UnlitToy>,
}

impl Photograph {
    /// The pixels of people are not read.
    pub(super) fn new(scene: &Scene, input: &FrameInput) -> Self {
        Self::without(scene, input, people(input).as_ref())
    }

    /// Pixels that must not be read are unknown; those of people are among them.
    pub(super) fn without(scene: &Scene, input: &FrameInput, unread: Option<&Mask>) -> Self {
        Self::with(scene, input, |receivers| {
            let plate = plate_for(&scene.plates, receivers, &input.camera);
            let frame = Picture::without(input.image.rgba(), unread);
            Arc::new(Pyramid::new(frame, plate, input.camera.intrinsics))
        })
    }

    /// With pictures of the input's camera.
    pub(super) fn of(scene: &Scene, input: &FrameInput, pyramid: Arc<Pyramid>) -> Self {
        Self::with(scene, input, |_| pyramid)
    }

    /// With the pictures that show some receivers.
    fn with(
        scene: &Scene,
        input: &FrameInput,
        pyramid: impl FnOnce(&[SeenReceiver]) -> Arc<Pyramid>,
    ) -> Self {
        let camera_from_world = input.camera.world_from_camera.inverse();
        let (receivers, in_scene) =
            SeenReceiver::near_in_scene(scene, &input.world_from_object, &camera_from_world);
        Self {
            pyramid: pyramid(&receivers),
            receivers,
            in_scene,
            camera_from_world,
            unlit: OnceLock::new(),
        }
    }

    /// With the receivers around a toy in another place, the nearest first.
    pub(super) fn around_toy(self, scene: &Scene, world_from_object: &DMat4) -> Self {
        let (receivers, in_scene) =
            SeenReceiver::near_in_scene(scene, world_from_object, &self.camera_from_world);
        Self {
            receivers,
            in_scene,
            unlit: OnceLock::new(),
            ..self
        }
    }

    pub(super) fn pyramid(&self) -> &Arc<Pyramid> {
        &self.pyramid
    }

    /// Rounded to 32 bits, which are mostly the same for any origin of the world.
    pub(super) fn camera_from_object(&self, world_from_object: &DMat4) -> DMat4 {
        (self.camera_from_world * *world_from_object).as_mat4().as_dmat4()
    }

    /// The toy's pose, starting from its earlier or from its given one; the start stays if nothing
    /// better is found.
    pub(super) fn pose(
        &self,
        scene: &Scene,
        input: &FrameInput,
        held: Option<DMat4>,
    ) -> Result<FoundPose, ToyError> {
        let given = input.world_from_object;
        let uncertainty = &scene.uncertainty.toy;
        if let Some(held) = held.filter(|held| *held != given) {
            let start = self.start(scene, held)?;
            let found = self.pose_from(input, &start, &PoseUncertainty::default());
            if found.is_seen() && found.is_within(uncertainty) {
                return Ok(found);
            }
        }
        let start = self.start(scene, given)?;
        let found = self.pose_from(input, &start, uncertainty);
        if held.is_some() || found.is_seen() {
            return Ok(found);
        }
        // In the first view, a person may have placed the toy.
        let resting = self.pose_resting(input, &start, uncertainty);
        Ok(resting.filter(FoundPose::is_seen).unwrap_or(found))
    }

    /// A toy in the pose from which the search starts.
    fn start(&self, scene: &Scene, world_from_object: DMat4) -> Result<PoseStart, ToyError> {
        let shape = self.shape(scene, &world_from_object)?;
        Ok(PoseStart {
            paint: pose::Paint::new(scene, &self.camera_from_object(&world_from_object))?,
            ground: self.ground_under(scene, &shape),
            shape,
            world_from_object,
        })
    }

    /// The pose of a toy that rests on a receiver, as it does at the start; `None` if it does not
    /// rest.
    fn pose_resting(
        &self,
        input: &FrameInput,
        start: &PoseStart,
        uncertainty: &PoseUncertainty,
    ) -> Option<FoundPose> {
        let normal = start.ground?.plane.normal;
        let found = pose::find_resting(start.subject(), &self.pyramid, normal, uncertainty);
        Some(self.judged(input, start, found))
    }

    /// The ground that a toy may stand on; `None` if it floats.
    pub(super) fn ground_under(&self, scene: &Scene, shape: &Shape) -> Option<pose::Ground> {
        if scene.uncertainty.are_receivers_guessed {
            return None;
        }
        let most_m = match scene.resting {
            Some(true) => f64::INFINITY,
            Some(false) => return None,
            None => RESTING * shape.radius_m,
        };
        // The nearest first.
        let receivers = self.receivers.iter();
        let planes = receivers.filter_map(|receiver| receiver.plane_under(&shape.points, most_m));
        let up = self.camera_from_world.transform_vector3(DVec3::Y);
        Some(pose::Ground {
            plane: pose::Plane::most_level(planes, up)?,
            is_certain: scene.resting.is_some(),
        })
    }

    /// The estimate from a start, of whatever quality, with the distance of its outline in pixels
    /// of the largest level; `None` if too little of it is visible.
    pub(super) fn tried_pose(
        &self,
        scene: &Scene,
        (start, known): (&DMat4, pose::Start),
    ) -> Result<Option<(DMat4, f64)>, ToyError> {
        let camera_from_object = self.camera_from_object(start);
        let shape = Shape::new(scene, &camera_from_object)?;
        let found = pose::tried(&shape, &self.pyramid, known);
        Ok(found.map(|(motion, outline_px)| {
            let corrected = self.camera_from_world.inverse() * motion * camera_from_object;
            (corrected, outline_px)
        }))
    }

    /// The smallest level with at least that number of pixels, or the largest.
    pub(super) fn level_of(&self, n_pixels: i32) -> usize {
        let mut levels = (0..=Pyramid::SMALLEST).rev();
        let found = levels.find(|level| {
            let size_px = self.pyramid.level(*level).frame.size_px;
            size_px.x * size_px.y >= n_pixels
        });
        found.unwrap_or(0)
    }

    /// The toy in a pose.
    pub(super) fn shape(&self, scene: &Scene, world_from_object: &DMat4) -> Result<Shape, ToyError> {
        Shape::new(scene, &self.camera_from_object(world_from_object))
    }

    /// A toy's shape with receivers and pictures.
    pub(super) fn seen<'a>(&'a self, shape: &'a Shape) -> lights::View<'a> {
        lights::View {
            shape,
            receivers: &self.receivers,
            pyramid: &self.pyramid,
        }
    }

    fn pose_from(&self, input: &FrameInput, start: &PoseStart, uncertainty: &PoseUncertainty) -> FoundPose {
        let found = pose::find(start.subject(), &self.pyramid, uncertainty);
        self.judged(input, start, found)
    }

    /// The estimate from a start, or the start if that is as good.
    fn judged(&self, input: &FrameInput, start: &PoseStart, found: Option<pose::Found>) -> FoundPose {
        let PoseStart {
            shape,
            world_from_object: start,
            ..
        } = start;
        let camera_from_object = self.camera_from_object(start);
        let Some(found) = found else {
            return FoundPose {
                world_from_object: *start,
                picture_px: self.pyramid.picture_px(),
                plate_spread_px: 0.0,
                covariance: None,
                report: None,
            };
        };
        let corrected = input.camera.world_from_camera * found.motion * camera_from_object;
        let is_better = found.is_better()
            && found.is_met(MOST_OUTLINE_PX)
            && check::similarity(corrected.to_cols_array()).is_ok();
        let world_from_object = if is_better { corrected } else { *start };
        let middle = camera_from_object.inverse().transform_point3(shape.centre);
        let (moved_m, turned_rad) = apart(&input.world_from_object, &corrected, middle);
        let picture_px = self.pyramid.picture_px();
        FoundPose {
            world_from_object,
            picture_px,
            plate_spread_px: found.plate_spread_px,
            covariance: is_better.then_some(found.covariance),
            report: Some(PoseAlignment {
                is_applied: world_from_object != input.world_from_object,
                is_held: !is_better && *start != input.world_from_object,
                moved_m,
                turned_rad,
                given_outline_px: picture_px * found.outlines_px[0],
                outline_px: picture_px * found.outlines_px[1],
                deviation: found.deviation,
                size_ratio: corrected.x_axis.length() / input.world_from_object.x_axis.length(),
                model_px: picture_px * found.model_px,
                is_of_model: found.is_of_model(),
                texture_correlation: found.texture_correlation,
                spread_px: picture_px * found.spread_px,
                stand: found
                    .stands
                    .map(|[given, found]| if is_better { found } else { given }),
            }),
        }
    }

    /// Estimates the lights, with the toy in its place; `None` if too little of their shadows is
    /// visible.
    pub(super) fn lights(
        &self,
        scene: &Scene,
        input: &FrameInput,
        (given, uncertainty): (&[Light], &LightUncertainty),
    ) -> Result<Option<FoundLights>, ToyError> {
        let shape = self.shape(scene, &input.world_from_object)?;
        let world_from_camera = &input.camera.world_from_camera;
        let found = lights::find(
            (given, uncertainty),
            (&shape, &self.receivers),
            &self.pyramid,
            world_from_camera,
        );
        Ok(found.map(|found| {
            let [before, after] = found.losses;
            let lights: Arc<[Light]> = found.lights.iter().map(|found| found.light).collect();
            let is_applied = after < LIGHT_GAIN * before
                && found.lights.iter().any(FoundLight::is_moved)
                && lights.iter().all(|light| light.check("lights").is_ok());
            FoundLights {
                applied: is_applied.then_some(lights),
                report: found
                    .lights
                    .iter()
                    .map(|found| found.report(is_applied))
                    .collect(),
                errors: found.losses,
            }
        }))
    }

    /// The light in this photograph over that in its plate; `None` without a plate.
    pub(super) fn relight(&self, scene: &Scene, input: &FrameInput) -> Result<Option<Relight>, ToyError> {
        let shape = self.shape(scene, &input.world_from_object)?;
        let (receivers, pyramid) = (&self.receivers, &self.pyramid);
        Ok(Relight::of(&shape, receivers, pyramid, &self.camera_from_world))
    }

    /// Unlisted lights, with the toy in its place of uncertainty `pose`; around a probe's
    /// estimates, if there are any.
    pub(super) fn search_lights(
        &self,
        scene: &Scene,
        input: &FrameInput,
        pose: &PoseDeviation,
        by_probe: &[TrackedLight],
    ) -> Result<EstimatedLights, ToyError> {
        let shape = self.shape(scene, &input.world_from_object)?;
        let world_from_camera = &input.camera.world_from_camera;
        let middle_in_world = input.world_from_object.transform_point3(middle_of_toy(scene)?);
        let initial_lights = by_probe.iter();
        let initial_lights =
            initial_lights.filter_map(|light| InitialLight::new(light, &self.camera_from_world));
        let estimated = input.light_estimate.and_then(|light| light.direction_in_world());
        let hints = Hints {
            initial_lights: initial_lights.collect(),
            estimated: estimated.map(|direction| self.camera_from_world.transform_vector3(direction)),
        };
        let found = lights::search_lights(
            &shape,
            &self.receivers,
            &self.pyramid,
            world_from_camera,
            pose,
            &hints,
        );
        Ok(found.and_then(|mut found| {
            for found in &mut found {
                found.seen_from(middle_in_world);
            }
            let can_be = |found: &EstimatedLight| found.light.check("lights").is_ok();
            if found.iter().all(can_be) {
                Ok(found)
            } else {
                Err(NoLight::NoneDominant)
            }
        }))
    }

    /// A wide light if none is found, with the toy in its place; `None` if ambient light explains
    /// the picture about as well.
    pub(super) fn assume_wide(
        &self,
        scene: &Scene,
        input: &FrameInput,
    ) -> Result<Option<AssumedLight>, ToyError> {
        let shape = self.shape(scene, &input.world_from_object)?;
        let world_from_camera = &input.camera.world_from_camera;
        let assumed = lights::assume_wide(&shape, &self.receivers, &self.pyramid, world_from_camera);
        Ok(assumed.filter(|assumed| assumed.light.check("lights").is_ok()))
    }

    /// A line of lights in place of one, with the toy in its place; `None` if it explains no more.
    pub(super) fn line_of(
        &self,
        scene: &Scene,
        input: &FrameInput,
        light: &Light,
    ) -> Result<Option<Arc<[Light]>>, ToyError> {
        let shape = self.shape(scene, &input.world_from_object)?;
        let world_from_camera = &input.camera.world_from_camera;
        let line = lights::line_of(light, (&shape, &self.receivers), &self.pyramid, world_from_camera);
        let can_be = |line: &Vec<Light>| line.iter().all(|light| light.check("lights").is_ok());
        Ok(line.filter(can_be).map(Arc::from))
    }
}

/// A toy in the pose from which the search starts.
struct PoseStart {
    world_from_object: DMat4,
    shape: Shape,
    paint: pose::Paint,
    ground: Option<pose::Ground>,
}

impl PoseStart {
    fn subject(&self) -> pose::Subject<'_> {
        pose::Subject {
            shape: &self.shape,
            paint: &self.paint,
            ground: self.ground,
        }
    }
}

/// Centre of the toy's box in its physical pose, in its own space.
pub(super) fn middle_of_toy(scene: &Scene) -> Result<DVec3, ToyError> {
    let bounds = scene.toy.bounds_of_pose(&scene.physical_pose)?;
    Ok(0.5 * (bounds.min + bounds.max).as_dvec3())
}

/// Difference of two poses: metres that a point of the object moves, and the angle in radians.
pub(super) fn apart(a: &DMat4, b: &DMat4, point: DVec3) -> (f64, f64) {
    let moved_m = a.transform_point3(point).distance(b.transform_point3(point));
    let [a, b] = [a, b].map(|pose| pose.to_scale_rotation_translation().1);
    (moved_m, (b * a.inverse()).to_scaled_axis().length())
}

/// Unlisted lights, or the reason why there are none.
pub(super) type EstimatedLights = Result<Vec<EstimatedLight>, NoLight>;

/// A pose: given, kept or corrected.
pub(super) struct FoundPose {
    /// The pose, from object space.
    pub(super) world_from_object: DMat4,
    /// Pixels of the picture per pixel of the largest level.
    pub(super) picture_px: f64,
    /// The blur that makes the plate as soft as the photograph, in pixels of the largest level; 0
    /// if they are equally soft.
    plate_spread_px: f64,
    /// Covariance of a step of it in camera space; `None` if it was not estimated.
    pub(super) covariance: Option<Matrix6>,
    /// `None` if too little of the outline is visible.
    pub(super) report: Option<PoseAlignment>,
}

impl FoundPose {
    /// The blur of the plate in a photograph of this sharpness, in pixels of the picture: that of a motion, or
    /// the round one beside which the pose was found.
    pub(super) fn plate_spread(&self, sharpness: &Sharpness) -> Spread {
        let measured = sharpness.plate_spread;
        if is_motion(&measured) {
            measured
        } else {
            Spread::round(self.picture_px * self.plate_spread_px)
        }
    }

    /// Whether the outline fits the picture's.
    pub(super) fn is_seen(&self) -> bool {
        let most_px = MOST_OUTLINE_PX * self.picture_px;
        self.report.is_some_and(|pose| pose.shown_px() <= most_px)
    }

    /// Whether it is within the uncertainty of the given pose.
    fn is_within(&self, uncertainty: &PoseUncertainty) -> bool {
        let is_within =
            |away: f64, most: Option<f64>| most.is_none_or(|most| away <= (1.0 + ROUNDING) * most);
        self.report.is_none_or(|pose| {
            is_within(pose.moved_m, uncertainty.position_m)
                && is_within(pose.turned_rad, uncertainty.rotation_rad)
        })
    }
}

/// Estimated lights.
pub(super) struct FoundLights {
    /// `None` if the given ones stay.
    pub(super) applied: Option<Arc<[Light]>>,
    /// The report of each.
    pub(super) report: Vec<LightAlignment>,
    /// Mean losses with the given and with the estimated lights.
    pub(super) errors: [f64; 2],
}

impl EstimatedLight {
    /// Adds their direction, distance and size as seen from a place.
    pub(super) fn seen_from(&mut self, place_in_world: DVec3) {
        let direction = self.light.direction_from(place_in_world);
        self.direction_in_world = direction.unwrap_or(self.direction_in_world);
        self.distance_m = self.light.distance_m_from(place_in_world);
        self.angular_radius_rad = self.light.angular_radius_rad_from(place_in_world);
    }
}
