//! Warnings about the fits, read back from the device: for reports, never during a frame.

use super::inspect::Inspect;
use super::{Core, CoreError};
use crate::frame::warning::{Mismatch, Outlier, Warning};
use crate::model::diagnostics::conditioning::light_conditioning;
use crate::model::diagnostics::evidence::{Evidence, PixelEvidence, linear_colors};
use crate::model::diagnostics::outliers::{ReceiverCells, outliers};
use crate::model::state::grids::MAX_CELLS;
use crate::model::state::solution::Fit;
use crate::readback::Map;
use crate::stage::Stage;

/// Conditioning below which a light's intensity is under-constrained, and sum of the lights'
/// conditioning below which too little of the real shadow is visible. Two lights at one position
/// have 0.5 each; lights with different shadows have more than 0.99.
const LEAST_CONDITIONING: f64 = 0.75;
/// Share of the lights in the plate's radiance below which no real shadow is assumed: its edge
/// would hardly be visible.
const LEAST_DIRECT_FRACTION: f32 = 0.03;
/// The same, if only one channel has a share.
const CLEAR_DIRECT_FRACTION: f32 = 0.2;
/// Darkest and brightest bounce: no paint reflects less than a hundredth of the light or more than
/// 99 hundredths.
const POSSIBLE_BOUNCE: [f32; 2] = [0.01, 0.99];
/// Light relative to the plate's below which a toy is dark. A dark table may reflect more light
/// than expected; then no warning is given.
const DARK_TOY: f64 = 0.15;
/// Pixels of real shadow below which its strength is uncertain: with up to 18 pixels a direct
/// fraction was wrong by 0.06 to 0.16, with 35 and more by at most 0.06.
const FEWEST_PIXELS: f64 = 25.0;
/// Share of unreadable plate or shadow pixels from which a warning is given: the remaining pixels
/// are not representative.
const UNREADABLE: f64 = 0.5;
/// Share of the toy's pixels that show the plate, from which the toy is considered absent. A toy of
/// the table's colour differs by its shading.
const NOT_SEEN: f64 = 0.8;
/// Standard deviation of the colours between picture and plate, as a logarithm, from which red and
/// blue may be swapped: more than grain.
const COLORS_DIFFER: f64 = 0.1;
/// Factor by which the deviation must shrink when red and blue are swapped.
const TIMES_LESS: f64 = 2.0;

