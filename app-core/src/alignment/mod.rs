//! Alignment: camera, toy and lights, corrected by what the photograph shows.
//!
//! No tracker knows where a toy is to a tenth of a pixel, and no person where a lamp is to a tenth of a degree; both show in
//! the picture at once. The **table** beside the toy gives the camera (`camera`), since plates say what it looks like. Frame against
//! plate is the best segmentation there is: the **outline** of the toy gives its pose (`pose`); the outline of its **shadow**, a
//! second view of the toy from the light, gives the light (`lights`).
//! Both papers name misregistration as their largest error and leave it there.
//!
//! ```text
//! frame, plates ─► camera ─► pyramid ─┐
//! physical pose ─► shape ─────────────┴► pose ─► lights ─► Alignment
//! ```
//!
//! What is held fixed, since pictures do not tell it from the rest: the first plate's camera, to which all others are relative, the
//! intrinsics, and the receivers.
//! All is solved in camera space, from numbers of 32 bits: wherever the world's origin is, the same correction comes out, but for
//! the last of them. A correction is applied only where it explains the picture better by more than noise does ([`Aligner::align`]).
//!
//! It runs on the processor. At 1280 x 720 one core of a desktop takes 0.3 to 0.6 s for a pose, once a view, and 1 to 7 s for the
//! lights, once a session: more the more triangles and lights there are. A camera takes about as long as a pose, once a view and
//! once for each of the first 32 plates; lights that nobody lists 1 to 7 s more, and where there are none that again in each new
//! view.

mod camera;
mod error;
mod lights;
mod outlines;
mod photograph;
mod picture;
mod pose;
mod raster;
mod receivers;
mod rectangle;
pub(crate) mod report;
mod shape;

use std::sync::Arc;

use glam::DMat4;

use crate::frame::warning::Warning;
use crate::frame::{FrameInput, NoLight};
use crate::probe::{ProbeReport, TrackedLight};
use crate::scene::{Camera, Image, Light, MAX_LIGHTS, Plate, Scene, check};
use crate::toy::ToyError;
use photograph::{Discovered, FoundLights, MOST_OUTLINE_PX, Photograph};

pub use error::AlignError;
pub use outlines::Outlines;
pub use report::{
    AlignmentReport, CameraAlignment, DiscoveredLight, LightAlignment, LightDeviation, PoseAlignment,
    PoseDeviation,
};

/// Each plate takes as long as a frame; more than so many stay as they are given.
const MOST_ALIGNED_PLATES: usize = 32;
/// Lights are looked for with a pose whose outline is no farther from the picture's, in pixels.
///
/// Exact poses came out at up to 1.2, where a shadow beside the toy hides a part of the outline; 2 is that of no toy at all.
const DISCOVERY_OUTLINE_PX: f64 = 1.5;

/// Where the toy and the lights of a frame are, by its picture.
#[derive(Clone, Debug)]
pub struct Alignment {
    /// The camera: as given, where it was not corrected.
    pub camera: Camera,
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
            camera: self.camera,
            world_from_object: self.world_from_object,
            lights: self.lights.clone().or_else(|| input.lights.clone()),
            ..input.clone()
        }
    }
}

/// Aligns the frames of one scene, one after the other.
///
/// A frame with the same picture, camera, pose and lights as the one before costs nothing. The toy stands still in the world: its pose
/// is kept as long as the picture shows it there, whatever a tracker says, and found anew where it was nudged. Lights are found in
/// the first frame that shows their shadow, and kept while the listed ones stay as they are. Where none are listed they are looked
/// for around those that the scene's probe tells of, or without one all over the hemisphere. Lights that a probe tells stand as it
/// tells them where no shadow does.
#[derive(Debug)]
pub struct Aligner {
    scene: Scene,
    are_plates_aligned: bool,
    cameras: camera::Finder,
    view: Option<AlignedView>,
    /// The pose in the latest view that showed where the toy is.
    held: Option<DMat4>,
    lights: Option<AlignedLights>,
    /// Once it was needed.
    probe: Option<ProbeReport>,
}

/// Camera and pose in the latest view.
#[derive(Debug)]
struct AlignedView {
    image: Arc<Image>,
    given_camera: Camera,
    given: DMat4,
    camera: Camera,
    camera_report: Option<CameraAlignment>,
    world_from_object: DMat4,
    report: Option<PoseAlignment>,
}

