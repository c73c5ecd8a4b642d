//! Pictures in linear light, their pyramids, and masks.

use glam::{DVec2, IVec2, UVec2};

use app_scene::geometry::color::{linear_of_codes, linear_per_srgb};
use app_scene::scene::{Image, Intrinsics};
use app_scene::sharpness::Spread;
use app_scene::things::Mark;

/// Mean of a colour's channels.
pub(crate) fn brightness(color: &Color) -> f32 {
    color.iter().sum::<f32>() / 3.0
}

/// Index of a place within a rectangle; `None` outside it.
pub(super) fn index_in(size_px: IVec2, place: IVec2) -> Option<usize> {
    let is_inside = place.cmpge(IVec2::ZERO).all() && place.cmplt(size_px).all();
    is_inside.then_some((place.y * size_px.x + place.x) as usize)
}

/// All places of a rectangle, in the order of their indices.
pub(super) fn places(size_px: IVec2) -> impl DoubleEndedIterator<Item = IVec2> + Clone + use<> {
    (0..size_px.y).flat_map(move |y| (0..size_px.x).map(move |x| IVec2::new(x, y)))
}

/// All places up to a distance from one along each axis, row by row.
pub(super) fn square(middle: IVec2, reach_px: i32) -> impl Iterator<Item = IVec2> {
    places(IVec2::splat(2 * reach_px + 1)).map(move |place| middle + place - reach_px)
}

/// Linear red, green and blue.
pub(super) type Color = [f32; 3];

/// Value of an unknown pixel.
pub(super) const UNKNOWN: Color = [f32::NAN; 3];

/// A picture in linear light, rows from the top.
#[derive(Clone, Debug)]
pub(super) struct Picture {
    /// Width and height in pixels.
    pub(super) size_px: IVec2,
    pixels: Vec<Color>,
}

impl Picture {
    /// Decodes a picture of checked size; withheld pixels are unknown.
    pub(super) fn without(image: &Image, withheld: Option<&Mask>) -> Self {
        let mut picture = Self::decode(image);
        if let Some(withheld) = withheld {
            for (pixel, at) in picture.pixels.iter_mut().zip(places(picture.size_px)) {
                if withheld.has(at) {
                    *pixel = UNKNOWN;
                }
            }
        }
        picture
    }

    /// Decodes a picture of checked size.
    pub(super) fn decode(image: &Image) -> Self {
        let table = linear_of_codes();
        let texels = image.rgba8.chunks_exact(4);
        Self {
            size_px: UVec2::new(image.width_px, image.height_px).as_ivec2(),
            pixels: texels
                .map(|texel| [0, 1, 2].map(|channel| table[usize::from(texel[channel])]))
                .collect(),
        }
    }

    /// A picture of given pixels, rows from the top.
    pub(super) fn of(size_px: IVec2, pixels: Vec<Color>) -> Self {
        Self { size_px, pixels }
    }

    /// A pixel; `None` outside the picture, or if it is unknown.
    pub(super) fn get(&self, at: IVec2) -> Option<Color> {
        self.pixel(index_in(self.size_px, at)?)
    }

    /// The same by the pixel's index.
    pub(super) fn pixel(&self, index: usize) -> Option<Color> {
        let pixel = self.pixels.get(index).copied();
        pixel.filter(|color| !color[0].is_nan())
    }

    /// The value at a place in pixels, bilinear between four centres; `None` if one of them is
    /// unknown.
    pub(super) fn sample(&self, at_px: DVec2) -> Option<Color> {
        let is_inside = at_px.cmpge(DVec2::ZERO).all() && at_px.cmple(self.size_px.as_dvec2()).all();
        let four = is_inside.then(|| bilinear(at_px - 0.5))?;
        let mut sum = [0.0; 3];
        for (at, weight) in four {
            let color = self.get(at)?;
            sum = [0, 1, 2].map(|channel| sum[channel] + weight * color[channel]);
        }
        Some(sum)
    }

    /// Adds light to a pixel that is known; nothing becomes darker than black.
    pub(super) fn add(&mut self, at: IVec2, light: Color) {
        if let Some(pixel) = index_in(self.size_px, at).and_then(|index| self.pixels.get_mut(index)) {
            for (channel, light) in pixel.iter_mut().zip(light) {
                // Unknown values stay unknown.
                let sum = *channel + light;
                *channel = if sum < 0.0 { 0.0 } else { sum };
            }
        }
    }

