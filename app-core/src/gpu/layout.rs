//! Mirrors of the WGSL structs, and nothing else. A test compares each with the shaders through naga.

use bytemuck::{Pod, Zeroable};

/// Most lights that a scene may list.
pub const MAX_LIGHTS: usize = 4;
/// Most receivers that shadows are moved on.
pub const MAX_RECEIVERS: usize = 4;
/// Most plates that a view's plate is made of.
pub const MAX_PLATES: usize = 4;
/// Most cells of a receiver's coarse grid, at its finest level.
pub const MAX_CELLS: usize = 64 * 64;
/// Most unknowns of a fit: two, and one a light.
pub const N_COLUMNS: usize = 2 + MAX_LIGHTS;
/// Sums of a fit in one channel: the upper triangle of the normal equations row by row, and their right-hand side.
pub const N_FIT_SUMS: usize = N_COLUMNS * (N_COLUMNS + 1) / 2 + N_COLUMNS;
/// Weight of the fit's priors against the energy of its first column.
pub const PRIOR_WEIGHT: f32 = 1e-4;
/// Most light points of one occlusion pass: each adds three codes, and 255 is the last.
pub const MAX_LIGHT_POINTS: usize = 64;

/// Positions within a pixel that the toy's coverage is counted over. RMS error of the area that a straight edge of any
/// direction cuts off a pixel: 0.020, where four multisample positions have 0.092.
pub const N_POSITIONS: usize = 32;
/// What each covered one adds, in codes of eight bits.
pub const COVERED_CODES: usize = 7;

/// Cells of a grid of tints along each side.
pub const TINT_SIDE: usize = 16;
/// Cells of a grid of tints.
pub const TINT_CELLS: usize = TINT_SIDE * TINT_SIDE * TINT_SIDE;
/// Cells of all levels of its pyramid: 16, 8, 4, 2 and 1 along each side, a geometric series.
pub const TINT_PYRAMID: usize = (8 * TINT_CELLS - 1) / 7;
/// Sums of a cell of tints.
pub const N_TINT_SUMS: usize = 7;

/// Most depth maps of the toy from the lights.
pub const MAX_TILES: usize = 64;

/// What the fit takes a toy to throw back until it knows better.
pub const PRIOR_BOUNCE: f32 = 0.27;
/// What the fit takes all lights' shares to sum to until it knows better.
pub const PRIOR_SHARE: f32 = 0.5;

/// A 3 x 3 matrix in uniform layout: columns on 16 bytes.
pub type Mat3Columns = [[f32; 4]; 3];

/// `ReceiverPlane` in `common/globals.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[allow(missing_docs, reason = "documented where the shader declares them")]
pub struct ReceiverPlane {
    pub plane_from_stage: [[f32; 4]; 4],
    pub plane_from_region_px: Mat3Columns,
    pub clip_from_plane: Mat3Columns,
    pub lights: [[f32; 4]; MAX_LIGHTS],
    pub reference_in_plane: [f32; 2],
    pub half_extent_m: [f32; 2],
}

/// `Globals` in `common/globals.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[allow(missing_docs, reason = "documented where the shader declares them")]
pub struct Globals {
    pub clip_from_stage: [[f32; 4]; 4],
    pub receivers: [ReceiverPlane; MAX_RECEIVERS],
    pub lights: [[f32; 4]; MAX_LIGHTS],
    pub border_px: [f32; 4],
    pub camera_in_stage: [f32; 3],
    pub n_lights: u32,
    pub region_size_px: [f32; 2],
    pub region_origin_px: [f32; 2],
    pub n_receivers: u32,
    pub seen_from_behind: u32,
    pub _pad_1: [u32; 2],
}

/// `ReceiverFit` in `common/fit.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[allow(missing_docs, reason = "documented where the shader declares them")]
pub struct ReceiverFit {
    pub bounce: [f32; 4],
    pub share: [[f32; 4]; MAX_LIGHTS],
    pub contrast: [f32; 4],
}

/// `Fit` in `common/fit.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[allow(missing_docs, reason = "documented where the shader declares them")]
pub struct Fit {
    pub gain: [f32; 4],
    pub level: [[f32; 4]; MAX_LIGHTS],
    pub receivers: [ReceiverFit; MAX_RECEIVERS],
    pub toy: [[f32; 4]; N_COLUMNS],
}

