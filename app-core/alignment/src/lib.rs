//! Alignment: camera, toy and lights, corrected by what the photograph shows.
//!
//! No tracker knows where a toy is to a tenth of a pixel, and no person where a lamp is to a tenth of a degree; both show in
//! the picture at once. The **table** beside the toy gives the camera (`camera`), since plates say what it looks like. Frame against
//! plate is the best segmentation there is: the **outline** of the toy gives its pose, and its feet stand on the table (`pose`); the
//! outline of its **shadow**, a second view of the toy from the light, gives the light (`lights`). Where the outline shows that the toy
//! is not quite its **model**, the model is displaced to have the toy's (`adapted`).
//! Both papers name misregistration as their largest error and leave it there.
//!
//! ```text
//! frame, plates ─► camera ─► pyramid ─┐
//! physical pose ─► shape ─────────────┴► pose ─► model ─► lights ─► things ─► Alignment
//! ```
//!
//! How soft the photograph is, beside its plate and at the toy's outline, is measured on the way (`softness`).
//!
//! Where one of them is asked for, the **focal length** or the **scale** of the world is found first, by toy and shadow together (`ratio`);
//! before all else the distortion of the **lens** ([`Aligner::lens`]), of which photographs are freed.
//!
//! What is held fixed, since pictures do not tell it from the rest: the first plate's camera, to which all others are relative, the
//! principal point, and the receivers.
//! All is solved in camera space, from numbers of 32 bits: wherever the world's origin is, the same correction comes out, but for
//! the last of them. A correction is applied only where it explains the picture better by more than noise does ([`Aligner::align`]).
//!
//! It runs on the processor. At 1280 x 720 one core of a desktop takes 0.5 to 1.3 s for a pose, once a view, and 1 to 7 s for the
//! lights, once a session: more the more triangles and lights there are. A camera takes about as long as a pose, once a view and
//! once for each of the first 32 plates; lights that nobody lists 1 to 5 s, and a focal length 2 to 12 s more, once a session.

#![forbid(unsafe_code)]

mod adapted;
mod camera;
mod directions;
mod error;
mod hand;
mod kept_lights;
mod laid;
mod light_search;
mod lights;
mod median;
mod no_light;
mod observer;
mod outlines;
mod photograph;
mod picture;
pub mod plate_taker;
mod pose;
pub mod pose_filter;
pub mod probe;
mod raster;
mod ratio;
mod receivers;
pub(crate) mod report;
mod rigid_motion;
mod robust;
mod shape;
mod silhouette;
mod softness;
mod standing_search;
mod things;
mod toy_search;
mod view;
mod warning;
mod withheld;

use std::sync::Arc;

use glam::DMat4;

use crate::probe::ProbeReport;
use adapted::MOST_ADAPTED_PX;
use app_scene::frame::FrameInput;
use app_scene::scene::{Camera, Light, Plate, Scene};
use app_scene::sharpness::Sharpness;
use app_scene::things::Things;
use app_scene::toy::ToyError;
use kept_lights::KeptLights;
use photograph::{MOST_OUTLINE_PX, Photograph};
use picture::Mask;
use ratio::{Ratio, Unknown};
use view::{AlignedView, Seen};

pub use directions::LightSearch;
pub use error::AlignError;
pub use no_light::NoLight;
pub use observer::Observer;
pub use outlines::Outlines;
pub use report::{
    AlignmentReport, AssumedLight, CameraAlignment, DiscoveredLight, LensAlignment, LightAlignment,
    LightDeviation, ModelAlignment, PoseAlignment, PoseDeviation, RatioAlignment, RatioOutcome, Stand,
};
pub use silhouette::Silhouette;
pub use standing_search::{Newcomer, StandingPose, StandingSearch};
pub use toy_search::{FoundToy, ToySearch, ViewDirection, find_toy};
pub use warning::AlignmentWarning;

/// A model is adapted in one of the first views that it does not fit, or never: each try takes about a second.
const MOST_ADAPTATIONS: usize = 2;

/// Each plate takes as long as a frame; more than so many stay as they are given.
const MOST_ALIGNED_PLATES: usize = 32;

/// How far around shadows nothing is read where they are withheld, over the picture's width: by the camera, for which that of a
/// tracker is not yet corrected, and by the pose.
const CAMERA_GROWN: f64 = 0.05;
const POSE_GROWN: f64 = 0.01;

