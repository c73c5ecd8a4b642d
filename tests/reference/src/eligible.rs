//! CPU reference of `eligible.wgsl`: masks 3b and 3c.

use glam::{DVec4, IVec2};

use super::raster::Raster;
use super::sets::LightSet;

/// Hidden share of a light up to which a place counts as lit: it is invisible.
const FAINT: f64 = 0.01;

/// Mask 3c, the set of lights whose shadow may be sampled, and mask 3b, the real shadow.
#[must_use]
pub fn masks(
    is_toy: &Raster<bool>,
    visibility: &Raster<DVec4>,
    n_lights: usize,
    margin_px: i32,
) -> (Raster<LightSet>, Raster<bool>) {
    let is_lit = |v: f64| v >= 1.0 - FAINT;
    // `None` if a light is partly hidden, or the toy is in front.
    let umbra = Raster::from_fn(is_toy.size(), |texel| {
        let of_lights = &visibility.at(texel).to_array()[..n_lights];
        let is_clear = !is_toy.at(texel) && of_lights.iter().all(|v| *v == 0.0 || is_lit(*v));
        let hidden = (0..).zip(of_lights).filter(|(_, v)| **v == 0.0);
        is_clear.then(|| LightSet(hidden.fold(0, |set, (light, _)| set | 1 << light)))
    });
    let last = is_toy.size().as_ivec2() - 1;
    let around =
        || (-margin_px..=margin_px).flat_map(|y| (-margin_px..=margin_px).map(move |x| IVec2::new(x, y)));
    let eligible = Raster::from_fn(is_toy.size(), |texel| {
        let near = around().map(|step| (texel.as_ivec2() + step).clamp(IVec2::ZERO, last).as_uvec2());
        let own = umbra.at(texel);
        let is_same = near.into_iter().all(|other| umbra.at(other) == own);
        own.filter(|_| is_same).unwrap_or_default()
    });
    let shadow = visibility.map(|v| v.to_array()[..n_lights].iter().any(|v| !is_lit(*v)));
    (eligible, shadow)
}
