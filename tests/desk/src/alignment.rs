//! The frames of a session as the core receives them: as recorded, or aligned by their pictures.

use std::ops::Range;
use std::sync::Arc;
use std::time::Instant;

use app_core::alignment::{
    Aligner, Alignment, AlignmentReport, EstimatedLight, LensAlignment, Observer, RatioAlignment,
};
use app_core::frame::{FrameInput, Observations};
use app_core::preset::Preset;
use app_core::probe::TrackedLight;
use app_core::scene::{Camera, Light, Receiver, Scene};
use app_core::session::{Session, SessionFrame};
use glam::{DMat4, DVec3};
use serde::Serialize;

use crate::replay::ReplayError;

pub use crate::ratio::{Ratio, RatioArgs, Source};

/// The source of the lights.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::ValueEnum)]
pub enum Lights {
    /// The session's list; if that is empty, its probe, and without a probe the toy's shadow.
    #[default]
    Given,
    /// The frames alone: list and probe are ignored, and the result is compared with the list.
    Found,
    /// The session's probe: the list is ignored, and the result is compared with it.
    Probe,
}

/// Quantities to estimate from the pictures even if the session states them.
#[derive(Clone, Copy, Debug, Default)]
pub struct Asked {
    /// The lights.
    pub lights: Lights,
    /// The focal length, or the scale of the world.
    pub ratio: Ratio,
}

/// Corrections of frames, estimated once for all presets, one frame after the other.
pub struct Alignments {
    lights: Lights,
    /// `None` if frames stay as they were recorded.
    aligner: Option<Aligner>,
    /// The observer of frames that stay as they were recorded.
    observer: Observer,
    /// Its observation of each frame.
    observed: Vec<Observed>,
    first: usize,
    found: Vec<Aligned>,
    /// Plates with a corrected camera, by their index.
    moved_plates: Vec<(usize, Camera)>,
    /// The receivers, if they differ from the session's.
    receivers: Option<Vec<Receiver>>,
    /// Estimate of the lens, if it was requested.
    lens: Option<LensAlignment>,
}

/// The observation of a frame that stays as it was recorded.
struct Observed {
    index: usize,
    observations: Observations,
}

/// The alignment of one frame.
pub struct Aligned {
    /// The estimated toy pose and lights.
    pub alignment: Alignment,
    /// Time of the estimate on the processor.
    pub cpu_ms: f64,
    /// The session's lights that were ignored.
    pub put_aside: Vec<Light>,
    /// Centre of the toy in the world.
    middle: DVec3,
}

/// A light as it appears from a place.
#[derive(Clone, Copy, Debug)]
pub struct SeenLight {
    /// Unit vector to its centre.
    pub direction_in_world: DVec3,
    /// `None` for a light at infinity.
    pub distance_m: Option<f64>,
    /// Half its angular width.
    pub angular_radius_rad: f64,
}

/// Error of an estimated light.
#[derive(Clone, Debug, Serialize)]
pub struct LightError {
    /// Index of the light of the list that it is compared with.
    pub index: usize,
    /// Angle between the directions, in radians.
    pub direction_rad: f64,
    /// Estimated distance over the listed one; `None` if either light is at infinity.
    pub distance_ratio: Option<f64>,
    /// Estimated angular radius over the listed one; `None` for a point light.
    pub size_ratio: Option<f64>,
}

impl LightError {
    /// The error against the listed light in the nearest direction; `None` without a list.
    fn nearest(found: &SeenLight, listed: impl Iterator<Item = SeenLight>) -> Option<Self> {
        let error = |(index, listed): (usize, SeenLight)| Self {
            index,
            direction_rad: found.direction_in_world.angle_between(listed.direction_in_world),
            distance_ratio: found
                .distance_m
                .zip(listed.distance_m)
                .map(|(found, listed)| found / listed),
            size_ratio: (listed.angular_radius_rad > 0.0)
                .then(|| found.angular_radius_rad / listed.angular_radius_rad),
        };
        let errors = listed.enumerate().map(error);
        errors.min_by(|a, b| a.direction_rad.total_cmp(&b.direction_rad))
    }
}

