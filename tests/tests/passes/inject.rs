//! Injected visibility: the device's own changes nothing, and another one is drawn.

use app_core::core::CoreError;
use app_core::frame::PassGroup;
use app_core::preset::Preset;
use app_pipeline::core::inspect::Inspect;
use app_pipeline::readback::inject::InjectedVisibility;
use app_pipeline::readback::{FloatMap, Map};

use crate::cores::core_on;
use crate::photo::photograph;
use crate::run::{input, scene};
use crate::setups::SETUPS;
use crate::stand::Stand;

#[test]
fn injected_visibility_takes_the_place_of_the_devices_own() {
    for preset in [Preset::Balanced, Preset::Paper] {
        // Two lights: the maps have two channels.
        let stand = Stand::new(SETUPS[1].twice());
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
        let learned = report.ran.iter().any(|run| run.path == PassGroup::Capture);
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

/// `composite` reads no visibility outside the shadows' tiles. Injecting a map of its own
/// visibilities keeps these tiles; a map in which a little is hidden everywhere makes it read
/// everywhere.
#[test]
fn clear_of_shadows_all_is_composed_as_elsewhere() {
    // Values that round to the code of 1.
    let hides_nothing = |map: &FloatMap| FloatMap {
        texels: map
            .texels
            .iter()
            .map(|texel| texel.map(|v| v.min(0.999)))
            .collect(),
        ..map.clone()
    };
    let mut n_apart = 0;
    for setup in SETUPS {
        let stand = Stand::new(setup.twice());
        let [plate, image] = photograph(&stand);
        let mut core = core_on(scene(&stand, &plate), Preset::Balanced).unwrap();
        let mut picture = |maps: Option<&InjectedVisibility>| {
            if let Some(maps) = maps {
                core.inject_visibility(maps).unwrap();
            }
            core.frame(&input(&stand, &image)).unwrap();
            let own =
                [Map::PhysicalVisibility, Map::Visibility].map(|map| core.read_map(map).unwrap().unwrap());
            (core.read_picture().unwrap(), own)
        };
        let (before, [physical, shown]) = picture(None);
        let injected = |of: &dyn Fn(&FloatMap) -> FloatMap| InjectedVisibility {
            physical: Some(of(&physical)),
            shown: Some(of(&shown)),
        };
        let (same, _) = picture(Some(&injected(&FloatMap::clone)));
        assert!(
            same == before,
            "{}: a shadow falls where none is looked for",
            setup.name
        );
        let (all, maps) = picture(Some(&injected(&hides_nothing)));
        assert!(maps == [physical, shown], "{}: other maps", setup.name);
        let codes = all.rgba8.iter().zip(&before.rgba8);
        let most = codes.clone().map(|(a, b)| a.abs_diff(*b)).max();
        assert!(most <= Some(1), "{}: {most:?} codes apart", setup.name);
        n_apart += codes.filter(|(a, b)| a != b).count();
    }
    assert!(n_apart > 0, "no light changed clear of shadows");
}
