//! Where the depth maps of the toy lie: one tile of an atlas for each of a light's points, made to hold all of the toy.

use glam::{DMat4, DVec3, DVec4, Vec3, Vec4, Vec4Swizzles};

use crate::gpu::layout::{MAX_LIGHTS, MAX_TILES, SelfShadow};
use crate::plan::SelfShadowPlan;

/// Texels at a tile's rim that hold nothing, so that a filtered fetch never reaches the next tile.
const RIM_TEXELS: f64 = 2.0;

/// A ball around all of a posed toy, in stage space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sphere {
    /// Its middle.
    pub centre: DVec3,
    /// In metres.
    pub radius_m: f64,
}

impl Sphere {
    /// The ball around the middle of the points' bounding box; of no size without any point.
    #[must_use]
    pub fn around(points: &[Vec3]) -> Self {
        let low = points.iter().copied().reduce(Vec3::min).unwrap_or_default();
        let high = points.iter().copied().reduce(Vec3::max).unwrap_or_default();
        let centre = 0.5 * (low.as_dvec3() + high.as_dvec3());
        let distances = points.iter().map(|point| point.as_dvec3().distance(centre));
        Self {
            centre,
            radius_m: distances.fold(0.0, f64::max),
        }
    }

    /// Whether a homogeneous light point is within; a direction never is.
    #[must_use]
    pub fn holds(&self, light_point: DVec4) -> bool {
        light_point.w != 0.0 && light_point.xyz().distance(self.centre) <= self.radius_m
    }
}

/// The tiles of each light's points over a toy within `toy`. A light inside that ball, from where no frustum holds all of
/// the toy, gets none.
#[must_use]
pub fn light_tiles(light_points: &[&[Vec4]], toy: &Sphere, plan: &SelfShadowPlan) -> SelfShadow {
    let mut tiles = SelfShadow {
        atlas_from_stage: [[[0.0; 4]; 4]; MAX_TILES],
        first_tile: [0; MAX_LIGHTS],
        n_tiles: [0; MAX_LIGHTS],
        texel_m: [0.0; MAX_LIGHTS],
    };
    let used = 1.0 - 2.0 * RIM_TEXELS / f64::from(plan.tile_px);
    let mut taken = 0;
    for (light, (points, n_points)) in light_points.iter().zip(&plan.n_points).enumerate() {
        let frusta = frusta(points, *n_points, toy);
        tiles.first_tile[light] = taken;
        for frustum in &frusta {
            let atlas_from_stage = plan.atlas_from_tile(taken, used) * frustum.clip_from_stage;
            tiles.atlas_from_stage[taken as usize] = atlas_from_stage.as_mat4().to_cols_array_2d();
            tiles.n_tiles[light] += 1;
            taken += 1;
        }
        #[allow(clippy::cast_possible_truncation, reason = "a width in metres")]
        let texel_m = |frustum: &Frustum| (frustum.width_m / (used * f64::from(plan.tile_px))) as f32;
        tiles.texel_m[light] = frusta.iter().map(texel_m).fold(0.0, f32::max);
    }
    tiles
}

/// `n_points` of a light's points, evenly taken, as seen from them; none when one of them is inside the toy's ball.
fn frusta(points: &[Vec4], n_points: usize, toy: &Sphere) -> Vec<Frustum> {
    let stride = points.len() / n_points.max(1);
    let taken = points.iter().step_by(stride.max(1)).take(n_points);
    let frusta: Option<Vec<_>> = taken.map(|point| Frustum::new(point.as_dvec4(), toy)).collect();
    frusta.unwrap_or_default()
}

/// What a light point sees of the toy.
struct Frustum {
    /// Depth is reversed, from 1 at the ball's near side; w is the distance along the axis, 1 for a directional light.
    clip_from_stage: DMat4,
    /// Width of what is seen, at w = 1.
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
        let axes_from_stage = DMat4::from_mat3(glam::DMat3::from_cols(right, up, back).transpose());
        let centre_at_origin = axes_from_stage * DMat4::from_translation(-toy.centre);
        let r = toy.radius_m;
        // Rows of clip x, y, z, w over the point along (right, up, back), from the ball's middle.
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
                DVec4::W * (distance_m - r),
                DVec4::new(0.0, 0.0, -1.0, distance_m),
            ];
            (rows, 2.0 * slope)
        };
        let [x, y, z, w] = rows;
        Some(Self {
            clip_from_stage: DMat4::from_cols(x, y, z, w).transpose() * centre_at_origin,
            width_m,
        })
    }
}
