//! The toy's pose as estimated from the picture, on another thread.

use std::sync::Arc;

use glam::{DMat4, DVec3};

use super::recorder::Recorder;
use super::watching::{Watch, WatchJob, WatchedJob};
use app_alignment::NoLight;
use app_alignment::pose_filter::{PoseFilter, PoseNoise};
use app_alignment::{AlignError, Aligner, Alignment};
use app_scene::camera_frame::Anchor;
use app_scene::frame::FrameInput;
use app_scene::gloss::Gloss;
use app_scene::grain::Grain;
use app_scene::reflection::Reflection;
use app_scene::scene::{Camera, Light, Scene};
use app_scene::sharpness::Sharpness;

/// Largest distance between the outlines of a found toy and the picture, root mean square in
/// pixels: exact poses reach 1.2 if a shadow hides a part of the outline, and a picture without a
/// toy gives 2.
pub(super) const FOUND_PX: f64 = 1.5;
/// Number of consecutive pictures without the toy at its place after which it counts as lost.
const N_MISSES: u32 = 2;
/// Number of consecutive pictures without grain after which none is drawn.
const N_CLEAN: u32 = 2;
/// Number of consecutive threads that did not end normally after which the next would not either.
pub(super) const N_DEAD: u32 = 2;
/// Time between the starts of two alignments, in seconds: trackers drift by millimetres in some
/// seconds.
const PERIOD_S: f64 = 1.0;

/// One alignment, for another thread.
#[derive(Debug)]
pub struct AlignJob {
    place: u64,
    aligner: Aligner,
    input: FrameInput,
}

impl AlignJob {
    /// The frame to align.
    #[must_use]
    pub fn input(&self) -> &FrameInput {
        &self.input
    }

    /// The scene of the alignment.
    #[must_use]
    pub fn scene(&self) -> &Scene {
        self.aligner.scene()
    }

    /// Uses an alignment from another source instead of running one.
    #[must_use]
    pub fn known(self, alignment: Alignment) -> AlignedJob {
        AlignedJob {
            place: self.place,
            aligner: self.aligner,
            given: self.input.camera,
            result: Some(Ok(alignment)),
        }
    }

    /// Runs the alignment, which takes a second or more.
    #[must_use]
    pub fn run(mut self) -> AlignedJob {
        let result = self.aligner.align(&self.input);
        AlignedJob {
            place: self.place,
            aligner: self.aligner,
            given: self.input.camera,
            result: Some(result),
        }
    }

    /// The result if the thread of the alignment does not end normally: nothing, and a new aligner.
    #[must_use]
    pub fn without_result(&self) -> AlignedJob {
        AlignedJob {
            place: self.place,
            aligner: Aligner::new(Arc::clone(self.aligner.scene())),
            given: self.input.camera,
            result: None,
        }
    }
}

/// The result of an alignment.
#[derive(Debug)]
pub struct AlignedJob {
    place: u64,
    aligner: Aligner,
    given: Camera,
    /// `None` if its thread did not end normally.
    result: Option<Result<Alignment, AlignError>>,
}

/// The state of the toy according to an alignment.
#[derive(Clone, Debug, PartialEq)]
pub enum Verdict {
    /// It is at its place.
    Found {
        /// Distance of the outlines in pixels; `None` if too little is visible to decide.
        outline_px: Option<f64>,
        /// The reason why no light is known, if none is.
        no_light: Option<NoLight>,
    },
    /// It is not at its place.
    Missed {
        /// Distance of the outlines in pixels.
        outline_px: f64,
    },
    /// The alignment failed, for this reason.
    Failed(String),
}

