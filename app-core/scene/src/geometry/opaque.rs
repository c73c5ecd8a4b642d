//! What the top of a thing hides, such as that of a book: parts of a light, and of the sky.

use std::f64::consts::{PI, TAU};

use glam::{DMat4, DVec2, DVec3, DVec4, Vec3Swizzles};

/// Least radius of a light's disc, projected onto a rectangle, in metres: a pixel shows no sharper
/// edge.
pub const SHARPEST_M: f32 = 5e-4;
/// Least cosine between a receiver and the top of what stands on it: a ramp of up to 60 degrees has
/// a top, and what is steeper is taken for a wall.
pub const STANDS: f32 = 0.5;
/// Least part of the sky that a point sees: in the narrowest gap some of its light arrives by
/// reflection, and a plate without any light has no shares of it.
pub const LEAST_SKY: f32 = 0.02;
/// How dark a face is that no light meets, beside the sky that it hides: it reflects sky and table.
pub const UNLIT_FACE: f32 = 0.75;

/// Whether a rectangle may be the top of what stands on a plane y = 0; the matrix leads from its
/// space to the plane's. An upright one is a wall, which may have a window, or a side.
#[must_use]
pub fn is_top(plane_from_rect: &DMat4) -> bool {
    plane_from_rect.y_axis.y >= f64::from(STANDS)
}

/// The part of a light that a rectangle on the plane y = 0, and what is below it, hide from a point,
/// 0 to 1: the larger part of the two. From a point above the plane, as before the low edge of a
/// ramp, the rectangle alone hides a light below it.
///
/// `light` is its centre, homogeneous, and `radius` that of its disc over its distance, which is 1
/// for a direction: metres, or a slope. The rectangle has a smallest and a largest (x, z); `up` is
/// the direction upwards, and faces run down from the rectangle's edges against it. Each line cuts
/// the light's disc by itself.
#[must_use]
pub fn hidden_light(from: DVec3, up: DVec3, light: DVec4, radius: f64, [min, max]: [DVec2; 2]) -> f64 {
    if from.y * light.y >= 0.0 {
        return 0.0;
    }
    let to_light = light.truncate() - light.w * from;
    let part = -from.y / to_light.y;
    let disc = Disc {
        at: from.xz() + part * to_light.xz(),
        slope: to_light.xz() / to_light.y,
        across: part * radius,
    };
    let above = from.xz() - up.xz() * (from.y / up.y);
    let below = if from.y < 0.0 {
        disc.entered([min, max], above)
    } else {
        0.0
    };
    disc.on([min, max]).max(below)
}

/// A light's disc, projected onto the plane of a rectangle from a point.
struct Disc {
    at: DVec2,
    /// The light's (x, z) over its height.
    slope: DVec2,
    /// Its radius across the way to the light.
    across: f64,
}

impl Disc {
    /// Half its axes.
    fn radius(&self) -> DVec2 {
        let radius = self.across * (DVec2::ONE + self.slope * self.slope).map(f64::sqrt);
        radius.max(DVec2::splat(f64::from(SHARPEST_M)))
    }

    /// The part of it on a rectangle.
    fn on(&self, [min, max]: [DVec2; 2]) -> f64 {
        let parts = |t: DVec2| (t / self.radius()).map(disc_part);
        let within = (parts(self.at - min) + parts(max - self.at) - 1.0).max(DVec2::ZERO);
        within.element_product()
    }

