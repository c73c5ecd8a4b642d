//! Things that stand in the picture beside the toy: on the table where its shadow falls, and before
//! it.
//!
//! **Seeds** are pixels that no light on a receiver explains, in places where a change should be
//! visible (`lights::compare`): frame and plate agree although a shadow should fall there, or
//! differ although none should. From them a thing **grows** over the plate, along its own colours
//! and up to the next edge (`grown`), against pixels that are known to show the receiver. A thing
//! that frame and plate both show in the toy's place is **before the toy**; a thing in the plate
//! alone makes the plate wrong; and a thing in the frame alone matters if it hides the toy or is large.

mod by_shadow;
mod cast;
mod codes;
mod colored_extent;
mod colors;
mod edges;
mod ends;
mod expected_light;
mod exposure;
mod extent;
mod feet;
mod foot_line;
mod found;
mod fronts;
pub(crate) mod groups;
mod grown;
mod inner;
mod interpolate;
mod known;
mod listed;
mod low;
mod measured;
mod memory;
mod outline;
mod own_shadow;
mod painted;
mod pattern;
pub(crate) mod planes;
mod plate_mended;
mod seeds;
mod shade;
mod shadow_loss;
mod sides;
mod sight;
mod simplex;
mod standing;
mod tops;
mod toy;
mod upright;
mod upright_shadows;
mod wrong_plate;

use std::borrow::Cow;
use std::collections::HashSet;

use glam::IVec2;

use crate::lights::Comparison;
use crate::picture::{Level, Mask, brightness, places};
use crate::receivers::receiver_at;
use app_scene::scene::MAX_RECEIVERS;
use app_scene::things::{Front, Mark, RaisedPoint};
pub(crate) use codes::least_change;
pub(crate) use found::adopt;
pub(crate) use listed::marks_of_listed;
pub(crate) use memory::Memory;
pub(crate) use plate_mended::{is_of_wrong_plate, with_mended_plate};

use codes::Codes;
use expected_light::ExpectedLight;
use exposure::{gain, gains, plate_codes};
use found::Found;
use grown::Grown;
use memory::Place;
use planes::{FoundPlane, is_clearer};
pub(crate) use seeds::Colored;
use seeds::{Seed, Seeds};
use shade::Brightness;
pub(crate) use sight::Sight;
use standing::standing;
use toy::{Toy, is_shade};
use wrong_plate::wrong_plate;

/// Maximum number of pixels of the level for the search: more take longer and find no more.
const MOST_PIXELS: i32 = 150_000;
/// Share of seeds among a thing's pixels that show a receiver, below which these belong to the
/// receiver itself.
const OF_PLANE: f32 = 0.1;

/// Border in metres around a known top and its sides up to which a thing on these may reach.
const SOLID_BORDER_M: f64 = 0.002;

/// Things beside the toy.
pub(crate) struct Sighting {
    /// Size of the largest level in pixels.
    pub(crate) size_px: IVec2,
    pub(crate) marks: Vec<Mark>,
    /// The points of things on which the toy's shadow falls; empty if there are none.
    pub(crate) raised: Vec<RaisedPoint>,
    /// Planes of things, if they are wanted.
    pub(crate) planes: Vec<FoundPlane>,
    /// As `Things::fronts`.
    pub(crate) fronts: Vec<Front>,
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
    let found = |things| sight.found((&restored, &frame), &toy, things);
    let (sighting, memory) = sight.sighted(level, &frame, found(Colored::Otherwise));
    // A thing in the place's own colours counts if the toy's shadow on it shows that it stands up.
    let may_stand = sight.lights.len() == 1 && seeds::may_be_alike(&restored.compared.pixels);
    if sighting.is_none() && may_stand {
        let (alike, memory) = sight.sighted(level, &frame, found(Colored::Alike));
        if alike.as_ref().is_some_and(|alike| !alike.raised.is_empty()) {
            return (alike, Some(memory));
        }
    }
    (sighting, Some(memory))
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

    /// A level's pixels per pixel of the largest one. A level omits an odd last row and column: it is
    /// half as large as the one above, not stretched.
    fn per_px(&self, level: &Level) -> f64 {
        level.intrinsics.fx_px / self.pyramid.level(0).intrinsics.fx_px
    }

