//! Tiles far from every silhouette, compared with rays: all viewpoints see the same there, and the
//! triangles that meet the other tiles cover as much of them as the whole shape.

use app_pipeline::geometry::silhouette::{
    AROUND_PX, ByCamera, OntoReceiver, Projection, Shape, Silhouette, Viewers, find_silhouette,
};
use app_scene::geometry::edges::{Edge, edges};
use glam::{DMat3, DVec2, DVec3, Mat3, Mat4, UVec2, Vec2, Vec3, Vec4, Vec4Swizzles};
use measure::ball::ball_mesh;

const SIZE_PX: UVec2 = UVec2::new(192, 144);
/// Positions of rays within a pixel, from its corner: at the lattice's ends, and between.
const POSITIONS: [[f64; 2]; 3] = [[0.01, 0.99], [0.5, 0.5], [0.99, 0.01]];

/// Positions, and corners counter-clockwise seen from outside.
type Mesh = (Vec<Vec3>, Vec<u32>);

/// A ball of `n` by `n` squares; without its last ring it is open.
fn ball(centre: Vec3, radius: f32, n: u32, is_closed: bool) -> Mesh {
    let (mut positions, corners) = ball_mesh(n, n);
    let last = u32::try_from(positions.len()).expect("some hundreds") - 1;
    positions.iter_mut().for_each(|at| *at = centre + radius * *at);
    let triangles = corners.as_chunks::<3>().0.iter();
    let kept = triangles.filter(|triangle| is_closed || !triangle.contains(&last));
    (positions, kept.flatten().copied().collect())
}

fn both((mut positions, mut corners): Mesh, (others, more): Mesh) -> Mesh {
    let first = u32::try_from(positions.len()).expect("some hundreds");
    positions.extend(others);
    corners.extend(more.iter().map(|corner| first + corner));
    (positions, corners)
}

/// A ray, and the range along it in which a hit counts.
struct Ray {
    from: DVec3,
    along: DVec3,
    end: f64,
}

impl Ray {
    /// Source: Möller and Trumbore 1997.
    fn meets(&self, [a, b, c]: [DVec3; 3]) -> bool {
        let [ab, ac, to] = [b - a, c - a, self.from - a];
        let across = self.along.cross(ac);
        let det = ab.dot(across);
        let u = to.dot(across) / det;
        let v = self.along.dot(to.cross(ab)) / det;
        let t = ac.dot(to.cross(ab)) / det;
        u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t > 0.0 && t < self.end
    }
}

/// A mesh's viewer, by its rays through a position of the target, in pixels.
struct Look<'a> {
    name: &'static str,
    points: Vec<Vec4>,
    projection: &'a dyn Projection,
    rays: &'a dyn Fn(DVec2) -> Vec<Ray>,
}

