//! `occlusion`: flattened meshes compared with rays.

use std::fs;
use std::sync::Arc;

use app_core::frame::FrameInput;
use app_core::gpu::ShaderTexts;
use app_core::preset::Preset;
use app_core::scene::Image;
use app_core::shadow_style::ShadowStyle;
use app_core::sharpness::{Sharpness, Spread};
use app_core::toy::PosedMesh;
use app_pipeline::core::inspect::Inspect;
use app_pipeline::model::plan::Plan;
use app_pipeline::readback::Map;
use glam::DVec4;
use reference::model::{ReceiverPoint, Region};
use reference::occlusion::{Caster, sample_position, taken_from};
use reference::raster::Raster;
use reference::visibility::{ambient_map, soft_visibility_map, visibility_map};

use crate::cores::any_core;
use crate::device::Device;
use crate::errors::Errors;
use crate::photo::photograph;
use crate::rim::of_point;
use crate::run::{Run, input, raster, runs, scene};
use crate::setups::{FOUR_LIGHTS, SETUPS, SIDE, Setup, WALL};
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
        let maps = [
            (&stand.physical, &run.pictures.ambient, "physical ambient"),
            (&stand.shown, &run.shown_ambient, "shown ambient"),
        ];
        for (posed, actual, what) in maps {
            let casters = stand.ambient_casters(posed, n_directions);
            let shadows = shadows(stand, (&run.region, &run.plan), posed);
            let expected = ambient_map(&casters, &run.region, actual.size(), &shadows);
            let told = (what, MAX_AMBIENT_SHARE, AMBIENT_STORED);
            compare_with(run, &casters, (actual, &expected), told);
        }
    }
}

/// The visibilities of the lights over a region.
fn shadows(stand: &Stand, (region, plan): (&Region, &Plan), posed: &PosedMesh) -> Vec<Raster<f64>> {
    let lights = 0..stand.setup.lights.len();
    let map = |i| {
        visibility_map(
            &stand.light_casters(posed, i, plan.n_light_points[i]),
            region,
            region.size_px,
        )
    };
    lights.map(map).collect()
}

const PASS: &str = "lighting/occlusion";
/// Half the share of one of the 64 directions of `balanced`.
const HALF_A_DIRECTION: f64 = 0.5 / 64.0;

/// A setup with a side or a wall that sees the toy's shadows on the table, and its ambient maps in
/// both poses.
struct Upright {
    stand: Stand,
    plan: Plan,
    maps: [Raster<f64>; 2],
}

impl Upright {
    /// Drawn by a changed shader.
    fn drawn(setup: Setup, text: &str) -> Self {
        let stand = Stand::new(setup);
        let mut core = any_core();
        core.replace_shaders([(PASS.to_owned(), text.to_owned())].into_iter().collect())
            .unwrap();
        core.set_scene(scene(&stand, &blank(&stand)), Preset::Balanced)
            .unwrap();
        core.frame(&input(&stand, &blank(&stand))).unwrap();
        let maps = [Map::PhysicalAmbient, Map::Ambient]
            .map(|map| raster(&core.read_map(map).unwrap().unwrap()).map(|texel| texel.x));
        let plan = core.plan().unwrap().clone();
        core.replace_shaders(ShaderTexts::default()).unwrap();
        Self { stand, plan, maps }
    }

    /// Drawn and expected texels.
    fn pairs(&self, expected: impl Fn(&PosedMesh, &Region) -> Raster<f64>) -> Vec<(f64, f64)> {
        let region = self.stand.region(&self.plan.region);
        let posed = [&self.stand.physical, &self.stand.shown];
        let maps = self.maps.iter().zip(posed).map(|(map, posed)| {
            let expected = expected(posed, &region);
            let both = map
                .texels()
                .iter()
                .copied()
                .zip(expected.texels().iter().copied());
            both.collect::<Vec<_>>()
        });
        maps.flatten().collect()
    }

    fn casters(&self, posed: &PosedMesh) -> Vec<Caster> {
        self.stand.ambient_casters(posed, self.plan.n_ambient_directions)
    }

    /// The map by maps of the lights, as the shader has it.
    fn by_maps(&self, posed: &PosedMesh, region: &Region) -> Raster<f64> {
        let shadows = shadows(&self.stand, (region, &self.plan), posed);
        ambient_map(&self.casters(posed), region, self.maps[0].size(), &shadows)
    }

    /// The map by rays alone: from the side to the table, and from there to the lights. A direction
    /// in which the toy stands before the table lacks no more than what the toy takes.
    fn by_rays(&self, posed: &PosedMesh, region: &Region) -> Raster<f64> {
        let casters = self.casters(posed);
        let lights: Vec<_> = (0..self.stand.setup.lights.len())
            .map(|i| self.stand.light_casters(posed, i, self.plan.n_light_points[i]))
            .collect();
        let hidden = |i: usize, place: ReceiverPoint, _| {
            let caster = &lights[i][place.receiver];
            let points = caster.light_points.iter();
            let n_hidden = points.filter(|point| caster.occluder.hides(place.in_plane, **point));
            n_hidden.count() as f64 / caster.light_points.len() as f64
        };
        let size = self.maps[0].size();
        let scale = region.size_px.as_dvec2() / size.as_dvec2();
        Raster::from_fn(size, |texel| {
            let Some(shown) = region.receiver_point((texel.as_dvec2() + 0.5) * scale) else {
                return 1.0;
            };
            let caster = &casters[shown.receiver];
            let n_points = caster.light_points.len();
            let missing = caster.light_points.iter().enumerate().map(|(k, direction)| {
                let position = (texel.as_dvec2() + sample_position(k, n_points)) * scale;
                let in_plane = region.plane_of(shown).plane_point(position).unwrap();
                match caster.occluder.hides(in_plane, *direction) {
                    true => 1.0,
                    false => taken_from(
                        region,
                        ReceiverPoint { in_plane, ..shown },
                        direction.truncate(),
                        hidden,
                    ),
                }
            });
            1.0 - missing.sum::<f64>() / n_points as f64
        })
    }
}

