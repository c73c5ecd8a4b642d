//! Extent of things: each pixel belongs to the nearest seeds, along paths that do not cross edges
//! or the other's colours.
//!
//! Source: Criminisi et al. 2008, geodesic segmentation, with detected seeds.

use std::cmp::Reverse;
use std::collections::{BTreeMap, BinaryHeap};

use glam::{DVec2, IVec2};

use super::codes::{Codes, apart};
use super::colors::Colors;
use super::groups::{STEPS, groups, place_of};
use super::known::Known;
use super::seeds::{Colored, Seed, Seeds};
use crate::picture::{Color, bilinear, index_in, places, square};

/// Cost of a step: a constant, a factor for each code of change in the plate, and one for the log
/// likelihood against it.
const OF_STEP: f32 = 0.3;
const OF_CODE: f32 = 1.0 / 6.0;
const OF_COLOR: f32 = 0.4;
/// Log likelihood ratio from which on a colour is a thing's own, and the reduced cost of a change
/// between two of them.
const OWN: f32 = 1.5;
const WITHIN: f32 = 0.15;
/// Cost of a step between two of them, for a thing without a plane: it may have large uniform faces in
/// doubtful colours. With .3, .1 and .05 the RMS error of the shadow beside a pale post on wood is 3.65,
/// 2.25 and 1.71 codes, that of the toy behind it 6.3, 7.1 and 7.2. Sides of planes would be 3 mm off.
const OF_OWN_STEP: f32 = 0.1;
/// Log likelihood ratio from which on a colour is the place's, and the radius within which most
/// pixels must agree.
const LIKE_PLACE: f32 = 0.5;
const AROUND_PX: i32 = 2;
/// Maximum number of pixels of a hole that is closed.
const LARGEST_HOLE: usize = 100;
/// Maximum distance of growth.
const FARTHEST: f32 = 40.0;
/// The same from the receiver to free pixels, unless they have a thing's own colours: mostly the table far behind the
/// toy and what the toy hides, where posts grew 20 to 40 pixels beyond their rims. The edge between two faces of a
/// post costs 3 to 6, that between the post and a table 7 to 11.
const FARTHEST_FREE: f32 = 10.0;

/// Minimum number of seeds of a thing that is not before the toy: fewer may come from the camera's
/// own processing.
pub(super) const LEAST_ALONE: usize = 60;
/// Distance in pixels at which a group touches a thing, and an added one's distance from the receiver.
pub(super) const TOUCH_PX: i32 = 3;
const ABSORBED: f32 = 10.0;
/// Part of a thing's seeds on known tops and their sides from which on it ends with these.
const ON_SOLID: f32 = 0.9;

/// Things of a level.
pub(super) struct Grown {
    size_px: IVec2,
    /// Each pixel's distance from the receiver's seeds, less that from the things' seeds.
    nearer: Vec<f32>,
    /// The thing of each pixel.
    thing: Vec<Option<u32>>,
    n_seeds: Vec<usize>,
    place: Place,
    /// Whether each pixel is of a thing's shadow.
    is_shadow: Vec<bool>,
    colors: Colors,
}

/// What things grow in, whatever the cost of their own steps.
struct Place {
    /// Each pixel's distance from the receiver's seeds.
    from_receiver: Vec<f32>,
    /// Whether most pixels around each one have the place's colours in the plate.
    is_like: Vec<bool>,
}

impl Place {
    /// The place of seeds of a kind; `None` if there are none.
    fn of(seeds: &Seeds, kind: Seed, plate: &Codes) -> Option<Self> {
        let colors = seeds.known_colors(kind);
        let from_receiver = || {
            let mut distances = distances(seeds, (plate, colors), (Seed::Receiver, OF_STEP));
            for ((distance, is_free), color) in distances.iter_mut().zip(&seeds.is_free).zip(&plate.pixels) {
                if *is_free && !is_own(colors, *color) {
                    *distance = distance.min(FARTHEST_FREE);
                }
            }
            distances
        };
        seeds.seeds.contains(&kind).then(|| Self {
            from_receiver: from_receiver(),
            is_like: like_place(seeds.size_px, plate, colors),
        })
    }
}

