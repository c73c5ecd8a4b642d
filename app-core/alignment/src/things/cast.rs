//! Shadows of things: beside a thing, the place's own colours in the light that a shadow leaves.
//!
//! No further shadow of the toy falls there, and the frame keeps them. A group of such pixels counts
//! if it touches a thing, and if some of them did not get darker in the toy's shadow, or if it lies where
//! the thing's shadow would fall if the thing were upright, below a single light.

use std::cell::LazyCell;
use std::collections::BTreeSet;

use glam::IVec2;

use super::codes::Codes;
use super::colors::Colors;
use super::groups::{groups, place_of};
use super::grown::{Grown, TOUCH_PX};
use super::seeds::{Seed, Seeds};
use crate::lights::Compared;
use crate::median::median;
use crate::picture::{Color, Mask, index_in, places};
use app_scene::geometry::color::{linear_from_srgb, srgb_from_linear};

/// Share of the light that the darkest part of the toy's shadow loses at least, part of it that
/// counts as that, and the number of such pixels: the darkest of fewer, as below a shoe
/// that hides the sky, too, are beyond it.
const LEAST_TAKEN: f32 = 0.3;
const DARKEST: f32 = 0.93;
const LEAST_PIXELS: usize = 30;
/// Log likelihood ratio of shaded colours against those of the place, as a mean over a square of
/// this radius in pixels.
const SHADED: f32 = 1.5;
const MEAN_PX: i32 = 2;
/// Minimum number of pixels of a group that stay as bright as in the plate.
const LEAST_UNCHANGED: usize = 8;
/// Smallest part of the pixels of a group and of the expected shadow of an upright thing that both
/// have: .45 for a post, whose depth makes the expected shadow longer, .21 and .22 for groups beside a
/// cup and another post that are parts of a shadow, or two of them.
const AGREES: f32 = 0.33;
/// Minimum number of pixels that both have: that post has 401, and no capture 25 to 100.
const LEAST_IN_SHADOW: usize = 50;

/// Whether the plate shows the place's colours in a shadow's light around each pixel; `None` if the toy's shadow is
/// too faint, or too small, to tell that light.
pub(super) fn shade(seeds: &Seeds, (compared, plate): (&[Compared], &Codes)) -> Option<Vec<bool>> {
    let left = darkest(compared)?;
    let of_place = seeds.of(Seed::Receiver);
    let place = || of_place.iter().map(|index| plate.pixels[*index]);
    let colors = Colors::of(place().map(|color| shaded(color, &left)), place());
    let likelier = mean(plate, &colors).into_iter();
    Some(likelier.map(|likelier| likelier > SHADED).collect())
}

/// The shadows of things in a level's plate. `expected` are those of upright things, if they are needed.
pub(super) fn shadows_of(
    things: &Grown,
    seeds: &Seeds,
    (compared, plate): (&[Compared], &Codes),
    expected: impl FnOnce() -> Vec<Mask>,
) -> Vec<Vec<usize>> {
    let mut is_toy_shadow = vec![false; plate.pixels.len()];
    for pixel in compared.iter().filter(|pixel| pixel.taken() > 0.5 * LEAST_TAKEN) {
        if let Some(index) = index_in(plate.size_px, pixel.at) {
            is_toy_shadow[index] = seeds.get(pixel.at) == Seed::Receiver;
        }
    }
    let mut beside = Mask::new(plate.size_px);
    for at in places(plate.size_px).filter(|at| things.of_pixel(*at).is_some()) {
        beside.mark(at);
    }
    let beside = beside.grown(TOUCH_PX);
    let upright = LazyCell::new(|| {
        let is_open = |at: &IVec2| {
            let index = index_in(plate.size_px, *at);
            index.is_some_and(|index| !is_toy_shadow[index]) && things.of_pixel(*at).is_none()
        };
        let open = compared.iter().map(|pixel| pixel.at).filter(is_open);
        UprightShadows::of(expected(), open, plate.size_px)
    });
    let is_shadow = |group: &Vec<usize>| {
        let is_unchanged = |index: &&usize| seeds.seeds[**index] == Seed::Thing;
        group
            .iter()
            .any(|index| beside.has(place_of(*index, plate.size_px)))
            && (group.iter().filter(is_unchanged).count() >= LEAST_UNCHANGED || {
                let touched: BTreeSet<usize> = things.touched(group).collect();
                touched.into_iter().any(|thing| upright.has(thing, group))
            })
    };
    let mut found = groups(plate.size_px, |index| {
        seeds.is_shade[index] && !is_toy_shadow[index]
    });
    found.retain(is_shadow);
    found
}

