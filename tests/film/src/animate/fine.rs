//! Pictures of more than 8 bits: PNG of 16, and OpenEXR with the layers of a picture, in linear
//! light.

use std::io::Cursor;
use std::path::Path;

use anyhow::Context;
use app_core::core::{FloatMap, Layers};
use app_scene::geometry::color::srgb_from_linear;
use desk::output::write_whole;
use exr::math::Vec2;
use exr::meta::attribute::{Chromaticities, Text};
use exr::prelude::{
    AnyChannel, AnyChannels, Encoding, FlatSamples, Image, IntegerBounds, Layer, LayerAttributes,
    WritableImage, f16,
};
use image::codecs::png::PngEncoder;
use image::{ImageBuffer, Rgb};

/// Largest code of 16 bits.
const MOST_CODE: f32 = 65535.0;

/// Writes a picture of linear light as a PNG of 16 bits, in sRGB.
///
/// # Errors
/// When its texels do not fit its size, or the system refuses.
pub fn write_png_16(path: &Path, light: &FloatMap) -> anyhow::Result<()> {
    let codes = light
        .texels
        .iter()
        .flat_map(|[r, g, b, _]| [*r, *g, *b].map(code_16));
    let codes: ImageBuffer<Rgb<u16>, Vec<u16>> =
        ImageBuffer::from_raw(light.width, light.height, codes.collect())
            .context("the picture's bytes do not fit its size")?;
    let mut png = Vec::new();
    codes.write_with_encoder(PngEncoder::new(&mut png))?;
    Ok(write_whole(path, &png)?)
}

/// The code of 16 bits nearest to linear light; light brighter than white becomes white.
#[must_use]
#[allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "from 0 to 65535"
)]
pub fn code_16(linear: f32) -> u16 {
    (MOST_CODE * srgb_from_linear(linear.clamp(0.0, 1.0))).round() as u16
}

/// Writes a picture and its layers as one OpenEXR file of half floats: the picture as R, G and B, each layer's channels behind its name
/// and a dot.
///
/// # Errors
/// When their texels do not fit their size, or the system refuses.
pub fn write_exr(path: &Path, light: &FloatMap, layers: &Layers) -> anyhow::Result<()> {
    let channels = [
        named("", ["R", "G", "B"], light),
        named("clean_plate.", ["R", "G", "B"], &layers.clean_plate),
        named("shadow_ratio.", ["R", "G", "B"], &layers.shadow_ratio),
        named("toy.", ["R", "G", "B", "A"], &layers.toy),
        named("masks.", ["R", "G", "B"], &layers.masks),
    ];
    let channels = AnyChannels::sort(channels.into_iter().flatten().collect());
    let size = Vec2(light.width as usize, light.height as usize);
    let attributes = LayerAttributes {
        comments: Some(Text::from(
            "linear light; masks are of toy, shadow and receiver; toy is premultiplied; toy over (clean_plate * shadow_ratio) is the picture but for its grain",
        )),
        ..LayerAttributes::default()
    };
    let layer = Layer::new(size, attributes, Encoding::SMALL_LOSSLESS, channels);
    let mut image = Image::from_layer(layer);
    image.attributes.display_window = IntegerBounds::from_dimensions(size);
    image.attributes.chromaticities = Some(REC_709);
    let mut bytes = Cursor::new(Vec::new());
    image.write().non_parallel().to_buffered(&mut bytes)?;
    Ok(write_whole(path, bytes.get_ref())?)
}

/// Primaries and white of sRGB. Source: ITU-R BT.709.
const REC_709: Chromaticities = Chromaticities {
    red: Vec2(0.64, 0.33),
    green: Vec2(0.3, 0.6),
    blue: Vec2(0.15, 0.06),
    white: Vec2(0.3127, 0.329),
};

/// The first channels of a map, with names.
fn named<const N: usize>(layer: &str, names: [&str; N], map: &FloatMap) -> Vec<AnyChannel<FlatSamples>> {
    let channel = |(index, name): (usize, &str)| {
        let values = map.texels.iter().map(|texel| f16::from_f32(texel[index]));
        AnyChannel::new(
            format!("{layer}{name}").as_str(),
            FlatSamples::F16(values.collect()),
        )
    };
    names.into_iter().enumerate().map(channel).collect()
}
