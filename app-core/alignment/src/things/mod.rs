//! Things that stand in the picture beside the toy: on the table where its shadow falls, and before
//! it.
//!
//! **Seeds** are pixels that no light on a receiver explains, in places where a change should be
//! visible (`lights::compare`): frame and plate agree although a shadow should fall there, or
//! differ although none should. From them a thing **grows** over the plate, along its own colours
//! and up to the next edge (`grown`), against pixels that are known to show the receiver. A thing
//! that frame and plate both show in the toy's place is **before the toy**; a thing in the plate
//! alone makes the plate wrong; and a thing in the frame alone matters if it hides the toy.

mod cast;
mod codes;
mod colors;
mod edges;
mod extent;
mod found;
pub(crate) mod groups;
mod grown;
mod inner;
mod known;
mod listed;
mod measured;
mod memory;
pub(crate) mod planes;
mod seeds;
mod shade;
mod sides;
mod simplex;
mod standing;
mod wrong_plate;

use std::borrow::Cow;

use glam::{DMat4, IVec2};

use crate::lights::Comparison;
use crate::measured_points::MeasuredPoints;
use crate::picture::{Color, Level, Pyramid, index_in, places};
use crate::pose::Paint;
use crate::raster::{Coverage, Rasterizer, project};
use crate::receivers::{SeenReceiver, receiver_at};
use crate::shape::Shape;
use app_scene::geometry::color::srgb_from_linear;
use app_scene::scene::{Light, MAX_RECEIVERS};
use app_scene::things::Mark;
pub(crate) use codes::least_change;
pub(crate) use found::adopt;
pub(crate) use memory::Memory;

use codes::{Codes, UNLIKE_CODES, apart, from_shaded};
use found::{Found, InFrame};
use groups::{cross, most_around};
use grown::Grown;
use known::Known;
use memory::Place;
use planes::{FoundPlane, clearer};
pub(crate) use seeds::Colored;
use seeds::{Seed, Seeds};
use shade::Brightness;
use standing::standing;
use wrong_plate::wrong_plate;

/// Maximum number of pixels of the level for the search: more take longer and find no more.
const MOST_PIXELS: i32 = 150_000;
/// Distance in pixels of a level from the toy's outline within which something before it is
/// detected.
const WITHIN_PX: i32 = 2;
/// Least distance in pixels of a level between the toy and a depth sensor's points of other things.
const BESIDE_PX: i32 = 4;
/// Largest difference in codes at which frame and plate count as equal.
const ALIKE_CODES: f32 = 5.0;
/// Minimum number of pixels of the level that show a thing before the toy: in the toy's place, and
/// beside the toy.
const LEAST_BEFORE: usize = 5;
const LEAST_BESIDE: usize = 20;
/// The same for a thing that the frame alone shows.
const LEAST_IN_FRAME: usize = 12;
/// Minimum number of seeds of a thing in the frame alone that is not before the toy: shadows and
/// highlights that the model does not have look like small things.
const LEAST_IN_FRAME_ALONE: usize = 400;
/// Share of its possible pixels before the toy that must show it.
const PART_BEFORE: f32 = 0.04;
/// Share of seeds among a thing's pixels that show a receiver, below which these belong to the
/// receiver itself.
const OF_PLANE: f32 = 0.1;

/// Inputs of the search for things.
pub(crate) struct Sight<'a> {
    pub(crate) shape: &'a Shape,
    pub(crate) paint: &'a Paint,
    pub(crate) receivers: &'a [SeenReceiver],
    pub(crate) pyramid: &'a Pyramid,
    pub(crate) lights: &'a [Light],
    pub(crate) world_from_camera: &'a DMat4,
    /// Points by each source that measured some; of use to planes alone.
    pub(crate) points: &'a [MeasuredPoints],
    /// Things whose planes are searched for, if any are.
    pub(crate) planes_of: Option<Colored>,
    /// Memory of the search in the previous picture; `None` for a picture by itself.
    pub(crate) memory: Option<&'a Memory>,
}

/// Things beside the toy.
pub(crate) struct Sighting {
    /// Size of the largest level in pixels.
    pub(crate) size_px: IVec2,
    pub(crate) marks: Vec<Mark>,
    /// Planes of things, if they are wanted.
    pub(crate) planes: Vec<FoundPlane>,
}

