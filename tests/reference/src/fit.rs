//! CPU reference of `fit.wgsl` and `fit_solve.wgsl`: the light, estimated from the real shadow and
//! the real toy by iteratively reweighted least squares with weak priors.

use std::iter;

use glam::{DVec3, DVec4, UVec2};

use super::least_squares::NormalEquations;
use super::model::{
    Pictures, ReceiverPlane, ReceiverPoint, Region, Solution, bounced, centre_px, coarse_at, evidence,
    is_clipped,
};
use super::raster::Raster;
use super::receiver_priors::receiver_priors;
pub use super::receiver_priors::{MAX_BOUNCE, PRIOR_BOUNCE, PRIOR_DIRECT_FRACTION};

/// Residual of a receiver, as a fraction of the plate, at which a pixel counts half.
const CAUCHY_SCALE: f64 = 0.03;
/// The same for the toy, as a fraction of its base colour: its interreflection and its curved faces
/// are not modelled.
const TOY_CAUCHY_SCALE: f64 = 0.12;
/// Weight of each prior, as a fraction of the first column's energy.
const PRIOR_WEIGHT: f64 = 1e-4;
/// Weight of the common solution of all channels, for the toy, as a fraction of their common
/// energy.
const WHITE_WEIGHT: f64 = 0.003;
/// Weight of the receivers' evidence about the light on the toy, as a fraction of the toy's energy.
const RECEIVER_LIGHT_WEIGHT: f64 = 0.01;
/// Prior reflectance of a receiver, for the light from below on the toy.
const PRIOR_REFLECTANCE: f64 = 0.25;
/// Share of all lights below which the receivers' evidence about a light gains no more weight.
const LEAST_SHARE: f64 = 0.05;
/// Weight with which further receivers keep the first one's gain, as a fraction of the first
/// column's energy.
const SAME_GAIN_WEIGHT: f64 = 10.0;
/// Largest direct share of the plate's radiance: some of it is always ambient.
const MAX_DIRECT_FRACTION: f64 = 0.98;
/// Smallest fraction of the difference between frame and plate that an ambient shadow must explain
/// if no light is known.
const LEAST_EXPLAINED: f64 = 0.1;

/// Constants that a test may vary.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FitConstants {
    /// Residual of a receiver, as a fraction of the plate, at which a pixel counts half.
    pub cauchy_scale: f64,
    /// Weight of each prior against the energy of the first column.
    pub prior_weight: f64,
    /// Weight of the common solution of all channels, for the toy, as a fraction of their common
    /// energy.
    pub white_weight: f64,
    /// Weight of the receivers' evidence about the light on the toy, as a fraction of the toy's
    /// energy.
    pub receiver_light_weight: f64,
}

impl Default for FitConstants {
    fn default() -> Self {
        Self {
            cauchy_scale: CAUCHY_SCALE,
            prior_weight: PRIOR_WEIGHT,
            white_weight: WHITE_WEIGHT,
            receiver_light_weight: RECEIVER_LIGHT_WEIGHT,
        }
    }
}

/// A receiver pixel of known light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReceiverSample {
    /// Linear colour of the camera's frame.
    pub frame: DVec3,
    /// Linear colour of the plate.
    pub plate: DVec3,
    /// Its point.
    pub point: ReceiverPoint,
    /// Visibility of the ambient light.
    pub ambient: f64,
    /// Visibility of each light.
    pub visibility: DVec4,
    /// Light that the receiver reflects, relative to the gain.
    pub reflected: DVec3,
}

/// Every `stride_px`th pixel, along each side, that shows the receiver alone.
#[must_use]
pub fn receiver_samples(region: &Region, pictures: &Pictures, stride_px: u32) -> Vec<ReceiverSample> {
    let taken = Raster::from_fn(region.size_px / stride_px, |texel| texel * stride_px);
    let sample = |texel: &UVec2| {
        let at = centre_px(*texel);
        let point = region
            .receiver_point(at)
            .filter(|_| pictures.seen.at(*texel) > 0.0)?;
        Some(ReceiverSample {
            frame: pictures.frame.at(*texel),
            plate: pictures.plate.at(*texel),
            point,
            ambient: coarse_at(&pictures.ambient, region, at),
            visibility: pictures.visibility.at(*texel),
            reflected: region.reflected(point, pictures.visibility.at(*texel)),
        })
    };
    taken.texels().iter().filter_map(sample).collect()
}