    /// The part of it for which the way from `above`, seen from above, meets a rectangle: it enters by
    /// the edges that are turned to `above`, between the outermost corners; 0 from within it, since a
    /// pixel with such a point shows a side.
    fn entered(&self, [min, max]: [DVec2; 2], above: DVec2) -> f64 {
        let (is_before, is_behind) = (above.cmplt(min), above.cmpgt(max));
        if !is_before.any() && !is_behind.any() {
            return 0.0;
        }
        let parts = |t: DVec2| (t / self.radius()).map(disc_part);
        let beyond_high = DVec2::select(is_behind, parts(max - self.at), DVec2::ONE);
        let near = DVec2::select(is_before, parts(self.at - min), beyond_high);
        let corners = [min, max, DVec2::new(min.x, max.y), DVec2::new(max.x, min.y)];
        let sides = corners.map(|corner| {
            let to = corner - above;
            let width = self.across * to.length().hypot(to.perp().dot(self.slope));
            to.perp_dot(self.at - above) / width.max(f64::from(SHARPEST_M) * to.length())
        });
        let most = sides.into_iter().fold(f64::NEG_INFINITY, f64::max);
        let least = sides.into_iter().fold(f64::INFINITY, f64::min);
        let within = (disc_part(most) + disc_part(-least) - 1.0).max(0.0);
        near.element_product() * within
    }
}

/// Part of the area of a disc on one side of a line at a distance from its centre, in radii.
fn disc_part(t: f64) -> f64 {
    let c = t.clamp(-1.0, 1.0);
    0.5 + (c.asin() + c * (1.0 - c * c).sqrt()) / PI
}

/// How dark the faces below the edges of a rectangle are, beside the sky that they hide: those with
/// the smallest z, the largest x, the largest z and the smallest x. One that a light meets counts as
/// dark, 1: the toy's shadow beside it is on the face, too. `lights` are in the rectangle's space,
/// homogeneous.
#[must_use]
pub fn darkness_of_faces([min, max]: [DVec2; 2], lights: &[DVec4]) -> [f64; 4] {
    let meets: [&dyn Fn(&DVec4) -> bool; 4] = [
        &|light| light.z < light.w * min.y,
        &|light| light.x > light.w * max.x,
        &|light| light.z > light.w * max.y,
        &|light| light.x < light.w * min.x,
    ];
    meets.map(|meets| match lights.iter().any(meets) {
        true => 1.0,
        false => f64::from(UNLIT_FACE),
    })
}

/// The part of the sky, cosine-weighted, that is hidden from a point of the plane y = 0 by the
/// upright faces below the edges of a rectangle, 0 to 1; 0 if that is no top.
///
/// The matrix leads from the rectangle's space, where it is on y = 0 with a smallest and a largest
/// (x, z), to the plane's; `darkness` is that of the faces, 1 for black ones. Source: Nishita and
/// Nakamae 1985 (Lambert's formula).
#[must_use]
pub fn hidden_sky(at: DVec2, plane_from_rect: &DMat4, [min, max]: [DVec2; 2], darkness: [f64; 4]) -> f64 {
    if !is_top(plane_from_rect) {
        return 0.0;
    }
    let seen = |corner: DVec2| {
        let corner = DVec3::new(corner.x, 0.0, corner.y);
        plane_from_rect.transform_point3(corner) - DVec3::new(at.x, 0.0, at.y)
    };
    let corners = [min, DVec2::new(max.x, min.y), max, DVec2::new(min.x, max.y)].map(seen);
    let middle = seen(0.5 * (min + max));
    let edges = (0..4).map(|index| (corners[index], corners[(index + 1) % 4]));
    let is_turned_here =
        |a: DVec3, b: DVec3| a.xz().perp_dot(b.xz()) * (a - middle).xz().perp_dot((b - middle).xz()) < 0.0;
    let above = |end: DVec3| DVec3::new(end.x, end.y.max(0.0), end.z);
    let turned_here = edges.zip(darkness).filter(|((a, b), _)| is_turned_here(*a, *b));
    turned_here
        .map(|((a, b), darkness)| darkness * hidden_below(above(a), above(b)))
        .sum()
}

/// The same by the upright face below one edge, from its ends relative to the point.
fn hidden_below(a: DVec3, b: DVec3) -> f64 {
    let across = a.cross(b);
    let area = across.length();
    if area == 0.0 {
        return 0.0;
    }
    let ground = a.xz().angle_to(b.xz()).abs();
    ((ground - a.angle_between(b) * across.y.abs() / area) / TAU).max(0.0)
}
