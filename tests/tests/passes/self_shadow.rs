//! `self_shadow` with `object`: depth maps compared with rays.

use glam::{DVec2, DVec3, DVec4, UVec2};
use reference::model::centre_px;
use reference::occlusion::Occluder;
use reference::raster::texels_of;
use reference::self_shadow::received;

use crate::errors::Errors;
use crate::run::{Run, runs};

/// Offsets of rays that detect a nearby edge.
const AROUND_PX: [DVec2; 4] = [
    DVec2::new(-1.5, 0.0),
    DVec2::new(1.5, 0.0),
    DVec2::new(0.0, -1.5),
    DVec2::new(0.0, 1.5),
];
/// Difference of received light that exceeds the effect of a side's perspective over that distance.
const ALIKE: f64 = 0.02;

/// The surface of the physical toy at a position of the region: side of a box, point and normal.
fn surface(run: &Run, region_px: DVec2) -> Option<(usize, DVec3, DVec3)> {
    let stand = &run.stand;
    let (origin, direction) = stand.camera_ray(run.plan.region.origin_px.as_dvec2() + region_px);
    let hit = stand.occluder(&stand.physical).nearest(origin, direction)?;
    let normal = stand.physical.normals[stand.toy.indices()[3 * hit.triangle] as usize].as_dvec3();
    Some((hit.triangle / 2, origin + hit.distance * direction, normal))
}

fn light_points(run: &Run) -> Vec<Vec<DVec4>> {
    let planned = run.plan.self_shadow.n_points.iter();
    let points = planned.enumerate().map(|(i, n_points)| {
        let points = run.stand.light_points(i, run.plan.n_light_points[i]);
        let stride = points.len() / n_points;
        points.into_iter().step_by(stride).collect()
    });
    points.collect()
}

/// Away from the edges of sides and shadows a depth map agrees with rays: fully lit, fully dark, or
/// the same half shade.
#[test]
fn received_light() {
    let (mut n_lit, mut n_shadowed) = (0, 0);
    for run in runs() {
        let occluder = run.stand.occluder(&run.stand.physical);
        let points = light_points(run);
        let of_ray = |at: DVec2| {
            let (side, in_plane, normal) = surface(run, at)?;
            let light = received(&run.region, &occluder, &points, in_plane, normal);
            let unhidden = received(
                &run.region,
                &Occluder::<f64>::new(&[], &[]),
                &points,
                in_plane,
                normal,
            );
            Some((side, light, unhidden))
        };
        let (mut everywhere, mut away) = (Vec::new(), Vec::new());
        let is_on_toy = |texel: &UVec2| run.validity.at(*texel).y > 0.0;
        for texel in texels_of(run.region.size_px).filter(is_on_toy) {
            let Some((side, expected, unhidden)) = of_ray(centre_px(texel)) else {
                continue;
            };
            let actual = run.gbuffer_received.at(texel);
            let around = AROUND_PX.map(|offset| of_ray(centre_px(texel) + offset));
            for i in 0..run.region.lights.len() {
                everywhere.push((actual[i], expected[i]));
                let is_alike = |other: &Option<(usize, DVec4, DVec4)>| {
                    other.is_some_and(|(its, light, _)| its == side && (light[i] - expected[i]).abs() < ALIKE)
                };
                if around.iter().all(is_alike) {
                    away.push((actual[i], expected[i]));
                    n_lit += usize::from(expected[i] == unhidden[i] && unhidden[i] > 0.0);
                    n_shadowed += usize::from(expected[i] == 0.0 && unhidden[i] > 0.0);
                }
            }
        }
        let name = run.stand.setup.name;
        // 16 bits for normal and result. Measured: 6.4e-4.
        Errors::between(away).check_all(&format!("{name}, away from edges"), 2e-3);
        // A texel of the depth maps moves an edge by less than a pixel. Measured: 0.4 % and 0.10.
        Errors::between(everywhere).check(&format!("{name}, received light"), (0.1, 0.02), 0.5);
    }
    assert!(
        n_lit > 100 && n_shadowed > 2,
        "{n_lit} lit, {n_shadowed} in shadow"
    );
}
