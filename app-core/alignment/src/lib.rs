//! Alignment: camera, toy and lights, corrected by the photograph.
//!
//! No tracker knows where a toy is to a tenth of a pixel, and no person where a lamp is to a tenth of a degree;
//! both show in the picture at once. The **table** beside the toy gives the camera (`camera`), since plates show
//! its texture. Frame against plate is the best segmentation there is: the **outline** of the toy gives its pose,
//! and its feet stand on the table (`pose`); the outline of its **shadow**, a second view of the toy from the
//! light, gives the light (`lights`). If the outline shows that the toy differs from its **model**, the model is
//! displaced to match it (`adapted`). Outline and shadow then correct pose and light together (`joint_pose`). Both
//! papers name misregistration as their largest error and leave it there.
//!
//! ```text
//! frame, plates ─► camera ─► pyramid ─┐
//! physical pose ─► shape ─────────────┴► pose ─► model ─► lights ─► things ─► pose and lights ─► Alignment
//! ```
//!
//! If the receiver below the toy reflects it, the reflection is estimated as well, once per session, and removed
//! for the shadows (`lights/reflection`).
//!
//! The softness of the photograph, relative to its plate and at the toy's outline, is measured as well
//! (`softness`), and so is its noise beside the plate's ([`Grain`](app_scene::grain::Grain)).
//!
//! On request, the **focal length** or the **scale** of the world is estimated first, from toy and shadow
//! together (`ratio`), and before all else the distortion of the **lens** ([`Aligner::lens`]), which is removed
//! from photographs.
//!
//! Some quantities are fixed, since pictures do not constrain them separately: the first plate's camera, to which
//! all others are relative, the principal point, and the receivers. All is solved in camera space, from numbers
//! of 32 bits: the correction does not depend on the world's origin, except for the last bits. A correction is
//! applied only if it explains the picture better by more than noise ([`Aligner::align`]).
//!
//! It runs on the processor. At 1280 x 720 one core of a desktop takes 0.5 to 1.3 s for a pose, once a view, and
//! 1 to 7 s for the lights, once a session, growing with the number of triangles and lights. A camera takes about
//! as long as a pose, once a view and once for each of the first 32 plates; unlisted lights 1 to 5 s, and a focal
//! length 2 to 12 s more, once a session. If no light is found without a plate, the first, second, fourth,
//! eighth... view after that is searched again.

#![forbid(unsafe_code)]

mod adapted;
mod before_toy;
mod camera;
mod directions;
mod error;
mod found;
mod found_planes;
mod gloss;
mod hand;
mod joint_pose;
mod kept_lights;
mod kept_reflection;
mod light_search;
mod lights;
mod measured_points;
mod median;
mod no_light;
mod observer;
mod outlines;
mod photograph;
mod picture;
mod placed_receivers;
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
mod smaller;
mod softness;
mod standing_search;
mod thing_lights;
mod thing_watcher;
mod things;
mod toy_search;
mod unknown_ratio;
mod view;
mod warning;
mod withheld;
mod without_people;

use std::sync::Arc;

use glam::DMat4;

use crate::probe::ProbeReport;
use adapted::MOST_ADAPTED_PX;
use app_scene::frame::FrameInput;
use app_scene::geometry::used_lights::UsedLights;
use app_scene::gloss::Gloss;
use app_scene::scene::{Light, Plate, Scene};
use app_scene::things::Things;
use app_scene::toy::ToyError;
use before_toy::LightsOfView;
use kept_lights::KeptLights;
use kept_reflection::KeptReflection;
use photograph::{MOST_OUTLINE_PX, Photograph};
use picture::Mask;
use ratio::{Ratio, Unknown};
use view::{AlignedView, Seen};

pub use directions::LightSearch;
pub use error::AlignError;
pub use found::Alignment;
pub use no_light::NoLight;
pub use observer::Observer;
pub use outlines::Outlines;
pub use report::{
    AlignmentReport, AssumedLight, CameraAlignment, EstimatedLight, LensAlignment, LightAlignment,
    LightDeviation, ModelAlignment, PlaneAlignment, PoseAlignment, PoseDeviation, RatioAlignment,
    RatioOutcome, Stand,
};
pub use silhouette::Silhouette;
pub use standing_search::{NewObject, StandingPose, StandingSearch, TableChange};
pub use thing_watcher::{Conditions, ThingWatcher, Watched};
pub use toy_search::{FoundToy, ToySearch, ViewDirection, find_toy};
pub use warning::AlignmentWarning;

