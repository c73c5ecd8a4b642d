//! The memory of a search for things, for the search in the next picture: marks then neither come
//! for a single picture, nor flicker where nothing changes.

use glam::{DMat4, DVec3, IVec2};

use super::codes::{Codes, apart, least_change};
use super::ends::Ends;
use super::grown::Grown;
use super::known::{HELD, Known};
use crate::picture::{Mask, index_in, places};
use crate::receivers::{SeenReceiver, receiver_at};
use app_scene::scene::{Intrinsics, Light};
use app_scene::things::{Mark, RaisedPoint};

/// Evidence that a thing needs, over that of a single picture: one that had half of that evidence in
/// the previous picture, and one that no picture before showed. One that was marked there needs [`HELD`].
const SEEN: f32 = 1.0;
const NEW: f32 = 2.0;
/// Share of a thing's pixels that the previous picture must have shown as a thing.
const SAME_PLACE: f32 = 0.3;
/// Movement in pixels of a level within which two pictures show the same view.
const SAME_VIEW_PX: f64 = 0.5;
/// Distance in pixels of a level within which the outline of a thing in an unchanged part of the
/// picture stays.
const SAME_OUTLINE_PX: f64 = 3.0;

/// Number of the toy's points by which a movement of it or of a part of it is told.
const N_POINTS: usize = 64;

/// Place from which a picture was taken, with the toy and the lights in it.
#[derive(Clone, Debug)]
pub(crate) struct Place {
    intrinsics: Intrinsics,
    world_from_camera: DMat4,
    /// Some points of the toy in camera space, the same for each pose.
    toy: Vec<DVec3>,
    lights: Vec<Light>,
}

/// The memory of a search.
#[derive(Clone, Debug)]
pub(crate) struct Memory {
    place: Place,
    frame: Codes,
    /// The state of each pixel of the level.
    known: Vec<Known>,
    /// Marks of the largest level, rows from the top, and its size; empty if there are none.
    marks: (IVec2, Vec<Mark>),
    /// The points of things at these pixels; empty if there are none.
    raised: Vec<RaisedPoint>,
    /// The ends of things before the toy.
    ends: Ends,
    /// Marks without and with the place's pattern; `None` if the plate is not wrong.
    pattern: Option<[Vec<Mark>; 2]>,
}

impl Memory {
    /// The memory of a level's frame.
    pub(super) fn new(place: Place, frame: Codes, known: Vec<Known>) -> Self {
        Self {
            place,
            frame,
            known,
            marks: (IVec2::ZERO, Vec::new()),
            raised: Vec::new(),
            ends: Ends::default(),
            pattern: None,
        }
    }

    /// The evidence that each thing of a level needs, from a camera whose projection is given in
    /// the level's pixels.
    pub(super) fn needed(
        &self,
        grown: &Grown,
        receivers: &[SeenReceiver],
        (intrinsics, world_from_camera): (&Intrinsics, &DMat4),
    ) -> Vec<f32> {
        let mut counts = vec![[0_u32; 3]; grown.n_things()];
        let before_from_camera = self.place.world_from_camera.inverse() * *world_from_camera;
        for at in places(grown.size_px()) {
            let Some(thing) = grown.of_pixel(at) else { continue };
            let there = receiver_at(receivers, intrinsics, at).and_then(|(_, point)| {
                let point = before_from_camera.transform_point3(point);
                self.place.intrinsics.pixel_of(point)
            });
            // The previous picture may not have shown it.
            let index = there.and_then(|px| index_in(self.frame.size_px, px.floor().as_ivec2()));
            if let Some(known) = index.and_then(|index| self.known.get(index)) {
                counts[thing][*known as usize] += 1;
            }
        }
        let needed = |[nothing, candidate, marked]: [u32; 3]| {
            let n_shown = nothing + candidate + marked;
            let least = SAME_PLACE * n_shown as f32;
            if n_shown == 0 {
                SEEN
            } else if marked as f32 > least {
                HELD
            } else if (candidate + marked) as f32 > least {
                SEEN
            } else {
                NEW
            }
        };
        counts.into_iter().map(needed).collect()
    }

    /// Marks of the largest level of the next picture: as before where neither the picture nor
    /// light, toy and camera changed, up to the next change of a thing's outline.
    /// A pixel of it has `per_px` of the level.
    pub(super) fn steadied(
        &self,
        now: &Self,
        (size_px, per_px): (IVec2, f64),
        marks: Vec<Mark>,
    ) -> Vec<Mark> {
        let (known_px, known) = &self.marks;
        if *known_px != size_px || !self.is_of_same_view(now) {
            return marks;
        }
        let has_changed = self.frame.changed(&now.frame);
        #[allow(clippy::cast_possible_truncation, reason = "some pixels")]
        let reach_px = (SAME_OUTLINE_PX / per_px).round() as i32;
        let near = [known, &marks].map(|marks| {
            let mut mask = Mask::new(size_px);
            let marked = places(size_px)
                .zip(marks)
                .filter(|(_, mark)| **mark != Mark::None);
            marked.for_each(|(at, _)| mask.mark(at));
            mask.grown(reach_px)
        });
        let steadied = places(size_px)
            .zip(known.iter().zip(&marks))
            .map(|(at, (known, mark))| {
                let is_near = near.iter().all(|near| near.has(at));
                let in_level = ((at.as_dvec2() + 0.5) * per_px).floor().as_ivec2();
                // A painted pixel shows the toy, whose picture does not change if the thing behind it moves.
                let is_painted = [known, mark]
                    .iter()
                    .any(|mark| matches!(mark, Mark::PaintedThing { .. }));
                let stays = known != mark && is_near && !is_painted && !has_changed.has(in_level);
                if stays { *known } else { *mark }
            });
        steadied.collect()
    }