impl SeenLight {
    /// A light that was found by its shadow, seen from the toy's centre.
    #[must_use]
    pub fn found(light: &EstimatedLight) -> Self {
        Self {
            direction_in_world: light.direction_in_world,
            distance_m: light.distance_m,
            angular_radius_rad: light.angular_radius_rad,
        }
    }

    /// A light seen from a place in the world.
    #[must_use]
    pub fn from(place: DVec3, light: &Light) -> Self {
        Self {
            direction_in_world: light.direction_from(place).unwrap_or(DVec3::Y),
            distance_m: light.distance_m_from(place),
            angular_radius_rad: light.angular_radius_rad_from(place),
        }
    }
}

impl Alignments {
    /// Frames as they were recorded.
    #[must_use]
    pub fn none() -> Self {
        Self {
            lights: Lights::Given,
            aligner: None,
            observer: Observer::default(),
            observed: Vec::new(),
            first: 0,
            found: Vec::new(),
            moved_plates: Vec::new(),
            receivers: None,
            lens: None,
        }
    }

    /// Adds the lens that was estimated when the session was opened.
    #[must_use]
    pub fn with_lens(mut self, lens: Option<LensAlignment>) -> Self {
        self.lens = lens;
        self
    }

    /// The estimate of the lens that is removed from photographs; `None` if it was not asked for.
    #[must_use]
    pub fn lens(&self) -> Option<&LensAlignment> {
        self.lens.as_ref()
    }

    /// An alignment without any frame yet.
    #[must_use]
    pub fn new(scene: &Scene, asked: Asked) -> Self {
        let aligner = Aligner::new(asked.lights.known(scene));
        let aligner = match asked.ratio {
            Ratio::Given => aligner,
            Ratio::FocalLength => aligner.with_unknown_focal_length(),
            Ratio::WorldScale => aligner.with_unknown_world_scale(),
        };
        Self {
            lights: asked.lights,
            aligner: Some(aligner),
            ..Self::none()
        }
    }

    /// Aligns frames one after the other.
    ///
    /// # Errors
    /// When a frame cannot be read or aligned.
    pub fn find(session: &dyn Session, frames: Range<usize>, asked: Asked) -> Result<Self, ReplayError> {
        Self::new(session.scene(), asked).aligning(session, frames)
    }

    /// Aligns all frames, and reads no shadow but that of the first picture.
    ///
    /// # Errors
    /// When a frame cannot be read or aligned.
    pub fn find_without_shadows(session: &dyn Session) -> Result<Self, ReplayError> {
        let mut aligner = Aligner::new(session.scene().clone());
        aligner.withhold_shadows();
        let found = Self {
            aligner: Some(aligner),
            ..Self::none()
        };
        found.aligning(session, 0..session.n_frames())
    }

    fn aligning(mut self, session: &dyn Session, frames: Range<usize>) -> Result<Self, ReplayError> {
        session.check_pictures(frames.clone())?;
        for index in frames {
            self.align(session.scene(), index, &session.frame(index)?)?;
        }
        Ok(self)
    }

