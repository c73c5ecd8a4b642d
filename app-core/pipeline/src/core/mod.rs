//! [`Core`]: the central type that a shell or a program holds.

mod error;
mod fit_warnings;
pub mod inspect;
mod layers;
mod preview;
mod shaders;
mod warm_up;
mod window;

use std::sync::Arc;

use crate::frame::FrameReport;
use crate::governor::QualityStep;
use crate::gpu::{
    AdapterChoice, Clock, DeviceHandle, Gpu, GpuError, PassTime, Recorder, Stages, Texture, Timer, Work,
};
use crate::model::Model;
use crate::passes::pictures::ComposedFrame;
use crate::passes::present::OUTPUT_FORMAT;
use crate::passes::screen;
use crate::preset::Settings;
use crate::stage::Stage;
use crate::stage::method::Method;
use app_scene::camera_frame::{CameraImage, Display};
use app_scene::frame::FrameInput;
use app_scene::scene::{Image, Scene};

use preview::Preview;
use window::Window;

pub use error::CoreError;
pub use warm_up::WarmUp;
pub use window::{Canvas, as_shown};

/// The pipeline on a device: scene in, frames in, pictures out.
pub struct Core {
    gpu: Arc<Gpu>,
    window: Option<Window>,
    stage: Option<Stage>,
    /// The camera's picture, if it was shown last instead of a frame.
    preview: Option<Preview>,
    /// Timer of the passes; `None` until it is requested.
    timer: Option<Timer>,
    clock: Option<Clock>,
}

impl Core {
    /// Returns a core that draws into textures alone, for replay and tests.
    ///
    /// # Errors
    /// If there is no such adapter, or it falls short of a phone's limits.
    pub async fn headless(instance: &wgpu::Instance, adapter: &AdapterChoice) -> Result<Self, CoreError> {
        Ok(Self::new(Gpu::open(instance, adapter, None).await?, None))
    }

    /// Returns a core on the caller's own device, which draws into textures alone; the caller may
    /// continue to use device and queue.
    ///
    /// # Errors
    /// If the device was opened with less than a phone's limits.
    pub fn on_device(device: wgpu::Device, queue: wgpu::Queue) -> Result<Self, CoreError> {
        Ok(Self::new(Gpu::adopt(device, queue)?, None))
    }

    /// Returns a core that presents on `surface`, of `size_px` physical pixels.
    ///
    /// # Errors
    /// If no adapter can draw on the surface, or it falls short of a phone's limits.
    pub async fn on_surface(
        instance: &wgpu::Instance,
        surface: wgpu::Surface<'static>,
        size_px: [u32; 2],
    ) -> Result<Self, CoreError> {
        let gpu = Gpu::open(instance, &AdapterChoice::Fastest, Some(&surface)).await?;
        let window = Window::new(&gpu, surface, size_px)?;
        Ok(Self::new(gpu, Some(window)))
    }

    /// Returns a core without a device: it draws nothing, but each frame's report has the work of
    /// the passes that would run, from the same descriptors. Reading from the device is an error.
    #[must_use]
    pub fn counting() -> Self {
        Self::new(Gpu::default(), None)
    }

    /// Returns a core without a scene that draws into textures alone, on the same device: it shares
    /// all compiled pipelines, but no estimates.
    #[must_use]
    pub fn beside(&self) -> Self {
        Self::new(Arc::clone(&self.gpu), None)
    }

    fn new(gpu: impl Into<Arc<Gpu>>, window: Option<Window>) -> Self {
        Self {
            gpu: gpu.into(),
            window,
            stage: None,
            preview: None,
            timer: None,
            clock: None,
        }
    }

    /// The device, for a platform that shares its textures; `None` for a core that only counts.
    #[must_use]
    pub fn device(&self) -> Option<DeviceHandle> {
        self.gpu.opened.as_ref().map(|opened| opened.device.handle())
    }

    /// Key under which compiled pipelines are kept between starts: this crate's version, the device
    /// and its driver. `None` if the driver does not export pipelines, or has a known fault in
    /// doing so.
    #[must_use]
    pub fn pipelines_key(&self) -> Option<String> {
        self.gpu.pipelines_key()
    }

