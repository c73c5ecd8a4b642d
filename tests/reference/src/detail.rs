//! CPU reference of `detail.wgsl`: what each pixel knows of its own residual, with the noise of the shadow taken out.

use glam::{DVec3, IVec2, UVec2};

use super::model::{DARKEST_USABLE, Pictures, Region, Solution, centre_px, coarse_at};
use super::raster::Raster;
use super::smoothstep;

/// Half the side of the square that is smoothed over, in pixels, without its middle.
const RADIUS_PX: i32 = 3;
/// Detail, in plates, up to which it is noise.
pub const NOISE: f64 = 0.03;
/// Detail, in plates, from which none of it is noise.
pub const DETAIL: f64 = 0.08;
/// Light left, in plates, up to which a pixel is in shadow.
const SHADOW: f64 = 0.85;
/// Light left, in plates, from which a pixel is in the light.
const LIT: f64 = 0.98;

/// What a pixel that shows a receiver clear of the toy tells, where its plate was photographed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Told {
    /// Which receiver.
    pub receiver: usize,
    /// What the model says that is left of the plate.
    pub model: DVec3,
    /// Light that the model does not explain, over the gain.
    pub unexplained: DVec3,
    /// The plate, 0 in channels that tell nothing.
    pub plate: DVec3,
}

/// What each pixel tells; `photographed` is 1 where the plate was.
#[must_use]
pub fn told(
    region: &Region,
    pictures: &Pictures,
    photographed: &Raster<f64>,
    solution: &Solution,
) -> Raster<Option<Told>> {
    Raster::from_fn(region.size_px, |texel| {
        let at = centre_px(texel);
        let is_told = pictures.seen.at(texel) > 0.0 && photographed.at(texel) == 1.0;
        let point = region.receiver_point(at).filter(|_| is_told)?;
        let ambient = coarse_at(&pictures.ambient, region, at);
        let model = solution.receiver_model(region, point, ambient, pictures.visibility.at(texel));
        let plate = pictures.plate.at(texel);
        let is_dark = plate.cmplt(DVec3::splat(DARKEST_USABLE));
        Some(Told {
            receiver: point.receiver,
            model,
            unexplained: pictures.frame.at(texel) / solution.gain - plate * model,
            plate: DVec3::select(is_dark, DVec3::ZERO, plate),
        })
    })
}

/// The residual of a pixel of `receiver`, in plates.
///
/// In the light it is the pixel's own. In shadow it is that of the pixels around which show the same receiver, by least
/// squares against the plate, and as much of what its own differs by as is more than noise.
#[must_use]
pub fn separate(told: &Raster<Option<Told>>, (texel, receiver): (UVec2, usize)) -> DVec3 {
    let own = told.at(texel);
    let exact = least_squares(own.as_slice());
    // One that tells nothing is as in the light.
    let left = own.map_or(1.0, |own| own.model.max_element());
    let in_light = smoothstep(SHADOW, LIT, left);
    let reach = -RADIUS_PX..=RADIUS_PX;
    let offsets = reach
        .clone()
        .flat_map(|y| reach.clone().map(move |x| IVec2::new(x, y)));
    let around: Vec<Told> = offsets
        .filter_map(|offset| {
            let other = texel.as_ivec2() + offset;
            let is_within = other.cmpge(IVec2::ZERO).all() && other.cmplt(told.size().as_ivec2()).all();
            is_within.then(|| told.at(other.as_uvec2())).flatten()
        })
        .filter(|other| other.receiver == receiver)
        .collect();
    let smooth = least_squares(&around);
    let detail = exact - smooth;
    let kept = smoothstep(NOISE, DETAIL, detail.abs().max_element());
    (smooth + kept * detail).lerp(exact, in_light)
}

/// The residual r that makes plate times r the unexplained light, of all pixels together; 0 where none tells.
fn least_squares(pixels: &[Told]) -> DVec3 {
    let product: DVec3 = pixels.iter().map(|told| told.plate * told.unexplained).sum();
    let energy: DVec3 = pixels.iter().map(|told| told.plate * told.plate).sum();
    DVec3::select(energy.cmpgt(DVec3::ZERO), product / energy, DVec3::ZERO)
}
