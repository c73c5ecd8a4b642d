//! `plate`: the plate as this camera would have taken it.

use wgpu::TextureFormat;

use crate::gpu::Gpu;
use crate::gpu::encoder::Encoder;
use crate::gpu::layout::PlateViews;
use crate::gpu::pipeline::{GROUP_GLOBALS, GROUP_PASS, view};
use crate::gpu::shaders::PLATE;

/// Format of a plate: finer than codes, since gains have been applied; alpha tells a photographed pixel.
pub(crate) const PLATE_FORMAT: TextureFormat = TextureFormat::Rgba16Float;

pub(crate) struct Plate {
    pipeline: wgpu::RenderPipeline,
}

impl Plate {
    pub(crate) fn new(gpu: &Gpu) -> Self {
        Self {
            pipeline: gpu.fullscreen_pipeline(&PLATE, "fs_choose", PLATE_FORMAT, &[]),
        }
    }

    /// `plates` is an array of pictures, in the order of `views`.
    pub(crate) fn encode(
        &self,
        gpu: &Gpu,
        encoder: &mut Encoder,
        globals: &wgpu::Buffer,
        (views, plates): (&PlateViews, &wgpu::TextureView),
        target: &wgpu::TextureView,
    ) {
        let layout = |group| self.pipeline.get_bind_group_layout(group);
        let shared = gpu.bind(&layout(GROUP_GLOBALS), &[(0, globals.as_entire_binding())]);
        let uniform = gpu.uniform("plate views", views);
        let own = gpu.bind(
            &layout(GROUP_PASS),
            &[(0, uniform.as_entire_binding()), (1, view(plates))],
        );
        let groups = [(GROUP_GLOBALS, &shared), (GROUP_PASS, &own)];
        encoder.fullscreen(PLATE.name, &self.pipeline, &groups, target);
    }
}
