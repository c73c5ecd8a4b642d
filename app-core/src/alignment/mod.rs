//! Alignment: the toy's pose and the lights, corrected by what the photograph shows.
//!
//! No tracker knows where a toy is to a tenth of a pixel, and no person where a lamp is to a tenth of a degree; both show in
//! the picture at once. Frame against plate is the best segmentation there is. The **outline** of the toy gives its pose
//! (`pose`); the outline of its **shadow**, a second view of the toy from the light, gives the light (`lights`).
//! Both papers name misregistration as their largest error and leave it there.
//!
//! ```text
//! frame, plate ─► pyramid ─┐
//! physical pose ─► shape ──┴► pose ─► lights ─► Alignment
//! ```
//!
//! What is held fixed, since pictures of one view do not tell it: the camera with its intrinsics, and the receivers.
//! All is solved in camera space, from numbers of 32 bits: wherever the world's origin is, the same correction comes out.
//! A correction is applied only where it explains the picture better by more than noise does ([`Aligner::align`]).
//!
//! It runs on the processor. At 1280 x 720 one core of a desktop takes 0.3 to 0.6 s for a pose, once a view, and 1 to 7 s for the
//! lights, once a session: more the more triangles and lights there are.

mod error;
mod lights;
mod outlines;
mod picture;
mod pose;
mod raster;
mod receivers;
pub(crate) mod report;
mod shape;

use std::sync::Arc;

use glam::DMat4;

use crate::frame::FrameInput;
use crate::frame::warning::Warning;
use crate::scene::{Camera, Image, Light, MAX_LIGHTS, Scene};
use crate::toy::ToyError;
use picture::{Picture, Pyramid};
use receivers::{SeenReceiver, plate_for};
use shape::Shape;

pub use error::AlignError;
pub use outlines::Outlines;
pub use report::{AlignmentReport, LightAlignment, PoseAlignment, PoseDeviation};

/// A found pose is applied where the outline's loss in the finest band falls to less than this part of the given pose's.
///
/// With exact poses it falls to .9, by what the model of the outline's pixels lacks. The wide band does not decide: where there is no
/// plate, a shadow beside the toy draws it along.
const POSE_GAIN: f64 = 0.5;
/// A pose whose outline stays farther from the picture's, in pixels, was not found.
const MOST_OUTLINE_PX: f64 = 1.0;
/// Found lights are applied where the loss falls to less than this part of the given lights'.
const LIGHT_GAIN: f64 = 0.96;
/// And where one of them turned by more than that part of its spread, and by more than that in radians; or grew by more.
const LEAST_TURN: f64 = 0.06;
const LEAST_TURN_RAD: f64 = 0.0015;
const LEAST_GROWTH: f64 = 0.15;

/// Where the toy and the lights of a frame are, by its picture.
#[derive(Clone, Debug)]
pub struct Alignment {
    /// Transform of the real toy, from object space to world: as given, where it was not corrected.
    pub world_from_object: DMat4,
    /// The lights; none where those that were given stay.
    pub lights: Option<Arc<[Light]>>,
    /// What was found.
    pub report: AlignmentReport,
    /// What could not be aligned.
    pub warnings: Vec<Warning>,
}

impl Alignment {
    /// The input that it was found for, corrected.
    #[must_use]
    pub fn applied_to(&self, input: &FrameInput) -> FrameInput {
        FrameInput {
            world_from_object: self.world_from_object,
            lights: self.lights.clone().or_else(|| input.lights.clone()),
            ..input.clone()
        }
    }
}

/// Aligns the frames of one scene, one after the other.
///
/// A frame with the same picture, camera and pose as the one before costs nothing. Lights are found in the first frame that
/// shows their shadow, and kept while the listed ones stay as they are.
#[derive(Debug, Default)]
pub struct Aligner {
    pose: Option<AlignedPose>,
    lights: Option<AlignedLights>,
}

/// The pose of the latest view.
#[derive(Debug)]
struct AlignedPose {
    image: Arc<Image>,
    camera: Camera,
    given: DMat4,
    world_from_object: DMat4,
    report: Option<PoseAlignment>,
}

/// Lights that were found.
#[derive(Debug)]
struct AlignedLights {
    given: Arc<[Light]>,
    /// None where those that were given stay.
    applied: Option<Arc<[Light]>>,
    report: Vec<LightAlignment>,
    errors: [f64; 2],
}

impl Aligner {
    /// Knows nothing yet.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Finds the pose of the toy in a frame and the lights, and corrects both where the picture is explained better by more than
    /// noise and the model's own errors do: the loss of the outline must halve, that of the shadows must fall by a
    /// twenty-fifth and a light move by enough to show.
    ///
    /// # Errors
    /// When a value of the input cannot be, a picture is not of the scene's size, or the toy cannot be posed.
    pub fn align(&mut self, scene: &Scene, input: &FrameInput) -> Result<Alignment, AlignError> {
        error::check(scene, input)?;
        let is_known = self.pose.as_ref().is_some_and(|pose| pose.is_of(input));
        let given_lights = input.lights.as_deref().unwrap_or(&scene.lights);
        let has_lights = (1..=MAX_LIGHTS).contains(&given_lights.len()) && !scene.plates.is_empty();
        let are_lights_known = self
            .lights
            .as_ref()
            .is_some_and(|lights| *lights.given == *given_lights);
        if !is_known || (has_lights && !are_lights_known) {
            let view = View::new(scene, input);
            if !is_known {
                self.pose = Some(view.pose(scene, input)?);
            }
            self.lights = match &self.pose {
                Some(pose) if has_lights && !are_lights_known && pose.is_trusted() => {
                    view.lights(scene, input, &pose.world_from_object, given_lights)?
                }
                _ => self.lights.take().filter(|_| are_lights_known),
            };
        }
        Ok(self.aligned(input))
    }