/// A uniform picture, since visibility is independent of what it shows.
fn blank(stand: &Stand) -> Arc<Image> {
    let [width_px, height_px] = stand.setup.image_px.to_array();
    Arc::new(Image {
        width_px,
        height_px,
        rgba8: vec![128; 4 * (width_px * height_px) as usize],
    })
}

fn shader() -> String {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../shaders");
    fs::read_to_string(format!("{folder}/{PASS}.wgsl")).unwrap()
}

#[test]
fn a_side_sees_the_shadows_on_the_table() {
    let upright = Upright::drawn(SIDE, &shader());
    let pairs = upright.pairs(|posed, region| upright.by_maps(posed, region));
    let dark = pairs.iter().filter(|(_, expected)| *expected < 0.8).count();
    assert!(dark > 20, "{dark} texels are dark");
    let allowed = (HALF_A_DIRECTION, MAX_AMBIENT_SHARE);
    Errors::between(pairs).check("side", allowed, MAX_POINTS * 2.0 * HALF_A_DIRECTION);
    // Rays tell which directions the toy hides. Most texels show no side.
    let by_rays = upright.pairs(|posed, region| upright.by_rays(posed, region));
    let without = upright
        .pairs(|posed, region| visibility_map(&upright.casters(posed), region, upright.maps[0].size()));
    let without = without
        .iter()
        .zip(&by_rays)
        .map(|((_, without), (_, rays))| (*without, *rays));
    let [mean, without] =
        [Errors::between(by_rays.clone()), Errors::between(without)].map(|errors| errors.mean());
    eprintln!("side, by rays: mean error {mean:.2e}, without the table's shadows {without:.2e}");
    assert!(mean < 0.25 * without, "{mean} of {without}");
}

#[test]
fn a_fault_in_the_light_of_a_side_is_found() {
    let text = shader();
    let faults = [
        ("LIT_PART: f32 = 0.8", "LIT_PART: f32 = 0.0"),
        ("LIT_PART: f32 = 0.8", "LIT_PART: f32 = 0.5"),
        ("hidden[i] * falloff(i, place)", "hidden[i]"),
        ("here.y <= 0.0 ||", ""),
        ("max(n_above, 1.0)", "f32(globals.n_lights)"),
        (
            "receiver_of(receiver_point(texel + 0.5)) != receiver_of(place)",
            "false",
        ),
        ("- globals.receivers[own].plane_from_anchor[3].xyz", ""),
    ];
    let setups = [SIDE, WALL].map(|setup| {
        let right = Upright::drawn(setup, &text);
        let pairs = right.pairs(|posed, region| right.by_maps(posed, region));
        (setup, pairs)
    });
    for (from, to) in faults {
        assert_eq!(text.matches(from).count(), 1, "places of \"{from}\"");
        let is_found = setups.iter().any(|(setup, right)| {
            let drawn = Upright::drawn(*setup, &text.replace(from, to));
            let drawn = drawn.maps.iter().flat_map(Raster::texels);
            let pairs = drawn.zip(right).map(|(drawn, (_, expected))| (*drawn, *expected));
            let errors = Errors::between(pairs);
            errors.share_beyond(HALF_A_DIRECTION) > MAX_AMBIENT_SHARE
                || errors.max() > MAX_POINTS * 2.0 * HALF_A_DIRECTION
        });
        assert!(is_found, "\"{to}\" for \"{from}\" is not found");
    }
}

/// The ambient light of a side depends on how sharp the lights' shadows are: a softer picture of a
/// known view changes it as a first picture does.
#[test]
fn the_captured_light_of_a_side_is_as_soft_as_the_picture() {
    let stand = Stand::new(SIDE);
    let of = |outline_spread| {
        input(&stand, &blank(&stand)).with_sharpness(Sharpness {
            plate_spread: Spread::NONE,
            outline_spread,
        })
    };
    let softer = Spread {
        xx_px2: 9.0,
        xy_px2: 0.0,
        yy_px2: 9.0,
    };
    let [soft, softer] = [SOFT, softer].map(of);
    let captured = |inputs: &[&FrameInput]| {
        let mut core = any_core();
        core.set_scene(scene(&stand, &blank(&stand)), Preset::Balanced)
            .unwrap();
        for input in inputs {
            core.frame(input).unwrap();
        }
        core.read_map(Map::PhysicalAmbient).unwrap().unwrap()
    };
    let at_once = captured(&[&softer]);
    assert_ne!(captured(&[&soft]), at_once);
    assert_eq!(captured(&[&soft, &softer]), at_once);
}

/// A blur that is wider along one axis.
const SOFT: Spread = Spread {
    xx_px2: 3.2,
    xy_px2: 0.9,
    yy_px2: 1.4,
};

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
        let expected = soft_visibility_map(&casters, &run.region, actual.size(), of_point(SOFT).0);
        let told = ("soft light", MAX_LIGHT_SHARE, LIGHTS_STORED);
        compare_with(&run, &casters, (&actual, &expected), told);
        let sharp = visibility_map(&casters, &run.region, actual.size());
        let apart = actual.texels().iter().zip(sharp.texels());
        let apart = Errors::between(apart.map(|(a, b)| (*a, *b)));
        assert!(apart.max() > 0.2, "it is no sharp one: {}", apart.max());
    }
}