/// Where the shadow of each thing would fall if the thing were upright.
struct UprightShadows {
    size_px: IVec2,
    /// Pixels of receivers that the toy's shadow does not reach.
    open: Mask,
    shadows: Vec<Mask>,
    /// Number of open pixels of each shadow.
    n_open: Vec<usize>,
}

impl UprightShadows {
    fn of(shadows: Vec<Mask>, open_pixels: impl Iterator<Item = IVec2>, size_px: IVec2) -> Self {
        let (mut open, mut n_open) = (Mask::new(size_px), vec![0; shadows.len()]);
        for at in open_pixels {
            open.mark(at);
            for (n, shadow) in n_open.iter_mut().zip(&shadows) {
                *n += usize::from(shadow.has(at));
            }
        }
        Self {
            size_px,
            open,
            shadows,
            n_open,
        }
    }

    /// Whether a group lies where the shadow of a thing falls, as far as open pixels show.
    fn has(&self, thing: usize, group: &[usize]) -> bool {
        let Some((shadow, n_shadow)) = self.shadows.get(thing).zip(self.n_open.get(thing)) else {
            return false;
        };
        let open = || {
            let pixels = group.iter().map(|index| place_of(*index, self.size_px));
            pixels.filter(|at| self.open.has(*at))
        };
        let both = open().filter(|at| shadow.has(*at)).count();
        let either = n_shadow + open().count() - both;
        both >= LEAST_IN_SHADOW && both as f32 > AGREES * either as f32
    }
}

/// The light that the darkest part of the toy's shadow has.
fn darkest(compared: &[Compared]) -> Option<Color> {
    let mut taken: Vec<f32> = compared.iter().map(Compared::taken).collect();
    taken.sort_unstable_by(|a, b| b.total_cmp(a));
    let most = *taken.get(LEAST_PIXELS - 1)?;
    let darkest: Vec<Color> = compared
        .iter()
        .filter(|pixel| pixel.taken() > DARKEST * most)
        .map(|pixel| pixel.model)
        .collect();
    if most < LEAST_TAKEN {
        return None;
    }
    let of = |channel: usize| median(darkest.iter().map(|model| model[channel]), f32::total_cmp);
    Some([of(0)?, of(1)?, of(2)?])
}

fn shaded(color: Color, left: &Color) -> Color {
    [0, 1, 2].map(|channel| {
        let light = linear_from_srgb(color[channel] / 255.0) * left[channel];
        255.0 * srgb_from_linear(light.clamp(0.0, 1.0))
    })
}

/// Mean log likelihood ratios around each pixel.
fn mean(plate: &Codes, colors: &Colors) -> Vec<f32> {
    let own: Vec<f32> = plate
        .pixels
        .iter()
        .map(|color| colors.likelier(*color).unwrap_or(0.0))
        .collect();
    let along = |values: &[f32], axis: IVec2| -> Vec<f32> {
        let mean = |at: IVec2| {
            let taps = (-MEAN_PX..=MEAN_PX).filter_map(|step| index_in(plate.size_px, at + step * axis));
            let (sum, n) = taps.fold((0.0, 0.0), |(sum, n), index| (sum + values[index], n + 1.0));
            sum / n
        };
        places(plate.size_px).map(mean).collect()
    };
    along(&along(&own, IVec2::X), IVec2::Y)
}
