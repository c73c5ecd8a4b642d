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
pub(crate) mod groups;
mod grown;
mod inner;
mod measured;
pub(crate) mod planes;
mod seeds;
mod shade;
mod sides;
mod simplex;
mod standing;
mod wrong_plate;

use std::borrow::Cow;

use glam::{DMat4, DVec2, IVec2};

use crate::lights::Comparison;
use crate::measured_points::MeasuredPoints;
use crate::picture::{Color, Level, Mask, Pyramid, index_in, places};
use crate::pose::Paint;
use crate::raster::{Coverage, Rasterizer, project};
use crate::receivers::{SeenReceiver, receiver_at};
use crate::shape::Shape;
use app_scene::geometry::color::srgb_from_linear;
use app_scene::scene::{Light, MAX_RECEIVERS};
use app_scene::things::Mark;
use codes::{Codes, UNLIKE_CODES, apart, from_shaded};
use groups::{cross, most_around};
use grown::Grown;
use planes::{FoundPlane, clearer};
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
/// Minimum number of seeds of a thing that is not before the toy: fewer may come from the camera's
/// own processing.
const LEAST_ALONE: usize = 60;
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
    /// Points by each source that measured some.
    pub(crate) points: &'a [MeasuredPoints],
    /// Whether planes of things are searched for.
    pub(crate) wants_planes: bool,
}

/// Things beside the toy.
pub(crate) struct Sighting {
    /// Size of the largest level in pixels.
    pub(crate) size_px: IVec2,
    pub(crate) marks: Vec<Mark>,
    /// Planes of things, if they are wanted.
    pub(crate) planes: Vec<FoundPlane>,
}

