//! CPU reference of `composite.wgsl`: the picture on the receiver.

use glam::{DVec2, DVec3, DVec4, UVec2};

use super::grid::PlaneGrid;
use super::model::{
    BRIGHTEST_USABLE, DARKEST_USABLE, Pictures, ReceiverPoint, Region, Solution, centre_px, coarse_at,
};
use super::raster::Raster;
use super::smoothstep;

/// Change of the model, in plates, up to which a visible pixel keeps all of its own residual.
pub(super) const KEEP_ALL: f64 = 0.02;
/// Change of the model, in plates, from which a visible pixel keeps none of its own residual.
pub(super) const KEEP_NONE: f64 = 0.15;
/// Change of the model, in plates, at which half of the pooled residual remains.
const RESIDUAL_HALF: f64 = 0.5;
/// Pooled residual, in plates, up to which the model explains the pixel.
const OUTLIER_NONE: f64 = 0.15;
/// Pooled residual, in plates, from which it explains nothing: the camera's colour stays.
const OUTLIER_ALL: f64 = 0.3;
/// Ratio of the smallest and the largest channel of a residual from which it counts as a shadow.
const SHADOW_EVENNESS: f64 = 0.4;
/// The same ratio, up to which it counts as a thing of its own colour.
const OBJECT_EVENNESS: f64 = 0.2;

/// Remaining part of the receiver in the new shadow up to which a pixel is too dark, and from which
/// it is not.
const DARK: [f64; 2] = [0.1, 0.4];

/// Distance, along either axis and in pixels, of the places beside a pixel's centre at which another
/// receiver is looked for.
const BESIDE_PX: f64 = 0.75;
/// Distance of the pixels on either side of an edge that show one receiver alone.
const ALONE_PX: f64 = 2.0;
/// Squared difference of two colours of the plate, over the square of one, from which it tells both
/// apart.
const TELLS: f64 = 0.01;

/// The toy's shown pose, and learned parameters.
#[derive(Clone, Debug)]
pub struct Shown {
    /// Visibility of each light with the shown toy.
    pub visibility: Raster<DVec4>,
    /// Visibility of the ambient light with the shown toy, of any size.
    pub ambient: Raster<f64>,
    /// The fit's result.
    pub solution: Solution,
    /// Filled residuals on each receiver, in plates.
    pub residuals: Vec<Raster<DVec3>>,
    /// Positions of their cells.
    pub grids: Vec<PlaneGrid>,
    /// Up to 1 the fraction of the true shadow that is shown; beyond, the exponent of the true one.
    pub strength: f64,
}

/// The light left by a shadow of a strength, from the light `open` of which the true one leaves
/// `left`.
fn strengthened(open: DVec3, left: DVec3, strength: f64) -> DVec3 {
    let of_channel = |open: f64, left: f64| {
        if strength <= 1.0 {
            (1.0 - strength) * open + strength * left
        } else if open > 0.0 {
            let part = left / open;
            open * part.clamp(0.0, 1.0).powf(strength) * part.max(1.0)
        } else {
            0.0
        }
    };
    DVec3::from_array([0, 1, 2].map(|channel| of_channel(open[channel], left[channel])))
}

