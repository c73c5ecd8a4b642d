//! Pixels that certainly show a receiver, and pixels that certainly do not.

use glam::IVec2;

use super::codes::{Codes, UNLIKE_CODES, from_shaded};
use super::colors::Colors;
use super::groups::{groups, most_around};
use crate::lights::Compared;
use crate::median::median;
use crate::picture::{Color, index_in, places};
use app_scene::geometry::color::{linear_from_srgb, srgb_from_linear};

/// Smallest difference from the model, in plates, that no light on a receiver explains; a larger
/// one excludes a receiver.
pub(super) const UNEXPLAINED: f32 = 0.15;
pub(super) const EXPLAINED: f32 = 0.06;
/// Minimum of that difference in standard deviations of the noise.
const OF_NOISE: f32 = 4.0;
/// Smallest loss of light in the model at which a pixel can certainly show a receiver.
const SHADOWED: f32 = 0.25;
/// Largest loss of light in the model of a pixel without shadow.
const OPEN: f32 = 0.02;
/// Smallest remaining light at which the model constrains the plate.
const LEAST_LIGHT: f32 = 0.05;
/// Log likelihood ratio of the place against a thing at which an open pixel shows a receiver, and
/// the required share of the place.
const LIKE_PLACE: f32 = 1.5;
const COMMON: f32 = 0.02;
/// Log likelihood ratio of a thing against the place at which a pixel shows no receiver, and the
/// number of rounds.
const LIKE_THING: f32 = 1.0;
const N_DROPS: usize = 3;
/// The same ratio of a group of such pixels, against the place without it, and the group's size: the
/// minimum number of pixels, and the maximum as a part of all that show a receiver.
const LIKE_THING_ALONE: f32 = 3.0;
const LEAST_PART: usize = 8;
const MOST_PARTS: usize = 4;
/// Largest log likelihood ratio of a thing in the frame's colours for a group in the plate alone.
const OF_PLACE: f32 = 1.0;
/// Largest ratio in the plate of a group in the frame alone: skin is like wood.
const MOST_IN_PLATE: f32 = 2.0;
/// Least difference in codes between frame and plate in less light of such a group, and by how much its ratio in
/// the frame is larger; the same for a large group; and for any, also if the difference is only beyond the noise
/// of the place. Groups of more than 100 pixels in forty rooms: things in both pictures differ by .2 to 4.6 codes,
/// at most by .5 if their ratio in the plate is below 2; hands by 10 to 41, one in the shade of a llama by 4.0 with
/// a ratio that is larger by 4.8, and one on wood of its colour by 10.7 with 1.3.
const OF_FRAME: (f32, f32) = (0.5 * UNLIKE_CODES, 1.5);
const OF_FRAME_LARGE: (f32, f32) = (0.5 * UNLIKE_CODES, 0.5);
const OF_FRAME_SHADED: (f32, f32) = (0.25 * UNLIKE_CODES, 3.0);
const OF_PLACE_NOISE: f32 = 3.0;
/// By how much the ratio in the plate of a large group in the plate alone is larger.
const OF_PLATE_LARGE: f32 = 1.5;
/// Median log likelihood ratio at which a group's colours in the plate are a thing's, with the
/// minimum number of pixels; and the limit for large groups. Between them it falls evenly with the logarithm of
/// that number: a post before a striped toy has groups of 161, 99 and 70 pixels with 1.9 to 3.3.
const SIGNIFICANT: (f32, usize) = (3.0, 8);
const SIGNIFICANT_LARGE: (f32, usize) = (1.0, 200);
/// The minimum number of pixels of a group in the place's own colours: a white mug on pale stone has
/// 527; no group of a varnished table, a lamp's tube, an inexact scan or a phone's camera is as large.
const LEAST_ALIKE: usize = 200;

/// How much the colours of a thing must differ from the place's.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Colored {
    /// Beyond doubt: they alone show that there is a thing.
    Otherwise,
    /// Not at all, perhaps: the thing is there if it has a plane, or if the toy's shadow on it shows
    /// that it stands up.
    Alike,
}

/// Content of a pixel, as far as it is certain.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Seed {
    /// The content is unknown.
    None,
    Receiver,
    Thing,
    /// A thing that the plate shows and the frame does not.
    WrongPlate,
    /// A thing that the frame shows and the plate does not.
    InFrame,
}

