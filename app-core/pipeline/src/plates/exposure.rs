//! Exposures: gains between plates, and from the plates to a frame.

use glam::{DVec2, DVec3, UVec2};

use crate::geometry::anchored::AnchoredReceiver;
use crate::geometry::rect::PixelRect;
use crate::plates::joint::{PairGain, joint_gains};
use crate::plates::overlap::compared;
use crate::plates::shot::{Shot, shots_of};
use crate::plates::sight::PointOn;
use app_scene::geometry::color::linear_of_codes;
use app_scene::scene::{Plate, Scene};

/// Sample points along each side of a plate, for the comparison of its exposure with another's.
const N_COMPARED: u32 = 48;
/// Relative difference between two plates at which a sample has half its weight.
const CAUCHY_SCALE: f64 = 0.05;
/// Minimum number of samples of a gain.
const FEWEST_COMPARED: usize = 16;
/// Steps of the reweighted least squares.
const N_STEPS: usize = 8;

/// Gain of each plate to the exposure of the first plate to which it is connected by pairs with
/// enough common samples, per channel of linear light; 1 for that plate.
#[must_use]
pub fn match_plates(scene: &Scene, receivers: &[AnchoredReceiver]) -> Vec<DVec3> {
    let decoded = linear_of_codes().map(f64::from);
    let shots = shots_of(scene, receivers);
    let mut pairs = Vec::new();
    for (later, others) in compared(&shots).into_iter().enumerate() {
        if others.is_empty() {
            continue;
        }
        let seen = seen_places(&shots[later], &decoded);
        for earlier in others {
            let shared: Vec<_> = shared_places(&seen, &shots[earlier], &decoded)
                .map(|shared| (shared.here, shared.there))
                .collect();
            pairs.extend(gain_of(&shared).map(|gain| PairGain {
                plates: [later, earlier],
                gain,
                n_samples: shared.len() as f64,
            }));
        }
    }
    joint_gains(scene.plates.len(), &pairs)
}

/// Gain of the scene's first plate to the exposure of a frame, per channel of linear light; 1 if
/// they have no common sample. `chosen` are indices of plates that are visible from the frame's
/// camera, `gains` convert each of the scene's plates to the first.
///
/// Samples `within`, which contains the whole toy and its shadows, count only if there are too few
/// others.
pub(crate) fn match_frame(
    (scene, receivers): (&Scene, &[AnchoredReceiver]),
    frame: &Plate,
    (chosen, gains): (&[usize], &[DVec3]),
    within: &PixelRect,
) -> DVec3 {
    let decoded = linear_of_codes().map(f64::from);
    let seen = seen_places(&Shot::new(scene, frame, receivers), &decoded);
    let shared: Vec<Shared> = chosen
        .iter()
        .flat_map(|index| {
            let plate = Shot::new(scene, &scene.plates[*index], receivers);
            let shared = shared_places(&seen, &plate, &decoded).map(|one| Shared {
                there: gains[*index] * one.there,
                ..one
            });
            shared.collect::<Vec<_>>()
        })
        .collect();
    let (min, max) = (
        within.origin_px.as_dvec2(),
        (within.origin_px + within.size_px).as_dvec2(),
    );
    let is_outside = |one: &&Shared| one.px.cmplt(min).any() || one.px.cmpge(max).any();
    let pair = |one: &Shared| (one.there, one.here);
    let outside: Vec<_> = shared.iter().filter(is_outside).map(pair).collect();
    gain_of(&outside)
        .or_else(|| gain_of(&shared.iter().map(pair).collect::<Vec<_>>()))
        .unwrap_or(DVec3::ONE)
}

/// A point that is visible in a picture.
struct VisiblePoint {
    px: DVec2,
    point: PointOn,
    /// Mean colour around it.
    color: DVec3,
}

/// A point that is visible in two pictures.
struct Shared {
    /// Its position in the first one.
    px: DVec2,
    /// Mean colours around it.
    here: DVec3,
    there: DVec3,
}

/// The sample points at which a picture shows a receiver.
fn seen_places(shot: &Shot<'_>, linear_of_code: &[f64; 256]) -> Vec<VisiblePoint> {
    let spacing = shot.size_px() / f64::from(N_COMPARED);
    let places = (0..N_COMPARED * N_COMPARED).map(|k| UVec2::new(k % N_COMPARED, k / N_COMPARED));
    let seen = places.filter_map(|at| {
        let px = (at.as_dvec2() + 0.5) * spacing;
        Some(VisiblePoint {
            px,
            point: shot.nearest(px)?,
            color: shot.mean_color(px, linear_of_code)?,
        })
    });
    seen.collect()
}

/// The points that another picture shows, too.
fn shared_places<'a>(
    seen: &'a [VisiblePoint],
    other: &'a Shot<'_>,
    linear_of_code: &'a [f64; 256],
) -> impl Iterator<Item = Shared> + 'a {
    seen.iter().filter_map(move |seen| {
        let there = other.mean_color(other.image_px_of(seen.point)?, linear_of_code)?;
        Some(Shared {
            px: seen.px,
            here: seen.color,
            there,
        })
    })
}

/// The gain from the first of each pair to the second, per channel; `None` if there are too few
/// pairs.
fn gain_of(pairs: &[(DVec3, DVec3)]) -> Option<DVec3> {
    if pairs.len() < FEWEST_COMPARED {
        return None;
    }
    let channels = [0, 1, 2].map(|channel| robust_gain(pairs, channel));
    Some(DVec3::from_array(channels))
}

/// The gain from the first of each pair to the second, by reweighted least squares that start from
/// the median of the ratios: samples in shadow in one of the pictures do not count.
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
