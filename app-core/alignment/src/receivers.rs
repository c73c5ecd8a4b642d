//! Receivers in camera space, and the plate transferred to the camera.

use glam::{DMat4, DVec2, DVec3, IVec2};

use super::picture::{Picture, UNKNOWN, places};
use super::pose::Plane;
use app_scene::geometry::nearest_receivers::nearest_to_toy;
use app_scene::scene::{Camera, Intrinsics, MAX_RECEIVERS, Plate, Receiver, Scene, Surface};

/// Tolerance for equal cameras' matrices.
pub(super) const SAME_CAMERA: f64 = 1e-9;

/// A receiver in camera space.
#[derive(Clone, Debug)]
pub(super) struct SeenReceiver {
    /// Rigid.
    pub(super) plane_from_camera: DMat4,
    half_extent_m: DVec2,
}

impl SeenReceiver {
    /// The receivers nearest to the toy, up to the number on which shadows are retargeted.
    pub(super) fn near(scene: &Scene, world_from_object: &DMat4, camera_from_world: &DMat4) -> Vec<Self> {
        Self::near_in_scene(scene, world_from_object, camera_from_world).0
    }

    /// The same with the place of each in the scene's list.
    pub(super) fn near_in_scene(
        scene: &Scene,
        world_from_object: &DMat4,
        camera_from_world: &DMat4,
    ) -> (Vec<Self>, Vec<usize>) {
        let nearest = nearest_to_toy(scene, world_from_object);
        let seen = nearest.into_iter().take(MAX_RECEIVERS);
        seen.map(|index| (Self::new(&scene.receivers[index], camera_from_world), index))
            .unzip()
    }

    /// One of them.
    pub(super) fn new(receiver: &Receiver, camera_from_world: &DMat4) -> Self {
        Self {
            plane_from_camera: (*camera_from_world * receiver.world_from_plane).inverse(),
            half_extent_m: receiver.half_extent_m,
        }
    }

    /// A plane of some size about its origin.
    pub(super) fn of_size(plane_from_camera: DMat4, half_extent_m: DVec2) -> Self {
        Self {
            plane_from_camera,
            half_extent_m,
        }
    }

    /// From the space of another plane to this one's.
    pub(super) fn own_from_plane(&self, plane_from_camera: &DMat4) -> DMat4 {
        self.plane_from_camera * plane_from_camera.inverse()
    }

    /// Its corners, in camera space.
    pub(super) fn corners(&self) -> [DVec3; 4] {
        let camera_from_plane = self.plane_from_camera.inverse();
        let DVec2 { x, y } = self.half_extent_m;
        [(x, y), (-x, y), (x, -y), (-x, -y)]
            .map(|(x, z)| camera_from_plane.transform_point3(DVec3::new(x, 0.0, z)))
    }

    /// The same in the space of another camera.
    fn seen_from(&self, camera_from_other: &DMat4) -> Self {
        Self {
            plane_from_camera: self.plane_from_camera * *camera_from_other,
            half_extent_m: self.half_extent_m,
        }
    }

    /// Half its sides, in metres.
    pub(super) fn half_extent_m(&self) -> DVec2 {
        self.half_extent_m
    }

    /// The receiver in the world.
    pub(super) fn receiver(&self, name: String, world_from_camera: &DMat4) -> Receiver {
        Receiver {
            name,
            world_from_plane: *world_from_camera * self.plane_from_camera.inverse(),
            half_extent_m: self.half_extent_m,
            surface: Surface::Textured,
        }
    }

    /// The receiver's point at a pixel, in camera space; `None` if the pixel shows none.
    pub(super) fn point_at(&self, k: &Intrinsics, at: IVec2) -> Option<DVec3> {
        let ray = ray(k, at);
        self.depth_m(ray).map(|depth_m| depth_m * ray)
    }

    /// The plane in camera space, if the lowest of the points is within `most_m` of it; rounded to
    /// 32 bits, as poses are.
    pub(super) fn plane_under(&self, points: &[DVec3], most_m: f64) -> Option<Plane> {
        let heights_m = points
            .iter()
            .map(|point| self.plane_from_camera.transform_point3(*point).y);
        let lowest_m = heights_m.fold(f64::INFINITY, f64::min);
        let normal = self.plane_from_camera.inverse().y_axis.truncate().normalize();
        // The point is below the toy: there 32 bits are enough for any origin of the plane.
        let above = *points.first()?;
        let point = above - self.plane_from_camera.transform_point3(above).y * normal;
        (lowest_m.abs() <= most_m).then(|| Plane {
            normal: normal.as_vec3().as_dvec3().normalize(),
            point: point.as_vec3().as_dvec3(),
        })
    }

    /// Depth in metres at which a ray of depth 1 from the camera meets its front; `None` if it does
    /// not.
    fn depth_m(&self, ray: DVec3) -> Option<f64> {
        let eye = self.plane_from_camera.w_axis.truncate();
        let along = self.plane_from_camera.transform_vector3(ray);
        // Towards the plane from its front, so that a positive number is divided by a positive one.
        if eye.y <= 0.0 || along.y >= 0.0 {
            return None;
        }
        let depth_m = eye.y / -along.y;
        let at = eye + depth_m * along;
        let is_on = at.x.abs() <= self.half_extent_m.x && at.z.abs() <= self.half_extent_m.y;
        is_on.then_some(depth_m)
    }
}

