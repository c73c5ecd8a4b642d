//! [`Core`]: the one type a shell or a harness holds.

mod read;

use std::sync::Arc;

use thiserror::Error;

use crate::frame::{FrameInput, FrameReport};
use crate::gpu::encoder::{Encoder, PassTime, Stamps};
use crate::gpu::{AdapterChoice, Gpu, GpuError};
use crate::inject::InjectedVisibility;
use crate::plan::Plan;
use crate::preset::Preset;
use crate::scene::{Image, Scene};
use crate::stage::Stage;
use crate::toy::ToyError;
use crate::window::Window;
use crate::work::{Model, Work};

/// Why the core cannot go on.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum CoreError {
    /// There is no device, or it was lost.
    #[error(transparent)]
    Gpu(#[from] GpuError),
    /// The surface cannot be drawn on.
    #[error("drawing on the surface: {reason}")]
    Surface {
        /// What the driver said.
        reason: String,
    },
    /// The toy cannot be posed.
    #[error(transparent)]
    Toy(#[from] ToyError),
    /// A frame came before there was a scene.
    #[error("a frame came before its scene")]
    NoScene,
    /// A picture is not of the scene's size.
    #[error(
        "the {what} has {actual_px:?} pixels in {n_bytes} bytes, the scene {expected_px:?} of four bytes each"
    )]
    SizeDiffers {
        /// Which picture.
        what: &'static str,
        /// The scene's size.
        expected_px: [u32; 2],
        /// The picture's size.
        actual_px: [u32; 2],
        /// What it comes in.
        n_bytes: usize,
    },
    /// A picture is larger than the device takes, or empty.
    #[error("pictures of {size_px:?} pixels cannot be handled: each side is 1 to {largest_px} pixels")]
    SizeOutOfRange {
        /// The scene's size.
        size_px: [u32; 2],
        /// Longest side that the device takes.
        largest_px: u32,
    },
    /// A scene that no frame could be made from.
    #[error("the scene has no receiver")]
    NoReceiver,
}

/// The pipeline on a device: scene in, frames in, pictures out.
pub struct Core {
    gpu: Gpu,
    window: Option<Window>,
    stage: Option<Stage>,
    stamps: Option<Stamps>,
}

impl Core {
    /// A core that draws into textures alone, for replay and tests.
    ///
    /// # Errors
    /// When there is no adapter of that choice, or it falls short of a phone's limits.
    pub async fn headless(instance: &wgpu::Instance, adapter: &AdapterChoice) -> Result<Self, CoreError> {
        let gpu = Gpu::open(instance, adapter, None).await?;
        Ok(Self {
            gpu,
            window: None,
            stage: None,
            stamps: None,
        })
    }

    /// A core that presents on `surface`, of `size_px` physical pixels.
    ///
    /// # Errors
    /// When no adapter can draw on the surface, or it falls short of a phone's limits.
    pub async fn on_surface(
        instance: &wgpu::Instance,
        surface: wgpu::Surface<'static>,
        size_px: [u32; 2],
    ) -> Result<Self, CoreError> {
        let gpu = Gpu::open(instance, &AdapterChoice::Fastest, Some(&surface)).await?;
        let window = Window::new(&gpu, surface, size_px)?;
        Ok(Self {
            gpu,
            window: Some(window),
            stage: None,
            stamps: None,
        })
    }

    /// Drops the surface; device, pipelines and what was learned stay.
    pub fn suspend(&mut self) {
        self.window = None;
    }

    /// Continues on a new surface.
    ///
    /// # Errors
    /// When the device cannot draw on it.
    pub fn resume(&mut self, surface: wgpu::Surface<'static>, size_px: [u32; 2]) -> Result<(), CoreError> {
        self.window = Some(Window::new(&self.gpu, surface, size_px)?);
        Ok(())
    }

    /// Follows a new size of the surface, in physical pixels.
    pub fn resize(&mut self, size_px: [u32; 2]) {
        if let Some(window) = &mut self.window {
            window.resize(&self.gpu, size_px);
        }
    }

    /// Shows the latest picture, or black before the first.
    ///
    /// # Errors
    /// When the surface is lost for good; one that is only out of date is set up anew.
    pub fn present(&mut self) -> Result<(), CoreError> {
        let Some(window) = &mut self.window else {
            return Ok(());
        };
        window.present(&self.gpu, self.stage.as_ref().map(|stage| &stage.output.view))
    }

    /// Takes a scene; what was learned of another is forgotten.
    ///
    /// # Errors
    /// When it has no receiver, a plate is not of its size, or that size is out of range or of the device's memory.
    pub fn set_scene(&mut self, scene: Scene, preset: Preset) -> Result<(), CoreError> {
        if scene.receivers.is_empty() {
            return Err(CoreError::NoReceiver);
        }
        let largest_px = self.gpu.device.limits().max_texture_dimension_2d;
        let size_px = [scene.width_px, scene.height_px];
        if size_px.iter().any(|side| !(1..=largest_px).contains(side)) {
            return Err(CoreError::SizeOutOfRange { size_px, largest_px });
        }
        for plate in &scene.plates {
            check_size("plate", &scene, &plate.image)?;
        }
        self.stage = None;
        let stage = Stage::new(&self.gpu, scene, preset)?;
        self.gpu.check()?;
        self.stage = Some(stage);
        Ok(())
    }