    /// Aligns a frame of a session's scene: the first one, the next one, or one that is aligned
    /// already, which costs nothing.
    ///
    /// # Errors
    /// When it cannot be aligned.
    pub fn align(&mut self, scene: &Scene, index: usize, frame: &SessionFrame) -> Result<(), ReplayError> {
        if self.aligner.is_none() {
            return self.observe(scene, index, frame);
        }
        let is_known = self.of(index).is_some();
        let Some(aligner) = self.aligner.as_mut().filter(|_| !is_known) else {
            return Ok(());
        };
        let start = Instant::now();
        let alignment = aligner
            .align(&self.lights.input(frame))
            .map_err(|reason| ReplayError::Align {
                index,
                reason: Box::new(reason),
            })?;
        let cpu_ms = start.elapsed().as_secs_f64() * 1e3;
        self.moved_plates = moved_plates(scene, aligner.scene());
        self.receivers = other_receivers(scene, aligner.scene());
        if self.found.is_empty() {
            self.first = index;
        }
        self.found.push(Aligned {
            middle: middle(scene, &alignment.world_from_object),
            alignment,
            cpu_ms,
            put_aside: match self.lights {
                Lights::Given => Vec::new(),
                Lights::Found | Lights::Probe => scene.lights.clone(),
            },
        });
        Ok(())
    }

    /// Observes a frame that stays as it was recorded.
    fn observe(&mut self, scene: &Scene, index: usize, frame: &SessionFrame) -> Result<(), ReplayError> {
        if self.observed.iter().any(|observed| observed.index == index) {
            return Ok(());
        }
        let observed = self.observer.observed(scene, &self.lights.input(frame));
        let observed = observed.map_err(|reason| ReplayError::Align {
            index,
            reason: Box::new(reason),
        })?;
        self.observed.push(Observed {
            index,
            observations: observed.observations(),
        });
        self.receivers = other_receivers(scene, &self.observer.scene(scene));
        Ok(())
    }

    /// The scene that the core receives for a session's scene.
    #[must_use]
    pub fn scene(&self, given: &Scene) -> Scene {
        let mut scene = given.clone();
        for (index, camera) in &self.moved_plates {
            scene.plates[*index].camera = *camera;
        }
        if let Some(receivers) = &self.receivers {
            scene.receivers.clone_from(receivers);
        }
        scene
    }

    /// The scene from a frame on: its plates in another light if lights were moved, its toy in
    /// another shape, or planes of things among its receivers.
    #[must_use]
    pub fn changed_scene(&self, given: &Scene, index: usize) -> Option<Scene> {
        let now = self.of(index)?.alignment.scene.as_ref()?;
        // Corrected cameras of plates alone are no other scene.
        let mut pairs = now.plates.iter().zip(&given.plates);
        let is_relit = pairs.any(|(now, given)| !Arc::ptr_eq(&now.image, &given.image));
        let has_planes = now.receivers != given.receivers;
        let is_changed = is_relit || has_planes || !Arc::ptr_eq(&now.toy, &given.toy);
        is_changed.then(|| {
            self.scene(given)
                .with_plates(now.plates.clone())
                .with_toy(Arc::clone(&now.toy))
        })
    }

    /// Number of lights in the core's input of the last frame.
    #[must_use]
    pub fn n_lights(&self, given: &Scene, preset: Preset) -> usize {
        let found = self.found.last().and_then(|last| last.lights(preset));
        found.map_or(self.lights.listed(given).len(), |lights| lights.len())
    }

    /// The receivers, if they differ from the session's: fitted under the toy, or found planes.
    #[must_use]
    pub fn receivers(&self) -> Option<&[Receiver]> {
        self.receivers.as_deref()
    }

    /// Plates with a corrected camera, by their index.
    #[must_use]
    pub fn moved_plates(&self) -> &[(usize, Camera)] {
        &self.moved_plates
    }

    /// The focal length of all frames and plates, over the recorded one.
    #[must_use]
    pub fn focal_ratio(&self) -> f64 {
        self.ratio(|report| report.focal_length)
    }

    /// The scale of all poses of the toy, over the recorded one.
    #[must_use]
    pub fn world_scale(&self) -> f64 {
        self.ratio(|report| report.world_scale)
    }

    fn ratio(&self, of: impl Fn(&AlignmentReport) -> Option<RatioAlignment>) -> f64 {
        let last = self.found.last();
        let found = last.and_then(|last| of(&last.alignment.report));
        found.map_or(1.0, |found| if found.is_applied() { found.ratio } else { 1.0 })
    }

