//! Extensions: supported, or refused and reported by name.

use std::f32::consts::FRAC_PI_2;
use std::io::Cursor;

use app_core::toy::{Pose, PosedMesh, Toy, ToyWarning};
use glam::{DMat4, Vec2, Vec3};
use serde_json::{Value, json};

use super::FILE;
use super::builder::{Glb, triangle};

pub(super) fn read(glb: &Glb) -> Toy {
    Toy::from_glb(FILE, &glb.bytes()).unwrap()
}

fn places(toy: &Toy) -> Vec<Vec3> {
    let mut posed = PosedMesh::default();
    toy.pose(&Pose::Authored, &DMat4::IDENTITY, &mut posed).unwrap();
    posed.positions
}

const PIXELS: [[u8; 4]; 2] = [[200, 10, 30, 255], [0, 128, 255, 255]];

fn picture(format: image::ImageFormat) -> Vec<u8> {
    let image = image::RgbaImage::from_vec(2, 1, PIXELS.concat()).unwrap();
    let mut bytes = Cursor::new(Vec::new());
    image.write_to(&mut bytes, format).unwrap();
    bytes.into_inner()
}

/// A triangle with texture coordinates and a texture.
pub(super) fn textured(picture: &[u8], uvs: &[f32]) -> Glb {
    let mut glb = triangle();
    let uvs = glb.floats("VEC2", uvs);
    glb.json["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_0"] = uvs.into();
    glb.json["meshes"][0]["primitives"][0]["material"] = 0.into();
    let view = glb.view(picture);
    glb.json["images"] = json!([{ "bufferView": view }]);
    glb.json["textures"] = json!([{ "source": 0 }]);
    let base_color = json!({ "baseColorTexture": { "index": 0 } });
    glb.json["materials"] = json!([{ "pbrMetallicRoughness": base_color }]);
    glb
}

const UVS: [f32; 6] = [0.0, 0.0, 1.0, 0.0, 0.0, 1.0];

#[test]
fn texture_coordinates_are_transformed() {
    let mut glb = textured(&picture(image::ImageFormat::Png), &[9.0; 6]);
    let second = glb.floats("VEC2", &UVS);
    glb.json["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_1"] = second.into();
    // The extension's own example: the lower left quadrant, turned clockwise.
    let transform =
        json!({ "offset": [0.0, 1.0], "rotation": FRAC_PI_2, "scale": [0.5, 0.5], "texCoord": 1 });
    glb.json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]["extensions"] =
        json!({ "KHR_texture_transform": transform });
    glb.json["extensionsUsed"] = json!(["KHR_texture_transform"]);
    glb.json["extensionsRequired"] = json!(["KHR_texture_transform"]);
    let toy = read(&glb);
    assert!(toy.warnings().is_empty(), "{:?}", toy.warnings());
    for (uv, expected) in toy.uvs().iter().zip([[0.0, 1.0], [0.0, 0.5], [0.5, 1.0]]) {
        let apart = Vec2::from(*uv).distance(Vec2::from(expected));
        assert!(apart < 1e-6, "{uv:?}, not {expected:?}");
    }
    let place = "/materials/0/pbrMetallicRoughness/baseColorTexture/extensions/KHR_texture_transform/scale";
    *glb.json.pointer_mut(place).unwrap() = json!([1e30, 1.0]);
    let refused = Toy::from_glb(FILE, &glb.bytes()).unwrap_err().to_string();
    assert!(
        refused.contains("TEXCOORD_1") && refused.contains("is not from"),
        "{refused}"
    );
}

