//! The surface on which a core presents, and other targets of a screen.

use wgpu::CurrentSurfaceTexture;

use crate::gpu::{Gpu, GpuError, Recorded, Recorder, Texture, TextureView, Timer, Work};
use crate::passes::pictures::ComposedFrame;
use crate::passes::present::OUTPUT_FORMAT;
use crate::passes::screen;
use app_scene::camera_frame::Display;

/// A target with the picture on it, to be painted over; it stores sRGB codes unchanged.
#[derive(Clone, Copy, Debug)]
pub struct Canvas<'a> {
    /// The core's device.
    pub device: &'a wgpu::Device,
    /// The device's queue. Work submitted here runs after the picture is drawn and before it is
    /// presented.
    pub queue: &'a wgpu::Queue,
    /// The target.
    pub target: &'a wgpu::Texture,
}

impl<'a> Canvas<'a> {
    /// Returns `None` without a device.
    pub(super) fn on(gpu: &'a Gpu, target: &'a wgpu::Texture) -> Option<Self> {
        let opened = gpu.opened.as_ref()?;
        Some(Self {
            device: &opened.device.raw,
            queue: &opened.queue,
            target,
        })
    }
}

/// A configured surface.
pub(super) struct Window {
    surface: wgpu::Surface<'static>,
    config: wgpu::SurfaceConfiguration,
    pub(super) screen: screen::Pass,
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
        let opened = gpu.opened.as_ref();
        let adapter = opened
            .and_then(|opened| opened.adapter.as_ref())
            .ok_or_else(|| failed("the caller has opened the device, and must present the picture itself"))?;
        let config = surface
            .get_default_config(adapter, width.max(1), height.max(1))
            .ok_or_else(|| failed("the adapter offers no configuration for it"))?;
        let config = as_shown(config);
        configure(gpu, &surface, &config);
        Ok(Self {
            screen: screen::Pass::new(gpu, config.format),
            surface,
            config,
        })
    }

    /// Format for which `screen` is compiled.
    pub(super) fn format(&self) -> wgpu::TextureFormat {
        self.config.format
    }

    pub(super) fn resize(&mut self, gpu: &Gpu, [width, height]: [u32; 2]) {
        self.config.width = width.max(1);
        self.config.height = height.max(1);
        configure(gpu, &self.surface, &self.config);
    }

    /// Presents `picture`, or black.
    pub(super) fn present(
        &mut self,
        gpu: &Gpu,
        timer: Option<&mut Timer>,
        picture: Option<ComposedFrame<'_>>,
        display: Display,
        paint: impl FnOnce(&Canvas<'_>),
    ) -> Result<(), GpuError> {
        let texture = match self.surface.get_current_texture() {
            CurrentSurfaceTexture::Success(texture) | CurrentSurfaceTexture::Suboptimal(texture) => texture,
            CurrentSurfaceTexture::Timeout | CurrentSurfaceTexture::Occluded => return Ok(()),
            CurrentSurfaceTexture::Outdated => {
                configure(gpu, &self.surface, &self.config);
                return Ok(());
            }
            CurrentSurfaceTexture::Lost => return Err(GpuError::SurfaceLost),
            other @ CurrentSurfaceTexture::Validation => {
                return Err(GpuError::Surface {
                    reason: format!("{other:?}"),
                });
            }
        };
        match picture {
            Some(picture) => {
                let recorder = Recorder::new(gpu, timer);
                show(recorder, &self.screen, &picture, display, &texture.texture);
            }
            None => blacken(gpu, &texture.texture),
        }
        if let Some(canvas) = Canvas::on(gpu, &texture.texture) {
            paint(&canvas);
        }
        if let Some(opened) = &gpu.opened {
            opened.queue.present(texture);
        }
        Ok(())
    }
}

/// Draws a picture on a target that stores sRGB codes unchanged.
pub(super) fn show(
    recorder: Recorder<'_>,
    screen: &screen::Pass,
    picture: &ComposedFrame<'_>,
    display: Display,
    target: &wgpu::Texture,
) -> Recorded {
    let target = TextureView::of_other(recorder.gpu, target);
    show_on(recorder, screen, picture, display, &target)
}

/// The cost of presenting.
pub(super) fn count(picture: &ComposedFrame<'_>, screen_px: [u32; 2], display: Display) -> Work {
    let gpu = Gpu::default();
    let target = Texture::target(&gpu, "", screen_px.into(), OUTPUT_FORMAT);
    let screen = screen::Pass::new(&gpu, OUTPUT_FORMAT);
    let recorded = show_on(Recorder::new(&gpu, None), &screen, picture, display, &target.view);
    recorded.ran.iter().map(|run| run.work).sum()
}

fn show_on(
    mut recorder: Recorder<'_>,
    screen: &screen::Pass,
    picture: &ComposedFrame<'_>,
    display: Display,
    target: &TextureView,
) -> Recorded {
    let screen_px = target.size_px().to_array();
    let image_from_screen = display.image_from_screen(picture.size_px.to_array(), screen_px);
    screen.encode(&mut recorder, picture, &image_from_screen, target);
    recorder.submit()
}

fn blacken(gpu: &Gpu, target: &wgpu::Texture) {
    let view = TextureView::of_other(gpu, target);
    let mut recorder = Recorder::new(gpu, None);
    recorder.blacken(&view);
    recorder.submit();
}

/// A surface's configuration as it is used, independent of the platform's default.
///
/// A picture waits for the display: Android offers `Mailbox` first, which draws as often as the
/// processor can, mostly pictures that are never displayed. And `screen` writes sRGB codes, which a
/// surface that encodes again would show too bright.
#[must_use]
pub fn as_shown(config: wgpu::SurfaceConfiguration) -> wgpu::SurfaceConfiguration {
    wgpu::SurfaceConfiguration {
        present_mode: wgpu::PresentMode::Fifo,
        format: config.format.remove_srgb_suffix(),
        ..config
    }
}

/// Configures a surface; the only function that does.
fn configure(gpu: &Gpu, surface: &wgpu::Surface<'static>, config: &wgpu::SurfaceConfiguration) {
    if let Some(opened) = &gpu.opened {
        surface.configure(&opened.device.raw, config);
    }
}
