//! CPU reference of `retarget.wgsl`: the published method's picture on the receiver.

use glam::{DVec3, DVec4, IVec2, UVec2};

use super::box_filter::mean;
use super::raster::Raster;
use super::sets::LightSet;

/// The shading of a shadow.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shade {
    /// A constant ratio to the plate for each hidden light.
    Constant(f64),
    /// Sampled: ratios to the plate on a textured receiver, colours on a uniform one.
    Sampled {
        /// Whether the receiver is textured.
        is_textured: bool,
    },
}

/// The inputs of the picture, over the region. Colours are linear.
#[derive(Clone, Debug)]
pub struct Layers {
    /// The camera's frame.
    pub frame: Raster<DVec3>,
    /// The plate; `None` if no plate shows the place.
    pub plate: Raster<Option<DVec3>>,
    /// Masks 3a and 3b together: the real toy and the real shadow.
    pub mask: Raster<bool>,
    /// Visibility of each light with the shown toy.
    pub visibility: Raster<DVec4>,
    /// Sums of terms and their counts, for each set of lights from the set 1 on.
    pub terms: Vec<Raster<DVec4>>,
}

/// Linear colour of the receiver at `texel`, with a seam of `seam_px` around the masks.
#[must_use]
pub fn receiver_color(layers: &Layers, n_lights: usize, shade: Shade, seam_px: i32, texel: UVec2) -> DVec3 {
    let frame = layers.frame.at(texel);
    let Some(plate) = layers.plate.at(texel) else {
        return frame;
    };
    let lit = frame.lerp(plate, cropped(&layers.mask, seam_px, texel));
    let visibility = layers.visibility.at(texel);
    // Probability of each set if the lights were hidden independently.
    let share = |set: LightSet| -> f64 {
        (0..n_lights)
            .map(|i| {
                if set.has(i) {
                    1.0 - visibility[i]
                } else {
                    visibility[i]
                }
            })
            .product()
    };
    let sets = (0..1 << n_lights).map(LightSet);
    sets.map(|set| {
        let color = if set == LightSet::default() {
            lit
        } else {
            shaded(layers, shade, set, texel).map_or(lit, |shaded| shaded.color(plate))
        };
        share(set) * color
    })
    .sum()
}

/// 1 in the masks, falling linearly to 0 just beyond `seam_px` from them.
fn cropped(mask: &Raster<bool>, seam_px: i32, texel: UVec2) -> f64 {
    let last = mask.size().as_ivec2() - 1;
    let reach = -seam_px..=seam_px;
    let offsets = reach
        .clone()
        .flat_map(|y| reach.clone().map(move |x| IVec2::new(x, y)));
    let distances = offsets
        .filter(|offset| mask.at((texel.as_ivec2() + *offset).clamp(IVec2::ZERO, last).as_uvec2()))
        .map(|offset| offset.as_dvec2().length());
    distances
        .map(|px| 1.0 - px / f64::from(seam_px + 1))
        .fold(0.0, f64::max)
}

/// A shadow's colour, or its ratio to the plate.
enum Shaded {
    Ratio(DVec3),
    Color(DVec3),
}

impl Shaded {
    fn color(self, plate: DVec3) -> DVec3 {
        match self {
            Self::Ratio(ratio) => ratio * plate,
            Self::Color(color) => color,
        }
    }
}

/// The shadow of a set of lights: its own terms or, if it has none near, those of the most similar
/// set, the first of equally similar ones; `None` if no set has any.
fn shaded(layers: &Layers, shade: Shade, set: LightSet, texel: UVec2) -> Option<Shaded> {
    match shade {
        Shade::Constant(ratio) => {
            let n_lights = i32::try_from(set.lights().count()).ok()?;
            Some(Shaded::Ratio(DVec3::splat(ratio.powi(n_lights))))
        }
        Shade::Sampled { is_textured } => {
            let terms = (1..).map(LightSet).zip(&layers.terms);
            let known = terms.filter_map(|(other, sums)| Some((other, mean(sums.at(texel))?)));
            let (_, term) = known.min_by_key(|(other, _)| set.unlikeness(*other))?;
            Some(if is_textured {
                Shaded::Ratio(term)
            } else {
                Shaded::Color(term)
            })
        }
    }
}
