//! `retarget` on the receiver, with scattered masks, half shadows of two lights and terms of some
//! of their sets.

use app_core::wgpu;
use app_pipeline::baseline::uniform::Baseline as BaselineUniform;
use app_pipeline::geometry::rect::PixelRect;
use glam::{DVec3, DVec4, UVec2};
use reference::raster::Raster;
use reference::retarget::{Layers, Shade, receiver_color};

use crate::alone::{Bindings, Draw, check_faults, source};
use crate::device::Device;
use crate::errors::{Errors, pairs_of};
use crate::numbers::{number, numbers};
use crate::scrambled::views;
use crate::setups::SETUPS;
use crate::stand::Stand;

const SEAM_PX: i32 = 3;
const SHADES: [Shade; 3] = [
    Shade::Constant(0.6),
    Shade::Sampled { is_textured: true },
    Shade::Sampled { is_textured: false },
];
/// Measured: 2e-7.
const ALLOWED: f64 = 1e-5;

fn settings(shade: Shade) -> BaselineUniform {
    let (is_constant, constant_ratio, textured_receivers) = match shade {
        Shade::Constant(ratio) => (1, ratio, 0),
        Shade::Sampled { is_textured } => (0, 0.0, u32::from(is_textured)),
    };
    #[allow(clippy::cast_possible_truncation, reason = "a shader takes no more")]
    let constant_ratio = constant_ratio as f32;
    BaselineUniform {
        is_constant,
        constant_ratio,
        textured_receivers,
        seam_px: SEAM_PX,
        ..bytemuck::Zeroable::zeroed()
    }
}

/// Visibility of two lights, often 0 or 1 for one of them.
fn visibility(at: UVec2) -> DVec4 {
    let of_light = |seed| (2.0 * number(at, seed) - 0.5).clamp(0.0, 1.0);
    DVec4::new(of_light(150), of_light(151), 0.0, 1.0)
        .as_vec4()
        .as_dvec4()
}

/// Sums of a few terms, or of none: zero in whole patches, so that a set is missing alone and
/// together with others.
fn terms(size: UVec2, set: u32) -> Raster<DVec4> {
    Raster::from_fn(size, |at| {
        let count = (4.0 * number(at / 5, 160 + set) - 1.0).floor().max(0.0);
        let color = DVec3::from([161, 162, 163].map(|seed| number(at, seed + 10 * set)));
        (count * color).extend(count)
    })
}

/// Actual and expected colours, for every way of shading.
fn errors(source: &str) -> Errors {
    let device = Device::shared();
    let pairs = SHADES.map(|shade| pairs(device, source, shade));
    Errors::between(pairs.concat())
}

fn pairs(device: &Device, source: &str, shade: Shade) -> Vec<(f64, f64)> {
    let stand = Stand::new(SETUPS[1]);
    let rect = PixelRect {
        origin_px: UVec2::new(13, 7),
        size_px: UVec2::new(71, 53),
    };
    let size = rect.size_px;
    let image = numbers(stand.setup.image_px, 31);
    let colors = numbers(size, 32);
    let plate = Raster::from_fn(size, |at| {
        let alpha = f64::from(u8::from(number(at / 7, 170) < 0.8));
        colors.at(at).truncate().extend(alpha)
    });
    let is_toy = |at: UVec2| number(at / 3, 171) < 0.02;
    let is_shadow = |at: UVec2| number(at, 172) < 0.01;
    let masks = Raster::from_fn(size, |at| DVec4::splat(f64::from(u8::from(is_toy(at)))));
    let eligible = Raster::from_fn(size, |at| [0, u8::from(is_shadow(at))]);
    let terms = [1, 2, 3].map(|set| terms(size, set));
    let layers = Layers {
        frame: Raster::from_fn(size, |at| image.at(rect.origin_px + at).truncate()),
        plate: plate.map(|texel| (texel.w > 0.0).then_some(texel.truncate())),
        mask: Raster::from_fn(size, |at| is_toy(at) || is_shadow(at)),
        visibility: Raster::from_fn(size, visibility),
        terms: terms.to_vec(),
    };

    let uniforms = [
        device.uniform(&stand.globals(&rect)),
        device.uniform(&settings(shade)),
    ];
    let array = device.array(&terms.each_ref());
    let maps = [&image, &plate, &masks, &layers.visibility].map(|map| device.map(map));
    let labels = device.labels(&eligible);
    let shared: Bindings<'_> = vec![
        (0, uniforms[0].as_entire_binding()),
        (1, uniforms[1].as_entire_binding()),
    ];
    let mut own = views(0, &maps);
    own.push((4, wgpu::BindingResource::TextureView(&array)));
    own.push((6, wgpu::BindingResource::TextureView(&labels)));
    let draw = Draw::of(source, "fs_receiver", size);
    let actual = device.draw(draw, [&shared, &own]);
    let expected = Raster::from_fn(size, |texel| {
        receiver_color(&layers, 2, shade, SEAM_PX, texel).extend(1.0)
    });
    pairs_of(&actual, &expected)
}

#[test]
fn shadows_and_seams() {
    errors(&source("retarget")).check_all("receiver of the published picture", ALLOWED);
}

#[test]
fn a_fault_in_the_picture_is_found() {
    let faults = [
        (") + 1.0));", ") + 0.0));"),
        ("0).g != 0u", "0).g > 1u"),
        ("0).r > 0.0", "0).r > 2.0"),
        ("f32(countOneBits(", "f32(1u + 0u * countOneBits("),
        ("2u * countOneBits(", "0u * countOneBits("),
        ("& 1u) != 0u);", "& 1u) == 0u);"),
        ("if sums.a == 0.0 { return lit; }", ""),
        ("baseline.textured_receivers", "0u"),
        (".a == 0.0 { return vec4f(", ".a < 0.0 { return vec4f("),
    ];
    check_faults("retarget", &faults, ALLOWED, errors);
}
