//! Blends two pictures in linear light: those made for a moment from the keys before and after it.

use app_core::grain::Grain;
use reference::grain::grain_at;

use super::light::{LightPicture, smoothed};
use super::stage::seen_weight;

/// Reach of the averages that fade seams.
const SEAM_PX: usize = 2;
/// Reach of the averages by which two pictures are compared.
const SAME_PX: usize = 1;
/// Lower bound of the usual difference, as a fraction of the light.
const LEAST_NOISE: f32 = 2e-3;
/// Lower bound of the light that differences are divided by.
const DARK: f32 = 0.01;

/// The use of the reference's detail, and its separation from the level.
#[derive(Clone, Copy, Debug)]
struct Detail {
    /// Distance of the detail from whatever lies on it, in pixels.
    clear_px: usize,
    /// Reach of the averages that define the level, in pixels.
    level_px: usize,
    /// Ratio to the usual difference above which a difference is no noise: an edge, or something
    /// that the reference lacks.
    most_noise: f32,
}

/// The table far from toy and shadows, outlines and penumbras of other frames included.
const TABLE: Detail = Detail {
    clear_px: 6,
    level_px: 8,
    most_noise: 8.0,
};
/// The table in shadow, away from the toy: a shadow is a smooth factor. Chosen on one shot, on
/// which half and twice as much noise are within a fiftieth.
const SHADOW: Detail = Detail {
    clear_px: 3,
    level_px: 1,
    most_noise: 2.0,
};

/// The picture whose table is shown throughout, so that neither grain nor texture changes from
/// frame to frame.
#[derive(Clone, Debug)]
pub struct Reference {
    /// A plate, or without plates the first key.
    pub picture: LightPicture,
    /// Pixels that show something else than the table.
    pub touched: Option<Vec<bool>>,
}

/// The grain of the photographs, of which a mean of two has less.
#[derive(Clone, Copy, Debug)]
pub struct FrameGrain {
    /// The measured grain.
    pub grain: Grain,
    /// The frame; its noise differs from others'.
    pub frame: u32,
}

/// The input of a blend.
pub struct Mix<'a> {
    /// The pictures of the moment, made from the key before it and from the key after it.
    pub pictures: [&'a LightPicture; 2],
    /// The share of the way, from 0 to 1.
    pub share: f32,
    /// Visibility of each pixel of the toy in both photographs; `None` for pixels beside the toy.
    pub seen: [&'a [Option<f32>]; 2],
    /// Pixels of the toy.
    pub covered: &'a [bool],
    /// Pixels of the toy and its shadows.
    pub touched: &'a [bool],
    /// `None` if the photographs have hardly any.
    pub grain: Option<FrameGrain>,
}

impl Mix<'_> {
    /// The picture.
    #[must_use]
    pub fn blended(&self, reference: Option<&Reference>) -> LightPicture {
        let [left, right] = self.pictures;
        let weights = self.weights();
        let pixels = left.rgb.iter().zip(&right.rgb).zip(&weights);
        let rgb = pixels
            .map(|((left, right), weight)| mixed(left, right, *weight))
            .collect();
        let blend = LightPicture { rgb, ..*left };
        let blend = match reference {
            Some(reference) => self.with_table(blend, reference),
            None => blend,
        };
        match &self.grain {
            Some(grain) => self.with_grain(blend, grain, &weights),
            None => blend,
        }
    }

    /// Adds the missing noise on toy and shadows: means of two photographs with independent noise
    /// have `w^2 + (1 - w)^2` of its variance. The table beside them shows one photograph and needs
    /// none.
    fn with_grain(&self, blend: LightPicture, of_frame: &FrameGrain, weights: &[f32]) -> LightPicture {
        let FrameGrain { grain, frame } = *of_frame;
        let (near, channels) = (grain.weights.map(f64::from), f64::from(grain.channels));
        let clear = TABLE.clear(self.touched, blend.width_px);
        let side = |pixel: usize| i32::try_from(pixel).unwrap_or(i32::MAX);
        let pixels = blend.rgb.iter().zip(weights).zip(&clear).enumerate();
        let rgb = pixels.map(|(index, ((pixel, weight), [clear]))| {
            let missing = f64::from(2.0 * weight * (1.0 - weight) * (1.0 - clear));
            if missing <= 0.0 {
                return *pixel;
            }
            let at = [side(index % blend.width_px), side(index / blend.width_px)];
            let noise = grain_at(at, frame, near, channels);
            [0, 1, 2].map(|channel| {
                let light = f64::from(pixel[channel]);
                let deviation = (missing * grain.frame.variance(light.max(0.0))).sqrt();
                #[allow(clippy::cast_possible_truncation, reason = "of the range of light")]
                let grained = (light + deviation * noise[channel]) as f32;
                grained
            })
        });
        LightPicture {
            rgb: rgb.collect(),
            ..blend
        }
    }

    /// The blend with the reference's detail on the table, in the light, and in shadow if the
    /// pictures are clean.
    fn with_table(&self, blend: LightPicture, reference: &Reference) -> LightPicture {
        let own = reference.touched.as_deref();
        let with_own = |covered: &[bool]| -> Vec<bool> {
            let pixels = covered.iter().enumerate();
            let is_covered =
                |(pixel, is_covered): (usize, &bool)| *is_covered || own.is_some_and(|own| own[pixel]);
            pixels.map(is_covered).collect()
        };
        let table = &reference.picture;
        let blend = if self.grain.is_none() {
            SHADOW.shown(blend, table, &with_own(self.covered), |pixel| self.touched[pixel])
        } else {
            // The plate's grain, darkened as by a shadow, is weaker than a photograph's there.
            blend
        };
        TABLE.shown(blend, table, &with_own(self.touched), |_| true)
    }

    /// Weights of the key after the moment, pixel by pixel: by time, and on the toy by visibility.
    fn weights(&self) -> Vec<f32> {
        let width_px = self.pictures[0].width_px;
        let [left, right] = self.seen;
        let seen = left.iter().zip(right).map(|(left, right)| match (left, right) {
            (Some(left), Some(right)) => [seen_weight(*left), seen_weight(*right), 1.0],
            _ => [0.0; 3],
        });
        // A pixel at the outline takes the value of its neighbours.
        let seen = smoothed(seen.collect(), width_px, SAME_PX);
        let weight = |[left, right, covered]: [f32; 3]| {
            let [left, right] = [(1.0 - self.share) * left, self.share * right];
            let sum = left + right;
            if covered > 0.0 && sum > 0.0 {
                right / sum
            } else {
                self.share
            }
        };
        seen.into_iter().map(weight).collect()
    }

    /// Share of the toy's pixels that neither key shows; `None` if no pixel shows the toy.
    #[must_use]
    pub fn unseen(&self) -> Option<f64> {
        let [left, right] = self.seen;
        let pairs = left.iter().zip(right);
        let pairs = pairs.filter_map(|(left, right)| Some((*left)?.max((*right)?)));
        let (mut n_shown, mut n_unseen) = (0.0, 0.0);
        for seen in pairs {
            n_shown += 1.0;
            n_unseen += if seen > 0.0 { 0.0 } else { 1.0 };
        }
        (n_shown > 0.0).then(|| n_unseen / n_shown)
    }
}

