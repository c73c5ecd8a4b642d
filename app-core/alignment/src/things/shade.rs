//! The light in which the plate shows the place, and in which the frame shows things.
//!
//! A shadow that the plate alone shows, such as that of the hand that took it, leaves its texture
//! right. Its light is measured against the frame: in the open, and up to a factor within the toy's
//! shadow, whose depth is not known well yet. Likewise a thing that the toy hides is as in the plate,
//! but in the light of its visible part. Where the toy hides the place, the light is interpolated.

use glam::{DVec2, IVec2};

use super::codes::{Codes, UNLIKE_CODES, from_shaded};
use super::groups::{groups, place_of};
use super::grown::Grown;
use super::interpolate::interpolate;
use crate::lights::Compared;
use crate::median::median;
use crate::picture::{Color, Level, Mask, Picture, UNKNOWN, bilinear, index_in, places, square};
use crate::raster::Coverage;
use app_scene::geometry::color::linear_from_srgb;

/// Light that the model takes from a pixel up to which the pixel is in the open.
const OPEN: f32 = 0.1;
/// The same from which on a pixel is in the toy's shadow, and the part of the light that is left
/// there below which it is no shadow. Left by the toy's shadow: .39; in the place of a dark toy that
/// the plate shows: .05 to .16 at most of its pixels; in a hand's shadow: .57 and more.
const SHADOWED: f32 = 0.25;
const DARKER: f32 = 0.5;
/// Factor by which the frame is brighter than the plate where that has a shadow, and the minimum
/// number of such pixels in a group, and in all.
const BRIGHTER: f32 = 1.15;
const LEAST_GROUP: usize = 30;
const LEAST_PIXELS: usize = 60;
/// Share of these whose plate must show the place in less light.
const OF_SHADOW: f32 = 0.9;
/// Largest part of the frame's texture that the plate lacks or adds, in energy, and the texture in
/// codes that is needed to compare it.
const OTHER_TEXTURE: f32 = 0.5;
const TEXTURE_CODES: f32 = 2.0;
/// Largest difference of the model within a radius of a pixel if its neighbours' differences are those
/// of the plate's light.
const EVEN: f32 = 0.05;
const EVEN_PX: i32 = 2;
/// Smallest light, as a share of its usual amount, that is used, and the light from which on nothing
/// is missing.
const LEAST_LEFT: f32 = 0.1;
const WHOLE: f32 = 0.985;
/// Radius of the mean of the measured light, in pixels, and the largest difference of a pixel from
/// it, as a logarithm.
const MEAN_PX: i32 = 2;
const SHARP: f32 = 0.1;
/// Margin around a shadow in the plate, and around the toy without measurements, in pixels.
const AROUND_PX: i32 = 8;
const HIDDEN_PX: i32 = 2;

/// Light at the pixels of a level, as a share of its usual amount.
#[derive(Clone)]
pub(super) struct Brightness {
    size_px: IVec2,
    /// Logarithms; unknown where it cannot be measured.
    light: Vec<Color>,
    /// Pixels where it is used.
    used: Mask,
}

impl Brightness {
    /// The light that remains in the plate in a shadow that it alone shows; `None` if there is none.
    pub(super) fn of_plate(
        compared: &[Compared],
        (frame, plate): (&Codes, &Codes),
        coverage: &Coverage,
    ) -> Option<Self> {
        let size_px = plate.size_px;
        let brighter = brighter(compared, size_px);
        let darkest = DARKER * left_by_toy(compared);
        if brighter.len() < LEAST_PIXELS || !is_shadow(&brighter, (frame, plate), darkest) {
            return None;
        }
        let mut used = Mask::new(size_px);
        brighter
            .iter()
            .for_each(|index| used.mark(place_of(*index, size_px)));
        let mut used = used.grown(AROUND_PX);
        let measured = smoothed(&measured(compared, size_px), size_px);
        let is_unmeasured = |pixel: &&Compared| {
            let index = index_in(size_px, pixel.at);
            pixel.taken() > OPEN || index.is_some_and(|index| measured[index][0].is_nan())
        };
        let unmeasured: Vec<IVec2> = compared
            .iter()
            .filter(is_unmeasured)
            .map(|pixel| pixel.at)
            .chain(hidden(coverage, size_px))
            .collect();
        unmeasured.iter().for_each(|at| used.mark(*at));
        let mut light = measured.clone();
        for index in unmeasured.iter().filter_map(|at| index_in(size_px, *at)) {
            light[index] = UNKNOWN;
        }
        interpolate(&mut light, (&measured, size_px), &unmeasured);
        Some(Self { size_px, light, used })
    }

