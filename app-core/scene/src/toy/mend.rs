//! Normalises the JSON tree: extensions with an equivalent in plain glTF are rewritten, parts that
//! a toy does not need are removed, and data that only extensions have is collected.

use std::collections::HashMap;

use gltf::json::animation::Animation;
use serde::Deserialize;
use serde_json::{Map, Value, json};

use super::error::{Flaw, ToyProblem};
use super::extensions::{DRACO, TEXTURE_FORMATS, lacking};
use super::meshopt::{Compressed, Filter, Mode};
use super::uv_transform::UvTransform;
use super::warning::ToyWarning;

/// Data without a place in plain glTF.
#[derive(Default)]
pub(super) struct Extras {
    /// Materials' transforms of the coordinates of their base colour's texture.
    pub(super) uv_transforms: HashMap<usize, UvTransform>,
    /// Textures that exist only in an unsupported format, with its extension.
    pub(super) unread_textures: HashMap<usize, &'static str>,
    pub(super) instances: Vec<Instances>,
    pub(super) compressed: Vec<CompressedView>,
    /// Unreadable clips, with the reason.
    pub(super) broken_clips: HashMap<usize, String>,
}

/// Instances of a node's mesh: accessors of their transforms to the node.
pub(super) struct Instances {
    pub(super) node: usize,
    pub(super) translation: Option<u32>,
    pub(super) rotation: Option<u32>,
    pub(super) scale: Option<u32>,
}

/// A buffer view whose bytes are compressed.
pub(super) struct CompressedView {
    pub(super) index: usize,
    pub(super) extension: &'static str,
    pub(super) buffer: usize,
    pub(super) offset: usize,
    pub(super) length: usize,
    pub(super) how: Compressed,
}

const INSTANCING: &str = "EXT_mesh_gpu_instancing";
pub(super) const MESHOPT: [&str; 2] = ["EXT_meshopt_compression", "KHR_meshopt_compression"];
const VISIBILITY: &str = "KHR_node_visibility";
const WEBP: &str = "EXT_texture_webp";

pub(super) fn mend(tree: &mut Value, warnings: &mut Vec<ToyWarning>) -> Result<Extras, Flaw> {
    let mut extras = Extras::default();
    if let Some(tree) = tree.as_object_mut() {
        tree.remove("cameras");
    }
    refuse_draco(tree)?;
    hide_nodes(tree);
    each(tree, "nodes", |i, node| {
        node.remove("camera");
        extras.instances.extend(instances(i, node));
    });
    each(tree, "textures", |i, texture| {
        mend_texture(i, texture, &mut extras.unread_textures);
    });
    let mut flaw = None;
    each(tree, "materials", |i, material| {
        mend_material(material);
        match uv_transform(material) {
            Ok(Some(transform)) => drop(extras.uv_transforms.insert(i, transform)),
            Ok(None) => {}
            Err(problem) => {
                let field = "pbrMetallicRoughness.baseColorTexture.extensions.KHR_texture_transform";
                flaw = Some(problem.at(format!("materials[{i}].{field}")));
            }
        }
    });
    each(tree, "bufferViews", |i, view| match compressed(i, view) {
        Ok(view) => extras.compressed.extend(view),
        Err(found) => flaw = Some(found),
    });
    each(tree, "animations", |i, animation| {
        mend_clip(i, animation, warnings);
        if let Err(reason) = Animation::deserialize(&Value::Object(animation.clone())) {
            let name = animation.remove("name").filter(Value::is_string);
            animation.clear();
            animation.insert("channels".to_owned(), json!([]));
            animation.insert("samplers".to_owned(), json!([]));
            animation.extend(name.map(|name| ("name".to_owned(), name)));
            extras.broken_clips.insert(i, reason.to_string());
        }
    });
    flaw.map_or(Ok(extras), Err)
}

fn list<'v>(of: &'v Value, name: &str) -> impl Iterator<Item = &'v Value> {
    of.get(name).and_then(Value::as_array).into_iter().flatten()
}