    /// The points of things and the ends of those before the toy, if neither the marks nor light, toy and camera have
    /// changed.
    pub(super) fn points_and_ends(
        &self,
        now: &Self,
        size_px: IVec2,
        marks: &[Mark],
    ) -> Option<(Vec<RaisedPoint>, Ends)> {
        let (known_px, known) = &self.marks;
        let is_same = *known_px == size_px && known == marks && self.is_of_same_view(now);
        is_same.then(|| (self.raised.clone(), self.ends.clone()))
    }

    /// Marks with the place's pattern, if neither those without it nor light, toy and camera have changed.
    pub(super) fn completed(&self, now: &Self, marks: &[Mark]) -> Option<&[Mark]> {
        let [without, with] = self.pattern.as_ref()?;
        (without == marks && self.is_of_same_view(now)).then_some(with)
    }

    /// With its picture's marks without and with the place's pattern.
    pub(super) fn with_pattern(self, without: Vec<Mark>, with: Vec<Mark>) -> Self {
        Self {
            pattern: Some([without, with]),
            ..self
        }
    }

    /// Whether neither light, toy nor camera have changed.
    fn is_of_same_view(&self, now: &Self) -> bool {
        self.frame.size_px == now.frame.size_px && self.place.is_like(&now.place, self.frame.size_px)
    }

    /// With the ends of things before the toy.
    pub(super) fn with_ends(self, ends: Ends) -> Self {
        Self { ends, ..self }
    }

    /// With the marks of its picture's largest level, and the points of things.
    pub(crate) fn with_marks(self, size_px: IVec2, marks: &[Mark], raised: &[RaisedPoint]) -> Self {
        Self {
            marks: (size_px, marks.to_vec()),
            raised: raised.to_vec(),
            ..self
        }
    }
}

impl Codes {
    /// Pixels that differ from those of another picture of the same size by more than noise.
    fn changed(&self, other: &Self) -> Mask {
        let both = self.pixels.iter().zip(&other.pixels);
        let apart: Vec<f32> = both
            .map(|(a, b)| match (a[0].is_nan(), b[0].is_nan()) {
                (false, false) => apart(*a, *b),
                (true, true) => 0.0,
                _ => f32::INFINITY,
            })
            .collect();
        let known = apart
            .iter()
            .zip(&self.pixels)
            .filter(|(_, pixel)| !pixel[0].is_nan());
        let least = least_change(known.map(|(apart, _)| *apart));
        let mut changed = Mask::new(self.size_px);
        let unlike = places(self.size_px)
            .zip(apart)
            .filter(|(_, apart)| *apart > least);
        unlike.for_each(|(at, _)| changed.mark(at));
        changed.grown(1)
    }
}

impl Place {
    /// The place of a camera's picture, with a toy of these points in camera space.
    pub(super) fn new(
        (intrinsics, world_from_camera): (&Intrinsics, &DMat4),
        points: &[DVec3],
        lights: &[Light],
    ) -> Self {
        let stride = points.len().div_ceil(N_POINTS).max(1);
        Self {
            intrinsics: *intrinsics,
            world_from_camera: *world_from_camera,
            toy: points.iter().step_by(stride).copied().collect(),
            lights: lights.to_vec(),
        }
    }

    /// Whether both pictures show the same view of the toy in the same light, within a part of a
    /// pixel.
    fn is_like(&self, other: &Self, size_px: IVec2) -> bool {
        let before_from_camera = self.world_from_camera.inverse() * other.world_from_camera;
        let corners = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0], [0.5, 0.5]];
        let distance_m = other.toy.iter().map(|point| point.z.abs()).sum::<f64>() / other.toy.len() as f64;
        let is_still = |corner: [f64; 2]| {
            let at = glam::DVec2::from_array(corner) * size_px.as_dvec2();
            let point = distance_m * other.intrinsics.ray(at);
            let there = self
                .intrinsics
                .pixel_of(before_from_camera.transform_point3(point));
            there.is_some_and(|there| there.distance(at) < SAME_VIEW_PX)
        };
        let is_toy_still = self.toy.len() == other.toy.len()
            && self.toy.iter().zip(&other.toy).all(|(a, b)| {
                match [self.intrinsics.pixel_of(*a), other.intrinsics.pixel_of(*b)] {
                    [Some(a), Some(b)] => a.distance(b) < SAME_VIEW_PX,
                    both => both == [None, None],
                }
            });
        self.lights == other.lights && is_toy_still && corners.into_iter().all(is_still)
    }
}
