//! Smaller pictures, in codes.

use std::sync::Arc;

use app_scene::geometry::color::{CodesOfLinear, linear_of_codes};
use app_scene::scene::Image;

/// Side of a block in pixels.
const BLOCK_PX: usize = 16;

/// A picture that is halved some times; an odd last row and column are left out. The means are of
/// linear light.
pub(super) fn smaller(image: &Arc<Image>, n_halvings: u32) -> Arc<Image> {
    if n_halvings == 0 {
        return Arc::clone(image);
    }
    let (light_of, codes) = (linear_of_codes(), CodesOfLinear::new());
    let side = 1_usize << n_halvings;
    let part = 1.0 / (side * side) as f32;
    let [width_px, height_px] = [image.width_px, image.height_px].map(|px| px >> n_halvings);
    let mut rgba8 = Vec::with_capacity(4 * width_px as usize * height_px as usize);
    let row_bytes = 4 * image.width_px as usize;
    for y in 0..height_px as usize {
        for x in 0..width_px as usize {
            let mut sums = [0.0; 3];
            for row in 0..side {
                let first = (y * side + row) * row_bytes + 4 * x * side;
                for pixel in image.rgba8[first..first + 4 * side].chunks_exact(4) {
                    sums = [0, 1, 2].map(|channel| sums[channel] + light_of[usize::from(pixel[channel])]);
                }
            }
            rgba8.extend(sums.map(|sum| codes.code(part * sum)));
            rgba8.push(u8::MAX);
        }
    }
    Arc::new(Image {
        width_px,
        height_px,
        rgba8,
    })
}

/// Mean codes of the blocks of a picture.
#[derive(Debug)]
pub(super) struct Blocks {
    columns: usize,
    means: Vec<[f32; 3]>,
}

impl Blocks {
    pub(super) fn of(image: &Image) -> Self {
        let [width, height] = [image.width_px, image.height_px].map(|px| px as usize);
        let [columns, rows] = [width, height].map(|side| side / BLOCK_PX);
        let part = 1.0 / (BLOCK_PX * BLOCK_PX) as f32;
        let mean = |block: usize| {
            let [left, top] = [block % columns, block / columns].map(|at| at * BLOCK_PX);
            let mut sums = [0_u32; 3];
            for y in top..top + BLOCK_PX {
                let first = 4 * (y * width + left);
                for pixel in image.rgba8[first..first + 4 * BLOCK_PX].chunks_exact(4) {
                    sums = [0, 1, 2].map(|channel| sums[channel] + u32::from(pixel[channel]));
                }
            }
            sums.map(|sum| part * sum as f32)
        };
        Self {
            columns,
            means: (0..columns * rows).map(mean).collect(),
        }
    }

    /// The largest difference of a channel, in codes, for each block; `None` for pictures of
    /// different sizes.
    pub(super) fn apart(&self, other: &Self) -> Option<Vec<f32>> {
        let is_same_size = self.columns == other.columns && self.means.len() == other.means.len();
        let apart = |(a, b): (&[f32; 3], &[f32; 3])| {
            let differences = a.iter().zip(b).map(|(a, b)| (a - b).abs());
            differences.fold(0.0, f32::max)
        };
        is_same_size.then(|| self.means.iter().zip(&other.means).map(apart).collect())
    }
}
