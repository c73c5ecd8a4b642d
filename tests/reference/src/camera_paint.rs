//! CPU reference of `common/camera_paint.wgsl`: paint of the toy as the camera's pixels show it, relit.

use glam::{DVec3, DVec4, IVec2, UVec2};

use super::fit::toy_radiance;
use super::model::Solution;
use super::raster::Raster;
use super::smoothstep;

/// Largest factor by which a turned surface is brightened or darkened.
const MAX_TURN: f64 = 4.0;
/// Factor beyond the model's colour to which a pixel may be relit.
const OTHER_PAINT: f64 = 1.1;
/// Least part of a pixel that is unmixed.
const LEAST_PART: f64 = 0.35;
/// Error of the toy's part of a pixel, relative to that of its model's colour.
const PART_ERROR: f64 = 0.2;
/// Least part of the paint in a pixel's light.
const LEAST_PAINT: f64 = 0.1;
/// Distance in pixels within which brightness is compared.
const COMPARED_PX: i32 = 2;
/// Largest difference of the upward parts of two surfaces that are compared.
const SAME_UP: f64 = 0.1;
/// Factors by which the model is brighter up to which it stays, and from which the camera's brightness
/// is taken; the largest one.
const BRIGHTNESS: [f64; 3] = [1.2, 1.6, 2.0];
const LUMINANCE: DVec3 = DVec3::new(0.2126, 0.7152, 0.0722);

/// A camera pixel relit from `was_lit` to `lit`, radiance over base colour; a pixel that is on one side
/// of the model's colour `expected` comes no farther than a tenth beyond it.
#[must_use]
pub fn relit(color: DVec3, [lit, was_lit]: [DVec3; 2], expected: DVec3) -> DVec3 {
    let of_channel = |k: usize| {
        let turn = if was_lit[k] > 0.0 {
            lit[k] / was_lit[k]
        } else {
            1.0
        };
        let turned = color[k] * turn.clamp(1.0 / MAX_TURN, MAX_TURN);
        let low = color[k].min(expected[k] / OTHER_PAINT);
        let high = color[k].max(expected[k] * OTHER_PAINT);
        turned.clamp(low, high)
    };
    DVec3::from([0, 1, 2].map(of_channel))
}

/// What the camera sees of the toy, at each texel of the physical box.
#[derive(Clone, Debug)]
pub struct SeenToy {
    /// The camera's colours.
    pub frame: Raster<DVec3>,
    /// Whether a texel shows one surface.
    pub is_one: Raster<bool>,
    /// Base colour, and the part of the surface's view above the horizon.
    pub base: Raster<DVec4>,
    /// Each light's cosine times its visibility.
    pub received: Raster<DVec4>,
    /// In a blurred picture the colour that is mixed in, over the gain, and the toy's part.
    pub mixed: Option<Raster<DVec4>>,
    /// The radiance that a glossy toy reflects, over the gain, and the visibility of its paint.
    pub reflected: Option<Raster<DVec4>>,
}

impl SeenToy {
    /// The model's colour in the light of the photograph, over the gain.
    fn model(&self, solution: &Solution, texel: UVec2) -> DVec3 {
        let base = self.base.at(texel);
        let normal = DVec3::Y * (2.0 * base.w - 1.0);
        base.truncate() * toy_radiance(solution, normal, self.received.at(texel))
    }

    /// Weight of a pixel's own colour beside the model's, by the variances of both.
    fn told(&self, solution: &Solution, texel: UVec2) -> f64 {
        let Some(mixed) = self.mixed.as_ref().map(|mixed| mixed.at(texel)) else {
            return 1.0;
        };
        if mixed.w == 0.0 || mixed.w == 1.0 {
            return 1.0;
        }
        let model = self.model(solution, texel).dot(LUMINANCE);
        let apart = mixed.truncate().dot(LUMINANCE) - model;
        let of_pixel = (PART_ERROR * apart / mixed.w.max(LEAST_PART)).powi(2);
        model.powi(2) / (model.powi(2) + of_pixel)
    }

    /// The paint's colour, and how far it is known.
    #[must_use]
    pub fn paint(&self, solution: &Solution, texel: UVec2) -> DVec4 {
        let gain = solution.gain;
        let told = self.told(solution, texel);
        let mut color = self.frame.at(texel);
        if let Some(mixed) = &self.mixed {
            let mixed = mixed.at(texel);
            let part = mixed.w.max(LEAST_PART);
            color = (color - (1.0 - part) * gain * mixed.truncate()).max(DVec3::ZERO) / part;
        }
        match &self.reflected {
            Some(reflected) => {
                let there = reflected.at(texel);
                let paint = (color - gain * there.truncate()).max(LEAST_PAINT * color);
                paint.extend(told * there.w)
            }
            None => color.extend(told),
        }
    }

    /// Factor for the model's colour of a point that no pixel shows, with this upward part and tint: the
    /// brightness of one-surface pixels around a texel over the model's there.
    #[must_use]
    pub fn brightness_beside(&self, solution: &Solution, texel: UVec2, (up, tint): (f64, DVec3)) -> f64 {
        let size = self.frame.size().as_ivec2();
        let reach = || -COMPARED_PX..=COMPARED_PX;
        let around = reach().flat_map(|y| reach().map(move |x| IVec2::new(x, y)));
        let (mut shown, mut expected) = (0.0, 0.0);
        for at in around.map(|offset| texel.as_ivec2() + offset) {
            if at.cmplt(IVec2::ZERO).any() || at.cmpge(size).any() {
                continue;
            }
            let at = at.as_uvec2();
            let base = self.base.at(at);
            if !self.is_one.at(at) || (base.w - up).abs() > SAME_UP {
                continue;
            }
            let paint = self.paint(solution, at);
            shown += paint.w * paint.truncate().dot(LUMINANCE);
            expected += paint.w * (solution.gain * tint * self.model(solution, at)).dot(LUMINANCE);
        }
        if shown == 0.0 || expected == 0.0 {
            return 1.0;
        }
        let [same, other, most] = BRIGHTNESS;
        let brighter: f64 = expected / shown;
        let part = smoothstep(same.ln(), other.ln(), brighter.ln());
        brighter.clamp(1.0, most).powf(-part)
    }
}
