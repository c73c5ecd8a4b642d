//! Names of presets, and what they spend.

use app_core::preset::{Preset, Settings};

#[test]
fn a_preset_is_asked_for_by_its_name() {
    for &preset in Preset::ALL {
        assert_eq!(preset.to_string().parse(), Ok(preset));
    }
    assert_eq!(Preset::default().name(), "balanced");
}

#[test]
fn another_name_is_refused_with_those_that_there_are() {
    for name in ["", "Balanced", "balanced ", "bal", "ultra"] {
        let refusal = name.parse::<Preset>().unwrap_err();
        assert_eq!(refusal.asked, name);
        let message = refusal.to_string();
        assert!(message.contains(&format!("\"{name}\"")), "{message}");
        for preset in Preset::ALL {
            assert!(message.contains(preset.name()), "{message}");
        }
    }
}

#[test]
fn a_preset_spends_what_the_passes_can_take() {
    for preset in Preset::ALL {
        let Settings::Model(settings) = preset.settings() else {
            continue;
        };
        let n_points = [settings.n_narrow_light_points, settings.n_light_points];
        assert!(n_points.is_sorted(), "{preset}: {n_points:?}");
        for n_points in n_points.into_iter().chain([settings.n_ambient_directions]) {
            assert!([16, 32, 64].contains(&n_points), "{preset}: {n_points}");
        }
        assert!((1..=16).contains(&settings.ambient_divisor), "{preset}");
        let toy = [settings.n_toy_draws, settings.n_toy_samples];
        assert!([[1, 1], [1, 4], [4, 4]].contains(&toy), "{preset}: {toy:?}");
        assert!([16, 32].contains(&settings.n_coverage_positions), "{preset}");
        assert!((1..=16).contains(&settings.n_self_shadow_points), "{preset}");
    }
}
