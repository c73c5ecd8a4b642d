//! Cameras close to the table's plane, which see little of the shadow: a warning is given if that
//! matters, and only then.

use app_core::frame::Warning;
use app_core::preset::Preset;
use app_pipeline::core::inspect::Inspect;
use glam::DVec3;

use crate::cores::core_on;
use crate::photo::{Photo, truth};
use crate::run::{input, scene, solution};
use crate::setups::{SETUPS, Setup};
use crate::stand::Stand;

/// Error of a direct fraction up to which it counts as measured.
const MEASURED: f64 = 0.05;
const ASSUMED: f64 = 0.12;

/// Elevation of the camera over the table's plane.
const ELEVATIONS_DEG: [f64; 5] = [0.3, 1.0, 2.0, 3.0, 6.0];

fn stand(setup: Setup, elevation_deg: f64, half_extent_m: Option<f64>) -> Stand {
    let (sin, cos) = elevation_deg.to_radians().sin_cos();
    let aside = cos * DVec3::new(0.3, 0.0, 0.75).normalize();
    // The camera looks at a point 35 mm over the table.
    let offset = setup.distance_m * (aside + sin * DVec3::Y) - 0.035 * DVec3::Y;
    let stand = Stand::seen_from(setup, offset);
    match half_extent_m {
        Some(half_extent_m) => stand.on_table(half_extent_m),
        None => stand,
    }
}

#[test]
fn a_faint_shadow_is_told_where_its_strength_is_assumed() {
    for setup in [SETUPS[0], SETUPS[2]] {
        let setup = setup.of_size(231, 173);
        for elevation_deg in ELEVATIONS_DEG {
            for half_extent_m in [None, Some(1.5)] {
                let stand = stand(setup, elevation_deg, half_extent_m);
                let photo = Photo::plain(setup.lights.len());
                let (plate, frame) = (photo.plate(&stand), photo.frame(&stand, &stand.physical));
                let mut core = core_on(scene(&stand, &plate), Preset::Balanced).unwrap();
                let of_frame = core.frame(&input(&stand, &frame)).unwrap().warnings;
                let of_fit = core.read_fit_warnings().unwrap();
                let fit = solution(&core.read_fit().unwrap().unwrap(), 1);
                let [fitted, expected] =
                    [&fit, &truth(1)].map(|solution| solution.receivers[0].direct_fractions[0]);
                let off = (fitted - expected).abs().max_element();
                let what = format!(
                    "{}, {elevation_deg} deg, {half_extent_m:?}: off by {off:.3}",
                    setup.name
                );
                eprintln!("{what}: {of_frame:?} {of_fit:?}");
                assert!(of_frame.is_empty(), "{what}: {of_frame:?}");
                let is_faint = |warning: &Warning| {
                    matches!(warning, Warning::FaintShadow { .. } | Warning::SmallShadow { .. })
                };
                assert!(of_fit.iter().all(is_faint), "{what}: {of_fit:?}");
                assert!(off > MEASURED || of_fit.is_empty(), "{what}: {of_fit:?}");
                assert!(off < ASSUMED || !of_fit.is_empty(), "{what}: not told");
            }
        }
    }
}
