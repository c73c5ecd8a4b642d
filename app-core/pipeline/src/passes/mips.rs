//! Mip levels of a picture, so that a distant texture does not alias.

use glam::UVec2;

use app_scene::geometry::color::{linear_of_codes, srgb_from_linear};

/// The levels below a picture of sRGB-encoded RGBA, each half the size of the previous one, down to
/// one texel.
///
/// Texels are averages over the area that they cover in the previous level, in linear light; a size
/// that cannot be halved is rounded down. Source: Guthe and Heckbert 2005 (non-power-of-two mipmap
/// creation).
pub(crate) fn mips(size_px: UVec2, rgba8_srgb: &[u8]) -> Vec<Vec<u8>> {
    let of_code = linear_of_codes();
    let (texels, _) = rgba8_srgb.as_chunks::<4>();
    // The picture itself is decoded texel by texel: as floats it would need four times the memory.
    let mut half_px = half(size_px);
    let mut level = shrunk(|index| decoded(texels[index], &of_code), size_px, half_px);
    let mut levels = Vec::new();
    for _ in 0..size_px.max_element().ilog2() {
        levels.push(encoded(&level));
        let next_px = half(half_px);
        level = shrunk(|index| level[index], half_px, next_px);
        half_px = next_px;
    }
    levels
}

fn half(size_px: UVec2) -> UVec2 {
    (size_px / 2).max(UVec2::ONE)
}

/// One texel of linear RGBA.
type Texel = [f32; 4];

fn decoded([r, g, b, a]: [u8; 4], linear_of_code: &[f32; 256]) -> Texel {
    let [r, g, b] = [r, g, b].map(|code| linear_of_code[usize::from(code)]);
    [r, g, b, f32::from(a) / 255.0]
}

fn encoded(level: &[Texel]) -> Vec<u8> {
    #[allow(clippy::cast_possible_truncation, reason = "from 0 to 255")]
    let code = |value: f32| (255.0 * value).round() as u8;
    let codes = level.iter().flat_map(|[r, g, b, a]| {
        let [r, g, b] = [r, g, b].map(|value| code(srgb_from_linear(*value)));
        [r, g, b, code(*a)]
    });
    codes.collect()
}

fn shrunk(texel_at: impl Fn(usize) -> Texel, from_px: UVec2, to_px: UVec2) -> Vec<Texel> {
    let [columns, rows] = [0, 1].map(|axis| footprints(from_px[axis], to_px[axis]));
    let mut texels = Vec::with_capacity(to_px.element_product() as usize);
    for row in &rows {
        for column in &columns {
            let mut sum = [0.0; 4];
            for (y, weight_y) in row {
                for (x, weight_x) in column {
                    let texel = texel_at(y * from_px.x as usize + x);
                    for (sum, value) in sum.iter_mut().zip(texel) {
                        *sum += weight_x * weight_y * value;
                    }
                }
            }
            texels.push(sum);
        }
    }
    texels
}

/// For each texel along one side of a level, the texels of the previous level that it covers: index
/// and weight; the weights sum to 1.
fn footprints(n_from: u32, n_to: u32) -> Vec<Vec<(usize, f32)>> {
    // Positions in units of 1 / n_to of a texel of the previous level, all integers.
    let footprint = |index: u32| {
        let (start, end) = (index * n_from, (index + 1) * n_from);
        let covered = (start / n_to..end.div_ceil(n_to)).map(|at| {
            let overlap = end.min((at + 1) * n_to) - start.max(at * n_to);
            (at as usize, overlap as f32 / n_from as f32)
        });
        covered.collect()
    };
    (0..n_to).map(footprint).collect()
}
