//! Layout of the toy's depth maps: one tile of an atlas for each light point, sized to contain the
//! whole toy.

use glam::{DMat4, DVec3, DVec4, Vec4, Vec4Swizzles};

use app_scene::geometry::bounds::Sphere;

/// Empty texels at a tile's rim, so that a filtered fetch never reaches the next tile.
const RIM_TEXELS: f64 = 2.0;

/// An atlas of square depth maps, one for each point of each light.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ShadowAtlas {
    /// Number of maps of each light.
    pub n_points: Vec<usize>,
    /// Tiles along each side of the atlas.
    pub n_columns: u32,
    /// Texels along each side of a tile.
    pub tile_px: u32,
}

/// The depth map of one light point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tile {
    /// Index of the light.
    pub light: usize,
    /// Transform to clip space of the atlas; depth is reversed, 0 in empty texels.
    pub atlas_from_anchor: DMat4,
    /// Width of a texel at w = 1.
    pub texel_m: f64,
}

impl ShadowAtlas {
    /// An atlas for `n_points` maps of each light, of `tile_px` texels along each side.
    #[must_use]
    pub fn new(n_points: Vec<usize>, tile_px: u32) -> Self {
        let n_tiles: usize = n_points.iter().sum();
        Self {
            n_columns: (1..).find(|n| (n * n) as usize >= n_tiles).unwrap_or(1),
            n_points,
            tile_px,
        }
    }

    /// The tiles of each light's points over a toy within `toy`, light by light. A light inside
    /// that ball gets none, since no frustum from there contains the whole toy.
    #[must_use]
    pub fn tiles(&self, light_points: &[&[Vec4]], toy: &Sphere) -> Vec<Tile> {
        let used = 1.0 - 2.0 * RIM_TEXELS / f64::from(self.tile_px);
        let lights = light_points.iter().zip(&self.n_points).enumerate();
        let frusta = lights.flat_map(|(light, (points, n_points))| {
            frusta(points, *n_points, toy)
                .into_iter()
                .map(move |frustum| (light, frustum))
        });
        (0..)
            .zip(frusta)
            .map(|(index, (light, frustum))| Tile {
                light,
                atlas_from_anchor: self.atlas_from_tile(index, used) * frustum.clip_from_anchor,
                texel_m: frustum.width_m / (used * f64::from(self.tile_px)),
            })
            .collect()
    }

    /// Transform from the clip space of tile `index`, of which the part `used` along each side is
    /// drawn, to that of the atlas.
    #[must_use]
    pub fn atlas_from_tile(&self, index: u32, used: f64) -> DMat4 {
        let side = 1.0 / f64::from(self.n_columns);
        let middle = |place: u32| side * f64::from(2 * place + 1) - 1.0;
        let at = DVec3::new(
            middle(index % self.n_columns),
            -middle(index / self.n_columns),
            0.0,
        );
        DMat4::from_translation(at) * DMat4::from_scale(DVec3::new(used * side, used * side, 1.0))
    }
}

/// Frusta from `n_points` of a light's points, evenly selected; none if one of them is inside the
/// toy's ball.
fn frusta(points: &[Vec4], n_points: usize, toy: &Sphere) -> Vec<Frustum> {
    let stride = points.len() / n_points.max(1);
    let taken = points.iter().step_by(stride.max(1)).take(n_points);
    let frusta: Option<Vec<_>> = taken.map(|point| Frustum::new(point.as_dvec4(), toy)).collect();
    frusta.unwrap_or_default()
}

/// Frustum of a light point around the toy.
struct Frustum {
    /// Transform to clip space: depth is reversed, from 1 at the ball's near side; w is the
    /// distance along the axis, 1 for a directional light.
    clip_from_anchor: DMat4,
    /// Width of the frustum, at w = 1.
    width_m: f64,
}

impl Frustum {
    fn new(light_point: DVec4, toy: &Sphere) -> Option<Self> {
        let light = light_point.xyz();
        let to_light = light - toy.centre * light_point.w;
        let distance_m = to_light.length();
        if !(toy.radius_m > 0.0 && distance_m > 0.0) || toy.holds(light_point) {
            return None;
        }
        let back = to_light / distance_m;
        let (right, up) = back.any_orthonormal_pair();
        let axes_from_anchor = DMat4::from_mat3(glam::DMat3::from_cols(right, up, back).transpose());
        let centre_at_origin = axes_from_anchor * DMat4::from_translation(-toy.centre);
        let r = toy.radius_m;
        // Rows of clip x, y, z, w over the point along (right, up, back), from the ball's centre.
        let (rows, width_m) = if light_point.w == 0.0 {
            let rows = [
                DVec4::X / r,
                DVec4::Y / r,
                DVec4::new(0.0, 0.0, 0.5 / r, 0.5),
                DVec4::W,
            ];
            (rows, 2.0 * r)
        } else {
            let slope = r / (distance_m * distance_m - r * r).sqrt();
            let rows = [
                DVec4::X / slope,
                DVec4::Y / slope,
                DVec4::new(0.0, 0.0, 1.0, r) * (distance_m - r) / (2.0 * r),
                DVec4::new(0.0, 0.0, -1.0, distance_m),
            ];
            (rows, 2.0 * slope)
        };
        let [x, y, z, w] = rows;
        Some(Self {
            clip_from_anchor: DMat4::from_cols(x, y, z, w).transpose() * centre_at_origin,
            width_m,
        })
    }
}
