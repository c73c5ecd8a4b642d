//! A picture in layers, for compositing programs.

use glam::{UVec2, Vec2};

use super::FloatMap;
use super::decoding::Decoding;
use crate::geometry::rect::PixelRect;

/// Layers of a picture, all of its size, in linear light, by floats of 16 bits where anything is made.
///
/// The toy over the product of clean plate and shadow ratio is the picture, but for its grain, which the picture alone has, and for
/// pixels at the outline of a toy that stands still, where the camera's own are shown.
#[derive(Clone, Debug, PartialEq)]
pub struct Layers {
    /// The picture without the toy and without its shadow, as far as that is known; alpha is 1.
    pub clean_plate: FloatMap,
    /// Light with the shown shadow over light without it, for each channel; alpha is 1.
    pub shadow_ratio: FloatMap,
    /// The toy, its colours premultiplied by alpha, which is the part of the pixel that it covers.
    pub toy: FloatMap,
    /// r the same part; g the part of a light that the toy hides, the most of all lights; b is 1 where a
    /// receiver is; alpha is 1.
    pub masks: FloatMap,
}

/// The same of the work region, in the order of the fields.
pub(crate) type RegionLayers = [FloatMap; 4];

impl Layers {
    /// Of a camera's picture in which nothing is made.
    pub(crate) fn of_camera(camera: FloatMap) -> Self {
        let all = |texel: [f32; 4]| FloatMap {
            texels: vec![texel; camera.texels.len()],
            ..camera
        };
        Self {
            shadow_ratio: all([1.0; 4]),
            toy: all([0.0; 4]),
            masks: all([0.0, 0.0, 0.0, 1.0]),
            clean_plate: camera,
        }
    }

    /// Lays those of a region into it.
    pub(crate) fn lay(&mut self, of_region: &RegionLayers, rect: PixelRect, decoding: &Decoding) {
        let [clean_plate, shadow_ratio, toy, masks] = of_region;
        lay(&mut self.clean_plate, clean_plate, rect, |[r, g, b, _]| {
            let [r, g, b] = [r, g, b].map(|light| decoding.standard(light));
            [r, g, b, 1.0]
        });
        lay(&mut self.shadow_ratio, shadow_ratio, rect, |texel| texel);
        lay(&mut self.toy, toy, rect, |[r, g, b, alpha]| {
            let whole = |light: f32| alpha * decoding.standard(light / alpha);
            if alpha > 0.0 {
                [whole(r), whole(g), whole(b), alpha]
            } else {
                [0.0; 4]
            }
        });
        lay(&mut self.masks, masks, rect, |texel| texel);
    }

    /// Marks where a receiver is, by the centres of pixels.
    pub(crate) fn mark_receivers(&mut self, is_receiver: impl Fn(Vec2) -> bool) {
        let width = self.masks.width.max(1);
        for (index, texel) in (0..).zip(&mut self.masks.texels) {
            let at = UVec2::new(index % width, index / width).as_vec2() + 0.5;
            texel[2] = if is_receiver(at) { 1.0 } else { 0.0 };
        }
    }
}

fn lay(whole: &mut FloatMap, part: &FloatMap, rect: PixelRect, of: impl Fn([f32; 4]) -> [f32; 4]) {
    let width = whole.width as usize;
    let rows = part.texels.chunks_exact(part.width.max(1) as usize);
    for (y, row) in (rect.origin_px.y as usize..).zip(rows) {
        let first = y * width + rect.origin_px.x as usize;
        for (texel, from) in whole.texels[first..].iter_mut().zip(row) {
            *texel = of(*from);
        }
    }
}
