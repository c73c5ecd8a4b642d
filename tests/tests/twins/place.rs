//! Where the toy stands: camera, receiver, lights, and the poses in plane space.

use std::sync::Arc;

use app_core::light_points::{ambient_directions, light_points};
use app_core::region::Bounds;
use app_core::region::{PixelRect, Place, View};
use app_core::scene::{Intrinsics, Light, PoseTime, Receiver, Surface};
use app_core::toy::{PosedMesh, Toy};
use glam::{DMat4, DQuat, DVec2, DVec3, DVec4, UVec2};
use harness::reference::model::Region;
use harness::reference::occlusion::Occluder;

use crate::toy;

/// Moment of the clip that is shown.
const SHOWN_SECS: f64 = 0.8;

/// What a twin is run on.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Setup {
    pub(crate) name: &'static str,
    pub(crate) image_px: UVec2,
    pub(crate) lights: &'static [Light],
    /// Distance of the camera from the toy; what is far off leaves room around the work region.
    pub(crate) distance_m: f64,
    /// Height of the toy's feet over the receiver: tracking is never quite right.
    pub(crate) feet_m: f64,
}

const BULB: Light = Light::Sphere {
    position_in_world: DVec3::new(0.32, 0.62, 0.02),
    radius_m: 0.05,
};
const OTHER_BULB: Light = Light::Sphere {
    position_in_world: DVec3::new(-0.3, 0.7, 0.25),
    radius_m: 0.03,
};
/// Unit vector: -3, 6, -2 over 7, away from the camera, which then sees the shadow.
const SKY: Light = Light::Directional {
    direction_to_light_in_world: DVec3::new(-3.0 / 7.0, 6.0 / 7.0, -2.0 / 7.0),
    angular_radius_rad: 0.06,
};

const POINT: Light = Light::Sphere {
    position_in_world: DVec3::new(0.3, 0.5, -0.2),
    radius_m: 0.0,
};

const NEAR: Setup = Setup {
    name: "bulb",
    image_px: UVec2::new(97, 61),
    lights: &[BULB],
    distance_m: 0.42,
    feet_m: 0.0,
};
/// One light close by, two lights, a directional light on a sunken toy, and the hard edge of a lifted one from afar.
pub(crate) const SETUPS: [Setup; 4] = [
    NEAR,
    Setup {
        name: "two bulbs",
        image_px: UVec2::new(131, 75),
        lights: &[BULB, OTHER_BULB],
        distance_m: 0.72,
        feet_m: 0.0,
    },
    Setup {
        name: "directional",
        lights: &[SKY],
        distance_m: 0.5,
        feet_m: -0.004,
        ..NEAR
    },
    Setup {
        name: "point",
        image_px: UVec2::new(163, 119),
        lights: &[POINT],
        distance_m: 0.9,
        feet_m: 0.006,
    },
];

/// A toy on a receiver under a camera.
pub(crate) struct Stand {
    pub(crate) setup: Setup,
    pub(crate) toy: Arc<Toy>,
    pub(crate) intrinsics: Intrinsics,
    pub(crate) world_from_camera: DMat4,
    pub(crate) world_from_object: DMat4,
    pub(crate) receiver: Receiver,
    pub(crate) plane_from_world: DMat4,
    pub(crate) physical_pose: PoseTime,
    pub(crate) shown_pose: PoseTime,
    pub(crate) physical: PosedMesh,
    pub(crate) shown: PosedMesh,
}

impl Stand {
    /// Height over the receiver of the box around the toy, over the physical pose and the whole clip.
    pub(crate) fn tallest_m(&self) -> f64 {
        let over_clip = self.toy.bounds_over_clip(self.shown_pose.clip.unwrap()).unwrap();
        let corners = Bounds {
            min: over_clip.min.as_dvec3(),
            max: over_clip.max.as_dvec3(),
        };
        let plane_from_object = self.plane_from_world * self.world_from_object;
        let clip = corners.corners().map(|p| plane_from_object.transform_point3(p).y);
        let physical = self.physical.positions.iter().map(|p| f64::from(p.y));
        clip.chain(physical).fold(f64::MIN, f64::max)
    }

