//! The lights whose strengths the real shadow constrains, and the values that are assumed for the
//! others.

use app_core::frame::Warning;
use app_core::preset::Preset;
use app_core::scene::Light;
use app_core::things::{Mark, Things};
use app_pipeline::core::inspect::Inspect;
use app_pipeline::readback::Map;
use glam::DVec3;
use reference::raster::texels_of;

use crate::cores::core_on;
use crate::photo::Photo;
use crate::run::{input, scene};
use crate::setups::{SETUPS, Setup};
use crate::stand::Stand;

const BULB: Light = bulb(0.32);
const TOGETHER: [Light; 2] = [BULB; 2];
const APART: [Light; 2] = [BULB, bulb(-0.32)];

const fn bulb(x_m: f64) -> Light {
    Light::Sphere {
        position_in_world: DVec3::new(x_m, 0.62, 0.02),
        radius_m: 0.02,
    }
}

/// Shares of the two lights in green, and the lights that are reported as unconstrained.
fn told(lights: &'static [Light]) -> (Vec<f32>, Option<Vec<usize>>) {
    let stand = Stand::new(Setup { lights, ..SETUPS[0] });
    let photo = Photo::plain(2);
    let mut core = core_on(scene(&stand, &photo.plate(&stand)), Preset::Balanced).unwrap();
    core.frame(&input(&stand, &photo.frame(&stand, &stand.physical)))
        .unwrap();
    let direct_fractions = core.read_fit().unwrap().unwrap().receivers[0].direct_fraction;
    let warnings = core.read_fit_warnings().unwrap().into_iter();
    let mut lights = warnings.filter_map(|warning| match warning {
        Warning::LightsUnderConstrained { lights } => Some(lights),
        _ => None,
    });
    (
        direct_fractions[..2]
            .iter()
            .map(|direct_fraction| direct_fraction[1])
            .collect(),
        lights.next(),
    )
}

#[test]
fn of_shadows_that_fall_together_only_the_sum_is_told() {
    let (direct_fractions, not_told) = told(&TOGETHER);
    assert_eq!(not_told, Some(vec![0, 1]), "{direct_fractions:?}");
    // 0.38 and 0.2 in the picture.
    assert!(
        direct_fractions
            .iter()
            .all(|direct_fraction| (direct_fraction - 0.29).abs() < 0.02),
        "{direct_fractions:?}"
    );
    let (direct_fractions, not_told) = told(&APART);
    assert_eq!(not_told, None, "{direct_fractions:?}");
    assert!(
        (direct_fractions[0] - 0.38).abs() < 0.02 && (direct_fractions[1] - 0.2).abs() < 0.02,
        "{direct_fractions:?}"
    );
}

/// A cup over all but a few pixels of the shadow leaves little evidence, although the shadow on it is in
/// the picture.
#[test]
fn a_shadow_on_things_is_not_seen() {
    let stand = Stand::new(SETUPS[0]);
    let photo = Photo::plain(1);
    let frame = photo.frame(&stand, &stand.physical);
    let mut core = core_on(scene(&stand, &photo.plate(&stand)), Preset::Balanced).unwrap();
    let mut told = |marks: Vec<Mark>| {
        let things = Things::new(stand.setup.image_px, marks, stand.camera).unwrap();
        let input = input(&stand, &frame).with_things(Some(things));
        core.frame(&input).unwrap();
        let shadow = core.read_map(Map::PhysicalVisibility).unwrap().unwrap();
        (
            core.read_fit_warnings().unwrap(),
            shadow,
            core.plan().unwrap().region,
        )
    };
    let n_pixels = stand.setup.image_px.element_product() as usize;
    let mut none = vec![Mark::None; n_pixels];
    none[0] = Mark::Thing;
    let (warnings, shadow, region) = told(none.clone());
    assert!(!warnings.iter().any(is_about_size), "{warnings:?}");
    let mut n_left = 12;
    for (at, visibility) in texels_of(region.size_px).zip(&shadow.texels) {
        if visibility[0] < 1.0 {
            let in_image = region.origin_px + at;
            let is_left = visibility[0] == 0.0 && n_left > 0;
            n_left -= usize::from(is_left);
            let index = (in_image.y * stand.setup.image_px.x + in_image.x) as usize;
            none[index] = if is_left { Mark::None } else { Mark::Thing };
        }
    }
    let (warnings, ..) = told(none);
    assert!(warnings.iter().any(is_about_size), "{warnings:?}");
}

fn is_about_size(warning: &Warning) -> bool {
    matches!(warning, Warning::SmallShadow { .. } | Warning::FaintShadow { .. })
}