impl Grown {
    /// Grows from the seeds of a kind; `None` if there are none.
    pub(super) fn from(seeds: &Seeds, kind: Seed, plate: &Codes) -> Option<Self> {
        let place = Place::of(seeds, kind, plate)?;
        Some(Self::in_place(place, (seeds, kind), plate, OF_STEP))
    }

    /// The same over all of a thing's uniform faces.
    pub(super) fn whole_from(seeds: &Seeds, kind: Seed, plate: &Codes) -> Option<Self> {
        let place = Place::of(seeds, kind, plate)?;
        Some(Self::in_place(place, (seeds, kind), plate, OF_OWN_STEP))
    }

    /// What grew from the seeds of a kind, grown over all of a thing's uniform faces.
    pub(super) fn whole(self, seeds: &Seeds, kind: Seed, plate: &Codes) -> Self {
        Self::in_place(self.place, (seeds, kind), plate, OF_OWN_STEP)
    }

    /// Grows in a place; `of_own` is the cost of a step between colours of the thing.
    fn in_place(place: Place, (seeds, kind): (&Seeds, Seed), plate: &Codes, of_own: f32) -> Self {
        let colors = seeds.known_colors(kind);
        let of_thing = distances(seeds, (plate, colors), (kind, of_own));
        let both = of_thing.iter().zip(&place.from_receiver);
        let nearer = both.map(|(thing, receiver)| receiver - thing);
        let nearer = without_holes(nearer.collect(), seeds);
        let groups = groups(seeds.size_px, |index| nearer[index] > 0.0);
        let mut thing = vec![None; nearer.len()];
        let mut n_seeds = Vec::new();
        for (number, group) in (0..).zip(&groups) {
            for index in group {
                thing[*index] = Some(number);
            }
            n_seeds.push(group.iter().filter(|index| seeds.seeds[**index] == kind).count());
        }
        Self {
            size_px: seeds.size_px,
            nearer,
            thing,
            n_seeds,
            place,
            is_shadow: vec![false; plate.pixels.len()],
            colors: colors.clone(),
        }
    }

    /// Without the pixels beside known tops and their sides, of things whose seeds are on these: a side of a
    /// ramp of stone had grown over a table of the same stone.
    pub(super) fn within(mut self, is_solid: impl Fn(IVec2) -> bool, (seeds, kind): (&Seeds, Seed)) -> Self {
        let is_solid = |index: usize| is_solid(place_of(index, seeds.size_px));
        let mut n_on = vec![0; self.n_seeds.len()];
        for index in seeds.of(kind) {
            if let Some(thing) = self.thing[index].filter(|_| is_solid(index)) {
                n_on[thing as usize] += 1;
            }
        }
        let is_on = |thing: u32| {
            let of = |n: &[usize]| n[thing as usize] as f32;
            of(&n_on) > ON_SOLID * of(&self.n_seeds)
        };
        for (index, (thing, nearer)) in self.thing.iter_mut().zip(&mut self.nearer).enumerate() {
            if thing.is_some_and(is_on) && !is_solid(index) {
                (*thing, *nearer) = (None, nearer.min(-OF_STEP));
            }
        }
        self
    }

    /// Things of known pixels, each with the number of its seeds, in a place of unknown colours.
    pub(super) fn of_groups(size_px: IVec2, groups: &[(usize, Vec<usize>)]) -> Self {
        let n_pixels = (size_px.x * size_px.y) as usize;
        let (mut thing, mut nearer) = (vec![None; n_pixels], vec![-FARTHEST; n_pixels]);
        for (number, (_, group)) in (0..).zip(groups) {
            for index in group {
                thing[*index] = Some(number);
                nearer[*index] = FARTHEST;
            }
        }
        Self {
            size_px,
            nearer,
            thing,
            n_seeds: groups.iter().map(|(n_seeds, _)| *n_seeds).collect(),
            place: Place {
                from_receiver: vec![FARTHEST; n_pixels],
                is_like: vec![false; n_pixels],
            },
            is_shadow: vec![false; n_pixels],
            colors: Colors::default(),
        }
    }

