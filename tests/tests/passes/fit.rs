//! `fit` with `fit_solve`: sums of 32 bits over workgroups against sums of 64.

use app_core::gloss::Gloss;
use app_core::scene::MAX_RECEIVERS;
use glam::{DVec3, UVec2};
use reference::fit::{
    FitConstants, MAX_BOUNCE, PRIOR_BOUNCE, PRIOR_DIRECT_FRACTION, ToySample, fit_receiver, fit_toy,
    receiver_samples, toy_radiance,
};
use reference::gloss::{Glossy, SeenPoint};
use reference::model::{ReceiverSolution, Solution, centre_px};
use reference::raster::Raster;

use crate::composite::check_receiver;
use crate::device::Device;
use crate::errors::{Errors, channels};
use crate::photo::{Photo, photograph, truth};
use crate::run::{Run, runs};
use crate::setups::{NO_LIGHT, SETUPS, SIDE, Setup};
use crate::stand::Stand;
use crate::toy;

/// The start values of the core.
fn start(n_lights: usize) -> Solution {
    let direct_fraction = PRIOR_DIRECT_FRACTION / f64::from(u32::try_from(n_lights).unwrap());
    let bounce = if n_lights == 0 { MAX_BOUNCE } else { PRIOR_BOUNCE };
    let receiver = ReceiverSolution {
        bounce: DVec3::splat(bounce),
        direct_fractions: vec![DVec3::splat(direct_fraction); n_lights],
        clipped: DVec3::ZERO,
    };
    Solution {
        gain: DVec3::ONE,
        intensities: vec![DVec3::ONE; n_lights],
        receivers: vec![receiver; MAX_RECEIVERS],
        toy: vec![DVec3::ZERO; 2 + n_lights],
    }
}

fn receiver_values(solution: &Solution, receiver: usize) -> impl Iterator<Item = f64> + '_ {
    let of_receiver = &solution.receivers[receiver];
    let colors = [solution.gain, of_receiver.bounce, of_receiver.clipped].into_iter();
    colors
        .chain(of_receiver.direct_fractions.iter().copied())
        .flat_map(|color| color.to_array())
}

#[test]
fn receiver() {
    runs().iter().for_each(check_receivers);
}

pub(crate) fn check_receivers(run: &Run) {
    let constants = FitConstants::default();
    let samples = receiver_samples(&run.region, &run.pictures, run.plan.fit_stride_px);
    let mut expected = start(run.region.lights.len());
    for receiver in 0..run.stand.receivers.len() {
        let of_receiver = (receiver, &samples[..]);
        expected = fit_receiver(
            &run.region,
            of_receiver,
            &expected,
            &constants,
            run.plan.n_fit_steps,
        );
        let values = |solution| receiver_values(solution, receiver);
        let errors = Errors::between(values(&run.solution).zip(values(&expected)));
        // Sums of some 10^4 terms in 32 bits, times the condition number, which the priors limit to
        // 10^4; and 8 bits of weight in a graphics card's bilinear filter. Measured in software,
        // which filters in 32 bits: 4e-6.
        errors.check_all(&format!("{}, receiver {receiver}", run.stand.setup.name), 1e-3);
    }
}

/// A light that only the side of a book sees has no fraction on the table to follow; and from behind,
/// nothing of that side is in the picture.
#[test]
fn receivers_whose_light_no_other_one_tells() {
    let setup = Setup {
        lights: &SIDE.lights[1..],
        ..SIDE
    };
    let behind = setup.distance_m * DVec3::new(0.3, 0.6, -0.75).normalize();
    for (stand, shows_side) in [
        (Stand::new(setup), true),
        (Stand::seen_from(setup, behind), false),
    ] {
        let pictures = photograph(&stand);
        let run = Run::new(stand, pictures, &Device::shared().decoded()).unwrap();
        let samples = receiver_samples(&run.region, &run.pictures, run.plan.fit_stride_px);
        let is_seen = samples.iter().any(|sample| sample.point.receiver == 2);
        assert_eq!(is_seen, shows_side);
        check_receivers(&run);
    }
}

/// Everything is clipped, including the shadow: there is no shadow to retarget.
#[test]
fn clipped_pictures_tell_of_no_shadow() {
    let stand = Stand::new(SETUPS[0]);
    let photo = Photo {
        albedo: |_| DVec3::splat(20.0),
        ..Photo::plain(stand.setup.lights.len())
    };
    let pictures = [photo.plate(&stand), photo.frame(&stand, &stand.physical)];
    let run = Run::new(stand, pictures, &Device::shared().decoded()).unwrap();
    check_receivers(&run);
    let direct_fraction = run.solution.receivers[0].direct_fractions[0];
    assert!(
        direct_fraction.max_element() < 0.01,
        "{direct_fraction} of the plate is taken for a light's"
    );
    // The light on these pixels is not known either: they stay unchanged.
    assert_eq!(run.solution.receivers[0].clipped, DVec3::ONE);
    check_receiver(&run);
}

/// If no light is known, the shadow below the toy determines the strength of the ambient light; it
/// is zero if the picture shows no shadow.
#[test]
fn without_a_light_the_shadow_is_as_strong_as_it_is_seen() {
    for bounce in [DVec3::new(0.35, 0.2, 0.1), DVec3::ONE] {
        let stand = Stand::new(NO_LIGHT);
        let mut photo = Photo::plain(0);
        photo.solution.receivers[0].bounce = bounce;
        let pictures = [photo.plate(&stand), photo.frame(&stand, &stand.physical)];
        let run = Run::new(stand, pictures, &Device::shared().decoded()).unwrap();
        check_receivers(&run);
        check_receiver(&run);
        let found = run.solution.receivers[0].bounce;
        // This allows for 8 bits, and a coarse ambient map near the contact. Measured: .06.
        assert!(found.abs_diff_eq(bounce, 0.08), "{bounce} is taken for {found}");
    }
}

