//! The frames of a session as the core is given them: as recorded, or aligned by their pictures.

use std::ops::Range;
use std::sync::Arc;
use std::time::Instant;

use app_core::alignment::{
    Aligner, Alignment, AlignmentReport, DiscoveredLight, LensAlignment, RatioAlignment,
};
use app_core::frame::FrameInput;
use app_core::preset::Preset;
use app_core::scene::{Camera, Light, Scene};
use app_core::session::{Session, SessionFrame};
use glam::{DMat4, DVec3};

use crate::replay::ReplayError;

/// Where lights come from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::ValueEnum)]
pub enum Lights {
    /// From the session's list; where that is empty as its probe tells, and without one they are looked for.
    #[default]
    Given,
    /// From the frames alone: list and probe are put aside, and the list is compared with.
    Found,
    /// As the session's probe tells: the list is put aside, and compared with.
    Probe,
}

/// Where a number comes from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::ValueEnum)]
pub enum Source {
    /// The session.
    #[default]
    Given,
    /// The pictures; numbers within 3 % of what the session says.
    Found,
}

/// The number that is looked for in the pictures.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Ratio {
    /// None: all are the session's.
    #[default]
    Given,
    /// The focal length.
    FocalLength,
    /// The scale of the world.
    WorldScale,
}

/// Options that ask for a number.
#[derive(Clone, Copy, Debug, clap::Args)]
pub struct RatioArgs {
    /// Look for the focal length, too, which takes several times as long as all else
    #[arg(long, value_enum, default_value_t)]
    focal_length: Source,
    /// Look for the scale of the world in place of it, as by a tracker whose metre is none: the toy's model has the right size
    #[arg(long, value_enum, default_value_t, conflicts_with = "focal_length")]
    world_scale: Source,
    /// Look for two radial terms of the lens's distortion, in place of those that the session says
    #[arg(long, value_enum, default_value_t)]
    lens: Source,
}

impl RatioArgs {
    /// Where the lens comes from.
    #[must_use]
    pub fn lens(&self) -> Source {
        self.lens
    }

    /// The number that they ask for.
    #[must_use]
    pub fn asked(&self) -> Ratio {
        match (self.focal_length, self.world_scale) {
            (Source::Given, Source::Given) => Ratio::Given,
            (Source::Found, _) => Ratio::FocalLength,
            (Source::Given, Source::Found) => Ratio::WorldScale,
        }
    }
}

/// What is looked for in the pictures though a session says it.
#[derive(Clone, Copy, Debug, Default)]
pub struct Asked {
    /// The lights.
    pub lights: Lights,
    /// The focal length, or the scale of the world.
    pub ratio: Ratio,
}

/// Corrections of frames, found once for all presets.
pub struct Alignments {
    lights: Lights,
    first: usize,
    found: Vec<Aligned>,
    /// Plates whose camera was corrected, by their index.
    moved_plates: Vec<(usize, Camera)>,
    /// Of the lens, where it was looked for.
    lens: Option<LensAlignment>,
}

/// Of one frame.
pub struct Aligned {
    /// Where toy and lights are.
    pub alignment: Alignment,
    /// What finding it took on the processor.
    pub cpu_ms: f64,
    /// The lights that were put aside.
    pub put_aside: Vec<Light>,
    /// The same as seen from the toy's middle.
    pub listed: Vec<SeenLight>,
}

/// A light as it is seen from a place.
#[derive(Clone, Copy, Debug)]
pub struct SeenLight {
    /// Unit vector to its middle.
    pub direction_in_world: DVec3,
    /// None for a light without end.
    pub distance_m: Option<f64>,
    /// Half the angle that it fills.
    pub angular_radius_rad: f64,
}

impl SeenLight {
    /// One that was found by its shadow, from the toy's middle.
    #[must_use]
    pub fn found(light: &DiscoveredLight) -> Self {
        Self {
            direction_in_world: light.direction_in_world,
            distance_m: light.distance_m,
            angular_radius_rad: light.angular_radius_rad,
        }
    }

    /// From a place in the world.
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
    /// Frames stay as they were recorded.
    #[must_use]
    pub fn none() -> Self {
        Self {
            lights: Lights::Given,
            first: 0,
            found: Vec::new(),
            moved_plates: Vec::new(),
            lens: None,
        }
    }

    /// With what was found of the lens when the session was opened.
    #[must_use]
    pub fn with_lens(mut self, lens: Option<LensAlignment>) -> Self {
        self.lens = lens;
        self
    }

    /// What was found of the lens that photographs are freed of; none where nobody asked.
    #[must_use]
    pub fn lens(&self) -> Option<&LensAlignment> {
        self.lens.as_ref()
    }

    /// Aligns frames one after the other.
    ///
    /// # Errors
    /// When a frame cannot be read or aligned.
    pub fn find(session: &dyn Session, frames: Range<usize>, asked: Asked) -> Result<Self, ReplayError> {
        let known = asked.lights.known(session.scene());
        let aligner = match asked.ratio {
            Ratio::Given => Aligner::new(known),
            Ratio::FocalLength => Aligner::new(known).with_unknown_focal_length(),
            Ratio::WorldScale => Aligner::new(known).with_unknown_world_scale(),
        };
        Self::find_by(aligner, session, frames, asked.lights)
    }

    /// Aligns all frames, and reads no shadow but that of the first picture.
    ///
    /// # Errors
    /// When a frame cannot be read or aligned.
    pub fn find_without_shadows(session: &dyn Session) -> Result<Self, ReplayError> {
        let mut aligner = Aligner::new(session.scene().clone());
        aligner.withhold_shadows();
        Self::find_by(aligner, session, 0..session.n_frames(), Lights::Given)
    }