    /// Makes the picture of one frame.
    ///
    /// # Errors
    /// When there is no scene, the camera's picture is not of its size, or the device refuses the work.
    pub fn frame(&mut self, input: &FrameInput) -> Result<FrameReport, CoreError> {
        let stage = self.stage.as_mut().ok_or(CoreError::NoScene)?;
        check_size("camera frame", stage.scene(), &input.image)?;
        let mut encoder = Encoder::new(&self.gpu);
        let report = stage.encode(&self.gpu, &mut encoder, input)?;
        self.stamps = encoder.submit(&self.gpu);
        if let Err(refused) = self.gpu.check() {
            stage.forget();
            return Err(refused.into());
        }
        Ok(report)
    }

    /// Waits for the device and returns the latest picture, alpha 255.
    ///
    /// # Errors
    /// When there is no scene, or the device is lost.
    pub fn read_picture(&self) -> Result<Image, CoreError> {
        let stage = self.stage.as_ref().ok_or(CoreError::NoScene)?;
        let rgba8 = self.gpu.read_texture(&stage.output.raw)?;
        Ok(Image {
            width_px: stage.output.raw.width(),
            height_px: stage.output.raw.height(),
            rgba8,
        })
    }

    /// Waits for the device and returns the latest frame's time per pass; empty where the device cannot tell.
    ///
    /// # Errors
    /// When the device is lost.
    pub fn take_pass_times(&mut self) -> Result<Vec<PassTime>, CoreError> {
        Ok(self
            .stamps
            .take()
            .map(|stamps| stamps.read(&self.gpu))
            .transpose()?
            .unwrap_or_default())
    }

    /// Replaces visibilities of the lights in what follows, so that errors of visibility can be told from all others.
    ///
    /// What was learned is learned again with the next frame. The maps stay until the place, the camera or the scene
    /// changes, or others are injected. A measuring aid: no product has exact visibility.
    ///
    /// # Errors
    /// When no frame was retargeted yet, or a map is not of the size of the latest one's region.
    pub fn inject_visibility(&mut self, maps: &InjectedVisibility) -> Result<(), CoreError> {
        let stage = self.stage.as_mut().ok_or(CoreError::NoScene)?;
        let expected_px = stage
            .work()
            .ok_or(CoreError::NoScene)?
            .region()
            .size_px
            .to_array();
        for map in [&maps.physical, &maps.shown].into_iter().flatten() {
            let actual_px = [map.width, map.height];
            let n_texels = map.width as usize * map.height as usize;
            if actual_px != expected_px || map.texels.len() != n_texels {
                return Err(CoreError::SizeDiffers {
                    what: "injected visibility",
                    expected_px,
                    actual_px,
                    n_bytes: 16 * map.texels.len(),
                });
            }
        }
        stage.inject(&self.gpu, maps);
        Ok(())
    }

    /// Keeps the real shadow from what follows, so that how well it is rebuilt can be measured on photographs that have no
    /// truth: of the first frame it tells the fits and, where no plate shows the place, a smooth estimate of that, in which
    /// shadow counts little; of later ones nothing. The physical pose is then made
    /// like any other, and its photograph is its truth.
    ///
    /// Until another scene is set. A measuring aid for the presets of the model; `paper` and `flat` stay as they are.
    ///
    /// # Errors
    /// When there is no scene.
    pub fn withhold_shadow(&mut self) -> Result<(), CoreError> {
        self.stage.as_mut().ok_or(CoreError::NoScene)?.withhold_shadow();
        Ok(())
    }

    /// The model's plan of the latest retargeted frame, once there was one.
    #[must_use]
    pub fn plan(&self) -> Option<&Plan> {
        self.model().map(|model| &model.capture.plan)
    }

    fn model(&self) -> Option<&Model> {
        self.stage.as_ref().and_then(Stage::work).and_then(Work::model)
    }

    /// The device, for reports.
    #[must_use]
    pub fn gpu(&self) -> &Gpu {
        &self.gpu
    }
}

fn check_size(what: &'static str, scene: &Scene, image: &Arc<Image>) -> Result<(), CoreError> {
    let expected_px = [scene.width_px, scene.height_px];
    let actual_px = [image.width_px, image.height_px];
    let n_bytes = 4 * u64::from(image.width_px) * u64::from(image.height_px);
    if expected_px == actual_px && image.rgba8.len() as u64 == n_bytes {
        Ok(())
    } else {
        Err(CoreError::SizeDiffers {
            what,
            expected_px,
            actual_px,
            n_bytes: image.rgba8.len(),
        })
    }
}
