//! Numbers as colours: the error against the truth, and the maps between input and picture.

use app_core::scene::Image;
use app_pipeline::geometry::rect::PixelRect;
use app_pipeline::readback::{FloatMap, Map};
use serde::Serialize;

pub use app_scene::geometry::color::srgb_from_linear;

/// Colours at equal steps from the lowest value to the highest, as 8-bit sRGB.
pub type Ramp = &'static [[u8; 3]];

/// Error in codes at which the ramp ends.
pub const ERROR_END_CODES: u8 = 16;
/// Even steps of lightness from black. Source: inferno of matplotlib (CC0), every 32nd colour.
pub const ERROR_RAMP: Ramp = &[
    [0, 0, 4],
    [31, 12, 72],
    [85, 15, 109],
    [136, 34, 106],
    [186, 54, 85],
    [227, 89, 51],
    [249, 140, 10],
    [249, 201, 50],
    [252, 255, 164],
];
const GRAY: Ramp = &[[0; 3], [255; 3]];
const TAPS_RAMP: Ramp = &[
    [68, 1, 84],
    [59, 82, 139],
    [33, 145, 140],
    [94, 201, 98],
    [253, 231, 37],
];
/// Blue if the model has too much light, red if it has too little.
const SIGNED_RAMP: Ramp = &[[33, 102, 172], [247, 247, 247], [178, 24, 43]];

const RECEIVER: [u8; 3] = [86, 180, 233];
const TOY: [u8; 3] = [230, 159, 0];
/// Colour of an estimated or corrected light: yellow.
pub const LIGHT_FOUND: [u8; 3] = [255, 220, 40];
/// Colour of a given light: red.
pub const LIGHT_GIVEN: [u8; 3] = [255, 40, 40];
const NOTHING: [u8; 4] = [0; 4];
/// Residual, in plates, at which the ramp ends.
const RESIDUAL_END: f32 = 0.1;
/// Candidates at which the ramp of the ring search ends.
const TAPS_END: f32 = 3200.0;

/// Presentation of a map.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Shown {
    /// Name in file names.
    pub name: &'static str,
    /// Title for the reader.
    pub title: &'static str,
    /// Caption.
    pub caption: &'static str,
    /// The meaning of its ramp; `None` if single colours have a meaning, or if the colours are a
    /// picture's.
    pub legend: Option<Legend>,
    /// Single colours and their meanings.
    pub swatches: &'static [Swatch],
}

/// The meaning of a single colour.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Swatch {
    /// The colour, as 8-bit sRGB.
    pub color: [u8; 3],
    /// Description of the map.
    pub meaning: &'static str,
}

/// The meaning of a ramp.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Legend {
    /// Meaning of the first colour.
    pub low: &'static str,
    /// Meaning of the last colour.
    pub high: &'static str,
    /// Its colours.
    pub ramp: Ramp,
}

/// Presentation of the error.
pub const ERROR: Shown = shown(
    "error",
    "Error",
    "Largest difference from the truth over red, green and blue.",
    Some(("0", "16 codes of 255 and more", ERROR_RAMP)),
);

/// Presentation of the lights.
pub const LIGHTS: Shown = shown(
    "lights",
    "Lights",
    "From the toy a ray towards each light, with a ring as wide as the light. A dashed ring is two standard deviations of the direction.",
    None,
)
.with_swatches(&[
    swatch(LIGHT_FOUND, "as found or corrected"),
    swatch(LIGHT_GIVEN, "as listed"),
]);

const fn shown(
    name: &'static str,
    title: &'static str,
    caption: &'static str,
    legend: Option<(&'static str, &'static str, Ramp)>,
) -> Shown {
    let legend = match legend {
        Some((low, high, ramp)) => Some(Legend { low, high, ramp }),
        None => None,
    };
    Shown {
        name,
        title,
        caption,
        legend,
        swatches: &[],
    }
}

const fn swatch(color: [u8; 3], meaning: &'static str) -> Swatch {
    Swatch { color, meaning }
}

impl Shown {
    const fn with_swatches(self, swatches: &'static [Swatch]) -> Self {
        Self { swatches, ..self }
    }
}

