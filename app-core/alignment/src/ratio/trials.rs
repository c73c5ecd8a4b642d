//! One number after the other, each with the pose and the lights that fit it best.

use glam::{DMat4, DVec3};

use super::unknown::{Taken, Unknown};
use crate::camera::Finder;
use crate::lights::{Around, Followed};
use crate::photograph::{MOST_OUTLINE_PX, Photograph};
use crate::picture::Pyramid;
use crate::pose::Start;
use crate::receivers::{SAME_CAMERA, nearest};
use app_scene::frame::FrameInput;
use app_scene::scene::{Camera, Light, Plate, Scene};

/// The smallest picture with as many pixels is looked at in the end: larger ones move what is found by a ten-thousandth.
const LARGER_PIXELS: i32 = 40_000;
/// Rounds that lights are moved for, in a picture that they were followed in before, and in a larger one.
const N_ROUNDS: usize = 1;
const N_ROUNDS_LARGER: usize = 2;

/// Toy or shadows cannot be seen with a ratio.
#[derive(Debug)]
pub(super) struct Unseen;

/// What a ratio leaves unexplained.
#[derive(Clone, Copy, Debug)]
pub(super) struct Trial {
    /// Of the shadows, in variances.
    pub(super) loss: f64,
    /// Of the outline, in pixels.
    pub(super) outline_px: f64,
}

/// Toy and lights with a ratio.
struct Tried {
    at: f64,
    /// As found, with its focal length.
    camera: Camera,
    world_from_object: DMat4,
    outline_px: f64,
    followed: Followed,
    /// The picture that it was followed in last.
    level: usize,
}

/// The trials so far. A ratio is named by its logarithm.
pub(super) struct Trials<'a> {
    unknown: Unknown,
    input: &'a FrameInput,
    given: Plate,
    /// With that plate alone.
    scene: Scene,
    cameras: Finder,
    /// At least one.
    tried: Vec<Tried>,
    level: usize,
    around: Around,
}

impl<'a> Trials<'a> {
    /// Starts with what is given.
    pub(super) fn new(
        unknown: Unknown,
        scene: &Scene,
        input: &'a FrameInput,
        lights: &[Light],
    ) -> Result<Self, Unseen> {
        let plate = nearest(&scene.plates, &input.camera)
            .into_iter()
            .next()
            .ok_or(Unseen)?;
        let given = plate.clone();
        let mut scene = scene.clone().with_plates(vec![given.clone()]);
        let mut cameras = Finder::default();
        let taken = unknown.taken(0.0, &given, input).ok_or(Unseen)?;
        let (photograph, camera) = photograph(&mut scene, &mut cameras, taken);
        let (world_from_object, outline_px) =
            posed(&scene, &photograph, (&input.world_from_object, Start::Given))?;
        let shape = photograph.shape(&scene, &world_from_object).map_err(|_| Unseen)?;
        let camera_from_world = camera.world_from_camera.inverse();
        let view = photograph.seen(&shape);
        let followed = Followed::new(lights, view, &camera_from_world).ok_or(Unseen)?;
        let around = followed.around(view, Pyramid::SMALLEST);
        let tried = vec![Tried {
            at: 0.0,
            camera,
            world_from_object,
            outline_px,
            followed,
            level: Pyramid::SMALLEST,
        }];
        Ok(Self {
            unknown,
            input,
            given,
            scene,
            cameras,
            tried,
            level: Pyramid::SMALLEST,
            around,
        })
    }