/// Lights that were looked for.
#[derive(Debug)]
struct AlignedLights {
    given: Arc<[Light]>,
    /// None where those that were given stay.
    applied: Option<Arc<[Light]>>,
    /// Empty where they were not found in the latest view.
    report: Vec<LightAlignment>,
    errors: Option<[f64; 2]>,
    /// None where lights were given.
    discovered: Option<Discovered>,
}

impl Aligner {
    /// Knows a scene, and none of its frames.
    #[must_use]
    pub fn new(scene: Scene) -> Self {
        Self {
            scene,
            are_plates_aligned: false,
            cameras: camera::Finder::default(),
            view: None,
            held: None,
            lights: None,
            probe: None,
        }
    }

    /// The scene, its plates' cameras corrected once a frame was aligned: what frames are to be shown with.
    #[must_use]
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// Finds the camera of a frame, the pose of the toy in it and the lights, and corrects each where the picture is explained
    /// better by more than noise and the model's own errors do: the table must meet more of its plates, the more the farther it
    /// moves; the loss of the outline must halve; that of the shadows must fall by a twenty-fifth and a light move by enough to
    /// show. Where the picture shows the toy nowhere near, it is where the input says.
    ///
    /// # Errors
    /// When a value of the scene or of the input cannot be, a picture is not of the scene's size, or the toy cannot be posed.
    pub fn align(&mut self, input: &FrameInput) -> Result<Alignment, AlignError> {
        error::check(&self.scene, input)?;
        let given: Arc<[Light]> = match &input.lights {
            Some(lights) => Arc::clone(lights),
            None => self.scene.lights.as_slice().into(),
        };
        let is_view_known = self.view.as_ref().is_some_and(|view| view.is_of(input));
        // Other lights than those that were found; and those that were not found are looked for in each view.
        self.lights = self
            .lights
            .take()
            .filter(|lights| lights.given == given && (is_view_known || lights.are_found()));
        if !is_view_known || self.lights.is_none() {
            self.align_plates();
            let view = match self.view.take().filter(|_| is_view_known) {
                Some(view) => view,
                None => self.view(input)?,
            };
            if given.is_empty() && self.probe.is_none() {
                self.probe = self.scene.probe.as_ref().map(ProbeReport::of).transpose()?;
            }
            if self.lights.is_none() {
                self.lights = Some(self.find_lights(given, &view, input)?);
            }
            if view.is_trusted(MOST_OUTLINE_PX) {
                self.held = Some(view.world_from_object);
            }
            self.view = Some(view);
        }
        Ok(self.aligned(input))
    }

    /// Camera and pose in a view that is not known.
    fn view(&mut self, input: &FrameInput) -> Result<AlignedView, ToyError> {
        let Scene {
            plates, receivers, ..
        } = &self.scene;
        let found = self
            .cameras
            .find((&input.image, &input.camera), plates, receivers);
        let (camera, camera_report) = corrected(&input.camera, found);
        let seen = FrameInput {
            camera,
            ..input.clone()
        };
        let photograph = Photograph::new(&self.scene, &seen);
        let found = photograph.pose(&self.scene, &seen, self.held)?;
        Ok(AlignedView {
            image: Arc::clone(&input.image),
            given_camera: input.camera,
            given: input.world_from_object,
            camera,
            camera_report,
            world_from_object: found.world_from_object,
            report: found.report,
        })
    }

    /// The lights in a view, as far as it can tell.
    fn find_lights(
        &self,
        given: Arc<[Light]>,
        view: &AlignedView,
        input: &FrameInput,
    ) -> Result<AlignedLights, ToyError> {
        let seen = FrameInput {
            camera: view.camera,
            world_from_object: view.world_from_object,
            ..input.clone()
        };
        let photograph = || Photograph::new(&self.scene, &seen);
        if given.is_empty() {
            let told = self.probe.as_ref().map_or(&[][..], |probe| &probe.lights);
            let found = match &view.report {
                Some(pose) if view.is_trusted(DISCOVERY_OUTLINE_PX) => {
                    photograph().discover(&self.scene, &seen, &pose.deviation, told)?
                }
                _ => Err(NoLight::PoseUnknown),
            };
            return Ok(AlignedLights::discovered(given, found, told));
        }
        let can_tell = given.len() <= MAX_LIGHTS && !self.scene.plates.is_empty();
        let found = if can_tell && view.is_trusted(MOST_OUTLINE_PX) {
            photograph().lights(&self.scene, &seen, &given)?
        } else {
            None
        };
        Ok(AlignedLights::new(given, found))
    }