#[test]
fn webp_is_a_texture_with_and_without_another_source() {
    for with_source in [true, false] {
        let mut glb = textured(&picture(image::ImageFormat::Png), &UVS);
        let webp = glb.view(&picture(image::ImageFormat::WebP));
        let other = image::RgbaImage::from_pixel(1, 1, image::Rgba([9; 4]));
        let mut bytes = Cursor::new(Vec::new());
        other.write_to(&mut bytes, image::ImageFormat::Png).unwrap();
        let other = glb.view(&bytes.into_inner());
        glb.json["images"] =
            json!([{ "bufferView": other }, { "bufferView": webp, "mimeType": "image/webp" }]);
        let mut texture = json!({ "extensions": { "EXT_texture_webp": { "source": 1 } } });
        if with_source {
            texture["source"] = 0.into();
        }
        glb.json["textures"] = json!([texture]);
        glb.json["extensionsRequired"] = json!(["EXT_texture_webp"]);
        let toy = read(&glb);
        assert!(toy.warnings().is_empty(), "{:?}", toy.warnings());
        assert_eq!(toy.textures()[0].rgba8_srgb, PIXELS.concat());
    }
}

#[test]
fn the_diffuse_colour_is_the_base_colour() {
    let mut glb = textured(&picture(image::ImageFormat::Png), &UVS);
    let glossy = json!({ "diffuseFactor": [0.5, 0.25, 1.0, 1.0], "diffuseTexture": { "index": 0 } });
    glb.json["materials"] = json!([{ "extensions": { "KHR_materials_pbrSpecularGlossiness": glossy } }]);
    glb.json["extensionsRequired"] = json!(["KHR_materials_pbrSpecularGlossiness"]);
    let toy = read(&glb);
    assert_eq!(toy.materials()[0].base_color_linear, [0.5, 0.25, 1.0, 1.0]);
    assert!(toy.materials()[0].base_color_texture.is_some() && toy.warnings().is_empty());
}

#[test]
fn every_instance_is_there() {
    let mut glb = triangle();
    let translations = glb.floats("VEC3", &[0.0, 0.0, 5.0, 0.0, 0.0, 7.0]);
    let scales = glb.floats("VEC3", &[1.0, 1.0, 1.0, 2.0, 2.0, 2.0]);
    glb.json["nodes"][0]["translation"] = json!([10.0, 0.0, 0.0]);
    let attributes = json!({ "TRANSLATION": translations, "SCALE": scales });
    glb.json["nodes"][0]["extensions"] = json!({ "EXT_mesh_gpu_instancing": { "attributes": attributes } });
    glb.json["extensionsRequired"] = json!(["EXT_mesh_gpu_instancing"]);
    let place = |x: f32, y: f32, z: f32| Vec3::new(x, y, z);
    let expected = [
        place(10.0, 0.0, 5.0),
        place(11.0, 0.0, 5.0),
        place(10.0, 1.0, 5.0),
        place(10.0, 0.0, 7.0),
        place(12.0, 0.0, 7.0),
        place(10.0, 2.0, 7.0),
    ];
    assert_eq!(places(&read(&glb)), expected);
    glb.json["accessors"][translations]["count"] = 1.into();
    let refused = Toy::from_glb(FILE, &glb.bytes()).unwrap_err().to_string();
    assert!(refused.contains("EXT_mesh_gpu_instancing"), "{refused}");
}

#[test]
fn hidden_nodes_hide_what_is_below() {
    let mut glb = triangle();
    glb.push(
        "nodes",
        json!({ "mesh": 0, "children": [2], "extensions": { "KHR_node_visibility": { "visible": false } } }),
    );
    glb.push("nodes", json!({ "mesh": 0 }));
    glb.json["scenes"][0]["nodes"] = json!([0, 1]);
    assert_eq!(read(&glb).n_vertices(), 3);
    glb.json["nodes"][1]["extensions"]["KHR_node_visibility"]["visible"] = true.into();
    assert_eq!(read(&glb).n_vertices(), 9);
}

