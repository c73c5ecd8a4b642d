//! The blur of an outline that differs by direction, as by a motion during the exposure.

use glam::DVec2;
use nalgebra::{Matrix3, Vector3};

use super::blur::{COMPARED_PX, MOST_SPREAD_PX, Pieces};
use super::contour::Element;
use super::edge::Edges;
use super::sides::Beside;
use app_scene::sharpness::Spread;

/// Number of directions in which the blur of the outline is compared, and of pieces that one needs.
const N_CLASSES: usize = 4;
const LEAST_PIECES: usize = 16;
/// First steps of its deviations, in pixels, and of its direction, and number of their reductions.
const FIRST_STEPS: [f64; 3] = [0.4, 0.4, 0.3];
const N_REDUCED: usize = 8;
/// Largest square of what is left over the contrast, of an outline that is explained by a blur.
/// Measured: .003 to .014 for motions of 5 px, .055 for a sharp llama in front of planks of its colour.
const MOST_LEFT: f64 = 0.03;

/// The blur of an outline by direction.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Directed {
    Blurred(Spread),
    /// No blur explains its pixels: something else is beside the toy.
    Unexplained,
}

/// The lens's blur along the normals of the outline, as a covariance; `None` if too few directions
/// tell. An edge shows no blur along itself, so that pieces of four directions are taken apart.
pub(super) fn directed(beside: &Beside<'_>, elements: &[Element]) -> Option<Directed> {
    let edges = Edges::new(beside, elements, COMPARED_PX).mixing(beside);
    let (mut normal, mut right) = (Matrix3::zeros(), Vector3::zeros());
    let mut n_told = 0;
    for class in 0..N_CLASSES {
        let pieces = Pieces {
            edges: &edges,
            are_used: elements.iter().map(|one| class_of(one.normal) == class).collect(),
        };
        let known = pieces.used(&edges.are_known).filter(|is_known| **is_known);
        if known.count() < LEAST_PIECES {
            continue;
        }
        let (spread_px, _) = pieces.blur();
        let row = pieces.used(elements).map(|one| {
            let DVec2 { x, y } = one.normal;
            Vector3::new(x * x, 2.0 * x * y, y * y)
        });
        let row = row.sum::<Vector3<f64>>() / pieces.used(elements).count() as f64;
        normal += row * row.transpose();
        right += row * (spread_px * spread_px);
        n_told += 1;
    }
    // A covariance has three numbers.
    if n_told < 3 {
        return None;
    }
    let found = normal.cholesky()?.solve(&right);
    let found = Spread {
        xx_px2: found.x,
        xy_px2: found.y,
        yy_px2: found.z,
    };
    Some(refined(&Pieces::all(&edges), found))
}

/// A blur near this one that explains the pixels of all directions best, since pieces of one class
/// do not have one direction; unexplained if it leaves too much. Source: pattern search, Hooke and Jeeves 1961.
fn refined(pieces: &Pieces<'_>, start: Spread) -> Directed {
    let along = start.axes_px()[0].normalize_or(DVec2::X).to_angle();
    let [wide, narrow] = start.variances_px2().map(|variance| variance.max(0.0).sqrt());
    let of = |[wide, narrow, along]: [f64; 3]| {
        let [wide, narrow] = [wide, narrow].map(|px| px.clamp(0.0, MOST_SPREAD_PX));
        Spread::round(narrow).and(Spread::of_motion(
            ((wide * wide - narrow * narrow).max(0.0) * 12.0).sqrt() * DVec2::from_angle(along),
        ))
    };
    let mut best = [wide, narrow, along];
    let mut misfit = pieces.misfit_of(of(best));
    let mut steps = FIRST_STEPS;
    for _ in 0..N_REDUCED {
        for k in 0..best.len() {
            for step in [steps[k], -steps[k]] {
                let mut tried = best;
                tried[k] += step;
                let of_tried = pieces.misfit_of(of(tried));
                if of_tried < misfit {
                    (best, misfit) = (tried, of_tried);
                }
            }
        }
        steps = steps.map(|step| 0.7 * step);
    }
    if misfit <= MOST_LEFT {
        Directed::Blurred(of(best))
    } else {
        Directed::Unexplained
    }
}

/// The class of a normal's direction, either way round.
fn class_of(normal: DVec2) -> usize {
    let turn = normal.to_angle() / std::f64::consts::PI * N_CLASSES as f64;
    #[allow(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "from 0 to the number of classes"
    )]
    let class = turn.round().rem_euclid(N_CLASSES as f64) as usize;
    class % N_CLASSES
}

/// Standard deviation of a round blur of the outline beside this one, in pixels; 0 if it explains no
/// more.
pub(super) fn beyond(beside: &Beside<'_>, elements: &[Element], spread: Spread) -> f64 {
    let edges = Edges::new(beside, elements, COMPARED_PX).mixing(beside);
    Pieces::all(&edges).blur_beside(spread).0
}
