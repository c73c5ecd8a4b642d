//! Points of things that stand on the first receiver, on which the toy's shadow falls, as if each
//! thing were upright.
//!
//! The lights' share of a point's light follows from a thing's shaded parts, as if it had one
//! colour: what is no brighter than these gets no darker. A thing whose shadow in the picture
//! contradicts its points has none.

use glam::{DVec3, IVec2};

use super::codes::codes_of;
use super::exposure::gain;
use super::feet::{Bodies, Feet, WITHIN_PX, pixel_of, shadow_of};
use super::found::Found;
use super::groups::{cross, in_level};
use super::sight::Sight;
use crate::lights::Compared;
use crate::median::{median, part_of};
use crate::picture::{Level, brightness, index_in, places};
use crate::receivers::SeenReceiver;
use app_scene::scene::Light;
use app_scene::things::{Mark, RaisedPoint};

/// Part of a thing's pixels that are in shadow, or on sides that no light reaches. With .1, .25 and
/// .4 the shadow's RMS error is 1.89, 1.86 and 1.86 codes for a post, 6.55, 6.44 and 6.44 for a cup,
/// and 4.54, 3.57 and 4.05 for a white mug on pale stone.
const SHADED: f64 = 0.25;
/// Least part of the light that a shadowed pixel of a thing loses, so that noise and codes do not
/// decide; and the least number of such pixels of the level, so that a corner of the shadow does not:
/// with 12 the error of the shadow beside a post with 11 of them is 3.37 codes, with 8 it is 2.81. Of the
/// things in 18 other captures none has 1 to 28, so that the loss decides.
const SHADOWED: f32 = 0.1;
const LEAST_SHADOWED: usize = 8;
/// Largest loss of a thing's points, over that without shadows on them: .14, .41 and .45 for those
/// three, .57 for the post with few shadowed pixels, .08 to .17 for a box and two mugs; 1.5 for a
/// chequered board whose front no light reaches, which one colour does not describe, .74 to 1.2 for
/// books, a ramp and a block, .79 for a blue mug on blue tiles of which a side is not found.
const OF_NONE: f32 = 0.6;
/// Heights at which a top is looked for, in steps of the highest point of a thing, and the first one: a
/// lower top is a book's, whose plane is found otherwise. A top explains this many times as much as none.
/// Measured: tops of blocks of 40, 40 and 50 mm at 39, 40 and 51 mm, which explain 1.58, 1.06 and 1.43
/// times as much, and none of seven mugs and posts above 1.01. A block behind the toy, of which no
/// point explains anything, seems to have a top, too.
const N_TOPS: u32 = 32;
const FIRST_TOP: u32 = 8;
const OF_TOP: f32 = 1.05;
/// Largest loss of a pixel, a squared difference in plates: that of nearly half of the light, so that
/// a highlight or a wrong pixel counts no more than a wrong shadow.
const MOST_LOSS: f32 = 0.2;
/// Part of a light that is blocked in its own umbra, and at most of any other light there.
const UMBRA: f32 = 0.9;
const OPEN: f32 = 0.1;

impl Sight<'_> {
    /// The points of things at the pixels of the largest level; empty if there are none.
    pub(super) fn raised(&self, level: &Level, found: &Found<'_>, bodies: &Bodies) -> Vec<RaisedPoint> {
        let Some(table) = self.receivers.first() else {
            return Vec::new();
        };
        let table_from_world = self.plane_from_world(table);
        let upright = Upright {
            bodies,
            largest: self.pyramid.level(0),
            level,
            compared: found.compared,
            table,
            lights: self
                .lights
                .iter()
                .map(|light| light.moved(&table_from_world))
                .collect(),
        };
        upright.raised().unwrap_or_default()
    }

    /// The things of the plate at the pixels of the largest level, which have these marks.
    pub(super) fn bodies(
        &self,
        level: &Level,
        found: &Found<'_>,
        (size_px, marks): (IVec2, &[Mark]),
    ) -> Bodies {
        let largest = self.pyramid.level(0);
        let per_px = self.per_px(level);
        let body = |(at, mark): (IVec2, &Mark)| match mark {
            Mark::Thing | Mark::BeforeToy | Mark::HiddenThing { .. } => {
                found.body_at((at.as_dvec2() + 0.5) * per_px)
            }
            _ => None,
        };
        let bodies = Bodies {
            size_px,
            thing: places(size_px).zip(marks).map(body).collect(),
            per_px,
        };
        bodies.without_rims(|at| {
            let color = largest.plate.as_ref().and_then(|plate| plate.get(at));
            color.is_some_and(|color| found.is_own_color(codes_of(color)))
        })
    }
}

/// A point of a thing: in the space of the receiver, and the lights' share.
#[derive(Clone, Copy)]
struct Point {
    at: DVec3,
    of_lights: f32,
}

/// A pixel of the level that shows a point of a thing.
#[derive(Clone, Copy)]
struct Shown {
    thing: usize,
    point: Point,
    /// Brightness over that of the receiver in all of its light.
    ratio: f32,
}

