//! A reflecting table: the toy's image in it, the fits with the image, and the picture.

use std::sync::LazyLock;

use app_core::reflection::Reflection;
use app_core::toy::PosedMesh;
use glam::{DVec3, DVec4};
use reference::model::centre_px;
use reference::occlusion::sample_position;
use reference::raster::{Raster, texels_of};

use crate::composite::check_receiver;
use crate::device::Device;
use crate::errors::Errors;
use crate::fit::check_receivers;
use crate::photo::photograph;
use crate::residual::check_residuals;
use crate::run::{Run, crop};
use crate::setups::{FOUR_LIGHTS, SETUPS, Setup};
use crate::stand::Stand;

/// In one channel the toy is brighter than its surroundings.
const REFLECTION: Reflection = Reflection {
    roughness: 0.15,
    surroundings: [0.5, 0.7, 0.9],
    toy_above_surroundings: [0.6, -0.4, -0.8],
};
const N_EYES: usize = 32;

static RUN: LazyLock<Run> = LazyLock::new(|| {
    let stand = Stand::new(SETUPS[0]);
    let pictures = photograph(&stand);
    Run::reflecting(REFLECTION, stand, pictures, &Device::shared().decoded()).unwrap()
});

/// Positions of the eye's images behind the table, opposite points of a lobe, one for each of its
/// equally likely slopes: Beckmann's distribution of the tangent t is 1 - exp(-t^2 / alpha^2).
fn mirrored_eyes(run: &Run) -> Vec<DVec3> {
    let stand = &run.stand;
    let (eye, _) = stand.camera_ray(Default::default());
    let foot = stand.physical_centre().with_y(0.0);
    let (distance_m, view) = ((eye - foot).length(), (eye - foot).normalize());
    let golden_rad = std::f64::consts::TAU * (1.0 - 2.0 / (1.0 + 5f64.sqrt()));
    (0..N_EYES)
        .map(|index| {
            let part = (index as f64 + 0.5) / N_EYES as f64;
            let tangent = REFLECTION.roughness * (1.0 / (1.0 - part)).ln().sqrt();
            let turn_rad = golden_rad * index as f64;
            let normal = DVec3::new(tangent * turn_rad.cos(), 1.0, tangent * turn_rad.sin()).normalize();
            foot - distance_m * (-view).reflect(normal)
        })
        .collect()
}

/// The share of the lobe that a pose does not hide, by rays from the table.
fn left(run: &Run, posed: &PosedMesh) -> Raster<f64> {
    let occluder = run.stand.occluder(posed);
    let eyes = mirrored_eyes(run);
    Raster::from_fn(run.region.size_px, |texel| {
        let is_hidden = |index: usize| {
            let at = texel.as_dvec2() + sample_position(index, N_EYES);
            run.region.receiver_point(at).is_some_and(|point| {
                let origin = DVec3::new(point.in_plane.x, 0.0, point.in_plane.y);
                occluder.nearest(origin, origin - eyes[index]).is_some()
            })
        };
        1.0 - (0..N_EYES).filter(|index| is_hidden(*index)).count() as f64 / N_EYES as f64
    })
}

#[test]
fn the_toy_is_reflected_where_rays_from_the_table_meet_it() {
    let run = &*RUN;
    let poses = [
        (&run.stand.physical, &run.pictures.visibility),
        (&run.stand.shown, &run.shown_visibility),
    ];
    for (posed, visibility) in poses {
        let expected = left(run, posed);
        let n_hidden = expected.texels().iter().filter(|left| **left < 0.5).count();
        assert!(n_hidden > 100, "{n_hidden} texels reflect the toy");
        let channel = run.plan.n_lights;
        let actual = visibility.texels().iter().map(|texel| texel[channel]);
        let errors = Errors::between(actual.zip(expected.texels().iter().copied()));
        // The same holds for lights: a snapped corner moves an edge over a position, and stored
        // values are off by a code.
        errors.check(
            "toy's image",
            (0.5 / N_EYES as f64, 0.005),
            2.0 / N_EYES as f64 + 1.0 / 255.0,
        );
    }
}

/// The plate without the table's reflection.
#[test]
fn the_plate_is_freed_of_its_surroundings() {
    let run = &*RUN;
    let [photographed, _] = photograph(&run.stand);
    let photographed = crop(&photographed, &run.plan.region, &Device::shared().decoded());
    let pairs = texels_of(run.region.size_px).flat_map(|texel| {
        let point = run.region.receiver_point(centre_px(texel));
        let reflected = point.map_or(DVec3::ZERO, |point| run.region.reflected(point, DVec4::ONE));
        let expected = (photographed.at(texel) - reflected).max(DVec3::ZERO);
        let actual = run.pictures.plate.at(texel);
        (0..3).map(move |channel| (actual[channel], expected[channel]))
    });
    // The tolerance is that of floats with 16 bits.
    Errors::between(pairs).check_all("plate", 1e-3);
}

#[test]
fn fits_and_residual_beside_a_reflection() {
    check_receivers(&RUN);
    check_residuals(&RUN);
}

#[test]
fn picture_of_a_table_that_reflects_in_codes() {
    check_receiver(&RUN);
}

/// Four lights leave no channel: the picture is that of a matt table, to the last bit.
#[test]
fn four_lights_leave_no_reflection() {
    let decoded = Device::shared().decoded();
    // The visible content does not matter.
    let two_lights = Setup {
        lights: &FOUR_LIGHTS.lights[..2],
        ..FOUR_LIGHTS
    };
    let run = |reflection: Option<Reflection>| {
        let stand = Stand::new(FOUR_LIGHTS);
        let pictures = photograph(&Stand::new(two_lights));
        match reflection {
            Some(reflection) => Run::reflecting(reflection, stand, pictures, &decoded),
            None => Run::new(stand, pictures, &decoded),
        }
    };
    let [glossy, matt] = [Some(REFLECTION), None].map(|reflection| run(reflection).unwrap());
    assert_eq!(glossy.plan.reflection, None);
    assert!(glossy.picture == matt.picture);
}