impl Core {
    /// Waits for the device and returns warnings about the fits, up to the latest frame.
    ///
    /// # Errors
    /// If the device is lost.
    pub fn read_fit_warnings(&self) -> Result<Vec<Warning>, CoreError> {
        let Some(fit) = self.read_fit()? else {
            return self.read_baseline_warnings();
        };
        let evidence = self.read_evidence(&fit)?;
        let about_pictures = evidence.as_ref().and_then(unseen);
        // The evidence explains why the fit is weak.
        let about_fit = match (&about_pictures, &evidence) {
            (None, Some(evidence)) => self.about_fit(&fit, evidence)?,
            _ => None,
        };
        let swapped = evidence.as_ref().and_then(swapped);
        let warnings = about_pictures
            .into_iter()
            .chain(swapped)
            .map(Warning::Mismatch)
            .chain(about_fit);
        let outliers = self.read_outliers()?.into_iter().map(Warning::Outlier);
        Ok(warnings.chain(outliers).collect())
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

    /// Evidence in the pictures of the latest view.
    fn read_evidence(&self, fit: &Fit) -> Result<Option<Evidence>, CoreError> {
        let (Some(model), Some(image)) = (self.model(), self.stage.as_ref().and_then(Stage::learned_image))
        else {
            return Ok(None);
        };
        let (Some(plate), Some(validity), Some(visibility)) = (
            self.read_map(Map::Plate)?,
            self.read_map(Map::Validity)?,
            self.read_map(Map::PhysicalVisibility)?,
        ) else {
            return Ok(None);
        };
        let frame = linear_colors(image, &model.region.rect());
        let n_lights = model.region.plan.n_lights;
        let pixel = |k: usize| PixelEvidence {
            frame: frame[k],
            plate: plate.texels[k],
            validity: validity.texels[k],
            visibility: visibility.texels[k][..n_lights]
                .iter()
                .copied()
                .fold(1.0, f32::min),
        };
        Ok(Some(Evidence::of((0..frame.len()).map(pixel), &fit.gain)))
    }

    /// Warnings about the unknown part of the shadow's strength.
    fn about_fit(&self, fit: &Fit, evidence: &Evidence) -> Result<Option<Warning>, CoreError> {
        let conditioning = self.read_conditioning()?;
        let (Some(stage), Some(model)) = (&self.stage, self.model()) else {
            return Ok(None);
        };
        if model.region.plan.n_lights == 0 {
            let strength = ambient_strength(fit);
            return Ok(Some(Warning::AmbientAlone { strength }));
        }
        if conditioning.is_empty() {
            return Ok(None);
        }
        let known: f64 = conditioning.iter().map(|(_, known)| known).sum();
        if known < LEAST_CONDITIONING {
            // If the toy is outside the picture, a warning of the frame reports it.
            let faint = Warning::FaintShadow { assumed: 1.0 - known };
            return Ok(stage.is_toy_in_picture().then_some(faint));
        }
        let direct_fractions = total_direct_fractions(fit, model.region.plan.n_receivers);
        if let Some(direct_fraction) = absent(direct_fractions) {
            return Ok(Some(Warning::Mismatch(Mismatch::NoShadow { direct_fraction })));
        }
        if let Some(color) = absent_color(direct_fractions) {
            return Ok(Some(Warning::Mismatch(Mismatch::NoShadowInColor { color })));
        }
        let n_pixels = evidence.n_shadow_pixels();
        if n_pixels < FEWEST_PIXELS && stage.is_first_view() {
            return Ok(Some(Warning::SmallShadow { n_pixels }));
        }
        let unknown = conditioning
            .iter()
            .filter(|(_, known)| *known < LEAST_CONDITIONING);
        let lights: Vec<usize> = unknown.map(|(light, _)| *light).collect();
        Ok(if lights.is_empty() {
            bounce_at_limit(fit, evidence)
        } else {
            Some(Warning::LightsUnderConstrained { lights })
        })
    }

    /// Share of each light's intensity that is measured rather than assumed, with its index in the
    /// caller's list; lights inside the toy, which cast no shadow, are left out.
    fn read_conditioning(&self) -> Result<Vec<(usize, f64)>, CoreError> {
        let (Some(stage), Some(model)) = (&self.stage, self.model()) else {
            return Ok(Vec::new());
        };
        let sums = self.gpu.read_buffer(&model.state.fit_sums)?;
        let sums: Vec<f32> = bytemuck::pod_collect_to_vec(&sums);
        let conditioning = light_conditioning(&sums, model.region.plan.n_lights);
        let lights = stage.light_indices().iter().copied().zip(conditioning);
        Ok(lights
            .filter(|(light, _)| !stage.lights_inside().contains(light))
            .collect())
    }

    fn read_outliers(&self) -> Result<Vec<Outlier>, CoreError> {
        let Some(model) = self.model() else {
            return Ok(Vec::new());
        };
        let accumulated = self.gpu.read_buffer(&model.state.residual.accumulated)?;
        let accumulated: Vec<[f32; 4]> = bytemuck::pod_collect_to_vec(&accumulated);
        let grids = model.state.layout.grids;
        let receivers = accumulated
            .chunks(MAX_CELLS)
            .zip(&grids)
            .map(|(accumulated, grid)| {
                let [width, height] = grid.size.map(|n_cells| n_cells as usize);
                outliers(&ReceiverCells {
                    accumulated: &accumulated[..width * height],
                    width,
                    cell_m: grid.cell_m,
                })
            });
        let mut found: Vec<Outlier> = receivers.flatten().collect();
        found.sort_unstable_by_key(|outlier| *outlier as u8);
        found.dedup();
        Ok(found)
    }
}

/// Share of the light that counts as ambient where no other information exists, on the receiver on
/// which the toy stands.
fn ambient_strength(fit: &Fit) -> f32 {
    let [r, g, b, _] = fit.receivers[0].bounce;
    // The bounce is at most 1, except for rounding.
    (1.0 - (r + g + b) / 3.0).max(0.0)
}

/// A warning if, in most channels, the bounce on the receiver on which the toy stands is impossible
/// for a toy. A channel in which the toy itself is dark may have no bounce.
fn bounce_at_limit(fit: &Fit, evidence: &Evidence) -> Option<Warning> {
    let toy = evidence.toy_over_plate()?;
    let [red, green, blue, _] = fit.receivers[0].bounce;
    let channels = || [red, green, blue].into_iter().zip(toy);
    let n_black = channels().filter(|(bounce, toy)| *bounce < POSSIBLE_BOUNCE[0] && *toy > DARK_TOY);
    let is_black = n_black.count() >= 2;
    let is_white = channels()
        .filter(|(bounce, _)| *bounce > POSSIBLE_BOUNCE[1])
        .count()
        >= 2;
    (is_black || is_white).then_some(Warning::BounceAtLimit { is_black })
}

/// Share of all lights in the plate's radiance in each channel, on the receiver with the largest
/// one.
fn total_direct_fractions(fit: &Fit, n_receivers: u32) -> [f32; 3] {
    let receivers = || fit.receivers.iter().take(n_receivers as usize);
    [0, 1, 2].map(|channel| {
        let total = |lights: &[[f32; 4]]| lights.iter().map(|light| light[channel]).sum();
        receivers()
            .map(|receiver| total(&receiver.direct_fraction))
            .fold(0.0, f32::max)
    })
}

/// The largest of the lights' shares, if they cast no visible shadow. A shadow in one channel alone
/// is that of a coloured light only if it is a clear one.
fn absent(mut fractions: [f32; 3]) -> Option<f32> {
    fractions.sort_unstable_by(f32::total_cmp);
    let [_, second, most] = fractions;
    let is_absent =
        most < LEAST_DIRECT_FRACTION || (second < LEAST_DIRECT_FRACTION && most < CLEAR_DIRECT_FRACTION);
    is_absent.then_some(most)
}

/// The colour that has no visible shadow, though others have.
fn absent_color(fractions: [f32; 3]) -> Option<&'static str> {
    let mut colors = ["red", "green", "blue"].into_iter().zip(fractions);
    colors
        .find(|(_, fraction)| *fraction < LEAST_DIRECT_FRACTION)
        .map(|(color, _)| color)
}

/// The first thing missing in the pictures that explains the others.
fn unseen(evidence: &Evidence) -> Option<Mismatch> {
    let at_least = |share: Option<f64>, least: f64| share.filter(|share| *share >= least);
    let plate = at_least(evidence.unreadable_plate(), UNREADABLE);
    let toy = at_least(evidence.toy_as_plate(), NOT_SEEN);
    let shadow = at_least(evidence.unreadable_shadow(), UNREADABLE);
    plate
        .map(|fraction| Mismatch::PlateUnreadable { fraction })
        .or(toy.map(|fraction| Mismatch::ToyNotSeen { fraction }))
        .or(shadow.map(|fraction| Mismatch::ShadowUnreadable { fraction }))
}

fn swapped(evidence: &Evidence) -> Option<Mismatch> {
    let [as_they_are, swapped] = evidence.color_spreads()?;
    let is_swapped = as_they_are > COLORS_DIFFER && as_they_are > TIMES_LESS * swapped;
    is_swapped.then(|| Mismatch::RedAndBlueSwapped {
        times: as_they_are / swapped,
    })
}
