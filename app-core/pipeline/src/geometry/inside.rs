//! Whether a point lies inside a mesh.

use glam::{DVec3, Vec3};

/// Whether the mesh is around a point, more than not: its winding number is above one half.
///
/// The winding number is the solid angle of all triangles as seen from there, with their sign, over that of a sphere. It is 1
/// within a closed piece and 0 outside, and between the two where a mesh has holes.
/// Source: Jacobson, Kavan and Sorkine-Hornung 2013; solid angle of a triangle: van Oosterom and Strackee 1983.
pub(crate) fn is_inside(positions: &[Vec3], indices: &[u32], at: DVec3) -> bool {
    let corner = |index: u32| positions.get(index as usize).map(|p| p.as_dvec3() - at);
    let half_angles_rad = indices.chunks_exact(3).filter_map(|triangle| {
        let [a, b, c] = [corner(triangle[0])?, corner(triangle[1])?, corner(triangle[2])?];
        let (a_m, b_m, c_m) = (a.length(), b.length(), c.length());
        let volume = a.dot(b.cross(c));
        let rest = a_m * b_m * c_m + a.dot(b) * c_m + b.dot(c) * a_m + c.dot(a) * b_m;
        // Both are 0 at a corner, of which the angle is none.
        Some(volume.atan2(rest))
    });
    // Half of the whole sphere's 4 pi, in halves of angles.
    half_angles_rad.sum::<f64>().abs() > std::f64::consts::PI
}
