//! Colours of a toy's textures at the size of a pixel.

use glam::DVec2;

use crate::picture::Color;
use app_scene::toy::{Texture, Wrap};

/// Width and height of a texture, in texels.
pub(super) fn texture_size(texture: &Texture) -> DVec2 {
    DVec2::new(f64::from(texture.width_px), f64::from(texture.height_px))
}

/// Mean of texels around a place, in linear light, over a square with this side in texels; (0, 0)
/// is the corner of the first texel.
pub(super) fn mean_texel(
    texture: &Texture,
    linear: &[f32; 256],
    (uv, wraps): (DVec2, [Wrap; 2]),
    side: f64,
) -> Color {
    /// Maximum number of texels along each side of the square: more would hardly change the mean.
    const MOST_TEXELS: f64 = 4.0;
    let size = texture_size(texture);
    let n = side.min(MOST_TEXELS).round();
    let index = |at: DVec2| {
        let [x, y] = [
            texel(at.x / size.x, wraps[0], texture.width_px),
            texel(at.y / size.y, wraps[1], texture.height_px),
        ];
        4 * (y as usize * texture.width_px as usize + x as usize)
    };
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "1 to 4")]
    let steps = 0..n as u32;
    let offset = |step: u32| ((f64::from(step) + 0.5) / n - 0.5) * side;
    let mut sum = [0.0; 3];
    for y in steps.clone() {
        for x in steps.clone() {
            let at = index(uv * size + DVec2::new(offset(x), offset(y)));
            let codes = texture.rgba8_srgb.get(at..at + 3).unwrap_or(&[u8::MAX; 3]);
            sum = [0, 1, 2].map(|channel| sum[channel] + linear[usize::from(codes[channel])]);
        }
    }
    #[allow(clippy::cast_possible_truncation, reason = "1 to 16")]
    sum.map(|sum| sum / (n * n) as f32)
}

/// The texel at a coordinate, of `n` texels.
fn texel(at: f64, wrap: Wrap, n: u32) -> u32 {
    let at = match wrap {
        Wrap::Repeat => at.rem_euclid(1.0),
        Wrap::MirroredRepeat => 1.0 - (at.rem_euclid(2.0) - 1.0).abs(),
        Wrap::ClampToEdge => at,
    };
    let most = f64::from(n.saturating_sub(1));
    #[allow(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a place in a texture"
    )]
    let texel = (at * f64::from(n)).floor().clamp(0.0, most) as u32;
    texel
}
