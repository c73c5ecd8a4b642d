//! Classifies each pixel beside the toy: a receiver under the light that falls on it, or something
//! else.
//!
//! A thing in the place of the shadow shows frame = plate there, so that a fit of all pixels would
//! find no shadow. So frame over plate is compared, in which each pixel counts once at any
//! brightness. Where a light is hidden, the histogram of the light's share implied by this ratio
//! has a peak for each kind of surface. The peak at no light means "unchanged", which is no shadow;
//! the largest of the others starts the fit, and a mixture of three classes ends it: the receiver,
//! unchanged surfaces, and anything else.

use std::array;

use glam::{DMat4, DVec2, IVec2};

use super::background::QUADRATIC;
use super::lamp::Lamp;
use super::shading::{FIRST_LAMP, Factors, Shading};
use super::shadows::{LEAST_PIXELS, ROBUST_FAR, Shadows};
use crate::median::{DEVIATION_OF_MEDIAN_32, median};
use crate::picture::{Color, Level, brightness, index_in, noise_deviation, places};
use crate::raster::{Rasterizer, project};
use crate::receivers::SeenReceiver;
use crate::shape::Shape;
use app_scene::scene::{Light, MAX_LIGHTS};

/// Margin around toy and shadows, over their size.
const BEYOND: f64 = 0.3;
/// Hidden fraction of a light from which a pixel votes for the light's share.
const HIDDEN: f32 = 0.7;
/// Noise of a ratio from which a channel is black in the plate, if another one is not: that of a code of 10.
const BLACK: f32 = 0.1;
/// Hidden fraction of every light up to which a pixel is unshadowed.
const OPEN: f32 = 0.02;
/// Bounce of a toy of middle grey, as in `fit_solve`.
const BOUNCE: f32 = 0.27;
/// Number of bins for shares from 0 to 1.
const N_BINS: usize = 100;
/// Standard deviation of the blur of the histogram, in bins.
const BLUR_BINS: f32 = 1.5;
/// Smallest share of a light; a peak below it belongs to unchanged surfaces.
const LEAST_SHARE: f32 = 0.12;
/// Fraction of the votes that a peak needs.
const LEAST_VOTES: f32 = 0.05;
/// Largest distance of a vote from its peak, as a share of the light.
const OF_PEAK: f32 = 0.08;
/// Standard deviation of unchanged surfaces, and of the receiver at the start and at least: the
/// error of model and pictures.
const UNCHANGED: f32 = 0.06;
const FIRST_DEVIATION: f32 = 0.08;
const LEAST_DEVIATION: f32 = 0.012;
/// Other surfaces are distributed uniformly between none and this many plates.
const MOST_RATIO: f32 = 1.5;
/// Blocked share of the light below which no shadow is expected.
const CHANGED: f32 = 0.12;
/// Rounds of the mixture.
const N_ROUNDS: usize = 4;
/// Fractions of unchanged and of other surfaces among pixels without receiver.
const OF_THE_REST: [f32; 2] = [0.6, 0.4];
/// Prior probability of the receiver.
const FIRST_PRIOR: f32 = 0.6;
/// Distance of priors from 0 and 1.
const LEAST_PRIOR: f32 = 0.05;
/// Lower bound of the exposure.
const LEAST_GAIN: f64 = 1e-3;
/// Reach of the blur of the classes' probabilities, in pixels of the level.
const BLUR_PX: i32 = 3;

/// A pixel beside the toy.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Compared {
    /// Position, in pixels of the level.
    pub(crate) at: IVec2,
    /// Frame over plate, at the plate's exposure.
    pub(crate) ratio: Color,
    /// The model's value of it.
    pub(crate) model: Color,
    /// The part of each lamp's light that the toy blocks.
    pub(crate) blocked: [f32; MAX_LIGHTS],
    /// Index of the receiver that is there.
    pub(crate) on: usize,
    /// Noise of the ratio in each channel, as a deviation.
    pub(crate) noises: Color,
    /// Probability of the receiver.
    pub(crate) receiver: f32,
}