    /// The light on the parts of things that the toy hides, relative to the plate.
    pub(super) fn of_things(
        things: &Grown,
        compared: &[Compared],
        (coverage, size_px): (&Coverage, IVec2),
    ) -> Self {
        let is_thing = |at: IVec2| things.of_pixel(at).is_some();
        let mut own = vec![UNKNOWN; (size_px.x * size_px.y) as usize];
        for pixel in compared {
            let is_seen = is_thing(pixel.at) && !coverage.is_near(pixel.at, HIDDEN_PX);
            if let Some(index) = index_in(size_px, pixel.at).filter(|_| is_seen) {
                own[index] = logarithm(pixel.ratio);
            }
        }
        let mut light = smoothed(&own, size_px);
        let unmeasured: Vec<IVec2> = hidden(coverage, size_px).filter(|at| is_thing(*at)).collect();
        interpolate(&mut light, (&own, size_px), &unmeasured);
        let mut used = Mask::new(size_px);
        unmeasured.iter().for_each(|at| used.mark(*at));
        Self { size_px, light, used }
    }

    /// The light at a place in pixels, between the centres of pixels; `None` if it is unknown or not
    /// used.
    pub(super) fn at(&self, place: DVec2) -> Option<Color> {
        if !self.used.has(place.floor().as_ivec2()) {
            return None;
        }
        let last = self.size_px - 1;
        let (mut sum, mut known) = ([0.0; 3], 0.0);
        for (at, weight) in bilinear(place - 0.5) {
            let light = self.light[index_in(self.size_px, at.clamp(IVec2::ZERO, last))?];
            if !light[0].is_nan() {
                sum = [0, 1, 2].map(|channel| sum[channel] + weight * light[channel]);
                known += weight;
            }
        }
        let light = sum.map(|sum| (sum / known).exp());
        let is_bright = light.iter().all(|light| *light >= LEAST_LEFT);
        (known > 0.0 && is_bright).then_some(light)
    }

    /// The same, if some of the light is missing.
    pub(super) fn missing_at(&self, place: DVec2) -> Option<Color> {
        self.at(place)
            .filter(|light| light.iter().any(|light| *light < WHOLE))
    }

    /// A level whose plate has all of its light.
    pub(super) fn restored(&self, level: &Level) -> Level {
        let pixel = |at: IVec2, plate: &Picture| {
            let color = plate.get(at).unwrap_or(UNKNOWN);
            match self.missing_at(at.as_dvec2() + 0.5) {
                Some(left) => [0, 1, 2].map(|channel| color[channel] / left[channel]),
                None => color,
            }
        };
        let restored = |plate: &Picture| {
            let pixels = places(plate.size_px).map(|at| pixel(at, plate));
            Picture::of(plate.size_px, pixels.collect())
        };
        Level {
            plate: level.plate.as_ref().map(restored),
            ..level.clone()
        }
    }
}

pub(super) fn logarithm(color: Color) -> Color {
    if color.iter().all(|channel| *channel > 0.0) {
        color.map(f32::ln)
    } else {
        UNKNOWN
    }
}

/// Pixels that the toy may hide.
fn hidden(coverage: &Coverage, size_px: IVec2) -> impl Iterator<Item = IVec2> {
    places(size_px).filter(|at| coverage.is_near(*at, HIDDEN_PX))
}

/// Pixels in the open, in groups, whose frame is brighter than the plate.
fn brighter(compared: &[Compared], size_px: IVec2) -> Vec<usize> {
    let mut is_brighter = vec![false; (size_px.x * size_px.y) as usize];
    for pixel in compared.iter().filter(|pixel| pixel.taken() < OPEN) {
        if let Some(index) = index_in(size_px, pixel.at) {
            is_brighter[index] = (0..3).all(|channel| pixel.ratio[channel] > BRIGHTER * pixel.model[channel]);
        }
    }
    let large = groups(size_px, |index| is_brighter[index]);
    let large = large.into_iter().filter(|group| group.len() >= LEAST_GROUP);
    let mut pixels: Vec<usize> = large.flatten().collect();
    pixels.sort_unstable();
    pixels
}