    pub(crate) fn new(setup: Setup) -> Self {
        let toy = Toy::from_glb("boxes.glb", &toy::glb()).unwrap();
        let clip = toy.find_clip(toy::CLIP).unwrap();
        let world_from_plane =
            DMat4::from_rotation_translation(DQuat::from_rotation_y(0.3), DVec3::new(0.02, 0.015, -0.03));
        let world_from_object = DMat4::from_rotation_translation(
            DQuat::from_rotation_y(-0.5),
            DVec3::new(0.0, 0.015 + setup.feet_m, 0.0),
        );
        let plane_from_world = world_from_plane.inverse();
        let pose = |moment| {
            let mut posed = PosedMesh::default();
            toy.pose(moment, &(plane_from_world * world_from_object), &mut posed)
                .unwrap();
            posed
        };
        let target = DVec3::new(0.0, 0.05, 0.0);
        let eye = target + setup.distance_m * DVec3::new(0.3, 0.6, 0.75).normalize();
        let size = setup.image_px.as_dvec2();
        Self {
            intrinsics: Intrinsics {
                fx_px: size.x,
                fy_px: 1.02 * size.x,
                cx_px: 0.5 * size.x + 1.7,
                cy_px: 0.5 * size.y - 0.6,
            },
            world_from_camera: looking_at(eye, target),
            receiver: Receiver {
                name: "table".to_owned(),
                world_from_plane,
                half_extent_m: DVec2::new(0.24, 0.2),
                surface: Surface::Textured,
            },
            physical_pose: PoseTime {
                clip: None,
                time_secs: 0.0,
            },
            shown_pose: PoseTime {
                clip: Some(clip),
                time_secs: SHOWN_SECS,
            },
            physical: pose(None),
            shown: pose(Some((clip, SHOWN_SECS))),
            toy: Arc::new(toy),
            setup,
            world_from_object,
            plane_from_world,
        }
    }

    pub(crate) fn whole_image(&self) -> PixelRect {
        PixelRect {
            origin_px: UVec2::ZERO,
            size_px: self.setup.image_px,
        }
    }

    /// What the references know of `rect` of the camera's picture.
    pub(crate) fn region(&self, rect: &PixelRect) -> Region {
        let view = View::new(
            self.setup.image_px,
            self.intrinsics,
            &self.world_from_camera,
            &self.receiver,
        );
        let centre = self.physical_centre();
        let place = Place {
            receiver: &self.receiver,
            lights: self.setup.lights,
            plane_from_world: &self.plane_from_world,
            reference_in_plane: DVec2::new(centre.x, centre.z),
        };
        Region::new(&view, rect, &place)
    }

    /// Points over light `index`; as many as are planned.
    pub(crate) fn light_points(&self, index: usize, n_points: usize) -> Vec<DVec4> {
        let light = &self.setup.lights[index];
        let points = light_points(light, &self.plane_from_world, self.physical_centre(), n_points);
        points.iter().map(|point| point.as_dvec4()).collect()
    }

    pub(crate) fn occluder(&self, posed: &PosedMesh) -> Occluder {
        let positions: Vec<DVec3> = posed
            .positions
            .iter()
            .map(|position| position.as_dvec3())
            .collect();
        Occluder::new(&positions, self.toy.indices())
    }

    /// The camera's centre and the direction of the ray through `image_px`, in plane space.
    pub(crate) fn camera_ray(&self, image_px: DVec2) -> (DVec3, DVec3) {
        let k = &self.intrinsics;
        let in_camera = DVec3::new(
            (image_px.x - k.cx_px) / k.fx_px,
            (k.cy_px - image_px.y) / k.fy_px,
            -1.0,
        );
        let plane_from_camera = self.plane_from_world * self.world_from_camera;
        (
            plane_from_camera.w_axis.truncate(),
            plane_from_camera.transform_vector3(in_camera),
        )
    }

    /// The middle of the physical toy's bounding box.
    fn physical_centre(&self) -> DVec3 {
        let positions = self.physical.positions.iter().map(|position| position.as_dvec3());
        let low = positions.clone().fold(DVec3::INFINITY, DVec3::min);
        0.5 * (low + positions.fold(DVec3::NEG_INFINITY, DVec3::max))
    }
}

fn looking_at(eye: DVec3, target: DVec3) -> DMat4 {
    let backward = (eye - target).normalize();
    let right = DVec3::Y.cross(backward).normalize();
    let up = backward.cross(right);
    DMat4::from_cols(
        right.extend(0.0),
        up.extend(0.0),
        backward.extend(0.0),
        eye.extend(1.0),
    )
}

/// Directions of the ambient light; as many as are planned.
pub(crate) fn ambient_points(n_directions: usize) -> Vec<DVec4> {
    ambient_directions(n_directions)
        .iter()
        .map(|direction| direction.as_dvec4())
        .collect()
}