/// A level's pixels beside the toy, in given lights.
pub(crate) struct Comparison {
    pub(crate) pixels: Vec<Compared>,
    /// The light on each receiver.
    pub(super) shading: Shading,
    pub(super) lamps: Vec<Lamp>,
}

/// Compares a level's pixels beside the toy with the expectation from the plate and given lights;
/// `None` if too little is visible, or no plate or no shadow of the lights shows the place.
pub(crate) fn compare(
    lights: &[Light],
    (shape, receivers): (&Shape, &[SeenReceiver]),
    level: &Level,
    world_from_camera: &DMat4,
) -> Option<Comparison> {
    level.plate.as_ref()?;
    let camera_from_world = world_from_camera.inverse();
    let lamps = lights
        .iter()
        .map(|light| Lamp::new(light, &camera_from_world, shape.centre));
    let lamps = lamps.collect::<Option<Vec<_>>>()?;
    let mut raster = Rasterizer::default();
    if lamps.is_empty() || lamps.len() > MAX_LIGHTS {
        return None;
    }
    let rect = around(&mut raster, (shape, receivers), level, &lamps);
    let mut shadows = Shadows::within(&mut raster, (shape, receivers), level, Some(rect));
    if shadows.pixels.len() < LEAST_PIXELS {
        return None;
    }
    let taken = shadows.taken_of_all(&mut raster, &lamps);
    let gain = open_gain(&shadows, &taken)?;
    let shares = shares(&shadows, &taken, &gain)?;
    let mut mixture = Mixture::new(&shadows, &taken, level.frame.size_px);
    let mut shading = first_shading(&shares, &gain, shadows.caster.receivers.len());
    mixture.predict(&shadows, &shading);
    mixture.classify(FIRST_DEVIATION);
    for _ in 0..N_ROUNDS {
        mixture.weigh(&mut shadows);
        shading = shadows.shaded(&taken).fit(receivers.len(), ROBUST_FAR);
        mixture.predict(&shadows, &shading);
        mixture.classify(mixture.deviation());
    }
    let pixels = mixture.compared;
    Some(Comparison {
        pixels,
        shading,
        lamps,
    })
}

/// The pixels around toy and shadows, with some unaffected surroundings.
fn around(
    raster: &mut Rasterizer,
    (shape, receivers): (&Shape, &[SeenReceiver]),
    level: &Level,
    lamps: &[Lamp],
) -> [IVec2; 2] {
    let [mut low, mut high] = Shadows::around(raster, (shape, receivers), level, lamps);
    for point in project(shape.points.iter().copied(), &level.intrinsics) {
        let at = point
            .truncate()
            .clamp(DVec2::ZERO, level.frame.size_px.as_dvec2())
            .as_ivec2();
        (low, high) = (low.min(at), high.max(at));
    }
    let beyond = ((high - low).as_dvec2() * BEYOND).as_ivec2();
    [low.saturating_sub(beyond), high.saturating_add(beyond)]
}

/// Median of frame over plate at unshadowed pixels, for each channel; `None` without any.
fn open_gain(shadows: &Shadows<'_>, taken: &[Vec<f32>]) -> Option<Color> {
    let open = shadows
        .pixels
        .iter()
        .enumerate()
        .filter(|(index, pixel)| taken.iter().all(|taken| taken[*index] < OPEN) && pixel.has_evidence());
    let ratios: Vec<Color> = open.map(|(_, pixel)| ratio(pixel.frame, pixel.plate)).collect();
    medians(&ratios)
}

fn medians(colors: &[Color]) -> Option<Color> {
    let of = |channel: usize| median(colors.iter().map(|color| color[channel]), f32::total_cmp);
    Some([of(0)?, of(1)?, of(2)?])
}

fn ratio(frame: Color, plate: Color) -> Color {
    // Pixels of zero precision are never used, and all others have a plate above the darkest codes.
    [0, 1, 2].map(|channel| {
        if plate[channel] > 0.0 {
            frame[channel] / plate[channel]
        } else {
            0.0
        }
    })
}

