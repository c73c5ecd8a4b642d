//! One picture of two: what the keys before and after a moment make of it, in linear light.

use super::light::{LightPicture, smoothed};
use super::stage::seen_weight;

/// How far around toy and shadows the pictures themselves are taken, in pixels: outlines and penumbras that are a little elsewhere.
const GROWN_PX: usize = 6;
/// Reach of the averages that seams are faded by, and of those that level and detail are told apart by.
const SEAM_PX: usize = 2;
const LEVEL_PX: usize = 8;
/// Averages of this reach are compared to see whether both pictures show the same.
const SAME_PX: usize = 1;
/// Differences of so many times the usual one are no noise: something stands there that the reference lacks.
const MOST_NOISE: f32 = 8.0;
/// The least that a usual difference is taken for, in linear light.
const LEAST_NOISE: f32 = 5e-4;

/// The picture whose table is shown throughout, so that neither grain nor texture changes from frame to frame.
#[derive(Clone, Debug)]
pub struct Reference {
    /// A plate, or without one the first key.
    pub picture: LightPicture,
    /// Where it shows something else than the table.
    pub touched: Option<Vec<bool>>,
}

/// What a picture is made of.
pub struct Mix<'a> {
    /// The moment, as it is made from the key before it and from that after it.
    pub pictures: [&'a LightPicture; 2],
    /// The part of the way, from 0 to 1.
    pub share: f32,
    /// How well each pixel of the toy was seen in both photographs; none where it does not show the toy.
    pub seen: [&'a [Option<f32>]; 2],
    /// Pixels of the toy and its shadows.
    pub touched: &'a [bool],
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
        match reference {
            Some(reference) => with_table(blend, reference, self.touched),
            None => blend,
        }
    }

    /// Of the key after it, pixel by pixel: by time, and on the toy by what each has seen.
    fn weights(&self) -> Vec<f32> {
        let width_px = self.pictures[0].width_px;
        let [left, right] = self.seen;
        let seen = left.iter().zip(right).map(|(left, right)| match (left, right) {
            (Some(left), Some(right)) => [seen_weight(*left), seen_weight(*right), 1.0],
            _ => [0.0; 3],
        });
        // A pixel at the outline goes by its neighbours.
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

    /// Part of the toy's pixels that neither key has seen; none where no pixel shows the toy.
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

/// The blend with the reference's detail at the blend's level, wherever neither the toy nor its shadows are.
fn with_table(blend: LightPicture, reference: &Reference, touched: &[bool]) -> LightPicture {
    let width_px = blend.width_px;
    let own = reference.touched.as_deref();
    let is_touched = |pixel: usize| touched[pixel] || own.is_some_and(|own| own[pixel]);
    let touched = (0..touched.len()).map(|pixel| [if is_touched(pixel) { 1.0 } else { 0.0 }]);
    let table = table(touched.collect(), width_px);
    let level = level(&blend, &reference.picture, &table);
    let shown: Vec<[f32; 3]> = level
        .iter()
        .zip(&reference.picture.rgb)
        .map(|(level, pixel)| [0, 1, 2].map(|channel| level[channel] * pixel[channel]))
        .collect();
    let same = same(&blend, &shown, &table);
    let pixels = blend.rgb.iter().zip(&shown).zip(table.iter().zip(&same));
    let rgb = pixels
        .map(|((blend, shown), ([table], same))| mixed(blend, shown, table * same))
        .collect();
    LightPicture { rgb, ..blend }
}

/// 1 well clear of what is touched, and 0 there.
fn table(touched: Vec<[f32; 1]>, width_px: usize) -> Vec<[f32; 1]> {
    let grown = smoothed(touched, width_px, GROWN_PX / 3);
    let grown = grown
        .into_iter()
        .map(|[near]| [if near > 1e-4 { 1.0 } else { 0.0 }]);
    let seam = smoothed(grown.collect(), width_px, SEAM_PX);
    seam.into_iter()
        .map(|[near]| [(1.0 - near).clamp(0.0, 1.0)])
        .collect()
}

/// Light of the blend over that of the reference, over a neighbourhood of the table.
fn level(blend: &LightPicture, reference: &LightPicture, table: &[[f32; 1]]) -> Vec<[f32; 3]> {
    let weighted = |picture: &LightPicture| {
        let pixels = picture.rgb.iter().zip(table);
        let pixels = pixels.map(|(pixel, [weight])| pixel.map(|light| weight * light));
        smoothed(pixels.collect(), picture.width_px, LEVEL_PX)
    };
    let pairs = weighted(blend).into_iter().zip(weighted(reference));
    let ratio = |(blend, reference): ([f32; 3], [f32; 3])| {
        [0, 1, 2].map(|channel| {
            // Far from all table there is nothing to compare, and the blend is shown.
            if reference[channel] > 1e-6 {
                blend[channel] / reference[channel]
            } else {
                1.0
            }
        })
    };
    pairs.map(ratio).collect()
}

/// 1 where two pictures differ by no more than noise, 0 where something else is seen.
fn same(blend: &LightPicture, shown: &[[f32; 3]], table: &[[f32; 1]]) -> Vec<f32> {
    let differences = blend
        .rgb
        .iter()
        .zip(shown)
        .map(|(blend, shown)| [0, 1, 2].map(|channel| blend[channel] - shown[channel]));
    let differences = smoothed(differences.collect(), blend.width_px, SAME_PX);
    let sizes = differences.iter().map(|difference| difference.map(f32::abs));
    let sizes: Vec<f32> = sizes.map(|[red, green, blue]| red.max(green).max(blue)).collect();
    let of_table = sizes.iter().zip(table).filter(|(_, [table])| *table > 0.5);
    let mut sorted: Vec<f32> = of_table.map(|(size, _)| *size).collect();
    let middle = sorted.len() / 2;
    let usual = if sorted.is_empty() {
        LEAST_NOISE
    } else {
        sorted
            .select_nth_unstable_by(middle, f32::total_cmp)
            .1
            .max(LEAST_NOISE)
    };
    sizes
        .into_iter()
        .map(|size| (2.0 - size / (MOST_NOISE * usual)).clamp(0.0, 1.0))
        .collect()
}
