//! CPU reference of `unmix.wgsl` and of `common/unmixed.wgsl`: one surface's part of a colour of the toy that a blurred picture mixes.

use glam::{DVec2, DVec3, UVec2};

use super::model::DARKEST_USABLE;
use super::occlusion::{PointSpread, spread_position};
use super::raster::Raster;

/// The code of a factor of 1, and the greatest one.
const CODES: [f64; 2] = [512.0, 1023.0];
/// The greatest factor that has a code: that of the code of 1023.
const GREATEST: f64 = 3.992_191_3;

/// Number of sampled places, and rows from one column's place to the next.
const N_PLACES: u32 = 64;
const ROW_STEP: u32 = 19;

/// The model's colour of a texel over its mean over the blur, no greater than codes can be; the model has none beside the toy. `spread` is that of
/// the picture's blur, and places are shifted by `beside_px` to all four sides in turn.
#[must_use]
pub fn unmixed_factor(
    model: &Raster<Option<DVec3>>,
    (spread, beside_px): (PointSpread, f64),
    texel: UVec2,
) -> DVec3 {
    let Some(own) = model.at(texel) else {
        return DVec3::ONE;
    };
    let places = (0..N_PLACES).map(|k| {
        let lattice = DVec2::new(f64::from(k), f64::from(k * ROW_STEP % N_PLACES)) + 0.5;
        let side = [k, k / 2].map(|k| if k % 2 == 0 { -beside_px } else { beside_px });
        texel.as_dvec2() + spread_position(lattice / f64::from(N_PLACES), spread) + DVec2::from(side)
    });
    let inside =
        places.filter(|place| place.cmpge(DVec2::ZERO).all() && place.cmplt(model.size().as_dvec2()).all());
    let seen: Vec<DVec3> = inside.filter_map(|place| model.at(place.as_uvec2())).collect();
    if seen.is_empty() {
        return DVec3::ONE;
    }
    let mean = seen.iter().sum::<DVec3>() / seen.len() as f64;
    ((own + DARKEST_USABLE) / (mean + DARKEST_USABLE)).min(DVec3::splat(GREATEST))
}

/// The factor of codes of ten bits, each relative to the greatest one.
#[must_use]
pub fn factor_of_code(coded: DVec3) -> DVec3 {
    let [of_one, greatest] = CODES;
    let root = coded * greatest / of_one;
    root * root
}

/// The codes of a factor, before they are rounded.
#[must_use]
pub fn coded_factor(factor: DVec3) -> DVec3 {
    let [of_one, greatest] = CODES;
    let root = DVec3::from(factor.to_array().map(f64::sqrt));
    (root * of_one / greatest).min(DVec3::ONE)
}
