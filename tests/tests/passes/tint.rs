//! `tint` and `tint_fill`: the device's tints for a frame, and the filled tints of parts that no
//! camera saw.

use app_core::preset::Preset;
use app_core::sharpness::{Sharpness, Spread};
use app_pipeline::core::inspect::Inspect;
use glam::{DVec2, DVec3, UVec2};
use reference::fit::toy_radiance;
use reference::model::centre_px;
use reference::occlusion::Occluder;
use reference::occlusion::PointSpread;
use reference::raster::{Raster, texels_of};
use reference::tint::{SeenPaint, tints};
use reference::unmix::unmixed_factor;

use crate::cores::core_on;
use crate::device::Device;
use crate::errors::Errors;
use crate::photo::{Photo, photograph};
use crate::run::{Run, codes_at, input, runs, scene};
use crate::setups::SETUPS;
use crate::stand::Stand;

/// Triangles of a box of the toy, each with a material of its own.
const N_TRIANGLES: usize = 12;
/// Index of the body among the toy's boxes.
const BODY: usize = 2;
const HEAD: usize = 3;

/// The tests' blur by a pixel and a pixel's own, without that of means over three by three texels; and the
/// deviation of the latter. Computed by hand.
const OF_POINT: (PointSpread, f64) = (
    PointSpread {
        axes_px: [DVec2::new(0.763_763, 0.0), DVec2::new(0.0, 0.763_763)],
        is_line: false,
    },
    std::f64::consts::FRAC_1_SQRT_2,
);

/// The toy in a run's frame, by rays.
fn seen(run: &Run) -> Vec<SeenPaint> {
    let occluder = run.stand.occluder(&run.stand.physical);
    let hit_at = |texel| {
        let (origin, direction) = run
            .stand
            .camera_ray(run.plan.region.origin_px.as_dvec2() + centre_px(texel));
        let hit = occluder.nearest(origin, direction)?;
        Some((hit.triangle, origin + hit.distance * direction))
    };
    let model = Raster::from_fn(run.region.size_px, |texel| {
        let (triangle, _) = hit_at(texel)?;
        let normal = run.stand.physical.normals[run.stand.toy.indices()[3 * triangle] as usize].as_dvec3();
        // How far it faces up is kept as a code of 8 bits.
        let up = (255.0 * (0.5 + 0.5 * normal.y)).round() / 255.0;
        let as_kept = DVec3::Y * (2.0 * up - 1.0);
        let light = toy_radiance(&run.solution, as_kept, run.gbuffer_received.at(texel));
        Some(run.gbuffer_base.at(texel) * light)
    });
    let taken = texels_of(run.region.size_px).filter(|texel| {
        let is_taken = *texel % run.plan.fit_stride_px == UVec2::ZERO;
        is_taken && run.validity.at(*texel).y > 0.0
    });
    let of_texel = taken.filter_map(|texel| {
        let (triangle, in_anchor) = hit_at(texel)?;
        let factor = if run.plan.sharpness.outline_spread == Spread::NONE {
            DVec3::ONE
        } else {
            unmixed_factor(&model, OF_POINT, texel)
        };
        Some(SeenPaint {
            in_anchor,
            material: triangle / N_TRIANGLES,
            seen: run.pictures.frame.at(texel),
            shown: factor * run.pictures.frame.at(texel),
            expected: run.solution.gain * model.at(texel)?,
            weight: run.validity.at(texel).y,
        })
    });
    of_texel.collect()
}

#[test]
fn tint_of_all_cells() {
    // 16 bits for normal and light. Measured: 2.1e-4.
    runs().iter().for_each(|run| check_tints(run, 1e-3));
}

/// A pixel into which a blurred picture mixes another surface counts less.
#[test]
fn tint_of_a_blurred_picture() {
    let spread = Spread::round(1.0);
    let sharpness = Sharpness {
        plate_spread: spread,
        outline_spread: spread,
    };
    let stand = Stand::new(SETUPS[0]);
    let pictures = photograph(&stand);
    let decoded = Device::shared().decoded();
    let run = Run::of(Preset::Balanced, (stand, sharpness), pictures, &decoded).unwrap();
    let seen = seen(&run);
    let n_mixed = seen.iter().filter(|paint| paint.weight < 1.0).count();
    assert!(
        n_mixed > 50 && n_mixed < seen.len(),
        "{n_mixed} of {} are mixed",
        seen.len()
    );
    // A sixteenth of a dark colour is rounded to few bits. Measured: 4.4e-3.
    check_tints(&run, 6e-3);
}

fn check_tints(run: &Run, most: f64) {
    let expected = tints(&run.tints.grid, &seen(run));
    let pairs = run
        .tints
        .materials
        .iter()
        .zip(&expected)
        .flat_map(|(actual, expected)| {
            let cells = actual.iter().zip(expected.cells());
            cells.flat_map(|(actual, expected)| (0..4).map(|k| (f64::from(actual[k]), expected[k])))
        });
    // A point at the border of two cells may fall on either side.
    Errors::between(pairs).check(&format!("{}, tints", run.stand.setup.name), (most, 0.01), 0.05);
}

