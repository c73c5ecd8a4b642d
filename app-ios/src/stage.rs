//! The app and its layer: created once, without a surface in the background.

use std::sync::Arc;

use app_core::live::Live;
use app_core::preset::Preset;
use app_core::toy::{Toy, ToyError};
use app_core::wgpu::{self, SurfaceTargetUnsafe};
use app_core::{Core, CoreError};
use app_shell::record::clock;
use app_shell::toys::BUNDLED;
use objc2::Message;
use objc2::rc::Retained;
use objc2_quartz_core::{CALayer, CAMetalLayer};

/// Frame rate of the camera and of the screen.
const FRAMES_PER_S: u32 = 60;

/// The reason why nothing can be drawn.
#[derive(Debug, thiserror::Error)]
pub(crate) enum StageError {
    /// The view is not backed by a Metal layer.
    #[error("the view's layer is not a CAMetalLayer")]
    NotMetal,
    /// Metal refused the layer.
    #[error("no surface on the view's layer: {0}")]
    Surface(#[from] wgpu::CreateSurfaceError),
    /// The core could not start or continue.
    #[error(transparent)]
    Core(#[from] CoreError),
    /// The initial toy cannot be read.
    #[error(transparent)]
    Toy(#[from] ToyError),
}

/// The result of fitting the app to a layer.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Fitted {
    /// The app is a new one, which has no state yet.
    Anew,
    /// The app is the previous one.
    Again,
}

/// Owns the app and lends it the view's layer.
pub(crate) struct Stage {
    instance: wgpu::Instance,
    live: Option<Live>,
    has_surface: bool,
}

impl Stage {
    /// A stage without an app, which comes with the first fit.
    pub(crate) fn new() -> Self {
        let descriptor = wgpu::InstanceDescriptor::new_without_display_handle();
        Self {
            instance: wgpu::Instance::new(descriptor),
            live: None,
            has_surface: false,
        }
    }

    /// Lets the app draw on `layer` in the given size: creates, continues or resizes it, as needed.
    /// Creating it blocks the main thread until there is a device; pipelines are compiled one per
    /// picture.
    pub(crate) fn fit(&mut self, layer: &CALayer, size_px: [u32; 2]) -> Result<Fitted, StageError> {
        let mut fitted = Fitted::Again;
        match &mut self.live {
            Some(live) if self.has_surface => live.core_mut().resize(size_px),
            Some(live) => live
                .core_mut()
                .resume(surface_on(&self.instance, layer)?, size_px)?,
            None => {
                let toy = Arc::new(Toy::from_glb("toy.glb", BUNDLED)?);
                let core = core_on(&self.instance, layer, size_px)?;
                let mut live = Live::new(core, toy, Preset::default());
                live.set_clock(clock());
                live.set_target_fps(FRAMES_PER_S);
                self.live = Some(live);
                fitted = Fitted::Anew;
            }
        }
        self.has_surface = true;
        Ok(fitted)
    }

    /// Opens another device on `layer`, after the previous one was lost.
    pub(crate) fn reopen(&mut self, layer: &CALayer, size_px: [u32; 2]) -> Result<(), StageError> {
        if let Some(live) = &mut self.live {
            // A layer has one surface at a time.
            live.core_mut().suspend();
            live.reopen(core_on(&self.instance, layer, size_px)?);
            self.has_surface = true;
        }
        Ok(())
    }

    /// Drops the surface; the app keeps device, pipelines and estimates.
    pub(crate) fn suspend(&mut self) {
        if let Some(live) = &mut self.live {
            live.core_mut().suspend();
        }
        self.has_surface = false;
    }

    /// The app, once there is one.
    pub(crate) fn live(&mut self) -> Option<&mut Live> {
        self.live.as_mut()
    }

    /// Whether the app has a surface.
    pub(crate) fn has_surface(&self) -> bool {
        self.has_surface
    }

    /// Drops the app with everything it holds.
    pub(crate) fn clear(&mut self) {
        self.has_surface = false;
        self.live = None;
    }
}

fn core_on(instance: &wgpu::Instance, layer: &CALayer, size_px: [u32; 2]) -> Result<Core, StageError> {
    let surface = surface_on(instance, layer)?;
    Ok(pollster::block_on(Core::on_surface(instance, surface, size_px))?)
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