/// Where the toy and the lights of a frame are, by its picture.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Alignment {
    /// The camera: as given, where it was not corrected.
    pub camera: Camera,
    /// Transform of the real toy, from object space to world: as given, where it was not corrected.
    pub world_from_object: DMat4,
    /// The lights; none where those that were given stay.
    pub lights: Option<Arc<[Light]>>,
    /// The scene that the core is to be given before this frame is shown: its plates' cameras were corrected, its plates are in another
    /// light than before, its toy was adapted, or its receivers were laid under the toy. None if the core keeps the scene of the frame before, which for the
    /// first frame is the one that the [`Aligner`] was made with.
    pub scene: Option<Arc<Scene>>,
    /// Things that stand in the picture beside the toy; none where nothing tells of any.
    pub things: Option<Things>,
    /// How soft the picture is.
    pub sharpness: Sharpness,
    /// What was found.
    pub report: AlignmentReport,
    /// What could not be aligned.
    pub warnings: Vec<AlignmentWarning>,
}

impl Alignment {
    /// An input as given, of which nothing was found.
    #[must_use]
    pub fn new(input: &FrameInput) -> Self {
        Self {
            camera: input.camera,
            world_from_object: input.world_from_object,
            lights: None,
            scene: None,
            things: input.things.clone(),
            sharpness: input.sharpness,
            report: AlignmentReport::default(),
            warnings: Vec::new(),
        }
    }

    /// The input that it was found for, corrected.
    #[must_use]
    pub fn applied_to(&self, input: &FrameInput) -> FrameInput {
        input
            .clone()
            .with_camera(self.camera)
            .with_world_from_object(self.world_from_object)
            .with_lights(self.lights.clone().or_else(|| input.lights.clone()))
            .with_things(self.things.clone())
            .with_sharpness(self.sharpness)
    }
}

/// Aligns the frames of one scene, one after the other.
///
/// A frame with the same picture, camera, pose and lights as the one before costs nothing. The toy stands still in the world: its pose
/// is kept as long as the picture shows it there, whatever a tracker says, and found anew where it was nudged. Lights are found in
/// the first frame that shows their shadow, and kept while that is where they cast it. Where it is elsewhere, a lamp was moved or
/// switched on: lights are found anew, and plates are taken as they would be in the new light. Where none are listed they are looked
/// for around those that the scene's probe tells of, or without one all over the hemisphere. Lights that a probe tells stand as it
/// tells them where no shadow does.
#[derive(Debug)]
pub struct Aligner {
    scene: Arc<Scene>,
    /// The scene that the latest alignment was told with.
    told_scene: Arc<Scene>,
    /// Looked for where it was asked for.
    ratio: Ratio,
    are_plates_aligned: bool,
    cameras: camera::Finder,
    view: Option<AlignedView>,
    /// The pose in the latest view that showed where the toy is.
    held: Option<DMat4>,
    lights: Option<KeptLights>,
    /// In the latest view.
    things: Option<Things>,
    /// Whether the scene's plates are in another light than they were taken in.
    is_relit: bool,
    are_shadows_withheld: bool,
    /// Once it was adapted.
    model: Option<ModelAlignment>,
    /// How often another model was looked for.
    n_adaptations: usize,
    /// Once it was needed.
    probe: Option<ProbeReport>,
}

impl Aligner {
    /// Knows a scene, and none of its frames.
    #[must_use]
    pub fn new(scene: impl Into<Arc<Scene>>) -> Self {
        let scene = scene.into();
        Self {
            told_scene: Arc::clone(&scene),
            scene,
            ratio: Ratio::default(),
            are_plates_aligned: false,
            cameras: camera::Finder::default(),
            view: None,
            held: None,
            lights: None,
            things: None,
            is_relit: false,
            are_shadows_withheld: false,
            model: None,
            n_adaptations: 0,
            probe: None,
        }
    }

    /// Reads no shadow but in the first view: lights are those of that view, and of later pictures nothing is read where these
    /// lights cast a shadow, nor close beside. For measuring how well such shadows are predicted.
    pub fn withhold_shadows(&mut self) {
        self.are_shadows_withheld = true;
    }

