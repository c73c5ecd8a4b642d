//! Parts of WGSL that the model's shaders join, without mirrors on the host.

use crate::gpu::shader::{Part, part};

/// Bilinear interpolation between the cells of a grid.
pub(crate) const BETWEEN_CELLS: Part = part!("common/between_cells");
/// The value of a grid at a receiver's point.
pub(crate) const CELLS: Part = part!("common/cells");
/// A plate with an estimate where none was photographed.
pub(crate) const COMPLETED: Part = part!("common/completed");
/// Accumulation of a cell over frames.
pub(crate) const ACCUMULATED: Part = part!("common/accumulated");
/// The model of a receiver: the frame as a fraction of the plate.
pub(crate) const MODEL: Part = part!("common/model");
/// Ambient light of two colours, from above and from below.
pub(crate) const HEMISPHERES: Part = part!("common/hemispheres");
/// What the receivers tell of the light on the toy.
pub(crate) const RECEIVER_LIGHT: Part = part!("common/receiver_light");
/// The fitted light on the toy.
pub(crate) const TOY_RADIANCE: Part = part!("common/toy_radiance");