/// Calls for each object of a list.
fn each(tree: &mut Value, list: &str, mut call: impl FnMut(usize, &mut Map<String, Value>)) {
    let entries = tree.get_mut(list).and_then(Value::as_array_mut);
    for (i, entry) in entries.into_iter().flatten().enumerate() {
        if let Some(entry) = entry.as_object_mut() {
            call(i, entry);
        }
    }
}

fn extension<'v>(of: &'v Map<String, Value>, name: &str) -> Option<&'v Map<String, Value>> {
    of.get("extensions")?.get(name)?.as_object()
}

fn index(value: Option<&Value>) -> Option<usize> {
    usize::try_from(value?.as_u64()?).ok()
}

/// Refuses primitives that have Draco-compressed corners and no plain ones.
fn refuse_draco(tree: &Value) -> Result<(), Flaw> {
    let accessors = tree.get("accessors").and_then(Value::as_array);
    for (i, mesh) in list(tree, "meshes").enumerate() {
        for (j, primitive) in list(mesh, "primitives").enumerate() {
            let is_draco = primitive.pointer(&format!("/extensions/{DRACO}")).is_some();
            let position = index(primitive.pointer("/attributes/POSITION"));
            let accessor = position.and_then(|position| accessors?.get(position));
            let is_plain = accessor.is_some_and(|accessor| accessor.get("bufferView").is_some());
            if is_draco && !is_plain {
                return Err(lacking(DRACO, format!("meshes[{i}].primitives[{j}]")));
            }
        }
    }
    Ok(())
}

/// Removes the meshes of hidden nodes, and of all nodes below.
fn hide_nodes(tree: &mut Value) {
    let Some(nodes) = tree.get_mut("nodes").and_then(Value::as_array_mut) else {
        return;
    };
    let is_hidden = |node: &Value| {
        let visible = node.pointer(&format!("/extensions/{VISIBILITY}/visible"));
        visible == Some(&Value::Bool(false))
    };
    let mut waiting: Vec<usize> = (0..nodes.len()).filter(|&i| is_hidden(&nodes[i])).collect();
    let mut is_done = vec![false; nodes.len()];
    while let Some(i) = waiting.pop() {
        if is_done.get(i).copied().unwrap_or(true) {
            continue;
        }
        is_done[i] = true;
        if let Some(node) = nodes[i].as_object_mut() {
            for key in ["mesh", "skin", "weights"] {
                node.remove(key);
            }
            let children = node.get("children").and_then(Value::as_array);
            waiting.extend(
                children
                    .into_iter()
                    .flatten()
                    .filter_map(|child| index(Some(child))),
            );
        }
    }
}

fn instances(node: usize, json: &Map<String, Value>) -> Option<Instances> {
    let attributes = extension(json, INSTANCING)?.get("attributes")?.as_object()?;
    json.get("mesh")?;
    let accessor = |name: &str| u32::try_from(attributes.get(name)?.as_u64()?).ok();
    Some(Instances {
        node,
        translation: accessor("TRANSLATION"),
        rotation: accessor("ROTATION"),
        scale: accessor("SCALE"),
    })
}

fn mend_texture(i: usize, texture: &mut Map<String, Value>, unread: &mut HashMap<usize, &'static str>) {
    if let Some(source) = extension(texture, WEBP)
        .and_then(|webp| webp.get("source"))
        .cloned()
    {
        texture.insert("source".to_owned(), source);
    }
    if !texture.contains_key("source") {
        let format = TEXTURE_FORMATS
            .into_iter()
            .find(|name| extension(texture, name).is_some());
        unread.extend(format.map(|format| (i, format)));
    }
}

/// Uses the diffuse colour as base colour.
fn mend_material(material: &mut Map<String, Value>) {
    let Some(glossy) = extension(material, "KHR_materials_pbrSpecularGlossiness") else {
        return;
    };
    let keys = [
        ("diffuseFactor", "baseColorFactor"),
        ("diffuseTexture", "baseColorTexture"),
    ];
    let base = keys
        .into_iter()
        .filter_map(|(from, to)| Some((to.to_owned(), glossy.get(from)?.clone())));
    let base = Value::Object(base.collect());
    material.insert("pbrMetallicRoughness".to_owned(), base);
}

