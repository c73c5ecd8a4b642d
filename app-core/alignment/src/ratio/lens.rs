//! The distortion of a lens that nobody lists, by toy and shadow together.
//!
//! A lens that is left out bends the outline of toy and shadow in a way that no pose and no light does. So it is looked for as a focal
//! length is: photographs are taken for those of one lens after the other, each with the pose and the lights that fit best then. The
//! first term comes first, and around it the second.
//!
//! Only where toy and shadow are is anything told, and there the two terms look much alike: they are right together, each by itself
//! less so, and toward the picture's corners they are a continuation.

use super::optimum::searched;
use super::trials::Unseen;
use super::unknown::{Bend, Unknown};
use crate::report::{LensAlignment, RatioOutcome};
use app_scene::frame::FrameInput;
use app_scene::lens::Distortion;
use app_scene::scene::{Intrinsics, Light, Scene};

/// The most that a lens adds at the corner that is farthest from the principal point, in parts of its distance from there.
const MOST: f64 = 0.12;
/// The second term changes nothing at this part of the corner's squared distance: about as far out as shadows are.
const PIVOT: f64 = 0.3;

/// Looks for the lens in a frame; `lights` are about where the frame's are.
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

/// The least loss of lenses in a row.
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
                return none(RatioOutcome::NotTold);
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

/// Squared distance of the farthest corner from the principal point, as the lens's terms count it.
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