/// Seeds of a level.
pub(super) struct Seeds {
    pub(super) size_px: IVec2,
    pub(super) seeds: Vec<Seed>,
    /// Pixels that are as bright as in the plate, as expected.
    open: Vec<usize>,
    /// Whether each pixel is free: no light of it that the toy blocks tells what it shows, and nothing in the frame shows
    /// a thing.
    pub(super) is_free: Vec<bool>,
    /// Whether each pixel may be in a thing's shadow.
    pub(super) is_shade: Vec<bool>,
    /// Colours in the plate of receivers and of things, or of things that the plate alone shows.
    pub(super) colors: [Colors; 2],
}

impl Seeds {
    /// The colours of things of a kind, and of their place.
    pub(super) fn known_colors(&self, kind: Seed) -> &Colors {
        &self.colors[usize::from(kind == Seed::WrongPlate)]
    }

    /// Finds the seeds. `hidden` are the pixels that show the plate in place of the toy, and `is_free` says whether
    /// nothing at a pixel shows a thing.
    pub(super) fn found(
        compared: &[Compared],
        (hidden, is_free): (impl Iterator<Item = IVec2>, impl Fn(IVec2) -> bool),
        (frame, plate): (&Codes, &Codes),
        colored: Colored,
    ) -> Self {
        let size_px = plate.size_px;
        let mut seeds = vec![Seed::None; plate.pixels.len()];
        let mut is_free: Vec<bool> = places(size_px).map(is_free).collect();
        for pixel in compared {
            let Some(index) = index_in(size_px, pixel.at) else {
                continue;
            };
            is_free[index] &= pixel.taken() < OPEN;
            if is_unexplained(pixel) {
                seeds[index] = Seed::Thing;
            } else if !pixel.is_away(EXPLAINED, 0.5 * OF_NOISE) && pixel.taken() > SHADOWED {
                seeds[index] = Seed::Receiver;
            }
        }
        let open = compared
            .iter()
            .filter(|pixel| pixel.taken() < OPEN && !pixel.has_changed(EXPLAINED));
        let open = open.filter_map(|pixel| index_in(size_px, pixel.at));
        let mut found = Self {
            open: open.collect(),
            is_free,
            is_shade: vec![false; plate.pixels.len()],
            size_px,
            colors: [Colors::default(), Colors::default()],
            seeds,
        };
        for at in hidden {
            if let Some(index) = index_in(size_px, at) {
                found.seeds[index] = Seed::Thing;
            }
        }
        found.drop_lone();
        found.tell(frame, &lit(compared, (frame, plate)), plate, colored);
        found
    }

    /// With pixels that may be in a thing's shadow, if any is known: these are not free.
    pub(super) fn with_shade(mut self, is_shade: Option<Vec<bool>>) -> Self {
        let Some(is_shade) = is_shade else { return self };
        for (is_free, is_shade) in self.is_free.iter_mut().zip(&is_shade) {
            *is_free &= !is_shade;
        }
        Self { is_shade, ..self }
    }

    /// Whether any seed is of a thing, in whichever picture.
    pub(super) fn show_things(&self) -> bool {
        let is_of_thing = |seed: &Seed| !matches!(seed, Seed::None | Seed::Receiver);
        self.seeds.iter().any(is_of_thing)
    }

    pub(super) fn get(&self, at: IVec2) -> Seed {
        index_in(self.size_px, at).map_or(Seed::None, |index| self.seeds[index])
    }

    /// Drops isolated seeds of things among others.
    fn drop_lone(&mut self) {
        let is_lone = |at: IVec2| !most_around(at, |at| self.get(at) == Seed::Thing);
        let kept = places(self.size_px).zip(&self.seeds);
        let kept = kept.map(|(at, seed)| {
            if *seed == Seed::Thing && is_lone(at) {
                Seed::None
            } else {
                *seed
            }
        });
        self.seeds = kept.collect();
    }

