//! `common/behind_outline`: the background of the outline in a blurred picture.

use std::sync::Arc;

use app_core::preset::Preset;
use app_core::scene::Image;
use app_core::sharpness::{Sharpness, Spread};
use app_core::wgpu::BindingResource;
use app_pipeline::core::inspect::Inspect;
use app_pipeline::geometry::rect::PixelRect;
use app_pipeline::readback::inject::InjectedVisibility;
use app_pipeline::readback::{FloatMap, Map};
use app_scene::geometry::color::{code_of_linear, linear_from_srgb};
use glam::{DVec2, DVec3, DVec4, IVec2, UVec2};
use reference::behind_outline::{beside, middle_of_free_px, plate_change, softened};
use reference::occlusion::PointSpread;
use reference::raster::{Raster, texels_of};

use crate::alone::{Draw, check_faults, source};
use crate::composite::shows_toy;
use crate::cores::core_on;
use crate::device::Device;
use crate::errors::{Errors, channels};
use crate::numbers::{number, numbers};
use crate::photo::photograph;
use crate::run::{Run, input, scene};
use crate::scrambled::{Scrambled, buffers};
use crate::setups::SETUPS;
use crate::stand::Stand;

/// The pass of the registry that contains it.
const PASS: &str = "composite";
/// The change of the plate at each pixel of the toy's box, and the visibilities beside the toy there.
const PROBES: &str = "
@fragment fn fs_change(@builtin(position) position: vec4f) -> @location(0) vec4f {
  let texel = vec2i(position.xy) + vec2i(globals.toy_box_origin_px);
  return vec4f(plate_change(texel, vec2f(texel) + middle_of_free_px(box_texel(texel), 1u)), 1.0);
}
@fragment fn fs_visibility(@builtin(position) position: vec4f) -> @location(0) vec4f {
  let texel = vec2i(position.xy) + vec2i(globals.toy_box_origin_px);
  return visibility_between(vec2f(texel) + middle_of_free_px(box_texel(texel), 1u));
}";
/// Reaches the region's left border, so that positions beyond it occur.
const BOX: PixelRect = PixelRect {
    origin_px: UVec2::new(0, 13),
    size_px: UVec2::new(97, 71),
};
const SPREAD: Spread = Spread {
    xx_px2: 2.5,
    xy_px2: -0.8,
    yy_px2: 1.1,
};
const ALLOWED: f64 = 1e-4;
/// Standard deviation of a soft picture.
const SOFT_PX: f64 = 1.5;

/// Many colours, and some that no plate shows.
fn plate(size: UVec2) -> Raster<DVec4> {
    Raster::from_fn(size, |at| {
        let color = DVec3::from([1, 2, 3].map(|seed| 0.04 + number(at, seed)));
        let alpha = if number(at / 9, 5) < 0.1 { 0.25 } else { 1.0 };
        color.as_vec3().as_dvec3().extend(alpha)
    })
}

/// The toy's share of a pixel: patches of all, of parts, and of nothing.
fn covered(at: UVec2) -> f64 {
    match number(at / 11, 6) {
        patch if patch < 0.3 => 0.0,
        patch if patch < 0.6 => 1.0,
        _ => (4.0 * number(at, 7)).floor() / 4.0,
    }
}

