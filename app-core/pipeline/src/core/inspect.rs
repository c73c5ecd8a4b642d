//! [`Inspect`]: resources and results of the core, for the project's own tests and programs.

use bytemuck::Zeroable;

use super::{Core, CoreError};
use crate::gpu::{Kind, Memory};
use crate::model::plan::Plan;
use crate::model::state::grids::Grid;
use crate::model::state::solution::Fit;
use crate::model::state::tints::TintMap;
use crate::readback::inject::InjectedVisibility;
use crate::readback::{FloatMap, Map};

/// Measurements and measuring aids behind the public interface of [`Core`]. Methods that read wait
/// for the device.
pub trait Inspect {
    /// Number of objects of each kind that were created on the device so far, including those that
    /// were dropped.
    fn n_created(&self) -> [(Kind, u64); Kind::ALL.len()];

    /// Bytes of textures and buffers that were allocated on the device so far, by their
    /// descriptors.
    fn memory(&self) -> Memory;

    /// The model's plan of the latest retargeted frame; `None` before the first.
    fn plan(&self) -> Option<&Plan>;

    /// The results of the model's fits; `None` before the first retargeted frame.
    ///
    /// # Errors
    /// If the device is lost.
    fn read_fit(&self) -> Result<Option<Fit>, CoreError>;

    /// A map of the latest retargeted frame; `None` before the first, or if the frame's method does
    /// not make the map.
    ///
    /// # Errors
    /// If the device is lost.
    fn read_map(&self, map: Map) -> Result<Option<FloatMap>, CoreError>;

    /// Each receiver's coarse grid with the filled residuals on it; empty before the first
    /// retargeted frame of the model.
    ///
    /// # Errors
    /// If the device is lost.
    fn read_residuals(&self) -> Result<Vec<(Grid, FloatMap)>, CoreError>;

    /// The tints of the toy's paint; `None` before the first retargeted frame of the model.
    ///
    /// # Errors
    /// If the device is lost.
    fn read_tints(&self) -> Result<Option<TintMap>, CoreError>;

    /// Replaces visibilities of the lights from the next frame on, which runs the fits anew, so
    /// that errors of visibility can be separated from all others. The maps stay until the view or
    /// the scene changes, or until others are injected.
    ///
    /// # Errors
    /// If no frame was retargeted yet, or if a map does not have the size of the latest frame's
    /// region.
    fn inject_visibility(&mut self, maps: &InjectedVisibility) -> Result<(), CoreError>;

    /// Excludes the real shadow from everything that is estimated from here on. Thus its
    /// reconstruction can be measured on photographs without ground truth. In the first frame only
    /// the fits see the shadow, and, where no plate shows the place, a smooth estimate of the
    /// plate, in which the shadow has little weight. The physical pose is then drawn like any
    /// other; its photograph is the ground truth.
    ///
    /// The exclusion lasts until another scene is set and exists for the presets of the model
    /// alone.
    ///
    /// # Errors
    /// If there is no scene.
    fn withhold_shadow(&mut self) -> Result<(), CoreError>;

    /// Draws a repeated pose as if it were new, so that a frame can be measured by repetition,
    /// until another scene is set.
    ///
    /// # Errors
    /// If there is no scene.
    fn draw_every_pose(&mut self) -> Result<(), CoreError>;
}

impl Inspect for Core {
    fn n_created(&self) -> [(Kind, u64); Kind::ALL.len()] {
        let counts = self.gpu.n_created();
        Kind::ALL.map(|kind| (kind, counts[kind as usize]))
    }

    fn memory(&self) -> Memory {
        self.gpu.memory()
    }

    fn plan(&self) -> Option<&Plan> {
        self.model().map(|model| &model.region.plan)
    }

    fn read_fit(&self) -> Result<Option<Fit>, CoreError> {
        let Some(model) = self.model() else {
            return Ok(None);
        };
        let bytes = self.gpu.read_buffer(&model.state.solution)?;
        let mut fit = Fit::zeroed();
        bytemuck::bytes_of_mut(&mut fit).copy_from_slice(&bytes);
        Ok(Some(fit))
    }

    fn read_map(&self, map: Map) -> Result<Option<FloatMap>, CoreError> {
        let Some(stage) = &self.stage else {
            return Ok(None);
        };
        Ok(stage.read_map(&self.gpu, map)?)
    }

    fn read_residuals(&self) -> Result<Vec<(Grid, FloatMap)>, CoreError> {
        let Some(model) = self.model() else {
            return Ok(Vec::new());
        };
        let grids = model.state.layout.grids.into_iter().enumerate();
        let residuals = grids
            .take(model.region.plan.n_receivers as usize)
            .map(|(receiver, grid)| Ok((grid, model.read_residual(&self.gpu, receiver)?)));
        residuals.collect()
    }

    fn read_tints(&self) -> Result<Option<TintMap>, CoreError> {
        let Some(model) = self.model() else {
            return Ok(None);
        };
        Ok(Some(model.state.tints.read(&self.gpu)?))
    }

    fn inject_visibility(&mut self, maps: &InjectedVisibility) -> Result<(), CoreError> {
        let stage = self.stage.as_mut().ok_or(CoreError::NoScene)?;
        let region = stage.method().ok_or(CoreError::NoScene)?.region();
        let expected_px = region.size_px.to_array();
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

    fn withhold_shadow(&mut self) -> Result<(), CoreError> {
        self.stage.as_mut().ok_or(CoreError::NoScene)?.withhold_shadow();
        Ok(())
    }

    fn draw_every_pose(&mut self) -> Result<(), CoreError> {
        self.stage.as_mut().ok_or(CoreError::NoScene)?.draw_every_pose();
        Ok(())
    }
}
