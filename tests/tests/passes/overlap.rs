//! Overlapping shadows of two lights, for which the real shadows are samples, complete or
//! incomplete: the published method on injected visibilities.

use app_core::frame::{FrameInput, UnseenShadow, Warning};
use app_core::preset::{BASELINE, Preset, Settings};
use app_core::scene::{Light, Scene};
use app_pipeline::core::inspect::Inspect;
use app_pipeline::geometry::rect::PixelRect;
use app_pipeline::readback::inject::InjectedVisibility;
use app_pipeline::readback::{FloatMap, Map};
use glam::{DVec3, DVec4, UVec2};
use reference::eligible::masks;
use reference::raster::Raster;
use reference::sets::LightSet;

use crate::cores::{SharedCore, core_on};
use crate::device::Device;
use crate::photo::photograph;
use crate::run::{crop, input, raster, scene};
use crate::setups::SETUPS;
use crate::stand::Stand;

/// A core that has made one frame, its inputs, and its work region.
struct Shot {
    core: SharedCore,
    input: FrameInput,
    region: PixelRect,
}

impl Shot {
    /// A shot of the setup with two lights, twice as large, since the eligible part excludes edges.
    fn new(preset: Preset) -> Self {
        Self::of_scene(preset, |_| ())
    }

    /// The same for a changed scene.
    fn of_scene(preset: Preset, change: impl FnOnce(&mut Scene)) -> Self {
        let stand = Stand::new(SETUPS[1].twice());
        let [plate, image] = photograph(&stand);
        let input = input(&stand, &image);
        let mut scene = scene(&stand, &plate);
        change(&mut scene);
        let mut core = core_on(scene, preset).unwrap();
        let region = core.frame(&input).unwrap().region.unwrap();
        Self { core, input, region }
    }

    fn map(&self, map: Map) -> FloatMap {
        self.core.read_map(map).unwrap().unwrap()
    }

    /// Makes the frame anew; the real shadow is the shown one after `change`.
    fn learn(&mut self, change: impl Fn([f32; 4]) -> [f32; 4]) {
        let shown = self.map(Map::Visibility);
        let physical = FloatMap {
            texels: shown.texels.iter().copied().map(change).collect(),
            ..shown.clone()
        };
        let maps = InjectedVisibility {
            physical: Some(physical),
            shown: Some(shown),
        };
        self.core.inject_visibility(&maps).unwrap();
        self.core.frame(&self.input).unwrap();
    }

    /// The sets of lights of the new shadows' terms.
    fn sets_of_terms(&self) -> Vec<f32> {
        self.map(Map::Terms).texels.iter().map(|term| term[3]).collect()
    }
}

#[test]
fn masks_follow_the_real_shadows_of_both_lights() {
    let mut shot = Shot::new(Preset::Paper);
    shot.learn(|visibility| visibility);
    let is_toy = raster(&shot.map(Map::Masks)).map(|texel| texel.x > 0.0);
    let visibility = raster(&shot.map(Map::Visibility));
    let (eligible, shadow) = masks(&is_toy, &visibility, 2, BASELINE.eligible_margin_px);
    let actual = raster(&shot.map(Map::Eligible));
    let expected = eligible.texels().iter().zip(shadow.texels());
    for (index, (actual, (set, is_shadow))) in actual.texels().iter().zip(expected).enumerate() {
        let is_same = actual.x == f64::from(set.0) && actual.y == f64::from(u8::from(*is_shadow));
        assert!(is_same, "texel {index}: {actual}, not {set:?} and {is_shadow}");
    }
    let lone = [1, 2].map(|set| eligible.texels().contains(&LightSet(set)));
    assert_eq!(lone, [true; 2], "each light has an umbra of its own");
}

/// Visibilities in which the second light reaches every place that the first does not.
fn without_overlap([first, second, ..]: [f32; 4]) -> [f32; 4] {
    [first, if first < 1.0 { 1.0 } else { second }, 0.0, 1.0]
}

