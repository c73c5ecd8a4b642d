//! The parts of WGSL that shaders import: every file of `shaders/common`.

use super::wgsl::wgsl;

/// Names each part's path below `shaders`, without its ending, and includes its text.
macro_rules! texts {
    ($($name:literal),* $(,)?) => {
        &[$((concat!("common/", $name), wgsl!(concat!("common/", $name)))),*]
    };
}

const TEXTS: &[(&str, &str)] = texts![
    "accumulated",
    "baseline",
    "behind",
    "behind_outline",
    "between_cells",
    "between_tints",
    "borders",
    "camera_paint",
    "cells",
    "channels",
    "completed",
    "covered",
    "depth",
    "drawn_toy",
    "estimated",
    "factor_code",
    "fit",
    "fit_row",
    "fit_step",
    "fit_sums",
    "flatten",
    "frame",
    "fullscreen",
    "globals",
    "gloss",
    "grain",
    "grid",
    "hemispheres",
    "layers",
    "made_grain",
    "marks",
    "material",
    "mixed",
    "model",
    "moved",
    "no_light",
    "over_things",
    "pixel",
    "planes",
    "plate_light",
    "pool",
    "position_steps",
    "receiver_light",
    "reflectance",
    "reflection",
    "relit",
    "self_shadow",
    "shadow_strength",
    "soft_toy",
    "source",
    "spread",
    "srgb",
    "still_toy",
    "stillness",
    "thing_marks",
    "thing_rim",
    "tiles",
    "tint_cells",
    "tint_grid",
    "toy_light",
    "toy_point",
    "toy_radiance",
    "two_receivers",
    "unknown",
    "unmixed",
];

/// The WGSL of a part; `None` if there is no such part.
pub(super) fn text(path: &str) -> Option<&'static str> {
    let part = TEXTS.iter().find(|(of, _)| *of == path);
    part.map(|(_, text)| *text)
}