/// Finds the things: `None` if there are none beside the toy, or none can be detected; and the
/// memory for the next picture, `None` if none can be detected.
pub(crate) fn find(sight: &Sight<'_>) -> (Option<Sighting>, Option<Memory>) {
    let level = sight.level();
    let toy = Toy::of(sight, level);
    let frame = Codes::of(&level.frame);
    let Some(restored) = sight.restored((level, &frame), &toy) else {
        return (None, None);
    };
    let found = sight.found((restored, &frame), &toy);
    let known = found.known(frame.size_px);
    let place = Place {
        intrinsics: level.intrinsics,
        world_from_camera: *sight.world_from_camera,
        middle: sight.shape.centre,
        lights: sight.lights.to_vec(),
    };
    let memory = Memory::new(place, frame, known);
    if found.is_empty() {
        return (None, Some(memory));
    }
    let (size_px, marks) = sight.marks(level, &found);
    let marks = match sight.memory {
        Some(before) => {
            let per_px = level.intrinsics.fx_px / sight.pyramid.level(0).intrinsics.fx_px;
            before.steadied(&memory, (size_px, per_px), marks)
        }
        None => marks,
    };
    let memory = memory.with_marks(size_px, &marks);
    let sighting = Sighting {
        size_px,
        marks,
        planes: found.planes,
    };
    (Some(sighting), Some(memory))
}

/// A level whose plate has all of its light.
struct Restored<'a> {
    level: Cow<'a, Level>,
    /// Its plate.
    plate: Codes,
    /// Comparison of its pixels.
    compared: Comparison,
    /// The light in the plate as it was taken, if a shadow lay on it.
    in_plate: Option<Brightness>,
}

