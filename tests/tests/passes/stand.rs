//! Setup of a scene: camera, receivers, and the poses in anchor space.

use std::f64::consts::FRAC_PI_2;
use std::sync::Arc;

use app_core::scene::{Camera, Intrinsics, Pose, Receiver, Surface};
use app_core::toy::{PosedMesh, Toy};
use app_pipeline::geometry::anchored::AnchoredReceiver;
use app_pipeline::geometry::rect::PixelRect;
use app_pipeline::geometry::scene_layout::SceneLayout;
use app_pipeline::geometry::view::View;
use app_pipeline::passes::globals::Globals;
use app_pipeline::passes::globals::globals;
use app_scene::geometry::bounds::Bounds;
use glam::{DMat4, DQuat, DVec2, DVec3, UVec2};
use reference::model::Region;

use crate::setups::{Beside, Setup};
use crate::toy;

/// Moment of the shown clip, in seconds.
const SHOWN_SECS: f64 = 0.8;
/// The camera's target.
const TARGET: DVec3 = DVec3::new(0.0, 0.05, 0.0);

/// A toy on its receivers under a camera.
pub(crate) struct Stand {
    pub(crate) setup: Setup,
    pub(crate) toy: Arc<Toy>,
    pub(crate) camera: Camera,
    pub(crate) world_from_object: DMat4,
    pub(crate) receivers: Vec<Receiver>,
    /// The receivers as the core has them; the first one's plane is the anchor.
    pub(crate) anchored: Vec<AnchoredReceiver>,
    pub(crate) anchor_from_world: DMat4,
    pub(crate) physical_pose: Pose,
    pub(crate) shown_pose: Pose,
    pub(crate) physical: PosedMesh,
    pub(crate) shown: PosedMesh,
}

impl Stand {
    /// Angular radius of each light, seen from the toy's centre.
    pub(crate) fn angular_radii_rad(&self) -> Vec<f64> {
        let bounds = self.toy.bounds_of_pose(&self.physical_pose).unwrap();
        let middle = self
            .world_from_object
            .transform_point3(0.5 * (bounds.min + bounds.max).as_dvec3());
        let lights = self.setup.lights.iter();
        lights
            .map(|light| light.angular_radius_rad_from(middle))
            .collect()
    }

    /// Height over the first receiver of the toy's bounding box, over the physical pose and the
    /// whole clip.
    pub(crate) fn tallest_m(&self) -> f64 {
        let over_clip = self
            .toy
            .bounds_over_clip(self.shown_pose.clip().unwrap())
            .unwrap();
        let corners = Bounds {
            min: over_clip.min.as_dvec3(),
            max: over_clip.max.as_dvec3(),
        };
        let anchor_from_object = self.anchor_from_world * self.world_from_object;
        let clip = corners
            .corners()
            .map(|p| anchor_from_object.transform_point3(p).y);
        let physical = self.physical.positions.iter().map(|p| f64::from(p.y));
        clip.chain(physical).fold(f64::MIN, f64::max)
    }

    pub(crate) fn new(setup: Setup) -> Self {
        let toy = Toy::from_glb("boxes.glb", &toy::glb()).unwrap();
        let clip = toy.find_clip(toy::CLIP).unwrap();
        let world_from_table =
            DMat4::from_rotation_translation(DQuat::from_rotation_y(0.3), DVec3::new(0.02, 0.015, -0.03));
        let world_from_object = DMat4::from_rotation_translation(
            DQuat::from_rotation_y(-0.5),
            DVec3::new(0.0, 0.015 + setup.feet_m, 0.0),
        );
        let receivers = receivers(&world_from_table, setup.beside);
        let anchored = anchored(&receivers, &toy, &world_from_object);
        let anchor_from_world = anchored[0].world_from_plane.inverse();
        let pose = |pose: &Pose| {
            let mut posed = PosedMesh::default();
            toy.pose(pose, &(anchor_from_world * world_from_object), &mut posed)
                .unwrap();
            posed
        };
        let size = setup.image_px.as_dvec2();
        let shown_pose = Pose::Clip {
            clip,
            time_secs: SHOWN_SECS,
        };
        Self {
            camera: Camera {
                intrinsics: Intrinsics {
                    fx_px: size.x,
                    fy_px: 1.02 * size.x,
                    cx_px: 0.5 * size.x + 1.7,
                    cy_px: 0.5 * size.y - 0.6,
                },
                world_from_camera: camera(setup.distance_m * DVec3::new(0.3, 0.6, 0.75).normalize()),
            },
            receivers,
            anchored,
            physical: pose(&Pose::Authored),
            physical_pose: Pose::Authored,
            shown: pose(&shown_pose),
            shown_pose,
            toy: Arc::new(toy),
            setup,
            world_from_object,
            anchor_from_world,
        }
    }

    /// The same stand with a table of another size.
    pub(crate) fn on_table(mut self, half_extent_m: f64) -> Self {
        self.receivers[0].half_extent_m = DVec2::splat(half_extent_m);
        self.anchored = anchored(&self.receivers, &self.toy, &self.world_from_object);
        self
    }

