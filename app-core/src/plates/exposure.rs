//! Exposures: gains between plates, and from the plates to a frame.

use glam::{DVec2, DVec3, UVec2};

use crate::geometry::anchored::AnchoredReceiver;
use crate::geometry::color::linear_from_srgb;
use crate::geometry::rect::PixelRect;
use crate::plates::choice::view_of;
use crate::plates::sight::Sight;
use crate::scene::{Image, Plate, Scene};

/// Sample points along each side of a plate, at which its exposure is compared with another's.
const N_COMPARED: u32 = 48;
/// Half the side of the square that is averaged at each: misaligned plates still agree.
const COMPARED_RADIUS_PX: i64 = 3;
/// Codes that are neither mostly quantisation nor perhaps clipped.
const USABLE_CODES: std::ops::RangeInclusive<u8> = 10..=250;
/// Difference between two plates, relative, at which a sample counts half.
const CAUCHY_SCALE: f64 = 0.05;
/// Minimum number of samples of a gain.
const FEWEST_COMPARED: usize = 16;
/// Steps of the reweighted least squares.
const N_STEPS: usize = 8;

/// Gain of each plate to the exposure of the first, per channel of linear light; 1 where they share no sample.
pub(crate) fn match_plates(scene: &Scene, receivers: &[AnchoredReceiver]) -> Vec<DVec3> {
    let decoded = decoded();
    let mut gains: Vec<DVec3> = Vec::new();
    for (index, plate) in scene.plates.iter().enumerate() {
        let mut pairs = Vec::new();
        for (other, gain) in scene.plates.iter().zip(&gains) {
            pairs.extend(
                shared_places((scene, receivers), plate, other, &decoded)
                    .map(|shared| (shared.here, *gain * shared.there)),
            );
        }
        gains.push(if index == 0 { DVec3::ONE } else { gain_of(&pairs) });
    }
    gains
}

/// Gain of the scene's first plate to the exposure of a frame, per channel of linear light; 1 where they share no
/// sample. `chosen` are indices of plates that are seen from there, `gains` bring each of the scene's to the first.
///
/// Samples `within`, which contains all of toy and shadows, count only where too few others are shared.
pub(crate) fn match_frame(
    (scene, receivers): (&Scene, &[AnchoredReceiver]),
    frame: &Plate,
    (chosen, gains): (&[usize], &[DVec3]),
    within: &PixelRect,
) -> DVec3 {
    let decoded = decoded();
    let shared: Vec<Shared> = chosen
        .iter()
        .flat_map(|index| {
            let shared = shared_places((scene, receivers), frame, &scene.plates[*index], &decoded);
            shared.map(|one| Shared {
                there: gains[*index] * one.there,
                ..one
            })
        })
        .collect();
    let (min, max) = (
        within.origin_px.as_dvec2(),
        (within.origin_px + within.size_px).as_dvec2(),
    );
    let is_outside = |one: &&Shared| one.px.cmplt(min).any() || one.px.cmpge(max).any();
    let pair = |one: &Shared| (one.there, one.here);
    let outside: Vec<_> = shared.iter().filter(is_outside).map(pair).collect();
    if outside.len() >= FEWEST_COMPARED {
        gain_of(&outside)
    } else {
        gain_of(&shared.iter().map(pair).collect::<Vec<_>>())
    }
}

/// A point that two pictures show.
struct Shared {
    /// Its position in the first one.
    px: DVec2,
    /// Mean colours around it.
    here: DVec3,
    there: DVec3,
}

/// Points that both of two pictures show.
fn shared_places<'a>(
    (scene, receivers): (&'a Scene, &'a [AnchoredReceiver]),
    plate: &'a Plate,
    other: &'a Plate,
    linear_of_code: &'a [f64; 256],
) -> impl Iterator<Item = Shared> + 'a {
    let [sight, other_sight] = [plate, other].map(|plate| Sight::new(&view_of(scene, plate), receivers));
    let spacing = DVec2::new(f64::from(scene.width_px), f64::from(scene.height_px)) / f64::from(N_COMPARED);
    let places = (0..N_COMPARED * N_COMPARED).map(|k| UVec2::new(k % N_COMPARED, k / N_COMPARED));
    places.filter_map(move |at| {
        let px = (at.as_dvec2() + 0.5) * spacing;
        let other_px = other_sight.image_px_of(sight.nearest(px)?)?;
        let here = mean_color(&plate.image, px, linear_of_code)?;
        let there = mean_color(&other.image, other_px, linear_of_code)?;
        Some(Shared { px, here, there })
    })
}

/// Mean linear colour around a pixel; none at the border, or where a code is too dark or too bright.
fn mean_color(image: &Image, px: DVec2, linear_of_code: &[f64; 256]) -> Option<DVec3> {
    #[allow(clippy::cast_possible_truncation, reason = "a pixel of an image")]
    let centre = [px.x.floor() as i64, px.y.floor() as i64];
    let side = 2 * COMPARED_RADIUS_PX + 1;
    let mut sum = DVec3::ZERO;
    for k in 0..side * side {
        let x = u32::try_from(centre[0] + k % side - COMPARED_RADIUS_PX).ok()?;
        let y = u32::try_from(centre[1] + k / side - COMPARED_RADIUS_PX).ok()?;
        if x >= image.width_px || y >= image.height_px {
            return None;
        }
        let first = 4 * (y as usize * image.width_px as usize + x as usize);
        let codes = image.rgba8.get(first..first + 3)?;
        if codes.iter().any(|code| !USABLE_CODES.contains(code)) {
            return None;
        }
        sum += DVec3::from_array([0, 1, 2].map(|channel| linear_of_code[usize::from(codes[channel])]));
    }
    #[allow(clippy::cast_precision_loss, reason = "49")]
    let n_pixels = (side * side) as f64;
    Some(sum / n_pixels)
}

/// Linear light of each code.
fn decoded() -> [f64; 256] {
    let mut decoded = [0.0; 256];
    for (code, linear) in (0..=u8::MAX).zip(&mut decoded) {
        *linear = f64::from(linear_from_srgb(f32::from(code) / 255.0));
    }
    decoded
}

/// The gain from the first of each pair to the second, per channel; 1 where there are too few.
fn gain_of(pairs: &[(DVec3, DVec3)]) -> DVec3 {
    if pairs.len() < FEWEST_COMPARED {
        return DVec3::ONE;
    }
    DVec3::from_array([0, 1, 2].map(|channel| robust_gain(pairs, channel)))
}

/// The gain from the first of each pair to the second, by reweighted least squares that start from the median of the
/// ratios: what is in shadow in one of them does not count.
fn robust_gain(pairs: &[(DVec3, DVec3)], channel: usize) -> f64 {
    let mut ratios: Vec<f64> = pairs.iter().map(|(a, b)| b[channel] / a[channel]).collect();
    ratios.sort_unstable_by(f64::total_cmp);
    let mut gain = ratios[ratios.len() / 2];
    for _ in 0..N_STEPS {
        let (mut product, mut energy) = (0.0, 0.0);
        for (here, there) in pairs.iter().map(|(a, b)| (a[channel], b[channel])) {
            let relative = (gain * here - there) / (CAUCHY_SCALE * there);
            let weight = 1.0 / (1.0 + relative * relative);
            product += weight * here * there;
            energy += weight * here * here;
        }
        gain = product / energy;
    }
    gain
}