impl Sight<'_> {
    fn level(&self) -> &Level {
        self.pyramid.largest_within(MOST_PIXELS)
    }

    fn compared(&self, level: &Level) -> Option<Comparison> {
        let seen = (self.shape, self.receivers);
        crate::lights::compare(self.lights, seen, level, self.world_from_camera)
    }

    /// The things of a level.
    fn found(&self, (restored, frame): (Restored<'_>, &Codes), toy: &Toy) -> Found {
        let Restored {
            level,
            plate,
            compared,
            in_plate,
        } = restored;
        let level = &*level;
        let seeds_of = |colored| {
            let hidden = toy.hidden(frame, &plate);
            Seeds::found(&compared.pixels, hidden, (frame, &plate), colored)
        };
        let seeds = seeds_of(Colored::Otherwise);
        let grown = Grown::from(&seeds, Seed::Thing, &plate);
        let wrong = Grown::from(&seeds, Seed::WrongPlate, &plate);
        let needed = |grown: &Grown| self.needed(grown, level);
        let in_frame = toy.in_frame(&seeds, frame, needed);
        let evidence = grown.as_ref().map(|grown| (grown, self.needed(grown, level)));
        let before = evidence.as_ref().map_or(Vec::new(), |(grown, needed)| {
            toy.before(grown, (frame, &plate), needed)
        });
        let alone = evidence.map_or(Vec::new(), |(grown, needed)| grown.alone(&needed));
        let planes = self.planes_of.map_or(Vec::new(), |colored| {
            let alike = (grown.is_none() && colored == Colored::Alike)
                .then(|| Grown::from(&seeds_of(colored), Seed::Thing, &plate))
                .flatten();
            let things = match &alike {
                Some(alike) => (Some(alike), Colored::Alike),
                None => (grown.as_ref(), Colored::Otherwise),
            };
            self.planes(things, grown.as_ref(), (level, toy), &compared)
        });
        let grown = grown.map(|mut grown| {
            let shadows = cast::shadows_of(&grown, &seeds, &compared.pixels, &plate);
            grown.absorb(&shadows);
            grown
        });
        let size_px = level.frame.size_px;
        let on_things = grown
            .as_ref()
            .map(|grown| Brightness::of_things(grown, &compared.pixels, (&toy.coverage, size_px)));
        let on_planes = grown.as_ref().map_or(Vec::new(), |grown| {
            self.on_planes((grown, &seeds), level, &before)
        });
        Found {
            planes,
            on_planes,
            grown,
            before,
            alone,
            wrong: wrong.map(|wrong| wrong_plate(&wrong, toy, size_px, &compared.pixels)),
            in_plate,
            on_things,
            in_frame,
        }
    }

    /// Planes by measured points, or those of `things` if they end at clearer edges or there are no
    /// others. `shown` are the things that the pictures show.
    fn planes(
        &self,
        (things, colored): (Option<&Grown>, Colored),
        shown: Option<&Grown>,
        (level, toy): (&Level, &Toy),
        compared: &Comparison,
    ) -> Vec<FoundPlane> {
        let points: Vec<_> = self
            .points
            .iter()
            .map(|points| toy.beside(points, level))
            .collect();
        let shape = self.shape.merged_in_px(planes::CELL_PX, level);
        let of = |things: Option<&Grown>, colored, are_things_of_points| {
            let place = planes::Place {
                shape: &shape,
                receivers: self.receivers,
                points: &points,
                are_things_of_points,
            };
            sides::with_sides(&place, (level, things, colored), compared)
        };
        let standing = standing(shown, (&points, self.receivers), level, &compared.pixels);
        let of_points = standing.map_or(Vec::new(), |things| of(Some(&things), Colored::Otherwise, true));
        // Points may be of a world that is a little off.
        clearer([of_points, of(things, colored, false)])
    }

    /// The evidence that each thing needs, over that of a picture by itself.
    fn needed(&self, grown: &Grown, level: &Level) -> Vec<f32> {
        match self.memory {
            Some(memory) => {
                let camera = (&level.intrinsics, self.world_from_camera);
                memory.needed(grown, self.receivers, camera)
            }
            None => vec![1.0; grown.n_things()],
        }
    }

    /// The level without the shadow that the plate alone may show; `None` without a plate.
    fn restored<'b>(&self, (level, frame): (&'b Level, &Codes), toy: &Toy) -> Option<Restored<'b>> {
        let compared = self.compared(level)?;
        let plate = Codes::of(level.plate.as_ref()?);
        let Some(light) = Brightness::of_plate(&compared.pixels, (frame, &plate), &toy.coverage) else {
            return Some(Restored {
                level: Cow::Borrowed(level),
                plate,
                compared,
                in_plate: None,
            });
        };
        let level = light.restored(level);
        Some(Restored {
            plate: Codes::of(level.plate.as_ref()?),
            compared: self.compared(&level).unwrap_or(compared),
            level: Cow::Owned(level),
            in_plate: Some(light),
        })
    }

    /// For each pixel of a level, whether it is in a part of a thing with few seeds, but shows
    /// another receiver than the thing stands on: for example the top of a book that is a receiver,
    /// in contrast to its sides.
    fn on_planes(&self, (grown, seeds): (&Grown, &Seeds), level: &Level, before: &[Known]) -> Vec<bool> {
        let mut counts = vec![[[0; 2]; MAX_RECEIVERS]; before.len()];
        let pixels: Vec<Option<(usize, usize)>> = places(level.frame.size_px)
            .map(|at| {
                let thing = grown.of_pixel(at)?;
                let (on, _) = receiver_at(self.receivers, &level.intrinsics, at)?;
                let [n_seeds, n] = &mut counts[thing][on];
                *n += 1;
                *n_seeds += usize::from(seeds.get(at) == Seed::Thing);
                Some((thing, on))
            })
            .collect();
        let stands_on = |thing: usize| (0..MAX_RECEIVERS).max_by_key(|on| counts[thing][*on][0]);
        let stands_on: Vec<Option<usize>> = (0..before.len()).map(stands_on).collect();
        let is_of_receiver = |(thing, on): (usize, usize)| {
            let [n_seeds, n] = counts[thing][on];
            stands_on[thing] != Some(on) && (n_seeds as f32) < OF_PLANE * n as f32
        };
        pixels
            .into_iter()
            .map(|pixel| pixel.is_some_and(is_of_receiver))
            .collect()
    }

    /// Marks in the largest level.
    fn marks(&self, level: &Level, found: &Found) -> (IVec2, Vec<Mark>) {
        let largest = self.pyramid.level(0);
        let size_px = largest.frame.size_px;
        // A level omits an odd last row and column: it is half as large as the one above, not
        // stretched.
        let per_px = level.intrinsics.fx_px / largest.intrinsics.fx_px;
        let toy = Toy::of(self, largest);
        let codes = largest
            .plate
            .as_ref()
            .map(|plate| [Codes::of(&largest.frame), Codes::of(plate)]);
        let mark = |at: IVec2| {
            let there = (at.as_dvec2() + 0.5) * per_px;
            let Some([frame, plate]) = &codes else {
                return Mark::None;
            };
            match found.at(there) {
                Mark::BeforeToy if toy.shows(at, frame, plate) => Mark::None,
                Mark::None => match found.in_frame_at(there) {
                    Mark::BeforeToy if toy.is_shown(at, frame) => Mark::None,
                    Mark::BeforeToy if !is_shade(at, frame, plate) => Mark::BeforeToy,
                    Mark::Thing if toy.coverage.at(at) > 0.0 || is_shade(at, frame, plate) => Mark::None,
                    Mark::BeforeToy | Mark::Thing => Mark::Thing,
                    mark => mark,
                },
                mark => mark,
            }
        };
        (size_px, places(size_px).map(mark).collect())
    }
}