    /// Keeps groups of seeds whose colours, in the frame without its shadow or in the plate, differ
    /// from the place's, and sets their kind.
    fn tell(&mut self, frame: &Codes, lit: &Codes, plate: &Codes, colored: Colored) {
        let groups = groups(self.size_px, |index| self.seeds[index] == Seed::Thing);
        let receivers = self.of(Seed::Receiver);
        // A thing is compared with the whole place, and grows against the shadowed receiver.
        let place: Vec<usize> = receivers.iter().chain(&self.open).copied().collect();
        let seeds = |of: &'_ Codes| -> Vec<Color> {
            groups.iter().flatten().map(|index| of.pixels[*index]).collect()
        };
        let of_place = || place.iter().map(|index| plate.pixels[*index]);
        let in_plate = Colors::of(seeds(plate).into_iter(), of_place());
        let in_frame = Colors::of(seeds(lit).into_iter(), of_place());
        let of_noise = from_less_light(&place, frame, plate);
        let kinds = groups.iter().map(|group| {
            let ratios = [in_frame.median(lit, group), in_plate.median(plate, group)];
            let differs = from_less_light(group, frame, plate);
            let kind = classified(ratios, [differs, of_noise], group.len(), colored);
            // Where both shadows fall, frame and plate are equal, but only the frame as dark as expected; where
            // that in the plate falls alone, the plate shows the frame's colours in less light.
            let may_be_shadow = is_of_plate_alone(ratios, group.len())
                || (differs > UNLIKE_CODES && from_less_light(group, plate, frame) < UNLIKE_CODES);
            (kind, may_be_shadow)
        });
        let kinds: Vec<(Seed, bool)> = kinds.collect();
        let is_plate_wrong = kinds.iter().any(|(kind, _)| *kind == Seed::WrongPlate);
        for (group, (kind, may_be_shadow)) in groups.iter().zip(kinds) {
            let is_shadow = kind == Seed::Thing && is_plate_wrong && may_be_shadow;
            let seed = if is_shadow { Seed::WrongPlate } else { kind };
            for index in group {
                self.seeds[*index] = seed;
            }
        }
        self.colors = self.colors_against(&place, plate);
        for index in &self.open {
            let color = plate.pixels[*index];
            let is_like = |colors: &Colors| {
                colors
                    .likelier(color)
                    .is_none_or(|likelier| likelier < -LIKE_PLACE)
            };
            let is_common = in_plate.part_of_place(color) > COMMON;
            if self.seeds[*index] == Seed::None && is_common && self.colors.iter().all(is_like) {
                self.seeds[*index] = Seed::Receiver;
            }
        }
        self.colors = self.colors_against(&self.of(Seed::Receiver), plate);
        self.drop_like_things(plate);
    }

    /// Keeps receivers whose colours in the plate are not a thing's: if a shadow on a thing
    /// coincides with the one that the receiver would catch, the thing looks like the receiver.
    fn drop_like_things(&mut self, plate: &Codes) {
        let learn = |seeds: &mut Self| seeds.colors = seeds.colors_against(&seeds.of(Seed::Receiver), plate);
        self.drop_like_thing(self.of(Seed::Receiver), plate, learn);
        self.drop_parts_like_things(plate);
    }

    /// Drops groups of receivers in colours of things that no receiver outside the group has, such
    /// as a side of a mug with as much of the shadow as its surroundings.
    fn drop_parts_like_things(&mut self, plate: &Codes) {
        let receivers = self.of(Seed::Receiver);
        let may_be_thing = |index: usize| {
            let likelier = self.colors[0].likelier(plate.pixels[index]);
            self.seeds[index] == Seed::Receiver && likelier.is_some_and(|likelier| likelier > 0.0)
        };
        let mut dropped = Vec::new();
        for group in groups(self.size_px, may_be_thing) {
            let is_part = (LEAST_PART..receivers.len() / MOST_PARTS).contains(&group.len());
            if is_part && self.is_like_things_alone(&group, &receivers, plate) {
                dropped.extend(group);
            }
        }
        for index in &dropped {
            self.seeds[*index] = Seed::None;
        }
        if !dropped.is_empty() {
            self.colors = self.colors_against(&self.of(Seed::Receiver), plate);
        }
    }

    /// Whether a group of receivers has colours of things, and of no other receiver.
    fn is_like_things_alone(&self, group: &[usize], receivers: &[usize], plate: &Codes) -> bool {
        let mut is_of_group = vec![false; self.seeds.len()];
        group.iter().for_each(|index| is_of_group[*index] = true);
        let others: Vec<usize> = receivers
            .iter()
            .copied()
            .filter(|index| !is_of_group[*index])
            .collect();
        self.colors_of(Seed::Thing, &others, plate).median(plate, group) > LIKE_THING_ALONE
    }

    /// Drops those of given seeds whose colours in a picture are a thing's, and learns the colours
    /// again after each round.
    fn drop_like_thing(&mut self, mut kept: Vec<usize>, picture: &Codes, learn: impl Fn(&mut Self)) {
        for _ in 0..N_DROPS {
            let is_like_thing = |index: &usize| {
                let likelier = self.colors[0].likelier(picture.pixels[*index]);
                likelier.is_some_and(|likelier| likelier > LIKE_THING)
            };
            let dropped: Vec<usize> = kept.extract_if(.., |index| is_like_thing(index)).collect();
            if dropped.is_empty() {
                return;
            }
            for index in dropped {
                self.seeds[index] = Seed::None;
            }
            learn(self);
        }
    }

    /// Colours of things, and of those that the plate alone shows, against some pixels of the
    /// place.
    fn colors_against(&self, place: &[usize], plate: &Codes) -> [Colors; 2] {
        [Seed::Thing, Seed::WrongPlate].map(|seed| self.colors_of(seed, place, plate))
    }

    /// Colours of the seeds of a kind against some pixels of the place.
    fn colors_of(&self, kind: Seed, place: &[usize], plate: &Codes) -> Colors {
        let seeds = self.of(kind).into_iter();
        Colors::of(
            seeds.map(|index| plate.pixels[index]),
            place.iter().map(|index| plate.pixels[*index]),
        )
    }

    /// The same for things that the frame alone shows: against the place, and against the toy in
    /// pixels that look as expected, of both without those in a thing's colours.
    pub(super) fn in_frame(&self, frame: &Codes, toy: &[usize]) -> Self {
        let keep = |seed: &Seed| match seed {
            Seed::InFrame | Seed::Receiver => *seed,
            Seed::None | Seed::Thing | Seed::WrongPlate => Seed::None,
        };
        let mut seeds: Vec<Seed> = self.seeds.iter().map(keep).collect();
        for index in toy {
            seeds[*index] = Seed::Receiver;
        }
        let mut found = Self {
            seeds,
            open: Vec::new(),
            is_free: self.is_free.clone(),
            is_shade: self.is_shade.clone(),
            colors: [Colors::default(), Colors::default()],
            ..*self
        };
        found.learn_in_frame(frame);
        // Skin in less light is like a pale toy, and like the table in the toy's shadow.
        found.drop_like_thing(found.of(Seed::Receiver), frame, |found| {
            found.learn_in_frame(frame)
        });
        found
    }

    /// Learns the colours in the frame of things that it alone shows.
    fn learn_in_frame(&mut self, frame: &Codes) {
        let of = |kind: Seed| self.of(kind).into_iter().map(|index| frame.pixels[index]);
        let colors = Colors::of(of(Seed::InFrame), of(Seed::Receiver));
        self.colors = [colors, Colors::default()];
    }

    /// Indices of the seeds of a kind.
    pub(super) fn of(&self, kind: Seed) -> Vec<usize> {
        let seeds = self.seeds.iter().enumerate();
        seeds
            .filter(|(_, seed)| **seed == kind)
            .map(|(index, _)| index)
            .collect()
    }
}

