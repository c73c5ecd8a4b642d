//! Names and costs of presets.

use app_core::Core;
use app_core::preset::{BALANCED, BASELINE, BaselineSettings, ModelSettings, Preset, Settings};

use crate::core::bundled::{first_input, scene};

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
fn settings_that_the_passes_cannot_take_are_refused_by_field() {
    let refused = |settings: Settings| settings.check().unwrap_err().field;
    for preset in Preset::ALL {
        assert_eq!(preset.settings().check(), Ok(()), "{preset}");
        let n_points = match preset.settings() {
            Settings::Model(settings) => [settings.n_narrow_light_points, settings.n_light_points],
            _ => continue,
        };
        assert!(n_points.is_sorted(), "{preset}: {n_points:?}");
    }
    let model = |change: fn(&mut ModelSettings)| {
        let mut settings = BALANCED;
        change(&mut settings);
        refused(Settings::Model(settings))
    };
    assert_eq!(model(|it| it.n_light_points = 65), "n_light_points");
    assert_eq!(model(|it| it.n_ambient_directions = 0), "n_ambient_directions");
    assert_eq!(model(|it| it.ambient_divisor = 0), "ambient_divisor");
    assert_eq!(model(|it| it.self_shadow_tile_px = 4096), "self_shadow_tile_px");
    assert_eq!(model(|it| it.n_toy_samples = 2), "n_toy_samples");
    assert_eq!(
        model(|it| (it.n_toy_draws, it.n_toy_samples) = (4, 1)),
        "n_toy_draws"
    );
    assert_eq!(model(|it| it.n_coverage_positions = 8), "n_coverage_positions");
    assert_eq!(model(|it| it.n_self_shadow_points = 17), "n_self_shadow_points");
    let baseline = |change: fn(&mut BaselineSettings)| {
        let mut settings = BASELINE;
        change(&mut settings);
        refused(Settings::Baseline(settings))
    };
    assert_eq!(
        baseline(|it| it.constant_ratio = Some(f32::NAN)),
        "constant_ratio"
    );
    assert_eq!(baseline(|it| it.ring_step_px = 0.0), "ring_step_px");
    assert_eq!(baseline(|it| it.seam_px = -1), "seam_px");
    assert_eq!(baseline(|it| it.n_rings = 0), "n_rings");
}

#[test]
fn a_scene_takes_settings_of_the_callers() {
    let mut core = Core::counting();
    let with_points = |n| {
        Settings::Model(ModelSettings {
            n_light_points: n,
            n_narrow_light_points: n,
            ..BALANCED
        })
    };
    let refused = core.set_scene(scene(), with_points(3)).unwrap_err();
    assert_eq!(
        refused.to_string(),
        "settings, n_light_points: 3 is not 16, 32 or 64"
    );
    let mut triangles = |settings: Settings| {
        core.set_scene(scene(), settings).unwrap();
        let report = core.frame(&first_input()).unwrap();
        report.ran.iter().map(|run| run.work.triangles()).sum::<u64>()
    };
    assert!(triangles(with_points(16)) < triangles(Preset::Balanced.into()));
}
