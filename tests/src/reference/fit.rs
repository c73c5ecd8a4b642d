//! Twin of `fit.wgsl` and `fit_solve.wgsl`: what the real shadow and the real toy tell of the light, by iteratively
//! reweighted least squares with weak priors.

use glam::{DVec2, DVec3, DVec4, UVec2};

use super::least_squares::NormalEquations;
use super::model::{EvidenceRange, Pictures, Region, Solution, centre_px, coarse_at};
use super::raster::Raster;
use super::{ConstantError, shader_constant};

/// What the shaders fix.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FitConstants {
    /// Which values carry evidence.
    pub evidence: EvidenceRange,
    /// Residual of the receiver, as a fraction of the plate, at which a pixel counts half.
    pub cauchy_scale: f64,
    /// The same for the toy, as a fraction of its base colour.
    pub toy_cauchy_scale: f64,
    /// Weight of each prior against the energy of the first column.
    pub prior_weight: f64,
    /// Weight of the common solution of all channels, for the toy, against their common energy.
    pub white_weight: f64,
    /// Expected bounce.
    pub prior_bounce: f64,
    /// Expected share of all lights together.
    pub prior_share: f64,
    /// Most that all lights together may have.
    pub max_share: f64,
    /// Most bounce.
    pub max_bounce: f64,
}

impl FitConstants {
    /// Reads them from the shaders.
    ///
    /// # Errors
    /// When a shader has no such constant.
    pub fn from_shaders() -> Result<Self, ConstantError> {
        let cauchy_scale = shader_constant("fit", "CAUCHY_SCALE")?;
        Ok(Self {
            evidence: EvidenceRange::from_shader("fit")?,
            cauchy_scale,
            toy_cauchy_scale: shader_constant("fit", "TOY_CAUCHY_SCALE")?,
            prior_weight: shader_constant("fit_solve", "PRIOR_WEIGHT")?,
            white_weight: shader_constant("fit_solve", "WHITE_WEIGHT")?,
            prior_bounce: shader_constant("fit_solve", "PRIOR_BOUNCE")?,
            prior_share: shader_constant("fit_solve", "PRIOR_SHARE")?,
            max_share: shader_constant("fit_solve", "MAX_SHARE")?,
            max_bounce: shader_constant("fit_solve", "MAX_BOUNCE")?,
        })
    }
}

/// A receiver pixel whose light is known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReceiverSample {
    /// Linear colour of the camera's frame.
    pub frame: DVec3,
    /// Linear colour of the plate.
    pub plate: DVec3,
    /// The receiver point, (x, z) in plane space.
    pub in_plane: DVec2,
    /// Visibility of the ambient light.
    pub ambient: f64,
    /// Visibility of each light.
    pub visibility: DVec4,
}

/// Every `stride_px`th pixel, along each side, that shows the receiver alone.
#[must_use]
pub fn receiver_samples(region: &Region, pictures: &Pictures, stride_px: u32) -> Vec<ReceiverSample> {
    let taken = Raster::from_fn(region.size_px / stride_px, |texel| texel * stride_px);
    let sample = |texel: &UVec2| {
        let at = centre_px(*texel);
        let in_plane = region
            .receiver_point(at)
            .filter(|_| pictures.seen.at(*texel) > 0.0)?;
        Some(ReceiverSample {
            frame: pictures.frame.at(*texel),
            plate: pictures.plate.at(*texel),
            in_plane,
            ambient: coarse_at(&pictures.ambient, region, at),
            visibility: pictures.visibility.at(*texel),
        })
    };
    taken.texels().iter().filter_map(sample).collect()
}

/// Fits gain, bounce and shares in `n_steps`, from `start`, which stays where there is no evidence.
#[must_use]
pub fn fit_receiver(
    region: &Region,
    samples: &[ReceiverSample],
    start: &Solution,
    constants: &FitConstants,
    n_steps: u32,
) -> Solution {
    let mut solution = start.clone();
    for step in 0..n_steps {
        let before = solution.clone();
        for channel in 0..3 {
            let equations = receiver_equations(region, samples, &before, constants, (step > 0, channel));
            take_receiver(&equations, constants, channel, &mut solution);
        }
    }
    solution
}

fn receiver_equations(
    region: &Region,
    samples: &[ReceiverSample],
    before: &Solution,
    constants: &FitConstants,
    (is_reweighted, channel): (bool, usize),
) -> NormalEquations {
    let mut equations = NormalEquations::new(2 + region.lights.len());
    for sample in samples {
        let (frame, plate) = (sample.frame[channel], sample.plate[channel]);
        let falloff = before.plate_falloff(region, sample.in_plane)[channel];
        let mut columns = vec![plate * sample.ambient, plate * (1.0 - sample.ambient)];
        columns.extend((0..region.lights.len()).map(|i| {
            plate * region.falloff(i, sample.in_plane) * (sample.visibility[i] - sample.ambient) / falloff
        }));
        let mut weight = constants.evidence.holds(frame, plate);
        if is_reweighted {
            let model = before.receiver_model(region, sample.in_plane, sample.ambient, sample.visibility);
            weight *= cauchy_weight(frame - plate * model[channel], constants.cauchy_scale * plate);
        }
        equations.observe(&columns, frame, weight);
    }
    equations
}