    /// For each pixel of a group, the things of the pixels around it.
    pub(super) fn touched(&self, group: &[usize]) -> impl Iterator<Item = usize> {
        group.iter().flat_map(|index| {
            let at = place_of(*index, self.size_px);
            square(at, TOUCH_PX).filter_map(|at| self.of_pixel(at))
        })
    }

    /// Adds groups of pixels, each to the thing that most of it touches or is part of.
    pub(super) fn absorb(&mut self, groups: &[Vec<usize>]) {
        for group in groups {
            let mut counts: BTreeMap<usize, usize> = BTreeMap::new();
            self.touched(group)
                .for_each(|thing| *counts.entry(thing).or_default() += 1);
            let most = counts.into_iter().max_by_key(|(_, n)| *n);
            let Some(thing) = most.and_then(|(thing, _)| u32::try_from(thing).ok()) else {
                continue;
            };
            for index in group {
                self.is_shadow[*index] = true;
                self.thing[*index] = self.thing[*index].or(Some(thing));
                self.nearer[*index] = self.nearer[*index].max(ABSORBED);
            }
        }
    }

    /// Whether a place in pixels has the colours of the place below the things, such as a thing's
    /// shadow.
    pub(super) fn is_like_place(&self, place: DVec2) -> bool {
        self.index(place).is_some_and(|index| self.place.is_like[index])
    }

    /// Whether a colour in codes is a thing's own.
    pub(super) fn is_own_color(&self, color: Color) -> bool {
        is_own(&self.colors, color)
    }

    /// Whether a colour in codes is the place's.
    pub(super) fn is_place_color(&self, color: Color) -> bool {
        is_of_place(&self.colors, color)
    }

    /// Whether a place in pixels is in a thing's shadow.
    pub(super) fn is_shadow(&self, place: DVec2) -> bool {
        self.index(place).is_some_and(|index| self.is_shadow[index])
    }

    /// Index of the pixel at a place in pixels.
    pub(super) fn index(&self, place: DVec2) -> Option<usize> {
        index_in(self.size_px, place.floor().as_ivec2())
    }

    pub(super) fn size_px(&self) -> IVec2 {
        self.size_px
    }

    pub(super) fn n_things(&self) -> usize {
        self.n_seeds.len()
    }

    pub(super) fn n_seeds(&self, thing: usize) -> usize {
        self.n_seeds[thing]
    }

    /// For each thing, whether it has the seeds of one that is not before the toy; `needed` is the
    /// evidence that each needs.
    pub(super) fn alone(&self, needed: &[f32]) -> Vec<Known> {
        let things = self.n_seeds.iter().zip(needed);
        let known = things
            .map(|(n_seeds, needed)| Known::of(*needed, |part| *n_seeds as f32 >= part * LEAST_ALONE as f32));
        known.collect()
    }

    /// The thing of a pixel.
    pub(super) fn of_pixel(&self, at: IVec2) -> Option<usize> {
        self.thing[index_in(self.size_px, at)?].map(|thing| thing as usize)
    }

    /// The thing at a place in pixels, interpolated between the centres of pixels.
    pub(super) fn at(&self, place: DVec2) -> Option<usize> {
        let last = self.size_px - 1;
        let mut sum = 0.0;
        let mut thing = None;
        for (at, weight) in bilinear(place - 0.5) {
            let index = index_in(self.size_px, at.clamp(IVec2::ZERO, last))?;
            sum += weight * self.nearer[index].clamp(-FARTHEST, FARTHEST);
            thing = thing.or(self.thing[index]);
        }
        thing.filter(|_| sum > 0.0).map(|thing| thing as usize)
    }

    /// The same without its shadow, and without pixels in the place's colours unless it may have these.
    pub(super) fn body_at(&self, place: DVec2, colored: Colored) -> Option<usize> {
        let is_place = colored == Colored::Otherwise && self.is_like_place(place);
        self.at(place).filter(|_| !is_place && !self.is_shadow(place))
    }
}

