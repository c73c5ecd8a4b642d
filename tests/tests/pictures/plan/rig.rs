//! A camera over a receiver, projected without matrices: by dot products with axes.

use app_core::scene::{Camera, Intrinsics, Light, Surface};
use app_pipeline::geometry::anchored::AnchoredReceiver;
use app_pipeline::geometry::rect::PixelRect;
use app_pipeline::geometry::rect::PlaneRect;
use app_pipeline::geometry::scene_layout::SceneLayout;
use app_pipeline::geometry::view::View;
use app_pipeline::passes::globals::Globals;
use app_pipeline::passes::globals::globals;
use app_scene::geometry::bounds::Bounds;
use glam::{DMat4, DVec2, DVec3, UVec2};

/// Camera and receiver as axes and positions in world space.
#[derive(Clone, Copy)]
pub(crate) struct Rig {
    pub(crate) image_px: UVec2,
    pub(crate) intrinsics: Intrinsics,
    eye: DVec3,
    right: DVec3,
    up: DVec3,
    forward: DVec3,
    origin: DVec3,
    /// The receiver's x, y and z axes.
    axes: [DVec3; 3],
}

/// A toy of 20 cm in plane space, away from the plane's origin.
pub(crate) const TOY: Bounds = Bounds {
    min: DVec3::new(-0.05, 0.0, -0.04),
    max: DVec3::new(0.07, 0.2, 0.05),
};

/// A region within the picture of the rig.
pub(crate) const RECT: PixelRect = PixelRect {
    origin_px: UVec2::new(37, 91),
    size_px: UVec2::new(501, 333),
};

/// Position of bulbs, in plane space.
pub(crate) const BULB_AT: DVec3 = DVec3::new(-0.6, 0.9, -0.3);

/// Points of the receiver that the camera of the rig sees.
pub(crate) fn points_on_plane() -> impl Iterator<Item = DVec3> {
    (-3..=3).flat_map(|x| (-3..=3).map(move |z| DVec3::new(0.1 * f64::from(x), 0.0, 0.1 * f64::from(z))))
}

/// Shadow on y = 0 of a point, from a light at a position: by similar triangles.
pub(crate) fn shadow(point: DVec3, light: DVec3) -> DVec3 {
    light + (point - light) * (light.y / (light.y - point.y))
}

impl Rig {
    /// A tilted receiver and a rolled camera 0.9 m from it that looks at the toy's centre. `shift`
    /// moves everything.
    pub(crate) fn new(shift: DVec3) -> Self {
        let turn = glam::DQuat::from_euler(glam::EulerRot::XYZ, 0.4, 0.7, -0.3);
        let axes = [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| turn * axis);
        let mut rig = Self {
            image_px: UVec2::new(640, 480),
            intrinsics: Intrinsics {
                fx_px: 601.0,
                fy_px: 587.0,
                cx_px: 311.0,
                cy_px: 251.0,
            },
            eye: DVec3::ZERO,
            right: DVec3::ZERO,
            up: DVec3::ZERO,
            forward: DVec3::ZERO,
            origin: shift + DVec3::new(0.3, -0.2, 0.5),
            axes,
        };
        rig.place_camera(DVec3::new(0.25, 0.6, 0.65), TOY.centre());
        rig
    }

    /// Moves the camera to `eye`, looking at `target`, both in plane space.
    pub(crate) fn place_camera(&mut self, eye: DVec3, target: DVec3) {
        self.eye = self.world(eye);
        self.forward = (self.world(target) - self.eye).normalize();
        // An axis that is not along the line of sight, so that the camera is rolled as well.
        self.right = self.forward.cross(DVec3::new(0.2, 0.9, 0.1)).normalize();
        self.up = self.right.cross(self.forward);
    }

    pub(crate) fn world(&self, in_plane: DVec3) -> DVec3 {
        let [x, y, z] = self.axes;
        self.origin + in_plane.x * x + in_plane.y * y + in_plane.z * z
    }

    pub(crate) fn world_from_plane(&self) -> DMat4 {
        self.receiver().world_from_plane
    }

    pub(crate) fn depth_m(&self, in_plane: DVec3) -> f64 {
        (self.world(in_plane) - self.eye).dot(self.forward)
    }

    /// Image position of a point in plane space.
    pub(crate) fn pixel(&self, in_plane: DVec3) -> DVec2 {
        let to_point = self.world(in_plane) - self.eye;
        let k = &self.intrinsics;
        let depth = to_point.dot(self.forward);
        DVec2::new(
            k.cx_px + k.fx_px * to_point.dot(self.right) / depth,
            k.cy_px - k.fy_px * to_point.dot(self.up) / depth,
        )
    }

    pub(crate) fn receiver(&self) -> AnchoredReceiver {
        let [x, y, z] = self.axes;
        AnchoredReceiver {
            world_from_plane: columns(x, y, z, self.origin),
            rect: square(2.0),
            surface: Surface::Textured,
        }
    }

    pub(crate) fn view(&self) -> View {
        let world_from_camera = columns(self.right, self.up, -self.forward, self.eye);
        View::new(
            self.image_px,
            &Camera {
                intrinsics: self.intrinsics,
                world_from_camera,
            },
        )
    }

    /// A bulb at a position in plane space.
    pub(crate) fn bulb(&self, in_plane: DVec3, radius_m: f64) -> Light {
        Light::Sphere {
            position_in_world: self.world(in_plane),
            radius_m,
        }
    }

    /// A sun in a direction of plane space.
    pub(crate) fn sun(&self, to_light_in_plane: DVec3, angular_radius_rad: f64) -> Light {
        let direction = self.world(to_light_in_plane.normalize()) - self.origin;
        Light::Directional {
            direction_to_light_in_world: direction.normalize(),
            angular_radius_rad,
        }
    }

    /// The shaders' globals for the rig.
    pub(crate) fn globals(&self, rect: &PixelRect, lights: &[Light]) -> Globals {
        globals(&self.view(), rect, &layout(&[self.receiver()], lights))
    }

    pub(crate) fn region(&self, toy: &Bounds, lights: &[Light]) -> Option<PixelRect> {
        self.view().region(toy, &layout(&[self.receiver()], lights))
    }
}

/// A square around the origin of a plane.
pub(crate) fn square(half_m: f64) -> PlaneRect {
    PlaneRect {
        min: DVec2::splat(-half_m),
        max: DVec2::splat(half_m),
    }
}

/// The toy in the centre of its receivers and lights.
pub(crate) fn layout<'a>(receivers: &'a [AnchoredReceiver], lights: &'a [Light]) -> SceneLayout<'a> {
    SceneLayout {
        receivers,
        lights,
        toy_in_anchor: TOY.centre(),
    }
}

fn columns(x: DVec3, y: DVec3, z: DVec3, origin: DVec3) -> DMat4 {
    DMat4::from_cols(x.extend(0.0), y.extend(0.0), z.extend(0.0), origin.extend(1.0))
}
