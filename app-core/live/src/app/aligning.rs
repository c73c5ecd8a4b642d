//! The toy's place as the picture tells it, found on another thread.

use std::sync::Arc;

use glam::{DMat4, DVec3};

use super::recorder::Recorder;
use app_alignment::NoLight;
use app_alignment::pose_filter::{PoseFilter, PoseNoise};
use app_alignment::{AlignError, Aligner, Alignment};
use app_scene::camera_frame::Anchor;
use app_scene::frame::FrameInput;
use app_scene::reflection::Reflection;
use app_scene::scene::{Camera, Light, Scene};
use app_scene::things::Things;

/// The outline of a toy that was found lies this near to the picture's, root mean square in pixels: exact poses reach 1.2 where a
/// shadow hides a part of it, and 2 is that of no toy at all.
const FOUND_PX: f64 = 1.5;
/// Pictures, one after the other, that do not show the toy where it should be, before it counts as lost.
const N_MISSES: u32 = 2;
/// Time between the beginnings of two alignments, in seconds: trackers drift by millimetres in some seconds.
const PERIOD_S: f64 = 1.0;

/// One alignment, for another thread.
#[derive(Debug)]
pub struct AlignJob {
    place: u64,
    aligner: Aligner,
    input: FrameInput,
}

impl AlignJob {
    /// What is to be aligned.
    #[must_use]
    pub fn input(&self) -> &FrameInput {
        &self.input
    }

    /// The scene that it is aligned with.
    #[must_use]
    pub fn scene(&self) -> &Scene {
        self.aligner.scene()
    }

    /// Takes what is known from elsewhere in place of aligning.
    #[must_use]
    pub fn known(self, alignment: Alignment) -> AlignedJob {
        AlignedJob {
            place: self.place,
            aligner: self.aligner,
            given: self.input.camera,
            result: Ok(alignment),
        }
    }

    /// Aligns; a second or more.
    #[must_use]
    pub fn run(mut self) -> AlignedJob {
        let result = self.aligner.align(&self.input);
        AlignedJob {
            place: self.place,
            aligner: self.aligner,
            given: self.input.camera,
            result,
        }
    }
}

/// What came of it.
#[derive(Debug)]
pub struct AlignedJob {
    place: u64,
    aligner: Aligner,
    given: Camera,
    result: Result<Alignment, AlignError>,
}

/// What an alignment says of the toy.
#[derive(Clone, Debug, PartialEq)]
pub enum Verdict {
    /// It is where it is shown.
    Found {
        /// Outline to picture, in pixels; none where too little of it is seen, so that nobody knows.
        outline_px: Option<f64>,
        /// Why no light is known, where none is.
        no_light: Option<NoLight>,
    },
    /// It is not.
    Missed {
        /// Outline to picture, in pixels.
        outline_px: f64,
    },
    /// Nothing could be said, and why.
    Failed(String),
}

/// A toy that was placed, with its scene.
#[derive(Debug)]
pub(super) struct Place {
    /// Counts places: results of another are not taken.
    number: u64,
    /// What frames are shown with: another one is another allocation.
    pub(super) scene: Arc<Scene>,
    /// None while it is at work.
    aligner: Option<Aligner>,
    started_s: Option<f64>,
    n_misses: u32,
    /// The platform's anchor when the toy was placed, and as it is told since: trackers correct their worlds.
    world_from_anchor: DMat4,
    anchor: PoseFilter,
    /// From the world that the anchor tells to that of the scene, as alignment found it.
    world_from_anchored: DMat4,
    world_from_object: DMat4,
    lights: Option<Arc<[Light]>>,
    things: Option<Things>,
    reflection: Option<Reflection>,
    pub(super) verdict: Option<Verdict>,
}

impl Place {
    pub(super) fn new(number: u64, scene: Scene) -> Self {
        let scene = Arc::new(scene);
        Self {
            number,
            aligner: Some(Aligner::new(Arc::clone(&scene))),
            started_s: None,
            n_misses: 0,
            world_from_anchor: rigid(&scene.world_from_object),
            anchor: PoseFilter::new(PoseNoise::default(), DVec3::ZERO),
            world_from_anchored: DMat4::IDENTITY,
            world_from_object: scene.world_from_object,
            lights: None,
            things: None,
            reflection: None,
            verdict: None,
            scene,
        }
    }

