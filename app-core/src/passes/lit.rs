//! `lit`: what the receivers look like in the light, pooled on coarse grids.

use crate::gpu::Gpu;
use crate::gpu::encoder::Encoder;
use crate::gpu::shaders::LIT;

use crate::pool::{Pool, PoolGrids};

pub(crate) struct Lit(Pool);

pub(crate) struct LitInputs<'a> {
    pub(crate) on: PoolGrids<'a>,
    pub(crate) frame: &'a wgpu::TextureView,
    pub(crate) evidence: &'a wgpu::TextureView,
    pub(crate) visibility: &'a wgpu::TextureView,
    pub(crate) ambient: &'a wgpu::TextureView,
}

impl Lit {
    pub(crate) fn new(gpu: &Gpu) -> Self {
        Self(Pool::new(gpu, &LIT))
    }

    /// Pools the lit colour.
    pub(crate) fn encode(&self, gpu: &Gpu, encoder: &mut Encoder, inputs: &LitInputs<'_>) {
        let pictures = [inputs.frame, inputs.evidence, inputs.visibility, inputs.ambient];
        self.0.encode(gpu, encoder, &inputs.on, &pictures);
    }
}
