//! The toy in a picture: where it should be seen, and what hides it.

use glam::IVec2;

use super::codes::{Codes, UNLIKE_CODES, apart, codes_of, from_shaded};
use super::found::InFrame;
use super::groups::{cross, most_around};
use super::grown::Grown;
use super::known::Known;
use super::seeds::{Seed, Seeds};
use super::sight::Sight;
use crate::measured_points::MeasuredPoints;
use crate::picture::{Color, Level, index_in, square};
use crate::raster::{Coverage, Rasterizer, project};
use app_scene::things::Mark;

/// Distance in pixels of a level from the toy's outline within which something before it is
/// detected.
const WITHIN_PX: i32 = 2;
/// Distance in pixels of a level from a thing's rim within which pixels of the toy may mix both.
const RIM_PX: i32 = 1;
/// Least distance in pixels of a level between the toy and a depth sensor's points of other things.
const BESIDE_PX: i32 = 4;
/// Largest difference in codes at which frame and plate count as equal.
const ALIKE_CODES: f32 = 5.0;
/// Minimum number of pixels of the level that show a thing before the toy: in the toy's place, and
/// beside the toy.
const LEAST_BEFORE: usize = 5;
const LEAST_BESIDE: usize = 20;
/// The same for a thing that the frame alone shows. A pixel that is so many times as unlike the toy as another
/// colour is counts twice: fingers before thin legs cover few of their pixels.
const LEAST_IN_FRAME: usize = 12;
const FAR_UNLIKE: f32 = 2.0;
/// Minimum number of seeds of a thing in the frame alone that is not before the toy: shadows and
/// highlights that the model does not have look like small things.
const LEAST_IN_FRAME_ALONE: usize = 400;
/// Part of the plate's codes below which a pixel is darker than a shadow leaves it: linear light of .1
/// to .2.
const LEAST_LIT: f32 = 0.4;
/// Share of its possible pixels before the toy that must show it.
const PART_BEFORE: f32 = 0.04;

/// The toy in a level.
pub(super) struct Toy {
    pub(super) coverage: Coverage,
    /// Expected colours in codes; `None` if they are not known.
    shown: Option<Vec<Option<Color>>>,
}

/// The pixels of a level that the toy covers.
pub(super) fn covered(sight: &Sight<'_>, level: &Level) -> Coverage {
    let corners = project(sight.shape.points.iter().copied(), &level.intrinsics);
    Rasterizer::default().coverage(&corners, &sight.shape.faces, level.frame.size_px)
}

impl Toy {
    pub(super) fn of(sight: &Sight<'_>, level: &Level) -> Self {
        let coverage = covered(sight, level);
        let shown = sight.paint.shown(level, &coverage);
        let codes = |color: Color| codes_of(color.map(|linear| linear.clamp(0.0, 1.0)));
        let shown = shown.map(|shown| shown.into_iter().map(|color| color.map(codes)).collect());
        Self { coverage, shown }
    }

    /// The points that are seen beside the toy.
    pub(super) fn beside(&self, measured: &MeasuredPoints, level: &Level) -> MeasuredPoints {
        measured.filtered(|point| {
            let at = level.intrinsics.pixel_of(*point);
            at.is_some_and(|at| !self.coverage.is_near(at.floor().as_ivec2(), BESIDE_PX))
        })
    }

    pub(super) fn expected(&self, at: IVec2) -> Option<Color> {
        let shown = self.shown.as_ref()?;
        shown[index_in(self.coverage.size_px, at - self.coverage.origin_px)?]
    }

    pub(super) fn is_within(&self, at: IVec2) -> bool {
        cross(at, WITHIN_PX).all(|at| self.coverage.at(at) >= 1.0)
    }

    /// Whether a pixel in the toy's place shows the plate, although the toy should look different.
    pub(super) fn is_hidden(&self, at: IVec2, frame: &Codes, plate: &Codes) -> bool {
        let [Some(frame), Some(plate)] = [frame.get(at), plate.get(at)] else {
            return false;
        };
        let is_unlike = self
            .expected(at)
            .is_none_or(|expected| apart(expected, plate) > UNLIKE_CODES);
        apart(frame, plate) < ALIKE_CODES && is_unlike
    }

    /// The same for the plate in another light of which a shadow leaves enough, as the toy changes it within a cup.
    fn is_hidden_in_light(&self, at: IVec2, frame: &Codes, plate: &Codes) -> bool {
        let [Some(color), Some(plate)] = [frame.get(at), plate.get(at)] else {
            return false;
        };
        let is_plate = from_shaded(color, plate) < ALIKE_CODES && is_lit(color, plate);
        is_plate && self.unlike(at, frame).is_some_and(|unlike| unlike >= FAR_UNLIKE)
    }

