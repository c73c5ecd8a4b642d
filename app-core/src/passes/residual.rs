//! `residual`: what the model leaves unexplained, pooled on coarse grids.

use crate::gpu::Gpu;
use crate::gpu::encoder::Encoder;
use crate::gpu::shaders::RESIDUAL;

use crate::pool::{Pool, PoolGrids};

pub(crate) struct Residual(Pool);

pub(crate) struct ResidualInputs<'a> {
    pub(crate) on: PoolGrids<'a>,
    pub(crate) frame: &'a wgpu::TextureView,
    pub(crate) plate: &'a wgpu::TextureView,
    pub(crate) evidence: &'a wgpu::TextureView,
    pub(crate) visibility: &'a wgpu::TextureView,
    pub(crate) ambient: &'a wgpu::TextureView,
}

impl Residual {
    pub(crate) fn new(gpu: &Gpu) -> Self {
        Self(Pool::new(gpu, &RESIDUAL))
    }

    /// Pools the residual.
    pub(crate) fn encode(&self, gpu: &Gpu, encoder: &mut Encoder, inputs: &ResidualInputs<'_>) {
        let pictures = [
            inputs.frame,
            inputs.plate,
            inputs.evidence,
            inputs.visibility,
            inputs.ambient,
        ];
        self.0.encode(gpu, encoder, &inputs.on, &pictures);
    }
}