/// Fits gain, bounce and shares of one receiver in `n_steps`, from `start`. Without evidence it stays
/// for the first receiver; the others have their priors.
///
/// Receivers are fitted in turn: the first determines the gain and the priors of the others.
#[must_use]
pub fn fit_receiver(
    region: &Region,
    (receiver, samples): (usize, &[ReceiverSample]),
    start: &Solution,
    constants: &FitConstants,
    n_steps: u32,
) -> Solution {
    let mut solution = start.clone();
    for step in 0..n_steps {
        let before = solution.clone();
        let of_receiver: Vec<&ReceiverSample> = samples
            .iter()
            .filter(|sample| sample.point.receiver == receiver)
            .collect();
        let of_channels = [0, 1, 2]
            .map(|channel| receiver_equations(region, &of_receiver, &before, constants, (step > 0, channel)));
        // Judged at the end.
        let is_last = step + 1 == n_steps;
        let has_no_shadow = region.lights.is_empty()
            && is_last
            && !is_ambient_shadow_known(&of_channels.each_ref().map(|(e, _)| e));
        for (channel, (equations, clipped)) in of_channels.into_iter().enumerate() {
            if receiver > 0 && equations.energy(0) <= 0.0 {
                let priors = receiver_priors(region, receiver, &before, channel);
                let unknowns: Vec<f64> = iter::once(1.0).chain(priors).collect();
                store_receiver(&unknowns, receiver, channel, &mut solution);
                solution.receivers[receiver].clipped[channel] = 0.0;
            } else if has_no_shadow {
                take_unshadowed(&equations, receiver, constants, channel, &mut solution);
            } else {
                let priors = receiver_priors(region, receiver, &before, channel);
                take_receiver(&equations, (receiver, &priors), constants, channel, &mut solution);
            }
            if equations.energy(0) > 0.0 {
                let clipped = clipped / equations.energy(0);
                solution.receivers[receiver].clipped[channel] = clipped;
            }
        }
    }
    solution
}

/// The equations, and the energy of the first column from clipped pixels.
fn receiver_equations(
    region: &Region,
    samples: &[&ReceiverSample],
    before: &Solution,
    constants: &FitConstants,
    (is_reweighted, channel): (bool, usize),
) -> (NormalEquations, f64) {
    let mut equations = NormalEquations::new(2 + region.lights.len());
    let mut of_clipped = 0.0;
    for sample in samples {
        let [frame, plate] = [sample.frame, sample.plate].map(|color| color[channel]);
        let value = frame / before.gain[channel] - sample.reflected[channel];
        let total = before.plate_falloff(region, sample.point)[channel];
        let ambient = sample.ambient;
        // Such a pixel counts as equally bright in shadow, as far as it is reliable.
        let visibility = match is_clipped(frame, plate) {
            true => DVec4::ZERO,
            false => sample.visibility,
        };
        let mut columns = vec![plate * ambient, plate * bounced(ambient, region.lights.len())];
        columns.extend((0..region.lights.len()).map(|i| {
            let intensity = before.intensities[i][channel];
            let visible = intensity * visibility[i] - ambient;
            plate * region.falloff(i, sample.point) * visible / total
        }));
        let mut weight = evidence(frame, plate);
        if is_reweighted {
            let model = before.receiver_model(region, sample.point, sample.ambient, visibility);
            let residual = value - plate * model[channel];
            weight *= cauchy_weight(residual, constants.cauchy_scale * plate);
        }
        if is_clipped(frame, plate) {
            of_clipped += weight * columns[0] * columns[0];
        }
        equations.observe(&columns, value, weight);
    }
    (equations, of_clipped)
}

/// Whether an ambient shadow explains enough of the difference between frame and plate, without
/// lights.
fn is_ambient_shadow_known(channels: &[&NormalEquations; 3]) -> bool {
    let (mut beside, mut explained) = (0.0, 0.0);
    for equations in channels.iter().filter(|equations| equations.energy(0) > 0.0) {
        // Remaining and blocked ambient light add up to the plate.
        let plate = equations.of_equal_unknowns();
        let without = plate.squares_left(&plate.solve());
        let shadowed = equations.solve();
        beside += without;
        if shadowed[1] < shadowed[0] {
            explained += without - equations.squares_left(&shadowed);
        }
    }
    explained > LEAST_EXPLAINED * beside
}

/// Assumes that a receiver is unshadowed below the toy.
fn take_unshadowed(
    observed: &NormalEquations,
    receiver: usize,
    constants: &FitConstants,
    channel: usize,
    solution: &mut Solution,
) {
    let mut plate = observed.of_equal_unknowns();
    let prior_weight = if receiver > 0 {
        SAME_GAIN_WEIGHT
    } else {
        constants.prior_weight
    };
    plate.expect(0, 1.0, prior_weight * plate.energy(0));
    let correction = plate.solve()[0];
    if observed.energy(0) <= 0.0 || correction <= 0.0 {
        return;
    }
    if receiver == 0 {
        solution.gain[channel] *= correction;
    }
    solution.receivers[receiver].bounce[channel] = MAX_BOUNCE;
}