    /// Corrects the cameras of the first plates, each against those before it, once.
    fn align_plates(&mut self) {
        if std::mem::replace(&mut self.are_plates_aligned, true) {
            return;
        }
        for index in 0..self.scene.plates.len().min(MOST_ALIGNED_PLATES) {
            let (aligned, rest) = self.scene.plates.split_at_mut(index);
            let Plate { image, camera } = &mut rest[0];
            let found = self.cameras.find((image, camera), aligned, &self.scene.receivers);
            (*camera, _) = corrected(camera, found);
        }
    }

    fn aligned(&self, input: &FrameInput) -> Alignment {
        let (view, lights) = (self.view.as_ref(), self.lights.as_ref());
        let discovered = lights.and_then(|lights| lights.discovered.as_ref());
        let report = AlignmentReport {
            camera: view.and_then(|view| view.camera_report),
            pose: view.and_then(|view| view.report),
            lights: lights.map_or(Vec::new(), |lights| lights.report.clone()),
            light_errors: lights.and_then(|lights| lights.errors),
            discovered: discovered
                .and_then(|found| found.clone().ok())
                .unwrap_or_default(),
            no_light: discovered.and_then(|found| found.as_ref().err().copied()),
            probe: self.probe.clone().filter(|_| discovered.is_some()),
        };
        let applied = lights.and_then(|lights| lights.applied.clone());
        let off = report.pose.filter(|pose| pose.shown_px() > MOST_OUTLINE_PX);
        let warnings = off.map(|pose| Warning::Misaligned {
            outline_px: pose.shown_px(),
        });
        let none = report.no_light.filter(|_| applied.is_none());
        let none = none.map(|reason| Warning::LightNotFound { reason });
        Alignment {
            camera: view.map_or(input.camera, |view| view.camera),
            world_from_object: view.map_or(input.world_from_object, |view| view.world_from_object),
            lights: applied,
            report,
            warnings: warnings.into_iter().chain(none).collect(),
        }
    }
}

impl AlignedView {
    fn is_of(&self, input: &FrameInput) -> bool {
        Arc::ptr_eq(&self.image, &input.image)
            && self.given_camera == input.camera
            && self.given == input.world_from_object
    }

    /// Whether the outline is where the picture has it, within some pixels.
    fn is_trusted(&self, most_px: f64) -> bool {
        self.report.is_some_and(|pose| pose.shown_px() <= most_px)
    }
}

impl AlignedLights {
    fn new(given: Arc<[Light]>, found: Option<FoundLights>) -> Self {
        let (applied, report, errors) = match found {
            Some(found) => (found.applied, found.report, Some(found.errors)),
            None => (None, Vec::new(), None),
        };
        Self {
            given,
            applied,
            report,
            errors,
            discovered: None,
        }
    }

    /// Those that a probe tells stand where no shadow tells them.
    fn discovered(given: Arc<[Light]>, found: Discovered, told: &[TrackedLight]) -> Self {
        let lights: Arc<[Light]> = match &found {
            Ok(found) => found.iter().map(|found| found.light).collect(),
            Err(_) => told.iter().map(|told| told.light).collect(),
        };
        Self {
            given,
            applied: (found.is_ok() || !told.is_empty()).then_some(lights),
            report: Vec::new(),
            errors: None,
            discovered: Some(found),
        }
    }

    fn are_found(&self) -> bool {
        self.errors.is_some() || matches!(self.discovered, Some(Ok(_)))
    }
}

/// A camera as found: as given, where that explains the picture no better.
fn corrected(given: &Camera, found: Option<camera::Found>) -> (Camera, Option<CameraAlignment>) {
    let Some(found) = found else {
        return (*given, None);
    };
    let corrected = Camera {
        world_from_camera: found.world_from_camera,
        ..*given
    };
    let is_applied = found.is_better() && check::camera("camera", &corrected).is_ok();
    let camera = if is_applied { corrected } else { *given };
    (camera, Some(found.report(is_applied)))
}
