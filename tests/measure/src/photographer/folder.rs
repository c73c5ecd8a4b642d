//! A shot as a session's folder, to be replayed and looked at.

use std::path::Path;

use app_core::scene::{FacetSlope, Intrinsics, Light, Probe, ProbePicture, ProbeShape, Surface};
use serde_json::{Value, json};

use super::shot::Shot;
use super::toy::CLIP;
use super::world::{Shown, World};
use desk::files::SESSION_FILE;
use desk::output::{WriteError, make_folder, write_png, write_whole};

/// Writes a session's folder.
///
/// # Errors
/// When a file cannot be written.
pub fn write(folder: &Path, world: &World, shot: &Shot) -> Result<(), WriteError> {
    make_folder(folder)?;
    for plate in &shot.scene.plates {
        write_png(&folder.join("plate.png"), &plate.image)?;
    }
    write_png(&folder.join("frame.png"), shot.input.image.rgba())?;
    write_png(&folder.join("truth.png"), &shot.truth.image)?;
    write_png(&folder.join("mask.png"), &shot.truth.mask)?;
    write_whole(&folder.join("toy.glb"), &shot.glb)?;
    let pictures = shot.scene.probe.iter().flat_map(|probe| &probe.pictures);
    for (index, picture) in pictures.enumerate() {
        write_png(&folder.join(probe_file(index)), &picture.image)?;
    }
    let text = format!("{:#}\n", index(world, shot));
    write_whole(&folder.join(SESSION_FILE), text.as_bytes())
}

fn index(world: &World, shot: &Shot) -> Value {
    let scene = &shot.scene;
    let camera = shot.input.camera.world_from_camera.to_cols_array();
    let object = scene.world_from_object.to_cols_array();
    let receivers: Vec<Value> = scene
        .receivers
        .iter()
        .map(|receiver| {
            json!({
                "name": receiver.name,
                "world_from_plane": receiver.world_from_plane.to_cols_array(),
                "half_extent": receiver.half_extent_m.to_array(),
                "surface": match receiver.surface {
                    Surface::Uniform => "uniform",
                    Surface::Textured => "textured",
                },
            })
        })
        .collect();
    let animation = match world.shown {
        Shown::Rest => json!({ "clip": null, "time": 0.0 }),
        Shown::At { time_secs } => json!({ "clip": CLIP, "time": time_secs }),
    };
    let mut index = json!({
        "format": "shadow-capture",
        "version": 1,
        "name": scene.name,
        "description": "Photographed by exact rays.",
        "credits": "",
        "width": scene.width_px,
        "height": scene.height_px,
        "encoding": "srgb",
        "intrinsics": intrinsics(&shot.input.camera.intrinsics),
        "toy": {
            "file": "toy.glb",
            "world_from_object": object,
            "physical_pose": { "clip": null, "time": 0.0 },
        },
        "receivers": receivers,
        "lights": scene.lights.iter().map(light).collect::<Vec<_>>(),
        "backgrounds": [{ "image": "plate.png", "world_from_camera": camera }],
        "frames": [{
            "time": 0.0,
            "image": "frame.png",
            "world_from_camera": camera,
            "animation": animation,
            "truth": "truth.png",
            "mask": "mask.png",
        }],
    });
    if let Some((probe, first)) = scene
        .probe
        .as_ref()
        .and_then(|probe| Some((probe, probe.pictures.first()?)))
    {
        index["probe"] = self::probe(probe, first);
    }
    index
}

fn probe_file(index: usize) -> String {
    format!("probe_{index}.png")
}

/// Probe and first picture, then the others; facets are told by a hemisphere or a focal length.
fn probe(probe: &Probe, first: &ProbePicture) -> Value {
    let picture = |(index, picture): (usize, &ProbePicture)| {
        json!({
            "image": probe_file(index),
            "exposure_ratio": picture.exposure_ratio,
            "intrinsics": intrinsics(&picture.camera.intrinsics),
            "world_from_camera": picture.camera.world_from_camera.to_cols_array(),
            "world_from_lens": picture.world_from_probe.to_cols_array(),
        })
    };
    let mut index = picture((0, first));
    let further = probe.pictures.iter().enumerate().skip(1);
    index["pictures"] = further.map(picture).collect();
    index["radius"] = json!(probe.shape.radius_m());
    index["kind"] = match probe.shape {
        ProbeShape::FresnelLens { .. } => json!("fresnel_lens"),
        ProbeShape::MirrorBall { .. } => json!("mirror_ball"),
    };
    if let ProbeShape::FresnelLens {
        slope: FacetSlope::Focal { focal_m },
        ..
    } = probe.shape
    {
        index["focal_length"] = json!(focal_m);
    }
    index
}

fn intrinsics(k: &Intrinsics) -> Value {
    json!({ "fx": k.fx_px, "fy": k.fy_px, "cx": k.cx_px, "cy": k.cy_px })
}

fn light(light: &Light) -> Value {
    match *light {
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