    /// Whether the picture shows the toy where it is drawn, as far as anyone knows.
    pub(super) fn is_known(&self) -> bool {
        matches!(self.verdict, Some(Verdict::Found { .. })) || (1..N_MISSES).contains(&self.n_misses)
    }

    /// The toy's transform, as it was found.
    pub(super) fn world_from_object(&self) -> &DMat4 {
        &self.world_from_object
    }

    /// The number and the pose of the anchor that is to be held.
    pub(super) fn anchor(&self) -> (u64, DMat4) {
        (self.number, self.world_from_anchor)
    }

    /// Takes where the platform says that the anchor is, after `elapsed_s`.
    pub(super) fn follow_anchor(&mut self, anchors: &[Anchor], elapsed_s: f64) {
        let own = anchors.iter().find(|anchor| anchor.id == self.number);
        let measured = own.map(|anchor| anchor.world_from_anchor);
        self.anchor.step(elapsed_s, measured);
    }

    /// The input in the world as it was when the toy was placed.
    pub(super) fn anchored(&self, input: FrameInput) -> FrameInput {
        let Some(now_from_anchor) = self.anchor.pose() else {
            return input;
        };
        let placed_from_now = self.world_from_anchor * now_from_anchor.inverse();
        let camera = moved(&input.camera, &placed_from_now);
        input.with_camera(camera)
    }

    /// The input as it was corrected.
    pub(super) fn corrected(&self, input: FrameInput) -> FrameInput {
        let input = self.anchored(input);
        let camera = moved(&input.camera, &self.world_from_anchored);
        input
            .with_camera(camera)
            .with_world_from_object(self.world_from_object)
            .with_lights(self.lights.clone())
            .with_things(self.things.clone())
            .with_reflection(self.reflection)
    }

    /// An alignment of `input`, where it is time for one.
    pub(super) fn job(&mut self, time_s: f64, input: FrameInput) -> Option<AlignJob> {
        let is_due = self
            .started_s
            .is_none_or(|started_s| self.verdict.is_none() || time_s - started_s >= PERIOD_S);
        if !is_due {
            return None;
        }
        let aligner = self.aligner.take()?;
        self.started_s = Some(time_s);
        // The job runs for a second or more, and a platform has few pictures to lend.
        let kept = input.image.kept();
        let input = input.with_image(kept);
        Some(AlignJob {
            place: self.number,
            aligner,
            input: self.anchored(input),
        })
    }

    /// Takes what an alignment found; whether it was of this place.
    pub(super) fn take(&mut self, done: AlignedJob) -> bool {
        if done.place != self.number {
            return false;
        }
        match done.result {
            Ok(alignment) => self.apply(&done.given, &done.aligner, alignment),
            Err(reason) => {
                self.things = None;
                self.verdict = Some(Verdict::Failed(reason.to_string()));
            }
        }
        self.aligner = Some(done.aligner);
        true
    }

    /// Tells a recording where the toy was found, and the lights.
    pub(super) fn tell(&self, recorder: &Recorder) {
        recorder.aligned(
            &self.world_from_object,
            self.lights.as_deref().unwrap_or_default(),
        );
    }

    /// The thread of an alignment did not come to an end: begins with a new one.
    pub(super) fn begin_anew(&mut self) {
        self.aligner = Some(Aligner::new(Arc::clone(&self.scene)));
        self.things = None;
    }

    fn apply(&mut self, given: &Camera, aligner: &Aligner, alignment: Alignment) {
        let verdict = verdict(&alignment);
        if let Verdict::Missed { .. } = verdict {
            self.n_misses = self.n_misses.saturating_add(1);
            self.things = None;
            self.verdict = Some(verdict);
            return;
        }
        self.n_misses = 0;
        self.world_from_anchored = alignment.camera.world_from_camera * given.world_from_camera.inverse();
        self.world_from_object = alignment.world_from_object;
        self.lights = alignment.lights;
        self.things = alignment.things;
        self.reflection = alignment.reflection;
        // What an alignment told that missed the toy counts from here on, too.
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
