//! Warnings about what was learned, read back from the device: for reports, never for a frame.

use super::inspect::Inspect;
use super::{Core, CoreError};
use crate::frame::warning::{Outlier, Warning};
use crate::model::diagnostics::conditioning::light_conditioning;
use crate::model::diagnostics::outliers::outliers;
use crate::model::state::grids::MAX_CELLS;
use crate::model::state::solution::Fit;

/// Energy of the lights' columns over that of the plate, below which too little real shadow was seen for the direct
/// fractions: at 0.006 one was off by 0.1, at 0.024 and above by less than 0.01.
const FAINT_CONTRAST: f32 = 0.01;
/// Conditioning below which a light's intensity is under-constrained. Two lights in one position have 0.5, ones whose
/// shadows differ more than 0.99.
const LEAST_CONDITIONING: f64 = 0.75;

impl Core {
    /// Waits for the device and returns warnings about what was learned, up to the latest frame.
    ///
    /// # Errors
    /// When the device is lost.
    pub fn read_fit_warnings(&self) -> Result<Vec<Warning>, CoreError> {
        let Some(fit) = self.read_fit()? else {
            return self.read_baseline_warnings();
        };
        let faint = faint_shadow(&fit);
        let lights = self.read_under_constrained_lights()?;
        let is_any = faint.is_none() && !lights.is_empty();
        let under_constrained = is_any.then_some(Warning::LightsUnderConstrained { lights });
        let outliers = self.read_outliers()?.into_iter().map(Warning::Outlier);
        Ok(faint
            .into_iter()
            .chain(under_constrained)
            .chain(outliers)
            .collect())
    }

    fn read_baseline_warnings(&self) -> Result<Vec<Warning>, CoreError> {
        let Some((stage, method)) = self
            .stage
            .as_ref()
            .and_then(|stage| Some((stage, stage.method()?)))
        else {
            return Ok(Vec::new());
        };
        let listed = (stage.receiver_indices(), stage.light_indices());
        Ok(method.read_warnings(&self.gpu, listed)?)
    }

    /// Lights whose intensity is assumed more than seen, as indices in the list that they were given in.
    fn read_under_constrained_lights(&self) -> Result<Vec<usize>, CoreError> {
        let (Some(stage), Some(model)) = (&self.stage, self.model()) else {
            return Ok(Vec::new());
        };
        let sums = self.gpu.read_buffer(&model.state.fit_sums)?;
        let sums: Vec<f32> = bytemuck::pod_collect_to_vec(&sums);
        let conditioning = light_conditioning(&sums, model.region.plan.n_lights);
        let lights = stage.light_indices().iter().zip(conditioning);
        Ok(lights
            .filter_map(|(light, conditioning)| (conditioning < LEAST_CONDITIONING).then_some(*light))
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
        found.sort_unstable_by_key(|outlier| *outlier as u8);
        found.dedup();
        Ok(found)
    }
}

fn faint_shadow(fit: &Fit) -> Option<Warning> {
    let contrasts = fit.receivers.iter().flat_map(|receiver| &receiver.contrast[..3]);
    let contrast = contrasts.copied().fold(0.0, f32::max);
    (contrast < FAINT_CONTRAST).then_some(Warning::FaintShadow { contrast })
}
