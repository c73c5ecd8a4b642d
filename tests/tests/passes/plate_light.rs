//! `common/plate_light`: light and sky on receivers beside which others stand.

use app_pipeline::geometry::rect::PixelRect;
use glam::{DVec4, UVec2};
use reference::model::centre_px;
use reference::raster::Raster;

use crate::alone::{Draw, check_faults, source};
use crate::device::Device;
use crate::errors::{Errors, pairs_of};
use crate::scrambled::buffers;
use crate::setups::{BOOK, PILE, RAMP, Setup, UNLIT_FACES, WALL};
use crate::stand::Stand;

/// A pass of the registry that contains it, and vertices for a whole target.
const PASS: &str = "rim";
/// Both lights, the open sky, and the receiver's number, at each pixel; zero where there is none.
const PROBE: &str = "
@fragment fn fs_probe(@builtin(position) position: vec4f) -> @location(0) vec4f {
  let point = receiver_point(position.xy);
  if !is_hit(point) { return vec4f(0.0); }
  return vec4f(falloff(0u, point), falloff(1u, point), open_sky(point), f32(receiver_of(point)));
}";

/// Errors of the light that `source` computes beside a book, a pile of books, a ramp and a wall, of
/// pixels that do not lie at the border of a receiver.
fn errors(source: &str) -> Errors {
    let source = format!("{source}{PROBE}");
    let pairs = [BOOK, UNLIT_FACES, PILE, RAMP, WALL].map(|setup| pairs(&source, setup));
    Errors::between(pairs.concat())
}

fn pairs(source: &str, setup: Setup) -> Vec<(f64, f64)> {
    let (device, stand) = (Device::shared(), Stand::new(setup));
    let rect = PixelRect {
        origin_px: UVec2::ZERO,
        size_px: setup.image_px,
    };
    let region = stand.region(&rect);
    let n_lights = setup.lights.len();
    let globals = [device.uniform(&stand.globals(&rect))];
    let draw = Draw::of(source, "fs_probe", rect.size_px);
    let actual = device.draw(draw, [&buffers(0, &globals), &[]]);
    let point = |at: UVec2| region.receiver_point(centre_px(at));
    let expected = Raster::from_fn(rect.size_px, |at| {
        point(at).map_or(DVec4::ZERO, |point| {
            let light = |i: usize| {
                if i < n_lights {
                    region.falloff(i, point)
                } else {
                    0.0
                }
            };
            #[allow(clippy::cast_precision_loss, reason = "a receiver's number")]
            let number = point.receiver as f64;
            DVec4::new(light(0), light(1), region.open_sky(point), number)
        })
    });
    let is_inside = |at: UVec2| {
        let around = [
            UVec2::ZERO,
            UVec2::new(2, 1),
            UVec2::new(1, 2),
            UVec2::new(0, 1),
            UVec2::new(1, 0),
        ];
        let number =
            |offset: UVec2| point((at + offset).saturating_sub(UVec2::ONE)).map(|point| point.receiver);
        around.iter().all(|offset| number(*offset) == number(UVec2::ONE))
    };
    let known = |map: &Raster<DVec4>| {
        Raster::from_fn(
            rect.size_px,
            |at| if is_inside(at) { map.at(at) } else { DVec4::ZERO },
        )
    };
    let (actual, expected) = (known(&actual), known(&expected));
    let is_partial = |part: f64| part > 0.01 && part < 0.9;
    let n_partial = |channel: usize| {
        let texels = expected.texels().iter();
        texels.filter(|texel| is_partial(texel[channel])).count()
    };
    assert!(
        n_partial(0) > 20,
        "{}: light 0 is hidden nowhere in part",
        setup.name
    );
    pairs_of(&actual, &expected)
}

/// Limit for rounding.
const ALLOWED: f64 = 5e-4;

#[test]
fn light_beside_things() {
    errors(&source(PASS)).check_all("plate_light", ALLOWED);
}

#[test]
fn a_fault_in_the_light_beside_things_is_found() {
    let faults = [
        ("SHARPEST_M: f32 = 5e-4", "SHARPEST_M: f32 = 5e-2"),
        ("STANDS: f32 = 0.5", "STANDS: f32 = -0.5"),
        ("LEAST_SKY: f32 = 0.02", "LEAST_SKY: f32 = 0.7"),
        ("max(max(below.x, below.y), max(below.z, below.w))", "0.0"),
        ("0.5 + (asin(c)", "0.4 + (asin(c)"),
        ("light.xyz - light.w * here", "light.xyz"),
        ("sqrt(1.0 + slope * slope)", "vec2f(1.0)"),
        ("disc_parts((at - rect.xy) / radius) + ", "1.0 + "),
        ("select(0.0, entered(rect", "select(1.0, entered(rect"),
        ("return near.x * near.y *", "return near.x *"),
        ("max(within.x + within.y - 1.0, 0.0);", "within.x;"),
        ("vec2f(-corner.y, corner.x)", "vec2f(-corner.x, corner.y)"),
        ("length(vec3f(across, dot(across, slope)))", "length(across)"),
        ("here.y / up.y * up.xz", "vec2f(0.0)"),
        (
            "entered(rect, above, at, across, radius, slope), here.y < 0.0)",
            "entered(rect, above, at, across, radius, slope), true)",
        ),
        (
            "* turn_of(a - middle, b - middle) < 0.0",
            "* turn_of(a - middle, b - middle) > 0.0",
        ),
        ("0.5 * INVERSE_PI * max(ground", "INVERSE_PI * max(ground"),
        ("UNLIT_FACE: f32 = 0.75", "UNLIT_FACE: f32 = 0.8"),
        ("light.xz - light.w * start", "light.xz"),
        ("vec2f(along.y, -along.x)", "vec2f(-along.y, along.x)"),
        ("left * ratio * ratio * ratio", "left * ratio * ratio"),
    ];
    check_faults(PASS, &faults, ALLOWED, errors);
}
