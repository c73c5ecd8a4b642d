//! The last hundredths of a pixel between two pictures of one table: a homography that is found by all of the table's texture at once.
//!
//! Source: Lucas and Kanade 1981, with robust weights (Geman and McClure 1987).

use glam::{DMat3, DVec2, DVec3};
use nalgebra::{SMatrix, SVector};

use super::exposure::Clear;
use super::keys::median;
use super::light::{LightPicture, smoothed};

/// Freedoms of a homography.
const N: usize = 8;
/// Both pictures are averaged over this reach first, so that slopes are those of more than noise.
const REACH_PX: usize = 1;
/// Fewer pixels tell nothing.
const MIN_PIXELS: usize = 2000;
/// A picture that would have to be moved farther, at its corners, was not near.
const MOST_PX: f64 = 1.5;
/// Differences of so many usual ones count a quarter.
const ROBUST: f64 = 3.0;

/// From pixels of a reference to those of a picture that lies nearly on it, by what both show where it is clear. The identity where that
/// tells nothing.
pub(super) fn registered(picture: &LightPicture, reference: &LightPicture, clear: &Clear) -> DMat3 {
    let size = DVec2::new(picture.width_px as f64, picture.height_px as f64);
    let half = 0.5 * size;
    let [ours, theirs] = [picture, reference].map(brightness);
    let pixels = places(picture).filter(|(pixel, _)| clear.holds(*pixel));
    let rows: Vec<Row> = pixels
        .filter_map(|(pixel, at)| {
            Row::new(
                [&ours, &theirs],
                (pixel, picture.width_px),
                (at - half) / half.x,
                half.x,
            )
        })
        .collect();
    if rows.len() < MIN_PIXELS {
        return DMat3::IDENTITY;
    }
    let usual = median(rows.iter().map(|row| row.residual.abs()).collect()).max(1e-6);
    let (mut information, mut pull) = (SMatrix::<f64, N, N>::zeros(), SVector::<f64, N>::zeros());
    for row in &rows {
        let weight = 1.0 / (1.0 + (row.residual / (ROBUST * usual)).powi(2)).powi(2);
        information += weight * row.slopes * row.slopes.transpose();
        pull += weight * row.residual * row.slopes;
    }
    let Some(step) = information.cholesky().map(|information| information.solve(&pull)) else {
        return DMat3::IDENTITY;
    };
    let from_middle = homography(&step);
    let to_middle = DMat3::from_scale(DVec2::splat(1.0 / half.x)) * DMat3::from_translation(-half);
    let from_px = to_middle.inverse() * from_middle * to_middle;
    let corners = [
        DVec2::ZERO,
        DVec2::new(size.x, 0.0),
        DVec2::new(0.0, size.y),
        size,
    ];
    let is_near = corners.into_iter().all(|corner| {
        let there = from_px * corner.extend(1.0);
        (there.truncate() / there.z - corner).length() < MOST_PX
    });
    if is_near { from_px } else { DMat3::IDENTITY }
}

fn homography(step: &SVector<f64, N>) -> DMat3 {
    DMat3::IDENTITY
        + DMat3::from_cols(
            DVec3::new(step[0], step[3], step[6]),
            DVec3::new(step[1], step[4], step[7]),
            DVec3::new(step[2], step[5], 0.0),
        )
}

/// What a pixel tells.
struct Row {
    /// Of the difference, for each freedom.
    slopes: SVector<f64, N>,
    /// The reference less the picture.
    residual: f64,
}

impl Row {
    /// At a place about the picture's middle, in units of `unit_px`. None at the border.
    fn new(
        [ours, theirs]: [&[f32]; 2],
        (pixel, width_px): (usize, usize),
        at: DVec2,
        unit_px: f64,
    ) -> Option<Self> {
        let column = pixel % width_px;
        if column == 0 || column + 1 == width_px {
            return None;
        }
        let near = |index: usize| ours.get(index).map(|value| f64::from(*value));
        let across = near(pixel + 1)? - near(pixel - 1)?;
        let along = near(pixel + width_px)? - near(pixel.checked_sub(width_px)?)?;
        let slope = 0.5 * unit_px * DVec2::new(across, along);
        let outward = slope.dot(at);
        Some(Self {
            slopes: SVector::from([
                slope.x * at.x,
                slope.x * at.y,
                slope.x,
                slope.y * at.x,
                slope.y * at.y,
                slope.y,
                -outward * at.x,
                -outward * at.y,
            ]),
            residual: f64::from(theirs[pixel] - ours[pixel]),
        })
    }
}

/// In the square root of light, in which noise is about as large everywhere.
fn brightness(picture: &LightPicture) -> Vec<f32> {
    let sums = picture
        .rgb
        .iter()
        .map(|[red, green, blue]| [(red + green + blue).max(0.0).sqrt()]);
    let values = smoothed(sums.collect(), picture.width_px, REACH_PX);
    values.into_iter().map(|[value]| value).collect()
}

/// Pixels by their index, with the place of their centre.
fn places(picture: &LightPicture) -> impl Iterator<Item = (usize, DVec2)> {
    let width_px = picture.width_px;
    (0..picture.rgb.len()).map(move |pixel| {
        let at = DVec2::new((pixel % width_px) as f64, (pixel / width_px) as f64);
        (pixel, at + 0.5)
    })
}
