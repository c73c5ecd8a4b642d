//! The host's side of the contract: each struct and constant that the shaders share, as Rust lays it out.

use std::mem::{offset_of, size_of};

use app_core::gpu::layout;
use app_core::unknown;
use naga::ScalarKind;

/// A struct of `gpu/layout.rs`.
pub(crate) struct Mirror {
    pub(crate) name: &'static str,
    pub(crate) size: usize,
    pub(crate) members: Vec<Member>,
}

/// A member of a mirrored struct, on either side.
#[derive(Debug, PartialEq)]
pub(crate) struct Member {
    pub(crate) name: String,
    pub(crate) offset: usize,
    pub(crate) size: usize,
    pub(crate) kind: Option<ScalarKind>,
}

/// What a host type is made of.
trait Plain {
    /// None for a struct, whose members are compared by themselves.
    const KIND: Option<ScalarKind>;
}

impl Plain for f32 {
    const KIND: Option<ScalarKind> = Some(ScalarKind::Float);
}

impl Plain for i32 {
    const KIND: Option<ScalarKind> = Some(ScalarKind::Sint);
}

impl Plain for u32 {
    const KIND: Option<ScalarKind> = Some(ScalarKind::Uint);
}

impl<T: Plain, const N: usize> Plain for [T; N] {
    const KIND: Option<ScalarKind> = T::KIND;
}

macro_rules! plain_structs {
    ($($name:ident),*) => {$(impl Plain for layout::$name {
        const KIND: Option<ScalarKind> = None;
    })*};
}

plain_structs!(ReceiverPlane, ReceiverFit, Grid, PlateView);

fn member<T, F: Plain>(name: &str, offset: usize, _type_of: impl Fn(&T) -> F) -> Member {
    Member {
        name: name.to_owned(),
        offset,
        size: size_of::<F>(),
        kind: F::KIND,
    }
}

macro_rules! mirror {
    ($name:ident { $($field:ident),* $(,)? }) => {{
        // Does not compile when a field is missing from the list.
        let _all_fields = |layout::$name { $($field: _),* }: layout::$name| ();
        Mirror {
            name: stringify!($name),
            size: size_of::<layout::$name>(),
            members: vec![$(member(
                stringify!($field),
                offset_of!(layout::$name, $field),
                |of: &layout::$name| of.$field,
            )),*],
        }
    }};
}

/// Every struct of `gpu/layout.rs`.
pub(crate) fn mirrors() -> Vec<Mirror> {
    let mut all = mirrors_of_the_scene();
    all.extend(mirrors_of_passes());
    all
}

fn mirrors_of_the_scene() -> Vec<Mirror> {
    vec![
        mirror!(ReceiverPlane {
            plane_from_stage,
            plane_from_region_px,
            clip_from_plane,
            lights,
            reference_in_plane,
            half_extent_m
        }),
        mirror!(Globals {
            clip_from_stage,
            receivers,
            lights,
            border_px,
            camera_in_stage,
            n_lights,
            region_size_px,
            region_origin_px,
            n_receivers,
            seen_from_behind,
            _pad_1
        }),
        mirror!(ReceiverFit {
            bounce,
            share,
            contrast
        }),
        mirror!(Fit {
            gain,
            level,
            receivers,
            toy
        }),
        mirror!(FitStep {
            is_reweighted,
            n_rows,
            n_columns,
            subject,
            receiver,
            stride_px,
            is_last
        }),
        mirror!(Grid {
            origin_in_plane,
            cell_m,
            first_cell,
            size,
            _pad
        }),
        mirror!(Grids { grids }),
        mirror!(LightPoints {
            points,
            texel_px,
            n_points,
            _pad
        }),
        mirror!(PlateView {
            plate_px_from_plane,
            camera_in_plane,
            gain
        }),
        mirror!(PlateViews {
            plates,
            camera_in_plane,
            n_plates,
            is_same_view,
            _pad
        }),
    ]
}

fn mirrors_of_passes() -> Vec<Mirror> {
    vec![
        mirror!(SelfShadow {
            atlas_from_stage,
            first_tile,
            n_tiles,
            texel_m
        }),
        mirror!(Material {
            base_color_linear,
            index,
            _pad_0,
            _pad_1
        }),
        mirror!(TintGrid {
            corner_in_stage,
            cell_m,
            n_materials,
            _pad_0,
            _pad_1
        }),
        mirror!(Placement { origin_px, size_px }),
        mirror!(Published {
            light_radii,
            tallest_m,
            textured_receivers,
            is_constant,
            constant_ratio,
            eligible_margin_px,
            ring_step_px,
            n_ring_directions,
            n_rings,
            box_radius_px,
            seam_px,
            n_blocker_taps,
            n_filter_taps,
            _pad
        }),
    ]
}

/// Constants that go by one name on both sides.
pub(crate) const SHARED_CONSTANTS: &[(&str, usize)] = &[
    ("MAX_LIGHTS", layout::MAX_LIGHTS),
    ("MAX_RECEIVERS", layout::MAX_RECEIVERS),
    ("MAX_PLATES", layout::MAX_PLATES),
    ("MAX_CELLS", layout::MAX_CELLS),
    ("N_COLUMNS", layout::N_COLUMNS),
    ("MAX_TILES", layout::MAX_TILES),
    ("N_POSITIONS", layout::N_POSITIONS),
    ("COVERED_CODES", layout::COVERED_CODES),
    ("TINT_SIDE", layout::TINT_SIDE),
    ("TINT_CELLS", layout::TINT_CELLS),
    ("TINT_PYRAMID", layout::TINT_PYRAMID),
    ("N_TINT_SUMS", layout::N_TINT_SUMS),
    ("SUBJECT_RECEIVER", layout::Subject::Receiver as usize),
    ("SUBJECT_TOY", layout::Subject::Toy as usize),
    ("SUBJECT_LEVELS", layout::Subject::Levels as usize),
];

/// Fractional constants that go by one name on both sides, and the shader they are in.
pub(crate) const SHARED_FRACTIONS: &[(&str, &str, f32)] = &[
    ("fit_solve", "PRIOR_WEIGHT", layout::PRIOR_WEIGHT),
    ("fit_solve", "PRIOR_BOUNCE", layout::PRIOR_BOUNCE),
    ("fit_solve", "PRIOR_SHARE", layout::PRIOR_SHARE),
    ("composite", "UNKNOWN_NONE", unknown::UNKNOWN_NONE),
    ("composite", "UNKNOWN_ALL", unknown::UNKNOWN_ALL),
    ("composite", "SHADOW_EVENNESS", unknown::SHADOW_EVENNESS),
];