    /// Looks for the focal length as well, in the first view that shows toy and shadows: up to 3 % off, the same for all frames and plates.
    /// That takes several times as long as all else, and a toy or a receiver of another size or height can be taken for it.
    #[must_use]
    pub fn with_unknown_focal_length(mut self) -> Self {
        self.ratio = Ratio::of(Unknown::FocalLength);
        self
    }

    /// Looks for the scale of the world in place of the focal length, in the same way: lengths that are up to 3 % larger or smaller than the
    /// toy's model says, such as those of a tracker whose metre is none. Poses of the toy are scaled, and all else stays as it is given.
    #[must_use]
    pub fn with_unknown_world_scale(mut self) -> Self {
        self.ratio = Ratio::of(Unknown::WorldScale);
        self
    }

    /// The scene, its plates' cameras corrected once a frame was aligned: what frames are to be shown with.
    #[must_use]
    pub fn scene(&self) -> &Arc<Scene> {
        &self.scene
    }

    /// Finds the camera of a frame, the pose of the toy in it and the lights, and corrects each where the picture is explained
    /// better by more than noise and the model's own errors do: the table must meet more of its plates, the more the farther it
    /// moves; the picture of the outline must be e^6 times as likely, with neighbouring pixels counted once; the loss of the shadows must
    /// fall by a twenty-fifth and to less than a tenth of what is there without lights, and a light move by enough to show. Where the
    /// picture shows the toy nowhere near, it is where the input says.
    ///
    /// # Errors
    /// When a value of the scene or of the input cannot be, a picture is not of the scene's size, or the toy cannot be posed.
    pub fn align(&mut self, input: &FrameInput) -> Result<Alignment, AlignError> {
        error::check(&self.scene, input)?;
        let given = input.lights_in(&self.scene);
        let input = &self.with_ratio(input, &given)?;
        let is_view_known = self.view.as_ref().is_some_and(|view| view.is_of(input));
        // Lights that were found stay as long as no others are listed.
        let kept = self.lights.take().filter(|lights| lights.given == given);
        if is_view_known && kept.is_some() {
            self.lights = kept;
            return Ok(self.aligned(input));
        }
        self.align_plates();
        if given.is_empty() && self.probe.is_none() {
            self.probe = self.scene.probe.as_ref().map(ProbeReport::of).transpose()?;
        }
        let seen = match self.view.take().filter(|_| is_view_known) {
            Some(view) => Seen::again(&self.scene, view, input),
            None => self.see(input, kept.as_ref())?,
        };
        let seen = self.with_adapted_model(seen)?;
        let seen = self.on_laid_receivers(seen, input)?;
        self.lights = Some(match kept {
            Some(kept) if self.are_shadows_withheld => kept,
            kept => self.look_at_lights(kept, given, &seen)?,
        });
        if seen.view.is_trusted(MOST_OUTLINE_PX) {
            self.held = Some(seen.view.world_from_object);
        }
        self.view = Some(seen.view);
        Ok(self.aligned(input))
    }

    /// The view with the model adapted to the toy, in the first that shows that it is not quite this one. The pose stays where it was
    /// found.
    fn with_adapted_model(&mut self, mut seen: Seen) -> Result<Seen, ToyError> {
        let Some(pose) = &mut seen.view.report else {
            return Ok(seen);
        };
        // Limits are in pixels of the largest level, which may be smaller than the picture.
        let picture_px = seen.photograph.pyramid().picture_px();
        let is_near = pose.shown_px() <= MOST_ADAPTED_PX * picture_px;
        let is_tried = self.model.is_some() || self.n_adaptations >= MOST_ADAPTATIONS;
        if is_tried || !is_near || !pose::adapt::is_doubtful(pose, picture_px) {
            return Ok(seen);
        }
        self.n_adaptations += 1;
        if let Some(adapted) = seen
            .photograph
            .adapted(&self.scene, &seen.view.world_from_object)?
        {
            let [_, outline_px] = adapted.report.outlines_px;
            (pose.given_outline_px, pose.outline_px) = (outline_px, outline_px);
            Arc::make_mut(&mut self.scene).toy = adapted.toy;
            self.model = Some(adapted.report);
        }
        Ok(seen)
    }

