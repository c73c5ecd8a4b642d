//! Extensions of a file: supported ones, harmless ones, and those without which a toy cannot be
//! drawn.

use serde_json::Value;

use super::error::{Flaw, ToyProblem};
use super::warning::ToyWarning;

/// Supported, or without effect on a toy's shape and base colour.
const FOLLOWED: [&str; 13] = [
    "KHR_mesh_quantization",
    "KHR_lights_punctual",
    "KHR_materials_unlit",
    "KHR_materials_specular",
    "KHR_materials_pbrSpecularGlossiness",
    "KHR_texture_transform",
    "KHR_node_visibility",
    // Unsupported channels have their own warning.
    "KHR_animation_pointer",
    "KHR_meshopt_compression",
    "EXT_meshopt_compression",
    "EXT_mesh_gpu_instancing",
    "EXT_texture_webp",
    "KHR_xmp_json_ld",
];

/// Extensions that change reflections, or add a variant: shape and base colour are independent of
/// them.
const GLOSS: [&str; 9] = [
    "KHR_materials_anisotropy",
    "KHR_materials_clearcoat",
    "KHR_materials_dispersion",
    "KHR_materials_emissive_strength",
    "KHR_materials_ior",
    "KHR_materials_iridescence",
    "KHR_materials_sheen",
    "KHR_materials_variants",
    "EXT_lights_ies",
];

/// Unsupported texture formats.
pub(super) const TEXTURE_FORMATS: [&str; 3] = ["KHR_texture_basisu", "EXT_texture_avif", "MSFT_texture_dds"];
pub(super) const DRACO: &str = "KHR_draco_mesh_compression";

/// The way to export a file without an extension.
pub(super) fn way_out(name: &str) -> &'static str {
    match name {
        DRACO => {
            "open it in Blender and export it as glTF Binary (.glb) with Compression off; meshopt is read, \
             `npx @gltf-transform/cli meshopt` writes it from the file that was not compressed yet"
        }
        "KHR_texture_basisu" => {
            "turn its KTX2 textures into PNG with `npx @gltf-transform/cli ktxdecompress IN.glb OUT.glb`"
        }
        "EXT_texture_avif" | "MSFT_texture_dds" => {
            "write its textures as PNG, JPEG or WebP, as with `npx @gltf-transform/cli webp IN.glb OUT.glb`"
        }
        _ => "export the toy without it",
    }
}

/// The refusal of data that only an extension provides.
pub(super) fn lacking(name: &str, field: impl Into<String>) -> Flaw {
    let problem = ToyProblem::Extension {
        name: name.to_owned(),
        way_out: way_out(name),
    };
    problem.at(field)
}

/// Refuses required unsupported extensions; warns about the others.
pub(super) fn check_extensions(tree: &Value, warnings: &mut Vec<ToyWarning>) -> Result<(), Flaw> {
    for (i, name) in names(tree, "extensionsRequired").enumerate() {
        if !FOLLOWED.contains(&name) && !GLOSS.contains(&name) {
            return Err(lacking(name, format!("extensionsRequired[{i}]")));
        }
    }
    let unfollowed = names(tree, "extensionsUsed").filter(|name| !FOLLOWED.contains(name));
    warnings.extend(unfollowed.map(|name| ToyWarning::ExtensionIgnored {
        name: name.to_owned(),
    }));
    Ok(())
}

fn names<'a>(tree: &'a Value, list: &str) -> impl Iterator<Item = &'a str> {
    let list = tree.get(list).and_then(Value::as_array);
    list.into_iter().flatten().filter_map(Value::as_str)
}