    /// Compiles with a cache of the driver from now on. The caller created the cache on
    /// [`Core::device`] from the data of an earlier start.
    pub fn set_pipeline_cache(&self, cache: wgpu::PipelineCache) {
        self.gpu.set_pipeline_cache(cache);
    }

    /// The present content of the driver's cache, for the next start; `None` without a cache.
    #[must_use]
    pub fn pipeline_data(&self) -> Option<Vec<u8>> {
        self.gpu.pipeline_data()
    }

    /// Drops the surface; device, pipelines and estimates stay.
    pub fn suspend(&mut self) {
        self.window = None;
    }

    /// Continues on a new surface.
    ///
    /// # Errors
    /// If the device cannot draw on it.
    pub fn resume(&mut self, surface: wgpu::Surface<'static>, size_px: [u32; 2]) -> Result<(), CoreError> {
        self.window = Some(Window::new(&self.gpu, surface, size_px)?);
        Ok(())
    }

    /// Adapts to a new size of the surface, in physical pixels.
    pub fn resize(&mut self, size_px: [u32; 2]) {
        if let Some(window) = &mut self.window {
            window.resize(&self.gpu, size_px);
        }
    }

    /// Uses a camera's unchanged picture as the latest one until the next frame: it needs no scene,
    /// and nothing is estimated from it.
    ///
    /// # Errors
    /// If its size is out of range, or the device refuses the work.
    pub fn show_camera(&mut self, image: &CameraImage) -> Result<(), CoreError> {
        self.check_sides(image.size_px())?;
        let size_px = image.size_px();
        if self
            .preview
            .as_ref()
            .is_some_and(|preview| preview.size_px() != size_px)
        {
            drop_preview(&self.gpu, &mut self.preview);
        }
        let kept = self.preview.take();
        let preview = self.gpu.guarded(|| {
            let mut preview = kept.unwrap_or_else(|| Preview::new(size_px));
            preview.take(&self.gpu, image);
            preview
        })?;
        self.preview = Some(preview);
        Ok(())
    }

    /// Presents the latest picture, or black before the first.
    ///
    /// # Errors
    /// If the surface is lost for good; an outdated surface is configured anew.
    pub fn present(&mut self, display: Display) -> Result<(), CoreError> {
        self.present_with(display, |_| {})
    }

