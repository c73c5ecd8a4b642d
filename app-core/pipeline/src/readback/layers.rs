//! A picture in layers, for compositing programs.

use glam::{UVec2, Vec2};

use super::FloatMap;
use super::decoding::Decoding;
use crate::geometry::rect::PixelRect;

/// Layers of a picture, all of its size, in linear light, as 16-bit floats where anything is drawn.
///
/// The toy over the product of clean plate and shadow ratio is the picture, except for the grain,
/// which the picture alone has, and for pixels at the outline of a toy that stands still, which are
/// the camera's own.
#[derive(Clone, Debug, PartialEq)]
pub struct Layers {
    /// The picture without the toy and its shadow, as far as it is known; alpha is 1.
    pub clean_plate: FloatMap,
    /// Ratio of the light with the shown shadow to that without it, for each channel; alpha is 1.
    pub shadow_ratio: FloatMap,
    /// The toy, its colours premultiplied by alpha, the fraction of the pixel that it covers.
    pub toy: FloatMap,
    /// r is the same fraction; g is the hidden fraction of a light, the largest over all lights; b
    /// is 1 on a receiver; alpha is 1.
    pub masks: FloatMap,
}

/// The same for the work region, in the order of the fields.
pub(crate) type RegionLayers = [FloatMap; 4];

impl Layers {
    /// The layers of a camera's picture in which nothing is drawn.
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

    /// Inserts the layers of a region.
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

    /// Marks the pixels whose centres lie on a receiver.
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