fn take_receiver(
    observed: &NormalEquations,
    (receiver, priors): (usize, &[f64]),
    constants: &FitConstants,
    channel: usize,
    solution: &mut Solution,
) {
    let energy = observed.energy(0);
    if energy <= 0.0 {
        return;
    }
    let mut equations = observed.clone();
    let weight = constants.prior_weight * energy;
    equations.expect(0, 1.0, weight);
    if receiver > 0 {
        equations.expect(0, 1.0, SAME_GAIN_WEIGHT * energy);
    }
    priors
        .iter()
        .enumerate()
        .for_each(|(i, prior)| equations.expect(1 + i, *prior, weight));
    let unknowns = equations.solve();
    if unknowns[0] > 0.0 {
        store_receiver(unknowns.as_slice(), receiver, channel, solution);
    }
}

/// Sets a receiver's values from the unknowns of a channel, the first of which is the correction of the
/// gain.
fn store_receiver(unknowns: &[f64], receiver: usize, channel: usize, solution: &mut Solution) {
    let correction = unknowns[0];
    if receiver == 0 {
        solution.gain[channel] *= correction;
    }
    let direct_fractions = unknowns[2..].iter();
    let direct_fractions: Vec<f64> = direct_fractions.map(|one| (one / correction).max(0.0)).collect();
    let total: f64 = direct_fractions.iter().sum();
    let scale = if total > MAX_DIRECT_FRACTION {
        MAX_DIRECT_FRACTION / total
    } else {
        1.0
    };
    let found = &mut solution.receivers[receiver];
    found.bounce[channel] = (unknowns[1] / correction).clamp(0.0, MAX_BOUNCE);
    let slots = found.direct_fractions.iter_mut().zip(&direct_fractions);
    slots.for_each(|(slot, direct_fraction)| slot[channel] = scale * *direct_fraction);
}

/// A pixel of one surface of the toy.
#[derive(Clone, Debug, PartialEq)]
pub struct ToySample {
    /// Linear colour of the camera's frame.
    pub frame: DVec3,
    /// Base colour of the model, linear.
    pub base: DVec3,
    /// Unit normal, in anchor space.
    pub normal: DVec3,
    /// Cosine to each light times its visibility.
    pub received: DVec4,
    /// Reflection of a glossy surface for each unknown's light, at the plate's level; empty if it
    /// is matt.
    pub reflected: Vec<f64>,
}

/// Fits the light on the toy in `n_steps`, from `start`, which stays without evidence.
///
/// All channels together constrain what a single one does not.
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
        let each = [0, 1, 2].map(|k| toy_equations(region, samples, &solution, (step > 0, k)));
        let mut all = NormalEquations::new(n_columns);
        each.iter().for_each(|equations| all.join(equations));
        let energy = all.energy(0) + all.energy(1);
        if energy <= 0.0 {
            continue;
        }
        let [weight, white_weight, receiver_weight] = [
            constants.prior_weight,
            constants.white_weight,
            constants.receiver_light_weight,
        ]
        .map(|weight| weight * energy);
        let expect_receiver_light = |equations: &mut NormalEquations, channels: DVec3| {
            for relation in receiver_light(region, &solution, channels) {
                equations.observe(&relation, 0.0, receiver_weight);
            }
        };
        (0..n_columns).for_each(|i| all.expect(i, 0.0, weight));
        expect_receiver_light(&mut all, DVec3::splat(1.0 / 3.0));
        let white = all.solve_non_negative();
        let found = each.into_iter().enumerate().map(|(channel, mut equations)| {
            white
                .iter()
                .enumerate()
                .for_each(|(i, w)| equations.expect(i, *w, white_weight));
            expect_receiver_light(&mut equations, DVec3::AXES[channel]);
            equations.solve_non_negative()
        });
        for (channel, found) in found.collect::<Vec<_>>().iter().enumerate() {
            let slots = solution.toy.iter_mut().zip(found);
            slots.for_each(|(slot, value)| slot[channel] = *value);
        }
    }
    solution
}

