//! Parts of WGSL that shaders of several modules join, without mirrors on the host.

use crate::gpu::shader::{Part, part};

/// Whether a receiver hides the toy.
pub(crate) const BEHIND: Part = part!("common/behind");
/// Largest and smallest channel.
pub(crate) const CHANNELS: Part = part!("common/channels");
/// Reversed depth, and which depths are of one surface.
pub(crate) const DEPTH: Part = part!("common/depth");
/// Points flattened from a light onto a receiver.
pub(crate) const FLATTEN: Part = part!("common/flatten");
/// One triangle over the whole target.
pub(crate) const FULLSCREEN: Part = part!("common/fullscreen");
/// Marks of the validity mask, which a shader binds as `validity`.
pub(crate) const MARKS: Part = part!("common/marks");
/// Whether a point of the toy has moved on the screen.
pub(crate) const MOVED: Part = part!("common/moved");
/// sRGB codes and linear light.
pub(crate) const SRGB: Part = part!("common/srgb");
/// Usable 8-bit codes.
pub(crate) const PIXEL: Part = part!("common/pixel");