/// Finds the things; `None` if there are none beside the toy, or none can be detected.
pub(crate) fn find(sight: &Sight<'_>) -> Option<Sighting> {
    let level = sight.level();
    let toy = Toy::of(sight, level);
    let frame = Codes::of(&level.frame);
    let Restored {
        level,
        plate,
        compared,
        in_plate,
    } = sight.restored((level, &frame), &toy)?;
    let level = &*level;
    let seeds = Seeds::found(&compared.pixels, toy.hidden(&frame, &plate), (&frame, &plate));
    let measured: Vec<_> = sight
        .points
        .iter()
        .map(|measured| toy.beside(measured, level))
        .collect();
    let grown = Grown::from(&seeds, Seed::Thing, &plate);
    let standing = standing(
        grown.as_ref(),
        (&measured, sight.receivers),
        level,
        &compared.pixels,
    );
    let wrong = Grown::from(&seeds, Seed::WrongPlate, &plate);
    let in_frame = toy.in_frame(&seeds, &frame);
    let is_any = [&grown, &wrong, &standing].into_iter().any(Option::is_some);
    if !is_any && in_frame.is_none() && in_plate.is_none() {
        return None;
    }
    let before = grown
        .as_ref()
        .map_or(Vec::new(), |grown| toy.before(grown, (&frame, &plate)));
    let of = |grown: &Option<Grown>, are_things_of_points: bool| {
        let place = planes::Place {
            shape: sight.shape,
            receivers: sight.receivers,
            points: &measured,
            are_things_of_points,
        };
        let grown = grown.as_ref().filter(|_| sight.wants_planes);
        grown.map_or(Vec::new(), |grown| planes::find(&place, level, &compared, grown))
    };
    // Points may be of a world that is a little off.
    let planes = clearer([of(&standing, true), of(&grown, false)]);
    let grown = grown.map(|mut grown| {
        let shadows = cast::shadows_of(&grown, &seeds, &compared.pixels, &plate);
        grown.absorb(&shadows);
        grown
    });
    let of_level = (&toy.coverage, level.frame.size_px);
    let on_things = grown
        .as_ref()
        .map(|grown| Brightness::of_things(grown, &compared.pixels, of_level));
    let wrong = wrong.map(|wrong| wrong_plate(&wrong, &toy, level.frame.size_px, &compared.pixels));
    let on_planes = grown.as_ref().map_or(Vec::new(), |grown| {
        sight.on_planes((grown, &seeds), level, &before)
    });
    let found = Found {
        on_planes,
        grown,
        before,
        wrong,
        in_plate,
        on_things,
        in_frame,
    };
    let (size_px, marks) = sight.marks(level, &found);
    Some(Sighting {
        size_px,
        marks,
        planes,
    })
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

/// Things in a level.
struct Found {
    /// Things that plate and frame show, and for each whether it is before the toy.
    grown: Option<Grown>,
    before: Vec<bool>,
    /// For each pixel, whether it is in a thing, but shows a receiver that is not part of it.
    on_planes: Vec<bool>,
    /// The wrong part of the plate.
    wrong: Option<Mask>,
    /// The light in the plate, if a shadow lies on it that the frame does not show.
    in_plate: Option<Brightness>,
    /// The light on the parts of things that the toy hides.
    on_things: Option<Brightness>,
    /// Things that the frame alone shows, such as a hand.
    in_frame: Option<InFrame>,
}

impl Found {
    /// The mark at a place in pixels of the level, for things in the plate.
    fn at(&self, place: DVec2) -> Mark {
        let thing = self
            .grown
            .as_ref()
            .and_then(|grown| Some((grown, grown.at(place)?)));
        let is_on_plane = thing.is_some_and(|(grown, _)| {
            grown
                .index(place)
                .is_some_and(|index| self.on_planes.get(index).is_some_and(|is_on| *is_on))
        });
        match thing {
            Some(_) if is_on_plane => self.in_plate_at(place),
            Some((grown, thing)) if self.before[thing] && !grown.is_like_place(place) => Mark::BeforeToy,
            Some((grown, thing)) if self.before[thing] || grown.n_seeds(thing) >= LEAST_ALONE => {
                self.behind_toy_at(place).unwrap_or(Mark::Thing)
            }
            _ => self.in_plate_at(place),
        }
    }

    /// The same for a part of a thing that the toy hides; `None` if it does not, or if the light
    /// there is unknown.
    fn behind_toy_at(&self, place: DVec2) -> Option<Mark> {
        self.on_things.as_ref()?.at(place).map(Mark::hidden_thing)
    }

    /// The same for what the plate alone shows.
    fn in_plate_at(&self, place: DVec2) -> Mark {
        let wrong = self.wrong.as_ref();
        if wrong.is_some_and(|wrong| wrong.has(place.floor().as_ivec2())) {
            return Mark::WrongPlate;
        }
        let left = self.in_plate.as_ref().and_then(|light| light.missing_at(place));
        left.map_or(Mark::None, Mark::shaded_plate)
    }

    /// The same for things in the frame alone.
    fn in_frame_at(&self, place: DVec2) -> Mark {
        let in_frame = self.in_frame.as_ref();
        let thing = in_frame.and_then(|in_frame| Some(in_frame.marks[in_frame.grown.at(place)?]));
        thing.unwrap_or_default()
    }
}

/// Things that the frame alone shows.
struct InFrame {
    grown: Grown,
    /// The mark of each thing: before the toy, beside it, or no mark.
    marks: Vec<Mark>,
}

impl Sight<'_> {
    fn level(&self) -> &Level {
        self.pyramid.largest_within(MOST_PIXELS)
    }

    fn compared(&self, level: &Level) -> Option<Comparison> {
        let seen = (self.shape, self.receivers);
        crate::lights::compare(self.lights, seen, level, self.world_from_camera)
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
    fn on_planes(&self, (grown, seeds): (&Grown, &Seeds), level: &Level, before: &[bool]) -> Vec<bool> {
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
    /// the toy does not look as expected, and beside it if they are large. `None` if there are
    /// neither. `seeds` are those of the plate.
    fn in_frame(&self, seeds: &Seeds, frame: &Codes) -> Option<InFrame> {
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
        let mark = |thing: usize| match (hidden[thing], grown.n_seeds(thing)) {
            (LEAST_IN_FRAME.., LEAST_BESIDE..) => Mark::BeforeToy,
            (_, LEAST_IN_FRAME_ALONE..) => Mark::Thing,
            _ => Mark::None,
        };
        let marks: Vec<Mark> = (0..grown.n_things()).map(mark).collect();
        let has_any = marks.iter().any(|mark| *mark != Mark::None);
        has_any.then_some(InFrame { grown, marks })
    }

    /// For each thing of a level, whether it is before the toy.
    fn before(&self, grown: &Grown, (frame, plate): (&Codes, &Codes)) -> Vec<bool> {
        let mut hidden = vec![0; grown.n_things()];
        let mut n_within = vec![0; grown.n_things()];
        for at in self.coverage.pixels().filter(|at| self.is_within(*at)) {
            if let Some(thing) = grown.of_pixel(at) {
                n_within[thing] += 1;
                hidden[thing] += usize::from(self.is_hidden(at, frame, plate));
            }
        }
        let is_before = |thing: usize| {
            hidden[thing] >= LEAST_BEFORE
                && hidden[thing] as f32 >= PART_BEFORE * n_within[thing] as f32
                && grown.n_seeds(thing) >= LEAST_BESIDE
        };
        (0..grown.n_things()).map(is_before).collect()
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

/// Whether most pixels around one agree with the plate in less light, as in a thing's shadow.
fn is_shade(at: IVec2, frame: &Codes, plate: &Codes) -> bool {
    most_around(at, |at| {
        let colors = frame.get(at).zip(plate.get(at));
        colors.is_some_and(|(frame, plate)| from_shaded(frame, plate) < 0.5 * UNLIKE_CODES)
    })
}
