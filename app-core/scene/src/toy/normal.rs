//! Transforms of normals: unit length, outward, never NaN.

use glam::{DMat3, DVec3, Vec3};

/// Transforms a normal by the inverse transpose of `linear`, computed from the cofactors, which
/// always exist.
///
/// Falls back to the plain transform, then to the normal itself, if `linear` flattens it to zero.
pub(super) fn carried_normal(linear: &DMat3, normal: DVec3) -> Vec3 {
    let [a, b, c] = [linear.x_axis, linear.y_axis, linear.z_axis];
    let cofactors = DMat3::from_cols(b.cross(c), c.cross(a), a.cross(b));
    let candidates = [cofactors * normal * handedness(linear), *linear * normal, normal];
    unit(candidates.into_iter().find_map(direction))
}

/// The normal of a triangle transformed by `linear`; untransformed, its corners are
/// counter-clockwise from outside.
pub(super) fn face_normal(linear: &DMat3, [a, b, c]: [DVec3; 3]) -> Vec3 {
    unit(direction(handedness(linear) * (b - a).cross(c - a)))
}

/// Minus one for a mirror, which reverses triangles while the outside stays outside.
fn handedness(linear: &DMat3) -> f64 {
    if linear.determinant() < 0.0 { -1.0 } else { 1.0 }
}

/// A vector's direction, however short it is: squares of lengths below 1e-154 lose precision.
fn direction(vector: DVec3) -> Option<DVec3> {
    let longest = vector.abs().max_element();
    (vector / longest).try_normalize()
}

/// Any unit vector will do if there is no direction.
fn unit(normal: Option<DVec3>) -> Vec3 {
    normal.map_or(Vec3::Y, |normal| normal.as_vec3())
}
