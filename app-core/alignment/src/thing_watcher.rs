//! Watches for things beside the toy between two alignments.

use std::sync::Arc;

use super::error::{self, AlignError};
use super::lights::FoundReflection;
use super::observer::Look;
use super::smaller::{Blocks, smaller};
use super::things::{Memory, adopt, least_change};
use app_scene::frame::FrameInput;
use app_scene::scene::{Camera, Light, Plate, Scene};
use app_scene::sharpness::Spread;
use app_scene::things::Things;

/// Maximum number of pixels of a picture in which things are searched for; larger ones are halved.
/// Outlines of moving things need no more, and the time is proportional to it.
const MOST_PIXELS: u32 = 1 << 20;
/// Number of changed blocks from which on a picture shows something else.
const LEAST_CHANGED: usize = 2;

/// The result of an alignment that a search for things depends on.
#[derive(Clone, Debug)]
pub struct Conditions {
    scene: Arc<Scene>,
    lights: Arc<[Light]>,
    reflection: Option<FoundReflection>,
    plate_spread: Spread,
}

impl Conditions {
    pub(super) fn new(
        scene: &Arc<Scene>,
        lights: &[Light],
        reflection: Option<FoundReflection>,
        plate_spread: Spread,
    ) -> Self {
        Self {
            scene: Arc::clone(scene),
            lights: lights.into(),
            reflection,
            plate_spread,
        }
    }

    fn is_like(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.scene, &other.scene)
            && self.lights == other.lights
            && self.reflection == other.reflection
            && self.plate_spread == other.plate_spread
    }
}

/// The things in a picture.
#[derive(Clone, Debug)]
pub enum Watched {
    /// The picture shows what the one before showed, with these things in it.
    Unchanged(Option<Things>),
    /// The things; `None` if there are none, or none can be detected.
    Things(Option<Things>),
}

/// Searches for things beside the toy, picture after picture, apart from camera, pose and lights: a
/// hand moves faster than an alignment takes.
///
/// A thing that was marked in the picture before needs half the evidence of a single picture, and one
/// that no picture before showed twice that evidence; and outlines stay where the picture does not change.
/// A picture that shows what the one before showed is not searched.
#[derive(Debug, Default)]
pub struct ThingWatcher {
    small: Option<SmallScene>,
    memory: Option<Memory>,
    looked: Option<Looked>,
    things: Option<Things>,
}

/// A scene with smaller pictures.
#[derive(Debug)]
struct SmallScene {
    of: Arc<Scene>,
    scene: Scene,
    n_halvings: u32,
}

/// The latest picture that was searched.
#[derive(Debug)]
struct Looked {
    conditions: Conditions,
    camera: Camera,
    world_from_object: glam::DMat4,
    blocks: Blocks,
}

impl ThingWatcher {
    /// Looks at the next picture, with its estimated camera and pose.
    ///
    /// # Errors
    /// As [`Aligner::align`](crate::Aligner::align).
    pub fn look(&mut self, conditions: &Conditions, input: &FrameInput) -> Result<Watched, AlignError> {
        error::check(&conditions.scene, input)?;
        let small = self.small.take();
        let small = small.filter(|small| Arc::ptr_eq(&small.of, &conditions.scene));
        if small.is_none() {
            // Its marks belong to the receivers and plates of another scene.
            self.memory = None;
        }
        let small = self
            .small
            .insert(small.unwrap_or_else(|| SmallScene::of(&conditions.scene)));
        let image = smaller(input.image.rgba(), small.n_halvings);
        let looked = Looked {
            conditions: conditions.clone(),
            camera: input.camera,
            world_from_object: input.world_from_object,
            blocks: Blocks::of(&image),
        };
        if self.looked.as_ref().is_some_and(|known| known.is_like(&looked)) {
            return Ok(Watched::Unchanged(self.things.clone()));
        }
        let input = input.clone().with_camera(halved(&input.camera, small.n_halvings));
        let input = input.with_image(image);
        let scale = 0.25_f64.powi(small.n_halvings.cast_signed());
        let look = Look {
            input: &input,
            plate_spread: conditions.plate_spread.times(scale),
            reflection: conditions.reflection.as_ref(),
        };
        let photograph = look.photograph(&small.scene)?;
        let before = (None, self.memory.as_ref());
        let sighted = photograph.things(&small.scene, &input, &conditions.lights, before)?;
        (self.looked, self.memory) = (Some(looked), sighted.memory);
        adopt(&mut self.things, sighted.things);
        Ok(Watched::Things(self.things.clone()))
    }
}

impl SmallScene {
    fn of(scene: &Arc<Scene>) -> Self {
        let n_pixels = scene.width_px * scene.height_px;
        let n_halvings = (0..).find(|n| n_pixels >> (2 * n) <= MOST_PIXELS).unwrap_or(0);
        let mut small = Scene::clone(scene);
        small.width_px >>= n_halvings;
        small.height_px >>= n_halvings;
        for Plate { camera, image } in &mut small.plates {
            *camera = halved(camera, n_halvings);
            *image = smaller(image, n_halvings);
        }
        Self {
            of: Arc::clone(scene),
            scene: small,
            n_halvings,
        }
    }
}

impl Looked {
    /// Whether both pictures show the same, in the same conditions.
    fn is_like(&self, other: &Self) -> bool {
        let Some(apart) = self.blocks.apart(&other.blocks) else {
            return false;
        };
        let least = least_change(apart.iter().copied());
        let n_changed = apart.into_iter().filter(|apart| *apart > least).count();
        n_changed < LEAST_CHANGED
            && self.camera == other.camera
            && self.world_from_object == other.world_from_object
            && self.conditions.is_like(&other.conditions)
    }
}

fn halved(camera: &Camera, n_halvings: u32) -> Camera {
    Camera {
        intrinsics: camera.intrinsics.scaled(0.5_f64.powi(n_halvings.cast_signed())),
        ..*camera
    }
}
