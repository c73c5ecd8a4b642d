//! Searches an upright toy of which only the model and the photograph are known.
//!
//! For each viewing direction, its silhouette is laid over a tiny picture (`pose::guesses`). The
//! best guesses are refined to the outline like given poses, and the matching ones are compared
//! with the model's own colours: two similar sides of a toy are distinguished by their paint, or
//! reported as ambiguous.

use std::sync::Arc;

use glam::{DMat4, DVec3, IVec2};

use crate::camera::{Finder, corrected};
use crate::error::{AlignError, check};
use crate::hand::photograph_from_plate;
use crate::photograph::Photograph;
use crate::picture::{Level, Picture, Pyramid};
use crate::placed_receivers::planes_under;
use crate::pose::{self, Paint, Start};
use crate::report::PoseDeviation;
use crate::shape::Shape;
use app_scene::frame::FrameInput;
use app_scene::scene::{Camera, Plate, PoseUncertainty, Receiver, Scene};

pub use crate::pose::ViewDirection;

/// Largest number of guesses that are followed to the outline.
const N_FOLLOWED: usize = 24;
/// Largest number of poses that are fully refined.
const N_REFINED: usize = 6;
/// Largest distance of a pose's outline for refinement, in pixels of the largest level.
const MOST_REFINED_PX: f64 = 2.0;
/// Number of guesses that must lead to a pose: a single one may match by chance.
const LEAST_SUPPORT: usize = 2;
/// Distance of the outline, in pixels, below which one guess is enough beside a plate: wrong poses
/// stayed above one beside a plate, and came to .46 without one.
const ALONE_PX: f64 = 0.3;
/// Poses are equal if the toy's centre differs by less, over its radius, and they are turned by
/// less, in radians.
const SAME_PLACE: f64 = 0.03;
const SAME_TURN_RAD: f64 = 0.1;
/// Side of the cells that points of a silhouette are merged in, over the toy's radius.
const CELL: f64 = 0.02;
/// Another pose is a rival if its outline's distance is at most this multiple of the best one's,
/// plus this many pixels of the largest level.
const RIVAL: f64 = 1.5;
const RIVAL_PX: f64 = 0.1;
/// A rival whose colour difference is at most this multiple of the best one's is ambiguous with it.
const ALIKE: f64 = 1.1;
/// Largest difference of colours, in natural logarithms.
const MOST_DIFFERENT: f64 = 1.0;
/// Linear light below which differences are noise.
const DARK: f64 = 0.004;
/// Least number of pixels of the level in which colours are compared.
const COMPARED_PIXELS: i32 = 60_000;
/// Largest number of pixels of the level in which hand-held plates are registered.
const REGISTERED_PIXELS: i32 = 120_000;
/// Largest distance of a hand-held plate's camera from the photograph's.
const HAND_M: f64 = 0.1;
const HAND_RAD: f64 = 0.11;

/// A pose of the toy that fits the photograph's outline.
#[derive(Clone, Debug)]
pub struct FoundToy {
    /// From object space to world.
    pub world_from_object: DMat4,
    /// Root mean square distance of the outline, in pixels.
    pub outline_px: f64,
    /// Mean difference of the toy's colours from those of the lit model, in natural logarithms: 1
    /// at most.
    pub color_difference: f64,
    /// Standard deviation of the pose.
    pub deviation: PoseDeviation,
    /// Planes that it may stand on, +Y up, the level one first; a second one if its three lowest
    /// feet are inclined against that.
    pub world_from_tables: Vec<DMat4>,
}

/// Result of a search for a toy.
#[derive(Clone, Debug, Default)]
pub struct ToySearch {
    /// Ambiguous poses that fit the outline, the likeliest first: one if the search succeeded.
    pub found: Vec<FoundToy>,
    /// Distance of the nearest outline that was reached, in pixels; `None` if too little of any was
    /// visible. It is robust: a distant outline comes to about two.
    pub nearest_px: Option<f64>,
    /// The cameras of the plates: corrected if their pictures require it.
    pub plate_cameras: Vec<Camera>,
}