/// Errors of the changes and visibilities that `source` computes.
fn errors(source: &str) -> Errors {
    let (device, scene) = (Device::shared(), Scrambled::new());
    let globals = scene.stand.globals(&scene.rect);
    let globals = globals.with_boxes(&BOX, &BOX).with_spread(SPREAD);
    let plate = plate(scene.rect.size_px);
    let covered = Raster::from_fn(BOX.size_px, covered);
    let toy = covered.map(|part| DVec3::ONE.extend(part));
    let visibility = numbers(scene.rect.size_px, 8);
    let [of_plate, of_toy, of_visibility] = [&plate, &toy, &visibility].map(|map| device.map(map));
    let [_, fit] = scene.shared(device);
    let shared = [device.uniform(&globals), fit];
    // Only two groups are bound here.
    let source = source
        .replace("@group(2) @binding(0)", "@group(1) @binding(20)")
        .replace("@group(3) @binding(1)", "@group(1) @binding(21)")
        .replace("@group(2) @binding(2)", "@group(1) @binding(22)")
        // One draw is read.
        .replace("textureLoad(toy_1, texel, 0)", "first")
        .replace("textureLoad(toy_2, texel, 0)", "first")
        .replace("textureLoad(toy_3, texel, 0)", "first");
    let source = format!("{source}{PROBES}");
    // A probe binds what it reads.
    let drawn = |probe: &str, n_shared: usize, maps: &[(u32, BindingResource<'_>)]| {
        let draw = Draw::of(&source, probe, BOX.size_px);
        device.draw(draw, [&buffers(0, &shared)[..n_shared], maps])
    };
    let bound = |slot: u32, map| (slot, BindingResource::TextureView(map));
    let changes = drawn("fs_change", 2, &[bound(20, &of_plate), bound(21, &of_toy)]);
    let beside_toy = drawn(
        "fs_visibility",
        1,
        &[bound(21, &of_toy), bound(22, &of_visibility)],
    );
    let [a, b, c, d] = globals.spread.map(f64::from);
    let spread = PointSpread {
        axes_px: [DVec2::new(a, b), DVec2::new(c, d)],
        is_line: false,
    };
    let means = softened(&visibility, f64::from(globals.soft_side));
    let mut n_other = 0;
    let pairs = texels_of(BOX.size_px).flat_map(|at| {
        let (texel, middle_px) = (BOX.origin_px + at, middle_of_free_px(&covered, spread, at));
        let expected = plate_change(&plate, scene.solution.gain, texel, middle_px);
        n_other += u32::from(expected != DVec3::ZERO);
        let visibilities = beside_toy.at(at).to_array().into_iter();
        let expected_there = beside(&means, texel, middle_px).to_array();
        channels(changes.at(at).truncate(), expected).chain(visibilities.zip(expected_there))
    });
    let errors = Errors::between(pairs.collect::<Vec<_>>());
    assert!(n_other > 3000, "{n_other} plates change");
    errors
}

#[test]
fn the_plate_of_an_outline_is_what_the_toy_leaves_free() {
    errors(&source(PASS)).check_all("background of the outline", ALLOWED);
}

#[test]
fn a_fault_in_the_background_of_an_outline_is_found() {
    let faults = [
        ("OUTLINE_ROW_STEP: u32 = 9u", "OUTLINE_ROW_STEP: u32 = 5u"),
        ("(1.0 - drawn_toy(tap, n_draws).a)", "drawn_toy(tap, n_draws).a"),
        ("floor(from_px + 0.5)", "floor(from_px)"),
        ("sum.xy / sum.z, sum.z > 0.0", "sum.xy / 32.0, true"),
        ("free.a == 1.0", "true"),
        ("fit.gain.rgb * (free", "fit.gain.gbr * (free"),
        (
            "clamp(low + corner, vec2f(0.0), globals",
            "clamp(low + corner, vec2f(1.0), globals",
        ),
        ("least = min(least, one.a);", ""),
        (
            "sum += near.z * soft_texel(visibility, vec2i(near.xy))",
            "sum += 0.25 * soft_texel(visibility, vec2i(near.xy))",
        ),
    ];
    check_faults(PASS, &faults, ALLOWED, errors);
}

/// A picture with a third of the green code in some pixels.
fn with_less_green(image: &Arc<Image>, hidden: impl Fn(UVec2) -> bool) -> Arc<Image> {
    let mut darker = image.as_ref().clone();
    for (index, codes) in (0..).zip(darker.rgba8.chunks_mut(4)) {
        if hidden(UVec2::new(index % image.width_px, index / image.width_px)) {
            codes[1] /= 3;
        }
    }
    Arc::new(darker)
}

/// A picture in which light is spread.
fn blurred(image: &Arc<Image>) -> Arc<Image> {
    let size = UVec2::new(image.width_px, image.height_px);
    let light = Raster::from_fn(size, |at| {
        let first = 4 * (at.y * size.x + at.x) as usize;
        DVec3::from([0, 1, 2].map(|k| f64::from(linear_from_srgb(f32::from(image.rgba8[first + k]) / 255.0))))
    });
    let along = |light: &Raster<DVec3>, step: IVec2| {
        Raster::from_fn(size, |at| {
            let parts = (-5..=5).map(|k| {
                let near = (at.as_ivec2() + k * step).clamp(IVec2::ZERO, size.as_ivec2() - 1);
                let weight = (-0.5 * (f64::from(k) / SOFT_PX).powi(2)).exp();
                (light.at(near.as_uvec2()) * weight).extend(weight)
            });
            let sum = parts.sum::<DVec4>();
            sum.truncate() / sum.w
        })
    };
    let soft = along(&along(&light, IVec2::X), IVec2::Y);
    let codes = texels_of(size).flat_map(|at| {
        let [r, g, b] = soft.at(at).as_vec3().to_array().map(code_of_linear);
        [r, g, b, 255]
    });
    Arc::new(Image {
        rgba8: codes.collect(),
        ..image.as_ref().clone()
    })
}

/// The picture of a soft frame, and the same with less green in the plate where the shown toy hides it, and in
/// the frame where it shows that.
fn runs([shown, physical]: &[Raster<bool>; 2]) -> [Run; 2] {
    let [plate, frame] = photograph(&stand());
    let red = [
        with_less_green(&plate, |at| shown.at(at)),
        with_less_green(&frame, |at| shown.at(at) && !physical.at(at)),
    ];
    [[plate, frame], red].map(run)
}

/// The picture of a frame that is blurred.
fn run([plate, frame]: [Arc<Image>; 2]) -> Run {
    let pictures = [plate, blurred(&frame)];
    let decoded = Device::shared().decoded();
    Run::of(Preset::Balanced, (stand(), soft()), pictures, &decoded).unwrap()
}

fn soft() -> Sharpness {
    Sharpness {
        plate_spread: Spread::NONE,
        outline_spread: Spread::round(SOFT_PX),
    }
}

fn stand() -> Stand {
    Stand::new(SETUPS[0].twice())
}

/// Where the shown, and the real toy hide the table.
fn hidden() -> [Raster<bool>; 2] {
    let whole = PixelRect {
        origin_px: UVec2::ZERO,
        size_px: stand().setup.image_px,
    };
    [stand().shown, stand().physical].map(|pose| shows_toy(&stand(), &pose, &whole))
}

/// Texels of the region at the outline, in pixels of the table that the shown toy hides and the real one does
/// not: elsewhere the frame shows what is beside the old toy.
fn outline<'a>(run: &'a Run, hidden: &'a [Raster<bool>; 2]) -> impl Iterator<Item = UVec2> + 'a {
    texels_of(run.region.size_px).filter(|texel| {
        let at = run.plan.region.origin_px + *texel;
        let is_outline = (0.3..0.9).contains(&run.coverage.at(*texel));
        is_outline && hidden[0].at(at) && !hidden[1].at(at)
    })
}

/// Mean loss of green codes from one to the other.
fn lost_green(codes: impl Iterator<Item = [u8; 2]>) -> f64 {
    let (mut n, mut lost) = (0.0, 0.0);
    for [before, after] in codes.map(|codes| codes.map(f64::from)) {
        n += 1.0;
        lost += (before - after).max(0.0);
    }
    assert!(n > 100.0, "{n} pixels of the outline");
    lost / n
}

/// A table that is red below the shown toy alone shows little red at the toy's soft outline.
#[test]
fn what_the_toy_hides_does_not_show_at_its_outline() {
    let hidden = hidden();
    let [plain, red] = runs(&hidden);
    let green = |texel| [&plain, &red].map(|run| run.picture.at(texel)[1]);
    let lost = lost_green(outline(&plain, &hidden).map(green));
    // Measured: 5.4, and 19.9 if the plate at the pixel itself is taken.
    eprintln!("{lost:.2} codes");
    assert!(lost < 10.0, "{lost:.2} codes");
}

/// A table that is dark below the shown toy alone does not darken the toy's soft outline.
#[test]
fn a_shadow_that_the_toy_hides_does_not_show_at_its_outline() {
    let hidden = hidden();
    let [plate, frame] = photograph(&stand());
    let plain = run([Arc::clone(&plate), Arc::clone(&frame)]);
    let input = input(&stand(), &blurred(&frame)).with_sharpness(soft());
    let mut core = core_on(scene(&stand(), &plate), Preset::Balanced).unwrap();
    core.frame(&input).unwrap();
    let own = core.read_map(Map::Visibility).unwrap().unwrap();
    // The means over the spread, of a light that nothing hides, or the toy's own place.
    let texels = |light: &dyn Fn(UVec2) -> f64| {
        let all =
            texels_of(plain.region.size_px).map(|texel| DVec4::splat(light(texel)).as_vec4().to_array());
        InjectedVisibility {
            physical: None,
            shown: Some(FloatMap {
                texels: all.collect(),
                ..own.clone()
            }),
        }
    };
    let lit = texels(&|_| 1.0);
    let dark = texels(&|texel| 1.0 - plain.coverage.at(texel));
    let pictures = [lit, dark].map(|visibility| {
        core.inject_visibility(&visibility).unwrap();
        core.frame(&input).unwrap();
        core.read_picture().unwrap()
    });
    let green = |texel: UVec2| {
        let at = plain.plan.region.origin_px + texel;
        let index = (at.y * stand().setup.image_px.x + at.x) as usize;
        [0, 1].map(|k: usize| pictures[k].rgba8[4 * index + 1])
    };
    let lost = lost_green(outline(&plain, &hidden).map(green));
    // Measured: .56, and 1.04 with the visibility at the pixel itself. Parts that stand still keep their pixels.
    eprintln!("{lost:.2} codes");
    assert!(lost < 0.8, "{lost:.2} codes");
}