impl Look<'_> {
    fn find_silhouette(&self, (positions, corners): &Mesh, edges: &[Edge]) -> (Vec<u32>, Silhouette) {
        let viewers = Viewers::around(&self.points).expect("points of one kind");
        let facing = viewers.facing(positions, corners);
        let shape = Shape {
            positions,
            corners,
            edges,
        };
        let silhouette = find_silhouette(shape, &viewers, self.projection, corners, SIZE_PX).expect("bounds");
        (facing, silhouette)
    }

    /// Number of pixels of tiles without a silhouette about which their rays disagree, of pixels of
    /// other tiles that the listed triangles cover differently than all triangles do, and of
    /// covered pixels far from every silhouette.
    fn check(&self, mesh: &Mesh, silhouette: &Silhouette) -> [usize; 3] {
        let place = |corner: &u32| mesh.0[*corner as usize].as_dvec3();
        let triangles = |corners: &[u32]| -> Vec<[DVec3; 3]> {
            let triangles = corners.as_chunks::<3>().0;
            triangles
                .iter()
                .map(|[a, b, c]| [place(a), place(b), place(c)])
                .collect()
        };
        let (all, listed) = (triangles(&mesh.1), triangles(&silhouette.corners));
        let is_met = |ray: &Ray, by: &[[DVec3; 3]]| by.iter().any(|triangle| ray.meets(*triangle));
        let [mut n_apart, mut n_lost, mut n_inside] = [0; 3];
        for px in (0..SIZE_PX.y).flat_map(|y| (0..SIZE_PX.x).map(move |x| UVec2::new(x, y))) {
            let rays: Vec<Ray> = POSITIONS
                .iter()
                .flat_map(|position| (self.rays)(px.as_dvec2() + DVec2::from(*position)))
                .collect();
            let met: Vec<bool> = rays.iter().map(|ray| is_met(ray, &all)).collect();
            if silhouette.tiles.is_marked_at(px) {
                n_lost += usize::from(
                    rays.iter()
                        .zip(&met)
                        .any(|(ray, met)| is_met(ray, &listed) != *met),
                );
            } else {
                n_apart += usize::from(met.iter().any(|one| *one != met[0]));
                n_inside += usize::from(met[0]);
            }
        }
        [n_apart, n_lost, n_inside]
    }
}

/// Toys that are closed, open, sunk into the receiver, and in two pieces that pass through each
/// other.
fn meshes() -> [(&'static str, Mesh); 4] {
    let at = |x: f32, y: f32| Vec3::new(x, y, 0.1);
    [
        ("closed", ball(at(0.0, 0.6), 0.5, 12, true)),
        ("open", ball(at(0.0, 0.7), 0.5, 10, false)),
        ("sunk", ball(at(0.1, 0.3), 0.5, 12, true)),
        (
            "two pieces",
            both(
                ball(at(-0.2, 0.6), 0.4, 10, true),
                ball(at(0.3, 0.5), 0.4, 10, true),
            ),
        ),
    ]
}

/// A camera that looks down on the receiver, the whole of which is in front of it.
fn homography() -> Mat3 {
    Mat3::from_cols_array(&[0.35, 0.02, 0.01, -0.03, -0.3, 0.12, 0.02, 0.05, 1.0])
}

/// Clip space's (x, y) at a position of the target.
fn clip_xy(px: DVec2) -> DVec2 {
    (px / SIZE_PX.as_dvec2() - 0.5) * DVec2::new(2.0, -2.0)
}

fn look_by_light(name: &'static str, points: Vec<Vec4>, check: &dyn Fn(&Look<'_>)) {
    let projection = OntoReceiver {
        plane_from_anchor: Mat4::IDENTITY,
        light: Viewers::around(&points).expect("points of one kind"),
        clip_from_plane: homography(),
        region_size_px: SIZE_PX.as_vec2(),
        near_m: 0.1,
        around_px: AROUND_PX,
    };
    let plane_from_clip: DMat3 = homography().as_dmat3().inverse();
    let seen_by = points.clone();
    let rays = move |px: DVec2| {
        let at = plane_from_clip * clip_xy(px).extend(1.0);
        let from = DVec3::new(at.x / at.z, 0.0, at.y / at.z);
        let to = |point: &Vec4| (point.xyz().as_dvec3(), f64::from(point.w));
        let ray = |(point, w): (DVec3, f64)| Ray {
            from,
            along: point - w * from,
            end: f64::INFINITY,
        };
        seen_by.iter().map(to).map(ray).collect()
    };
    check(&Look {
        name,
        points,
        projection: &projection,
        rays: &rays,
    });
}