    /// The view with receivers under the toy, where it is a guess where they are and the picture shows the toy.
    fn on_laid_receivers(&mut self, seen: Seen, input: &FrameInput) -> Result<Seen, ToyError> {
        if !self.scene.uncertainty.are_receivers_guessed || !seen.view.is_trusted(MOST_OUTLINE_PX) {
            return Ok(seen);
        }
        let Some(receivers) = laid::laid(&self.scene, &seen.view.world_from_object)? else {
            return Ok(seen);
        };
        let scene = Arc::make_mut(&mut self.scene);
        scene.receivers = receivers;
        scene.uncertainty.are_receivers_guessed = false;
        Ok(Seen::again(&self.scene, seen.view, input))
    }

    /// The input with the focal length or the scale that was found; in a view that is not known it is looked for, until it was seen.
    fn with_ratio(&mut self, input: &FrameInput, given: &Arc<[Light]>) -> Result<FrameInput, AlignError> {
        let is_view_known = self.view.as_ref().is_some_and(|view| view.is_of(input));
        let is_withheld = self.are_shadows_withheld && self.lights.is_some();
        if self.ratio.is_open() && !is_view_known && !is_withheld {
            let lights = self.about(given, input)?;
            let mut scene = Scene::clone(&self.scene);
            if self.ratio.find(&mut scene, input, &lights) {
                self.scene = Arc::new(scene);
                self.are_plates_aligned = false;
                (self.view, self.held, self.lights) = (None, None, None);
            }
        }
        Ok(input
            .clone()
            .with_camera(self.ratio.camera(&input.camera))
            .with_world_from_object(self.ratio.pose(&input.world_from_object)))
    }

    /// Looks for the distortion of the lens that a frame and the plates were taken with, as if they were of a pinhole: two radial terms.
    /// All photographs are to be freed of it before they are aligned (`Capture::open_with_lens` of a session).
    ///
    /// # Errors
    /// As [`Self::align`].
    pub fn lens(&self, input: &FrameInput) -> Result<LensAlignment, AlignError> {
        error::check(&self.scene, input)?;
        let given = input.lights_in(&self.scene);
        let lights = self.about(&given, input)?;
        Ok(ratio::find_lens(&self.scene, input, &lights))
    }

    /// About where the lights are: as given, or as they are found with the focal length given.
    fn about(&self, given: &Arc<[Light]>, input: &FrameInput) -> Result<Arc<[Light]>, AlignError> {
        if !given.is_empty() {
            return Ok(Arc::clone(given));
        }
        let found = Self::new(Arc::clone(&self.scene)).align(input)?;
        Ok(found.lights.unwrap_or_default())
    }

    /// Camera and pose in a view that is not known.
    fn see(&mut self, input: &FrameInput, kept: Option<&KeptLights>) -> Result<Seen, ToyError> {
        let withheld = self.withheld(input, (&input.camera, CAMERA_GROWN), kept)?;
        let Scene {
            plates, receivers, ..
        } = &*self.scene;
        let given = (input.image.rgba(), &input.camera, withheld.as_ref());
        let found = self
            .cameras
            .find(given, (plates, receivers), &self.scene.uncertainty.camera);
        let (camera, camera_report) = camera::corrected(&input.camera, found);
        let mut input_seen = input.clone().with_camera(camera);
        let withheld = self.withheld(input, (&camera, POSE_GROWN), kept)?;
        let photograph = Photograph::new(&self.scene, &input_seen, withheld.as_ref());
        let found = photograph.pose(&self.scene, &input_seen, self.held)?;
        input_seen.world_from_object = found.world_from_object;
        let outline_px = found.report.map(|pose| pose.spread_px);
        let sharpness = photograph.sharpness(&self.scene, &found.world_from_object, outline_px)?;
        Ok(Seen {
            view: AlignedView {
                image: input.image.clone(),
                given_camera: input.camera,
                given: input.world_from_object,
                camera,
                camera_report,
                world_from_object: found.world_from_object,
                plate_spread_px: found.plate_spread_px,
                report: found.report,
                sharpness,
            },
            photograph: photograph.with_plate_spread(found.plate_spread_px),
            input: input_seen,
        })
    }

    /// What of a view is not to be read.
    fn withheld(
        &self,
        input: &FrameInput,
        (camera, grown): (&Camera, f64),
        lights: Option<&KeptLights>,
    ) -> Result<Option<Mask>, ToyError> {
        let Some(lights) = lights.filter(|_| self.are_shadows_withheld) else {
            return Ok(None);
        };
        let placed = input
            .clone()
            .with_camera(*camera)
            .with_world_from_object(self.held.unwrap_or(input.world_from_object));
        withheld::shadows(&self.scene, &placed, lights.in_use(), grown).map(Some)
    }