    /// Spread by a Gaussian, whose deviation is in pixels; what is near to the border, or to what is unknown, is unknown.
    pub(super) fn spread(&self, deviation_px: f64) -> Self {
        let weights = gaussian(deviation_px);
        let [along, down] = [IVec2::X, IVec2::Y].map(|axis| {
            let taps = weights.iter().map(|(step, weight)| (*step * axis, *weight));
            taps.collect::<Vec<_>>()
        });
        self.taking(&along).taking(&down)
    }

    /// Spread along one axis, then along the other; what is near to the border, or to what is
    /// unknown, is unknown.
    pub(super) fn softened(&self, spread: Spread) -> Self {
        let [first, second] = taps_of(spread);
        self.taking(&first).taking(&second)
    }

    /// The weighted sum of the pixels at these offsets from each.
    fn taking(&self, taps: &[(IVec2, f32)]) -> Self {
        let pixel = |at: IVec2| {
            let mut sum = [0.0; 3];
            for (offset, weight) in taps {
                let Some(color) = self.get(at + *offset) else {
                    return UNKNOWN;
                };
                sum = [0, 1, 2].map(|channel| sum[channel] + weight * color[channel]);
            }
            sum
        };
        Self::of(self.size_px, places(self.size_px).map(pixel).collect())
    }

    /// Each pixel that is known, changed.
    pub(super) fn map(mut self, of: impl Fn(Color) -> Color) -> Self {
        for pixel in &mut self.pixels {
            if !pixel[0].is_nan() {
                *pixel = of(*pixel);
            }
        }
        self
    }

    /// Half as large, each pixel the mean of four; an odd last row or column is left out.
    fn halved(&self) -> Self {
        let size_px = self.size_px / 2;
        let mean = |at: IVec2| {
            let four = [IVec2::ZERO, IVec2::X, IVec2::Y, IVec2::ONE].map(|step| self.get(2 * at + step));
            let [Some(a), Some(b), Some(c), Some(d)] = four else {
                return UNKNOWN;
            };
            [0, 1, 2].map(|channel| 0.25 * (a[channel] + b[channel] + c[channel] + d[channel]))
        };
        Self {
            size_px,
            pixels: places(size_px).map(mean).collect(),
        }
    }
}

/// The four integer points around a point, and their weights.
pub(super) fn bilinear(at: DVec2) -> [(IVec2, f32); 4] {
    let corner = at.floor();
    let [right, down] = (at - corner).as_vec2().to_array();
    let corner = corner.as_ivec2();
    [
        (corner, (1.0 - right) * (1.0 - down)),
        (corner + IVec2::X, right * (1.0 - down)),
        (corner + IVec2::Y, (1.0 - right) * down),
        (corner + IVec2::ONE, right * down),
    ]
}

/// Steps within three standard deviations, and their weights, which add up to 1.
pub(super) fn gaussian(deviation_px: f64) -> Vec<(i32, f32)> {
    #[allow(clippy::cast_possible_truncation, reason = "some pixels")]
    let reach_px = (3.0 * deviation_px).ceil() as i32;
    let weight = |step: i32| (-0.5 * (f64::from(step) / deviation_px).powi(2)).exp();
    let total: f64 = (-reach_px..=reach_px).map(weight).sum();
    #[allow(clippy::cast_possible_truncation, reason = "weights below 1")]
    let weights = (-reach_px..=reach_px).map(|step| (step, (weight(step) / total) as f32));
    weights.collect()
}

/// Taps along each axis of a blur: a line's, or a Gaussian's.
pub(super) fn taps_of(spread: Spread) -> [Vec<(IVec2, f32)>; 2] {
    let [wide, narrow] = spread.axes_px();
    let first = if spread.is_line() {
        line(12.0_f64.sqrt() * wide)
    } else {
        taps_along(wide)
    };
    [first, taps_along(narrow)]
}

/// Taps of a uniform blur along a line around the centre, two a pixel and bilinear between pixels.
pub(super) fn line(by_px: DVec2) -> Vec<(IVec2, f32)> {
    #[allow(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "some pixels"
    )]
    let n = (2.0 * by_px.length()).ceil().max(1.0) as usize;
    let mut taps: Vec<(IVec2, f32)> = Vec::new();
    for k in 0..n {
        let at = ((k as f64 + 0.5) / n as f64 - 0.5) * by_px;
        for (offset, part) in bilinear(at) {
            let weight = part / n as f32;
            match taps.iter_mut().find(|(other, _)| *other == offset) {
                Some((_, sum)) => *sum += weight,
                None => taps.push((offset, weight)),
            }
        }
    }
    taps
}