/// A placed toy with its scene.
#[derive(Debug)]
pub(super) struct Place {
    /// Number of the place: results of another place are dropped.
    number: u64,
    /// The scene of the frames; another one is another allocation.
    pub(super) scene: Arc<Scene>,
    /// `None` while it runs on its thread.
    aligner: Option<Aligner>,
    started_s: Option<f64>,
    n_misses: u32,
    /// Number of consecutive alignments whose thread did not end normally.
    n_dead: u32,
    /// The platform's anchor when the toy was placed, and its latest pose: trackers correct their
    /// worlds.
    world_from_anchor: DMat4,
    anchor: PoseFilter,
    /// Transform from the anchor's world to the scene's, as estimated by alignment.
    world_from_anchored: DMat4,
    world_from_object: DMat4,
    lights: Option<Arc<[Light]>>,
    /// The things beside it.
    watch: Watch,
    sharpness: Sharpness,
    grain: HeldGrain,
    reflection: Option<Reflection>,
    gloss: Gloss,
    pub(super) verdict: Option<Verdict>,
}

/// The grain of the latest pictures.
#[derive(Debug, Default)]
struct HeldGrain {
    grain: Option<Grain>,
    /// Number of consecutive pictures without any.
    n_clean: u32,
}

impl HeldGrain {
    /// Adopts the grain of a picture. One clean picture is ignored, so that grain near the least
    /// that is drawn does not come and go.
    fn take(&mut self, measured: Option<Grain>) {
        self.n_clean = match measured {
            Some(_) => 0,
            None => self.n_clean.saturating_add(1),
        };
        if measured.is_some() || self.n_clean >= N_CLEAN {
            self.grain = measured;
        }
    }
}

impl Place {
    pub(super) fn new(number: u64, scene: Scene) -> Self {
        let scene = Arc::new(scene);
        Self {
            number,
            aligner: Some(Aligner::new(Arc::clone(&scene))),
            started_s: None,
            n_misses: 0,
            n_dead: 0,
            world_from_anchor: rigid(&scene.world_from_object),
            anchor: PoseFilter::new(PoseNoise::default(), DVec3::ZERO),
            world_from_anchored: DMat4::IDENTITY,
            world_from_object: scene.world_from_object,
            lights: None,
            watch: Watch::new(number),
            sharpness: Sharpness::SHARP,
            grain: HeldGrain::default(),
            reflection: None,
            gloss: Gloss::NONE,
            verdict: None,
            scene,
        }
    }

    /// Whether the picture shows the toy at its drawn place, as far as it was checked.
    pub(super) fn is_known(&self) -> bool {
        matches!(self.verdict, Some(Verdict::Found { .. })) || (1..N_MISSES).contains(&self.n_misses)
    }

    /// The toy's estimated transform.
    pub(super) fn world_from_object(&self) -> &DMat4 {
        &self.world_from_object
    }

    /// The number and the pose of the anchor that the platform must hold.
    pub(super) fn anchor(&self) -> (u64, DMat4) {
        (self.number, self.world_from_anchor)
    }

    /// Adopts the platform's pose of the anchor, after `elapsed_s`.
    pub(super) fn follow_anchor(&mut self, anchors: &[Anchor], elapsed_s: f64) {
        let own = anchors.iter().find(|anchor| anchor.id == self.number);
        let measured = own.map(|anchor| anchor.world_from_anchor);
        self.anchor.step(elapsed_s, measured);
    }

    /// The input in the world of the time when the toy was placed.
    pub(super) fn anchored(&self, input: FrameInput) -> FrameInput {
        let Some(now_from_anchor) = self.anchor.pose() else {
            return input;
        };
        let placed_from_now = self.world_from_anchor * now_from_anchor.inverse();
        let camera = moved(&input.camera, &placed_from_now);
        input.with_camera(camera)
    }

    /// The input with its corrections.
    pub(super) fn corrected(&self, input: FrameInput) -> FrameInput {
        let input = self.anchored(input);
        let camera = moved(&input.camera, &self.world_from_anchored);
        input
            .with_camera(camera)
            .with_world_from_object(self.world_from_object)
            .with_lights(self.lights.clone())
            .with_things(self.watch.things())
            .with_sharpness(self.sharpness)
            .with_grain(self.grain.grain)
            .with_reflection(self.reflection)
            .with_gloss(self.gloss)
    }

