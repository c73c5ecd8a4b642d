//! Where the toy stands: camera, receivers, lights, and the poses in stage space.

use std::f64::consts::FRAC_PI_2;
use std::sync::Arc;

use app_core::light_points::{ambient_directions, light_points};
use app_core::region::{Bounds, PixelRect};
use app_core::scene::{Intrinsics, Light, PoseTime, Receiver, Surface};
use app_core::toy::{PosedMesh, Toy};
use app_core::view::{Place, View};
use glam::{DMat4, DQuat, DVec2, DVec3, DVec4, UVec2};
use harness::reference::model::Region;
use harness::reference::occlusion::{Caster, Occluder};

use crate::toy;

/// Moment of the clip that is shown.
const SHOWN_SECS: f64 = 0.8;
/// What the camera looks at.
const TARGET: DVec3 = DVec3::new(0.0, 0.05, 0.0);

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
    /// Whether a wall stands behind the toy, so that its shadow is broken by the crease.
    pub(crate) has_wall: bool,
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
/// Low and before the toy: its shadow goes up the wall.
const LOW_BULB: Light = Light::Sphere {
    position_in_world: DVec3::new(-0.22, 0.27, 0.36),
    radius_m: 0.02,
};
/// Beyond the wall, which it does not shine on.
const BACK_BULB: Light = Light::Sphere {
    position_in_world: DVec3::new(0.05, 0.75, -0.4),
    radius_m: 0.04,
};

const NEAR: Setup = Setup {
    name: "bulb",
    image_px: UVec2::new(97, 61),
    lights: &[BULB],
    distance_m: 0.42,
    feet_m: 0.0,
    has_wall: false,
};
/// The shadow of one light goes up a wall that ends within the picture; another light is beyond it.
pub(crate) const WALL: Setup = Setup {
    name: "wall",
    image_px: UVec2::new(163, 119),
    lights: &[LOW_BULB, BACK_BULB],
    distance_m: 0.55,
    has_wall: true,
    ..NEAR
};
/// One light close by, two lights, a directional light on a sunken toy, the hard edge of a lifted one from afar, and a
/// second receiver.
pub(crate) const SETUPS: [Setup; 5] = [
    NEAR,
    Setup {
        name: "two bulbs",
        image_px: UVec2::new(131, 75),
        lights: &[BULB, OTHER_BULB],
        distance_m: 0.72,
        ..NEAR
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
        ..NEAR
    },
    WALL,
];

/// A toy on its receivers under a camera.
pub(crate) struct Stand {
    pub(crate) setup: Setup,
    pub(crate) toy: Arc<Toy>,
    pub(crate) intrinsics: Intrinsics,
    pub(crate) world_from_camera: DMat4,
    pub(crate) world_from_object: DMat4,
    /// The first is the stage.
    pub(crate) receivers: Vec<Receiver>,
    pub(crate) stage_from_world: DMat4,
    pub(crate) physical_pose: PoseTime,
    pub(crate) shown_pose: PoseTime,
    pub(crate) physical: PosedMesh,
    pub(crate) shown: PosedMesh,
}

impl Stand {
    /// Height over the first receiver of the box around the toy, over the physical pose and the whole clip.
    pub(crate) fn tallest_m(&self) -> f64 {
        let over_clip = self.toy.bounds_over_clip(self.shown_pose.clip.unwrap()).unwrap();
        let corners = Bounds {
            min: over_clip.min.as_dvec3(),
            max: over_clip.max.as_dvec3(),
        };
        let stage_from_object = self.stage_from_world * self.world_from_object;
        let clip = corners.corners().map(|p| stage_from_object.transform_point3(p).y);
        let physical = self.physical.positions.iter().map(|p| f64::from(p.y));
        clip.chain(physical).fold(f64::MIN, f64::max)
    }

    pub(crate) fn new(setup: Setup) -> Self {
        let toy = Toy::from_glb("boxes.glb", &toy::glb()).unwrap();
        let clip = toy.find_clip(toy::CLIP).unwrap();
        let world_from_stage =
            DMat4::from_rotation_translation(DQuat::from_rotation_y(0.3), DVec3::new(0.02, 0.015, -0.03));
        let world_from_object = DMat4::from_rotation_translation(
            DQuat::from_rotation_y(-0.5),
            DVec3::new(0.0, 0.015 + setup.feet_m, 0.0),
        );
        let stage_from_world = world_from_stage.inverse();
        let pose = |moment| {
            let mut posed = PosedMesh::default();
            toy.pose(moment, &(stage_from_world * world_from_object), &mut posed)
                .unwrap();
            posed
        };
        let size = setup.image_px.as_dvec2();
        Self {
            intrinsics: Intrinsics {
                fx_px: size.x,
                fy_px: 1.02 * size.x,
                cx_px: 0.5 * size.x + 1.7,
                cy_px: 0.5 * size.y - 0.6,
            },
            world_from_camera: camera(setup.distance_m * DVec3::new(0.3, 0.6, 0.75).normalize()),
            receivers: receivers(&world_from_stage, setup.has_wall),
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
            stage_from_world,
        }
    }