fn look_by_camera(check: &dyn Fn(&Look<'_>)) {
    let eye = Vec3::new(0.6, 2.2, 2.4);
    let back = (eye - Vec3::new(0.0, 0.4, 0.0)).normalize();
    let right = Vec3::Y.cross(back).normalize();
    let [x, y, z] = [right, back.cross(right), back].map(|axis| axis.extend(-axis.dot(eye)));
    // Reversed depth without a far plane: (x, y, near, -z).
    let (focal, near_m) = (2.7, 0.05);
    let rows = [0.75 * focal * x, focal * y, near_m * Vec4::W, -z];
    let clip_from_anchor = Mat4::from_rows(rows[0], rows[1], rows[2], rows[3]);
    let anchor_from_clip = clip_from_anchor.as_dmat4().inverse();
    let ray_at = move |px: DVec2| {
        let near = anchor_from_clip.project_point3(clip_xy(px).extend(1.0));
        let from = eye.as_dvec3();
        let along = near - from;
        // Up to the receiver.
        let end = if along.y < 0.0 {
            -from.y / along.y
        } else {
            f64::INFINITY
        };
        Ray { from, along, end }
    };
    let inverse_depth = |px: DVec2| {
        let ray = ray_at(px);
        let at = ray.from + ray.end * ray.along;
        1.0 / clip_from_anchor.as_dmat4().mul_vec4(at.extend(1.0)).w
    };
    // Linear in pixels.
    let [origin, right, below] = [DVec2::ZERO, DVec2::X, DVec2::Y].map(inverse_depth);
    let projection = ByCamera {
        clip_from_anchor,
        region_size_px: SIZE_PX.as_vec2(),
        origin_px: Vec2::ZERO,
        inverse_depths: vec![DVec3::new(right - origin, below - origin, origin).as_vec3()],
        around_px: AROUND_PX,
    };
    check(&Look {
        name: "a camera",
        points: vec![eye.extend(1.0)],
        projection: &projection,
        rays: &|px| vec![ray_at(px)],
    });
}

/// Points of a lamp around a position.
fn lamp(radius_m: f32) -> Vec<Vec4> {
    let around = [
        [1.0, 0.0, 0.0],
        [-1.0, 0.0, 0.0],
        [0.0, 0.7, 0.7],
        [0.0, -0.7, -0.7],
        [0.0, 0.0, 0.0],
    ];
    around
        .map(|offset| (Vec3::new(1.0, 4.0, 0.5) + radius_m * Vec3::from(offset)).extend(1.0))
        .to_vec()
}

fn looks(check: &dyn Fn(&Look<'_>)) {
    look_by_camera(check);
    look_by_light("a bulb", lamp(0.05), check);
    look_by_light("a wide lamp", lamp(0.6), check);
    let sun = [[0.5, 0.8, 0.2], [0.52, 0.8, 0.2], [0.5, 0.8, 0.24]];
    let sun = sun.map(|to| Vec3::from(to).normalize().extend(0.0));
    look_by_light("a sun", sun.to_vec(), check);
}

#[test]
fn all_points_see_the_same_where_no_outline_is() {
    looks(&|look| {
        for (name, mesh) in meshes() {
            let (facing, silhouette) = look.find_silhouette(&mesh, &edges(mesh.1.as_chunks().0));
            let what = format!("{name}, by {}", look.name);
            let [n_apart, n_lost, n_inside] = look.check(&mesh, &silhouette);
            assert_eq!(n_apart, 0, "{what}: pixels that are seen in part");
            assert_eq!(n_lost, 0, "{what}: pixels whose triangles are not listed");
            assert!(!facing.is_empty());
            // Under the receiver, or in a wide penumbra, all tiles are marked.
            if name != "sunk" && look.name != "a wide lamp" {
                assert!(
                    n_inside > 100,
                    "{what}: only {n_inside} pixels are drawn but once"
                );
            }
        }
    });
}

/// Without its edges a silhouette is not found, and without a triangle pixels are lost: the test
/// detects both.
#[test]
fn what_is_missing_is_found() {
    looks(&|look| {
        let mesh = ball(Vec3::new(0.0, 0.6, 0.1), 0.5, 12, true);
        let (_, mut silhouette) = look.find_silhouette(&mesh, &[]);
        assert!(look.check(&mesh, &silhouette)[0] > 0, "by {}", look.name);
        (_, silhouette) = look.find_silhouette(&mesh, &edges(mesh.1.as_chunks().0));
        silhouette.corners.truncate(silhouette.corners.len() / 2);
        assert!(look.check(&mesh, &silhouette)[1] > 0, "by {}", look.name);
    });
}

#[test]
fn points_and_directions_at_once_see_no_side_alone() {
    assert_eq!(Viewers::around(&[]), None);
    assert_eq!(Viewers::around(&[Vec4::W, Vec4::Y]), None);
}

#[test]
fn a_shadow_without_bounds_has_no_outline() {
    let mesh = ball(Vec3::new(0.0, 3.6, 0.0), 0.5, 8, true);
    let light = lamp(0.05);
    let viewers = Viewers::around(&light).expect("points of one kind");
    let projection = OntoReceiver {
        plane_from_anchor: Mat4::IDENTITY,
        light: viewers,
        clip_from_plane: homography(),
        region_size_px: SIZE_PX.as_vec2(),
        near_m: 0.1,
        around_px: AROUND_PX,
    };
    let edges = edges(mesh.1.as_chunks().0);
    let shape = Shape {
        positions: &mesh.0,
        corners: &mesh.1,
        edges: &edges,
    };
    assert!(find_silhouette(shape, &viewers, &projection, &mesh.1, SIZE_PX).is_none());
}

/// Points at which a line from each point of a lamp through a corner meets a shelf that is lifted
/// and tilted.
#[test]
fn shadows_land_on_any_receiver() {
    let shelf_from_anchor = Mat4::from_rotation_z(0.2)
        * Mat4::from_rotation_x(-0.1)
        * Mat4::from_translation(Vec3::new(0.1, -0.3, 0.2));
    let light = lamp(0.3);
    let in_shelf: Vec<Vec4> = light.iter().map(|point| shelf_from_anchor * *point).collect();
    let projection = |plane_from_anchor| OntoReceiver {
        plane_from_anchor,
        light: Viewers::around(&in_shelf).expect("points of one kind"),
        clip_from_plane: homography(),
        region_size_px: SIZE_PX.as_vec2(),
        near_m: 0.1,
        around_px: AROUND_PX,
    };
    let anchor_from_shelf = shelf_from_anchor.as_dmat4().inverse();
    let (origin, up) = (anchor_from_shelf.w_axis.xyz(), anchor_from_shelf.y_axis.xyz());
    let shadow_px = |corner: DVec3, point: DVec3| {
        let along = corner - point;
        let met = point + along * ((origin - point).dot(up) / along.dot(up));
        let in_shelf = shelf_from_anchor.as_dmat4().transform_point3(met);
        let clip = homography().as_dmat3() * DVec3::new(in_shelf.x, in_shelf.z, 1.0);
        (clip.truncate() / clip.z * DVec2::new(0.5, -0.5) + 0.5) * SIZE_PX.as_dvec2()
    };
    let (corners, _) = ball(Vec3::new(0.1, 0.9, -0.1), 0.4, 6, true);
    let is_held = |projection: &OntoReceiver, corner: &Vec3| {
        let landing = projection.land(*corner).expect("it is under the lamp");
        light.iter().all(|point| {
            let off = shadow_px(corner.as_dvec3(), point.xyz().as_dvec3()) - landing.at_px.as_dvec2();
            off.abs().cmple(landing.within_px.as_dvec2() + 1e-3).all()
        })
    };
    let on_shelf = projection(shelf_from_anchor);
    assert!(corners.iter().all(|corner| is_held(&on_shelf, corner)));
    // The expectation is that of a shelf on the table.
    let on_table = projection(Mat4::IDENTITY);
    assert!(!corners.iter().all(|corner| is_held(&on_table, corner)));
}
