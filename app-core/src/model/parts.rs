//! Parts of WGSL that the model's shaders join, and that share nothing with the host.

use crate::gpu::shader::{Part, part};

/// Bilinear values between the cells of a grid.
pub(crate) const BETWEEN_CELLS: Part = part!("common/between_cells");
/// The value of a grid at a receiver's point.
pub(crate) const CELLS: Part = part!("common/cells");
/// What is accumulated in a cell over frames.
pub(crate) const ACCUMULATED: Part = part!("common/accumulated");
/// What a frame is, as a fraction of the plate.
pub(crate) const MODEL: Part = part!("common/model");
/// The fitted light on the toy.
pub(crate) const TOY_RADIANCE: Part = part!("common/toy_radiance");