/// The share of each lamp, by the largest peak of the hidden pixels' votes; `None` if no lamp has
/// such a peak.
fn shares(shadows: &Shadows<'_>, taken: &[Vec<f32>], gain: &Color) -> Option<Vec<Color>> {
    let shares: Vec<Option<Color>> = (0..taken.len())
        .map(|lamp| share(shadows, taken, lamp, gain))
        .collect();
    if shares.iter().all(Option::is_none) {
        return None;
    }
    Some(
        shares
            .into_iter()
            .map(|share| share.unwrap_or([0.0; 3]))
            .collect(),
    )
}

fn share(shadows: &Shadows<'_>, taken: &[Vec<f32>], lamp: usize, gain: &Color) -> Option<Color> {
    let is_hidden = |index: usize| {
        let others = taken.iter().enumerate().filter(|(other, _)| *other != lamp);
        taken[lamp][index] > HIDDEN && others.map(|(_, taken)| taken[index]).all(|taken| taken < OPEN)
    };
    let votes: Vec<Color> = (0..shadows.pixels.len())
        .filter(|index| is_hidden(*index) && shadows.pixels[*index].has_evidence())
        .filter_map(|index| implied(shadows, index, taken[lamp][index], gain))
        .collect();
    let peak = peak(votes.iter().map(brightness))?;
    let of_peak: Vec<Color> = votes
        .into_iter()
        .filter(|vote| (brightness(vote) - peak).abs() < OF_PEAK)
        .collect();
    medians(&of_peak)
}

/// The share of a lamp, if a pixel hidden from it shows the receiver; `None` if as much of the
/// ambient light is hidden.
fn implied(shadows: &Shadows<'_>, index: usize, taken: f32, gain: &Color) -> Option<Color> {
    let pixel = &shadows.pixels[index];
    let hidden = shadows.ambient_taken(index);
    let spread = taken - hidden;
    (spread > 0.25).then(|| {
        let ratio = ratio(pixel.frame, pixel.plate);
        let bounced = (1.0 - hidden) * (1.0 + BOUNCE * hidden);
        [0, 1, 2].map(|channel| (bounced - ratio[channel] / gain[channel]) / spread)
    })
}

/// The mode of the values, without unchanged surfaces; `None` if no bin has enough of them.
fn peak(values: impl Iterator<Item = f32>) -> Option<f32> {
    let mut bins = [0.0_f32; N_BINS];
    let mut n_values = 0.0;
    for value in values {
        n_values += 1.0;
        #[allow(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "clamped to the bins"
        )]
        let bin = (value.clamp(0.0, 1.0) * (N_BINS - 1) as f32).round() as usize;
        bins[bin] += 1.0;
    }
    let blurred = blurred(&bins);
    let first = (LEAST_SHARE * N_BINS as f32).ceil();
    let is_peak = |bin: usize| {
        let around = &blurred[bin.saturating_sub(1)..(bin + 2).min(N_BINS)];
        around.iter().all(|other| *other <= blurred[bin])
    };
    let votes = |bin: usize| {
        let reach = (OF_PEAK * N_BINS as f32).round();
        #[allow(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "some bins"
        )]
        let reach = reach as usize;
        bins[bin.saturating_sub(reach)..(bin + reach + 1).min(N_BINS)]
            .iter()
            .sum::<f32>()
    };
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a bin")]
    let peaks = (first as usize..N_BINS).filter(|bin| is_peak(*bin));
    let best = peaks.max_by(|a, b| votes(*a).total_cmp(&votes(*b)))?;
    (n_values > 0.0 && votes(best) >= LEAST_VOTES * n_values).then(|| best as f32 / (N_BINS - 1) as f32)
}

fn blurred(bins: &[f32; N_BINS]) -> [f32; N_BINS] {
    array::from_fn(|bin| {
        let weights = bins.iter().enumerate().map(|(other, votes)| {
            let away = (other as f32 - bin as f32) / BLUR_BINS;
            votes * (-0.5 * away * away).exp()
        });
        weights.sum()
    })
}