/// The light that the toy's own shadow usually leaves, as a share of the plate's; 0 without such a
/// shadow, which bounds nothing.
fn left_by_toy(compared: &[Compared]) -> f32 {
    let taken = compared.iter().map(Compared::taken);
    let taken = median(taken.filter(|taken| *taken > SHADOWED), f32::total_cmp);
    taken.map_or(0.0, |taken| 1.0 - taken)
}

/// Whether the plate shows the place in less light at some pixels in the open: in the frame's hue,
/// with no less than a share of its light, and with its texture.
fn is_shadow(pixels: &[usize], (frame, plate): (&Codes, &Codes), darkest: f32) -> bool {
    let [frame, plate] = [&frame.pixels, &plate.pixels];
    let light = |color: Color| {
        color
            .iter()
            .map(|code| linear_from_srgb(code / 255.0))
            .sum::<f32>()
    };
    let is_shaded = |index: &&usize| {
        let [frame, plate] = [frame[**index], plate[**index]];
        from_shaded(plate, frame) < UNLIKE_CODES && light(plate) > darkest * light(frame)
    };
    let n_shaded = pixels.iter().filter(is_shaded).count();
    let (mut texture, mut other, mut n) = (0.0, 0.0, 0.0);
    // Neighbours in a row follow each other.
    for pair in pixels.windows(2).filter(|pair| pair[1] == pair[0] + 1) {
        for channel in 0..3 {
            let [in_frame, in_plate] =
                [frame, plate].map(|codes| [pair[0], pair[1]].map(|index| codes[index][channel]));
            let scale = (in_frame[0] + in_frame[1]) / (in_plate[0] + in_plate[1]).max(1.0);
            let step = in_frame[1] - in_frame[0];
            texture += step * step;
            other += (step - scale * (in_plate[1] - in_plate[0])).powi(2);
            n += 1.0;
        }
    }
    let has_texture = texture > n * TEXTURE_CODES * TEXTURE_CODES;
    n_shaded as f32 >= OF_SHADOW * pixels.len() as f32 && !(has_texture && other > OTHER_TEXTURE * texture)
}

/// The plate's light at pixels in the open, and up to a factor within the toy's shadow; unknown near
/// that shadow's edge.
fn measured(compared: &[Compared], size_px: IVec2) -> Vec<Color> {
    let mut models = vec![f32::NAN; (size_px.x * size_px.y) as usize];
    for pixel in compared {
        if let Some(index) = index_in(size_px, pixel.at) {
            models[index] = 1.0 - pixel.taken();
        }
    }
    let is_even = |at: IVec2, model: f32| {
        // A pixel that is not compared is not uneven.
        around(at, EVEN_PX, size_px).all(|index| {
            let apart = (models[index] - model).abs();
            apart.is_nan() || apart <= EVEN
        })
    };
    let mut light = vec![UNKNOWN; models.len()];
    for pixel in compared
        .iter()
        .filter(|pixel| is_even(pixel.at, 1.0 - pixel.taken()))
    {
        if let Some(index) = index_in(size_px, pixel.at) {
            // The fit may have taken the plate's shadow for light that the toy reflects.
            let [model, ratio] = [pixel.model.map(|model| model.min(1.0)), pixel.ratio].map(logarithm);
            light[index] = [0, 1, 2].map(|channel| model[channel] - ratio[channel]);
        }
    }
    light
}

/// Indices of the pixels of a square around one.
fn around(at: IVec2, reach_px: i32, size_px: IVec2) -> impl Iterator<Item = usize> {
    square(at, reach_px).filter_map(move |at| index_in(size_px, at))
}

/// Means of the known pixels around each known one, unless it is unlike its mean.
fn smoothed(own: &[Color], size_px: IVec2) -> Vec<Color> {
    let mean = |at: IVec2, here: &Color| {
        let (mut sum, mut n) = ([0.0; 3], 0.0);
        for other in around(at, MEAN_PX, size_px).filter(|index| !own[*index][0].is_nan()) {
            sum = [0, 1, 2].map(|channel| sum[channel] + own[other][channel]);
            n += 1.0;
        }
        let mean = sum.map(|sum| sum / n);
        let is_near = (0..3).all(|channel| (here[channel] - mean[channel]).abs() < SHARP);
        if is_near { mean } else { *here }
    };
    places(size_px).zip(own).map(|(at, own)| mean(at, own)).collect()
}