/// A model is adapted in one of the first views that it does not fit, or never: each attempt takes about a second.
const MOST_ADAPTATIONS: usize = 2;

/// Number of plates whose cameras are aligned; each takes as long as a frame.
const MOST_ALIGNED_PLATES: usize = 32;

/// Width of the unread margin around withheld shadows, over the picture's width: for the camera, whose pose is then
/// still the tracker's, and for the pose.
const CAMERA_GROWN: f64 = 0.05;
const POSE_GROWN: f64 = 0.01;

/// Aligns the frames of one scene, one after the other.
///
/// A frame with the same picture, camera, pose and lights as the one before costs nothing. The toy is assumed static in
/// the world: its pose is kept as long as the picture agrees, whatever a tracker reports, and is estimated anew after a
/// nudge. Lights are estimated in the first frame that shows their shadow, and kept while the shadow stays. If it
/// changes, a lamp was moved or switched on: lights are estimated anew, and plates are relit. If none are listed, they
/// are searched around the estimates from the scene's probe, or without one all over the hemisphere. A probe's estimate
/// stays if no shadow shows the light.
#[derive(Debug)]
pub struct Aligner {
    /// The scene as it was given.
    given: Arc<Scene>,
    scene: Arc<Scene>,
    /// The scene that the latest alignment reported.
    reported_scene: Arc<Scene>,
    /// The ratio to estimate, on request.
    ratio: Ratio,
    are_plates_aligned: bool,
    cameras: camera::Finder,
    view: Option<AlignedView>,
    /// The pose in the latest view that showed the toy's place.
    held: Option<DMat4>,
    lights: Option<KeptLights>,
    /// The things in the latest view.
    things: Option<Things>,
    /// Memories of the search for things in the previous view, and in this one.
    memories: [Option<things::Memory>; 2],
    /// The reflection of the receiver under the toy, once it was searched.
    reflection: KeptReflection,
    /// Planes of things on the table.
    planes: found_planes::FoundPlanes,
    /// Whether the scene's plates were relit.
    is_relit: bool,
    are_shadows_withheld: bool,
    /// Gloss of the toy, from the first view that shows it at its place.
    gloss: Option<Gloss>,
    /// The adapted model, once there is one.
    model: Option<ModelAlignment>,
    /// Number of attempts to adapt the model.
    n_adaptations: usize,
    /// The probe's report, once it was needed.
    probe: Option<ProbeReport>,
    /// The lights by which a second look at the toy was decided.
    lights_of_view: Option<LightsOfView>,
}

impl Aligner {
    /// An aligner of a scene, without any frame yet.
    #[must_use]
    pub fn new(scene: impl Into<Arc<Scene>>) -> Self {
        let scene = scene.into();
        Self {
            reported_scene: Arc::clone(&scene),
            given: Arc::clone(&scene),
            scene,
            ratio: Ratio::default(),
            are_plates_aligned: false,
            cameras: camera::Finder::default(),
            view: None,
            held: None,
            lights: None,
            things: None,
            memories: [None, None],
            gloss: None,
            reflection: KeptReflection::default(),
            planes: found_planes::FoundPlanes::default(),
            is_relit: false,
            are_shadows_withheld: false,
            model: None,
            n_adaptations: 0,
            probe: None,
            lights_of_view: None,
        }
    }

    /// Reads shadows in the first view alone: later frames have the same lights, and pixels in or close to their
    /// shadows are not read. For measuring the accuracy of predicted shadows.
    pub fn withhold_shadows(&mut self) {
        self.are_shadows_withheld = true;
    }

    /// Estimates the focal length as well, in the first view that shows toy and shadows: up to 3 % off, the same for
    /// all frames and plates. That takes several times as long as all else, and is ambiguous with the size or height of
    /// toy and receivers.
    #[must_use]
    pub fn with_unknown_focal_length(mut self) -> Self {
        self.ratio = Ratio::of(Unknown::FocalLength);
        self
    }

    /// Estimates the scale of the world instead of the focal length, in the same way: lengths up to 3 % larger or
    /// smaller than by the toy's model, for a tracker whose scale is wrong. Poses of the toy are scaled, and all else
    /// stays as given.
    #[must_use]
    pub fn with_unknown_world_scale(mut self) -> Self {
        self.ratio = Ratio::of(Unknown::WorldScale);
        self
    }