    /// Tries a ratio, or tries it again.
    pub(super) fn at(&mut self, at: f64) -> Result<Trial, Unseen> {
        let Self {
            unknown,
            input,
            given,
            scene,
            cameras,
            tried,
            level,
            around,
        } = self;
        let taken = unknown.taken(at, given, input).ok_or(Unseen)?;
        let (photograph, camera) = photograph(scene, cameras, taken);
        let near = nearest_to(tried, at).ok_or(Unseen)?;
        let (world_from_object, outline_px) = if tried[near].at == at {
            (tried[near].world_from_object, tried[near].outline_px)
        } else {
            posed(
                scene,
                &photograph,
                (&tried[near].slid(*unknown, at, &camera), Start::Near),
            )?
        };
        let shape = photograph.shape(scene, &world_from_object).map_err(|_| Unseen)?;
        let mut followed = tried[near].followed.clone();
        let n_rounds = if tried[near].level == *level {
            N_ROUNDS
        } else {
            N_ROUNDS_LARGER
        };
        let loss = followed
            .next(photograph.seen(&shape), around, n_rounds)
            .ok_or(Unseen)?;
        let one = Tried {
            at,
            camera,
            world_from_object,
            outline_px,
            followed,
            level: *level,
        };
        if tried[near].at == at {
            tried[near] = one;
        } else {
            tried.push(one);
        }
        Ok(Trial { loss, outline_px })
    }

    /// Goes on in a larger picture.
    pub(super) fn enlarge(&mut self) -> Result<(), Unseen> {
        let first = self.tried.first().ok_or(Unseen)?;
        let followed = first.followed.clone();
        let world_from_object = first.world_from_object;
        let taken = self.unknown.taken(0.0, &self.given, self.input).ok_or(Unseen)?;
        let (photograph, _) = photograph(&mut self.scene, &mut self.cameras, taken);
        let shape = photograph
            .shape(&self.scene, &world_from_object)
            .map_err(|_| Unseen)?;
        let view = photograph.seen(&shape);
        self.level = photograph.level_of(LARGER_PIXELS);
        self.around = followed.around(view, self.level);
        Ok(())
    }

    /// Distance of the outline with the ratio that was tried next to one.
    pub(super) fn outline_px(&self, at: f64) -> Option<f64> {
        nearest_to(&self.tried, at).map(|near| self.tried[near].outline_px)
    }
}

impl Tried {
    /// The pose with another ratio that gives an outline of the same size: farther away as the focal length is longer, or the toy larger.
    fn slid(&self, unknown: Unknown, at: f64, camera: &Camera) -> DMat4 {
        let camera_from_object = self.camera.world_from_camera.inverse() * self.world_from_object;
        let ratio = (at - self.at).exp();
        let slide = match unknown {
            Unknown::FocalLength => {
                let z_m = camera_from_object.w_axis.z * (ratio - 1.0);
                DMat4::from_translation(DVec3::new(0.0, 0.0, z_m))
            }
            Unknown::WorldScale => DMat4::from_scale(DVec3::splat(ratio)),
            // What a lens moves differs from place to place: the pose starts where it was.
            Unknown::Lens(_) => DMat4::IDENTITY,
        };
        camera.world_from_camera * slide * camera_from_object
    }
}

fn nearest_to(tried: &[Tried], at: f64) -> Option<usize> {
    let distance = |index: &usize| (tried[*index].at - at).abs();
    (0..tried.len()).min_by(|a, b| distance(a).total_cmp(&distance(b)))
}

/// A frame with a number, and its camera: where no plate was taken from there, it is found by the plate.
fn photograph(scene: &mut Scene, cameras: &mut Finder, taken: Taken) -> (Photograph, Camera) {
    let Taken { plate, frame } = taken;
    let mut camera = frame.camera;
    let is_same = plate
        .camera
        .world_from_camera
        .abs_diff_eq(camera.world_from_camera, SAME_CAMERA);
    scene.plates = vec![plate];
    if !is_same {
        let found = cameras.find(
            (frame.image.rgba(), &camera, None),
            (&scene.plates, &scene.receivers),
            &scene.uncertainty.camera,
        );
        if let Some(found) = found.filter(|found| found.is_better()) {
            camera.world_from_camera = found.world_from_camera;
        }
    }
    let seen = frame.with_camera(camera);
    (Photograph::new(scene, &seen, None), camera)
}

/// The pose that fits the outline best.
fn posed(scene: &Scene, photograph: &Photograph, start: (&DMat4, Start)) -> Result<(DMat4, f64), Unseen> {
    // A toy that cannot be posed is an error of the alignment that follows.
    let found = photograph.tried_pose(scene, start).ok().flatten();
    found
        .filter(|(_, outline_px)| *outline_px <= MOST_OUTLINE_PX)
        .ok_or(Unseen)
}