/// `FitStep` in `common/fit_step.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[allow(missing_docs, reason = "documented where the shader declares them")]
pub struct FitStep {
    pub is_reweighted: u32,
    pub n_rows: u32,
    pub n_columns: u32,
    pub subject: u32,
    pub receiver: u32,
    pub stride_px: u32,
    pub is_last: u32,
}

/// `Grid` in `common/grid.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[allow(missing_docs, reason = "documented where the shader declares them")]
pub struct Grid {
    pub origin_in_plane: [f32; 2],
    pub cell_m: f32,
    pub first_cell: u32,
    pub size: [u32; 2],
    pub _pad: [u32; 2],
}

/// `Grids` in `common/grid.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[allow(missing_docs, reason = "documented where the shader declares them")]
pub struct Grids {
    pub grids: [Grid; MAX_RECEIVERS],
}

/// `LightPoints` in `occlusion.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[allow(missing_docs, reason = "documented where the shader declares them")]
pub struct LightPoints {
    pub points: [[f32; 4]; MAX_LIGHT_POINTS * MAX_RECEIVERS],
    pub texel_px: [f32; 2],
    pub n_points: u32,
    pub _pad: u32,
}

/// `PlateView` in `plate.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[allow(missing_docs, reason = "documented where the shader declares them")]
pub struct PlateView {
    pub plate_px_from_plane: [Mat3Columns; MAX_RECEIVERS],
    pub camera_in_plane: [[f32; 4]; MAX_RECEIVERS],
    pub gain: [f32; 4],
}

/// `PlateViews` in `plate.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[allow(missing_docs, reason = "documented where the shader declares them")]
pub struct PlateViews {
    pub plates: [PlateView; MAX_PLATES],
    pub camera_in_plane: [[f32; 4]; MAX_RECEIVERS],
    pub n_plates: u32,
    pub is_same_view: u32,
    pub _pad: [u32; 2],
}

/// `SelfShadow` in `common/self_shadow.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[allow(missing_docs, reason = "documented where the shader declares them")]
pub struct SelfShadow {
    pub atlas_from_stage: [[[f32; 4]; 4]; MAX_TILES],
    pub first_tile: [u32; MAX_LIGHTS],
    pub n_tiles: [u32; MAX_LIGHTS],
    pub texel_m: [f32; MAX_LIGHTS],
}

/// `Material` in `common/material.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[allow(missing_docs, reason = "documented where the shader declares them")]
pub struct Material {
    pub base_color_linear: [f32; 4],
    pub index: u32,
    pub _pad_0: u32,
    pub _pad_1: [u32; 2],
}

/// `TintGrid` in `common/tint_grid.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[allow(missing_docs, reason = "documented where the shader declares them")]
pub struct TintGrid {
    pub corner_in_stage: [f32; 3],
    pub cell_m: f32,
    pub n_materials: u32,
    pub _pad_0: u32,
    pub _pad_1: [u32; 2],
}

/// `Placement` in `present.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
#[allow(missing_docs, reason = "documented where the shader declares them")]
pub struct Placement {
    pub origin_px: [u32; 2],
    pub size_px: [u32; 2],
}

/// `Published` in `common/published.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[allow(missing_docs, reason = "documented where the shader declares them")]
pub struct Published {
    pub light_radii: [f32; MAX_LIGHTS],
    pub tallest_m: [f32; MAX_RECEIVERS],
    pub textured_receivers: u32,
    pub is_constant: u32,
    pub constant_ratio: f32,
    pub eligible_margin_px: i32,
    pub ring_step_px: f32,
    pub n_ring_directions: u32,
    pub n_rings: u32,
    pub box_radius_px: i32,
    pub seam_px: i32,
    pub n_blocker_taps: u32,
    pub n_filter_taps: u32,
    pub _pad: u32,
}

/// What is fitted: `SUBJECT_RECEIVER`, `SUBJECT_TOY` and `SUBJECT_LEVELS` in `common/fit_step.wgsl`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub enum Subject {
    /// The receiver: gain, bounce and each light's share.
    Receiver = 0,
    /// The toy: ambient light, its gradient and each light's strength.
    Toy = 1,
    /// The frame's exposure and each light's power.
    Levels = 2,
}