/// Taps of a Gaussian along an axis as long as its deviation, one pixel apart and bilinear between
/// pixels.
fn taps_along(axis_px: DVec2) -> Vec<(IVec2, f32)> {
    const LEAST_PX: f64 = 0.01;
    let deviation_px = axis_px.length();
    if deviation_px < LEAST_PX {
        return vec![(IVec2::ZERO, 1.0)];
    }
    let mut taps = Vec::new();
    for (step, weight) in gaussian(deviation_px) {
        let four = bilinear(f64::from(step) * axis_px / deviation_px);
        let near = four.into_iter().filter(|(_, part)| *part > 0.0);
        taps.extend(near.map(|(offset, part)| (offset, weight * part)));
    }
    taps
}

/// The photograph and its plate at one level of the pyramid.
#[derive(Clone, Debug)]
pub(super) struct Level {
    /// Projection, in pixels of this level.
    pub(super) intrinsics: Intrinsics,
    /// The photograph.
    pub(super) frame: Picture,
    /// The plate from the same view, if there is one.
    pub(super) plate: Option<Picture>,
    /// Standard deviation of the blur that made the plate as soft as the photograph, in pixels of
    /// this level; the photograph's shadows are as soft.
    pub(super) softened_px: f64,
}

/// Photograph and plate, each level half as large as the one before.
#[derive(Clone, Debug)]
pub(super) struct Pyramid {
    levels: Vec<Level>,
    picture_px: f64,
}

impl Pyramid {
    /// Index of the smallest level.
    pub(super) const SMALLEST: usize = 3;
    /// Limit for the largest level; larger photographs are halved first: the loss is below the
    /// resolution of a phone's lens.
    const MOST_PIXELS: i32 = 4096 * 3072 / 4;

    /// All levels, from the largest.
    pub(super) fn new(frame: Picture, plate: Option<Picture>, intrinsics: Intrinsics) -> Self {
        let mut level = Level {
            intrinsics,
            frame,
            plate,
            softened_px: 0.0,
        };
        let mut picture_px = 1.0;
        while level.frame.size_px.x * level.frame.size_px.y > Self::MOST_PIXELS {
            level = level.halved();
            picture_px *= 2.0;
        }
        Self {
            levels: Self::levels_of(level),
            picture_px,
        }
    }

    /// With the plate blurred by a spread in pixels of the largest level; `None` without a plate.
    pub(super) fn with_softened_plate(&self, spread: Spread) -> Option<Self> {
        let largest = &self.levels[0];
        let plate = largest.plate.as_ref()?.softened(spread);
        Some(self.with_largest(largest.with_plate(plate, spread.mean_px())))
    }

    /// With unknown pixels of the photograph at marks of the largest level.
    pub(super) fn clear_of(&self, marks: &[Mark]) -> Self {
        let mut level = self.levels[0].clone();
        for (pixel, mark) in level.frame.pixels.iter_mut().zip(marks) {
            if *mark != Mark::None {
                *pixel = UNKNOWN;
            }
        }
        self.with_largest(level)
    }

    /// With another largest level, of the same size.
    pub(super) fn with_largest(&self, level: Level) -> Self {
        Self {
            levels: Self::levels_of(level),
            ..*self
        }
    }

    /// Changes the projection, in pixels of the photograph.
    pub(super) fn set_intrinsics(&mut self, intrinsics: Intrinsics) {
        let mut of_level = intrinsics.scaled(self.picture_px.recip());
        for level in &mut self.levels {
            level.intrinsics = of_level;
            of_level = of_level.scaled(0.5);
        }
    }

    /// All levels, from the largest.
    fn levels_of(largest: Level) -> Vec<Level> {
        let mut levels = vec![largest];
        for above in 0..Self::SMALLEST {
            levels.push(levels[above].halved());
        }
        levels
    }

    /// Pixels of the photograph per pixel of the largest level.
    pub(super) fn picture_px(&self) -> f64 {
        self.picture_px
    }