/// The toy in a level.
struct Toy {
    coverage: Coverage,
    /// Expected colours in codes; `None` if they are not known.
    shown: Option<Vec<Option<Color>>>,
}

impl Toy {
    fn of(sight: &Sight<'_>, level: &Level) -> Self {
        let corners = project(sight.shape.points.iter().copied(), &level.intrinsics);
        let coverage = Rasterizer::default().coverage(&corners, &sight.shape.faces, level.frame.size_px);
        let shown = sight.paint.shown(level, &coverage);
        let codes = |color: Color| color.map(|linear| 255.0 * srgb_from_linear(linear.clamp(0.0, 1.0)));
        let shown = shown.map(|shown| shown.into_iter().map(|color| color.map(codes)).collect());
        Self { coverage, shown }
    }

    /// The points that are seen beside the toy.
    fn beside(&self, measured: &MeasuredPoints, level: &Level) -> MeasuredPoints {
        measured.filtered(|point| {
            let at = level.intrinsics.pixel_of(*point);
            at.is_some_and(|at| !self.coverage.is_near(at.floor().as_ivec2(), BESIDE_PX))
        })
    }

    fn expected(&self, at: IVec2) -> Option<Color> {
        let shown = self.shown.as_ref()?;
        shown[index_in(self.coverage.size_px, at - self.coverage.origin_px)?]
    }

    fn is_within(&self, at: IVec2) -> bool {
        cross(at, WITHIN_PX).all(|at| self.coverage.at(at) >= 1.0)
    }

    /// Whether a pixel in the toy's place shows the plate, although the toy should look different.
    fn is_hidden(&self, at: IVec2, frame: &Codes, plate: &Codes) -> bool {
        let [Some(frame), Some(plate)] = [frame.get(at), plate.get(at)] else {
            return false;
        };
        let is_unlike = self
            .expected(at)
            .is_none_or(|expected| apart(expected, plate) > UNLIKE_CODES);
        apart(frame, plate) < ALIKE_CODES && is_unlike
    }

