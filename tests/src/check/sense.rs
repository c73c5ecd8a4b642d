//! Numbers that can be read, but are hardly meant.

use app_core::scene::{Light, Pose, Scene};
use app_core::session::SessionFrame;
use glam::{DMat4, DVec3};

/// Sizes of a toy and distances to it that are no mistake, in metres.
const TOY_M: [f64; 2] = [0.005, 3.0];
const CAMERA_M: [f64; 2] = [0.03, 30.0];

/// What a session does without, and what is made of it.
pub(super) fn without(scene: &Scene) -> Vec<String> {
    let mut facts = Vec::new();
    if scene.lights.is_empty() {
        facts.push("lights: none is listed, so that no shadow is moved".to_owned());
    }
    if scene.plates.is_empty() {
        facts.push("backgrounds: there is none, so that the place behind the toy is estimated".to_owned());
    }
    facts
}

/// Of the session as a whole.
pub(super) fn wrong(scene: &Scene) -> Vec<String> {
    let mut wrong = Vec::new();
    if let Some(corners) = corners(scene, &scene.physical_pose, &scene.world_from_object) {
        let toy_m = corners[0].distance(corners[7]);
        if !(TOY_M[0]..=TOY_M[1]).contains(&toy_m) {
            wrong.push(format!(
                "toy.world_from_object: the toy is {toy_m:.3} m from corner to corner: lengths are in metres, and the matrix holds the scale of the model"
            ));
        }
    }
    for (index, light) in scene.lights.iter().enumerate() {
        let is_above = scene.receivers.iter().any(|receiver| {
            let plane_from_world = receiver.world_from_plane.inverse();
            match light {
                Light::Sphere {
                    position_in_world, ..
                } => plane_from_world.transform_point3(*position_in_world).y > 0.0,
                Light::Directional {
                    direction_to_light_in_world,
                    ..
                } => plane_from_world.transform_vector3(*direction_to_light_in_world).y > 0.0,
            }
        });
        if !is_above {
            wrong.push(format!("lights[{index}]: it is above none of the receivers"));
        }
    }
    wrong
}

/// Of one frame.
pub(super) fn wrong_of_frame(scene: &Scene, index: usize, frame: &SessionFrame) -> Vec<String> {
    let Some(corners) = corners(scene, &scene.physical_pose, &frame.world_from_object) else {
        return vec![format!("frames[{index}]: the toy cannot be posed")];
    };
    let mut wrong = Vec::new();
    let camera = &frame.camera;
    let centre = 0.5 * (corners[0] + corners[7]);
    let camera_m = camera.world_from_camera.w_axis.truncate().distance(centre);
    if !(CAMERA_M[0]..=CAMERA_M[1]).contains(&camera_m) {
        wrong.push(format!(
            "frames[{index}].world_from_camera: the camera is {camera_m:.3} m from the toy: lengths are in metres"
        ));
    }
    let in_camera = corners.map(|corner| camera.world_from_camera.inverse().transform_point3(corner));
    let n_behind = in_camera.iter().filter(|at| at.z >= 0.0).count();
    let k = &camera.intrinsics;
    let is_seen = in_camera.iter().any(|at| {
        let (u, v) = (k.cx_px - k.fx_px * at.x / at.z, k.cy_px + k.fy_px * at.y / at.z);
        let inside =
            (0.0..f64::from(scene.width_px)).contains(&u) && (0.0..f64::from(scene.height_px)).contains(&v);
        at.z < 0.0 && inside
    });
    if n_behind == corners.len() {
        wrong.push(format!(
            "frames[{index}].world_from_camera: the toy is behind the camera, which looks along -Z with +Y up: the matrix may be of another convention, inverted or transposed"
        ));
    } else if !is_seen {
        wrong.push(format!(
            "frames[{index}].world_from_camera: the toy is out of the picture"
        ));
    }
    wrong
}

/// Of the toy's box, in the world: the first and the last are opposite.
fn corners(scene: &Scene, pose: &Pose, world_from_object: &DMat4) -> Option<[DVec3; 8]> {
    let bounds = scene.toy.bounds_of_pose(pose).ok()?;
    let [min, max] = [bounds.min.as_dvec3(), bounds.max.as_dvec3()];
    Some(std::array::from_fn(|i| {
        let pick = |bit: usize, low: f64, high: f64| if i & bit == 0 { low } else { high };
        world_from_object.transform_point3(DVec3::new(
            pick(1, min.x, max.x),
            pick(2, min.y, max.y),
            pick(4, min.z, max.z),
        ))
    }))
}