    /// The smallest level that shows shadows well enough for an estimate of lights.
    ///
    /// In 9,000 pixels a toy of a third of the picture's width is some 50 pixels wide.
    pub(super) fn smallest_for_shadows(&self) -> usize {
        const PIXELS: i32 = 9000;
        let is_enough = |level: &Level| level.frame.size_px.x * level.frame.size_px.y >= PIXELS;
        self.levels.iter().rposition(is_enough).unwrap_or(0)
    }

    /// The largest level of at most that many pixels, or a smaller copy of the smallest.
    pub(super) fn at_most(&self, n_pixels: i32) -> Level {
        let mut level = self.largest_within(n_pixels).clone();
        while !level.is_within(n_pixels) {
            level = level.halved();
        }
        level
    }

    /// The largest level of at most that many pixels, or else the smallest level.
    pub(super) fn largest_within(&self, n_pixels: i32) -> &Level {
        let found = self.levels.iter().find(|level| level.is_within(n_pixels));
        found.unwrap_or(&self.levels[Self::SMALLEST])
    }

    /// A level from 0, the largest, to [`Pyramid::SMALLEST`].
    pub(super) fn level(&self, level: usize) -> &Level {
        &self.levels[level]
    }
}

impl Level {
    fn is_within(&self, n_pixels: i32) -> bool {
        self.frame.size_px.element_product() <= n_pixels
    }

    /// With the plate blurred by a Gaussian, with its standard deviation in pixels; `None` without
    /// a plate.
    pub(super) fn with_plate_spread(&self, deviation_px: f64) -> Option<Self> {
        let plate = self.plate.as_ref()?.spread(deviation_px);
        Some(self.with_plate(plate, deviation_px))
    }

    /// With a plate that was blurred by this standard deviation in pixels.
    fn with_plate(&self, plate: Picture, deviation_px: f64) -> Self {
        Self {
            intrinsics: self.intrinsics,
            frame: self.frame.clone(),
            plate: Some(plate),
            softened_px: self.softened_px.hypot(deviation_px),
        }
    }

    fn halved(&self) -> Self {
        Self {
            intrinsics: self.intrinsics.scaled(0.5),
            frame: self.frame.halved(),
            plate: self.plate.as_ref().map(Picture::halved),
            softened_px: 0.5 * self.softened_px,
        }
    }
}

/// Noise of a photograph, in 8-bit sRGB codes.
pub(super) const NOISE_CODES: f32 = 2.0;

/// Standard deviation of a photograph's noise in linear light.
pub(super) fn noise_deviation(linear: f32) -> f32 {
    NOISE_CODES / 255.0 * linear_per_srgb(linear)
}

/// Marked pixels, rows from the top.
#[derive(Clone, Debug)]
pub(super) struct Mask {
    size_px: IVec2,
    pixels: Vec<bool>,
}

impl Mask {
    /// A mask of a size, without marks.
    pub(super) fn new(size_px: IVec2) -> Self {
        Self {
            size_px,
            pixels: vec![false; (size_px.x * size_px.y) as usize],
        }
    }

    /// Whether no pixel is marked.
    pub(super) fn is_empty(&self) -> bool {
        !self.pixels.contains(&true)
    }

    /// Whether a pixel is marked; false outside the picture.
    pub(super) fn has(&self, at: IVec2) -> bool {
        index_in(self.size_px, at).is_some_and(|index| self.pixels[index])
    }

    /// Marks a pixel; no effect outside the picture.
    pub(super) fn mark(&mut self, at: IVec2) {
        if let Some(index) = index_in(self.size_px, at) {
            self.pixels[index] = true;
        }
    }

    /// The marks of this mask and of another one of the same size.
    pub(super) fn with(mut self, other: &Self) -> Self {
        for (own, other) in self.pixels.iter_mut().zip(&other.pixels) {
            *own |= *other;
        }
        self
    }

    /// The mask with a square around each mark.
    pub(super) fn grown(&self, reach_px: i32) -> Self {
        self.grown_along(IVec2::X, reach_px)
            .grown_along(IVec2::Y, reach_px)
    }

    fn grown_along(&self, axis: IVec2, reach_px: i32) -> Self {
        let mut grown = self.clone();
        for at in places(self.size_px).filter(|at| self.has(*at)) {
            // Pixels between two marks are marked already.
            let before = if self.has(at - axis) { 0 } else { reach_px };
            let behind = if self.has(at + axis) { 0 } else { reach_px };
            for step in -before..=behind {
                grown.mark(at + step * axis);
            }
        }
        grown
    }
}