/// Searches an upright toy. `input.world_from_object` has it upright in its size at any place, with
/// +Y up in the world; the camera stays.
///
/// Plates may be hand-held: up to 10 cm and 6 degrees from the photograph. The first receiver is an
/// approximate table.
///
/// # Errors
/// As [`Aligner::align`](crate::Aligner::align).
pub fn find_toy(
    scene: &Scene,
    input: &FrameInput,
    directions: &[ViewDirection],
) -> Result<ToySearch, AlignError> {
    check(scene, input)?;
    let mut scene = Scene::clone(scene);
    scene.uncertainty.are_receivers_guessed = true;
    let mut cameras = Finder::default();
    let turned: Vec<Option<Camera>> = scene.plates.iter().map(|plate| turned(plate, input)).collect();
    register_plates(&mut scene, input, (&turned, &mut cameras));
    let search = Search::new(Arc::new(scene.clone()), input.clone())?;
    let followed = search.followed(directions)?;
    let nearest_px = followed.first().map(|pose| search.in_picture_px(pose));
    let mut found = search.distinguished(search.refined(&followed)?);
    if let [one] = &mut found[..] {
        // The plates were registered by a guess of the table's plane, which is now known from the
        // toy.
        scene.receivers.truncate(1);
        for (receiver, world_from_table) in scene.receivers.iter_mut().zip(&one.world_from_tables) {
            receiver.world_from_plane = *world_from_table;
        }
        let before = scene.plates.clone();
        if register_plates(&mut scene, input, (&turned, &mut cameras)) {
            let search = Search::new(Arc::new(scene.clone()), input.clone())?;
            match search.refine(&one.world_from_object)? {
                Some(refined) => *one = refined,
                None => scene.plates = before,
            }
        }
    }
    Ok(ToySearch {
        nearest_px: found.first().map(|found| found.outline_px).or(nearest_px),
        found,
        plate_cameras: scene.plates.iter().map(|plate| plate.camera).collect(),
    })
}

/// A plate's camera if it stood at the photograph's, by common corners of both pictures; `None` if it is
/// not turned, or if these do not tell.
fn turned(plate: &Plate, input: &FrameInput) -> Option<Camera> {
    let photograph_from_plate = photograph_from_plate(&level_with(plate, input))?;
    Some(Camera {
        world_from_camera: input.camera.world_from_camera * DMat4::from_quat(photograph_from_plate),
        ..plate.camera
    })
}

/// Corrects the cameras of the plates, each relative to the photograph; `turned` are those by common
/// corners. Returns whether any changed.
fn register_plates(
    scene: &mut Scene,
    input: &FrameInput,
    (turned, cameras): (&[Option<Camera>], &mut Finder),
) -> bool {
    let mut is_any_moved = false;
    for (plate, turned) in scene.plates.iter_mut().zip(turned) {
        let camera = registered((plate, *turned), input, &scene.receivers, cameras);
        is_any_moved |= camera != plate.camera;
        plate.camera = camera;
    }
    is_any_moved
}

/// The camera of a plate relative to the photograph: the best estimate from the given one, from a
/// wider search, and from common corners.
fn registered(
    (plate, turned): (&Plate, Option<Camera>),
    input: &FrameInput,
    receivers: &[Receiver],
    cameras: &mut Finder,
) -> Camera {
    let from_hand = PoseUncertainty {
        position_m: Some(HAND_M),
        rotation_rad: Some(HAND_RAD),
    };
    let starts = [
        Some((plate.camera, PoseUncertainty::default())),
        Some((plate.camera, from_hand)),
        turned.map(|turned| (turned, from_hand)),
    ];
    let tries = starts.into_iter().flatten().filter_map(|(start, uncertainty)| {
        let mut plate = plate.clone();
        plate.camera = start;
        let loss = follow(&mut plate, input, receivers, (&uncertainty, cameras))?;
        Some((loss, plate.camera))
    });
    let best = tries.min_by(|(a, _), (b, _)| a.total_cmp(b));
    best.map_or(plate.camera, |(_, camera)| camera)
}

/// Moves the camera of a plate, which shows the table alone, until it fits the photograph; returns
/// the residual. Twice, since the table's place in the plate changes with its camera.
fn follow(
    plate: &mut Plate,
    input: &FrameInput,
    receivers: &[Receiver],
    (uncertainty, cameras): (&PoseUncertainty, &mut Finder),
) -> Option<f64> {
    let mut loss = None;
    for _ in 0..2 {
        let known = (std::slice::from_ref(&*plate), receivers);
        let photograph = (input.image.rgba(), &input.camera, None);
        let found = cameras.find(photograph, known, uncertainty)?;
        let (camera, _) = corrected(&input.camera, Some(found));
        let moved = input.camera.world_from_camera * camera.world_from_camera.inverse();
        loss = Some(if camera == input.camera {
            found.losses[0]
        } else {
            found.losses[1]
        });
        plate.camera.world_from_camera = moved * plate.camera.world_from_camera;
    }
    loss
}