    /// An alignment of `input`, if one is due.
    pub(super) fn job(&mut self, time_s: f64, input: FrameInput) -> Option<AlignJob> {
        let is_due = self
            .started_s
            .is_none_or(|started_s| self.verdict.is_none() || time_s - started_s >= PERIOD_S);
        if !is_due {
            return None;
        }
        let aligner = self.aligner.take()?;
        self.started_s = Some(time_s);
        // The job runs for a second or more, and a platform lends only a few pictures.
        let kept = input.image.kept();
        let input = input.with_image(kept);
        Some(AlignJob {
            place: self.number,
            aligner,
            input: self.anchored(input),
        })
    }

    /// Adopts the result of an alignment of this place. Returns the verdict, unless there was no
    /// result: one thread that died is ignored, more in a row are an alignment that failed.
    pub(super) fn take(&mut self, done: AlignedJob) -> Option<Verdict> {
        if done.place != self.number {
            return None;
        }
        self.n_dead = match done.result {
            Some(_) => 0,
            None => self.n_dead.saturating_add(1),
        };
        match done.result {
            Some(Ok(alignment)) => self.apply(&done.given, &done.aligner, alignment),
            Some(Err(reason)) => self.fail(reason.to_string()),
            None if self.n_dead >= N_DEAD => self.fail("its thread ended again and again".to_owned()),
            None => self.watch.forget(),
        }
        self.aligner = Some(done.aligner);
        self.verdict
            .clone()
            .filter(|_| !(1..N_DEAD).contains(&self.n_dead))
    }

    fn fail(&mut self, reason: String) {
        self.watch.forget();
        self.verdict = Some(Verdict::Failed(reason));
    }

    /// Gives the toy's estimated pose and the lights to a recording.
    pub(super) fn tell(&self, recorder: &Recorder) {
        recorder.aligned(
            &self.world_from_object,
            self.lights.as_deref().unwrap_or_default(),
        );
    }

    /// A search for things in `input`, if one is due and there is a plate to compare with.
    pub(super) fn watch_job(&mut self, time_s: f64, input: FrameInput) -> Option<WatchJob> {
        if self.scene.plates.is_empty() || self.n_misses > 0 {
            return None;
        }
        let input = self.corrected(input);
        self.watch.job(time_s, input)
    }

    /// Adopts the result of a search for things.
    pub(super) fn take_watched(&mut self, done: WatchedJob) {
        self.watch.take(done);
    }

    fn apply(&mut self, given: &Camera, aligner: &Aligner, alignment: Alignment) {
        let verdict = verdict(&alignment);
        if let Verdict::Missed { .. } = verdict {
            self.n_misses = self.n_misses.saturating_add(1);
            self.watch.forget();
            self.verdict = Some(verdict);
            return;
        }
        self.n_misses = 0;
        self.world_from_anchored = alignment.camera.world_from_camera * given.world_from_camera.inverse();
        self.world_from_object = alignment.world_from_object;
        self.lights = alignment.lights;
        self.watch
            .align(aligner.conditions(), alignment.things, self.started_s);
        self.sharpness = alignment.sharpness;
        self.grain.take(alignment.grain);
        self.reflection = alignment.reflection;
        self.gloss = alignment.gloss;
        // Results of an alignment that missed the toy are used from now on, too.
        self.scene = Arc::clone(aligner.scene());
        self.verdict = Some(verdict);
    }
}

fn moved(camera: &Camera, new_from_old: &DMat4) -> Camera {
    Camera {
        world_from_camera: *new_from_old * camera.world_from_camera,
        ..*camera
    }
}

/// A pose without its scale.
fn rigid(pose: &DMat4) -> DMat4 {
    let (_, rotation, translation) = pose.to_scale_rotation_translation();
    DMat4::from_rotation_translation(rotation, translation)
}

fn verdict(alignment: &Alignment) -> Verdict {
    let report = &alignment.report;
    match report.pose.as_ref().map(|pose| pose.shown_px()) {
        Some(outline_px) if outline_px > FOUND_PX => Verdict::Missed { outline_px },
        outline_px => Verdict::Found {
            outline_px,
            no_light: report.no_light,
        },
    }
}