    /// Corrects the cameras of the first plates, each against those before it, once.
    fn align_plates(&mut self) {
        if std::mem::replace(&mut self.are_plates_aligned, true) {
            return;
        }
        for index in 0..self.scene.plates.len().min(MOST_ALIGNED_PLATES) {
            let (aligned, rest) = self.scene.plates.split_at(index);
            let Plate { image, camera } = &rest[0];
            let found = self.cameras.find(
                (image, camera, None),
                (aligned, &self.scene.receivers),
                &self.scene.uncertainty.camera,
            );
            let (aligned, _) = camera::corrected(camera, found);
            if aligned != *camera {
                Arc::make_mut(&mut self.scene).plates[index].camera = aligned;
            }
        }
    }

    fn aligned(&mut self, input: &FrameInput) -> Alignment {
        let told = std::mem::replace(&mut self.told_scene, Arc::clone(&self.scene));
        let (view, lights) = (self.view.as_ref(), self.lights.as_ref());
        let discovered = lights.and_then(|lights| lights.discovered.as_ref());
        let report = AlignmentReport {
            focal_length: self.ratio.report(Unknown::FocalLength),
            world_scale: self.ratio.report(Unknown::WorldScale),
            camera: view.and_then(|view| view.camera_report),
            pose: view.and_then(|view| view.report),
            model: self.model,
            lights: lights.map_or(Vec::new(), |lights| lights.report.clone()),
            light_errors: lights.and_then(|lights| lights.errors),
            discovered: discovered
                .and_then(|found| found.clone().ok())
                .unwrap_or_default(),
            no_light: discovered.and_then(|found| found.as_ref().err().copied()),
            assumed: lights.and_then(|lights| lights.assumed),
            is_long: lights.is_some_and(|lights| lights.is_long),
            unexplained: lights.and_then(KeptLights::unexplained),
            probe: self.probe.clone().filter(|_| discovered.is_some()),
            is_relit: self.is_relit,
        };
        let applied = lights.and_then(|lights| lights.applied.clone());
        let off = report.pose.filter(|pose| pose.shown_px() > MOST_OUTLINE_PX);
        let warnings = off.map(|pose| AlignmentWarning::Misaligned {
            outline_px: pose.shown_px(),
        });
        let off_receiver = report.pose.and_then(|pose| pose.off_receiver());
        let off_receiver = off_receiver
            .map(|Stand { height_m, lean_rad }| AlignmentWarning::OffReceiver { height_m, lean_rad });
        let is_other = |pose: &PoseAlignment| !pose.is_of_model || self.model.is_some();
        let differs = report.pose.filter(|pose| off.is_none() && is_other(pose));
        let differs = differs.map(|pose| AlignmentWarning::ModelDiffers {
            model_px: pose.model_px,
            displaced_m: self.model.map(|model| model.displaced_m),
        });
        let none = report.no_light.filter(|_| applied.is_none());
        let none = none.map(|reason| AlignmentWarning::LightNotFound { reason });
        let doubt = lights.and_then(KeptLights::doubt);
        let changed = doubt.map(|unexplained| AlignmentWarning::LightsChanged { unexplained });
        let assumed = report.assumed.map(|assumed| AlignmentWarning::LightAssumed {
            explained: assumed.explained,
        });
        let misfit = lights.and_then(KeptLights::misfit).filter(|_| doubt.is_none());
        let misfit = misfit.map(|unexplained| AlignmentWarning::ListUnexplained { unexplained });
        let ratio = self.ratio.warning().into_iter();
        let about_lights = none.into_iter().chain(assumed).chain(changed).chain(misfit);
        let about_toy = warnings.into_iter().chain(off_receiver).chain(differs);
        let warnings = ratio.chain(about_toy).chain(about_lights);
        Alignment {
            camera: view.map_or(input.camera, |view| view.camera),
            world_from_object: view.map_or(input.world_from_object, |view| view.world_from_object),
            lights: applied,
            scene: (!Arc::ptr_eq(&told, &self.scene)).then(|| Arc::clone(&self.scene)),
            things: self.things.clone(),
            sharpness: view.map_or(input.sharpness, |view| view.sharpness),
            report,
            warnings: warnings.collect(),
        }
    }
}
