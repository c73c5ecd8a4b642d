//! The shell and its window: the app is created with the first window, then moved from window to
//! window.

use std::path::PathBuf;
use std::time::{Duration, Instant};

use android_activity::AndroidApp;
use app_core::app::{Language, LaunchHistory, Panics, ShellEvent};
use app_core::interface::{Touch, of_closed, of_no_graphics};
use app_core::live::Live;
use app_core::preset::Preset;
use app_core::toy::ToyError;
use app_core::wgpu::{self, rwh};
use app_core::{Core, CoreError};
use app_shell::{pipelines, starts};
use arcore::feed::Feed;
use arcore::library;
use ndk::native_window::NativeWindow;

use crate::input::{BackKey, screen};
use crate::java::{Activity, font_scale};
use crate::phone::Phone;
use crate::shell::{Shell, bundled_toy};
use app_shell::guard::guarded;

/// The reason why nothing can be drawn.
#[derive(Debug, thiserror::Error)]
pub(crate) enum StageError {
    /// Vulkan refused the window.
    #[error("no surface on the activity's window: {0}")]
    Surface(#[from] wgpu::CreateSurfaceError),
    /// The core could not start or continue.
    #[error(transparent)]
    Core(#[from] CoreError),
    /// The bundled toy is invalid.
    #[error(transparent)]
    Toy(#[from] ToyError),
    /// Several apps in succession were ended by a panic.
    #[error("panics came one after the other")]
    Panics,
}

impl StageError {
    /// Text for the person, who no longer sees a picture.
    pub(crate) fn words(&self, language: Language) -> &'static str {
        match self {
            Self::Core(error) => of_no_graphics(error, language),
            Self::Surface(_) | Self::Toy(_) | Self::Panics => of_closed(language),
        }
    }
}

/// Owns the shell and lends it the activity's current window.
pub(crate) struct Stage {
    app: AndroidApp,
    instance: wgpu::Instance,
    start: Instant,
    text_scale: f32,
    shell: Option<Shell<Activity>>,
    window: Option<NativeWindow>,
    is_foreground: bool,
    panics: Panics,
    is_restarted: bool,
    /// The app's own folder, and whether the driver is trusted with a cache of compiled pipelines
    /// that is kept there.
    own: Option<PathBuf>,
    trusts_pipelines: bool,
    back_key: BackKey,
}

impl Stage {
    /// A stage without window and app; the app comes with the first window.
    pub(crate) fn new(app: AndroidApp) -> Self {
        let descriptor = wgpu::InstanceDescriptor::new_with_display_handle(Box::new(AndroidDisplay));
        Self {
            text_scale: font_scale(&app),
            app,
            instance: wgpu::Instance::new(descriptor),
            start: Instant::now(),
            shell: None,
            window: None,
            is_foreground: false,
            panics: Panics::default(),
            is_restarted: false,
            own: None,
            trusts_pipelines: false,
            back_key: BackKey::default(),
        }
    }

    /// Handles the result of a guarded callback. After a panic the app is dropped; the next picture
    /// begins a new one.
    pub(crate) fn settle(&mut self, outcome: Option<Result<(), StageError>>) -> Result<(), StageError> {
        if let Some(outcome) = outcome {
            return outcome;
        }
        let shell = self.shell.take();
        guarded("dropping the app", || drop(shell));
        self.is_restarted = true;
        if self.panics.begins_anew(self.start.elapsed().as_secs_f64()) {
            Ok(())
        } else {
            Err(StageError::Panics)
        }
    }

    /// Time for which the loop may sleep; `None` until an event.
    pub(crate) fn sleep(&mut self) -> Option<Duration> {
        let (now, draws) = (self.start.elapsed(), self.draws());
        let slept = self
            .shell
            .as_mut()
            .map_or(Duration::ZERO, |shell| shell.pace().sleep(now));
        draws.then_some(slept)
    }

    /// The phone's own back key is pressed.
    pub(crate) fn press_back(&mut self) {
        self.back_key.press();
    }

    /// It will not be released here.
    pub(crate) fn cancel_back(&mut self) {
        self.back_key.cancel();
    }

    /// It is released: the app goes back, or the activity is finished.
    pub(crate) fn release_back(&mut self) {
        if !self.back_key.release() {
            return;
        }
        match &mut self.shell {
            Some(shell) => shell.back(),
            None => Activity::new(self.app.clone()).leave(),
        }
    }

    /// Whether pictures are to be drawn.
    pub(crate) fn draws(&self) -> bool {
        self.is_foreground && self.window.is_some()
    }

    /// Creates the app on `window`, or lets the existing one continue there. Creating it blocks the loop, and with it
    /// the next life cycle change, until there is a device; its pipelines are compiled picture by picture.
    pub(crate) fn attach(&mut self, window: NativeWindow) -> Result<(), StageError> {
        let size = size_px(&window);
        match &mut self.shell {
            Some(shell) => {
                let surface = surface_on(&self.instance, &window)?;
                shell.live().core_mut().resume(surface, size)?;
            }
            None => {
                let phone = Activity::new(self.app.clone());
                // Before the first call of a driver.
                let starts = phone
                    .own_folder()
                    .map(|folder| starts::begin(&folder, cfg!(debug_assertions)));
                self.own = phone.own_folder();
                self.trusts_pipelines = starts.as_ref().is_some_and(LaunchHistory::is_first_try);
                let core = self.core_on(&window)?;
                let live = Live::new(core, bundled_toy()?, Preset::default());
                let api = library::load();
                let api = api.inspect_err(|error| eprintln!("app-android: no ARCore: {error}"));
                let mut shell = Shell::new(live, phone, Feed::new(api.ok()));
                if std::mem::take(&mut self.is_restarted) {
                    shell.tell(ShellEvent::Restarted);
                }
                if let Some(starts) = starts {
                    shell.tell(ShellEvent::Started(starts));
                }
                shell.set_foreground(self.is_foreground);
                self.shell = Some(shell);
            }
        }
        self.window = Some(window);
        if let Some(shell) = &mut self.shell {
            shell.set_surface(Some(size));
        }
        Ok(())
    }

    /// Drops surface and window; the core keeps device, pipelines and estimates.
    pub(crate) fn detach(&mut self) {
        // Taken first: the window is dropped even if suspending the core panics.
        let _window = self.window.take();
        if let Some(shell) = &mut self.shell {
            shell.live().core_mut().suspend();
            shell.set_surface(None);
        }
    }

    /// Follows a change of the window's size.
    pub(crate) fn resize(&mut self) {
        if let (Some(shell), Some(window)) = (&mut self.shell, &self.window) {
            let size = size_px(window);
            shell.live().core_mut().resize(size);
            shell.set_surface(Some(size));
        }
    }

    /// The activity came to the foreground, or left it.
    pub(crate) fn set_foreground(&mut self, is_foreground: bool) {
        self.is_foreground = is_foreground;
        if let Some(shell) = &mut self.shell {
            shell.set_foreground(is_foreground);
        }
    }

    /// Memory is short.
    pub(crate) fn memory_low(&mut self) {
        if let Some(shell) = &mut self.shell {
            shell.tell(ShellEvent::MemoryLow);
        }
    }

    /// Passes a touch on.
    pub(crate) fn touch(&mut self, touch: Touch) {
        if let Some(shell) = &mut self.shell {
            shell.live().touch(touch);
            shell.pace().touched();
        }
    }

    /// Draws one picture, if there is a window; a lost app or core is created anew before.
    pub(crate) fn present(&mut self) -> Result<(), StageError> {
        if let (None, Some(window)) = (&self.shell, self.window.clone()) {
            self.attach(window)?;
        }
        let (Some(mut shell), Some(window)) = (self.shell.take(), self.window.clone()) else {
            return Ok(());
        };
        // A panic on the way drops the app, as intended.
        let drawn = self.draw(&mut shell, &window);
        self.shell = Some(shell);
        drawn
    }

    fn draw(&mut self, shell: &mut Shell<Activity>, window: &NativeWindow) -> Result<(), StageError> {
        if shell.take_wants_device() {
            // A window has one surface at a time.
            shell.live().core_mut().suspend();
            let core = self.core_on(window)?;
            shell.live().reopen(core);
        } else if shell.take_wants_surface() {
            shell.live().core_mut().suspend();
            let surface = surface_on(&self.instance, window)?;
            shell.live().core_mut().resume(surface, size_px(window))?;
        }
        shell.tick();
        let now = self.start.elapsed();
        if !shell.pace().is_due(now) {
            return Ok(());
        }
        shell.pace().draw(now);
        let content = self.app.content_rect();
        let content_px = [content.left, content.top, content.right, content.bottom];
        let screen = screen(
            size_px(window),
            self.app.config().density(),
            shell.phone().insets_px(),
            content_px,
            self.text_scale,
        );
        shell.present(&screen, self.start.elapsed().as_secs_f64());
        Ok(())
    }

    fn core_on(&self, window: &NativeWindow) -> Result<Core, StageError> {
        let surface = surface_on(&self.instance, window)?;
        let core = pollster::block_on(Core::on_surface(&self.instance, surface, size_px(window)))?;
        let own = self.own.as_ref().filter(|_| self.trusts_pipelines);
        if let (Some(own), Some(device), Some(key)) = (own, core.device(), core.pipelines_key())
            && let pipelines::Start::Cached(data) = pipelines::begin(own, &key)
        {
            let descriptor = wgpu::PipelineCacheDescriptor {
                label: Some("kept"),
                data: data.as_deref(),
                fallback: true,
            };
            // SAFETY: the data were returned by wgpu to an earlier start, by the same version,
            // device and driver, and are complete: they are stored with a checksum.
            core.set_pipeline_cache(unsafe { device.raw().create_pipeline_cache(&descriptor) });
        }
        Ok(core)
    }
}

/// The surface owns its own reference to the window and so cannot outlive it.
fn surface_on(
    instance: &wgpu::Instance,
    window: &NativeWindow,
) -> Result<wgpu::Surface<'static>, StageError> {
    let target = wgpu::SurfaceTarget::from_window_without_display(window.clone());
    Ok(instance.create_surface(target)?)
}

/// Width and height, at least one pixel each: at a bad moment the window answers with a negative
/// number, and no surface can be empty.
fn size_px(window: &NativeWindow) -> [u32; 2] {
    [window.width(), window.height()].map(|side_px| u32::try_from(side_px).unwrap_or(1).max(1))
}

/// Android has only one display connection, which wgpu requires explicitly.
#[derive(Debug)]
struct AndroidDisplay;

impl rwh::HasDisplayHandle for AndroidDisplay {
    fn display_handle(&self) -> Result<rwh::DisplayHandle<'_>, rwh::HandleError> {
        Ok(rwh::DisplayHandle::android())
    }
}
