//! A pyramid of a picture's brightness.

use glam::{DVec2, IVec2, UVec2};

use crate::picture::{Mask, index_in, places};
use app_scene::geometry::color::linear_of_codes;
use app_scene::scene::{Image, Intrinsics};

/// Weights of linear red, green and blue in luminance (ITU-R BT.709).
const LUMINANCE: [f32; 3] = [0.2126, 0.7152, 0.0722];
/// Lower bound for the width of the smallest level, in pixels.
const LEAST_WIDTH_PX: i32 = 120;
/// A larger picture is halved first.
const MOST_PIXELS: i32 = 1920 * 1080;

/// A picture's brightness: the square root of luminance, in which a camera's noise is about
/// uniform.
#[derive(Debug)]
pub(super) struct Brightness {
    levels: Vec<Plane>,
}

/// One level, rows from the top.
#[derive(Debug)]
pub(super) struct Plane {
    pub(super) size_px: IVec2,
    /// Size of a pixel of the picture, in pixels of this level.
    scale: f64,
    /// Values; NaN if unknown.
    values: Vec<f32>,
}

impl Brightness {
    /// The brightness of a picture of checked size; withheld pixels are unknown.
    pub(super) fn of(image: &Image, withheld: Option<&Mask>) -> Self {
        let mut plane = Plane::luminance(image);
        if let Some(withheld) = withheld {
            for (value, at) in plane.values.iter_mut().zip(places(plane.size_px)) {
                if withheld.has(at) {
                    *value = f32::NAN;
                }
            }
        }
        while plane.size_px.x * plane.size_px.y > MOST_PIXELS {
            plane = plane.halved();
        }
        let mut levels = vec![plane];
        while let Some(last) = levels.last().filter(|last| last.size_px.x >= 2 * LEAST_WIDTH_PX) {
            levels.push(last.halved());
        }
        levels.iter_mut().for_each(Plane::take_root);
        Self { levels }
    }

    /// Levels, the largest first; at least one.
    pub(super) fn levels(&self) -> &[Plane] {
        &self.levels
    }
}

impl Plane {
    fn luminance(image: &Image) -> Self {
        let table = linear_of_codes();
        let texels = image.rgba8.chunks_exact(4);
        let luminance = |texel: &[u8]| -> f32 {
            let weighted = LUMINANCE.iter().zip(texel);
            weighted
                .map(|(weight, code)| weight * table[usize::from(*code)])
                .sum()
        };
        Self {
            size_px: UVec2::new(image.width_px, image.height_px).as_ivec2(),
            scale: 1.0,
            values: texels.map(luminance).collect(),
        }
    }

    fn take_root(&mut self) {
        self.values.iter_mut().for_each(|value| *value = value.sqrt());
    }

    fn halved(&self) -> Self {
        let size_px = self.size_px / 2;
        let mean = |at: IVec2| {
            let four = [IVec2::ZERO, IVec2::X, IVec2::Y, IVec2::ONE].map(|step| self.get(2 * at + step));
            0.25 * four.into_iter().sum::<Option<f32>>().unwrap_or(f32::NAN)
        };
        Self {
            size_px,
            scale: 0.5 * self.scale,
            values: places(size_px).map(mean).collect(),
        }
    }

    /// Converts a length in pixels of this level to pixels of the picture.
    pub(super) fn picture_px(&self, length_px: f64) -> f64 {
        length_px / self.scale
    }

    /// The picture's projection, in pixels of this level.
    pub(super) fn intrinsics(&self, k: &Intrinsics) -> Intrinsics {
        k.scaled(self.scale)
    }

    /// A pixel; `None` outside the picture, or if it is unknown.
    pub(super) fn get(&self, at: IVec2) -> Option<f32> {
        let value = self.values.get(index_in(self.size_px, at)?);
        value.copied().filter(|value| !value.is_nan())
    }

    /// Change per pixel along x and y by central differences; `None` at the border.
    pub(super) fn gradient(&self, at: IVec2) -> Option<DVec2> {
        let difference = |step: IVec2| Some(0.5 * f64::from(self.get(at + step)? - self.get(at - step)?));
        Some(DVec2::new(difference(IVec2::X)?, difference(IVec2::Y)?))
    }

    /// Value and gradient at a place in pixels, bilinear between four centres; `None` within two
    /// pixels of the border or of unknown pixels.
    pub(super) fn sample(&self, at_px: DVec2) -> Option<(f64, DVec2)> {
        let from_centre = at_px - 0.5;
        let is_inside =
            from_centre.cmpge(DVec2::ONE).all() && from_centre.cmplt(self.size_px.as_dvec2() - 2.0).all();
        let corner = is_inside.then(|| from_centre.floor())?;
        let [right, down] = (from_centre - corner).to_array();
        let corner = corner.as_ivec2();
        let weights = [
            (IVec2::ZERO, (1.0 - right) * (1.0 - down)),
            (IVec2::X, right * (1.0 - down)),
            (IVec2::Y, (1.0 - right) * down),
            (IVec2::ONE, right * down),
        ];
        let (mut value, mut gradient) = (0.0, DVec2::ZERO);
        for (step, weight) in weights {
            value += weight * f64::from(self.get(corner + step)?);
            gradient += weight * self.gradient(corner + step)?;
        }
        Some((value, gradient))
    }
}