fn uv_transform(material: &mut Map<String, Value>) -> Result<Option<UvTransform>, ToyProblem> {
    let texture = material
        .get_mut("pbrMetallicRoughness")
        .and_then(|base| base.get_mut("baseColorTexture"))
        .and_then(Value::as_object_mut);
    let Some(texture) = texture else { return Ok(None) };
    let Some(transform) = extension(texture, "KHR_texture_transform").cloned() else {
        return Ok(None);
    };
    if let Some(set) = transform.get("texCoord") {
        texture.insert("texCoord".to_owned(), set.clone());
    }
    let transform = UvTransform::deserialize(Value::Object(transform));
    transform
        .map(Some)
        .map_err(|reason| ToyProblem::Json(reason.to_string()))
}

fn compressed(i: usize, view: &Map<String, Value>) -> Result<Option<CompressedView>, Flaw> {
    let found = MESHOPT
        .into_iter()
        .find_map(|name| Some((name, extension(view, name)?)));
    let Some((name, values)) = found else {
        return Ok(None);
    };
    let flaw =
        |key: &str, problem: ToyProblem| problem.at(format!("bufferViews[{i}].extensions.{name}.{key}"));
    let number = |key: &str| index(values.get(key)).ok_or_else(|| flaw(key, ToyProblem::Missing));
    let text = |key: &str| values.get(key).and_then(Value::as_str);
    let mode = text("mode").and_then(Mode::of);
    let filter = Filter::of(text("filter").unwrap_or("NONE"));
    let how = Compressed {
        mode: mode.ok_or_else(|| flaw("mode", ToyProblem::NotAllowed))?,
        filter: filter.ok_or_else(|| flaw("filter", ToyProblem::NotAllowed))?,
        count: number("count")?,
        stride: number("byteStride")?,
    };
    if !how.is_allowed() {
        return Err(flaw("byteStride", ToyProblem::NotAllowed));
    }
    Ok(Some(CompressedView {
        index: i,
        extension: name,
        buffer: number("buffer")?,
        offset: index(values.get("byteOffset")).unwrap_or_default(),
        length: number("byteLength")?,
        how,
    }))
}

/// Drops channels that animate no node, and converts pointers to nodes to plain targets.
fn mend_clip(i: usize, animation: &mut Map<String, Value>, warnings: &mut Vec<ToyWarning>) {
    let Some(channels) = animation.get_mut("channels").and_then(Value::as_array_mut) else {
        return;
    };
    let mut j = 0;
    channels.retain_mut(|channel| {
        let field = format!("animations[{i}].channels[{j}]");
        j += 1;
        let Some(target) = channel.get_mut("target").and_then(Value::as_object_mut) else {
            return true;
        };
        let pointer = extension(target, "KHR_animation_pointer").and_then(|pointer| pointer.get("pointer"));
        let pointer = pointer.and_then(Value::as_str).map(str::to_owned);
        if let Some((node, path)) = pointer.as_deref().and_then(pointed) {
            target.insert("node".to_owned(), node.into());
            target.insert("path".to_owned(), path.into());
        } else if let Some(pointer) = pointer {
            warnings.push(ToyWarning::PointerIgnored { field, pointer });
            return false;
        } else if !target.contains_key("node") {
            warnings.push(ToyWarning::ChannelIgnored { field });
            return false;
        }
        true
    });
}

/// The node and the property of a pointer.
fn pointed(pointer: &str) -> Option<(u32, &str)> {
    let (node, path) = pointer.strip_prefix("/nodes/")?.split_once('/')?;
    let is_plain = ["translation", "rotation", "scale", "weights"].contains(&path);
    is_plain.then_some((node.parse().ok()?, path))
}
