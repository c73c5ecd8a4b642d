//! The core and the layer it draws on: created once, without a surface in the background.

use app_core::camera_frame::Display;
use app_core::wgpu::{self, SurfaceTargetUnsafe};
use app_core::{Core, CoreError};
use objc2::Message;
use objc2::rc::Retained;
use objc2_quartz_core::{CALayer, CAMetalLayer};

/// Why there is nothing to draw with.
#[derive(Debug, thiserror::Error)]
pub(crate) enum StageError {
    /// The view is not backed by a Metal layer.
    #[error("the view's layer is not a CAMetalLayer")]
    NotMetal,
    /// Metal refused the layer.
    #[error("no surface on the view's layer: {0}")]
    Surface(#[from] wgpu::CreateSurfaceError),
    /// The core could not start, continue or present.
    #[error(transparent)]
    Core(#[from] CoreError),
}

/// Owns the core and lends it the view's layer.
pub(crate) struct Stage {
    instance: wgpu::Instance,
    core: Option<Core>,
    has_surface: bool,
}

impl Stage {
    /// A stage without core; the core comes with the first fit.
    pub(crate) fn new() -> Self {
        let descriptor = wgpu::InstanceDescriptor::new_without_display_handle();
        Self {
            instance: wgpu::Instance::new(descriptor),
            core: None,
            has_surface: false,
        }
    }

    /// Lets the core draw on `layer` in the given size: creates it, continues it, or resizes it, whichever is due.
    /// Creating it blocks the main thread until device and pipelines exist.
    pub(crate) fn fit(&mut self, layer: &CALayer, size_px: [u32; 2]) -> Result<(), StageError> {
        match &mut self.core {
            Some(core) if self.has_surface => core.resize(size_px),
            Some(core) => core.resume(surface_on(&self.instance, layer)?, size_px)?,
            None => {
                let surface = surface_on(&self.instance, layer)?;
                let core = pollster::block_on(Core::on_surface(&self.instance, surface, size_px))?;
                self.core = Some(core);
            }
        }
        self.has_surface = true;
        Ok(())
    }

    /// Drops the surface; the core keeps device, pipelines and what it has learned.
    pub(crate) fn suspend(&mut self) {
        if let Some(core) = &mut self.core {
            core.suspend();
        }
        self.has_surface = false;
    }

    /// Presents one frame, where there is a surface.
    pub(crate) fn present(&mut self) -> Result<(), StageError> {
        match &mut self.core {
            Some(core) if self.has_surface => Ok(core.present(Display::default())?),
            _ => Ok(()),
        }
    }

    /// Drops the core with all it holds.
    pub(crate) fn clear(&mut self) {
        self.has_surface = false;
        self.core = None;
    }
}

/// A surface on the view's own layer.
fn surface_on(instance: &wgpu::Instance, layer: &CALayer) -> Result<wgpu::Surface<'static>, StageError> {
    let layer: Retained<CAMetalLayer> = layer
        .retain()
        .downcast::<CAMetalLayer>()
        .map_err(|_| StageError::NotMetal)?;
    let target = SurfaceTargetUnsafe::CoreAnimationLayer(Retained::as_ptr(&layer).cast_mut().cast());
    // SAFETY: the pointer is a live CAMetalLayer, and the surface retains it for as long as it exists.
    Ok(unsafe { instance.create_surface_unsafe(target) }?)
}
