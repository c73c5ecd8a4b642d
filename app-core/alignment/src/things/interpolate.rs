//! Interpolation of unknown pixels between known ones, with given differences between neighbours.
//!
//! Sources: Pérez et al. 2003, for logarithms of light; Bornemann and Deuflhard 1996 (cascadic multigrid): a
//! picture of half the size is solved first, from which the rounds of the larger one begin, so that their number
//! does not depend on how wide the unknown area is.

use glam::IVec2;

use super::groups::STEPS;
use crate::picture::{Color, Mask, UNKNOWN, index_in, places};

/// Number of rounds in each picture, and their relaxation factor.
const N_ROUNDS: usize = 100;
const RELAXATION: f32 = 1.5;
/// Longest side in pixels of a picture that no smaller one precedes: its rounds cross it.
const SMALLEST_PX: i32 = 8;

/// Sets some pixels so that each differs from its neighbours as `measured` says, or not at all where that is
/// unknown.
pub(super) fn interpolate(light: &mut [Color], (measured, size_px): (&[Color], IVec2), of: &[IVec2]) {
    for index in of.iter().filter_map(|at| index_in(size_px, *at)) {
        light[index] = UNKNOWN;
    }
    if size_px.max_element() > SMALLEST_PX && !of.is_empty() {
        begin(light, (measured, size_px), of);
    }
    for _ in 0..N_ROUNDS {
        for at in of {
            relax(light, (measured, size_px), *at);
        }
    }
}

/// Sets unknown pixels as in a picture of half the size, where cells without known pixels are unknown.
fn begin(light: &mut [Color], (measured, size_px): (&[Color], IVec2), of: &[IVec2]) {
    let half_px = (size_px + 1) / 2;
    let [mut light_there, measured_there] = [&*light, measured].map(|colors| halved(colors, size_px));
    let mut unknown = Mask::new(half_px);
    of.iter()
        .map(|at| *at / 2)
        .filter(|cell| index_in(half_px, *cell).is_some_and(|index| light_there[index][0].is_nan()))
        .for_each(|cell| unknown.mark(cell));
    let unknown: Vec<IVec2> = places(half_px).filter(|cell| unknown.has(*cell)).collect();
    interpolate(&mut light_there, (&measured_there, half_px), &unknown);
    for at in of {
        let [Some(index), Some(cell)] = [index_in(size_px, *at), index_in(half_px, *at / 2)] else {
            continue;
        };
        light[index] = moved(light_there[cell], [measured_there[cell], measured[index]]);
    }
}

/// Means of the known ones of four pixels each.
fn halved(colors: &[Color], size_px: IVec2) -> Vec<Color> {
    let mean = |cell: IVec2| {
        let of = places(IVec2::splat(2)).filter_map(|step| index_in(size_px, 2 * cell + step));
        let (mut sum, mut n) = ([0.0; 3], 0.0);
        for color in of.map(|index| colors[index]).filter(|color| !color[0].is_nan()) {
            sum = [0, 1, 2].map(|channel| sum[channel] + color[channel]);
            n += 1.0;
        }
        if n > 0.0 { sum.map(|sum| sum / n) } else { UNKNOWN }
    };
    places((size_px + 1) / 2).map(mean).collect()
}

/// A colour at another place, by the difference of what is measured there, if both are known.
fn moved(color: Color, [from, to]: [Color; 2]) -> Color {
    let step = [0, 1, 2].map(|channel| to[channel] - from[channel]);
    if step[0].is_nan() {
        color
    } else {
        [0, 1, 2].map(|channel| color[channel] + step[channel])
    }
}

/// A round at a pixel. Source: Young 1954 (successive over-relaxation).
fn relax(light: &mut [Color], (measured, size_px): (&[Color], IVec2), at: IVec2) {
    let Some(index) = index_in(size_px, at) else {
        return;
    };
    let (mut sum, mut n) = ([0.0; 3], 0.0);
    for other in STEPS.iter().filter_map(|step| index_in(size_px, at + *step)) {
        if !light[other][0].is_nan() {
            let expected = moved(light[other], [measured[other], measured[index]]);
            sum = [0, 1, 2].map(|channel| sum[channel] + expected[channel]);
            n += 1.0;
        }
    }
    if n > 0.0 {
        let mean = sum.map(|sum| sum / n);
        let before = if light[index][0].is_nan() {
            mean
        } else {
            light[index]
        };
        light[index] =
            [0, 1, 2].map(|channel| before[channel] + RELAXATION * (mean[channel] - before[channel]));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The largest error of an area between two sides that differ by 1, if light changes evenly across it.
    fn largest_error(wide_px: i32) -> f32 {
        let size_px = IVec2::splat(wide_px + 2);
        let expected = |at: IVec2| [at.x as f32 / (wide_px + 1) as f32; 3];
        let is_inner = |at: &IVec2| at.cmpgt(IVec2::ZERO).all() && at.cmplt(size_px - 1).all();
        let inner: Vec<IVec2> = places(size_px).filter(is_inner).collect();
        let mut light: Vec<Color> = places(size_px).map(expected).collect();
        let unmeasured = vec![UNKNOWN; light.len()];
        interpolate(&mut light, (&unmeasured, size_px), &inner);
        let error = |(at, color): (IVec2, &Color)| (color[0] - expected(at)[0]).abs();
        places(size_px).zip(&light).map(error).fold(0.0, f32::max)
    }

    #[test]
    fn an_area_of_any_width_changes_evenly_between_its_sides() {
        for wide_px in [5, 60, 300] {
            let error = largest_error(wide_px);
            assert!(error < 0.03, "{error} across {wide_px} px");
        }
    }

    #[test]
    fn known_differences_are_kept() {
        let size_px = IVec2::new(40, 3);
        let step = |at: IVec2| [if at.x < 20 { 0.0 } else { 1.0 }; 3];
        let measured: Vec<Color> = places(size_px).map(step).collect();
        let is_known = |at: IVec2| at.x == 0;
        let unknown: Vec<IVec2> = places(size_px).filter(|at| !is_known(*at)).collect();
        let mut light: Vec<Color> = places(size_px)
            .map(|at| if is_known(at) { [5.0; 3] } else { UNKNOWN })
            .collect();
        interpolate(&mut light, (&measured, size_px), &unknown);
        for (at, color) in places(size_px).zip(light) {
            assert!((color[0] - 5.0 - step(at)[0]).abs() < 0.02, "{color:?} at {at}");
        }
    }
}
