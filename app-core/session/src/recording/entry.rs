//! What a live camera and an app know, as the index of a session has it.

use glam::DMat4;
use serde_json::{Value, json};

use app_scene::camera_frame::CameraImage;
use app_scene::scene::{Camera, Intrinsics, Light, LightEstimate, Pose, Receiver, Scene, Surface};
use app_scene::toy::Toy;

/// A camera frame that is recorded as it comes; its picture is encoded by whoever writes it.
#[derive(Clone, Debug)]
pub struct LiveFrame {
    /// The camera's picture.
    pub image: CameraImage,
    /// The camera that took it.
    pub camera: Camera,
    /// Where the real toy stands, from object space to world.
    pub world_from_object: DMat4,
    /// Exposure of the picture over that of the plates.
    pub exposure: f64,
    /// What the platform estimates of the light.
    pub light_estimate: Option<LightEstimate>,
    /// The pose that was shown.
    pub shown_pose: Pose,
}

impl LiveFrame {
    /// Its entry of the index's `frames`: taken `time_secs` after the first, its picture at `path`.
    pub(super) fn entry(&self, time_secs: f64, path: &str, toy: &Toy) -> Value {
        let mut entry = json!({
            "time": time_secs,
            "image": path,
            "intrinsics": intrinsics(&self.camera.intrinsics),
            "world_from_camera": matrix(&self.camera.world_from_camera),
            "world_from_object": matrix(&self.world_from_object),
            "exposure": self.exposure,
            "animation": pose(&self.shown_pose, toy),
        });
        if let Some(estimate) = &self.light_estimate {
            entry["light_estimate"] = light_estimate(estimate);
        }
        entry
    }
}

/// The index of a scene but its frames, with cameras of `projection` unless they bring their own. A probe and bounds on
/// what is uncertain are not told: a live scene has none.
pub(super) fn index(scene: &Scene, projection: &Intrinsics, toy_path: &str, plate_paths: &[String]) -> Value {
    let plates = scene.plates.iter().zip(plate_paths);
    let backgrounds = plates.map(|(plate, path)| {
        json!({
            "image": path,
            "intrinsics": intrinsics(&plate.camera.intrinsics),
            "world_from_camera": matrix(&plate.camera.world_from_camera),
        })
    });
    json!({
        "format": "shadow-capture",
        "version": 1,
        "name": scene.name,
        "width": scene.width_px,
        "height": scene.height_px,
        "encoding": "srgb",
        "intrinsics": intrinsics(projection),
        "toy": {
            "file": toy_path,
            "world_from_object": matrix(&scene.world_from_object),
            "physical_pose": pose(&scene.physical_pose, &scene.toy),
        },
        "receivers": scene.receivers.iter().map(receiver).collect::<Vec<_>>(),
        "lights": scene.lights.iter().map(light).collect::<Vec<_>>(),
        "backgrounds": backgrounds.collect::<Vec<_>>(),
    })
}

/// As the index has it.
pub fn light(light: &Light) -> Value {
    match light {
        Light::Sphere {
            position_in_world,
            radius_m,
        } => json!({ "kind": "sphere", "position": position_in_world.to_array(), "radius": radius_m }),
        Light::Directional {
            direction_to_light_in_world,
            angular_radius_rad,
        } => json!({
            "kind": "directional",
            "direction_to_light": direction_to_light_in_world.to_array(),
            "angular_radius_deg": angular_radius_rad.to_degrees(),
        }),
    }
}

/// As the index has it, without what the platform does not tell.
pub fn light_estimate(estimate: &LightEstimate) -> Value {
    let direction = estimate.direction_to_light_in_world;
    let told = [
        (
            "direction_to_light",
            direction.map(|direction| json!(direction.to_array())),
        ),
        ("intensity", estimate.intensity.map(|intensity| json!(intensity))),
        (
            "ambient_intensity",
            estimate.ambient_intensity.map(|one| json!(one)),
        ),
        (
            "color_temperature",
            estimate.color_temperature_k.map(|one| json!(one)),
        ),
        (
            "spherical_harmonics",
            estimate.spherical_harmonics.map(|all| json!(all)),
        ),
    ];
    let told = told
        .into_iter()
        .filter_map(|(key, value)| Some((key.to_owned(), value?)));
    Value::Object(told.collect())
}

/// Column by column.
pub fn matrix(a_from_b: &DMat4) -> Value {
    json!(a_from_b.to_cols_array())
}

fn intrinsics(of: &Intrinsics) -> Value {
    json!({ "fx": of.fx_px, "fy": of.fy_px, "cx": of.cx_px, "cy": of.cy_px })
}

fn receiver(receiver: &Receiver) -> Value {
    let surface = match receiver.surface {
        Surface::Uniform => "uniform",
        Surface::Textured => "textured",
    };
    json!({
        "name": receiver.name,
        "world_from_plane": matrix(&receiver.world_from_plane),
        "half_extent": receiver.half_extent_m.to_array(),
        "surface": surface,
    })
}

/// A clip by its name, or by its number where another clip of that name comes before it.
fn pose(pose: &Pose, toy: &Toy) -> Value {
    let Pose::Clip { clip, time_secs } = pose else {
        return json!({ "clip": null, "time": 0.0 });
    };
    let name = toy.clip_names().into_iter().nth(clip.index());
    let name = name.filter(|name| toy.find_clip(name).ok() == Some(*clip));
    let name = name.unwrap_or_else(|| format!("#{}", clip.index()));
    json!({ "clip": name, "time": time_secs })
}