/// Whether no light on a receiver explains a pixel.
pub(super) fn is_unexplained(pixel: &Compared) -> bool {
    pixel.is_away(UNEXPLAINED, OF_NOISE)
}

/// Whether there may be a thing in the place's own colours.
pub(super) fn may_be_alike(compared: &[Compared]) -> bool {
    compared.iter().filter(|pixel| is_unexplained(pixel)).count() >= LEAST_ALIKE
}

/// The frame without the toy's shadow, if it shows a receiver.
fn lit(compared: &[Compared], (frame, plate): (&Codes, &Codes)) -> Codes {
    let mut lit = frame.pixels.clone();
    for pixel in compared {
        if let Some(index) = index_in(plate.size_px, pixel.at) {
            lit[index] = [0, 1, 2].map(|channel| {
                let plate = linear_from_srgb(plate.pixels[index][channel] / 255.0);
                let light = pixel.ratio[channel] / pixel.model[channel].max(LEAST_LIGHT);
                255.0 * srgb_from_linear((plate * light).min(1.0))
            });
        }
    }
    Codes {
        size_px: plate.size_px,
        pixels: lit,
    }
}

/// Median distance in codes of a group's colours in a picture from those of another in less light.
fn from_less_light(group: &[usize], picture: &Codes, other: &Codes) -> f32 {
    let distances = group
        .iter()
        .map(|index| from_shaded(picture.pixels[*index], other.pixels[*index]));
    median(distances, f32::total_cmp).unwrap_or(0.0)
}