/// The photograph was made with known light: the device must find it, within the precision of 8
/// bits.
#[test]
fn receiver_finds_the_light_that_was_there() {
    for run in runs() {
        let truth = truth(run.region.lights.len());
        // This allows for codes of 8 bits, decoding by a driver's polynomial, a coarse ambient map,
        // and the faint light that is not listed. Measured: 8e-3 and 8e-4.
        let n_receivers = run.stand.receivers.len();
        let direct_fractions = |solution: &Solution| -> Vec<DVec3> {
            let receivers = solution.receivers[..n_receivers].iter();
            receivers
                .flat_map(|receiver| receiver.direct_fractions.clone())
                .collect()
        };
        let direct_fractions = direct_fractions(&run.solution)
            .into_iter()
            .zip(direct_fractions(&truth))
            .flat_map(|(a, b)| channels(a, b));
        Errors::between(direct_fractions)
            .check_all(&format!("{}, true direct_fractions", run.stand.setup.name), 0.02);
        Errors::between(channels(run.solution.gain, truth.gain)).check_all("true gain", 0.01);
    }
}

/// Pixels that the device sampled from one surface of the toy, with normals from rays.
fn toy_samples(run: &Run, glossy: Option<&Glossy>) -> Vec<ToySample> {
    let (stand, stride_px) = (&run.stand, run.plan.fit_stride_px);
    let occluder = stand.occluder(&stand.physical);
    let taken = Raster::from_fn(run.region.size_px / stride_px, |texel| texel * stride_px);
    let sample = |texel: &UVec2| {
        let (origin, direction) = stand.camera_ray(centre_px(run.plan.region.origin_px + *texel));
        let hit = occluder
            .nearest(origin, direction)
            .filter(|_| run.validity.at(*texel).y > 0.0)?;
        let point = SeenPoint {
            in_anchor: origin + hit.distance * direction,
            normal: stand.physical.normals[stand.toy.indices()[3 * hit.triangle] as usize].as_dvec3(),
            camera_in_anchor: origin,
            material: toy::material(hit.triangle),
            received: run.gbuffer_received.at(*texel),
        };
        Some(ToySample {
            frame: run.pictures.frame.at(*texel),
            base: run.gbuffer_base.at(*texel),
            normal: point.normal,
            received: point.received,
            reflected: glossy.map_or(Vec::new(), |glossy| glossy.columns(&run.region, &point)),
        })
    };
    taken.texels().iter().filter_map(sample).collect()
}

#[test]
fn matt_toy() {
    runs().iter().for_each(|run| check_toy(run, None, 1e-3));
}

/// The reflection of a glossy toy contributes to the estimate of its light, too.
#[test]
fn glossy_toy() {
    for setup in SETUPS {
        let stand = Stand::new(setup);
        let gloss = Gloss {
            roughness: 0.3,
            strengths: [1.0, 1.0, 0.0, 1.6, 1.0, 1.0, 1.0, 1.0],
        };
        let glossy = Glossy {
            roughness: 0.3_f32.into(),
            strengths: gloss.strengths.map(f64::from).to_vec(),
            angular_radii_rad: stand.angular_radii_rad(),
        };
        let photo = Photo {
            gloss: Some(gloss),
            ..Photo::plain(stand.setup.lights.len())
        };
        let pictures = [photo.plate(&stand), photo.frame(&stand, &stand.physical)];
        let run = Run::glossy(gloss, stand, pictures, &Device::shared().decoded()).unwrap();
        // Highlights are some ten times as bright as paint.
        check_toy(&run, Some(&glossy), 5e-3);
    }
}

fn check_toy(run: &Run, glossy: Option<&Glossy>, allowed: f64) {
    let constants = FitConstants::default();
    let samples = toy_samples(run, glossy);
    assert!(samples.len() > 80, "the toy is too small");
    // Exposure and shares of the light are those of the receivers.
    let start = Solution {
        gain: run.solution.gain,
        receivers: run.solution.receivers.clone(),
        ..start(run.region.lights.len())
    };
    let expected = fit_toy(&run.region, &samples, &start, &constants, run.plan.n_fit_steps);
    // Three sides of boxes do not constrain four unknowns; only their light on each normal counts.
    let light = |solution: &Solution, sample: &ToySample| -> DVec3 {
        toy_radiance(solution, sample.normal, sample.received)
    };
    let pairs = samples
        .iter()
        .flat_map(|sample| channels(light(&run.solution, sample), light(&expected, sample)));
    // Normals are stored in 16 bits, 5e-4 of their length. Measured: 1e-4.
    Errors::between(pairs).check_all(&format!("{}, toy", run.stand.setup.name), allowed);
}

#[test]
fn share_of_the_lights_over_the_receiver() {
    runs().iter().for_each(check_shares);
}

/// The map is computed in 32 bits from the fit that the references also use.
fn check_shares(run: &Run) {
    let size = run.direct_fraction.size();
    let scale = run.region.size_px.as_dvec2() / size.as_dvec2();
    let expected = Raster::from_fn(size, |texel| {
        let Some(point) = run.region.receiver_point(centre_px(texel) * scale) else {
            return DVec3::ZERO;
        };
        let lights = 0..run.region.lights.len();
        lights
            .map(|i| run.solution.light_fraction(&run.region, i, point))
            .sum()
    });
    for (actual, expected) in run.direct_fraction.texels().iter().zip(expected.texels()) {
        let error = (actual - expected).abs().max_element();
        assert!(error < 1e-4, "{}: {actual}, not {expected}", run.stand.setup.name);
    }
}