/// Inputs of the search.
pub(super) struct Upright<'a> {
    pub(super) bodies: &'a Bodies,
    /// The largest level, and that of the search.
    pub(super) largest: &'a Level,
    pub(super) level: &'a Level,
    pub(super) compared: &'a [Compared],
    pub(super) table: &'a SeenReceiver,
    /// The lights in the space of the receiver.
    pub(super) lights: Vec<Light>,
}

/// What is known before the points are.
struct Known {
    n_things: usize,
    /// Exposure of the frame over that of the plate.
    gain: f32,
    /// For each light and pixel of the level, the part of the receiver's light that the toy takes from it.
    taken: Vec<Vec<f32>>,
}

impl Upright<'_> {
    /// The point of each pixel of the largest level; `None` if no thing has any.
    pub(super) fn raised(&self) -> Option<Vec<RaisedPoint>> {
        let n_things = self.bodies.thing.iter().flatten().max()? + 1;
        let gain = gain(self.level, self.compared, brightness)?;
        let shaded = self.shaded(n_things, gain);
        let feet = Feet::of(self.bodies, self.largest, self.table);
        let points: Vec<Option<Point>> = places(self.bodies.size_px)
            .zip(&self.bodies.thing)
            .map(|(at, thing)| {
                let plate = brightness(&self.largest.plate.as_ref()?.get(at)?);
                Some(Point {
                    at: feet.point_above(at)?,
                    of_lights: (1.0 - shaded[(*thing)?] / plate).clamp(0.0, 1.0),
                })
            })
            .collect();
        let known = Known {
            n_things,
            gain,
            taken: self.taken(),
        };
        let points = self.topped(&points, &known);
        let agrees = self.agreeing(&points, &known);
        let raised = points.iter().zip(&self.bodies.thing).map(|(point, thing)| {
            let point = point.filter(|_| thing.is_some_and(|thing| agrees[thing]));
            point.map_or(RaisedPoint::default(), |point| {
                RaisedPoint::new(point.at.y, point.of_lights)
            })
        });
        agrees.contains(&true).then(|| raised.collect())
    }

    /// For each thing, brightness in the plate of its parts without light of the lights.
    fn shaded(&self, n_things: usize, gain: f32) -> Vec<f32> {
        let mut darker = vec![Vec::new(); n_things];
        for (at, thing) in places(self.bodies.size_px).zip(&self.bodies.thing) {
            let [frame, plate] = [Some(&self.largest.frame), self.largest.plate.as_ref()]
                .map(|picture| picture.and_then(|picture| picture.get(at)));
            if let (Some(thing), Some(frame), Some(plate)) = (thing, frame, plate) {
                darker[*thing].push((brightness(&frame) / gain).min(brightness(&plate)));
            }
        }
        let shaded = darker.into_iter().map(|mut darker| {
            darker.sort_unstable_by(f32::total_cmp);
            darker.get(part_of(darker.len(), SHADED)).copied().unwrap_or(0.0)
        });
        shaded.collect()
    }

    /// The points with those above a thing's top on it, if the toy's shadow shows that it has one: the
    /// level face of a block, say, which the camera sees above its sides.
    fn topped(&self, points: &[Option<Point>], known: &Known) -> Vec<Option<Point>> {
        let mut tops_m = vec![0.0_f64; known.n_things];
        for (point, thing) in points.iter().zip(&self.bodies.thing) {
            if let (Some(point), Some(thing)) = (point, thing) {
                tops_m[*thing] = tops_m[*thing].max(point.at.y);
            }
        }
        let tallest_m = tops_m.clone();
        let shown = self.shown(points, known);
        let mut best: Vec<f32> = self
            .gained(&shown, known)
            .iter()
            .map(|gained| OF_TOP * gained)
            .collect();
        let has_shadow: Vec<bool> = best.iter().map(|gained| *gained > 0.0).collect();
        let tried = if has_shadow.contains(&true) {
            FIRST_TOP..N_TOPS
        } else {
            0..0
        };
        for step in tried {
            let part = f64::from(step) / f64::from(N_TOPS);
            let tried_m: Vec<f64> = tallest_m.iter().map(|tallest_m| part * tallest_m).collect();
            let lowered = |one: &Shown| Shown {
                point: self.lowered(one.point, tried_m[one.thing]),
                ..*one
            };
            let gained = self.gained(&shown.iter().map(lowered).collect::<Vec<_>>(), known);
            for thing in 0..known.n_things {
                if has_shadow[thing] && gained[thing] > best[thing] {
                    (tops_m[thing], best[thing]) = (tried_m[thing], gained[thing]);
                }
            }
        }
        let lowered = |(point, thing): (&Option<Point>, &Option<usize>)| {
            Some(self.lowered((*point)?, tops_m[(*thing)?]))
        };
        points.iter().zip(&self.bodies.thing).map(lowered).collect()
    }

    /// The point of the same pixel on its thing's top, if it is above that.
    fn lowered(&self, point: Point, top_m: f64) -> Point {
        let eye = self.table.plane_from_camera.w_axis.truncate();
        // A ray to a point above the camera does not come down to a top.
        if point.at.y <= top_m || point.at.y >= eye.y {
            return point;
        }
        let times = (eye.y - top_m) / (eye.y - point.at.y);
        Point {
            at: eye + times * (point.at - eye),
            ..point
        }
    }

    /// For each thing, how much less the picture differs from its points in the toy's shadow than from
    /// none in it.
    fn gained(&self, shown: &[Shown], known: &Known) -> Vec<f32> {
        let losses = self.losses(shown, known).into_iter();
        losses.map(|([with, without], _)| without - with).collect()
    }

    /// For each thing, whether the toy's shadow in the picture is where its points have it.
    fn agreeing(&self, points: &[Option<Point>], known: &Known) -> Vec<bool> {
        let agrees = self.losses(&self.shown(points, known), known).into_iter();
        let agrees = agrees.map(|([with, without], n)| n >= LEAST_SHADOWED && with < OF_NONE * without);
        agrees.collect()
    }

    /// For each thing, the squared difference of the picture from its points in the toy's shadow, and
    /// from none in it, and the number of pixels in it.
    fn losses(&self, shown: &[Shown], known: &Known) -> Vec<([f32; 2], usize)> {
        let size_px = self.level.frame.size_px;
        let mut losses = vec![[0.0; 2]; known.n_things];
        let mut n_shadowed = vec![0; known.n_things];
        for Shown { thing, point, ratio } in shown.iter().copied() {
            let taken_from = |(light, taken): (&Light, &Vec<f32>)| {
                Some(taken[index_in(size_px, self.shadow_px(point.at, light)?)?])
            };
            let lost: Option<f32> = self.lights.iter().zip(&known.taken).map(taken_from).sum();
            let lost = lost.map(|lost| point.of_lights * lost);
            if let Some(lost) = lost.filter(|lost| lost.is_finite()) {
                let loss = |expected: f32| (ratio - expected).powi(2).min(MOST_LOSS);
                losses[thing][0] += loss(1.0 - lost);
                losses[thing][1] += loss(1.0);
                n_shadowed[thing] += usize::from(lost > SHADOWED);
            }
        }
        losses.into_iter().zip(n_shadowed).collect()
    }

    /// The pixels of the level that show points, with those.
    fn shown(&self, points: &[Option<Point>], known: &Known) -> Vec<Shown> {
        let shown = |at: IVec2| {
            let (thing, point) = self.point_at(at, points)?;
            let frame = self.level.frame.get(at)?;
            let plate = self.level.plate.as_ref()?.get(at)?;
            let ratio = brightness(&frame) / (known.gain * brightness(&plate));
            ratio.is_finite().then_some(Shown { thing, point, ratio })
        };
        places(self.level.frame.size_px).filter_map(shown).collect()
    }

    /// The point that a pixel of the level shows, and its thing.
    fn point_at(&self, at: IVec2, points: &[Option<Point>]) -> Option<(usize, Point)> {
        let there = ((at.as_dvec2() + 0.5) / self.bodies.per_px).floor().as_ivec2();
        let index = index_in(self.bodies.size_px, there)?;
        let thing = self.bodies.thing[index]?;
        let is_within = cross(there, WITHIN_PX).all(|at| self.bodies.of(at) == Some(thing));
        is_within.then_some((thing, points[index]?))
    }

    /// For each light and pixel of the level, the part of the receiver's light that the toy takes from it;
    /// not a number where nothing was compared, or if no light is lost anywhere.
    fn taken(&self) -> Vec<Vec<f32>> {
        let of = |(light, share): (usize, f32)| {
            in_level(self.level.frame.size_px, self.compared, f32::NAN, |pixel| {
                share * pixel.blocked[light]
            })
        };
        self.shares().into_iter().enumerate().map(of).collect()
    }

    /// Each light's share of what all of them give the receiver, as on a point: by the light that is
    /// lost where it alone is blocked; equal shares if such places are unknown.
    fn shares(&self) -> Vec<f32> {
        let of = |light: usize| {
            let is_alone = |pixel: &&Compared| {
                let mut others = pixel
                    .blocked
                    .iter()
                    .enumerate()
                    .filter(|(other, _)| *other != light);
                pixel.blocked[light] > UMBRA && others.all(|(_, blocked)| *blocked < OPEN)
            };
            let alone = self.compared.iter().filter(is_alone).map(Compared::taken);
            median(alone, f32::total_cmp).map(|lost| lost.max(0.0))
        };
        let lost: Option<Vec<f32>> = (0..self.lights.len()).map(of).collect();
        let lost = lost.unwrap_or_else(|| vec![1.0; self.lights.len()]);
        let all: f32 = lost.iter().sum();
        lost.into_iter().map(|lost| lost / all).collect()
    }

    /// The pixel of the level at which the receiver has the shadow of a light that falls on a point.
    fn shadow_px(&self, point: DVec3, light: &Light) -> Option<IVec2> {
        let below = shadow_of(point, light)?;
        Some(pixel_of(below, self.table, self.level)?.floor().as_ivec2())
    }
}