/// The receivers' evidence about the light on the toy: sums of coefficients times its unknowns that
/// are 0, in the mean of `channels`.
///
/// For an unshadowed receiver, the ratio of each light's part to the ambient part is that of its
/// light at the toy times the cosine to the receiver to the ambient light on a surface parallel to
/// the receiver; light from below is reflected by the first receiver.
fn receiver_light(region: &Region, solution: &Solution, channels: DVec3) -> Vec<Vec<f64>> {
    let n_lights = region.lights.len();
    let cosine = |plane: &ReceiverPlane, i: usize| {
        let light = plane.lights[i];
        let at = DVec3::new(plane.reference_in_plane.x, 0.0, plane.reference_in_plane.y);
        (light.truncate() - light.w * at).normalize().y.max(0.0)
    };
    let of_light = |i: usize| {
        let lit = region.receivers.iter().position(|plane| cosine(plane, i) > 0.0);
        let receiver = lit.unwrap_or(0);
        let plane = &region.receivers[receiver];
        let parts = &solution.receivers[receiver].direct_fractions;
        let ambient_part = 1.0 - parts.iter().map(|part| part.dot(channels)).sum::<f64>();
        // The receiver's upward component, in anchor space.
        let upward = plane.plane_from_anchor.inverse().y_axis.y;
        let total = 1.0 - ambient_part;
        // A light that is listed twice at half intensity has the same weight.
        let weight = if total > 0.0 {
            1.0 / (parts[i].dot(channels) / total).max(LEAST_SHARE)
        } else {
            1.0
        };
        let mut relation = vec![0.0; 2 + n_lights];
        relation[0] = -parts[i].dot(channels) * (1.0 + upward) / 2.0;
        relation[1] = -parts[i].dot(channels) * (1.0 - upward) / 2.0;
        relation[2 + i] = ambient_part * cosine(plane, i);
        relation
            .iter()
            .map(|coefficient| weight.sqrt() * coefficient)
            .collect()
    };
    let mut from_below = vec![-PRIOR_REFLECTANCE, 1.0];
    from_below.extend((0..n_lights).map(|i| -PRIOR_REFLECTANCE * cosine(&region.receivers[0], i)));
    let relations = (0..n_lights).map(of_light).chain([from_below]);
    relations.collect()
}

fn toy_equations(
    region: &Region,
    samples: &[ToySample],
    before: &Solution,
    (is_reweighted, channel): (bool, usize),
) -> NormalEquations {
    let mut equations = NormalEquations::new(2 + region.lights.len());
    for sample in samples {
        let [frame, base] = [sample.frame, sample.base].map(|color| color[channel]);
        let value = frame / before.gain[channel];
        let of_sky: f64 = sample.reflected.iter().take(2).sum();
        let mut columns: Vec<f64> = toy_columns(sample.normal, sample.received, &before.intensities)
            .into_iter()
            .map(|column| base * column[channel])
            .collect();
        let levels = [1.0, 1.0].into_iter();
        let levels = levels.chain(before.intensities.iter().map(|intensity| intensity[channel]));
        for ((column, reflected), level) in columns.iter_mut().zip(&sample.reflected).zip(levels) {
            *column += level * reflected;
        }
        let mut weight = evidence(frame, frame);
        if is_reweighted {
            let model: f64 = columns
                .iter()
                .zip(&before.toy)
                .map(|(column, toy)| *column * toy[channel])
                .sum();
            weight *= cauchy_weight(value - model, TOY_CAUCHY_SCALE * (base + of_sky));
        }
        equations.observe(&columns, value, weight);
    }
    equations
}

/// The components of the light on the toy: from above, from below, and from each light at its
/// level.
#[must_use]
pub fn toy_columns(normal: DVec3, received: DVec4, intensities: &[DVec3]) -> Vec<DVec3> {
    let lights = intensities.iter().zip(received.to_array());
    let of_sky = [1.0 + normal.y, 1.0 - normal.y].map(|twice| DVec3::splat(0.5 * twice));
    let of_lights = lights.map(|(intensity, received)| *intensity * received);
    of_sky.into_iter().chain(of_lights).collect()
}

/// CPU reference of `common/toy_radiance.wgsl`: radiance of a surface of the toy over its base colour and the gain.
#[must_use]
pub fn toy_radiance(solution: &Solution, normal: DVec3, received: DVec4) -> DVec3 {
    let columns = toy_columns(normal, received, &solution.intensities);
    let terms = columns.iter().zip(&solution.toy);
    terms.map(|(column, light)| column * light).sum()
}

/// 1 for no residual, a half for one of `scale`.
fn cauchy_weight(residual: f64, scale: f64) -> f64 {
    if scale == 0.0 {
        0.0
    } else {
        scale * scale / (scale * scale + residual * residual)
    }
}