    /// The same stand from another camera, at an offset from what it looks at.
    pub(crate) fn seen_from(setup: Setup, offset: DVec3) -> Self {
        Self {
            world_from_camera: camera(offset),
            ..Self::new(setup)
        }
    }

    pub(crate) fn whole_image(&self) -> PixelRect {
        PixelRect {
            origin_px: UVec2::ZERO,
            size_px: self.setup.image_px,
        }
    }

    pub(crate) fn view(&self) -> View {
        View::new(self.setup.image_px, self.intrinsics, &self.world_from_camera)
    }

    /// What the references know of `rect` of the camera's picture.
    pub(crate) fn region(&self, rect: &PixelRect) -> Region {
        let place = Place {
            receivers: &self.receivers,
            lights: self.setup.lights,
            toy_in_stage: self.physical_centre(),
        };
        Region::new(&self.view(), rect, &place)
    }

    /// Points of a light, in stage space.
    pub(crate) fn light_points(&self, index: usize, n_points: usize) -> Vec<DVec4> {
        let light = &self.setup.lights[index];
        let points = light_points(light, &self.stage_from_world, self.physical_centre(), n_points);
        points.iter().map(|point| point.as_dvec4()).collect()
    }

    /// A posed toy under points over light `index`, as many as are planned, for each receiver.
    pub(crate) fn light_casters(&self, posed: &PosedMesh, index: usize, n_points: usize) -> Vec<Caster> {
        let in_stage = self.light_points(index, n_points);
        self.casters(posed, |plane_from_stage| {
            in_stage.iter().map(|point| *plane_from_stage * *point).collect()
        })
    }

    /// A posed toy under directions of the ambient light, as many as are planned, for each receiver.
    pub(crate) fn ambient_casters(&self, posed: &PosedMesh, n_directions: usize) -> Vec<Caster> {
        let directions = ambient_directions(n_directions);
        // Each receiver has its own hemisphere.
        self.casters(posed, |_| {
            directions.iter().map(|point| point.as_dvec4()).collect()
        })
    }

    fn casters(&self, posed: &PosedMesh, light_points: impl Fn(&DMat4) -> Vec<DVec4>) -> Vec<Caster> {
        let planes = self
            .receivers
            .iter()
            .map(|receiver| receiver.world_from_plane.inverse() * self.stage_from_world.inverse());
        planes
            .map(|plane_from_stage| Caster {
                occluder: self.occluder_in(posed, &plane_from_stage),
                light_points: light_points(&plane_from_stage),
            })
            .collect()
    }

    /// A posed toy in stage space.
    pub(crate) fn occluder(&self, posed: &PosedMesh) -> Occluder {
        self.occluder_in(posed, &DMat4::IDENTITY)
    }

    fn occluder_in(&self, posed: &PosedMesh, plane_from_stage: &DMat4) -> Occluder {
        let positions = posed.positions.iter();
        let positions: Vec<DVec3> = positions
            .map(|position| plane_from_stage.transform_point3(position.as_dvec3()))
            .collect();
        Occluder::new(&positions, self.toy.indices())
    }

    /// The camera's centre and the direction of the ray through `image_px`, in stage space.
    pub(crate) fn camera_ray(&self, image_px: DVec2) -> (DVec3, DVec3) {
        let k = &self.intrinsics;
        let in_camera = DVec3::new(
            (image_px.x - k.cx_px) / k.fx_px,
            (k.cy_px - image_px.y) / k.fy_px,
            -1.0,
        );
        let stage_from_camera = self.stage_from_world * self.world_from_camera;
        (
            stage_from_camera.w_axis.truncate(),
            stage_from_camera.transform_vector3(in_camera),
        )
    }

    /// The middle of the physical toy's bounding box.
    fn physical_centre(&self) -> DVec3 {
        let positions = self.physical.positions.iter().map(|position| position.as_dvec3());
        let low = positions.clone().fold(DVec3::INFINITY, DVec3::min);
        0.5 * (low + positions.fold(DVec3::NEG_INFINITY, DVec3::max))
    }
}

/// The table, and a wall that stands on it behind the toy and reaches a little into it.
fn receivers(world_from_stage: &DMat4, has_wall: bool) -> Vec<Receiver> {
    let table = Receiver {
        name: "table".to_owned(),
        world_from_plane: *world_from_stage,
        half_extent_m: DVec2::new(0.24, 0.2),
        surface: Surface::Textured,
    };
    let half_extent_m = DVec2::new(0.13, 0.07);
    let stage_from_wall = DMat4::from_rotation_translation(
        DQuat::from_rotation_x(FRAC_PI_2),
        DVec3::new(0.06, half_extent_m.y - 0.01, -0.06),
    );
    let wall = Receiver {
        name: "wall".to_owned(),
        world_from_plane: *world_from_stage * stage_from_wall,
        half_extent_m,
        surface: Surface::Textured,
    };
    if has_wall { vec![table, wall] } else { vec![table] }
}

fn camera(offset: DVec3) -> DMat4 {
    let eye = TARGET + offset;
    let backward = (eye - TARGET).normalize();
    let right = DVec3::Y.cross(backward).normalize();
    let up = backward.cross(right);
    DMat4::from_cols(
        right.extend(0.0),
        up.extend(0.0),
        backward.extend(0.0),
        eye.extend(1.0),
    )
}