    fn compared(&self, level: &Level) -> Option<Comparison> {
        let seen = (self.shape, self.receivers);
        crate::lights::compare(self.lights, seen, level, self.world_from_camera)
    }

    /// The marks of a level's things; `None` if nothing is marked. And the memory for the next picture.
    fn sighted(&self, level: &Level, frame: &Codes, found: Found<'_>) -> (Option<Sighting>, Memory) {
        let camera = (&level.intrinsics, self.world_from_camera);
        let place = Place::new(camera, &self.shape.points, self.lights);
        let memory = Memory::new(place, frame.clone(), found.known(frame.size_px));
        if found.is_empty() {
            return (None, memory);
        }
        let largest_px = self.pyramid.level(0).frame.size_px;
        if !found.planes.is_empty() {
            // Things are searched again with these among the receivers.
            let sighting = Sighting {
                size_px: largest_px,
                marks: vec![Mark::None; (largest_px.x * largest_px.y) as usize],
                raised: Vec::new(),
                planes: found.planes,
                fronts: Vec::new(),
            };
            return (Some(sighting), memory);
        }
        let (size_px, marks) = self.marks(level, &found);
        let marks = match self.memory {
            Some(before) => {
                let per_px = self.per_px(level);
                before.steadied(&memory, (size_px, per_px), marks)
            }
            None => marks,
        };
        let known = self
            .memory
            .and_then(|before| before.points_and_ends(&memory, size_px, &marks));
        let (raised, ends) = known.unwrap_or_else(|| {
            let bodies = self.bodies(level, &found, (size_px, &marks));
            let ends = self.ends(level, &found, (&bodies, &marks));
            (self.raised(level, &found, &bodies), ends)
        });
        let memory = memory
            .with_marks(size_px, &marks, &raised)
            .with_ends(ends.clone());
        let marks = match found.colored {
            Colored::Otherwise => marks,
            Colored::Alike => self.marks_of_standing(level, &found, (size_px, marks), &raised),
        };
        let (mut marks, memory) = self.with_pattern(marks, memory);
        ends.mark(&mut marks);
        let sighting = Sighting {
            size_px,
            fronts: ends.fronts,
            marks,
            raised,
            planes: found.planes,
        };
        (Some(sighting), memory)
    }

