//! Search for a toy that was put on a known table, from twelve turns, in steps. The best pose so
//! far is available after each step.
//!
//! The plane determines the toy's size at every place, so a tiny picture suffices to find the best
//! place of each turn (`pose::standing_guesses`). The best of these are followed to the outline,
//! and those that match it are refined and distinguished by their colours, as
//! [`find_toy`](crate::find_toy) does without a table.

use std::cmp::Reverse;
use std::f64::consts::TAU;
use std::sync::Arc;

use glam::{DMat4, DVec2, DVec3, IVec2};

use crate::camera::{Finder, corrected};
use crate::error::{AlignError, check};
use crate::photograph::Photograph;
use crate::picture::{Level, Mask};
use crate::pose::{self, Standing};
use crate::shape::Shape;
use crate::things::groups::{groups, place_of};
use crate::toy_search::{Followed, FoundToy, Search};
use app_scene::frame::FrameInput;
use app_scene::scene::{Camera, Scene};

/// Number of starting turns about the table's normal.
const N_TURNS: u32 = 12;
/// Number of guesses, ranked by a plate, that are followed to the outline.
const N_FOLLOWED: usize = 8;
/// Maximum number of refined poses.
const N_REFINED: usize = 3;
/// Largest distance between the outlines of a pose and the picture, in pixels of the largest level, at
/// which the pose is refined.
const MOST_REFINED_PX: f64 = 2.0;
/// Following ends once that many guesses lead to the same pose with an outline within that
/// distance, in pixels of the largest level.
const N_AGREED: usize = 2;
const AGREED_PX: f64 = 0.6;
/// Smallest share of the picture that can be a toy.
const LEAST_SHARE: f64 = 0.002;

/// Something in a picture that its plate does not show.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NewObject {
    /// Its centre on the first receiver, in the world.
    pub at: DVec3,
    /// Share of the picture that it covers, with its shadow.
    pub share: f64,
}

/// Difference between a picture and its plate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TableChange {
    /// There is none, or there is no plate.
    None,
    /// The largest new region that does not reach the picture's border.
    Object(NewObject),
    /// All new regions reach the border, as an arm does.
    AtBorder,
}

impl TableChange {
    /// Compares a picture with its plate.
    ///
    /// # Errors
    ///
    /// As [`Aligner::align`](crate::Aligner::align).
    pub fn of(scene: &Scene, input: &FrameInput) -> Result<Self, AlignError> {
        check(scene, input)?;
        let photograph = Photograph::new(scene, input);
        let tiny = photograph.pyramid().at_most(pose::TINY_PIXELS);
        if tiny.plate.is_none() {
            return Ok(Self::None);
        }
        let size_px = tiny.frame.size_px;
        let n_least = LEAST_SHARE * f64::from(size_px.x * size_px.y);
        let mut regions = changed_regions(&tiny);
        regions.retain(|region| region.len() as f64 >= n_least);
        let n_all = regions.len();
        let is_at_border = |at: &IVec2| at.cmpeq(IVec2::ZERO).any() || at.cmpeq(size_px - 1).any();
        regions.retain(|region| !region.iter().any(is_at_border));
        let are_at_border = n_all > 0 && regions.is_empty();
        regions.sort_by_key(|region| Reverse(region.len()));
        let mut objects = regions
            .iter()
            .filter_map(|region| object(region, scene, (&input.camera, &tiny)));
        Ok(match objects.next() {
            Some(object) => Self::Object(object),
            None if are_at_border => Self::AtBorder,
            None => Self::None,
        })
    }
}

/// A region of a reduced picture as an object on the first receiver; `None` above its horizon.
fn object(region: &[IVec2], scene: &Scene, (camera, tiny): (&Camera, &Level)) -> Option<NewObject> {
    let n = region.len() as f64;
    let sum: DVec2 = region.iter().map(|at| at.as_dvec2() + 0.5).sum();
    let ray = tiny.intrinsics.ray(sum / n);
    Some(NewObject {
        at: on_receiver(scene, &camera.world_from_camera, ray)?,
        share: n / f64::from(tiny.frame.size_px.element_product()),
    })
}

/// Intersection of a camera's ray with the first receiver, in the world; `None` above its horizon.
fn on_receiver(scene: &Scene, world_from_camera: &DMat4, ray: DVec3) -> Option<DVec3> {
    let (eye, ray) = (
        world_from_camera.w_axis.truncate(),
        world_from_camera.transform_vector3(ray),
    );
    let plane = scene.receivers.first()?.world_from_plane;
    let normal = plane.y_axis.truncate();
    let (height, slope) = ((eye - plane.w_axis.truncate()).dot(normal), ray.dot(normal));
    (height > 0.0 && slope < 0.0).then(|| eye - height / slope * ray)
}

