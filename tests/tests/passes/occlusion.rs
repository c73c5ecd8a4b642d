//! `occlusion`: flattened meshes compared with rays.

use app_core::preset::Preset;
use app_core::shadow_style::ShadowStyle;
use app_core::sharpness::{Sharpness, Spread};
use glam::DVec4;
use reference::occlusion::Caster;
use reference::raster::Raster;
use reference::visibility::{soft_visibility_map, visibility_map};

use crate::device::Device;
use crate::errors::Errors;
use crate::photo::photograph;
use crate::run::{Run, runs};
use crate::setups::{FOUR_LIGHTS, SETUPS, Setup};
use crate::stand::Stand;

/// Share of a region's texels that may differ by more than half a step of one light point.
///
/// Rasterisers snap corners to 1/256 pixel (`subPixelPrecisionBits` of Vulkan), which moves an edge by half of that.
/// Along the outline of one light point's shadow, one texel in some 200 has a sample that close to it; outlines of 64
/// light points are some 10^3 texels long in a region of 10^4. Measured: 0.09 %.
const MAX_LIGHT_SHARE: f64 = 0.005;
/// The same for a coarse ambient map, in which the outlines of 64 directions cross most texels.
/// Measured: 1.3 %.
const MAX_AMBIENT_SHARE: f64 = 0.03;
/// Light points that may fall on the other side of an edge in one texel. Measured: 1, and 2 of 32 before a wall.
const MAX_POINTS: f64 = 2.0;
/// Largest rounding error of stored values: each of a light's 16, 32 or 64 points has 16, 8 or 4
/// codes of 255; the ambient light, in 16-bit floats, has none.
const LIGHTS_STORED: f64 = 1.0 / 255.0;
const AMBIENT_STORED: f64 = 0.0;

fn compare(run: &Run, casters: &[Caster], actual: &Raster<f64>, told: (&str, f64, f64)) {
    let expected = visibility_map(casters, &run.region, actual.size());
    compare_with(run, casters, (actual, &expected), told);
}

fn compare_with(
    run: &Run,
    casters: &[Caster],
    (actual, expected): (&Raster<f64>, &Raster<f64>),
    (what, max_share, stored): (&str, f64, f64),
) {
    assert!(
        expected.texels().iter().any(|visibility| *visibility < 0.5),
        "{what}: there is no shadow"
    );
    let errors = Errors::between(
        actual
            .texels()
            .iter()
            .copied()
            .zip(expected.texels().iter().copied()),
    );
    let step = 1.0 / f64::from(u32::try_from(casters[0].light_points.len()).unwrap());
    let what = format!("{}, {what}", run.stand.setup.name);
    errors.check(&what, (0.5 * step, max_share), MAX_POINTS * step + stored);
}

fn compare_lights(run: &Run) {
    let stand = &run.stand;
    for i in 0..run.plan.n_lights {
        let n_points = run.plan.n_light_points[i];
        let softness = run.shadow_style.softness;
        let channel = |map: &Raster<DVec4>| map.map(|texel| texel[i]);
        compare(
            run,
            &stand.light_casters(&stand.physical, i, n_points),
            &channel(&run.pictures.visibility),
            ("physical light", MAX_LIGHT_SHARE, LIGHTS_STORED),
        );
        compare(
            run,
            &stand.softened_casters(&stand.shown, (i, softness), n_points),
            &channel(&run.shown_visibility),
            ("shown light", MAX_LIGHT_SHARE, LIGHTS_STORED),
        );
    }
}

#[test]
fn visibility_of_each_light() {
    runs().iter().for_each(compare_lights);
}

/// The shown shadow is that of lights of another width, the real one that of the lights themselves.
#[test]
fn visibility_of_softened_lights() {
    for softness in [0.0, 0.4, 3.0] {
        let style = ShadowStyle {
            softness,
            ..ShadowStyle::TRUE
        };
        let stand = Stand::new(SETUPS[0]);
        let pictures = photograph(&stand);
        compare_lights(&Run::styled(style, stand, pictures, &Device::shared().decoded()).unwrap());
    }
}

/// In all channels of one map.
#[test]
fn visibility_of_four_lights() {
    // The picture's content does not affect visibility.
    let two_lights = Setup {
        lights: &FOUR_LIGHTS.lights[..2],
        ..FOUR_LIGHTS
    };
    let pictures = photograph(&Stand::new(two_lights));
    let run = Run::new(Stand::new(FOUR_LIGHTS), pictures, &Device::shared().decoded()).unwrap();
    assert_eq!(run.plan.n_lights, 4);
    compare_lights(&run);
}

#[test]
fn visibility_of_the_ambient_light() {
    for run in runs() {
        let (stand, n_directions) = (&run.stand, run.plan.n_ambient_directions);
        compare(
            run,
            &stand.ambient_casters(&stand.physical, n_directions),
            &run.pictures.ambient,
            ("physical ambient", MAX_AMBIENT_SHARE, AMBIENT_STORED),
        );
        compare(
            run,
            &stand.ambient_casters(&stand.shown, n_directions),
            &run.shown_ambient,
            ("shown ambient", MAX_AMBIENT_SHARE, AMBIENT_STORED),
        );
    }
}

/// A blur that is wider along one axis, and the root of its covariance, with that of a pixel and
/// without that of the mean over three by three texels with which it is read, computed by hand.
const SOFT: Spread = Spread {
    xx_px2: 3.2,
    xy_px2: 0.9,
    yy_px2: 1.4,
};

fn root() -> [f64; 3] {
    let own = 1.0 / 12.0 - 0.5;
    let xx = (SOFT.xx_px2 + own).sqrt();
    let yx = SOFT.xy_px2 / xx;
    [xx, yx, (SOFT.yy_px2 + own - yx * yx).sqrt()]
}

#[test]
fn visibility_in_a_soft_picture() {
    let stand = Stand::new(FOUR_LIGHTS);
    let two_lights = Setup {
        lights: &FOUR_LIGHTS.lights[..2],
        ..FOUR_LIGHTS
    };
    let pictures = photograph(&Stand::new(two_lights));
    let sharpness = Sharpness {
        plate_spread: Spread::NONE,
        outline_spread: SOFT,
    };
    let decoded = Device::shared().decoded();
    let run = Run::of(Preset::Balanced, (stand, sharpness), pictures, &decoded).unwrap();
    for i in 0..run.plan.n_lights {
        let casters = run
            .stand
            .light_casters(&run.stand.shown, i, run.plan.n_light_points[i]);
        let actual = run.shown_visibility.map(|texel| texel[i]);
        let expected = soft_visibility_map(&casters, &run.region, actual.size(), root());
        let told = ("soft light", MAX_LIGHT_SHARE, LIGHTS_STORED);
        compare_with(&run, &casters, (&actual, &expected), told);
        let sharp = visibility_map(&casters, &run.region, actual.size());
        let apart = actual.texels().iter().zip(sharp.texels());
        let apart = Errors::between(apart.map(|(a, b)| (*a, *b)));
        assert!(apart.max() > 0.2, "it is no sharp one: {}", apart.max());
    }
}
