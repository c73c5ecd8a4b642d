//! Trials of a number, each with the pose and the lights that fit it best.

use std::sync::Arc;

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

/// Number of pixels of the picture of the last trials: larger ones change the result by a
/// ten-thousandth.
const LARGER_PIXELS: i32 = 40_000;
/// Rounds for lights, in a picture in which they were tracked before, and in a larger one.
const N_ROUNDS: usize = 1;
const N_ROUNDS_LARGER: usize = 2;

/// Toy or shadows are not visible with a ratio.
#[derive(Debug)]
pub(super) struct Unseen;

/// The residuals with a ratio.
#[derive(Clone, Copy, Debug)]
pub(super) struct Trial {
    /// Loss of the shadows, in variances.
    pub(super) loss: f64,
    /// Distance of the outline, in pixels.
    pub(super) outline_px: f64,
}

/// Toy and lights with a ratio.
struct Tried {
    at: f64,
    /// The estimated camera, with its focal length.
    camera: Camera,
    world_from_object: DMat4,
    outline_px: f64,
    followed: Followed,
    /// The picture in which it was tracked last.
    level: usize,
}

/// The trials so far. A ratio is identified by its logarithm.
pub(super) struct Trials<'a> {
    unknown: Unknown,
    input: &'a FrameInput,
    given: Plate,
    /// The scene with that plate alone.
    scene: Scene,
    cameras: Finder,
    /// The pictures of the latest trial, if those of all others are the same.
    pictures: Option<Arc<Pyramid>>,
    /// At least one trial.
    tried: Vec<Tried>,
    level: usize,
    around: Around,
}

impl<'a> Trials<'a> {
    /// Starts with the given value.
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
        let (photograph, camera) = photograph(&mut scene, &mut cameras, taken, None);
        let pictures = unknown.pictures(&given, input, &photograph);
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
            pictures,
            tried,
            level: Pyramid::SMALLEST,
            around,
        })
    }

    /// Tries a ratio, or repeats a trial.
    pub(super) fn at(&mut self, at: f64) -> Result<Trial, Unseen> {
        let Self {
            unknown,
            input,
            given,
            scene,
            cameras,
            pictures,
            tried,
            level,
            around,
        } = self;
        let taken = unknown.taken(at, given, input).ok_or(Unseen)?;
        let (photograph, camera) = photograph(scene, cameras, taken, pictures.take());
        *pictures = unknown.pictures(given, input, &photograph);
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

    /// Continues in a larger picture.
    pub(super) fn enlarge(&mut self) -> Result<(), Unseen> {
        let first = self.tried.first().ok_or(Unseen)?;
        let followed = first.followed.clone();
        let world_from_object = first.world_from_object;
        let taken = self.unknown.taken(0.0, &self.given, self.input).ok_or(Unseen)?;
        let pictures = self.pictures.take();
        let (photograph, _) = photograph(&mut self.scene, &mut self.cameras, taken, pictures);
        self.pictures = self.unknown.pictures(&self.given, self.input, &photograph);
        let shape = photograph
            .shape(&self.scene, &world_from_object)
            .map_err(|_| Unseen)?;
        let view = photograph.seen(&shape);
        self.level = photograph.level_of(LARGER_PIXELS);
        self.around = followed.around(view, self.level);
        Ok(())
    }

    /// Distance of the outline with the ratio tried nearest to the given one.
    pub(super) fn outline_px(&self, at: f64) -> Option<f64> {
        nearest_to(&self.tried, at).map(|near| self.tried[near].outline_px)
    }
}

impl Tried {
    /// The pose with another ratio and an outline of the same size: farther away for a longer focal
    /// length, or a larger toy.
    fn slid(&self, unknown: Unknown, at: f64, camera: &Camera) -> DMat4 {
        let camera_from_object = self.camera.world_from_camera.inverse() * self.world_from_object;
        let ratio = (at - self.at).exp();
        let slide = match unknown {
            Unknown::FocalLength => {
                let z_m = camera_from_object.w_axis.z * (ratio - 1.0);
                DMat4::from_translation(DVec3::new(0.0, 0.0, z_m))
            }
            Unknown::WorldScale => DMat4::from_scale(DVec3::splat(ratio)),
            // The shift by a lens varies over the picture: the pose starts unchanged.
            Unknown::Lens(_) => DMat4::IDENTITY,
        };
        camera.world_from_camera * slide * camera_from_object
    }
}

fn nearest_to(tried: &[Tried], at: f64) -> Option<usize> {
    let distance = |index: &usize| (tried[*index].at - at).abs();
    (0..tried.len()).min_by(|a, b| distance(a).total_cmp(&distance(b)))
}

/// Whether a plate was taken from a frame's place.
fn is_from_place(plate: &Plate, camera: &Camera) -> bool {
    let world_from_plate = &plate.camera.world_from_camera;
    world_from_plate.abs_diff_eq(camera.world_from_camera, SAME_CAMERA)
}

impl Unknown {
    /// The pictures of a trial, if all others have the same: not if a lens bends them, or if they show a plate from
    /// another place.
    fn pictures(self, plate: &Plate, input: &FrameInput, photograph: &Photograph) -> Option<Arc<Pyramid>> {
        let is_of_place =
            is_from_place(plate, &input.camera) && plate.camera.intrinsics == input.camera.intrinsics;
        let are_same = is_of_place && !matches!(self, Self::Lens(_));
        are_same.then(|| Arc::clone(photograph.pyramid()))
    }
}

/// A frame with a number, and its camera: if no plate was taken from there, it is estimated
/// relative to the plate. `pictures` are those of an earlier trial, if they are the same.
fn photograph(
    scene: &mut Scene,
    cameras: &mut Finder,
    taken: Taken,
    pictures: Option<Arc<Pyramid>>,
) -> (Photograph, Camera) {
    let Taken { plate, frame } = taken;
    let mut camera = frame.camera;
    let is_same = is_from_place(&plate, &camera);
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
    let photograph = match pictures {
        Some(mut pictures) => {
            Arc::make_mut(&mut pictures).set_intrinsics(camera.intrinsics);
            Photograph::of(scene, &seen, pictures)
        }
        None => Photograph::new(scene, &seen),
    };
    (photograph, camera)
}

/// The pose with the best outline.
fn posed(scene: &Scene, photograph: &Photograph, start: (&DMat4, Start)) -> Result<(DMat4, f64), Unseen> {
    // A toy that cannot be posed is an error of the following alignment.
    let found = photograph.tried_pose(scene, start).ok().flatten();
    found
        .filter(|(_, outline_px)| *outline_px <= MOST_OUTLINE_PX)
        .ok_or(Unseen)
}