const MASK_CAPTION: &str = "Mask of the real toy in the camera frame (figure 3a of the paper).";
const ELIGIBLE_CAPTION: &str =
    "The real shadow, and where samples of it may be taken (figures 3b and 3c of the paper).";

const VALIDITY_SWATCHES: &[Swatch] = &[
    swatch(RECEIVER, "the table alone"),
    swatch(TOY, "one surface of the toy"),
    swatch([0; 3], "mixed: not used"),
];
const MASK_SWATCHES: &[Swatch] = &[
    swatch([255; 3], "the real toy"),
    swatch([0; 3], "everything else"),
];
const ELIGIBLE_SWATCHES: &[Swatch] = &[
    swatch(RECEIVER, "the real shadow"),
    swatch(TOY, "the part of it that samples are taken from"),
    swatch([0; 3], "no shadow"),
];

/// Single colours of a map, and their meanings.
const fn swatches_of(map: Map) -> &'static [Swatch] {
    match map {
        Map::Validity => VALIDITY_SWATCHES,
        Map::Masks => MASK_SWATCHES,
        Map::Eligible => ELIGIBLE_SWATCHES,
        _ => &[],
    }
}

/// Presentation of `map`; `None` for a map that is not shown.
#[must_use]
pub fn describe(map: Map) -> Option<Shown> {
    let light = Some(("hidden", "in full sight", GRAY));
    let (name, title, caption, legend) = match map {
        Map::Validity => (
            "validity",
            "Validity",
            "The content of each pixel of the camera frame, and thus its permitted uses.",
            None,
        ),
        Map::GbufferBase => (
            "gbuffer",
            "Toy as modelled",
            "Base colour of the real toy's model in its visible parts; its outline must fit the camera frame.",
            None,
        ),
        Map::GbufferReceived => (
            "received",
            "Light on the toy",
            "The light that each point of the real toy receives from each lamp, including the toy's shadow on itself; \
             three lights as red, green, blue.",
            Some(("turned away or hidden", "in full light", GRAY)),
        ),
        Map::Appearance => (
            "appearance",
            "Toy's own colours",
            "Colours of the camera frame, extrapolated beyond the outline: the paint of the moved toy.",
            None,
        ),
        Map::PhysicalVisibility => (
            "visibility-before",
            "Light, real pose",
            "The visible fraction of each light at every point of the table, past the real toy; three lights as red, green, blue.",
            light,
        ),
        Map::PhysicalAmbient => (
            "ambient-before",
            "Surroundings, real pose",
            "The visible fraction of the surroundings at every point of the table, past the real toy.",
            light,
        ),
        Map::Visibility => (
            "visibility",
            "Light, shown pose",
            "The visible fraction of each light at every point of the table, past the moved toy; three lights as red, green, blue.",
            light,
        ),
        Map::Ambient => (
            "ambient",
            "Surroundings, shown pose",
            "The visible fraction of the surroundings at every point of the table, past the moved toy.",
            light,
        ),
        Map::Residual => (
            "residual",
            "Residual",
            "The residual of the model of light and shadow, as a fraction of the plate.",
            Some(("\u{2212}0.1: darker than modelled", "+0.1: brighter", SIGNED_RAMP)),
        ),
        Map::DirectFraction => (
            "share",
            "Share of the lights (f)",
            "The share of the listed lights in the table's light, for red, green and blue; the rest is ambient. It is f in \
             the paper.",
            Some(("0: all of it is ambient", "1: all of it is from the lights", GRAY)),
        ),
        Map::Masks => ("mask", "Object mask", MASK_CAPTION, None),
        Map::Eligible => ("eligible", "Shadow masks", ELIGIBLE_CAPTION, None),
        Map::SearchTaps => (
            "taps",
            "Sample distance",
            "Candidates that the ring search looked at until it found a sample; more is farther. Empty: none was needed.",
            Some(("1", "3200 candidates, in logarithmic steps", TAPS_RAMP)),
        ),
        _ => return None,
    };
    Some(shown(name, title, caption, legend).with_swatches(swatches_of(map)))
}

