//! A surface to present on.

use wgpu::CurrentSurfaceTexture;
use wgpu::util::TextureBlitter;

use crate::core::CoreError;
use crate::gpu::Gpu;

/// A configured surface.
pub(crate) struct Window {
    surface: wgpu::Surface<'static>,
    config: wgpu::SurfaceConfiguration,
    blitter: TextureBlitter,
}

impl Window {
    pub(crate) fn new(
        gpu: &Gpu,
        surface: wgpu::Surface<'static>,
        [width, height]: [u32; 2],
    ) -> Result<Self, CoreError> {
        let failed = |reason: &str| CoreError::Surface {
            reason: reason.to_owned(),
        };
        let mut config = surface
            .get_default_config(&gpu.adapter, width.max(1), height.max(1))
            .ok_or_else(|| failed("the adapter offers no configuration for it"))?;
        // The picture holds codes; a surface that encodes once more would show them too bright.
        config.format = config.format.remove_srgb_suffix();
        surface.configure(&gpu.device, &config);
        Ok(Self {
            blitter: TextureBlitter::new(&gpu.device, config.format),
            surface,
            config,
        })
    }

    pub(crate) fn resize(&mut self, gpu: &Gpu, [width, height]: [u32; 2]) {
        self.config.width = width.max(1);
        self.config.height = height.max(1);
        self.surface.configure(&gpu.device, &self.config);
    }

    /// Shows `picture` stretched over the surface, or black.
    pub(crate) fn present(
        &mut self,
        gpu: &Gpu,
        picture: Option<&wgpu::TextureView>,
    ) -> Result<(), CoreError> {
        let texture = match self.surface.get_current_texture() {
            CurrentSurfaceTexture::Success(texture) | CurrentSurfaceTexture::Suboptimal(texture) => texture,
            CurrentSurfaceTexture::Timeout | CurrentSurfaceTexture::Occluded => return Ok(()),
            CurrentSurfaceTexture::Outdated => {
                self.surface.configure(&gpu.device, &self.config);
                return Ok(());
            }
            other => {
                return Err(CoreError::Surface {
                    reason: format!("{other:?}"),
                });
            }
        };
        let target = texture
            .texture
            .create_view(&wgpu::TextureViewDescriptor::default());
        let mut encoder = gpu
            .device
            .create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        match picture {
            Some(picture) => self.blitter.copy(&gpu.device, &mut encoder, picture, &target),
            None => {
                encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                    label: Some("black"),
                    color_attachments: &[Some(crate::gpu::encoder::cleared(&target))],
                    ..Default::default()
                });
            }
        }
        gpu.queue.submit([encoder.finish()]);
        gpu.queue.present(texture);
        Ok(())
    }
}