    /// Like [`Core::present`]; `paint` may paint over the picture before it is presented.
    ///
    /// # Errors
    /// As [`Core::present`].
    pub fn present_with(
        &mut self,
        display: Display,
        paint: impl FnOnce(&Canvas<'_>),
    ) -> Result<(), CoreError> {
        let picture = latest(&self.gpu, self.preview.as_ref(), self.stage.as_ref());
        let Some(window) = &mut self.window else {
            return Ok(());
        };
        Ok(window.present(&self.gpu, self.timer.as_mut(), picture, display, paint)?)
    }

    /// A target of the caller with the core's device, to be painted on as by
    /// [`Core::present_with`]; `None` if the core only counts.
    #[must_use]
    pub fn canvas<'a>(&'a self, target: &'a wgpu::Texture) -> Option<Canvas<'a>> {
        Canvas::on(&self.gpu, target)
    }

    /// An off-screen target for [`Core::draw_on`] and [`Core::canvas`], of four bytes a pixel.
    /// `None` if the core only counts, or if the device has no texture of that size.
    #[must_use]
    pub fn hidden_screen(&self, size_px: [u32; 2]) -> Option<wgpu::Texture> {
        let size_px = size_px.map(|side| side.max(1));
        self.check_sides(size_px).ok()?;
        let make = || Texture::target(&self.gpu, "screen", size_px.into(), OUTPUT_FORMAT);
        self.gpu.guarded(make).ok()?.raw().cloned()
    }

    /// Waits for the device and returns the picture of a [`Core::hidden_screen`].
    ///
    /// # Errors
    /// If the device is lost, or refuses to copy the texture.
    pub fn read_screen(&self, screen: &wgpu::Texture) -> Result<Image, CoreError> {
        Ok(Image {
            width_px: screen.width(),
            height_px: screen.height(),
            rgba8: self.gpu.guarded(|| self.gpu.read_texture(Some(screen)))??,
        })
    }

    /// Draws the latest picture on a target of the caller's own, as [`Core::present`] does on the
    /// surface. The target's format stores sRGB codes unchanged, such as
    /// [`Bgra8Unorm`](wgpu::TextureFormat::Bgra8Unorm).
    ///
    /// # Errors
    /// If there is no scene, or the device refuses the work.
    pub fn draw_on(&mut self, target: &wgpu::Texture, display: Display) -> Result<(), CoreError> {
        let picture =
            latest(&self.gpu, self.preview.as_ref(), self.stage.as_ref()).ok_or(CoreError::NoScene)?;
        let (gpu, timer) = (&*self.gpu, self.timer.as_mut());
        gpu.guarded(|| {
            let screen = screen::Pass::new(gpu, target.format());
            window::show(Recorder::new(gpu, timer), &screen, &picture, display, target);
        })?;
        Ok(())
    }

    /// Sets a scene, with a [`Preset`](crate::preset::Preset) or [`Settings`] of the caller's;
    /// estimates of the previous scene are dropped.
    ///
    /// # Errors
    /// If a value of either is impossible, if a plate does not have the scene's size, or if that
    /// size is out of range or exceeds the device's memory.
    pub fn set_scene(
        &mut self,
        scene: impl Into<Arc<Scene>>,
        settings: impl Into<Settings>,
    ) -> Result<(), CoreError> {
        let (scene, settings) = (scene.into(), settings.into());
        scene.check()?;
        settings.check()?;
        self.check_sides([scene.width_px, scene.height_px])?;
        for plate in &scene.plates {
            check_size("plate", &scene, &Arc::clone(&plate.image).into())?;
        }
        let toy_in_object = scene.toy.bounds_of_pose(&scene.physical_pose)?;
        self.stage = None;
        self.gpu.release_groups();
        for compiled in self.warm_up(settings) {
            compiled?;
        }
        let stage = self
            .gpu
            .guarded(|| Stage::new(&self.gpu, scene, settings, &toy_in_object))??;
        self.stage = Some(stage);
        Ok(())
    }

    /// Returns to the state before a scene was set.
    pub fn forget_scene(&mut self) {
        self.stage = None;
        self.gpu.release_groups();
    }

    /// Reduces settings of the model from the next frame on, or restores them: those that a
    /// [`Governor`](crate::governor::Governor) has [turned
    /// down](crate::governor::Governor::quality_reductions). Estimates of the place stay; the next frame
    /// runs the fits as from a new view. The steps apply until another scene is set; the baseline
    /// has no such settings.
    ///
    /// # Errors
    /// If there is no scene.
    pub fn set_quality_reductions(&mut self, steps: &[QualityStep]) -> Result<(), CoreError> {
        self.stage
            .as_mut()
            .ok_or(CoreError::NoScene)?
            .set_quality_reductions(steps);
        Ok(())
    }

    /// Makes the picture of one frame.
    ///
    /// # Errors
    /// If there is no scene, if a value of the input is impossible, if the camera's picture does
    /// not have the scene's size, or if the device refuses the work.
    pub fn frame(&mut self, input: &FrameInput) -> Result<FrameReport, CoreError> {
        let stage = self.stage.as_mut().ok_or(CoreError::NoScene)?;
        input.check()?;
        check_size("camera frame", stage.scene(), &input.image)?;
        drop_preview(&self.gpu, &mut self.preview);
        if let Some(timer) = &mut self.timer {
            timer.start();
        }
        let (gpu, timer, clock) = (&self.gpu, self.timer.as_mut(), self.clock.clone());
        let made = gpu.guarded(|| {
            let mut recorder = Recorder::new(gpu, timer);
            recorder.stages = Stages::new(clock);
            let mut report = stage.encode(&mut recorder, input)?;
            let recorded = recorder.submit();
            report.ran = recorded.ran;
            report.uploaded_bytes = recorded.uploaded_bytes;
            report.stages = recorded.stages;
            Ok::<_, CoreError>(report)
        });
        match made {
            Ok(report) => report,
            Err(refused) => {
                stage.forget(&self.gpu);
                Err(refused.into())
            }
        }
    }

    /// The cost of [`Core::present`] for a picture on a screen of `screen_px` pixels; `None` before
    /// the first scene.
    #[must_use]
    pub fn count_present(&self, screen_px: [u32; 2], display: Display) -> Option<Work> {
        let picture = self.stage.as_ref()?.composed(&self.gpu);
        Some(window::count(&picture, screen_px, display))
    }

    /// Draws the latest frame's picture into a texture of the scene's size: sRGB codes as
    /// [`Rgba8Unorm`](wgpu::TextureFormat::Rgba8Unorm), which can be bound and copied from. The
    /// texture stays the same until the next scene.
    ///
    /// # Errors
    /// If there is no scene, or the device refuses the work.
    pub fn picture(&self) -> Result<&wgpu::Texture, CoreError> {
        let stage = self.stage.as_ref().ok_or(CoreError::NoScene)?;
        let picture = self.gpu.guarded(|| stage.draw_picture(&self.gpu))?;
        picture.raw().ok_or_else(|| GpuError::no_device().into())
    }

    /// Waits for the device and returns the latest picture, alpha 255.
    ///
    /// # Errors
    /// If there is no scene, or the device is lost.
    pub fn read_picture(&self) -> Result<Image, CoreError> {
        let stage = self.stage.as_ref().ok_or(CoreError::NoScene)?;
        let picture = self.gpu.guarded(|| stage.draw_picture(&self.gpu))?;
        let rgba8 = self.gpu.read_texture(picture.raw())?;
        let [width_px, height_px] = picture.size_px().to_array();
        Ok(Image {
            width_px,
            height_px,
            rgba8,
        })
    }

    /// Starts time stamps of each pass from the next frame on, if the device supports them, or
    /// stops them.
    ///
    /// # Errors
    /// If the device refuses the work.
    pub fn time_passes(&mut self, is_wanted: bool) -> Result<(), CoreError> {
        self.timer = if is_wanted {
            self.gpu.guarded(|| Timer::new(&self.gpu))?
        } else {
            None
        };
        Ok(())
    }

    /// Starts timing the processor's stages of frames from the next one on, by a clock of the
    /// caller's, or stops it.
    pub fn time_stages(&mut self, clock: Option<Clock>) {
        self.clock = clock;
    }

    /// Waits for the device and returns the latest frame's time per pass; empty if it was not
    /// requested, or if the device cannot measure it.
    ///
    /// # Errors
    /// If the device is lost.
    pub fn read_pass_times(&self) -> Result<Vec<PassTime>, CoreError> {
        let times = self
            .timer
            .as_ref()
            .map(|timer| timer.read(&self.gpu))
            .transpose()?;
        Ok(times.unwrap_or_default())
    }

    fn check_sides(&self, size_px: [u32; 2]) -> Result<(), CoreError> {
        let largest_px = self.gpu.limits().max_texture_dimension_2d;
        if size_px.iter().all(|side| (1..=largest_px).contains(side)) {
            Ok(())
        } else {
            Err(CoreError::SizeOutOfRange { size_px, largest_px })
        }
    }

    fn model(&self) -> Option<&Model> {
        self.stage
            .as_ref()
            .and_then(Stage::method)
            .and_then(Method::model)
    }

    /// Name of the device's adapter with its driver, as reported by the system; empty if the core
    /// only counts.
    #[must_use]
    pub fn adapter_name(&self) -> String {
        self.gpu.adapter_name()
    }

    /// Whether the device is a software renderer.
    #[must_use]
    pub fn is_software(&self) -> bool {
        self.gpu.is_software()
    }
}

/// Drops a preview together with its textures and the bind groups kept for them.
fn drop_preview(gpu: &Gpu, preview: &mut Option<Preview>) {
    if preview.take().is_some() {
        gpu.release_groups();
    }
}

/// The picture that was made or shown last.
fn latest<'a>(
    gpu: &Gpu,
    preview: Option<&'a Preview>,
    stage: Option<&'a Stage>,
) -> Option<ComposedFrame<'a>> {
    let of_stage = || stage.map(|stage| stage.composed(gpu));
    preview.map(|preview| preview.composed(gpu)).or_else(of_stage)
}

fn check_size(what: &'static str, scene: &Scene, image: &CameraImage) -> Result<(), CoreError> {
    let expected_px = [scene.width_px, scene.height_px];
    if image.is_of_size(expected_px) {
        Ok(())
    } else {
        Err(CoreError::SizeDiffers {
            what,
            expected_px,
            actual_px: image.size_px(),
            n_bytes: image.n_bytes(),
        })
    }
}
