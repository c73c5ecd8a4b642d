//! Limits for the counts of a file, checked before any allocation, and ranges of its numbers.
//!
//! The ranges are far outside any real toy. They keep the arithmetic finite: in 32 bits on the GPU,
//! where squares and products of three must not overflow, and in 64 bits on the way there.

use std::ops::RangeInclusive;

/// Limit for the size of a toy's file, in bytes.
pub const MAX_FILE_BYTES: usize = 256 << 20;
/// Limit for its JSON text without data URIs: three bytes can become a node of some hundred.
pub(super) const MAX_JSON_BYTES: usize = 16 << 20;
/// Vertices of all drawn surfaces together.
pub(super) const MAX_VERTICES: usize = 4 << 20;
/// Indices of all drawn surfaces together.
pub(super) const MAX_INDICES: usize = 24 << 20;
/// Limit for the triangles of all drawn surfaces together. Each is drawn once for every point of
/// every light, with all its pixels: on a software driver a first picture takes 21 CPU seconds with
/// 200,000 small ones, and more than 41 with 2,000 that each cover the toy.
pub(super) const MAX_TRIANGLES: usize = 250_000;
/// Limit for the numbers decoded from accessors over the whole file, each four bytes in memory.
///
/// A small file can refer many times to one accessor, or to accessors without bytes.
pub(super) const MAX_DECODED_VALUES: usize = 128 << 20;
/// Nodes of the file.
pub(super) const MAX_NODES: usize = 1 << 16;
/// Joints of all skins together: each has a 16-bit index, and the last index means none.
pub(super) const MAX_JOINTS: usize = (1 << 16) - 1;
/// Morph weights of all nodes together.
pub(super) const MAX_MORPH_WEIGHTS: usize = 1 << 20;
/// Sets of four joints (`JOINTS_0`, `JOINTS_1`, …) of one vertex.
pub(super) const MAX_JOINT_SETS: u32 = 8;
/// Materials of the file, used or not: each takes 16 bytes on the device, and a draw in each pass.
pub(super) const MAX_MATERIALS: usize = 4096;
/// Width and height of a texture.
pub(super) const MAX_TEXTURE_SIDE_PX: u32 = 8192;
/// Texels of all textures together.
pub(super) const MAX_TEXELS: u64 = 64 << 20;
/// Number of poses for a clip's bounds.
pub(super) const MAX_BOUNDS_SAMPLES: usize = 1024;

/// Coordinates, offsets, scales, entries of matrices and weights of morph targets, in units of the file: a scene of
/// 1e6 m, in the smallest unit that a scene's transform of the toy may have, 1e-6 m.
pub(super) const NUMBER: RangeInclusive<f32> = -1e12..=1e12;
/// The end of [`NUMBER`], for poses from the caller and for poses in object space.
pub(super) const MAX_NUMBER: f64 = 1e12;
/// Texture coordinates. Beyond, the spacing of 32-bit numbers is a sixteenth of the picture.
pub(super) const UV: RangeInclusive<f32> = -1e6..=1e6;
/// Factors of the base colour, as glTF has them.
pub(super) const FACTOR: RangeInclusive<f32> = 0.0..=1.0;
/// Colours of vertices, which are then clamped to [`FACTOR`] as glTF requires.
pub(super) const COLOR: RangeInclusive<f32> = -1e3..=1e3;
/// Times of keys, in seconds: three hundred years, as for requested times.
pub(super) const KEY_SECS: RangeInclusive<f32> = -1e10..=1e10;
/// Coordinates of a posed toy in anchor space, in metres: the range of a scene.
pub(super) const MAX_POSED_M: f64 = 1e6;