/// Photograph and plate as they were taken, reduced.
fn level_with(plate: &Plate, input: &FrameInput) -> Level {
    let [frame, plate] = [input.image.rgba(), &plate.image].map(|image| Picture::decode(image));
    let pyramid = Pyramid::new(frame, Some(plate), input.camera.intrinsics);
    pyramid.at_most(REGISTERED_PIXELS)
}

/// A toy in a photograph whose pose is searched for.
pub(crate) struct Search {
    scene: Arc<Scene>,
    input: FrameInput,
    photograph: Photograph,
    /// In world space.
    upright: Shape,
}

/// A followed pose.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Followed {
    pub(crate) world_from_object: DMat4,
    /// Distance of the outline, in pixels of the largest level.
    pub(crate) outline_px: f64,
}

impl Search {
    pub(crate) fn new(scene: Arc<Scene>, input: FrameInput) -> Result<Self, AlignError> {
        Ok(Self {
            photograph: Photograph::new(&scene, &input),
            upright: Shape::new(&scene, &input.world_from_object)?,
            scene,
            input,
        })
    }

    /// The toy as it is given, as coarse as guesses need it, and the tiny picture that they are made in.
    pub(crate) fn tiny(&self) -> (Shape, Level) {
        (
            self.upright.merged(CELL * self.upright.radius_m),
            self.photograph.pyramid().at_most(pose::TINY_PIXELS),
        )
    }

    /// Distance of a followed outline, in pixels of the picture.
    pub(crate) fn in_picture_px(&self, followed: &Followed) -> f64 {
        self.photograph.pyramid().picture_px() * followed.outline_px
    }

    /// The best guesses, followed by coarse and fine rounds, the nearest outline first.
    fn followed(&self, directions: &[ViewDirection]) -> Result<Vec<Followed>, AlignError> {
        let (silhouette, tiny) = self.tiny();
        let mut followed = Vec::new();
        for guess in pose::guesses(&silhouette, &tiny, directions)
            .iter()
            .take(N_FOLLOWED)
        {
            let start = self.world_from_upright(&guess.camera_from_upright) * self.input.world_from_object;
            followed.extend(self.follow(&start)?);
        }
        followed.sort_by(|a, b| a.outline_px.total_cmp(&b.outline_px));
        Ok(followed)
    }

    /// A pose, followed to the outline; `None` if too little of the outline is visible.
    pub(crate) fn follow(&self, start: &DMat4) -> Result<Option<Followed>, AlignError> {
        let tried = self.photograph.tried_pose(&self.scene, (start, Start::Given))?;
        Ok(tried.map(|(world_from_object, outline_px)| Followed {
            world_from_object,
            outline_px,
        }))
    }

    fn world_from_upright(&self, camera_from_upright: &DMat4) -> DMat4 {
        self.input.camera.world_from_camera * *camera_from_upright
    }

    /// Different refined poses with a matching outline, the nearest first.
    fn refined(&self, followed: &[Followed]) -> Result<Vec<FoundToy>, AlignError> {
        let mut found: Vec<FoundToy> = Vec::new();
        let mut most_px = MOST_REFINED_PX;
        for pose in self.supported(followed).into_iter().take(N_REFINED) {
            if pose.outline_px > most_px {
                break;
            }
            let Some(refined) = self.refine(&pose.world_from_object)? else {
                continue;
            };
            // Before refinement, rivals are also close to the outline.
            most_px = most_px.min(RIVAL * pose.outline_px + RIVAL_PX);
            let is_known =
                |known: &FoundToy| self.are_one(&known.world_from_object, &refined.world_from_object);
            if !found.iter().any(is_known) {
                found.push(refined);
            }
        }
        found.sort_by(|a, b| a.outline_px.total_cmp(&b.outline_px));
        Ok(found)
    }

