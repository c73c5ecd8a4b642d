//! Estimates the distortion of an unlisted lens, from toy and shadow together.
//!
//! An ignored lens bends the outline of toy and shadow in a way that no pose and no light does. So
//! it is estimated like a focal length: one lens after the other is tried, each with the best pose
//! and lights for it. The first term is estimated first, and then the second.
//!
//! Only the places of toy and shadow constrain it, and there the two terms are nearly equivalent:
//! their sum is accurate, each alone less so, and toward the picture's corners they are an
//! extrapolation.

use super::optimum::searched;
use super::trials::Unseen;
use super::unknown::{Bend, Unknown};
use crate::report::{LensAlignment, RatioOutcome};
use app_scene::frame::FrameInput;
use app_scene::lens::Distortion;
use app_scene::scene::{Intrinsics, Light, Scene};

/// Largest distortion at the corner farthest from the principal point, as a fraction of its
/// distance.
const MOST: f64 = 0.12;
/// The second term is zero at this fraction of the corner's squared distance: the typical distance
/// of shadows.
const PIVOT: f64 = 0.3;

/// Estimates the lens in a frame; `lights` are approximate.
pub(crate) fn find_lens(scene: &Scene, input: &FrameInput, lights: &[Light]) -> LensAlignment {
    let size_px = [scene.width_px, scene.height_px];
    let corner2 = corner2(&input.camera.intrinsics, size_px);
    let first = Bend {
        from: Distortion::NONE,
        by: Distortion {
            k1: 1.0 / corner2,
            k2: 0.0,
        },
    };
    let one = along(first, (scene, input, lights));
    if !one.is_applied() {
        return one;
    }
    let k2 = 1.0 / (corner2 * corner2 * (1.0 - PIVOT));
    let second = Bend {
        from: one.distortion,
        by: Distortion {
            k1: -PIVOT * corner2 * k2,
            k2,
        },
    };
    let two = along(second, (scene, input, lights));
    match (one.errors, two.errors) {
        (Some([without, _]), Some([_, with])) if two.is_applied() => LensAlignment {
            errors: Some([without, with]),
            ..two
        },
        _ => one,
    }
}

/// The lens of least loss in a family.
fn along(bend: Bend, (scene, input, lights): (&Scene, &FrameInput, &[Light])) -> LensAlignment {
    let none = |outcome| LensAlignment {
        outcome,
        distortion: bend.from,
        deviation: f64::INFINITY,
        errors: None,
    };
    match searched(Unknown::Lens(bend), MOST, (scene, input, lights)) {
        Ok(found) => {
            let Some(found) = found else {
                return none(RatioOutcome::Unconstrained);
            };
            LensAlignment {
                outcome: found.outcome,
                distortion: if found.outcome == RatioOutcome::Corrected {
                    bend.at(found.at)
                } else {
                    bend.from
                },
                deviation: found.deviation,
                errors: Some(found.errors),
            }
        }
        Err(Unseen) => none(RatioOutcome::Unseen),
    }
}

/// Squared distance of the farthest corner from the principal point, in the units of the lens's
/// terms.
fn corner2(intrinsics: &Intrinsics, size_px: [u32; 2]) -> f64 {
    let Intrinsics {
        fx_px,
        fy_px,
        cx_px,
        cy_px,
    } = *intrinsics;
    let [right, bottom] = size_px.map(f64::from);
    let x = cx_px.abs().max((right - cx_px).abs()) / fx_px;
    let y = cy_px.abs().max((bottom - cy_px).abs()) / fy_px;
    x.mul_add(x, y * y)
}