/// Normal of the first receiver, in camera space.
pub(super) fn up(receivers: &[SeenReceiver]) -> DVec3 {
    receivers.first().map_or(DVec3::Y, |receiver| {
        receiver.plane_from_camera.inverse().y_axis.truncate()
    })
}

/// Through a pixel's centre, of depth 1.
fn ray(k: &Intrinsics, at: IVec2) -> DVec3 {
    k.ray(at.as_dvec2() + 0.5)
}

/// The nearest receiver that a pixel shows: its index, and the point in camera space.
pub(super) fn receiver_at(receivers: &[SeenReceiver], k: &Intrinsics, at: IVec2) -> Option<(usize, DVec3)> {
    nearest_hit(receivers, ray(k, at))
}

/// The nearest receiver that a ray of depth 1 from the camera meets, and the point.
fn nearest_hit(receivers: &[SeenReceiver], ray: DVec3) -> Option<(usize, DVec3)> {
    let hits = receivers.iter().enumerate();
    let hits = hits.filter_map(|(index, receiver)| Some((index, receiver.depth_m(ray)?)));
    let nearest = hits.min_by(|(_, a), (_, b)| a.total_cmp(b));
    nearest.map(|(index, depth_m)| (index, depth_m * ray))
}

/// Plates sorted by their cameras' distance from a camera in metres, which similar directions
/// reduce.
pub(super) fn nearest<'a>(plates: &'a [Plate], camera: &Camera) -> Vec<&'a Plate> {
    let distance = |plate: &Plate| {
        let (there, here) = (&plate.camera.world_from_camera, &camera.world_from_camera);
        let turn = there.z_axis.dot(here.z_axis);
        (there.w_axis - here.w_axis).length() - turn
    };
    let mut plates: Vec<&Plate> = plates.iter().collect();
    plates.sort_by(|a, b| distance(a).total_cmp(&distance(b)));
    plates
}

/// The plate with the camera nearest to the given one, transferred by the receivers' planes if it
/// is from another place; `None` without plates.
pub(super) fn plate_for(plates: &[Plate], receivers: &[SeenReceiver], camera: &Camera) -> Option<Picture> {
    let plate = nearest(plates, camera).into_iter().next()?;
    let picture = Picture::decode(&plate.image);
    let is_same = plate.camera.intrinsics == camera.intrinsics
        && plate
            .camera
            .world_from_camera
            .abs_diff_eq(camera.world_from_camera, SAME_CAMERA);
    Some(if is_same {
        picture
    } else {
        carried(&picture, &plate.camera, receivers, camera)
    })
}

fn carried(picture: &Picture, from: &Camera, receivers: &[SeenReceiver], to: &Camera) -> Picture {
    let plate_camera_from_camera = from.world_from_camera.inverse() * to.world_from_camera;
    let camera_from_plate_camera = plate_camera_from_camera.inverse();
    let seen_by_plate: Vec<SeenReceiver> = receivers
        .iter()
        .map(|receiver| receiver.seen_from(&camera_from_plate_camera))
        .collect();
    let color = |at: IVec2| {
        let (shown, point) = receiver_at(receivers, &to.intrinsics, at)?;
        let point = plate_camera_from_camera.transform_point3(point);
        let px = from.intrinsics.pixel_of(point)?;
        // Another receiver may hide it from the plate's camera, which may also see its other side.
        let (in_plate, _) = nearest_hit(&seen_by_plate, from.intrinsics.ray(px))?;
        picture.sample(px).filter(|_| in_plate == shown)
    };
    let pixels = places(picture.size_px).map(|at| color(at).unwrap_or(UNKNOWN));
    Picture::of(picture.size_px, pixels.collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A camera at some metres to the right above a table, that looks straight down.
    fn camera(right_m: f64) -> Camera {
        let world_from_camera = DMat4::from_translation(DVec3::new(right_m, 0.5, 0.0))
            * DMat4::from_rotation_x(-std::f64::consts::FRAC_PI_2);
        Camera {
            intrinsics: Intrinsics {
                fx_px: 60.0,
                fy_px: 60.0,
                cx_px: 50.0,
                cy_px: 50.0,
            },
            world_from_camera,
        }
    }

    #[test]
    fn a_plate_shows_nothing_where_a_thing_hid_the_table_from_its_camera() {
        let (here, there) = (camera(0.2), camera(-0.2));
        let level_at = |height_m: f64, half_m: f64| Receiver {
            name: String::new(),
            world_from_plane: DMat4::from_translation(DVec3::Y * height_m),
            half_extent_m: DVec2::splat(half_m),
            surface: Surface::Textured,
        };
        let camera_from_world = here.world_from_camera.inverse();
        let receivers = [level_at(0.0, 1.0), level_at(0.1, 0.05)]
            .map(|receiver| SeenReceiver::new(&receiver, &camera_from_world));
        let size_px = IVec2::splat(100);
        let plate = Picture::of(size_px, vec![[0.5; 3]; 10_000]);
        let carried = carried(&plate, &there, &receivers, &here);
        let color_of = |point: DVec3| {
            let px = here
                .intrinsics
                .pixel_of(camera_from_world.transform_point3(point))
                .unwrap();
            carried.get(px.floor().as_ivec2())
        };
        // The rays of the plate's camera to places up to .11 m right of the origin pass below the top's border.
        assert_eq!(color_of(DVec3::X * 0.09), None);
        assert!(color_of(DVec3::X * 0.13).is_some());
        assert!(color_of(DVec3::Y * 0.1).is_some());
    }
}
