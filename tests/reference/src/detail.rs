//! CPU reference of `detail.wgsl`: each pixel's own residual, denoised in the shadow.

use glam::{DVec3, IVec2, UVec2};

use super::model::{DARKEST_USABLE, Pictures, Region, Solution, centre_px, coarse_at};
use super::raster::Raster;
use super::smoothstep;

/// Half the side of the smoothing square, in pixels, without its centre.
const RADIUS_PX: i32 = 3;
/// Largest detail, in plates, that is only noise.
pub const NOISE: f64 = 0.03;
/// Detail, in plates, from which none of it is noise.
pub const DETAIL: f64 = 0.08;
/// Remaining light, in plates, up to which a pixel is in shadow.
const SHADOW: f64 = 0.85;
/// Remaining light, in plates, from which a pixel is unshadowed.
const LIT: f64 = 0.98;

/// The evidence of a receiver pixel clear of the toy, with a photographed plate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Evidence {
    /// Index of the receiver.
    pub receiver: usize,
    /// The model's remaining light, in plates.
    pub model: DVec3,
    /// Light that neither the model nor a reflection explains, over the gain.
    pub unexplained: DVec3,
    /// The plate, 0 in unreliable channels.
    pub plate: DVec3,
}

/// The evidence of each pixel; `photographed` is 1 where the plate was.
#[must_use]
pub fn evidence(
    region: &Region,
    pictures: &Pictures,
    photographed: &Raster<f64>,
    solution: &Solution,
) -> Raster<Option<Evidence>> {
    Raster::from_fn(region.size_px, |texel| {
        let at = centre_px(texel);
        let has_evidence = pictures.seen.at(texel) > 0.0 && photographed.at(texel) == 1.0;
        let point = region.receiver_point(at).filter(|_| has_evidence)?;
        let ambient = coarse_at(&pictures.ambient, region, at);
        let visibility = pictures.visibility.at(texel);
        let model = solution.receiver_model(region, point, ambient, visibility);
        let own = pictures.frame.at(texel) / solution.gain - region.reflected(point, visibility);
        let plate = pictures.plate.at(texel);
        let is_dark = plate.cmplt(DVec3::splat(DARKEST_USABLE));
        Some(Evidence {
            receiver: point.receiver,
            model,
            unexplained: own - plate * model,
            plate: DVec3::select(is_dark, DVec3::ZERO, plate),
        })
    })
}

/// The residual of a pixel of `receiver`, in plates.
///
/// Unshadowed, it is the pixel's own. In shadow it is a least squares fit to the surrounding pixels
/// of the same receiver against the plate, plus the part of the own difference that exceeds noise.
#[must_use]
pub fn separate(evidence: &Raster<Option<Evidence>>, (texel, receiver): (UVec2, usize)) -> DVec3 {
    let own = evidence.at(texel);
    let exact = least_squares(own.as_slice());
    // A pixel without evidence counts as unshadowed.
    let left = own.map_or(1.0, |own| own.model.max_element());
    let in_light = smoothstep(SHADOW, LIT, left);
    let reach = -RADIUS_PX..=RADIUS_PX;
    let offsets = reach
        .clone()
        .flat_map(|y| reach.clone().map(move |x| IVec2::new(x, y)));
    let around: Vec<Evidence> = offsets
        .filter_map(|offset| {
            let other = texel.as_ivec2() + offset;
            let is_within = other.cmpge(IVec2::ZERO).all() && other.cmplt(evidence.size().as_ivec2()).all();
            is_within.then(|| evidence.at(other.as_uvec2())).flatten()
        })
        .filter(|other| other.receiver == receiver)
        .collect();
    let smooth = least_squares(&around);
    let detail = exact - smooth;
    let kept = smoothstep(NOISE, DETAIL, detail.abs().max_element());
    (smooth + kept * detail).lerp(exact, in_light)
}

/// The residual r for which plate times r is the unexplained light, over all pixels together; 0
/// without evidence.
fn least_squares(pixels: &[Evidence]) -> DVec3 {
    let product: DVec3 = pixels
        .iter()
        .map(|evidence| evidence.plate * evidence.unexplained)
        .sum();
    let energy: DVec3 = pixels
        .iter()
        .map(|evidence| evidence.plate * evidence.plate)
        .sum();
    DVec3::select(energy.cmpgt(DVec3::ZERO), product / energy, DVec3::ZERO)
}