/// Paints other than those of the toy's file, one per box.
fn repainted(triangle: usize) -> DVec3 {
    let paints = [
        DVec3::new(0.6, 0.8, 1.2),
        DVec3::new(0.6, 0.8, 1.2),
        DVec3::new(1.3, 0.9, 0.7),
        DVec3::new(0.8, 0.8, 1.3),
    ];
    paints[triangle / N_TRIANGLES]
}

/// The box of a posed toy that is visible at a position of the picture.
fn box_at(stand: &Stand, occluder: &Occluder, image_px: DVec2) -> Option<usize> {
    let (origin, direction) = stand.camera_ray(image_px);
    let hit = occluder.nearest(origin, direction)?;
    Some(hit.triangle / N_TRIANGLES)
}

/// Difference in codes between the body where the head had hidden it before moving away, and its
/// true look: the mean over pixels and channels.
fn error_of_what_was_hidden(paint: fn(usize) -> DVec3) -> f64 {
    let stand = Stand::new(SETUPS[0]);
    let photo = Photo {
        paint,
        ..Photo::plain(stand.setup.lights.len())
    };
    let mut core = core_on(scene(&stand, &photo.plate(&stand)), Preset::Balanced).unwrap();
    core.frame(&input(&stand, &photo.frame(&stand, &stand.physical)))
        .unwrap();
    let picture = core.read_picture().unwrap();
    let expected = photo.frame(&stand, &stand.shown);
    let (physical, shown) = (stand.occluder(&stand.physical), stand.occluder(&stand.shown));
    let was_hidden =
        |at: DVec2| box_at(&stand, &shown, at) == Some(BODY) && box_at(&stand, &physical, at) == Some(HEAD);
    let around = [DVec2::ZERO, DVec2::X, DVec2::Y, -DVec2::X, -DVec2::Y];
    let inside = texels_of(stand.setup.image_px).filter(|texel| {
        around
            .iter()
            .all(|offset| was_hidden(centre_px(*texel) + *offset))
    });
    let pairs = inside.flat_map(|texel| codes_at(&picture, &expected, texel));
    Errors::between(pairs).mean()
}

/// The tints from a frame with one paint, and from a second one with another, which may be soft.
fn tints_of_two_frames(paints: [fn(usize) -> DVec3; 2], soft: Sharpness) -> [Vec<Vec<[f32; 4]>>; 2] {
    let stand = Stand::new(SETUPS[0]);
    let plain = Photo::plain(stand.setup.lights.len());
    let mut core = core_on(scene(&stand, &plain.plate(&stand)), Preset::Balanced).unwrap();
    [0, 1].map(|index| {
        let photo = Photo {
            paint: paints[index],
            ..plain.clone()
        };
        let sharpness = [Sharpness::SHARP, soft][index];
        let frame = input(&stand, &photo.frame(&stand, &stand.physical)).with_sharpness(sharpness);
        core.frame(&frame).unwrap();
        core.read_tints().unwrap().unwrap().materials
    })
}

/// Ratios of the second tints to the first ones.
fn ratios([first, second]: &[Vec<Vec<[f32; 4]>>; 2]) -> Vec<f64> {
    let pairs = first.iter().flatten().zip(second.iter().flatten());
    pairs
        .flat_map(|(first, second)| [0, 1, 2].map(|k| f64::from(second[k] / first[k])))
        .collect()
}

/// A soft picture, in which all of the toy's pixels are mixed, hardly changes what a sharp one has shown.
#[test]
fn mixed_pixels_do_not_replace_a_tint_that_is_known() {
    let spread = Spread::round(8.0);
    let soft = Sharpness {
        plate_spread: spread,
        outline_spread: spread,
    };
    let ratios = ratios(&tints_of_two_frames(
        [|_| DVec3::ONE, |_| DVec3::splat(0.5)],
        soft,
    ));
    let changed = ratios.iter().map(|ratio| (ratio - 1.0).abs());
    let mean = changed.sum::<f64>() / ratios.len() as f64;
    eprintln!("{mean:.3} of a tint");
    assert!((0.001..0.06).contains(&mean), "{mean:.3}");
}

/// The light on the toy is fitted to the first picture alone, so a tint follows the paint.
#[test]
fn what_frames_before_have_shown_of_the_paint_counts() {
    let [first, both] =
        tints_of_two_frames([|_| DVec3::ONE, |_| DVec3::new(0.5, 0.8, 0.9)], Sharpness::SHARP);
    let expected = [0.75, 0.9, 0.95];
    let pairs = first.iter().zip(&both).flat_map(|(first, both)| {
        let cells = first.iter().zip(both);
        cells.flat_map(|(first, both)| (0..3).map(|k| (f64::from(both[k] / first[k]), expected[k])))
    });
    // Codes are rounded, and almost black pixels count as expected. Measured: 0.013. If the first
    // frame were forgotten, it would be 0.13.
    let off = Errors::between(pairs).mean();
    assert!(off < 0.03, "{off:.3}");
}

/// A paint that differs from the model's also changes the fitted light, so some of the error stays.
#[test]
fn what_was_hidden_is_of_the_paint_that_is_seen() {
    let errors = [|_| DVec3::ONE, repainted].map(error_of_what_was_hidden);
    eprintln!("{errors:.2?} codes, as made and repainted");
    assert!(errors[0] < 2.0 && errors[1] < 4.0, "{errors:.2?}");
}
