//! Upper bounds on what a file may ask for, checked before anything is allocated.

/// Size of a toy's file.
pub(super) const MAX_FILE_BYTES: usize = 256 << 20;
/// Its JSON chunk, of which three bytes can become a node of some hundred.
pub(super) const MAX_JSON_BYTES: usize = 16 << 20;
/// Vertices of all drawn surfaces together.
pub(super) const MAX_VERTICES: usize = 4 << 20;
/// Indices of all drawn surfaces together.
pub(super) const MAX_INDICES: usize = 24 << 20;
/// Numbers decoded from accessors over the whole file, each four bytes in memory.
///
/// A small file can point many times at one accessor, or at accessors without any bytes behind them.
pub(super) const MAX_DECODED_VALUES: usize = 128 << 20;
/// Nodes of the file.
pub(super) const MAX_NODES: usize = 1 << 16;
/// Joints of all skins together: each has a 16-bit index, of which the last means none.
pub(super) const MAX_JOINTS: usize = (1 << 16) - 1;
/// Morph weights of all nodes together.
pub(super) const MAX_MORPH_WEIGHTS: usize = 1 << 20;
/// Sets of four joints (`JOINTS_0`, `JOINTS_1`, …) that one vertex may follow.
pub(super) const MAX_JOINT_SETS: u32 = 8;
/// Width and height of a texture.
pub(super) const MAX_TEXTURE_SIDE_PX: u32 = 8192;
/// Texels of all textures together.
pub(super) const MAX_TEXELS: u64 = 64 << 20;
/// Poses that a clip's bounds are taken from.
pub(super) const MAX_BOUNDS_SAMPLES: usize = 1024;
