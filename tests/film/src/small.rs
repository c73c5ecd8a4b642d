//! Reduces pictures, and arranges them on sheets.

use app_scene::geometry::color::{code_of_linear, linear_of_codes};
use image::{Rgb, RgbImage};

/// A picture of at most `side_px` along its longer side: each pixel is the mean light of a square of the larger one's.
#[must_use]
pub fn shrunk(picture: &RgbImage, side_px: u32) -> RgbImage {
    let factor = picture.width().max(picture.height()).div_ceil(side_px.max(1));
    if factor <= 1 {
        return picture.clone();
    }
    let linear = linear_of_codes();
    let (width_px, height_px) = (picture.width() / factor, picture.height() / factor);
    RgbImage::from_fn(width_px.max(1), height_px.max(1), |x, y| {
        let mut sums = [0.0_f32; 3];
        let mut n = 0.0_f32;
        for dy in 0..factor {
            for dx in 0..factor {
                if let Some(pixel) = picture.get_pixel_checked(x * factor + dx, y * factor + dy) {
                    sums.iter_mut()
                        .zip(pixel.0)
                        .for_each(|(sum, code)| *sum += linear[usize::from(code)]);
                    n += 1.0;
                }
            }
        }
        Rgb(sums.map(|sum| code_of_linear(sum / n.max(1.0))))
    })
}

/// Pictures of one size side by side, row by row.
#[must_use]
pub fn sheet(pictures: &[RgbImage], n_columns: u32, gap_px: u32) -> RgbImage {
    let (width_px, height_px) = pictures.first().map_or((1, 1), |first| first.dimensions());
    let n_pictures = u32::try_from(pictures.len()).unwrap_or(u32::MAX);
    let n_columns = n_columns.clamp(1, n_pictures.max(1));
    let n_rows = n_pictures.div_ceil(n_columns).max(1);
    let side = |n: u32, px: u32| n * (px + gap_px) + gap_px;
    let mut sheet = RgbImage::from_pixel(side(n_columns, width_px), side(n_rows, height_px), Rgb([32; 3]));
    for (place, picture) in (0..n_pictures).zip(pictures) {
        let x = side(place % n_columns, width_px);
        let y = side(place / n_columns, height_px);
        image::imageops::replace(&mut sheet, picture, i64::from(x), i64::from(y));
    }
    sheet
}
