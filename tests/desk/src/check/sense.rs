//! Numbers that can be read, but are probably wrong.

use app_core::scene::Scene;
use app_core::session::SessionFrame;
use app_scene::geometry::bounds::Bounds;
use glam::{DMat4, DVec2, DVec3, UVec2};

use crate::doubts;

/// Plausible sizes of a toy, in metres.
const TOY_M: [f64; 2] = [0.005, 3.0];

/// Optional parts that a session lacks, and their substitutes.
pub(super) fn without(scene: &Scene) -> Vec<String> {
    let mut facts = Vec::new();
    if let (true, Some(_)) = (scene.lights.is_empty(), &scene.probe) {
        facts.push(
            "lights: none is listed: they are estimated from the probe and corrected by the toy's shadow"
                .to_owned(),
        );
    } else if scene.lights.is_empty() {
        facts.push("lights: none is listed: they are estimated from the toy's shadow".to_owned());
    }
    if scene.plates.is_empty() {
        facts.push("backgrounds: there is none: the place behind the toy is estimated".to_owned());
    }
    facts
}

/// The mesh of the place.
pub(super) fn place_mesh(scene: &Scene) -> Option<String> {
    let mesh = scene.place_mesh.as_ref()?;
    let deviation = mesh.deviation_m().map_or(String::new(), |deviation_m| {
        format!(" with a deviation of {:.1} mm", 1e3 * deviation_m)
    });
    Some(format!(
        "place_mesh: {} triangles{deviation}: planes of things are searched close to it",
        mesh.triangles().len()
    ))
}

/// The depths of the first frame.
pub(super) fn depth(frame: &SessionFrame) -> Option<String> {
    let depth = frame.depth.as_ref()?;
    let [width, height] = depth.size_px().to_array();
    Some(format!(
        "frames[0].depth: {width} x {height} px, {:.0} % of them known: planes of things are searched close to it",
        1e2 * depth.known()
    ))
}

/// Implausible numbers of the session as a whole.
pub(super) fn wrong(scene: &Scene) -> Vec<String> {
    let mut wrong = doubts::of_scene(scene);
    if let Some(corners) = corners(scene, &scene.world_from_object) {
        let toy_m = corners[0].distance(corners[7]);
        if !(TOY_M[0]..=TOY_M[1]).contains(&toy_m) {
            wrong.push(format!(
                "toy.world_from_object: the toy is {toy_m:.3} m from corner to corner: lengths are in metres, and the matrix holds the scale of the model, such as 0.001 for one in millimetres"
            ));
        }
    }
    for (index, light) in scene.lights.iter().enumerate() {
        let mut receivers = scene.receivers.iter();
        let is_above = receivers.any(|receiver| light.is_above(&receiver.world_from_plane.inverse()));
        if !is_above {
            wrong.push(format!("lights[{index}]: it is not above any receiver"));
        }
    }
    wrong
}

/// Implausible numbers of one frame.
pub(super) fn wrong_of_frame(scene: &Scene, index: usize, frame: &SessionFrame) -> Vec<String> {
    let Some(corners) = corners(scene, &frame.world_from_object) else {
        return vec![format!("frames[{index}]: the toy cannot be posed")];
    };
    let mut wrong = doubts::of_frame(scene, index, frame);
    let camera = &frame.camera;
    let size_px = UVec2::new(scene.width_px, scene.height_px).as_dvec2();
    let before_camera: Vec<DVec2> = corners
        .iter()
        .filter_map(|corner| camera.pixel_of(*corner))
        .collect();
    let is_inside = |at_px: &DVec2| at_px.cmpge(DVec2::ZERO).all() && at_px.cmplt(size_px).all();
    if before_camera.is_empty() {
        wrong.push(format!(
            "frames[{index}].world_from_camera: the toy is behind the camera, which looks along -Z with +Y up: the matrix may be of another convention, inverted or transposed"
        ));
    } else if !before_camera.iter().any(is_inside) {
        wrong.push(format!(
            "frames[{index}].world_from_camera: the toy is out of the picture"
        ));
    }
    wrong
}

/// Corners of the toy's box, in the world: the first and the last are opposite.
fn corners(scene: &Scene, world_from_object: &DMat4) -> Option<Vec<DVec3>> {
    let bounds = scene.toy.bounds_of_pose(&scene.physical_pose).ok()?;
    let bounds = Bounds {
        min: bounds.min.as_dvec3(),
        max: bounds.max.as_dvec3(),
    };
    let corners = bounds.corners();
    Some(
        corners
            .map(|corner| world_from_object.transform_point3(corner))
            .collect(),
    )
}