    /// The scene to show frames with; its plates' cameras are corrected once a frame was aligned.
    #[must_use]
    pub fn scene(&self) -> &Arc<Scene> {
        &self.scene
    }

    /// The conditions of a search for things in the pictures that follow; `None` if the latest one
    /// does not show the toy at its place, or if its shadows are withheld.
    #[must_use]
    pub fn conditions(&self) -> Option<Conditions> {
        let view = self.view.as_ref()?;
        let lights = self.lights.as_ref()?.in_use();
        let (scene, reflection) = (&self.scene, self.reflection.found);
        let is_trusted = view.is_trusted(MOST_OUTLINE_PX) && !self.are_shadows_withheld;
        is_trusted.then(|| Conditions::new(scene, lights, reflection, view.sharpness.plate_spread))
    }

    /// Estimates the camera of a frame, the pose of the toy in it and the lights, and corrects each if the picture is
    /// then explained better by more than noise and the model's own errors: the table must match more of its plates,
    /// the more the camera moves; the picture of the outline must be e^6 times as likely, with neighbouring pixels
    /// counted once; the loss of the shadows must fall by a twenty-fifth and to less than a tenth of the loss without
    /// lights, and a light must move visibly. Once pose and lights are both corrected, outline and shadow correct them
    /// together. If the picture shows the toy nowhere near, the input's pose stays.
    ///
    /// # Errors
    /// When a value of the scene or of the input is invalid, a picture is not of the scene's size,
    /// or the toy cannot be posed.
    pub fn align(&mut self, input: &FrameInput) -> Result<Alignment, AlignError> {
        error::check(&self.scene, input)?;
        let listed = input.lights_in(&self.scene);
        let used = UsedLights::near(&self.scene, &listed, &input.world_from_object);
        let given = used.of(&listed);
        let input = &self.with_ratio(input, &given)?;
        let is_view_known = self.view.as_ref().is_some_and(|view| view.is_of(input));
        // Estimated lights stay as long as the list does not change.
        let kept = self.lights.take().filter(|lights| lights.given == given);
        if is_view_known && kept.is_some() {
            self.lights = kept;
            return Ok(self.aligned(input, (&listed, &used)));
        }
        self.align_plates();
        if given.is_empty() && self.probe.is_none() {
            self.probe = self.scene.probe.as_ref().map(ProbeReport::of).transpose()?;
        }
        if !is_view_known {
            self.memories[0] = self.memories[1].take();
        }
        let seen = match self.view.take().filter(|_| is_view_known) {
            Some(view) => Seen::again(&self.scene, view, input),
            None => {
                let seen = self.see(input, kept.as_ref())?;
                self.past_things(seen, input, (kept.as_ref(), &given))?
            }
        };
        let seen = self.with_adapted_model(seen)?;
        let seen = self.on_placed_receivers(seen, input)?;
        let seen = self.with_lights(seen, kept, given)?;
        self.lights_of_view = None;
        if seen.view.is_trusted(MOST_OUTLINE_PX) {
            self.held = Some(seen.view.world_from_object);
        }
        self.view = Some(seen.view);
        Ok(self.aligned(input, (&listed, &used)))
    }