/// Kind of a group of seeds, from the log likelihood ratios of its colours in frame and plate, and
/// from the difference in codes between the frame and the plate in less light, also that of the place.
fn classified(
    [by_frame, by_plate]: [f32; 2],
    [differs, of_noise]: [f32; 2],
    n_seeds: usize,
    colored: Colored,
) -> Seed {
    let is_significant = n_seeds >= SIGNIFICANT.1 && by_plate > least_ratio(n_seeds);
    let is_of_one = differs > UNLIKE_CODES;
    let is_beyond = |(codes, ratio): (f32, f32)| differs > codes && by_frame > by_plate + ratio;
    let is_of_frame = is_beyond(OF_FRAME)
        || (n_seeds >= SIGNIFICANT_LARGE.1 && is_beyond(OF_FRAME_LARGE))
        || (differs > OF_PLACE_NOISE * of_noise && is_beyond(OF_FRAME_SHADED));
    if by_plate < MOST_IN_PLATE && is_of_frame {
        Seed::InFrame
    } else if colored == Colored::Alike && n_seeds >= LEAST_ALIKE && !is_of_one {
        Seed::Thing
    } else if !is_significant {
        Seed::None
    } else if is_of_one && is_of_plate_alone([by_frame, by_plate], n_seeds) {
        Seed::WrongPlate
    } else {
        Seed::Thing
    }
}

/// The log likelihood ratio that a group of so many pixels needs.
fn least_ratio(n_seeds: usize) -> f32 {
    let [(of_few, few), (of_many, many)] = [SIGNIFICANT, SIGNIFICANT_LARGE];
    let along = (n_seeds as f32 / few as f32).ln() / (many as f32 / few as f32).ln();
    of_few + along.clamp(0.0, 1.0) * (of_many - of_few)
}

/// Whether a group's colours are the place's in the frame, or, in a large one, much likelier so than in the plate: a
/// large part of a place may have rare colours. Planks behind a blockman had a ratio of 1.06, and he of 4.4.
fn is_of_plate_alone([by_frame, by_plate]: [f32; 2], n_seeds: usize) -> bool {
    by_frame < OF_PLACE || (n_seeds >= SIGNIFICANT_LARGE.1 && by_plate > by_frame + OF_PLATE_LARGE)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The kind of a large group beside a place without noise.
    fn kind(ratios: [f32; 2], differs: f32) -> Seed {
        classified(ratios, [differs, 0.2], 1000, Colored::Otherwise)
    }

    #[test]
    fn a_hand_on_a_table_of_its_colour_or_in_the_shade_is_in_the_frame_alone() {
        assert_eq!(kind([2.37, 1.09], 10.7), Seed::InFrame);
        assert_eq!(kind([5.83, 1.05], 4.0), Seed::InFrame);
    }

    #[test]
    fn a_thing_that_both_pictures_show_is_none_in_the_frame_alone() {
        // A ramp, a book and a mug in the toy's shadow.
        for (ratios, differs) in [([5.16, 1.84], 0.5), ([4.9, 2.69], 3.3), ([1.04, 1.14], 0.5)] {
            assert_eq!(kind(ratios, differs), Seed::Thing, "{ratios:?}");
        }
    }

    #[test]
    fn the_noise_of_a_place_is_no_difference() {
        let kind = classified([5.16, 1.84], [4.0, 3.0], 1000, Colored::Otherwise);
        assert_eq!(kind, Seed::Thing);
    }
}