fn take_receiver(
    observed: &NormalEquations,
    constants: &FitConstants,
    channel: usize,
    solution: &mut Solution,
) {
    let energy = observed.energy(0);
    if energy <= 0.0 {
        return;
    }
    let n_lights = solution.shares.len();
    let mut equations = observed.clone();
    let weight = constants.prior_weight * energy;
    equations.expect(0, 1.0, weight);
    equations.expect(1, constants.prior_bounce, weight);
    #[allow(clippy::cast_precision_loss, reason = "at most four lights")]
    let prior_share = constants.prior_share / n_lights as f64;
    (0..n_lights).for_each(|i| equations.expect(2 + i, prior_share, weight));
    let unknowns = equations.solve();
    let gain = unknowns[0];
    if gain <= 0.0 {
        return;
    }
    let shares: Vec<f64> = unknowns[2..]
        .iter()
        .map(|unknown| (unknown / gain).max(0.0))
        .collect();
    let total: f64 = shares.iter().sum();
    let scale = if total > constants.max_share {
        constants.max_share / total
    } else {
        1.0
    };
    solution.gain[channel] = gain;
    solution.bounce[channel] = (unknowns[1] / gain).clamp(0.0, constants.max_bounce);
    solution
        .shares
        .iter_mut()
        .zip(&shares)
        .for_each(|(slot, share)| slot[channel] = scale * share);
    solution.contrast[channel] = (0..n_lights).map(|i| observed.energy(2 + i)).sum::<f64>() / energy;
}

/// A pixel of one surface of the toy.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ToySample {
    /// Linear colour of the camera's frame.
    pub frame: DVec3,
    /// Base colour of the model, linear.
    pub base: DVec3,
    /// Unit normal, in stage space.
    pub normal: DVec3,
    /// Cosine to each light times its visibility.
    pub received: DVec4,
}

/// Fits how the toy is lit in `n_steps`, from `start`, which stays where there is no evidence.
///
/// All channels together decide what one of them does not show.
#[must_use]
pub fn fit_toy(
    region: &Region,
    samples: &[ToySample],
    start: &Solution,
    constants: &FitConstants,
    n_steps: u32,
) -> Solution {
    let n_columns = 2 + region.lights.len();
    let mut solution = start.clone();
    for step in 0..n_steps {
        let each = [0, 1, 2].map(|k| toy_equations(region, samples, &solution, constants, (step > 0, k)));
        let mut all = NormalEquations::new(n_columns);
        each.iter().for_each(|equations| all.join(equations));
        let energy = all.energy(0);
        (0..n_columns).for_each(|i| all.expect(i, 0.0, constants.prior_weight * energy));
        let white = all.solve();
        for (channel, mut equations) in each.into_iter().enumerate() {
            if equations.energy(0) <= 0.0 {
                continue;
            }
            white
                .iter()
                .enumerate()
                .for_each(|(i, w)| equations.expect(i, *w, constants.white_weight * energy));
            solution
                .toy
                .iter_mut()
                .zip(equations.solve())
                .for_each(|(slot, value)| slot[channel] = value);
        }
    }
    solution
}

fn toy_equations(
    region: &Region,
    samples: &[ToySample],
    before: &Solution,
    constants: &FitConstants,
    (is_reweighted, channel): (bool, usize),
) -> NormalEquations {
    let mut equations = NormalEquations::new(2 + region.lights.len());
    for sample in samples {
        let (frame, base) = (sample.frame[channel], sample.base[channel]);
        let columns: Vec<f64> = toy_columns(sample.normal, sample.received, region.lights.len())
            .into_iter()
            .map(|column| base * column)
            .collect();
        let mut weight = constants.evidence.holds(frame, frame);
        if is_reweighted {
            let model: f64 = columns
                .iter()
                .zip(&before.toy)
                .map(|(column, toy)| column * toy[channel])
                .sum();
            weight *= cauchy_weight(frame - model, constants.toy_cauchy_scale * base);
        }
        equations.observe(&columns, frame, weight);
    }
    equations
}

/// Twin of `common/toy_radiance.wgsl`: constant, vertical gradient, and what is received of each light.
#[must_use]
pub fn toy_columns(normal: DVec3, received: DVec4, n_lights: usize) -> Vec<f64> {
    [1.0, normal.y]
        .into_iter()
        .chain(received.to_array().into_iter().take(n_lights))
        .collect()
}

/// 1 for no residual, a half for one of `scale`.
fn cauchy_weight(residual: f64, scale: f64) -> f64 {
    if scale == 0.0 {
        0.0
    } else {
        scale * scale / (scale * scale + residual * residual)
    }
}
