//! Visibility from outside: the device's own changes nothing, another is what is drawn.

use app_core::core::CoreError;
use app_core::frame::Path;
use app_core::internals::InjectedVisibility;
use app_core::internals::{FloatMap, Inspect, Map};
use app_core::preset::Preset;

use crate::cores::core_on;
use crate::photo::photograph;
use crate::run::{input, scene};
use crate::setups::{SETUPS, Setup};
use crate::stand::Stand;

#[test]
fn injected_visibility_takes_the_place_of_the_devices_own() {
    for preset in [Preset::Balanced, Preset::Paper] {
        // Two lights: the maps have two channels.
        let stand = Stand::new(Setup {
            image_px: 2 * SETUPS[1].image_px + 1,
            ..SETUPS[1]
        });
        let [plate, image] = photograph(&stand);
        let input = input(&stand, &image);
        let mut core = core_on(scene(&stand, &plate), preset).unwrap();
        let shown = |shown| InjectedVisibility {
            physical: None,
            shown,
        };
        let early = core.inject_visibility(&shown(None)).unwrap_err();
        assert!(matches!(early, CoreError::NoScene), "{early}");

        core.frame(&input).unwrap();
        let (own, before) = (
            core.read_map(Map::Visibility).unwrap().unwrap(),
            core.read_picture().unwrap(),
        );
        core.inject_visibility(&shown(Some(own.clone()))).unwrap();
        let report = core.frame(&input).unwrap();
        assert!(
            core.read_picture().unwrap() == before,
            "{preset}: the same map, another picture"
        );
        let learned = report.ran.iter().any(|run| run.path == Path::Capture);
        assert!(learned, "{preset}: nothing was learned again");

        let dark = FloatMap {
            texels: vec![[0.0; 4]; own.texels.len()],
            ..own.clone()
        };
        core.inject_visibility(&shown(Some(dark.clone()))).unwrap();
        core.frame(&input).unwrap();
        assert_eq!(core.read_map(Map::Visibility).unwrap().unwrap().texels[0][0], 0.0);
        assert!(
            core.read_picture().unwrap() != before,
            "{preset}: darkness is not drawn"
        );

        let wrong = FloatMap {
            width: dark.width + 1,
            ..dark
        };
        let error = core.inject_visibility(&shown(Some(wrong))).unwrap_err();
        assert!(matches!(error, CoreError::SizeDiffers { .. }), "{error}");

        core.inject_visibility(&InjectedVisibility::default()).unwrap();
        core.frame(&input).unwrap();
        assert!(
            core.read_picture().unwrap() == before,
            "{preset}: an injection stayed"
        );
    }
}