    /// Pixels at which a level shows the plate in place of the toy.
    fn hidden<'a>(&'a self, frame: &'a Codes, plate: &'a Codes) -> impl Iterator<Item = IVec2> + 'a {
        let covered = self.coverage.pixels().filter(|at| self.coverage.at(*at) >= 1.0);
        covered.filter(|at| self.is_hidden(*at, frame, plate))
    }

    /// Whether a pixel of the toy has its expected colour.
    fn is_as_expected(&self, at: IVec2, frame: &Codes) -> bool {
        let colors = frame.get(at).zip(self.expected(at));
        colors.is_some_and(|(frame, expected)| from_shaded(frame, expected) < UNLIKE_CODES)
    }

    /// Whether most pixels around one of the toy have their expected colours.
    fn is_shown(&self, at: IVec2, frame: &Codes) -> bool {
        self.coverage.at(at) > 0.0 && most_around(at, |at| self.is_as_expected(at, frame))
    }

    /// Things in a level's frame alone. They are before the toy if they are visible beside it and
    /// the toy does not look as expected, and beside it if they are large. `None` without any
    /// seeds. `seeds` are those of the plate.
    /// `needed` gives the evidence that each thing needs.
    fn in_frame(&self, seeds: &Seeds, frame: &Codes, needed: impl Fn(&Grown) -> Vec<f32>) -> Option<InFrame> {
        let within: Vec<IVec2> = self.coverage.pixels().filter(|at| self.is_within(*at)).collect();
        let as_expected = within
            .iter()
            .copied()
            .filter(|at| self.is_as_expected(*at, frame));
        let of_toy = as_expected.filter_map(|at| index_in(seeds.size_px, at));
        let seeds = seeds.in_frame(frame, of_toy);
        let grown = Grown::from(&seeds, Seed::InFrame, frame)?;
        let mut hidden = vec![0; grown.n_things()];
        for at in within.into_iter().filter(|at| !self.is_as_expected(*at, frame)) {
            if let Some(thing) = grown.of_pixel(at) {
                hidden[thing] += 1;
            }
        }
        let needed = needed(&grown);
        let judged = |thing: usize| {
            let n_seeds = grown.n_seeds(thing);
            let before = Known::of(needed[thing], |part| {
                has(hidden[thing], LEAST_IN_FRAME, part) && has(n_seeds, LEAST_BESIDE, part)
            });
            let alone = Known::of(needed[thing], |part| has(n_seeds, LEAST_IN_FRAME_ALONE, part));
            let mark = match (before, alone) {
                (Known::Marked, _) => Mark::BeforeToy,
                (_, Known::Marked) => Mark::Thing,
                _ => Mark::None,
            };
            (mark, before.max(alone))
        };
        let (marks, known): (Vec<Mark>, Vec<Known>) = (0..grown.n_things()).map(judged).unzip();
        Some(InFrame { grown, marks, known })
    }

    /// For each thing of a level, whether it is before the toy.
    /// `needed` is the evidence that each needs.
    fn before(&self, grown: &Grown, (frame, plate): (&Codes, &Codes), needed: &[f32]) -> Vec<Known> {
        let mut hidden = vec![0; grown.n_things()];
        let mut n_within = vec![0; grown.n_things()];
        for at in self.coverage.pixels().filter(|at| self.is_within(*at)) {
            if let Some(thing) = grown.of_pixel(at) {
                n_within[thing] += 1;
                hidden[thing] += usize::from(self.is_hidden(at, frame, plate));
            }
        }
        let known = |thing: usize| {
            let is_of_toy = hidden[thing] as f32 >= PART_BEFORE * n_within[thing] as f32;
            Known::of(needed[thing], |part| {
                is_of_toy
                    && has(hidden[thing], LEAST_BEFORE, part)
                    && has(grown.n_seeds(thing), LEAST_BESIDE, part)
            })
        };
        (0..grown.n_things()).map(known).collect()
    }

    /// Whether a pixel shows the toy, and not a thing in the toy's shadow: the picture around it is
    /// nearer to the toy's expected colours than to the plate in any light.
    fn shows(&self, at: IVec2, frame: &Codes, plate: &Codes) -> bool {
        let is_toy = |at: IVec2| match (frame.get(at), plate.get(at), self.expected(at)) {
            (Some(frame), Some(plate), Some(toy)) => apart(frame, toy) < from_shaded(frame, plate),
            _ => false,
        };
        self.coverage.at(at) > 0.0 && most_around(at, is_toy)
    }
}

/// Whether a number of pixels is a part of the least one, or more.
fn has(n: usize, least: usize, part: f32) -> bool {
    n as f32 >= part * least as f32
}

/// Whether most pixels around one agree with the plate in less light, as in a thing's shadow.
fn is_shade(at: IVec2, frame: &Codes, plate: &Codes) -> bool {
    most_around(at, |at| {
        let colors = frame.get(at).zip(plate.get(at));
        colors.is_some_and(|(frame, plate)| from_shaded(frame, plate) < 0.5 * UNLIKE_CODES)
    })
}