    /// The view with the model adapted to the toy, in the first view that shows a difference. The pose stays.
    fn with_adapted_model(&mut self, mut seen: Seen) -> Result<Seen, ToyError> {
        let is_near = seen.view.is_trusted(MOST_ADAPTED_PX);
        let (picture_px, is_moving) = (seen.view.picture_px, seen.view.is_moving());
        let Some(pose) = &mut seen.view.report else {
            return Ok(seen);
        };
        let is_tried = self.model.is_some() || self.n_adaptations >= MOST_ADAPTATIONS;
        if is_tried || is_moving || !is_near || !pose::adapt::is_doubtful(pose, picture_px) {
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

    /// The view with receivers fitted under the toy, if their place is a guess and the picture shows the toy.
    fn on_placed_receivers(&mut self, seen: Seen, input: &FrameInput) -> Result<Seen, ToyError> {
        if !self.scene.uncertainty.are_receivers_guessed || !seen.view.is_trusted(MOST_OUTLINE_PX) {
            return Ok(seen);
        }
        let Some(receivers) = placed_receivers::placed_receivers(&self.scene, &seen.view.world_from_object)?
        else {
            return Ok(seen);
        };
        let scene = Arc::make_mut(&mut self.scene);
        scene.receivers = receivers;
        scene.uncertainty.are_receivers_guessed = false;
        Ok(Seen::again(&self.scene, seen.view, input))
    }

    /// Camera and pose in a new view.
    fn see(&mut self, input: &FrameInput, kept: Option<&KeptLights>) -> Result<Seen, ToyError> {
        let people = without_people::people(input).map(Arc::new);
        let unread = |withheld: Option<Mask>| match (withheld, &people) {
            (Some(withheld), Some(people)) => Some(Arc::new(withheld.with(people))),
            (withheld, people) => withheld.map(Arc::new).or(people.clone()),
        };
        let withheld = unread(self.withheld(input, (&input.camera, CAMERA_GROWN), kept)?);
        let Scene {
            plates, receivers, ..
        } = &*self.scene;
        let given = (input.image.rgba(), &input.camera, withheld.as_deref());
        let found = self
            .cameras
            .find(given, (plates, receivers), &self.scene.uncertainty.camera);
        let (camera, camera_report) = camera::corrected(&input.camera, found);
        let input_seen = input.clone().with_camera(camera);
        let withheld = unread(self.withheld(input, (&camera, POSE_GROWN), kept)?);
        let photograph = Photograph::without(&self.scene, &input_seen, withheld.as_deref());
        self.posed((photograph, people), input, (input_seen, camera_report))
    }

    /// The view of an input's toy in a photograph, whose input has the estimated camera and the given pose.
    fn posed(
        &self,
        (photograph, people): (Photograph, Option<Arc<Mask>>),
        input: &FrameInput,
        (mut input_seen, camera_report): (FrameInput, Option<CameraAlignment>),
    ) -> Result<Seen, ToyError> {
        let found = photograph.pose(&self.scene, &input_seen, self.held)?;
        input_seen.world_from_object = found.world_from_object;
        let outline_px = found.report.map(|pose| pose.spread_px);
        let sharpness = photograph.sharpness(&self.scene, &found.world_from_object, outline_px)?;
        let plate_spread = found.plate_spread(&sharpness);
        Ok(Seen {
            view: AlignedView {
                image: input.image.clone(),
                people,
                given_camera: input.camera,
                given: input.world_from_object,
                camera: input_seen.camera,
                camera_report,
                world_from_object: found.world_from_object,
                picture_px: found.picture_px,
                plate_spread,
                covariance: found.covariance,
                report: found.report,
                grain: photograph.grain(sharpness.plate_spread),
                sharpness,
            },
            photograph: photograph
                .around_toy(&self.scene, &found.world_from_object)
                .with_plate_as_soft(plate_spread),
            input: input_seen,
        })
    }

    /// Corrects the cameras of the first plates once, each relative to those before it.
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

    /// The result in the latest view, whose list of lights this is.
    fn aligned(&mut self, input: &FrameInput, (listed, used): (&[Light], &UsedLights)) -> Alignment {
        let reported = std::mem::replace(&mut self.reported_scene, Arc::clone(&self.scene));
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
            planes: self.planes.report.clone(),
        };
        let applied = lights.and_then(|lights| lights.in_list(listed, used));
        let is_off = view.is_some_and(|view| !view.is_trusted(MOST_OUTLINE_PX));
        let off = report.pose.filter(|_| is_off);
        let warnings = off.map(|pose| AlignmentWarning::Misaligned {
            outline_px: pose.shown_px(),
        });
        let off_receiver = report.pose.and_then(|pose| pose.off_receiver());
        let off_receiver = off_receiver
            .map(|Stand { height_m, lean_rad }| AlignmentWarning::OffReceiver { height_m, lean_rad });
        let is_moving = view.is_some_and(AlignedView::is_moving);
        let is_other = |pose: &PoseAlignment| !pose.is_of_model && !is_moving || self.model.is_some();
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
            scene: (!Arc::ptr_eq(&reported, &self.scene)).then(|| Arc::clone(&self.scene)),
            things: self.things.clone(),
            sharpness: view.map_or(input.sharpness, |view| view.sharpness),
            grain: input.grain.or(view.and_then(|view| view.grain)),
            gloss: self.gloss.unwrap_or(input.gloss),
            reflection: self.reflection.found.map(|found| found.reflection),
            report,
            warnings: warnings.collect(),
        }
    }
}
