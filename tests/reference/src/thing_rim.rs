//! CPU reference of `common/thing_rim.wgsl`: a pixel that mixes a thing and what is beyond it.

use glam::{DVec3, DVec4, IVec2, UVec2};

use super::composite::{KEEP_ALL, KEEP_NONE};
use super::model::DARKEST_USABLE;
use super::on_things::RELIT;
use super::raster::Raster;
use super::smoothstep;

/// Squared difference of colours that tells as much as the side of the mark.
const CONTRAST: f64 = 0.003;
/// Part of a pixel inside the mark that shows the thing, if colours do not tell.
const INSIDE: f64 = 0.75;

/// Pictures of a region: the frame, and the plate with alpha 1 where it is as photographed.
#[derive(Clone, Copy, Debug)]
pub struct Rims<'a> {
    /// Linear colours.
    pub frame: &'a Raster<DVec3>,
    /// Linear colours, over the gain.
    pub plate: &'a Raster<DVec4>,
    /// Exposure of the frame over that of the plate.
    pub gain: DVec3,
}

impl Rims<'_> {
    /// The pixel with `shown` beyond the thing; `steps` lead within the thing and beyond it.
    #[must_use]
    pub fn mixed(&self, texel: UVec2, steps: [IVec2; 2], shown: DVec3) -> DVec3 {
        let places = [IVec2::ZERO, steps[0], steps[1]].map(|step| (texel.as_ivec2() + step).as_uvec2());
        let [here, within, beyond] = places.map(|at| self.frame.at(at));
        let in_plate = places.map(|at| self.plate.at(at));
        let is_inside = steps[0].length_squared() < steps[1].length_squared();
        let prior = if is_inside { INSIDE } else { 1.0 - INSIDE };
        let mut rows = vec![(here - beyond, within - beyond)];
        if in_plate.iter().all(|color| color.w == 1.0) {
            let [here, within, beyond] = in_plate.map(DVec4::truncate);
            rows.push((here - beyond, within - beyond));
        }
        let along: f64 = rows.iter().map(|(own, all)| own.dot(*all)).sum();
        let whole: f64 = rows.iter().map(|(_, all)| all.length_squared()).sum();
        let part = ((along + CONTRAST * prior) / (whole + CONTRAST)).clamp(0.0, 1.0);
        let lightest = shown.max(beyond).max_element().max(DARKEST_USABLE);
        let change = (shown - beyond).abs().max_element() / lightest;
        let deviation = here - beyond.lerp(within, part);
        let kept = shown.lerp(within, part) + (1.0 - smoothstep(KEEP_ALL, KEEP_NONE, change)) * deviation;
        let kept = kept.max(DVec3::ZERO);
        let alpha = in_plate[1].w;
        if !(RELIT[0]..=RELIT[1]).contains(&alpha) {
            return kept;
        }
        let made = (alpha - RELIT[0]) / (RELIT[1] - RELIT[0]);
        kept.lerp(shown.lerp(self.gain * in_plate[1].truncate(), part), made)
    }
}
