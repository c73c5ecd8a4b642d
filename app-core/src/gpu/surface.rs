//! A surface to present on.

use wgpu::CurrentSurfaceTexture;
use wgpu::util::TextureBlitter;

use super::context::{Gpu, GpuError};
use super::recorder::cleared;

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
    ) -> Result<Self, GpuError> {
        let failed = |reason: &str| GpuError::Surface {
            reason: reason.to_owned(),
        };
        let adapter = gpu
            .adapter
            .as_ref()
            .ok_or_else(|| failed("the device was opened by the caller, who presents by itself"))?;
        let mut config = surface
            .get_default_config(adapter, width.max(1), height.max(1))
            .ok_or_else(|| failed("the adapter offers no configuration for it"))?;
        // The picture holds sRGB codes; a surface that encodes once more would show them too bright.
        config.format = config.format.remove_srgb_suffix();
        surface.configure(&gpu.device.raw, &config);
        Ok(Self {
            blitter: TextureBlitter::new(&gpu.device.raw, config.format),
            surface,
            config,
        })
    }

    pub(crate) fn resize(&mut self, gpu: &Gpu, [width, height]: [u32; 2]) {
        self.config.width = width.max(1);
        self.config.height = height.max(1);
        self.surface.configure(&gpu.device.raw, &self.config);
    }

    /// Shows `picture` stretched over the surface, or black.
    pub(crate) fn present(&mut self, gpu: &Gpu, picture: Option<&wgpu::TextureView>) -> Result<(), GpuError> {
        let texture = match self.surface.get_current_texture() {
            CurrentSurfaceTexture::Success(texture) | CurrentSurfaceTexture::Suboptimal(texture) => texture,
            CurrentSurfaceTexture::Timeout | CurrentSurfaceTexture::Occluded => return Ok(()),
            CurrentSurfaceTexture::Outdated => {
                self.surface.configure(&gpu.device.raw, &self.config);
                return Ok(());
            }
            other => {
                return Err(GpuError::Surface {
                    reason: format!("{other:?}"),
                });
            }
        };
        let target = gpu
            .device
            .view(&texture.texture, &wgpu::TextureViewDescriptor::default());
        let mut encoder = gpu.device.encoder();
        match picture {
            Some(picture) => self.blitter.copy(&gpu.device.raw, &mut encoder, picture, &target),
            None => {
                encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                    label: Some("black"),
                    color_attachments: &[Some(cleared(&target))],
                    ..Default::default()
                });
            }
        }
        gpu.queue.submit([encoder.finish()]);
        gpu.queue.present(texture);
        Ok(())
    }
}