    /// Each pose that enough guesses lead to, once.
    fn supported(&self, followed: &[Followed]) -> Vec<Followed> {
        let mut poses: Vec<(Followed, usize)> = Vec::new();
        for one in followed {
            let known = poses
                .iter_mut()
                .find(|(pose, _)| self.are_one(&pose.world_from_object, &one.world_from_object));
            match known {
                Some((_, support)) => *support += 1,
                None => poses.push((*one, 1)),
            }
        }
        let alone_px = if self.scene.plates.is_empty() {
            0.0
        } else {
            ALONE_PX
        };
        let is_supported =
            |(pose, support): &(Followed, usize)| *support >= LEAST_SUPPORT || pose.outline_px <= alone_px;
        let supported = poses.into_iter().filter(is_supported);
        supported.map(|(pose, _)| pose).collect()
    }

    /// The pose near the given one, if its outline matches.
    pub(crate) fn refine(&self, world_from_object: &DMat4) -> Result<Option<FoundToy>, AlignError> {
        let given = self.input.clone().with_world_from_object(*world_from_object);
        let pose = self.photograph.pose(&self.scene, &given, None)?;
        let Some(report) = pose.report.filter(|_| pose.is_seen()) else {
            return Ok(None);
        };
        // Motion from its given upright place.
        let moved = pose.world_from_object * self.input.world_from_object.inverse();
        let up = moved.transform_vector3(DVec3::Y).normalize_or(DVec3::Y);
        Ok(Some(FoundToy {
            world_from_object: pose.world_from_object,
            outline_px: report.shown_px(),
            color_difference: self.color_difference(&pose.world_from_object)?,
            deviation: report.deviation,
            world_from_tables: planes_under(&self.scene, &pose.world_from_object, up)?,
        }))
    }

    /// The possible poses among those sorted by their outlines: the best one by its colours among
    /// similar outlines, and those that are ambiguous with it.
    pub(crate) fn distinguished(&self, found: Vec<FoundToy>) -> Vec<FoundToy> {
        let rival_px = RIVAL_PX * self.photograph.pyramid().picture_px();
        let Some(most_px) = found.first().map(|best| RIVAL * best.outline_px + rival_px) else {
            return found;
        };
        let mut rivals: Vec<FoundToy> = found;
        rivals.retain(|rival| rival.outline_px <= most_px);
        rivals.sort_by(|a, b| a.color_difference.total_cmp(&b.color_difference));
        let most = rivals.first().map_or(0.0, |best| ALIKE * best.color_difference);
        rivals.retain(|rival| rival.color_difference <= most);
        rivals
    }

    pub(crate) fn are_one(&self, a: &DMat4, b: &DMat4) -> bool {
        let middle = self
            .input
            .world_from_object
            .inverse()
            .transform_point3(self.upright.centre);
        let moved_m = a.transform_point3(middle).distance(b.transform_point3(middle));
        let [turn_a, turn_b] = [a, b].map(|pose| pose.to_scale_rotation_translation().1);
        let turned_rad = (turn_b * turn_a.inverse()).to_scaled_axis().length();
        moved_m < SAME_PLACE * self.upright.radius_m && turned_rad < SAME_TURN_RAD
    }

    /// Difference between the toy in the photograph and its model in the best light; the largest if
    /// too little of it is visible.
    fn color_difference(&self, world_from_object: &DMat4) -> Result<f64, AlignError> {
        let shape = self.photograph.shape(&self.scene, world_from_object)?;
        let camera_from_object = self.photograph.camera_from_object(world_from_object);
        let paint = Paint::new(&self.scene, &camera_from_object)?;
        let level = self
            .photograph
            .pyramid()
            .level(self.photograph.level_of(COMPARED_PIXELS));
        let coverage = pose::covered(&shape, level);
        let Some(shown) = paint.shown(level, &coverage) else {
            return Ok(MOST_DIFFERENT);
        };
        let is_within = |at: IVec2| coverage.at(at) >= 1.0;
        let pixels = coverage.pixels().zip(shown).filter(|(at, _)| is_within(*at));
        let (mut sum, mut n) = (0.0, 0.0);
        for (at, shown) in pixels {
            let (Some(shown), Some(seen)) = (shown, level.frame.get(at)) else {
                continue;
            };
            let differ = DVec3::from_array([0, 1, 2].map(|channel| {
                let [a, b] = [seen[channel], shown[channel]].map(|light| f64::from(light).max(0.0) + DARK);
                (a / b).ln().abs().min(MOST_DIFFERENT)
            }));
            sum += differ.element_sum() / 3.0;
            n += 1.0;
        }
        Ok(if n > 0.0 { sum / n } else { MOST_DIFFERENT })
    }
}
