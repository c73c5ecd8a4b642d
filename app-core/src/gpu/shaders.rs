//! The registry of shaders: each pass's WGSL, joined from its shared parts.

/// A pass's shader.
#[derive(Clone, Copy, Debug)]
pub struct Shader {
    /// The pass's one name.
    pub name: &'static str,
    parts: &'static [&'static str],
    /// Its entry points.
    pub entry_points: &'static [&'static str],
}

impl Shader {
    /// The joined WGSL.
    #[must_use]
    pub fn source(&self) -> String {
        self.parts.join("\n")
    }
}

macro_rules! wgsl {
    ($path:literal) => {
        include_str!(concat!("../../../shaders/", $path, ".wgsl"))
    };
}

const GLOBALS: &str = wgsl!("common/globals");
const BETWEEN_TINTS: &str = wgsl!("common/between_tints");
const BEHIND: &str = wgsl!("common/behind");
const BETWEEN_CELLS: &str = wgsl!("common/between_cells");
const CHANNELS: &str = wgsl!("common/channels");
const CELLS: &str = wgsl!("common/cells");
const COVERED: &str = wgsl!("common/covered");
const DEPTH: &str = wgsl!("common/depth");
const FIT: &str = wgsl!("common/fit");
const FIT_STEP: &str = wgsl!("common/fit_step");
const FLATTEN: &str = wgsl!("common/flatten");
const FULLSCREEN: &str = wgsl!("common/fullscreen");
const GRID: &str = wgsl!("common/grid");
const HIDDEN: &str = wgsl!("common/hidden");
const KNOWN: &str = wgsl!("common/known");
const MATERIAL: &str = wgsl!("common/material");
const MODEL: &str = wgsl!("common/model");
const MOVED: &str = wgsl!("common/moved");
const PIXEL: &str = wgsl!("common/pixel");
const POOL: &str = wgsl!("common/pool");
const PUBLISHED: &str = wgsl!("common/published");
const SELF_SHADOW_MAPS: &str = wgsl!("common/self_shadow");
const TINT_CELLS: &str = wgsl!("common/tint_cells");
const TINT_GRID: &str = wgsl!("common/tint_grid");
const TOY_LIGHT: &str = wgsl!("common/toy_light");
const TOY_RADIANCE: &str = wgsl!("common/toy_radiance");

pub(crate) const SELF_SHADOW: Shader = Shader {
    name: "self_shadow",
    parts: &[GLOBALS, TOY_LIGHT, SELF_SHADOW_MAPS, wgsl!("self_shadow")],
    entry_points: &["vs_light", "fs_depth"],
};
pub(crate) const OBJECT: Shader = Shader {
    name: "object",
    parts: &[
        GLOBALS,
        TOY_LIGHT,
        SELF_SHADOW_MAPS,
        MATERIAL,
        BEHIND,
        wgsl!("object"),
    ],
    entry_points: &["vs_project", "fs_describe"],
};
pub(crate) const EVIDENCE: Shader = Shader {
    name: "evidence",
    parts: &[DEPTH, FULLSCREEN, wgsl!("evidence")],
    entry_points: &["vs_fullscreen", "fs_mark"],
};
pub(crate) const APPEARANCE: Shader = Shader {
    name: "appearance",
    parts: &[GLOBALS, FIT, TOY_RADIANCE, DEPTH, FULLSCREEN, wgsl!("appearance")],
    entry_points: &["vs_fullscreen", "fs_clean"],
};
pub(crate) const OCCLUSION: Shader = Shader {
    name: "occlusion",
    parts: &[GLOBALS, FLATTEN, HIDDEN, wgsl!("occlusion")],
    entry_points: &["vs_route", "fs_route", "vs_flatten", "fs_cover"],
};
pub(crate) const VISIBILITY: Shader = Shader {
    name: "visibility",
    parts: &[FULLSCREEN, HIDDEN, wgsl!("visibility")],
    entry_points: &["vs_fullscreen", "fs_average"],
};
pub(crate) const FIT_SUMS: Shader = Shader {
    name: "fit",
    parts: &[GLOBALS, FIT, FIT_STEP, MODEL, TOY_RADIANCE, PIXEL, wgsl!("fit")],
    entry_points: &["cs_accumulate"],
};
pub(crate) const FIT_SOLVE: Shader = Shader {
    name: "fit_solve",
    parts: &[GLOBALS, FIT, FIT_STEP, wgsl!("fit_solve")],
    entry_points: &["cs_solve"],
};
pub(crate) const RESIDUAL: Shader = Shader {
    name: "residual",
    parts: &[GLOBALS, FIT, MODEL, PIXEL, GRID, KNOWN, POOL, wgsl!("residual")],
    entry_points: &["cs_pool"],
};
pub(crate) const PLATE: Shader = Shader {
    name: "plate",
    parts: &[GLOBALS, FULLSCREEN, wgsl!("plate")],
    entry_points: &["vs_fullscreen", "fs_choose"],
};
pub(crate) const LIT: Shader = Shader {
    name: "lit",
    parts: &[GLOBALS, FIT, MODEL, CHANNELS, GRID, KNOWN, POOL, wgsl!("lit")],
    entry_points: &["cs_pool"],
};
pub(crate) const ESTIMATE: Shader = Shader {
    name: "estimate",
    parts: &[
        GLOBALS,
        FIT,
        MODEL,
        CHANNELS,
        GRID,
        BETWEEN_CELLS,
        CELLS,
        FULLSCREEN,
        wgsl!("estimate"),
    ],
    entry_points: &["vs_fullscreen", "fs_complete"],
};
pub(crate) const FILL: Shader = Shader {
    name: "fill",
    parts: &[GRID, BETWEEN_CELLS, wgsl!("fill")],
    entry_points: &["cs_pull_push"],
};
pub(crate) const TINT: Shader = Shader {
    name: "tint",
    parts: &[
        GLOBALS,
        FIT,
        TOY_RADIANCE,
        PIXEL,
        CHANNELS,
        TINT_GRID,
        TINT_CELLS,
        wgsl!("tint"),
    ],
    entry_points: &["cs_add"],
};
pub(crate) const TINT_FILL: Shader = Shader {
    name: "tint_fill",
    parts: &[PIXEL, KNOWN, TINT_CELLS, BETWEEN_TINTS, wgsl!("tint_fill")],
    entry_points: &["cs_fill"],
};
pub(crate) const MOTION: Shader = Shader {
    name: "motion",
    parts: &[GLOBALS, MOVED, BEHIND, wgsl!("motion")],
    entry_points: &["vs_physical", "fs_motion"],
};
pub(crate) const WITHHOLD: Shader = Shader {
    name: "withhold",
    parts: &[GLOBALS, FIT, MODEL, CHANNELS, FULLSCREEN, wgsl!("withhold")],
    entry_points: &["vs_fullscreen", "fs_withhold"],
};
pub(crate) const DETAIL: Shader = Shader {
    name: "detail",
    parts: &[GLOBALS, FIT, MODEL, PIXEL, CHANNELS, FULLSCREEN, wgsl!("detail")],
    entry_points: &["vs_fullscreen", "fs_separate"],
};
pub(crate) const TOY: Shader = Shader {
    name: "toy",
    parts: &[
        GLOBALS,
        FIT,
        TOY_LIGHT,
        TOY_RADIANCE,
        SELF_SHADOW_MAPS,
        MATERIAL,
        DEPTH,
        MOVED,
        CHANNELS,
        TINT_GRID,
        TINT_CELLS,
        BETWEEN_TINTS,
        BEHIND,
        wgsl!("toy"),
    ],
    entry_points: &["vs_toy", "fs_toy"],
};
pub(crate) const COVERAGE: Shader = Shader {
    name: "coverage",
    parts: &[GLOBALS, BEHIND, COVERED, wgsl!("coverage")],
    entry_points: &["vs_move", "fs_cover"],
};
pub(crate) const COMPOSITE: Shader = Shader {
    name: "composite",
    parts: &[
        GLOBALS,
        FIT,
        MODEL,
        PIXEL,
        GRID,
        BETWEEN_CELLS,
        CELLS,
        CHANNELS,
        COVERED,
        FULLSCREEN,
        wgsl!("composite"),
    ],
    entry_points: &["vs_fullscreen", "fs_compose"],
};
pub(crate) const PRESENT: Shader = Shader {
    name: "present",
    parts: &[FULLSCREEN, wgsl!("present")],
    entry_points: &["vs_fullscreen", "fs_place"],
};