    /// The same stand from another camera, at an offset from its target.
    pub(crate) fn seen_from(setup: Setup, offset: DVec3) -> Self {
        let stand = Self::new(setup);
        Self {
            camera: Camera {
                world_from_camera: camera(offset),
                ..stand.camera
            },
            ..stand
        }
    }

    pub(crate) fn whole_image(&self) -> PixelRect {
        PixelRect {
            origin_px: UVec2::ZERO,
            size_px: self.setup.image_px,
        }
    }

    pub(crate) fn view(&self) -> View {
        View::new(self.setup.image_px, &self.camera)
    }

    fn layout(&self) -> SceneLayout<'_> {
        SceneLayout {
            receivers: &self.anchored,
            lights: self.setup.lights,
            toy_in_anchor: self.physical_centre(),
        }
    }

    /// Values of the references for the rectangle `rect` of the camera's picture.
    pub(crate) fn region(&self, rect: &PixelRect) -> Region {
        Region::new(&self.view(), rect, &self.layout())
    }

    /// Values of the shaders for the rectangle.
    pub(crate) fn globals(&self, rect: &PixelRect) -> Globals {
        globals(&self.view(), rect, &self.layout())
    }

    /// The camera's centre and the direction of the ray through `image_px`, in anchor space.
    pub(crate) fn camera_ray(&self, image_px: DVec2) -> (DVec3, DVec3) {
        let k = &self.camera.intrinsics;
        let in_camera = DVec3::new(
            (image_px.x - k.cx_px) / k.fx_px,
            (k.cy_px - image_px.y) / k.fy_px,
            -1.0,
        );
        let anchor_from_camera = self.anchor_from_world * self.camera.world_from_camera;
        (
            anchor_from_camera.w_axis.truncate(),
            anchor_from_camera.transform_vector3(in_camera),
        )
    }

    /// The centre of the physical toy's bounding box.
    pub(crate) fn physical_centre(&self) -> DVec3 {
        let positions = self.physical.positions.iter().map(|position| position.as_dvec3());
        let low = positions.clone().fold(DVec3::INFINITY, DVec3::min);
        0.5 * (low + positions.fold(DVec3::NEG_INFINITY, DVec3::max))
    }
}

/// Computed in the same way as in the core.
fn anchored(receivers: &[Receiver], toy: &Toy, world_from_object: &DMat4) -> Vec<AnchoredReceiver> {
    let bounds = toy.bounds_of_pose(&Pose::Authored).unwrap();
    let middle = (0.5 * (bounds.min + bounds.max)).as_dvec3();
    let toy_in_world = world_from_object.transform_point3(middle);
    let receivers = receivers.iter();
    receivers
        .map(|receiver| AnchoredReceiver::near(receiver, toy_in_world))
        .collect()
}

/// The table, and a wall on it behind the toy, which reaches a little into it.
fn receivers(world_from_table: &DMat4, beside: Beside) -> Vec<Receiver> {
    let table = Receiver {
        name: "table".to_owned(),
        world_from_plane: *world_from_table,
        half_extent_m: DVec2::new(0.24, 0.2),
        surface: Surface::Textured,
    };
    let half_extent_m = DVec2::new(0.13, 0.07);
    let table_from_wall = DMat4::from_rotation_translation(
        DQuat::from_rotation_x(FRAC_PI_2),
        DVec3::new(0.06, half_extent_m.y - 0.01, -0.06),
    );
    let wall = Receiver {
        name: "wall".to_owned(),
        world_from_plane: *world_from_table * table_from_wall,
        half_extent_m,
        surface: Surface::Textured,
    };
    let book = |height_m: f64| {
        let middle = DVec3::new(-0.11, height_m, 0.03);
        let table_from_book = DMat4::from_rotation_translation(DQuat::from_rotation_y(0.3), middle);
        Receiver {
            name: "book".to_owned(),
            world_from_plane: *world_from_table * table_from_book,
            half_extent_m: DVec2::new(0.045, 0.06),
            surface: Surface::Textured,
        }
    };
    let tilt = DQuat::from_rotation_y(0.3) * DQuat::from_rotation_z(-0.52);
    let ramp = Receiver {
        name: "ramp".to_owned(),
        world_from_plane: *world_from_table
            * DMat4::from_rotation_translation(tilt, DVec3::new(-0.11, 0.0225, 0.03)),
        ..book(0.0)
    };
    match beside {
        Beside::Nothing => vec![table],
        Beside::Wall => vec![table, wall],
        Beside::Book => vec![table, book(0.025)],
        Beside::Side => {
            let side = side(&book(0.05));
            vec![table, book(0.05), side]
        }
        Beside::Pile => vec![table, book(0.03), book(0.06), book(0.09)],
        Beside::Ramp => vec![table, ramp],
    }
}

/// The side of a book below the edge of its top with the largest z.
fn side(top: &Receiver) -> Receiver {
    let half_extent_m = DVec2::new(top.half_extent_m.x, 0.025);
    let top_from_side = DMat4::from_rotation_translation(
        DQuat::from_rotation_x(FRAC_PI_2),
        DVec3::new(0.0, -half_extent_m.y, top.half_extent_m.y),
    );
    Receiver {
        name: "side".to_owned(),
        world_from_plane: top.world_from_plane * top_from_side,
        half_extent_m,
        surface: Surface::Textured,
    }
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