/// Closes small holes without seeds.
fn without_holes(mut nearer: Vec<f32>, seeds: &Seeds) -> Vec<f32> {
    let holes = groups(seeds.size_px, |index| nearer[index] <= 0.0);
    let is_known = |index: &usize| seeds.seeds[*index] == Seed::Receiver;
    for hole in holes
        .iter()
        .filter(|hole| hole.len() <= LARGEST_HOLE && !hole.iter().any(is_known))
    {
        for index in hole {
            nearer[*index] = OF_STEP;
        }
    }
    nearer
}

/// Whether a colour in codes is a thing's own.
fn is_own(colors: &Colors, color: Color) -> bool {
    colors.likelier(color).is_some_and(|likelier| likelier > OWN)
}

/// Whether a colour in codes is likelier the place's.
fn is_of_place(colors: &Colors, color: Color) -> bool {
    colors
        .likelier(color)
        .is_some_and(|likelier| likelier < -LIKE_PLACE)
}

/// For each pixel, whether most pixels around it are likelier the place's.
pub(super) fn like_place(size_px: IVec2, plate: &Codes, colors: &Colors) -> Vec<bool> {
    let pixels = plate.pixels.iter();
    let is_like: Vec<bool> = pixels.map(|color| is_of_place(colors, *color)).collect();
    let around = |at: IVec2| square(at, AROUND_PX).filter_map(|at| index_in(size_px, at));
    let most = |at: IVec2| 2 * around(at).filter(|index| is_like[*index]).count() > around(at).count();
    places(size_px).map(most).collect()
}

/// Distances from the seeds of one kind to each pixel, at most [`FARTHEST`]. Source: Dijkstra 1959.
fn distances(seeds: &Seeds, (plate, colors): (&Codes, &Colors), (from, of_own): (Seed, f32)) -> Vec<f32> {
    let mut distances = vec![FARTHEST; plate.pixels.len()];
    let mut open = BinaryHeap::new();
    for (at, index) in places(seeds.size_px).zip(0..) {
        if seeds.seeds[index] == from {
            distances[index] = 0.0;
            open.push((Reverse(0), at.to_array()));
        }
    }
    while let Some((Reverse(distance), at)) = open.pop() {
        let at = IVec2::from_array(at);
        let Some(index) = index_in(seeds.size_px, at) else {
            continue;
        };
        if distance > units(distances[index]) {
            continue;
        }
        for step in STEPS {
            let Some(other) = index_in(seeds.size_px, at + step) else {
                continue;
            };
            let farther = distances[index] + cost((plate, colors), [index, other], (from, of_own));
            if farther < distances[other] {
                distances[other] = farther;
                open.push((Reverse(units(farther)), (at + step).to_array()));
            }
        }
    }
    distances
}

/// Cost of a step to a neighbouring pixel.
fn cost((plate, colors): (&Codes, &Colors), [from, to]: [usize; 2], (of, of_own): (Seed, f32)) -> f32 {
    let [a, b] = [plate.pixels[from], plate.pixels[to]];
    if a[0].is_nan() || b[0].is_nan() {
        return FARTHEST;
    }
    // The place is known from many pixels, a thing from few: a colour that is new to the place is
    // not part of it, but one that is new to a thing may be.
    let against = match of {
        Seed::Receiver => colors.unusual(b),
        _ => -colors.likelier(b).unwrap_or(0.0),
    };
    // A thing may have a pattern: edges between its own colours are not part of its outline.
    let [of_step, of_code] = match (of, colors.likelier(a), colors.likelier(b)) {
        (Seed::Thing, Some(from), Some(to)) if from.min(to) > OWN => [of_own, WITHIN * OF_CODE],
        _ => [OF_STEP, OF_CODE],
    };
    of_step + of_code * apart(a, b) + OF_COLOR * against.max(0.0)
}

/// Distances as whole numbers, which can be ordered.
#[allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "no more than the farthest"
)]
fn units(distance: f32) -> u32 {
    (distance * 1e6) as u32
}
