//! The surface that a core presents on, and other targets of a screen's.

use wgpu::CurrentSurfaceTexture;

use crate::camera_frame::Display;
use crate::gpu::context::{Gpu, GpuError};
use crate::gpu::recorder::{Recorder, cleared};
use crate::passes::screen::{self, ScreenMap};
use crate::stage::Stage;

/// A configured surface.
pub(super) struct Window {
    surface: wgpu::Surface<'static>,
    config: wgpu::SurfaceConfiguration,
    screen: screen::Pass,
}

/// The finished picture.
#[derive(Clone, Copy)]
pub(super) struct Finished<'a> {
    /// Decoded where it is read.
    view: &'a wgpu::TextureView,
    size_px: [u32; 2],
}

impl<'a> Finished<'a> {
    pub(super) fn new(view: &'a wgpu::TextureView, size_px: [u32; 2]) -> Self {
        Self { view, size_px }
    }

    pub(super) fn of(stage: &'a Stage) -> Self {
        Self {
            view: stage.finished(),
            size_px: [stage.output.raw.width(), stage.output.raw.height()],
        }
    }
}

impl Window {
    pub(super) fn new(
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
        // `screen` writes sRGB codes; a surface that encodes once more would show them too bright.
        config.format = config.format.remove_srgb_suffix();
        surface.configure(&gpu.device.raw, &config);
        Ok(Self {
            screen: screen::Pass::new(gpu, config.format),
            surface,
            config,
        })
    }

    pub(super) fn resize(&mut self, gpu: &Gpu, [width, height]: [u32; 2]) {
        self.config.width = width.max(1);
        self.config.height = height.max(1);
        self.surface.configure(&gpu.device.raw, &self.config);
    }

    /// Shows `picture`, or black.
    pub(super) fn present(
        &mut self,
        gpu: &Gpu,
        picture: Option<Finished<'_>>,
        display: Display,
        paint: impl FnOnce(&Gpu, &wgpu::Texture),
    ) -> Result<(), GpuError> {
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
        match picture {
            Some(picture) => show(gpu, &self.screen, (picture, display), &texture.texture),
            None => blacken(gpu, &texture.texture),
        }
        paint(gpu, &texture.texture);
        gpu.queue.present(texture);
        Ok(())
    }
}

/// Draws a picture on a target that takes sRGB codes as they are.
pub(super) fn show(
    gpu: &Gpu,
    screen: &screen::Pass,
    (picture, display): (Finished<'_>, Display),
    target: &wgpu::Texture,
) {
    let view = gpu.device.view(target, &wgpu::TextureViewDescriptor::default());
    let image_from_screen = display.image_from_screen(picture.size_px, [target.width(), target.height()]);
    let map = ScreenMap::new(&image_from_screen, picture.size_px);
    let mut recorder = Recorder::new(gpu, None);
    screen.encode(&mut recorder, (picture.view, &map), &view);
    recorder.submit();
}

fn blacken(gpu: &Gpu, target: &wgpu::Texture) {
    let view = gpu.device.view(target, &wgpu::TextureViewDescriptor::default());
    let mut encoder = gpu.device.encoder();
    encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some("black"),
        color_attachments: &[Some(cleared(&view))],
        ..Default::default()
    });
    gpu.queue.submit([encoder.finish()]);
}