/// Linear colour of the receiver at `texel` of the region, between the camera's colour and the
/// model's: a pixel too near to the toy to be evidence has the model's.
#[must_use]
pub fn receiver_color(region: &Region, pictures: &Pictures, shown: &Shown, texel: UVec2) -> [DVec3; 2] {
    let at = centre_px(texel);
    let (frame, plate) = (pictures.frame.at(texel), pictures.plate.at(texel));
    let seen = pictures.seen.at(texel);
    let lit = shown.solution.gain * plate;
    let Some(point) = region.receiver_point(at) else {
        return [lit.lerp(frame, seen), frame];
    };
    let model_in =
        |ambient: f64, visibility: DVec4| shown.solution.receiver_model(region, point, ambient, visibility);
    let reflected = |visibility: DVec4, part: f64| {
        let reflection = region.reflection.as_ref();
        let light = reflection.map_or(DVec3::ZERO, |reflection| {
            reflection.light(point, visibility, part)
        });
        shown.solution.gain * light
    };
    let old_image = reflected(pictures.visibility.at(texel), 1.0);
    let new_image = reflected(shown.visibility.at(texel), shown.strength.min(1.0));
    let [before, left] = mixed_models(region, pictures, shown, texel);
    let open = model_in(1.0, DVec4::ONE);
    let after = strengthened(open, left, shown.strength);
    let [before, after] = [before, after].map(|model| shown_model(&shown.solution, point, model, plate));
    let darker = if shown.solution.intensities.is_empty() {
        // The strength of the shadow is unconstrained.
        let ambient = [&pictures.ambient, &shown.ambient].map(|map| coarse_at(map, region, at));
        (strengthened(DVec3::ONE, DVec3::splat(ambient[1]), shown.strength).x - ambient[0]).abs()
    } else {
        (after - before).abs().max_element()
    };
    let of_image = (new_image - old_image).abs() / lit.max(DVec3::splat(DARKEST_USABLE));
    let change = darker.max(of_image.max_element());

    let grid = &shown.grids[point.receiver];
    let pooled = grid.value_at(&shown.residuals[point.receiver], point.in_plane);
    let residual = pooled * (1.0 - smoothstep(0.0, 2.0 * RESIDUAL_HALF, change));
    let unknown = smoothstep(OUTLIER_NONE, OUTLIER_ALL, pooled.abs().max_element());
    let object = unknown * (1.0 - shadow_likeness(pooled));
    let made = lit * (after + residual).max(DVec3::ZERO) + new_image;
    let own = frame - old_image;
    let changes = lit * (after - before) + new_image - old_image;
    let kept = frame + (1.0 - object) * changes;
    let dark = darkened(own, own + lit * (after - before), lit * after) - own;
    let alone = frame + (1.0 - object) * (dark + new_image - old_image);
    let near = 1.0 - smoothstep(KEEP_ALL, KEEP_NONE, change);
    let keep = seen * near.max(unknown);

    // Whatever hides the receiver must be removed even at the border.
    let inside = inside_border(region, texel).max(1.0 - seen);
    let laid = frame.lerp(made.lerp(alone, keep), inside).max(DVec3::ZERO);
    [laid, laid.lerp(kept, (1.0 - seen) * near).max(DVec3::ZERO)]
}

/// The models of a texel with the real and the shown toy, with the ambient visibilities of a place;
/// 1 beyond all receivers.
fn models(
    region: &Region,
    pictures: &Pictures,
    shown: &Shown,
    (texel, of_ambient): (UVec2, DVec2),
) -> [DVec3; 2] {
    let Some(point) = region.receiver_point(centre_px(texel)) else {
        return [DVec3::ONE; 2];
    };
    let of = |ambient: &Raster<f64>, visibility: &Raster<DVec4>| {
        let ambient = coarse_at(ambient, region, of_ambient);
        let visibility = visibility.at(texel);
        shown.solution.receiver_model(region, point, ambient, visibility)
    };
    [
        of(&pictures.ambient, &pictures.visibility),
        of(&shown.ambient, &shown.visibility),
    ]
}

/// The same for a pixel that may show two receivers: the mean of both, weighted by their light in
/// the plate.
fn mixed_models(region: &Region, pictures: &Pictures, shown: &Shown, texel: UVec2) -> [DVec3; 2] {
    let at = centre_px(texel);
    let own = models(region, pictures, shown, (texel, at));
    match other_receiver(region, pictures, texel) {
        Some((there, part)) => {
            let other = models(region, pictures, shown, (there, at));
            [0, 1].map(|k| own[k] + part * (other[k] - own[k]))
        }
        None => own,
    }
}

