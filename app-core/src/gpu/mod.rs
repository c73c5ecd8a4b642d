//! The thin layer over wgpu: device, shaders, mirrored structs, pipelines, encoding with time stamps.

pub(crate) mod context;
pub(crate) mod encoder;
pub mod layout;
pub(crate) mod pipeline;
pub(crate) mod readback;
pub mod shaders;
pub(crate) mod texture;

pub use context::{AdapterChoice, Gpu, GpuError, phone_limits};
pub use encoder::PassTime;
