//! `composite` on the receiver, in codes of the finished picture.

use app_core::shadow_style::ShadowStyle;
use app_core::toy::PosedMesh;
use app_pipeline::geometry::rect::PixelRect;
use glam::{DVec2, DVec4, UVec2};
use reference::composite::{Shown, inside_border, other_receiver, receiver_color};
use reference::model::centre_px;
use reference::raster::{Raster, texels_of};

use crate::device::Device;
use crate::errors::Errors;
use crate::photo::{photograph, unrounded_code};
use crate::run::{Run, runs};
use crate::setups::SETUPS;
use crate::stand::Stand;

/// Whether the toy in a pose covers, or may by rounding cover, any sample of a pixel of `rect`.
pub(crate) fn shows_toy(stand: &Stand, posed: &PosedMesh, rect: &PixelRect) -> Raster<bool> {
    let occluder = stand.occluder(posed);
    Raster::from_fn(rect.size_px, |texel| {
        let around = [-0.5, 0.0, 0.5].map(|dy| [-0.5, 0.0, 0.5].map(|dx| DVec2::new(dx, dy)));
        around.as_flattened().iter().any(|offset| {
            let at = centre_px(rect.origin_px + texel) + *offset;
            let (origin, direction) = stand.camera_ray(at);
            occluder.nearest(origin, direction).is_some()
        })
    })
}

#[test]
fn receiver_in_codes() {
    runs().iter().for_each(check_receiver);
}

/// Shadows of half and of twice the strength, one of them softer than the true one.
#[test]
fn styled_receiver_in_codes() {
    let decoded = Device::shared().decoded();
    for (strength, softness) in [(0.5, 1.0), (2.0, 2.0), (0.0, 0.0)] {
        let style = ShadowStyle { strength, softness };
        let stand = Stand::new(SETUPS[0]);
        let pictures = photograph(&stand);
        let run = Run::styled(style, stand, pictures, &decoded).unwrap();
        check_receiver(&run);
    }
}

/// Compares the picture with the reference on the receiver.
pub(crate) fn check_receiver(run: &Run) {
    let shown = Shown {
        visibility: run.shown_visibility.clone(),
        ambient: run.shown_ambient.clone(),
        solution: run.solution.clone(),
        residuals: run.residuals.iter().map(|map| map.map(DVec4::truncate)).collect(),
        grids: run.grids.clone(),
        strength: run.shadow_style.strength,
    };
    let hidden = shows_toy(&run.stand, &run.stand.shown, &run.plan.region);
    let pairs = texels_of(run.region.size_px)
        .filter(|texel| !hidden.at(*texel))
        .flat_map(|texel| {
            let expected = receiver_color(&run.region, &run.pictures, &shown, texel);
            let actual = run.picture.at(texel);
            assert_eq!(actual[3], 255, "alpha at {texel}");
            (0..3).map(move |channel| {
                let (actual, [a, b]) = (
                    f64::from(actual[channel]),
                    expected.map(|c| unrounded_code(c[channel])),
                );
                // The toy's motion decides between the two.
                (actual, actual.clamp(a.min(b), a.max(b)))
            })
        });
    // Half a code is rounding. A software driver encodes sRGB by a polynomial, with an additional
    // error of 0.14 of a code at worst, which moves 5 % of the codes to a neighbour; 8 bits of
    // weight in the bilinear filters of a graphics card are 1/512 of the difference between two
    // texels.
    Errors::between(pairs).check(&format!("{}, codes", run.stand.setup.name), (0.5, 0.1), 0.7);
}

/// Comparisons on setups that never reach a branch do not test it.
#[test]
fn setups_meet_every_branch() {
    type Condition = fn(&Run, UVec2) -> bool;
    let conditions: [(&str, Condition); 5] = [
        ("on a second receiver", |run, texel| {
            let point = run.region.receiver_point(centre_px(texel));
            point.is_some_and(|point| point.receiver == 1)
        }),
        ("at an edge between receivers", |run, texel| {
            other_receiver(&run.region, &run.pictures, texel).is_some()
        }),
        ("beside the receiver", |run, texel| {
            run.region.receiver_point(centre_px(texel)).is_none()
        }),
        ("away from every border", |run, texel| {
            inside_border(&run.region, texel) == 1.0
        }),
        ("seen at an inner border", |run, texel| {
            inside_border(&run.region, texel) < 1.0 && run.pictures.seen.at(texel) == 1.0
        }),
    ];
    for (what, is_met) in conditions {
        let is_met_somewhere = runs().iter().any(|run| {
            let hidden = shows_toy(&run.stand, &run.stand.shown, &run.plan.region);
            texels_of(run.region.size_px).any(|texel| !hidden.at(texel) && is_met(run, texel))
        });
        assert!(is_met_somewhere, "no pixel is {what}");
    }
}