/// The lamps' shares on every receiver; the rest is ambient light.
fn first_shading(shares: &[Color], gain: &Color, n_receivers: usize) -> Shading {
    let of_channel = |channel: usize| {
        let mut factors = Factors::zeros();
        let gain = f64::from(gain[channel]);
        factors[0] = gain;
        let mut rest = 1.0;
        for (lamp, share) in shares.iter().enumerate() {
            let share = f64::from(share[channel]).clamp(0.0, 1.0);
            factors[FIRST_LAMP + lamp] = gain * share;
            rest -= share;
        }
        factors[QUADRATIC] = gain * rest.max(0.0);
        factors
    };
    Shading {
        factors: vec![[0, 1, 2].map(of_channel); n_receivers],
        loss: f64::INFINITY,
    }
}

/// The classes of the pixels.
struct Mixture<'a> {
    taken: &'a [Vec<f32>],
    size_px: IVec2,
    /// Precisions of the pixels themselves.
    precisions: Vec<Color>,
    compared: Vec<Compared>,
}

impl<'a> Mixture<'a> {
    fn new(shadows: &Shadows<'_>, taken: &'a [Vec<f32>], size_px: IVec2) -> Self {
        let compared = shadows.pixels.iter().enumerate().map(|(index, pixel)| Compared {
            at: pixel.at,
            on: pixel.receiver,
            ratio: [1.0; 3],
            model: [1.0; 3],
            blocked: array::from_fn(|lamp| taken.get(lamp).map_or(0.0, |taken| taken[index])),
            noises: [0.0; 3],
            receiver: FIRST_PRIOR,
        });
        Self {
            taken,
            size_px,
            precisions: shadows.pixels.iter().map(|pixel| pixel.precision).collect(),
            compared: compared.collect(),
        }
    }

    /// Compares all pixels with a shading.
    fn predict(&mut self, shadows: &Shadows<'_>, shading: &Shading) {
        let shaded = shadows.shaded(self.taken);
        for (index, compared) in self.compared.iter_mut().enumerate() {
            let pixel = &shadows.pixels[index];
            let columns = shaded.columns(index);
            let ratio = ratio(pixel.frame, pixel.plate);
            let of_channels = shading.factors[pixel.receiver].map(|factors| {
                let gain: f64 = (0..QUADRATIC).map(|term| columns[term] * factors[term]).sum();
                #[allow(clippy::cast_possible_truncation, reason = "ratios, to 7 digits")]
                let both = (gain.max(LEAST_GAIN) as f32, columns.dot(&factors) as f32);
                both
            });
            compared.ratio = [0, 1, 2].map(|channel| ratio[channel] / of_channels[channel].0);
            compared.noises = [0, 1, 2].map(|channel| {
                let plate = pixel.plate[channel] * of_channels[channel].0;
                noise_deviation(pixel.frame[channel]) / plate.max(f32::MIN_POSITIVE)
            });
            compared.model = of_channels.map(|(gain, lit)| lit / gain);
        }
    }

    /// Updates the probability of the receiver from the residuals of pixels and their neighbours.
    fn classify(&mut self, deviation: f32) {
        let priors = self.priors();
        for (compared, prior) in self.compared.iter_mut().zip(priors) {
            compared.receiver = compared.probability(prior, deviation);
        }
    }

    /// Prior of the receiver from the neighbours of each pixel: uniform at first.
    fn priors(&self) -> Vec<f32> {
        let mut sums = vec![[0.0; 2]; (self.size_px.x * self.size_px.y) as usize];
        for compared in &self.compared {
            if let Some(index) = index_in(self.size_px, compared.at) {
                sums[index] = [compared.receiver, 1.0];
            }
        }
        let blurred = box_blurred(
            &box_blurred(&sums, self.size_px, IVec2::X),
            self.size_px,
            IVec2::Y,
        );
        let prior = self.compared.iter().map(|compared| {
            let [sum, n] = index_in(self.size_px, compared.at).map_or([1.0, 1.0], |index| blurred[index]);
            (sum / n.max(1.0)).clamp(LEAST_PRIOR, 1.0 - LEAST_PRIOR)
        });
        prior.collect()
    }