    /// Pixels at which a level shows the plate in place of the toy.
    pub(super) fn hidden<'a>(
        &'a self,
        frame: &'a Codes,
        plate: &'a Codes,
    ) -> impl Iterator<Item = IVec2> + 'a {
        let covered = self.coverage.pixels().filter(|at| self.coverage.at(*at) >= 1.0);
        covered.filter(|at| self.is_hidden(*at, frame, plate))
    }

    /// Whether nothing at a pixel shows a thing: beside the toy, frame and plate are alike, as far as the toy's rim lets
    /// them be; in its place, the frame shows the toy at the pixel and around it, so that no thing's rim is there.
    pub(super) fn is_free(&self, at: IVec2, frame: &Codes, plate: &Codes) -> bool {
        if self.coverage.at(at) >= 1.0 {
            let is_toy = |at: IVec2| self.coverage.at(at) < 1.0 || self.is_as_expected(at, frame);
            return square(at, RIM_PX).all(is_toy);
        }
        let colors = frame.get(at).zip(plate.get(at));
        let is_alike = colors.is_some_and(|(frame, plate)| apart(frame, plate) < ALIKE_CODES);
        is_alike || self.coverage.is_near(at, WITHIN_PX)
    }

    /// Whether a pixel of the toy has its expected colour.
    pub(super) fn is_as_expected(&self, at: IVec2, frame: &Codes) -> bool {
        self.unlike(at, frame).is_some_and(|unlike| unlike < 1.0)
    }

    /// Distance of a pixel of the toy from its expected colour, relative to that of another colour; `None` if
    /// one is unknown.
    fn unlike(&self, at: IVec2, frame: &Codes) -> Option<f32> {
        let (frame, expected) = frame.get(at).zip(self.expected(at))?;
        Some(from_shaded(frame, expected) / UNLIKE_CODES)
    }

    /// Whether most pixels around one of the toy have their expected colours.
    pub(super) fn is_shown(&self, at: IVec2, frame: &Codes) -> bool {
        self.coverage.at(at) > 0.0 && most_around(at, |at| self.is_as_expected(at, frame))
    }

    /// Things in a level's frame alone. They are before the toy if they are visible beside it and
    /// the toy does not look as expected, and beside it if they are large. `None` without any
    /// seeds. `seeds` are those of the plate.
    /// `needed` gives the evidence that each thing needs.
    pub(super) fn in_frame(
        &self,
        seeds: &Seeds,
        frame: &Codes,
        needed: impl Fn(&Grown) -> Vec<f32>,
    ) -> Option<InFrame> {
        let as_expected = self
            .coverage
            .pixels()
            .filter(|at| self.coverage.at(*at) >= 1.0 && self.is_shown(*at, frame));
        let of_toy: Vec<usize> = as_expected.filter_map(|at| index_in(seeds.size_px, at)).collect();
        let seeds = seeds.in_frame(frame, &of_toy);
        let grown = Grown::from(&seeds, Seed::InFrame, frame)?;
        let mut hidden = vec![0; grown.n_things()];
        for at in self.coverage.pixels().filter(|at| self.is_within(*at)) {
            let unlike = self.unlike(at, frame).unwrap_or(1.0);
            if let Some(thing) = grown.of_pixel(at).filter(|_| unlike >= 1.0) {
                hidden[thing] += usize::from(unlike >= FAR_UNLIKE) + 1;
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
    pub(super) fn before(
        &self,
        grown: &Grown,
        (frame, plate): (&Codes, &Codes),
        needed: &[f32],
    ) -> Vec<Known> {
        let mut hidden = vec![0; grown.n_things()];
        let mut n_within = vec![0; grown.n_things()];
        for at in self.coverage.pixels().filter(|at| self.is_within(*at)) {
            if let Some(thing) = grown.of_pixel(at) {
                n_within[thing] += 1;
                let is_hidden = self.is_hidden(at, frame, plate) || self.is_hidden_in_light(at, frame, plate);
                hidden[thing] += usize::from(is_hidden);
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
    pub(super) fn shows(&self, at: IVec2, frame: &Codes, plate: &Codes) -> bool {
        let is_toy = |at: IVec2| match (frame.get(at), plate.get(at), self.expected(at)) {
            (Some(frame), Some(plate), Some(toy)) => apart(frame, toy) < from_shaded(frame, plate),
            _ => false,
        };
        self.coverage.at(at) > 0.0 && most_around(at, is_toy)
    }

    /// Whether a pixel shows the toy and nothing before it.
    pub(super) fn is_bare(&self, at: IVec2, [frame, plate]: [&Codes; 2]) -> bool {
        self.is_seen(at, [frame, plate]) && self.is_shown(at, frame)
    }

    /// Whether a pixel in the toy's place is not the plate's in some light of which a shadow leaves
    /// enough.
    pub(super) fn is_seen(&self, at: IVec2, [frame, plate]: [&Codes; 2]) -> bool {
        let is_plate = frame
            .get(at)
            .zip(plate.get(at))
            .is_some_and(|(frame, plate)| from_shaded(frame, plate) < UNLIKE_CODES && is_lit(frame, plate));
        self.coverage.at(at) > 0.0 && !is_plate
    }
}

/// Whether a colour has enough of the plate's light for one in a shadow.
fn is_lit(color: Color, plate: Color) -> bool {
    brightest(color) > LEAST_LIT * brightest(plate)
}

fn brightest(color: Color) -> f32 {
    color.into_iter().fold(0.0, f32::max)
}

/// Whether a number of pixels is a part of the least one, or more.
fn has(n: usize, least: usize, part: f32) -> bool {
    n as f32 >= part * least as f32
}

/// Whether most pixels around one agree with the plate in less light, as in a thing's shadow.
pub(super) fn is_shade(at: IVec2, frame: &Codes, plate: &Codes) -> bool {
    most_around(at, |at| {
        let colors = frame.get(at).zip(plate.get(at));
        colors.is_some_and(|(frame, plate)| from_shaded(frame, plate) < 0.5 * UNLIKE_CODES)
    })
}
