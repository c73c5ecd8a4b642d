//! What was made and learned, read back from the device: for reports, warnings and tests, never for a frame.

use bytemuck::Zeroable;

use super::{Core, CoreError};
use crate::frame::warning::Outlier;
use crate::frame::warning::Warning;
use crate::gpu::device::Kind;
use crate::model::diagnostics::conditioning::light_conditioning;
use crate::model::diagnostics::outliers::outliers;
use crate::model::state::grids::{Grid, MAX_CELLS};
use crate::model::state::solution::Fit;
use crate::model::state::tints::TintMap;
use crate::readback::{FloatMap, Map};
use crate::stage::Stage;

/// Energy of the lights' columns over that of the plate, below which too little real shadow was seen to tell the shares:
/// at 0.006 a share was off by 0.1, at 0.024 and above by less than 0.01.
const FAINT_CONTRAST: f32 = 0.01;
/// How far a light's strength must be told by what was seen. Two lights in one place have 0.5, ones
/// whose shadows differ more than 0.99.
const LEAST_CONDITIONING: f64 = 0.75;

impl Core {
    /// How many objects of each kind the device was asked to make so far, whether they still live or not.
    #[must_use]
    pub fn n_created(&self) -> [(Kind, u64); Kind::ALL.len()] {
        let counts = self.gpu.n_created();
        Kind::ALL.map(|kind| (kind, counts[kind as usize]))
    }

    /// Waits for the device and returns what the model learned from the real shadow, once anything was.
    ///
    /// # Errors
    /// When the device is lost.
    pub fn read_fit(&self) -> Result<Option<Fit>, CoreError> {
        let Some(model) = self.model() else {
            return Ok(None);
        };
        let bytes = self.gpu.read_buffer(&model.state.solution)?;
        let mut fit = Fit::zeroed();
        bytemuck::bytes_of_mut(&mut fit).copy_from_slice(&bytes);
        Ok(Some(fit))
    }

    /// Waits for the device and returns what was learned that gives to worry about.
    ///
    /// # Errors
    /// When the device is lost.
    pub fn read_fit_warnings(&self) -> Result<Vec<Warning>, CoreError> {
        let Some(fit) = self.read_fit()? else {
            let Some((stage, method)) = self
                .stage
                .as_ref()
                .and_then(|stage| Some((stage, stage.method()?)))
            else {
                return Ok(Vec::new());
            };
            return Ok(method.read_warnings(&self.gpu, stage.light_indices())?);
        };
        let contrasts = fit.receivers.iter().flat_map(|receiver| &receiver.contrast[..3]);
        let contrast = contrasts.copied().fold(0.0, f32::max);
        let faint = (contrast < FAINT_CONTRAST).then_some(Warning::FaintShadow { contrast });
        let lights = self.read_under_constrained_lights()?;
        let is_any = faint.is_none() && !lights.is_empty();
        let not_told = is_any.then_some(Warning::LightsUnderConstrained { lights });
        let unknown = self.read_outliers()?.into_iter().map(Warning::Outlier);
        Ok(faint.into_iter().chain(not_told).chain(unknown).collect())
    }

    /// Lights whose strength is assumed more than seen.
    fn read_under_constrained_lights(&self) -> Result<Vec<usize>, CoreError> {
        let (Some(stage), Some(model)) = (&self.stage, self.model()) else {
            return Ok(Vec::new());
        };
        let sums = self.gpu.read_buffer(&model.state.fit_sums)?;
        let sums: Vec<f32> = bytemuck::pod_collect_to_vec(&sums);
        let told = light_conditioning(&sums, model.region.plan.lights.len());
        let lights = stage.light_indices().iter().zip(told);
        Ok(lights
            .filter_map(|(light, told)| (told < LEAST_CONDITIONING).then_some(*light))
            .collect())
    }

    fn read_outliers(&self) -> Result<Vec<Outlier>, CoreError> {
        let Some(model) = self.model() else {
            return Ok(Vec::new());
        };
        let accumulated = self.gpu.read_buffer(&model.state.residual.accumulated)?;
        let accumulated: Vec<[f32; 4]> = bytemuck::pod_collect_to_vec(&accumulated);
        let receivers = accumulated.chunks(MAX_CELLS).map(outliers);
        let mut found: Vec<Outlier> = receivers.flatten().collect();
        found.sort_unstable_by_key(|unknown| *unknown as u8);
        found.dedup();
        Ok(found)
    }

    /// Waits for the device and returns a map of the latest retargeted frame, once there was one.
    ///
    /// # Errors
    /// When the device is lost.
    pub fn read_map(&self, map: Map) -> Result<Option<FloatMap>, CoreError> {
        let Some(method) = self.stage.as_ref().and_then(Stage::method) else {
            return Ok(None);
        };
        Ok(method.read_map(&self.gpu, map)?)
    }

    /// Waits for the device and returns each receiver's coarse grid with the filled residuals on it, once there was a
    /// retargeted frame of the model.
    ///
    /// # Errors
    /// When the device is lost.
    pub fn read_residuals(&self) -> Result<Vec<(Grid, FloatMap)>, CoreError> {
        let Some(model) = self.model() else {
            return Ok(Vec::new());
        };
        let grids = model.state.layout.grids.into_iter().enumerate();
        let residuals = grids
            .take(model.region.plan.n_receivers as usize)
            .map(|(receiver, grid)| Ok((grid, model.read_residual(&self.gpu, receiver)?)));
        residuals.collect()
    }

    /// Waits for the device and returns the tints of the toy's paint, once there was a retargeted frame of the model.
    ///
    /// # Errors
    /// When the device is lost.
    pub fn read_tints(&self) -> Result<Option<TintMap>, CoreError> {
        let Some(model) = self.model() else {
            return Ok(None);
        };
        Ok(Some(model.state.tints.read(&self.gpu)?))
    }
}