    /// Weights pixels by their probability of the receiver.
    fn weigh(&self, shadows: &mut Shadows<'_>) {
        for ((pixel, precision), compared) in shadows
            .pixels
            .iter_mut()
            .zip(&self.precisions)
            .zip(&self.compared)
        {
            pixel.precision = precision.map(|precision| precision * compared.receiver);
        }
    }

    /// Standard deviation of the receiver's pixels from the prediction.
    fn deviation(&self) -> f32 {
        let near = self
            .compared
            .iter()
            .filter(|compared| compared.receiver > 0.5 && compared.is_changed());
        let away = median(near.map(Compared::away), f32::total_cmp).unwrap_or(0.0);
        (DEVIATION_OF_MEDIAN_32 * away).clamp(LEAST_DEVIATION, FIRST_DEVIATION)
    }
}

/// Sums over a box along an axis.
fn box_blurred(values: &[[f32; 2]], size_px: IVec2, axis: IVec2) -> Vec<[f32; 2]> {
    let sum = |at: IVec2| {
        let taps = (-BLUR_PX..=BLUR_PX).filter_map(|step| index_in(size_px, at + step * axis));
        taps.fold([0.0; 2], |sum, index| {
            [sum[0] + values[index][0], sum[1] + values[index][1]]
        })
    };
    places(size_px).map(sum).collect()
}

impl Compared {
    /// Noise of the ratio, as a deviation: that of the noisiest channel.
    pub(crate) fn noise(&self) -> f32 {
        self.noises.into_iter().fold(0.0, f32::max)
    }

    /// Largest difference of a channel from the model, in plates.
    fn away(&self) -> f32 {
        (0..3)
            .map(|channel| (self.ratio[channel] - self.model[channel]).abs())
            .fold(0.0, f32::max)
    }

    /// Whether a channel differs from the model by more than a number of plates, and than a multiple of the
    /// noise, without channels that are black in the plate.
    pub(crate) fn is_away(&self, least: f32, of_noise: f32) -> bool {
        self.is_beyond(&self.model, (least, of_noise))
    }

    /// Whether a channel has changed since the plate by more than a number of plates, whatever the noise.
    pub(crate) fn has_changed(&self, least: f32) -> bool {
        self.is_beyond(&[1.0; 3], (least, 0.0))
    }

    fn is_beyond(&self, from: &Color, (least, of_noise): (f32, f32)) -> bool {
        let usable = self.noises.into_iter().fold(f32::INFINITY, f32::min).max(BLACK);
        let is_usable = |noise: &f32| *noise <= usable;
        let noise = self.noises.into_iter().filter(is_usable).fold(0.0, f32::max);
        (0..3)
            .filter(|channel| is_usable(&self.noises[*channel]))
            .any(|channel| (self.ratio[channel] - from[channel]).abs() > least.max(of_noise * noise))
    }

    /// The share of the light that the model blocks.
    pub(crate) fn taken(&self) -> f32 {
        1.0 - brightness(&self.model)
    }

    /// Whether the model blocks a visible share of light.
    pub(crate) fn is_changed(&self) -> bool {
        self.taken() > CHANGED
    }

    /// Probability of the receiver, with its neighbours' as prior.
    fn probability(&self, receiver: f32, deviation: f32) -> f32 {
        let [unchanged, other] = OF_THE_REST.map(|part| part * (1.0 - receiver));
        let density = |from: &Color, deviation: f32| {
            let squares: f32 = (0..3)
                .map(|channel| ((self.ratio[channel] - from[channel]) / deviation).powi(2))
                .sum();
            // The three channels are correlated, so that they count as one.
            (-0.5 * squares / 3.0).exp() / deviation
        };
        let deviation = deviation.hypot(self.noise());
        let receiver = receiver * density(&self.model, deviation);
        let unchanged = if self.is_changed() {
            unchanged * density(&[1.0; 3], UNCHANGED.hypot(self.noise()))
        } else {
            0.0
        };
        let other = other / MOST_RATIO;
        receiver / (receiver + unchanged + other)
    }
}
