//! The memory that materials need, in a separate process: other tests would count as well.

#![cfg(target_os = "linux")]
#![expect(clippy::unwrap_used, reason = "a test fails by panicking")]

#[path = "pictures/core/bundled.rs"]
mod bundled;

use std::fs;
use std::sync::Arc;

use app_core::preset::Preset;
use app_core::toy::Toy;
use app_pipeline::core::inspect::Inspect;
use desk::files::BUNDLED_SESSION;
use measure::glb::{chunks, container};
use measure::process::peak_mib;
use serde_json::{Value, json};

use bundled::{core, first_input, picture_of, scene};

/// Largest growth per material beside its textures.
const MAX_MATERIAL_KIB: f64 = 64.0;

fn number(value: &Value) -> usize {
    usize::try_from(value.as_u64().unwrap_or(0)).unwrap()
}

/// The bundled toy with a copy of its material for every `n_triangles` of each primitive.
fn with_materials(n_triangles: usize) -> Toy {
    let bytes = fs::read(format!("{BUNDLED_SESSION}/toy.glb")).unwrap();
    let (mut json, bin) = chunks(&bytes);
    let (mut primitives, mut materials, mut accessors) = (Vec::new(), Vec::new(), json["accessors"].clone());
    for whole in json["meshes"][0]["primitives"].as_array().unwrap() {
        let indices = &json["accessors"][number(&whole["indices"])];
        let (first, n_corners) = (number(&indices["byteOffset"]), number(&indices["count"]));
        for from in (0..n_corners).step_by(3 * n_triangles) {
            let count = (n_corners - from).min(3 * n_triangles);
            // Indices of 16 bits.
            accessors
                .as_array_mut()
                .unwrap()
                .push(json!({ "bufferView": indices["bufferView"],
                "byteOffset": first + 2 * from, "componentType": 5123, "type": "SCALAR", "count": count }));
            let mut part = whole.clone();
            part["indices"] = json!(accessors.as_array().unwrap().len() - 1);
            part["material"] = json!(materials.len());
            materials.push(json["materials"][number(&whole["material"])].clone());
            primitives.push(part);
        }
    }
    json["meshes"][0]["primitives"] = primitives.into();
    json["materials"] = materials.into();
    json["accessors"] = accessors;
    Toy::from_glb("toy.glb", &container(json.to_string().as_bytes(), bin)).unwrap()
}

/// The largest memory in MiB that this process has held so far with a picture of the toy, and the
/// toy's objects on the device.
fn shown(toy: Toy) -> (f64, u64) {
    let mut core = core();
    let objects = |core: &app_core::Core| core.n_created().iter().map(|(_, n)| n).sum::<u64>();
    let before = objects(&core);
    let scene = scene().with_toy(Arc::new(toy));
    core.set_scene(scene, Preset::Balanced).unwrap();
    picture_of(&mut core, &first_input());
    (peak_mib().unwrap(), objects(&core) - before)
}

#[test]
fn a_material_takes_little_beside_its_textures() {
    // Run once for the resources of every scene, such as pipelines.
    shown(with_materials(usize::MAX / 3));
    let (few_mib, n_few_objects) = shown(with_materials(usize::MAX / 3));
    let many = with_materials(1);
    let n_materials = many.materials().len();
    assert!(n_materials > 1000, "{n_materials}");
    let (many_mib, n_many_objects) = shown(many);
    let kib = 1024.0 * (many_mib - few_mib) / n_materials as f64;
    println!("{kib:.1} KiB a material");
    assert!(kib <= MAX_MATERIAL_KIB, "{kib} KiB a material");
    assert_eq!(n_many_objects, n_few_objects);
}