/// If another receiver is beside a pixel's centre, a texel that shows that one alone, and its part of
/// the pixel's light in the plate.
#[must_use]
pub fn other_receiver(region: &Region, pictures: &Pictures, texel: UVec2) -> Option<(UVec2, DVec3)> {
    if region.receivers.len() < 2 {
        return None;
    }
    let receiver_at = |at: DVec2| region.receiver_point(at).map(|point| point.receiver);
    let at = centre_px(texel);
    let own = receiver_at(at);
    let around = [-1.0, 1.0].map(|y| [-1.0, 1.0].map(|x| DVec2::new(x, y)));
    let around = around.as_flattened().iter().copied();
    let toward: DVec2 = around
        .filter(|side| receiver_at(at + BESIDE_PX * *side) != own)
        .sum();
    if toward == DVec2::ZERO {
        return None;
    }
    let sign = |value: f64| if value == 0.0 { 0.0 } else { value.signum() };
    let step_px = ALONE_PX * DVec2::new(sign(toward.x), sign(toward.y));
    let texel_at = |at: DVec2| {
        let is_within = at.cmpge(DVec2::ZERO).all() && at.cmplt(region.size_px.as_dvec2()).all();
        is_within.then(|| at.floor().as_uvec2())
    };
    let (there, here) = (texel_at(at + step_px)?, texel_at(at - step_px)?);
    if receiver_at(centre_px(there)) == own || receiver_at(centre_px(here)) != own {
        return None;
    }
    let [b_there, b_here, b] = [there, here, texel].map(|texel| pictures.plate.at(texel));
    let differs = b_there - b_here;
    if differs.length_squared() <= TELLS * b_there.length_squared() {
        return None;
    }
    let part = ((b - b_here).dot(differs) / differs.length_squared()).clamp(0.0, 1.0);
    let other = part * b_there;
    let both = other + (1.0 - part) * b_here;
    let is_lit = both.cmpgt(DVec3::ZERO);
    Some((there, DVec3::select(is_lit, other / both, DVec3::ZERO)))
}

/// The model, and 1 if the plate is clipped and no other pixel of its receiver is visible.
fn shown_model(solution: &Solution, point: ReceiverPoint, model: DVec3, plate: DVec3) -> DVec3 {
    let clipped = solution.receivers[point.receiver].clipped;
    let shown = model + clipped * (DVec3::ONE - model);
    DVec3::select(plate.cmpgt(DVec3::splat(BRIGHTEST_USABLE)), shown, model)
}

/// 1 inside, falling to 0 towards those edges of the region that are not edges of the camera's
/// picture.
#[must_use]
pub fn inside_border(region: &Region, texel: UVec2) -> f64 {
    let [x, y] = centre_px(texel).to_array();
    let [width, height] = region.size_px.as_dvec2().to_array();
    let to_edge_px = [x, y, width - x, height - y];
    let inner_edges = to_edge_px
        .into_iter()
        .zip(region.border_px)
        .filter(|(_, fade_px)| *fade_px > 0.0);
    inner_edges.map(|(px, fade_px)| px / fade_px).fold(1.0, f64::min)
}

/// A pixel's own colour after a change of the model. Where next to nothing of the receiver in the
/// new shadow would remain, another shadow is there already.
fn darkened(own: DVec3, changed: DVec3, shadowed: DVec3) -> DVec3 {
    let left = changed / shadowed.max(DVec3::splat(DARKEST_USABLE));
    let kept = changed.max(own.min(shadowed));
    kept + smoothstep(DARK[0], DARK[1], left.min_element()) * (changed - kept)
}

/// Whether a residual may be a shadow: darker in all channels, and by similar amounts.
fn shadow_likeness(residual: DVec3) -> f64 {
    let (least, most) = (-residual.max_element(), -residual.min_element());
    if least <= 0.0 {
        return 0.0;
    }
    smoothstep(OBJECT_EVENNESS, SHADOW_EVENNESS, least / most)
}