pub(crate) const MASKS: Shader = Shader {
    name: "masks",
    parts: &[GLOBALS, wgsl!("masks")],
    entry_points: &["vs_object", "fs_set"],
};
pub(crate) const ELIGIBLE: Shader = Shader {
    name: "eligible",
    parts: &[GLOBALS, PUBLISHED, FULLSCREEN, wgsl!("eligible")],
    entry_points: &["vs_fullscreen", "fs_mark"],
};
pub(crate) const CENSUS: Shader = Shader {
    name: "census",
    parts: &[GLOBALS, PUBLISHED, wgsl!("census")],
    entry_points: &["cs_count"],
};
pub(crate) const WARP: Shader = Shader {
    name: "warp",
    parts: &[GLOBALS, PUBLISHED, FLATTEN, wgsl!("warp")],
    entry_points: &["vs_warp", "fs_source"],
};
pub(crate) const SEARCH: Shader = Shader {
    name: "search",
    parts: &[GLOBALS, PUBLISHED, FULLSCREEN, wgsl!("search")],
    entry_points: &["vs_fullscreen", "fs_search"],
};
pub(crate) const BOX_FILTER: Shader = Shader {
    name: "box_filter",
    parts: &[GLOBALS, PUBLISHED, FULLSCREEN, wgsl!("box_filter")],
    entry_points: &["vs_fullscreen", "fs_sum"],
};
pub(crate) const PCSS: Shader = Shader {
    name: "pcss",
    parts: &[GLOBALS, PUBLISHED, FULLSCREEN, wgsl!("pcss")],
    entry_points: &["vs_fullscreen", "fs_soften"],
};
pub(crate) const RETARGET: Shader = Shader {
    name: "retarget",
    parts: &[GLOBALS, PUBLISHED, FULLSCREEN, wgsl!("retarget")],
    entry_points: &["vs_fullscreen", "fs_receiver", "vs_toy", "fs_toy"],
};

/// Every shader there is.
pub const ALL: &[Shader] = &[
    SELF_SHADOW,
    OBJECT,
    EVIDENCE,
    APPEARANCE,
    TINT,
    TINT_FILL,
    OCCLUSION,
    VISIBILITY,
    PLATE,
    LIT,
    ESTIMATE,
    FIT_SUMS,
    FIT_SOLVE,
    RESIDUAL,
    FILL,
    WITHHOLD,
    DETAIL,
    MOTION,
    TOY,
    COVERAGE,
    COMPOSITE,
    PRESENT,
    MASKS,
    ELIGIBLE,
    CENSUS,
    WARP,
    SEARCH,
    BOX_FILTER,
    PCSS,
    RETARGET,
];