    /// The alignment of a frame; `None` if it stays as recorded.
    #[must_use]
    pub fn of(&self, index: usize) -> Option<&Aligned> {
        self.found.get(index.checked_sub(self.first)?)
    }

    /// The core's input for a frame with a preset.
    #[must_use]
    pub fn input(&self, index: usize, frame: &SessionFrame, preset: Preset) -> FrameInput {
        let input = self.lights.input(frame);
        match self.of(index) {
            Some(aligned) => aligned
                .alignment
                .applied_to(&input)
                .with_lights(aligned.lights(preset).or_else(|| input.lights.clone())),
            None => {
                let observed = self.observed.iter().find(|observed| observed.index == index);
                observed.map_or(input.clone(), |observed| {
                    input.with_observations(observed.observations.clone())
                })
            }
        }
    }
}

impl Aligned {
    /// The error of a probe's light against the ignored list; `None` if that is empty.
    #[must_use]
    pub fn error_of_probe_light(&self, light: &TrackedLight) -> Option<LightError> {
        let place = light.seen.origin_in_world;
        LightError::nearest(&SeenLight::from(place, &light.light), self.put_aside_from(place))
    }

    /// The same for a light that was found by its shadow.
    #[must_use]
    pub fn error_of_estimated(&self, light: &EstimatedLight) -> Option<LightError> {
        LightError::nearest(&SeenLight::found(light), self.put_aside_from(self.middle))
    }

    fn put_aside_from(&self, place: DVec3) -> impl Iterator<Item = SeenLight> {
        let put_aside = self.put_aside.iter();
        put_aside.map(move |light| SeenLight::from(place, light))
    }

    /// Estimated lights; `None` if the session's stay. With preset `paper`, lights from a probe are
    /// the paper's own: the viewer on the axis, without correction by the shadow.
    fn lights(&self, preset: Preset) -> Option<Arc<[Light]>> {
        let probe = self.alignment.report.probe.as_ref();
        let published = probe.filter(|probe| preset == Preset::Paper && !probe.published.is_empty());
        match published {
            Some(probe) => Some(probe.published.as_slice().into()),
            None => self.alignment.lights.clone(),
        }
    }
}

fn other_receivers(given: &Scene, now: &Scene) -> Option<Vec<Receiver>> {
    (now.receivers != given.receivers).then(|| now.receivers.clone())
}

fn moved_plates(given: &Scene, aligned: &Scene) -> Vec<(usize, Camera)> {
    let plates = given.plates.iter().zip(&aligned.plates).enumerate();
    let moved = plates.filter(|(_, (given, aligned))| given.camera != aligned.camera);
    moved
        .map(|(index, (_, aligned))| (index, aligned.camera))
        .collect()
}

impl Lights {
    /// The lights of a scene's list that are not ignored.
    fn listed(self, scene: &Scene) -> &[Light] {
        match self {
            Self::Given => &scene.lights,
            Self::Found | Self::Probe => &[],
        }
    }

    /// A scene without the ignored parts.
    pub(crate) fn known(self, scene: &Scene) -> Scene {
        let mut known = scene.clone();
        if self == Self::Found {
            known.probe = None;
        }
        known
    }

    pub(crate) fn input(self, frame: &SessionFrame) -> FrameInput {
        let input = FrameInput::from(frame);
        match self {
            Self::Given => input,
            Self::Found | Self::Probe => input.with_lights(Some(Arc::new([]))),
        }
    }
}

/// Centre of the box around the real toy, in the world.
pub fn middle(scene: &Scene, world_from_object: &DMat4) -> DVec3 {
    let bounds = scene.toy.bounds_of_pose(&scene.physical_pose);
    let middle = bounds.map_or(DVec3::ZERO, |bounds| 0.5 * (bounds.min + bounds.max).as_dvec3());
    world_from_object.transform_point3(middle)
}