/// Groups of neighbouring pixels that differ from the plate.
fn changed_regions(level: &Level) -> Vec<Vec<IVec2>> {
    let size_px = level.frame.size_px;
    let mut changed = Mask::new(size_px);
    for at in pose::changed(level) {
        changed.mark(at);
    }
    groups(size_px, |index| changed.has(place_of(index, size_px)))
        .into_iter()
        .map(|group| group.into_iter().map(|index| place_of(index, size_px)).collect())
        .collect()
}

/// A possible pose of the toy.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StandingPose {
    /// Transform from object space to world.
    pub world_from_object: DMat4,
    /// Root mean square distance of the outline, in pixels; `None` for a guess that was not
    /// followed yet.
    pub outline_px: Option<f64>,
}

/// The next step.
#[derive(Debug)]
enum Stage {
    Guess,
    Register,
    /// Remaining guesses, the best last.
    Follow(Vec<DMat4>),
    /// Remaining poses, the best last.
    Refine(Vec<Followed>),
    Done,
}

/// A search for a toy on a table, in steps of some tenths of a second.
pub struct StandingSearch {
    scene: Arc<Scene>,
    input: FrameInput,
    /// Point of the world that the toy's image is at, if it is known.
    at: Option<DVec3>,
    stage: Stage,
    /// The search, once the first guesses are made.
    search: Option<Search>,
    guesses: Vec<DMat4>,
    /// Whether the best guesses are the first.
    are_ranked: bool,
    followed: Vec<Followed>,
    found: Vec<FoundToy>,
    best: Option<StandingPose>,
}

impl StandingSearch {
    /// Begins a search. `input.world_from_object` stands on the first receiver, in any turn: at the
    /// toy's place if there is no plate, and anywhere if there is one: the search then begins where
    /// the picture differs from the plate.
    #[must_use]
    pub fn new(scene: Arc<Scene>, input: FrameInput) -> Self {
        Self {
            scene,
            input,
            at: None,
            stage: Stage::Guess,
            search: None,
            guesses: Vec::new(),
            are_ranked: false,
            followed: Vec::new(),
            found: Vec::new(),
            best: None,
        }
    }

    /// The same beside a plate where the toy's image is at this point of the world, whatever else
    /// in the picture differs from the plate.
    #[must_use]
    pub fn at(self, point: DVec3) -> Self {
        Self {
            at: Some(point),
            ..self
        }
    }

    /// The best pose so far; `None` before the first step.
    #[must_use]
    pub fn best(&self) -> Option<StandingPose> {
        self.best
    }

    /// Whether the search has ended.
    #[must_use]
    pub fn is_done(&self) -> bool {
        matches!(self.stage, Stage::Done)
    }

    /// Makes one step.
    ///
    /// # Errors
    ///
    /// As [`Aligner::align`](crate::Aligner::align). The search has then ended.
    pub fn step(&mut self) -> Result<(), AlignError> {
        self.stage = match std::mem::replace(&mut self.stage, Stage::Done) {
            Stage::Guess => self.guess()?,
            Stage::Register => self.register()?,
            Stage::Follow(waiting) => self.follow(waiting)?,
            Stage::Refine(waiting) => self.refine(waiting)?,
            Stage::Done => Stage::Done,
        };
        Ok(())
    }

    fn guess(&mut self) -> Result<Stage, AlignError> {
        check(&self.scene, &self.input)?;
        let search = Search::new(Arc::clone(&self.scene), self.input.clone())?;
        self.guesses = self.ranked(&search)?;
        self.are_ranked = !self.guesses.is_empty();
        // What differs from the plate is no toy if no turn of it fits there.
        if self.scene.plates.is_empty() || (self.at.is_some() && !self.are_ranked) {
            self.guesses = self.turned_in_place();
        }
        self.best = self.guesses.first().map(|world_from_object| StandingPose {
            world_from_object: *world_from_object,
            outline_px: None,
        });
        self.search = Some(search);
        Ok(Stage::Register)
    }

    /// The best place of each turn beside a plate, ranked by the picture; none without a plate.
    fn ranked(&self, search: &Search) -> Result<Vec<DMat4>, AlignError> {
        let receiver = self.scene.receivers.first();
        let Some(receiver) = receiver.filter(|_| !self.scene.plates.is_empty()) else {
            return Ok(Vec::new());
        };
        let normal = receiver.world_from_plane.y_axis.truncate();
        let world_from_camera = self.input.camera.world_from_camera;
        let camera_from_world = world_from_camera.inverse();
        let (_, tiny) = search.tiny();
        let shape = Shape::new(&self.scene, &(camera_from_world * self.input.world_from_object))?;
        let standing = Standing {
            point: shape.centre,
            normal: camera_from_world.transform_vector3(normal).normalize(),
        };
        let coarse = shape.merged_in_px(0.5, &tiny);
        let pixel = |at: DVec3| tiny.intrinsics.pixel_of(camera_from_world.transform_point3(at));
        let tapped_px = self.at.and_then(pixel);
        let guesses = pose::standing_guesses(&coarse, &tiny, (standing, &turns()), tapped_px);
        let in_world = |guess: &DMat4| world_from_camera * *guess * camera_from_world;
        let poses = guesses
            .iter()
            .map(|guess| in_world(&guess.camera_from_upright) * self.input.world_from_object);
        Ok(poses.collect())
    }