fn mixed(a: &[f32; 3], b: &[f32; 3], weight: f32) -> [f32; 3] {
    [0, 1, 2].map(|channel| (1.0 - weight) * a[channel] + weight * b[channel])
}

impl Detail {
    /// The blend with the reference's detail at the blend's level, wherever it is clear of
    /// `covered` pixels. The usual difference is taken from the `usual` pixels.
    fn shown(
        self,
        blend: LightPicture,
        reference: &LightPicture,
        covered: &[bool],
        usual: impl Fn(usize) -> bool,
    ) -> LightPicture {
        let clear = self.clear(covered, blend.width_px);
        let level = self.level(&blend, reference, &clear);
        let detailed: Vec<[f32; 3]> = level
            .iter()
            .zip(&reference.rgb)
            .map(|(level, pixel)| [0, 1, 2].map(|channel| level[channel] * pixel[channel]))
            .collect();
        let same = self.same(&blend, &detailed, |pixel| clear[pixel][0] > 0.5 && usual(pixel));
        let pixels = blend.rgb.iter().zip(&detailed).zip(clear.iter().zip(&same));
        let rgb = pixels
            .map(|((blend, detailed), ([clear], same))| mixed(blend, detailed, clear * same))
            .collect();
        LightPicture { rgb, ..blend }
    }

    /// 1 far from covered pixels, and 0 on them.
    fn clear(self, covered: &[bool], width_px: usize) -> Vec<[f32; 1]> {
        let near = |is_near: bool| [if is_near { 1.0 } else { 0.0 }];
        let covered = covered.iter().map(|is_covered| near(*is_covered));
        let grown = smoothed(covered.collect(), width_px, self.clear_px / 3);
        let grown = grown.into_iter().map(|[value]| near(value > 1e-4));
        let seam = smoothed(grown.collect(), width_px, SEAM_PX);
        seam.into_iter()
            .map(|[near]| [(1.0 - near).clamp(0.0, 1.0)])
            .collect()
    }

    /// Light of the blend over that of the reference, over a neighbourhood of clear pixels.
    fn level(self, blend: &LightPicture, reference: &LightPicture, clear: &[[f32; 1]]) -> Vec<[f32; 3]> {
        let weighted = |picture: &LightPicture| {
            let pixels = picture.rgb.iter().zip(clear);
            let pixels = pixels.map(|(pixel, [weight])| pixel.map(|light| weight * light));
            smoothed(pixels.collect(), picture.width_px, self.level_px)
        };
        let pairs = weighted(blend).into_iter().zip(weighted(reference));
        let ratio = |(blend, reference): ([f32; 3], [f32; 3])| {
            [0, 1, 2].map(|channel| {
                // Far from all clear pixels there is nothing to compare, and the blend is shown.
                if reference[channel] > 1e-6 {
                    blend[channel] / reference[channel]
                } else {
                    1.0
                }
            })
        };
        pairs.map(ratio).collect()
    }

    /// 1 if two pictures differ by no more than noise, 0 if they show different things.
    fn same(self, blend: &LightPicture, detailed: &[[f32; 3]], is_usual: impl Fn(usize) -> bool) -> Vec<f32> {
        let pairs = blend.rgb.iter().zip(detailed);
        let differences = pairs.map(|(blend, detailed)| {
            [0, 1, 2].map(|channel| (blend[channel] - detailed[channel]) / blend[channel].max(DARK))
        });
        let differences = smoothed(differences.collect(), blend.width_px, SAME_PX);
        let sizes = differences.iter().map(|difference| difference.map(f32::abs));
        let sizes: Vec<f32> = sizes.map(|[red, green, blue]| red.max(green).max(blue)).collect();
        let sorted = sizes.iter().enumerate().filter(|(pixel, _)| is_usual(*pixel));
        let mut sorted: Vec<f32> = sorted.map(|(_, size)| *size).collect();
        let middle = sorted.len() / 2;
        let usual = if sorted.is_empty() {
            LEAST_NOISE
        } else {
            *sorted.select_nth_unstable_by(middle, f32::total_cmp).1
        };
        let most = self.most_noise * usual.max(LEAST_NOISE);
        sizes
            .into_iter()
            .map(|size| (2.0 - size / most).clamp(0.0, 1.0))
            .collect()
    }
}