    /// The things of a level, in these colours.
    fn found<'b>(
        &self,
        (restored, frame): (&'b Restored<'_>, &Codes),
        toy: &Toy,
        things: Colored,
    ) -> Found<'b> {
        let Restored {
            level,
            plate,
            compared,
            in_plate,
        } = restored;
        let level = &**level;
        let seeds_of = |colored| {
            let of_toy = (toy.hidden(frame, plate), |at| toy.is_free(at, frame, plate));
            let seeds = Seeds::found(&compared.pixels, of_toy, (frame, plate), colored);
            let shade = || cast::shade(&seeds, (&compared.pixels, plate));
            let is_shade = seeds.show_things().then(shade).flatten();
            seeds.with_shade(is_shade)
        };
        let seeds = seeds_of(things);
        // The search in doubtful colours is for things without planes.
        let planes_of = self.planes_of.filter(|_| things == Colored::Otherwise);
        let grown = planes_of.and_then(|_| Grown::from(&seeds, Seed::Thing, plate));
        let wrong = Grown::from(&seeds, Seed::WrongPlate, plate);
        let needed = |grown: &Grown| self.needed(grown, level);
        let in_frame = toy.in_frame(&seeds, frame, needed);
        let planes = planes_of.map_or(Vec::new(), |colored| {
            let alike = (grown.is_none() && colored == Colored::Alike)
                .then(|| Grown::from(&seeds_of(colored), Seed::Thing, plate))
                .flatten();
            let things = match &alike {
                Some(alike) => (Some(alike), Colored::Alike),
                None => (grown.as_ref(), Colored::Otherwise),
            };
            self.planes(things, grown.as_ref(), (level, toy), compared)
        });
        let grown = match grown {
            Some(grown) if planes.is_empty() => Some(grown.whole(&seeds, Seed::Thing, plate)),
            None if planes.is_empty() => Grown::whole_from(&seeds, Seed::Thing, plate),
            grown => grown,
        };
        let grown = grown.map(
            |grown| match listed::solids(self.receivers, level, SOLID_BORDER_M) {
                Some(is_solid) => grown.within(is_solid, (&seeds, Seed::Thing)),
                None => grown,
            },
        );
        let evidence = grown.as_ref().map(|grown| (grown, self.needed(grown, level)));
        let before = evidence.as_ref().map_or(Vec::new(), |(grown, needed)| {
            toy.before(grown, (frame, plate), needed)
        });
        let alone = evidence.map_or(Vec::new(), |(grown, needed)| grown.alone(&needed));
        let grown = grown.map(|mut grown| {
            let expected = || self.upright_shadows(&grown, level);
            let shadows = cast::shadows_of(&grown, &seeds, (&compared.pixels, plate), expected);
            grown.absorb(&shadows);
            grown
        });
        let size_px = level.frame.size_px;
        let on_things = grown
            .as_ref()
            .map(|grown| Brightness::of_things(grown, &compared.pixels, (&toy.coverage, size_px)));
        let on_planes = grown
            .as_ref()
            .map_or(Vec::new(), |grown| self.on_planes((grown, &seeds), level));
        Found {
            planes,
            on_planes,
            grown,
            before,
            alone,
            wrong: wrong.map(|wrong| wrong_plate(&wrong, toy, plate, &compared.pixels)),
            in_plate: in_plate.as_ref(),
            on_things,
            in_frame,
            compared: &compared.pixels,
            colored: things,
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
        let place = |are_things_of_points| planes::Place {
            shape: &shape,
            receivers: self.receivers,
            points: &points,
            are_things_of_points,
        };
        let of = |things: Option<&Grown>, colored, are_things_of_points| {
            let place = place(are_things_of_points);
            things.map_or(Vec::new(), |things| {
                tops::find(&place, level, compared, (things, colored))
            })
        };
        let standing = standing(shown, (&points, self.receivers), level, &compared.pixels);
        let of_points = of(standing.as_ref(), Colored::Otherwise, true);
        let of_things = of(things, colored, false);
        // Points may be of a world that is a little off.
        let (planes, seen) = if standing.is_none() || is_clearer(&of_things, &of_points) {
            (of_things, things.filter(|_| colored == Colored::Otherwise))
        } else {
            (of_points, standing.as_ref())
        };
        sides::with_sides(&place(false), (level, seen), compared, planes)
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
        let plate = plate_codes(level, level, &compared.pixels)?;
        let Some(light) = Brightness::of_plate(&compared.pixels, (frame, &plate), &toy.coverage) else {
            return Some(Restored {
                level: Cow::Borrowed(level),
                plate,
                compared,
                in_plate: None,
            });
        };
        let level = light.restored(level);
        let compared = self.compared(&level).unwrap_or(compared);
        Some(Restored {
            plate: plate_codes(&level, &level, &compared.pixels)?,
            compared,
            level: Cow::Owned(level),
            in_plate: Some(light),
        })
    }

    /// For each pixel of a level, whether it is in a part of a thing with few seeds, but shows
    /// another receiver than the thing stands on: for example the top of a book that is a receiver,
    /// in contrast to its sides.
    fn on_planes(&self, (grown, seeds): (&Grown, &Seeds), level: &Level) -> Vec<bool> {
        let mut counts = vec![[[0; 2]; MAX_RECEIVERS]; grown.n_things()];
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
        // None of the receivers' pixels may show it, as those of a thing beyond the table.
        let stands_on = |thing: usize| {
            let most = (0..MAX_RECEIVERS).max_by_key(|on| counts[thing][*on][0]);
            most.filter(|on| counts[thing][*on][0] > 0)
        };
        let stands_on: Vec<Option<usize>> = (0..grown.n_things()).map(stands_on).collect();
        let is_of_receiver = |(thing, on): (usize, usize)| {
            let [n_seeds, n] = counts[thing][on];
            stands_on[thing].is_some_and(|stood| stood != on) && (n_seeds as f32) < OF_PLANE * n as f32
        };
        pixels
            .into_iter()
            .map(|pixel| pixel.is_some_and(is_of_receiver))
            .collect()
    }

    /// The marks without those of things of which none of the points is raised.
    fn marks_of_standing(
        &self,
        level: &Level,
        found: &Found<'_>,
        (size_px, mut marks): (IVec2, Vec<Mark>),
        raised: &[RaisedPoint],
    ) -> Vec<Mark> {
        let per_px = self.per_px(level);
        let thing_at = |at: IVec2| found.thing_at((at.as_dvec2() + 0.5) * per_px);
        let of_points = places(size_px)
            .zip(raised)
            .filter(|(_, point)| point.height() > 0);
        let standing: HashSet<usize> = of_points.filter_map(|(at, _)| thing_at(at)).collect();
        for (at, mark) in places(size_px).zip(&mut marks) {
            if thing_at(at).is_some_and(|thing| !standing.contains(&thing)) {
                *mark = Mark::None;
            }
        }
        marks
    }

    /// Marks in the largest level.
    fn marks(&self, level: &Level, found: &Found<'_>) -> (IVec2, Vec<Mark>) {
        let largest = self.pyramid.level(0);
        let size_px = largest.frame.size_px;
        let per_px = self.per_px(level);
        let toy = Toy::of(self, largest);
        let plate = plate_codes(largest, level, found.compared);
        let codes = plate.map(|plate| [Codes::of(&largest.frame), plate]);
        let is_own = |at: IVec2, frame: &Codes| {
            let color = frame.get(at);
            color.is_some_and(|color| found.is_own_color_in_frame(color))
        };
        let light = found.in_frame.as_ref().and_then(|_| {
            let gain = gain(level, found.compared, brightness)?;
            Some(ExpectedLight::new(
                largest,
                (level, per_px),
                (found.compared, gain),
            ))
        });
        let is_lit = |at: IVec2| light.as_ref().is_some_and(|light| light.is_about_at(at));
        let mark = |at: IVec2| {
            let there = (at.as_dvec2() + 0.5) * per_px;
            let Some([frame, plate]) = &codes else {
                return Mark::None;
            };
            match found.at(there) {
                Mark::BeforeToy if toy.shows(at, frame, plate) => Mark::None,
                // It would hide the toy; behind that, its extent is a guess.
                Mark::BeforeToy | Mark::HiddenThing { .. }
                    if found.is_before_at(there) && toy.is_bare(at, [frame, plate]) =>
                {
                    Mark::None
                }
                Mark::None => match found.in_frame_at(there) {
                    Mark::BeforeToy if toy.is_shown(at, frame) && !is_own(at, frame) => Mark::None,
                    Mark::BeforeToy if !is_shade(at, frame, plate) => Mark::BeforeToy,
                    Mark::Thing if toy.coverage.at(at) > 0.0 || is_shade(at, frame, plate) => Mark::None,
                    // The table beside a hand is not all in its shadow.
                    Mark::BeforeToy if is_lit(at) => Mark::None,
                    Mark::BeforeToy | Mark::Thing => Mark::Thing,
                    mark => mark,
                },
                mark => mark,
            }
        };
        let mut marks: Vec<Mark> = places(size_px).map(mark).collect();
        if let Some([frame, plate]) = &codes {
            marks = outline::sharpened((found, &toy), [frame, plate], per_px, &marks);
        }
        self.keep_own_shadow(level, found, &mut marks);
        self.paint_behind_toy(level, found, &toy, &mut marks);
        (size_px, marks)
    }

    /// Marks in the largest level the parts behind the toy of things that the frame alone shows.
    fn paint_behind_toy(&self, level: &Level, found: &Found<'_>, toy: &Toy, marks: &mut [Mark]) {
        let largest = self.pyramid.level(0);
        let Some(plate) = largest.plate.as_ref().filter(|_| found.in_frame.is_some()) else {
            return;
        };
        let per_px = self.per_px(level);
        let mut things = Mask::new(largest.frame.size_px);
        for (at, mark) in places(largest.frame.size_px).zip(marks.iter()) {
            let is_thing = matches!(mark, Mark::Thing | Mark::BeforeToy);
            if is_thing && found.in_frame_at((at.as_dvec2() + 0.5) * per_px) != Mark::None {
                things.mark(at);
            }
        }
        if things.is_empty() {
            return;
        }
        let seen = painted::Seen {
            things: &things,
            coverage: &toy.coverage,
            frame: &largest.frame,
            plate,
            gain: gains(level, found.compared).unwrap_or([1.0; 3]),
        };
        seen.paint(marks);
    }
}
