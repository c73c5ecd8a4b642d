//! A reduced camera picture, to judge movement, focus and things in the way.

use app_scene::camera_frame::CameraImage;

/// Largest number of columns and rows of a reduced picture.
const MAX_SIDE: usize = 160;
/// Squares along a side of the tiles that detail is summed over.
const DETAIL_TILE: usize = 6;
/// Rows of the picture between those whose detail is measured.
const DETAIL_STEP: usize = 4;

/// Luma in codes, each number the mean of a square of pixels; and the picture's detail.
#[derive(Clone, Debug)]
pub(super) struct Reduced {
    /// Size of the picture.
    pub(super) size_px: [u32; 2],
    /// Columns and rows.
    pub(super) size: [usize; 2],
    /// Pixels of the picture along a side of the square.
    pub(super) factor: usize,
    pub(super) luma: Vec<f32>,
    /// Energy of the finest detail at its maximum, in squared codes, minus that of noise.
    pub(super) detail: f32,
    /// Energy of noise, measured in the flattest parts.
    pub(super) noise: f32,
}

impl Reduced {
    /// Reduces a complete picture; `None` if it is too small to be judged.
    pub(super) fn new(image: &CameraImage) -> Option<Self> {
        let [width, height] = image.size_px().map(|side| side as usize);
        let factor = width.max(height).div_ceil(MAX_SIDE).max(1);
        let size = [width / factor, height / factor];
        // Room for a gradient.
        if size.iter().any(|side| *side < 8) {
            return None;
        }
        let mut sums = vec![0_u32; size[0] * size[1]];
        let tiles = size.map(|side| side.div_ceil(DETAIL_TILE));
        let tile_px = factor * DETAIL_TILE;
        let mut details = vec![Energy::default(); tiles[0] * tiles[1]];
        let mut rows = [const { Vec::new() }; 3];
        for y in 0..size[1] * factor {
            rows.rotate_left(1);
            luma_row(image, y, &mut rows[2]);
            let first = y / factor * size[0];
            for (sum, square) in sums[first..]
                .iter_mut()
                .zip(rows[2].chunks_exact(factor))
                .take(size[0])
            {
                *sum += square.iter().map(|code| u32::from(*code)).sum::<u32>();
            }
            if y >= 2 && y % DETAIL_STEP == 0 {
                let tiles = &mut details[(y - 1) / tile_px * tiles[0]..][..tiles[0]];
                add_detail(&rows, tile_px, tiles);
            }
        }
        let n = (factor * factor) as f32;
        let luma = sums.iter().map(|sum| *sum as f32 / n).collect();
        let (detail, noise) = detail_and_noise(&details);
        Some(Self {
            size_px: image.size_px(),
            size,
            factor,
            luma,
            detail,
            noise,
        })
    }
}

/// A row of luma codes.
fn luma_row(image: &CameraImage, y: usize, row: &mut Vec<u8>) {
    let width = image.size_px()[0] as usize;
    row.clear();
    match image {
        CameraImage::Planes(planes) => row.extend_from_slice(&planes.luma()[y * width..][..width]),
        CameraImage::Rgba(image) => {
            let pixels = image.rgba8[4 * y * width..].chunks_exact(4).take(width);
            // BT.601 in 256ths, whatever the picture's own: only changes matter.
            row.extend(pixels.map(|pixel| {
                let [red, green, blue] = [pixel[0], pixel[1], pixel[2]].map(u32::from);
                u8::try_from((77 * red + 150 * green + 29 * blue) >> 8).unwrap_or(u8::MAX)
            }));
        }
    }
}

/// Sums of squares, and their number.
#[derive(Clone, Copy, Debug, Default)]
struct Energy {
    /// Second differences along rows and columns.
    fine: f32,
    /// The second difference along columns of that along rows, which noise has and edges hardly
    /// have.
    noise: f32,
    n: f32,
}

/// Squares of second differences along the middle row and across it.
fn add_detail(rows: &[Vec<u8>; 3], tile_px: usize, tiles: &mut [Energy]) {
    for (column, tile) in tiles.iter_mut().enumerate() {
        let columns = (column * tile_px).max(1)..((column + 1) * tile_px).min(rows[1].len() - 1);
        let n = columns.len();
        let (mut fine, mut noise) = (0_i64, 0_i64);
        for x in columns {
            let [above, middle, below] = [0, 1, 2].map(|k| {
                let [before, at, after] = [x - 1, x, x + 1].map(|x| i64::from(rows[k][x]));
                (at, before + after - 2 * at)
            });
            let across = above.0 + below.0 - 2 * middle.0;
            let both = above.1 + below.1 - 2 * middle.1;
            fine += middle.1 * middle.1 + across * across;
            noise += both * both;
        }
        let (fine, noise, n) = (fine as f32, noise as f32, n as f32);
        tile.fine += fine;
        tile.noise += noise;
        tile.n += n;
    }
}

/// Energy of the tenth of all tiles with most detail, minus that of noise; and that of noise, by
/// the tenth with least.
///
/// White noise of variance 1 has 6 in a second difference, 12 in both, and 36 in that of both: a
/// third. Source: Immerkaer 1996.
fn detail_and_noise(tiles: &[Energy]) -> (f32, f32) {
    let sorted = |energy: fn(&Energy) -> f32| {
        let tiles = tiles.iter().filter(|tile| tile.n > 0.0);
        let mut energies: Vec<f32> = tiles.map(|tile| energy(tile) / tile.n).collect();
        energies.sort_unstable_by(f32::total_cmp);
        energies
    };
    let (fine, noise) = (sorted(|tile| tile.fine), sorted(|tile| tile.noise / 3.0));
    let Some(noise) = noise.get(noise.len() / 10) else {
        return (0.0, 0.0);
    };
    let most = &fine[fine.len() - fine.len().div_ceil(10)..];
    let most = most.iter().sum::<f32>() / most.len() as f32;
    (most - noise, *noise)
}
