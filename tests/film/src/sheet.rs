//! A contact sheet: many small pictures in one.

use app_core::scene::Image;
use app_scene::geometry::color::{code_of_linear, linear_of_codes};

/// Width of a picture on a sheet.
const CELL_PX: u32 = 320;
/// Gap between pictures, and around them.
const MARGIN_PX: u32 = 6;
/// Colour behind the pictures, and of the frame of marked ones.
const BACKGROUND: [u8; 4] = [32, 32, 32, 255];
const MARKED: [u8; 4] = [240, 180, 40, 255];

/// A small picture of a sheet.
#[derive(Clone, Debug)]
pub struct Cell {
    image: Image,
    is_marked: bool,
}

impl Cell {
    /// Makes a picture smaller, by averages in linear light. A marked one has a bright frame.
    #[must_use]
    pub fn new(picture: &Image, is_marked: bool) -> Self {
        Self {
            image: shrunk(picture, picture.width_px.div_ceil(CELL_PX).max(1)),
            is_marked,
        }
    }
}

/// Arranges cells in rows; all should have the first one's size. `None` without cells.
#[must_use]
pub fn contact_sheet(cells: &[Cell], columns: u32) -> Option<Image> {
    let first = &cells.first()?.image;
    let n_cells = u32::try_from(cells.len()).ok()?;
    let columns = columns.clamp(1, n_cells);
    let step = [first.width_px, first.height_px].map(|side| side + MARGIN_PX);
    let size_px = [
        columns.checked_mul(step[0])? + MARGIN_PX,
        n_cells.div_ceil(columns).checked_mul(step[1])? + MARGIN_PX,
    ];
    let n_pixels = size_px[0] as usize * size_px[1] as usize;
    let mut sheet = Image {
        width_px: size_px[0],
        height_px: size_px[1],
        rgba8: BACKGROUND.repeat(n_pixels),
    };
    for (index, cell) in (0..).zip(cells) {
        let corner = [
            index % columns * step[0] + MARGIN_PX,
            index / columns * step[1] + MARGIN_PX,
        ];
        if cell.is_marked {
            let half = MARGIN_PX / 2;
            let framed_px = [first.width_px, first.height_px].map(|side| side + MARGIN_PX);
            fill(&mut sheet, corner.map(|at| at - half), framed_px, MARKED);
        }
        paste(&mut sheet, corner, &cell.image, [first.width_px, first.height_px]);
    }
    Some(sheet)
}

fn fill(sheet: &mut Image, corner: [u32; 2], size_px: [u32; 2], color: [u8; 4]) {
    for y in corner[1]..corner[1] + size_px[1] {
        let start = 4 * (y as usize * sheet.width_px as usize + corner[0] as usize);
        if let Some(row) = sheet.rgba8.get_mut(start..start + 4 * size_px[0] as usize) {
            row.as_chunks_mut::<4>().0.fill(color);
        }
    }
}

fn paste(sheet: &mut Image, corner: [u32; 2], image: &Image, most_px: [u32; 2]) {
    let n_bytes = 4 * image.width_px.min(most_px[0]) as usize;
    let rows = image.rgba8.chunks_exact(4 * image.width_px.max(1) as usize);
    for (y, row) in (corner[1]..).zip(rows.take(most_px[1] as usize)) {
        let start = 4 * (y as usize * sheet.width_px as usize + corner[0] as usize);
        if let Some(place) = sheet.rgba8.get_mut(start..start + n_bytes) {
            place.copy_from_slice(&row[..n_bytes]);
        }
    }
}

/// The picture with squares of `factor` pixels averaged; the rest at the right and at the bottom is
/// dropped.
fn shrunk(picture: &Image, factor: u32) -> Image {
    let linear = linear_of_codes();
    let size_px = [picture.width_px, picture.height_px].map(|side| (side / factor).max(1));
    let mut rgba8 = Vec::new();
    for row in 0..size_px[1] {
        for column in 0..size_px[0] {
            let mut sum = [0.0_f32; 3];
            let mut n_pixels = 0.0_f32;
            for y in row * factor..(row + 1) * factor {
                let start = 4 * (y as usize * picture.width_px as usize + (column * factor) as usize);
                let texels = picture.rgba8.get(start..start + 4 * factor as usize);
                for texel in texels.unwrap_or_default().chunks_exact(4) {
                    (0..3).for_each(|channel| sum[channel] += linear[usize::from(texel[channel])]);
                    n_pixels += 1.0;
                }
            }
            rgba8.extend(sum.map(|sum| code_of_linear(sum / n_pixels.max(1.0))));
            rgba8.push(u8::MAX);
        }
    }
    Image {
        width_px: size_px[0],
        height_px: size_px[1],
        rgba8,
    }
}