    /// All turns at the given place, starting with that of the input.
    fn turned_in_place(&self) -> Vec<DMat4> {
        let given = self.input.world_from_object;
        let up = self.scene.receivers.first();
        let up = up.map_or(DVec3::Y, |receiver| receiver.world_from_plane.y_axis.truncate());
        let middle = DMat4::from_translation(given.w_axis.truncate());
        let turned = turns().map(|turn_rad| {
            let turn = DMat4::from_axis_angle(up.normalize_or(DVec3::Y), turn_rad);
            middle * turn * middle.inverse() * given
        });
        turned.to_vec()
    }

    /// Corrects the camera against the plates, as an alignment does.
    fn register(&mut self) -> Result<Stage, AlignError> {
        let Scene {
            plates,
            receivers,
            uncertainty,
            ..
        } = &*self.scene;
        let given = (self.input.image.rgba(), &self.input.camera, None);
        let found = Finder::default().find(given, (plates, receivers), &uncertainty.camera);
        let (camera, _) = corrected(&self.input.camera, found);
        if camera != self.input.camera {
            let moved = camera.world_from_camera * self.input.camera.world_from_camera.inverse();
            // Guesses were made before the camera was corrected.
            for guess in &mut self.guesses {
                *guess = moved * *guess;
            }
            self.input.camera = camera;
            self.search = Some(Search::new(Arc::clone(&self.scene), self.input.clone())?);
        }
        let n_followed = if self.are_ranked {
            N_FOLLOWED
        } else {
            self.guesses.len()
        };
        let mut waiting: Vec<DMat4> = self.guesses.iter().take(n_followed).copied().collect();
        waiting.reverse();
        Ok(Stage::Follow(waiting))
    }

    fn follow(&mut self, mut waiting: Vec<DMat4>) -> Result<Stage, AlignError> {
        let (Some(search), Some(start)) = (&self.search, waiting.pop()) else {
            return Ok(self.end_following());
        };
        let Some(followed) = search.follow(&start)? else {
            return Ok(Stage::Follow(waiting));
        };
        self.followed.push(followed);
        let outline_px = search.in_picture_px(&followed);
        if self
            .best
            .and_then(|best| best.outline_px)
            .is_none_or(|px| outline_px < px)
        {
            self.best = Some(StandingPose {
                world_from_object: followed.world_from_object,
                outline_px: Some(outline_px),
            });
        }
        let same = self.followed.iter().filter(|other| {
            other.outline_px <= AGREED_PX
                && search.are_one(&other.world_from_object, &followed.world_from_object)
        });
        if waiting.is_empty() || same.count() >= N_AGREED {
            return Ok(self.end_following());
        }
        Ok(Stage::Follow(waiting))
    }

    /// Distinct poses, the nearest to the outline last.
    fn end_following(&mut self) -> Stage {
        let Some(search) = &self.search else {
            return Stage::Done;
        };
        self.followed
            .sort_by(|a, b| a.outline_px.total_cmp(&b.outline_px));
        let mut waiting: Vec<Followed> = Vec::new();
        for followed in &self.followed {
            let is_known = waiting
                .iter()
                .any(|known| search.are_one(&known.world_from_object, &followed.world_from_object));
            if !is_known && followed.outline_px <= MOST_REFINED_PX && waiting.len() < N_REFINED {
                waiting.push(*followed);
            }
        }
        waiting.reverse();
        if waiting.is_empty() {
            return Stage::Done;
        }
        Stage::Refine(waiting)
    }

    fn refine(&mut self, mut waiting: Vec<Followed>) -> Result<Stage, AlignError> {
        let (Some(search), Some(pose)) = (&self.search, waiting.pop()) else {
            return Ok(Stage::Done);
        };
        self.found.extend(search.refine(&pose.world_from_object)?);
        self.found.sort_by(|a, b| a.outline_px.total_cmp(&b.outline_px));
        if let Some(best) = search.distinguished(self.found.clone()).first() {
            self.best = Some(StandingPose {
                world_from_object: best.world_from_object,
                outline_px: Some(best.outline_px),
            });
        }
        Ok(if waiting.is_empty() {
            Stage::Done
        } else {
            Stage::Refine(waiting)
        })
    }
}

impl std::fmt::Debug for StandingSearch {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "StandingSearch({:?})", self.best)
    }
}

fn turns() -> [f64; N_TURNS as usize] {
    std::array::from_fn(|turn| TAU * turn as f64 / f64::from(N_TURNS))
}