    fn aligned(&self, input: &FrameInput) -> Alignment {
        let (pose, lights) = (self.pose.as_ref(), self.lights.as_ref());
        let report = AlignmentReport {
            pose: pose.and_then(|pose| pose.report),
            lights: lights.map_or(Vec::new(), |lights| lights.report.clone()),
            light_errors: lights.map(|lights| lights.errors),
        };
        let off = report
            .pose
            .filter(|pose| !pose.is_applied && pose.given_outline_px > MOST_OUTLINE_PX);
        let warnings = off.map(|pose| Warning::Misaligned {
            outline_px: pose.given_outline_px,
        });
        Alignment {
            world_from_object: pose.map_or(input.world_from_object, |pose| pose.world_from_object),
            lights: lights.and_then(|lights| lights.applied.clone()),
            report,
            warnings: warnings.into_iter().collect(),
        }
    }
}

impl AlignedPose {
    fn is_of(&self, input: &FrameInput) -> bool {
        Arc::ptr_eq(&self.image, &input.image)
            && self.camera == input.camera
            && self.given == input.world_from_object
    }

    /// Whether the outline is where the picture has it.
    fn is_trusted(&self) -> bool {
        let outline_px = |pose: &PoseAlignment| {
            if pose.is_applied {
                pose.outline_px
            } else {
                pose.given_outline_px
            }
        };
        self.report
            .as_ref()
            .is_some_and(|pose| outline_px(pose) <= MOST_OUTLINE_PX)
    }
}

/// A photograph with its plate, and where the receivers are in it.
struct View {
    pyramid: Pyramid,
    receivers: Vec<SeenReceiver>,
    camera_from_world: DMat4,
}

impl View {
    fn new(scene: &Scene, input: &FrameInput) -> Self {
        let camera_from_world = input.camera.world_from_camera.inverse();
        let receivers = SeenReceiver::all(&scene.receivers, &camera_from_world);
        let plate = plate_for(&scene.plates, &receivers, &input.camera);
        let frame = Picture::decode(&input.image);
        Self {
            pyramid: Pyramid::new(frame, plate, input.camera.intrinsics),
            receivers,
            camera_from_world,
        }
    }

    /// Rounded to 32 bits, which are the same wherever the world's origin is.
    fn camera_from_object(&self, world_from_object: &DMat4) -> DMat4 {
        (self.camera_from_world * *world_from_object).as_mat4().as_dmat4()
    }

    fn pose(&self, scene: &Scene, input: &FrameInput) -> Result<AlignedPose, ToyError> {
        let given = input.world_from_object;
        let camera_from_object = self.camera_from_object(&given);
        let shape = Shape::new(scene, &camera_from_object)?;
        let found = pose::find(&shape, &self.pyramid);
        let mut aligned = AlignedPose {
            image: Arc::clone(&input.image),
            camera: input.camera,
            given,
            world_from_object: given,
            report: None,
        };
        if let Some(found) = found {
            let is_applied = found.found.is_nearer_than(&found.given)
                && found.found.loss_px2 < POSE_GAIN * found.given.loss_px2
                && found.found.outline_px() <= MOST_OUTLINE_PX;
            if is_applied {
                aligned.world_from_object =
                    input.camera.world_from_camera * found.motion * camera_from_object;
            }
            aligned.report = Some(PoseAlignment {
                is_applied,
                moved_m: found.moved_m,
                turned_rad: found.turned_rad,
                given_outline_px: found.given.outline_px(),
                outline_px: found.found.outline_px(),
                deviation: found.deviation,
            });
        }
        Ok(aligned)
    }

    fn lights(
        &self,
        scene: &Scene,
        input: &FrameInput,
        world_from_object: &DMat4,
        given: &[Light],
    ) -> Result<Option<AlignedLights>, ToyError> {
        let shape = Shape::new(scene, &self.camera_from_object(world_from_object))?;
        let world_from_camera = &input.camera.world_from_camera;
        let found = lights::find(given, &shape, &self.receivers, &self.pyramid, world_from_camera);
        Ok(found.map(|found| {
            let [before, after] = found.losses;
            let is_applied =
                after < LIGHT_GAIN * before && found.lights.iter().any(lights::FoundLight::is_moved);
            let lights = found.lights.iter().map(|found| found.light);
            AlignedLights {
                given: given.into(),
                applied: is_applied.then(|| lights.collect()),
                report: found
                    .lights
                    .iter()
                    .map(|found| found.report(is_applied))
                    .collect(),
                errors: found.losses,
            }
        }))
    }
}

impl lights::FoundLight {
    /// Whether it was found elsewhere by enough to show.
    fn is_moved(&self) -> bool {
        let growth = (self.spread - self.given_spread).abs();
        self.turned_rad > (LEAST_TURN * self.given_spread).max(LEAST_TURN_RAD)
            || growth > LEAST_GROWTH * self.given_spread
    }

    fn report(&self, is_applied: bool) -> LightAlignment {
        LightAlignment {
            is_applied,
            turned_rad: self.turned_rad,
            distance_ratio: self.distance_ratio,
            size_ratio: (self.given_spread > 0.0).then(|| self.spread / self.given_spread),
            deviation_rad: self.deviation_rad,
        }
    }
}