/// The colour at `t` of a ramp; below 0 its first, above 1 its last.
#[expect(clippy::cast_possible_truncation, reason = "within the ramp")]
pub(crate) fn color_at(ramp: Ramp, t: f32) -> [u8; 3] {
    let last = ramp.len().saturating_sub(1);
    let position = t.clamp(0.0, 1.0) * last as f32;
    let below = (position as usize).min(last);
    let above = (below + 1).min(last);
    let share = position - below as f32;
    let channel =
        |i: usize| code(f32::from(ramp[below][i]) * (1.0 - share) + f32::from(ramp[above][i]) * share);
    [channel(0), channel(1), channel(2)]
}

/// The largest difference over the three channels of each pixel as a colour. Both pictures have the
/// same size.
#[must_use]
pub fn error(picture: &Image, truth: &Image) -> Image {
    let pairs = picture.rgba8.chunks_exact(4).zip(truth.rgba8.chunks_exact(4));
    let colors = pairs.flat_map(|(a, b)| {
        let codes = (0..3).map(|i| a[i].abs_diff(b[i])).max().unwrap_or(0);
        let t = f32::from(codes) / f32::from(ERROR_END_CODES);
        opaque(color_at(ERROR_RAMP, t))
    });
    Image {
        width_px: picture.width_px,
        height_px: picture.height_px,
        rgba8: colors.collect(),
    }
}

/// `values` of `map` as a picture of the whole frame, transparent outside of their region.
#[must_use]
pub fn picture(map: Map, values: &FloatMap, region: PixelRect, size_px: [u32; 2]) -> Image {
    let [width_px, height_px] = size_px;
    let mut rgba8 = vec![0; width_px as usize * height_px as usize * 4];
    let is_colored = values.texels.iter().any(|texel| texel[1] + texel[2] > 0.0);
    let [columns, rows] = [values.width, values.height].map(|n| n.max(1));
    let size = region.size_px.max(glam::UVec2::ONE);
    for y in 0..region.size_px.y.min(height_px.saturating_sub(region.origin_px.y)) {
        for x in 0..region.size_px.x.min(width_px.saturating_sub(region.origin_px.x)) {
            let texel = (y * rows / size.y * columns + x * columns / size.x) as usize;
            let pixel =
                (region.origin_px.y + y) as usize * width_px as usize + (region.origin_px.x + x) as usize;
            if let Some(texel) = values.texels.get(texel) {
                rgba8[pixel * 4..][..4].copy_from_slice(&color_of(map, *texel, is_colored));
            }
        }
    }
    Image {
        width_px,
        height_px,
        rgba8,
    }
}

fn color_of(map: Map, [r, g, b, a]: [f32; 4], is_colored: bool) -> [u8; 4] {
    match map {
        Map::GbufferBase | Map::Appearance if a == 0.0 => NOTHING,
        Map::GbufferBase | Map::Appearance => {
            opaque([r, g, b].map(|value| code(255.0 * srgb_from_linear(value))))
        }
        Map::Validity => two_sets(r, g, RECEIVER, TOY),
        Map::Eligible => two_sets(g, r, RECEIVER, TOY),
        Map::SearchTaps if r == 0.0 => NOTHING,
        Map::SearchTaps => opaque(color_at(TAPS_RAMP, r.max(1.0).ln() / TAPS_END.ln())),
        Map::Residual => opaque(color_at(SIGNED_RAMP, 0.5 + (r + g + b) / (6.0 * RESIDUAL_END))),
        _ if is_colored => opaque([r, g, b].map(|value| code(255.0 * value))),
        _ => opaque(color_at(GRAY, r)),
    }
}

/// Overlays the second set on the first. A part of the second, as of a surface that a soft picture mixes with
/// another one, is in it.
fn two_sets(first: f32, second: f32, first_color: [u8; 3], second_color: [u8; 3]) -> [u8; 4] {
    if second > 0.0 {
        opaque(second_color)
    } else if first > 0.5 {
        opaque(first_color)
    } else {
        opaque([0; 3])
    }
}

fn opaque([r, g, b]: [u8; 3]) -> [u8; 4] {
    [r, g, b, 255]
}

#[expect(clippy::cast_possible_truncation, reason = "rounded and kept within a byte")]
fn code(value: f32) -> u8 {
    value.round().clamp(0.0, 255.0) as u8
}