    fn find_by(
        mut aligner: Aligner,
        session: &dyn Session,
        frames: Range<usize>,
        lights: Lights,
    ) -> Result<Self, ReplayError> {
        let scene = session.scene();
        let put_aside = match lights {
            Lights::Given => &[],
            Lights::Found | Lights::Probe => &scene.lights[..],
        };
        let mut found = Vec::with_capacity(frames.len());
        for index in frames.clone() {
            let input = lights.input(&session.frame(index)?);
            let start = Instant::now();
            let alignment = aligner.align(&input).map_err(|reason| ReplayError::Align {
                index,
                reason: Box::new(reason),
            })?;
            let cpu_ms = start.elapsed().as_secs_f64() * 1e3;
            let middle = middle(scene, &alignment.world_from_object);
            found.push(Aligned {
                alignment,
                cpu_ms,
                put_aside: put_aside.to_vec(),
                listed: put_aside
                    .iter()
                    .map(|light| SeenLight::from(middle, light))
                    .collect(),
            });
        }
        Ok(Self {
            lights,
            first: frames.start,
            found,
            moved_plates: moved_plates(session.scene(), aligner.scene()),
            lens: None,
        })
    }

    /// What the core is given of a session's scene.
    #[must_use]
    pub fn scene(&self, given: &Scene) -> Scene {
        let mut scene = given.clone();
        for (index, camera) in &self.moved_plates {
            scene.plates[*index].camera = *camera;
        }
        scene
    }

    /// The scene from a frame on: its plates in another light, once lights were moved.
    #[must_use]
    pub fn relit_scene(&self, given: &Scene, index: usize) -> Option<Scene> {
        let plates = |index: usize| self.of(index)?.alignment.relit_plates.as_ref();
        let now = plates(index)?;
        let before = index.checked_sub(1).and_then(plates);
        let is_new = before.is_none_or(|before| !Arc::ptr_eq(before, now));
        is_new.then(|| given.clone().with_plates(now.to_vec()))
    }

    /// Lights that the core is given with the last frame.
    #[must_use]
    pub fn n_lights(&self, given: &Scene, preset: Preset) -> usize {
        let found = self.found.last().and_then(|last| last.lights(preset));
        found.map_or(self.lights.listed(given).len(), |lights| lights.len())
    }

    /// Plates whose camera was corrected, by their index.
    #[must_use]
    pub fn moved_plates(&self) -> &[(usize, Camera)] {
        &self.moved_plates
    }

    /// The focal length of all frames and plates, over that recorded.
    #[must_use]
    pub fn focal_ratio(&self) -> f64 {
        self.ratio(|report| report.focal_length)
    }

    /// The scale of all poses of the toy, over that recorded.
    #[must_use]
    pub fn world_scale(&self) -> f64 {
        self.ratio(|report| report.world_scale)
    }

    fn ratio(&self, of: impl Fn(&AlignmentReport) -> Option<RatioAlignment>) -> f64 {
        let last = self.found.last();
        let found = last.and_then(|last| of(&last.alignment.report));
        found.map_or(1.0, |found| if found.is_applied() { found.ratio } else { 1.0 })
    }

    /// Of a frame; none where it stays as recorded.
    #[must_use]
    pub fn of(&self, index: usize) -> Option<&Aligned> {
        self.found.get(index.checked_sub(self.first)?)
    }

    /// What the core is given of a frame with a preset.
    #[must_use]
    pub fn input(&self, index: usize, frame: &SessionFrame, preset: Preset) -> FrameInput {
        let input = self.lights.input(frame);
        match self.of(index) {
            Some(aligned) => aligned
                .alignment
                .applied_to(&input)
                .with_lights(aligned.lights(preset).or_else(|| input.lights.clone())),
            None => input,
        }
    }
}

impl Aligned {
    /// Lights that were found; none where those that were given stay. With preset `paper` those that a probe tells are the paper's own:
    /// the viewer on the axis, and no shadow looked at.
    fn lights(&self, preset: Preset) -> Option<Arc<[Light]>> {
        let probe = self.alignment.report.probe.as_ref();
        let published = probe.filter(|probe| preset == Preset::Paper && !probe.published.is_empty());
        match published {
            Some(probe) => Some(probe.published.as_slice().into()),
            None => self.alignment.lights.clone(),
        }
    }
}

fn moved_plates(given: &Scene, aligned: &Scene) -> Vec<(usize, Camera)> {
    let plates = given.plates.iter().zip(&aligned.plates).enumerate();
    let moved = plates.filter(|(_, (given, aligned))| given.camera != aligned.camera);
    moved
        .map(|(index, (_, aligned))| (index, aligned.camera))
        .collect()
}

impl Lights {
    /// Those of a scene's list that are not put aside.
    fn listed(self, scene: &Scene) -> &[Light] {
        match self {
            Self::Given => &scene.lights,
            Self::Found | Self::Probe => &[],
        }
    }

    /// A scene without what is put aside of it.
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

/// Middle of the box around the real toy, in the world.
pub fn middle(scene: &Scene, world_from_object: &DMat4) -> DVec3 {
    let bounds = scene.toy.bounds_of_pose(&scene.physical_pose);
    let middle = bounds.map_or(DVec3::ZERO, |bounds| 0.5 * (bounds.min + bounds.max).as_dvec3());
    world_from_object.transform_point3(middle)
}
