//! The thin layer over wgpu: device and caches, textures and buffers, recording of passes,
//! readback.
//!
//! Everything on the device is created and counted here.

pub(crate) mod bindings;
pub(crate) mod buffer;
mod common;
pub mod context;
pub(crate) mod device;
mod handle;
mod lent;
pub(crate) mod meter;
pub(crate) mod pass_run;
pub(crate) mod pipeline;
mod quirks;
pub(crate) mod readback;
pub(crate) mod recorder;
pub(crate) mod resource;
pub(crate) mod samplers;
pub mod shader;
pub(crate) mod shape;
pub mod shared;
pub(crate) mod stages;
pub(crate) mod texture;
pub(crate) mod timer;
pub(crate) mod uniforms;
pub(crate) mod wgsl;
pub(crate) mod work;

pub use context::{AdapterChoice, GpuError, phone_limits};
pub use handle::DeviceHandle;
pub use lent::{LentError, LentTextures};
pub use quirks::{fault_of_pipeline_caches, fault_on_surfaces};
pub use shader::ShaderTexts;

pub(crate) use bindings::{GROUP_DRAW, GROUP_PASS, GROUP_SCENE, Resource, Slot};
pub(crate) use buffer::Buffer;
pub(crate) use context::Gpu;
pub(crate) use device::Kind;
pub(crate) use meter::Memory;
pub(crate) use pass_run::{PassGroup, PassRun, PassTime};
pub(crate) use pipeline::{Compute, ComputeSpec, Draw, DrawSpec, Pipeline, Stream, nearest_surface};
pub(crate) use recorder::{
    Attachment, Group, Recorded, Recorder, Render, cleared, loaded, n_pixels, resolved,
};
pub(crate) use samplers::Sampler;
pub(crate) use shader::{Mirrors, Shader, mirrors, shader};
pub(crate) use shared::{Mat3Columns, shared_struct};
pub(crate) use stages::{Clock, StageTime, Stages};
pub(crate) use texture::{Texture, TextureLayers, TextureView, half_float, picture_sampler};
pub(crate) use timer::Timer;
pub(crate) use work::Work;
