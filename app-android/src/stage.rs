//! The core and the window it draws on: created once, then moved from window to window.

use app_core::camera_frame::Display;
use app_core::wgpu::{self, rwh};
use app_core::{Core, CoreError};
use ndk::native_window::NativeWindow;

/// Why there is nothing to draw with.
#[derive(Debug, thiserror::Error)]
pub(crate) enum StageError {
    /// Vulkan refused the window.
    #[error("no surface on the activity's window: {0}")]
    Surface(#[from] wgpu::CreateSurfaceError),
    /// The core could not start, continue or present.
    #[error(transparent)]
    Core(#[from] CoreError),
}

/// Owns the core and lends it the activity's current window.
pub(crate) struct Stage {
    instance: wgpu::Instance,
    core: Option<Core>,
    window: Option<NativeWindow>,
}

impl Stage {
    /// A stage without window and core; the core comes with the first window.
    pub(crate) fn new() -> Self {
        let descriptor = wgpu::InstanceDescriptor::new_with_display_handle(Box::new(AndroidDisplay));
        Self {
            instance: wgpu::Instance::new(descriptor),
            core: None,
            window: None,
        }
    }

    /// Whether the core has a window to draw on.
    pub(crate) fn has_window(&self) -> bool {
        self.window.is_some()
    }

    /// Creates the core on `window`, or lets the existing core continue there. Creating it blocks the loop, and with it
    /// the next life cycle change, until device and pipelines exist.
    pub(crate) fn attach(&mut self, window: NativeWindow) -> Result<(), StageError> {
        // The surface owns its own reference to the window and so cannot outlive it.
        let target = wgpu::SurfaceTarget::from_window_without_display(window.clone());
        let surface = self.instance.create_surface(target)?;
        match &mut self.core {
            Some(core) => core.resume(surface, size_px(&window))?,
            None => {
                let core = Core::on_surface(&self.instance, surface, size_px(&window));
                self.core = Some(pollster::block_on(core)?);
            }
        }
        self.window = Some(window);
        Ok(())
    }

    /// Drops surface and window; the core keeps device, pipelines and what it has learned.
    pub(crate) fn detach(&mut self) {
        if let Some(core) = &mut self.core {
            core.suspend();
        }
        self.window = None;
    }

    /// Follows a change of the window's size.
    pub(crate) fn resize(&mut self) {
        if let (Some(core), Some(window)) = (&mut self.core, &self.window) {
            core.resize(size_px(window));
        }
    }

    /// Presents one frame, where there is a window.
    pub(crate) fn present(&mut self) -> Result<(), StageError> {
        match (&mut self.core, &self.window) {
            (Some(core), Some(_)) => Ok(core.present(Display::default())?),
            _ => Ok(()),
        }
    }
}

/// Width and height, at least one pixel each: the window answers a question at a bad moment with a negative number,
/// and no surface can be empty.
fn size_px(window: &NativeWindow) -> [u32; 2] {
    [window.width(), window.height()].map(|side_px| u32::try_from(side_px).unwrap_or(1).max(1))
}

/// Android has one display connection, and wgpu wants it named.
#[derive(Debug)]
struct AndroidDisplay;

impl rwh::HasDisplayHandle for AndroidDisplay {
    fn display_handle(&self) -> Result<rwh::DisplayHandle<'_>, rwh::HandleError> {
        Ok(rwh::DisplayHandle::android())
    }
}
