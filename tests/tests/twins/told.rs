//! Which lights' strengths the real shadow tells, and what is taken for the others.

use app_core::frame::Warning;
use app_core::preset::Preset;
use app_core::scene::Light;
use glam::DVec3;

use crate::photo::Photo;
use crate::place::{SETUPS, Setup, Stand};
use crate::run::{core_on, input, scene};

const BULB: Light = bulb(0.32);
const TOGETHER: [Light; 2] = [BULB; 2];
const APART: [Light; 2] = [BULB, bulb(-0.32)];

const fn bulb(x_m: f64) -> Light {
    Light::Sphere {
        position_in_world: DVec3::new(x_m, 0.62, 0.02),
        radius_m: 0.02,
    }
}

/// Shares of the two lights in green, and the lights that are said not to be told.
fn told(lights: &'static [Light]) -> (Vec<f32>, Option<Vec<usize>>) {
    let stand = Stand::new(Setup { lights, ..SETUPS[0] });
    let photo = Photo::plain(2);
    let mut core = core_on(scene(&stand, &photo.plate(&stand)), Preset::Balanced).unwrap();
    core.frame(&input(&stand, &photo.frame(&stand, &stand.physical)))
        .unwrap();
    let shares = core.read_fit().unwrap().unwrap().receivers[0].share;
    let warnings = core.read_fit_warnings().unwrap().into_iter();
    let mut lights = warnings.filter_map(|warning| match warning {
        Warning::LightsNotTold { lights } => Some(lights),
        _ => None,
    });
    (shares[..2].iter().map(|share| share[1]).collect(), lights.next())
}

#[test]
fn of_shadows_that_fall_together_only_the_sum_is_told() {
    let (shares, not_told) = told(&TOGETHER);
    assert_eq!(not_told, Some(vec![0, 1]), "{shares:?}");
    // 0.38 and 0.2 in the picture.
    assert!(
        shares.iter().all(|share| (share - 0.29).abs() < 0.02),
        "{shares:?}"
    );
    let (shares, not_told) = told(&APART);
    assert_eq!(not_told, None, "{shares:?}");
    assert!(
        (shares[0] - 0.38).abs() < 0.02 && (shares[1] - 0.2).abs() < 0.02,
        "{shares:?}"
    );
}
