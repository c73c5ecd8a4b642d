//! Rasterises meshes on the processor: the triangle of each pixel, and the pixels of a flat shape.

use glam::{DVec2, DVec3};

/// The surface point of a pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sight {
    /// Index of the triangle.
    pub triangle: u32,
    /// Weights of its corners at the pixel's centre; they sum to 1.
    pub corners: [f32; 3],
    /// In metres along the camera's axis.
    pub depth_m: f32,
}

/// The nearest triangle of each pixel, rows from the top.
#[derive(Clone, Debug, Default)]
pub struct Sights {
    width_px: usize,
    sights: Vec<Option<Sight>>,
}

impl Sights {
    /// Draws triangles of `corners`: u, v in pixels and the depth in metres, which is not above 0
    /// behind the camera. Triangles with such a corner are skipped.
    #[must_use]
    pub fn draw(corners: &[DVec3], triangles: &[[u32; 3]], [width_px, height_px]: [usize; 2]) -> Self {
        let mut sights = vec![None; width_px * height_px];
        for (index, triangle) in (0..).zip(triangles) {
            let Some(projected) = in_front(corners, *triangle) else {
                continue;
            };
            cover(
                projected.map(DVec3::truncate),
                [width_px, height_px],
                |pixel, weights| {
                    let place: &mut Option<Sight> = &mut sights[pixel];
                    // One over the depth is linear in the picture.
                    let shares = [0, 1, 2].map(|k| weights[k] / projected[k].z);
                    let nearness = shares.iter().sum::<f64>();
                    #[allow(
                        clippy::cast_possible_truncation,
                        reason = "depths and weights of one picture"
                    )]
                    let sight = Sight {
                        triangle: index,
                        corners: shares.map(|share| (share / nearness) as f32),
                        depth_m: (1.0 / nearness) as f32,
                    };
                    if place.is_none_or(|known| sight.depth_m < known.depth_m) {
                        *place = Some(sight);
                    }
                },
            );
        }
        Self { width_px, sights }
    }

    /// The surface point of a pixel by its index, rows from the top.
    #[must_use]
    pub fn at(&self, pixel: usize) -> Option<Sight> {
        self.sights.get(pixel).copied().flatten()
    }

    /// The largest depth in a square of three pixels around a place; `None` outside the picture or
    /// if one of them shows no mesh.
    #[must_use]
    pub fn farthest_m(&self, at_px: DVec2) -> Option<f32> {
        let n_rows = self.sights.len().checked_div(self.width_px)?;
        let (column, row) = (index(at_px.x, self.width_px)?, index(at_px.y, n_rows)?);
        let mut farthest: Option<f32> = None;
        for y in row.saturating_sub(1)..(row + 2).min(n_rows) {
            for x in column.saturating_sub(1)..(column + 2).min(self.width_px) {
                if let Some(Sight { depth_m, .. }) = self.at(y * self.width_px + x) {
                    farthest = Some(farthest.map_or(depth_m, |farthest| farthest.max(depth_m)));
                }
            }
        }
        farthest
    }
}

/// Marks the pixels whose centre a triangle covers, and those on its outline, so that thin
/// triangles are not lost.
pub fn mark(mask: &mut [bool], size_px: [usize; 2], corners: [DVec2; 3]) {
    cover(corners, size_px, |pixel, _| mask[pixel] = true);
    for corner in corners {
        if let (Some(x), Some(y)) = (index(corner.x, size_px[0]), index(corner.y, size_px[1])) {
            mask[y * size_px[0] + x] = true;
        }
    }
}

/// Corners of a triangle, if all are in front of the camera.
#[must_use]
pub fn in_front(corners: &[DVec3], triangle: [u32; 3]) -> Option<[DVec3; 3]> {
    let [a, b, c] = triangle.map(|corner| corners.get(corner as usize).copied().filter(|at| at.z > 0.0));
    Some([a?, b?, c?])
}

/// The pixel of a coordinate.
fn index(at: f64, n: usize) -> Option<usize> {
    #[allow(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "checked against the picture's size"
    )]
    let index = (0.0..n as f64).contains(&at).then_some(at as usize);
    index
}

/// Calls with the index of each pixel whose centre a triangle covers, and the weights of its
/// corners there.
fn cover(corners: [DVec2; 3], [width_px, height_px]: [usize; 2], mut each: impl FnMut(usize, [f64; 3])) {
    let [a, b, c] = corners;
    let area = (b - a).perp_dot(c - a);
    if !area.is_normal() {
        return;
    }
    let range = |least: f64, most: f64, n: usize| {
        let clamp = |at: f64| at.clamp(0.0, n as f64);
        #[allow(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "clamped to the picture's size"
        )]
        let range = clamp((least - 0.5).ceil()) as usize..clamp((most - 0.5).floor() + 1.0) as usize;
        range
    };
    let (least, most) = (a.min(b).min(c), a.max(b).max(c));
    for y in range(least.y, most.y, height_px) {
        for x in range(least.x, most.x, width_px) {
            let at = DVec2::new(x as f64, y as f64) + 0.5;
            let weights = [
                (b - at).perp_dot(c - at) / area,
                (c - at).perp_dot(a - at) / area,
                (a - at).perp_dot(b - at) / area,
            ];
            if weights.iter().all(|weight| *weight >= 0.0) {
                each(y * width_px + x, weights);
            }
        }
    }
}