#[test]
fn lights_are_numbered_as_they_are_listed() {
    let below = Light::Sphere {
        position_in_world: DVec3::NEG_Y,
        radius_m: 0.01,
    };
    let mut shot = Shot::of_scene(Preset::Paper, |scene| scene.lights.insert(0, below));
    shot.learn(without_overlap);
    let unseen = vec![UnseenShadow {
        receiver: 0,
        lights: vec![1, 2],
    }];
    let warnings = shot.core.read_fit_warnings().unwrap();
    assert_eq!(warnings, [Warning::ShadowsUnseen { unseen }]);
    let warnings = shot.core.frame(&shot.input).unwrap().warnings;
    assert_eq!(warnings, [Warning::LightsBelowReceivers { lights: vec![0] }]);
}

#[test]
fn overlap_that_was_never_seen_is_told_and_leaves_no_hole() {
    let mut shot = Shot::new(Preset::Paper);
    let before = shot.sets_of_terms();
    assert!(before.contains(&3.0), "the new shadows overlap");
    shot.learn(without_overlap);
    assert_eq!(shot.sets_of_terms(), before, "a hole");
    let warnings = shot.core.read_fit_warnings().unwrap();
    let unseen = vec![UnseenShadow {
        receiver: 0,
        lights: vec![0, 1],
    }];
    assert_eq!(warnings, [Warning::ShadowsUnseen { unseen }]);
}

#[test]
fn nothing_to_sample_is_told_and_nothing_is_searched() {
    let mut shot = Shot::new(Preset::Paper);
    // A penumbra everywhere.
    shot.learn(|_| [0.5, 0.5, 0.0, 1.0]);
    let taps = shot.map(Map::SearchTaps);
    assert!(taps.texels.iter().all(|texel| texel[0] == 0.0), "searched");
    assert!(shot.sets_of_terms().iter().all(|set| *set == 0.0));
    let warnings = shot.core.read_fit_warnings().unwrap();
    assert_eq!(warnings, [Warning::NothingToSample]);
}

#[test]
fn constant_shadows_multiply() {
    let Settings::Baseline(settings) = Preset::Flat.settings() else {
        panic!("the preset is the published method's");
    };
    let of_all = f64::from(settings.constant_ratio.unwrap());
    let of_one = of_all.sqrt();
    let decoded = Device::shared().decoded();
    let mut shot = Shot::new(Preset::Flat);
    // Rounding to codes goes both ways, and averages out over a block of pixels.
    let block = Raster::from_fn(UVec2::splat(12), |at| at);
    let mean = |picture: &Raster<DVec3>| -> DVec3 { block.texels().iter().map(|at| picture.at(*at)).sum() };
    // At the exposure of the frame.
    let plate = mean(&raster(&shot.map(Map::Plate)).map(DVec4::truncate));
    for (visibility, expected) in [
        ([0.0, 0.0], of_all),
        ([0.0, 1.0], of_one),
        ([0.0, 0.5], 0.5 * (of_one + of_all)),
        ([0.5, 0.5], 0.25 * (1.0 + 2.0 * of_one + of_all)),
    ] {
        let everywhere = FloatMap {
            texels: vec![[visibility[0], visibility[1], 0.0, 1.0]; shot.map(Map::Visibility).texels.len()],
            ..shot.map(Map::Visibility)
        };
        let maps = InjectedVisibility {
            physical: Some(everywhere.clone()),
            shown: Some(everywhere),
        };
        shot.core.inject_visibility(&maps).unwrap();
        shot.core.frame(&shot.input).unwrap();
        let picture = crop(&shot.core.read_picture().unwrap(), &shot.region, &decoded);
        let actual = mean(&picture) / plate;
        let error = (actual - expected).abs().max_element();
        // Measured: 6e-3, mostly from the driver's decoding of sRGB.
        assert!(error < 0.01, "{visibility:?}: {actual}, not {expected}");
    }
}