#[test]
fn what_is_required_and_not_followed_is_refused_with_the_way_out() {
    let required = |name: &str, words: &[&str]| {
        let mut glb = triangle();
        glb.json["extensionsRequired"] = json!([name]);
        let refused = Toy::from_glb(FILE, &glb.bytes()).unwrap_err().to_string();
        for word in [name].iter().chain(words) {
            assert!(refused.contains(word), "no {word:?} in {refused}");
        }
    };
    required("KHR_draco_mesh_compression", &["Blender"]);
    required("KHR_texture_basisu", &["ktxdecompress"]);
    required("KHR_materials_transmission", &["export"]);
    required("ACME_spikes", &["export"]);
    // The extension is not required, but the corners exist nowhere else.
    let mut glb = triangle();
    let draco = json!({ "KHR_draco_mesh_compression": { "bufferView": 0, "attributes": { "POSITION": 0 } } });
    glb.json["meshes"][0]["primitives"][0]["extensions"] = draco;
    read(&glb);
    glb.json["accessors"][0]
        .as_object_mut()
        .unwrap()
        .remove("bufferView");
    let refused = Toy::from_glb(FILE, &glb.bytes()).unwrap_err().to_string();
    assert!(refused.contains("KHR_draco_mesh_compression"), "{refused}");
    // A texture in an unsupported format is replaced by plain white, with a warning.
    let mut glb = textured(&picture(image::ImageFormat::Png), &UVS);
    glb.json["textures"] = json!([{ "extensions": { "KHR_texture_basisu": { "source": 0 } } }]);
    let toy = read(&glb);
    let is_said = |warning: &ToyWarning| warning.to_string().contains("ktxdecompress");
    assert!(toy.warnings().iter().any(is_said), "{:?}", toy.warnings());
    assert_eq!(toy.materials()[0].base_color_texture, None);
    glb.json["textures"][0]["source"] = 0.into();
    assert!(read(&glb).materials()[0].base_color_texture.is_some());
}

#[test]
fn pictures_that_are_not_read_say_what_they_are() {
    let mut avif = b"\0\0\0\x20ftypavif".to_vec();
    avif.resize(64, 0);
    let mut heic = avif.clone();
    heic[8..12].copy_from_slice(b"heic");
    // A directory with one tag, the version of DNG.
    let dng = [&b"II*\0\x08\0\0\0\x01\0"[..], &50706_u16.to_le_bytes(), &[0; 32]].concat();
    for (bytes, name) in [
        (avif, "AVIF"),
        (heic, "HEIC"),
        (dng, "DNG"),
        (b"\xabKTX 20\xbb".to_vec(), "KTX2"),
    ] {
        let toy = read(&textured(&bytes, &UVS));
        let said: Vec<String> = toy.warnings().iter().map(ToString::to_string).collect();
        assert!(
            said.iter()
                .any(|said| said.contains(name) && said.contains("PNG")),
            "{name}: {said:?}"
        );
    }
}

#[test]
fn channels_by_pointer_move_nodes_and_others_are_left_out() {
    let mut glb = triangle();
    let keys = [glb.floats("SCALAR", &[0.0]), glb.floats("VEC3", &[0.0, 3.0, 0.0])];
    glb.animate("move", "translation", "STEP", keys);
    let pointer =
        |to: &str| json!({ "path": "pointer", "extensions": { "KHR_animation_pointer": { "pointer": to } } });
    let channels: Vec<Value> = [
        pointer("/nodes/0/translation"),
        pointer("/materials/0/alphaCutoff"),
        json!({ "path": "translation" }),
    ]
    .map(|target| json!({ "sampler": 0, "target": target }))
    .to_vec();
    glb.json["animations"][0]["channels"] = channels.into();
    let toy = read(&glb);
    let mut posed = PosedMesh::default();
    let clip = toy.find_clip("move").unwrap();
    let pose = Pose::Clip { clip, time_secs: 0.0 };
    toy.pose(&pose, &DMat4::IDENTITY, &mut posed).unwrap();
    assert_eq!(posed.positions[0], Vec3::new(0.0, 3.0, 0.0));
    let field = |channel: u32| format!("animations[0].channels[{channel}]");
    let expected = [
        ToyWarning::PointerIgnored {
            field: field(1),
            pointer: "/materials/0/alphaCutoff".to_owned(),
        },
        ToyWarning::ChannelIgnored { field: field(2) },
    ];
    assert_eq!(toy.warnings(), expected);
}
