//! Slightly wrong files are accepted as toys, and the corrections are reported.

use app_core::toy::{Pose, PosedMesh, Toy, ToyWarning, packed};
use glam::{DMat4, Vec3};
use serde_json::{Value, json};

use super::FILE;
use super::builder::{CORNERS, triangle};
use super::extensions::read;

/// The tree of a triangle, with its bytes in a data URI or elsewhere.
fn tree(uri: &str) -> Value {
    let glb = triangle();
    let mut tree = glb.json.clone();
    tree["buffers"] = json!([{ "byteLength": 72, "uri": uri }]);
    tree
}

/// The same as text: corners, then normals.
const DATA: &str = "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAAAAAAAAAAAAAIA/AAAAAAAAAAAAAIA/AAAAAAAAAAAAAIA/";

fn index(value: &Value) -> usize {
    usize::try_from(value.as_u64().unwrap()).unwrap()
}

fn corners(bytes: &[u8]) -> Vec<Vec3> {
    let toy = Toy::from_glb(FILE, bytes).unwrap();
    let mut posed = PosedMesh::default();
    toy.pose(&Pose::Authored, &DMat4::IDENTITY, &mut posed).unwrap();
    assert!(toy.warnings().is_empty(), "{:?}", toy.warnings());
    posed.positions
}

#[test]
fn json_alone_is_a_toy_with_or_without_marks_and_padding() {
    let expected: Vec<Vec3> = CORNERS
        .as_chunks()
        .0
        .iter()
        .copied()
        .map(Vec3::from_array)
        .collect();
    let text = tree(DATA).to_string();
    for bytes in [
        text.clone(),
        format!("\u{feff}{text}"),
        format!("\n {text}\0\0\0"),
    ] {
        assert_eq!(corners(bytes.as_bytes()), expected);
    }
    // The same as the JSON of a binary file, whose own chunk is another buffer.
    assert_eq!(corners(&measure::glb::container(text.as_bytes(), &[])), expected);
    assert_eq!(
        corners(&measure::glb::container(
            format!("\u{feff}{text}\0").as_bytes(),
            &[]
        )),
        expected
    );
}

#[test]
fn neighbours_are_packed_in() {
    let expected = corners(tree(DATA).to_string().as_bytes());
    let mut json = tree("parts/the%20toy.bin");
    json["images"] = json!([{ "uri": "skin.png" }, { "uri": "missing.png" }]);
    let text = json.to_string();
    let bytes: Vec<u8> = [&CORNERS[..], &[0.0, 0.0, 1.0].repeat(3)]
        .concat()
        .iter()
        .flat_map(|value| value.to_le_bytes())
        .collect();
    let mut asked = Vec::new();
    let mut neighbour = |name: &str| {
        asked.push(name.to_owned());
        match name {
            "parts/the toy.bin" => Ok(bytes.clone()),
            "skin.png" => Ok(vec![1, 2, 3]),
            _ => Err("is not there".to_owned()),
        }
    };
    let whole = packed(FILE, text.as_bytes(), &mut neighbour).unwrap();
    assert_eq!(corners(&whole), expected);
    let (json, bin) = measure::glb::chunks(&whole);
    assert_eq!(json["images"][1]["uri"], "missing.png");
    let view = &json["bufferViews"][index(&json["images"][0]["bufferView"])];
    let at = index(&view["byteOffset"]);
    assert_eq!(bin[at..at + 3], [1, 2, 3]);
    assert_eq!(asked, ["parts/the toy.bin", "skin.png", "missing.png"]);
    // An intact file stays unchanged, and a missing buffer is reported by name.
    let own = triangle().bytes();
    assert_eq!(
        packed(FILE, &own, &mut |_| Err(String::new())).unwrap().as_ref(),
        own
    );
    let refused = packed(FILE, text.as_bytes(), &mut |_| Err("is not there".to_owned()))
        .unwrap_err()
        .to_string();
    assert!(
        refused.contains("buffers[0].uri: parts/the toy.bin: is not there"),
        "{refused}"
    );
}

#[test]
fn a_neighbour_that_is_cut_short_is_not_read_on_into_the_next() {
    let corners: Vec<u8> = CORNERS.iter().flat_map(|value| value.to_le_bytes()).collect();
    let normals: Vec<u8> = [0.0_f32, 0.0, 1.0]
        .repeat(3)
        .iter()
        .flat_map(|value| value.to_le_bytes())
        .collect();
    let mut json = tree("one.bin");
    json["buffers"] = json!([
        { "uri": "one.bin", "byteLength": corners.len() },
        { "uri": "two.bin", "byteLength": normals.len() },
    ]);
    json["bufferViews"] = json!([
        { "buffer": 0, "byteLength": corners.len() },
        { "buffer": 1, "byteLength": normals.len() },
    ]);
    json["accessors"][1]["bufferView"] = 1.into();
    json["accessors"][1]["byteOffset"] = 0.into();
    let pack = |json: &Value, n_cut: usize| {
        let mut neighbour = |name: &str| match name {
            "one.bin" => Ok(corners[..corners.len() - n_cut].to_vec()),
            _ => Ok(normals.clone()),
        };
        packed(FILE, json.to_string().as_bytes(), &mut neighbour)
            .map(|whole| whole.into_owned())
            .map_err(|error| error.to_string())
    };
    assert!(Toy::from_glb(FILE, &pack(&json, 0).unwrap()).is_ok());
    let refused = pack(&json, 4).unwrap_err();
    assert!(
        refused.contains("buffers[0]: reaches to byte 36, but there are 32"),
        "{refused}"
    );
    // A wrong length does not give access to the next file.
    json["buffers"][0]["byteLength"] = 32.into();
    let refused = pack(&json, 4).unwrap_err();
    assert!(
        refused.contains("bufferViews[0]: reaches to byte 36, but there are 32"),
        "{refused}"
    );
}

/// Some exporters write everything into one text.
#[test]
fn data_in_the_text_does_not_count_as_text() {
    let mut json = tree(DATA);
    json["images"] = json!([{ "uri": format!("data:image/png;base64,{}", "A".repeat(17 << 20)) }]);
    assert_eq!(
        corners(json.to_string().as_bytes()),
        corners(tree(DATA).to_string().as_bytes())
    );
    json["images"] = json!([{ "name": "A".repeat(17 << 20) }]);
    let refused = Toy::from_glb(FILE, json.to_string().as_bytes())
        .unwrap_err()
        .to_string();
    assert!(refused.contains("JSON text without its data URIs"), "{refused}");
}

#[test]
fn numbers_that_are_a_little_off_are_mended_and_said() {
    let mut glb = triangle();
    glb.json["materials"] =
        json!([{ "pbrMetallicRoughness": { "baseColorFactor": [1.000_000_1, -0.1, 0.5, 1.5] } }]);
    glb.json["nodes"][0]["rotation"] = json!([0.0, 0.0, 0.0, 0.0]);
    let keys = [
        glb.floats("SCALAR", &[0.0, 1.0]),
        glb.floats("VEC4", &[0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0]),
    ];
    glb.animate("turn", "rotation", "LINEAR", keys);
    glb.animate("turn", "rotation", "LINEAR", keys);
    let toy = read(&glb);
    assert_eq!(toy.materials()[0].base_color_linear, [1.0, 0.0, 0.5, 1.0]);
    let mut posed = PosedMesh::default();
    let clip = toy.find_clip("turn").unwrap();
    toy.pose(&Pose::Clip { clip, time_secs: 1.0 }, &DMat4::IDENTITY, &mut posed)
        .unwrap();
    assert!(
        posed.positions[1].distance(Vec3::NEG_X) < 1e-6,
        "{}",
        posed.positions[1]
    );
    let repaired = |field: &str| ToyWarning::RotationsRepaired {
        field: field.to_owned(),
        n: 1,
    };
    let expected = [
        repaired("nodes[0].rotation"),
        repaired("animations[0].channels[0]"),
        repaired("animations[1].channels[0]"),
        ToyWarning::ClipsAlike {
            name: "turn".to_owned(),
            first: 0,
            second: 1,
        },
        ToyWarning::FactorClamped {
            field: "materials[0].pbrMetallicRoughness.baseColorFactor".to_owned(),
        },
    ];
    assert_eq!(toy.warnings(), expected);
}

#[test]
fn an_animated_matrix_is_taken_apart() {
    let mut glb = triangle();
    // Twice as large, and at (0, 0, 3).
    glb.json["nodes"][0]["matrix"] = json!([2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0, 0, 0, 3, 1]);
    let keys = [glb.floats("SCALAR", &[0.0]), glb.floats("VEC3", &[5.0, 0.0, 0.0])];
    glb.animate("move", "translation", "STEP", keys);
    let toy = read(&glb);
    let clip = toy.find_clip("move").unwrap();
    let mut posed = PosedMesh::default();
    toy.pose(&Pose::Clip { clip, time_secs: 0.0 }, &DMat4::IDENTITY, &mut posed)
        .unwrap();
    assert_eq!(posed.positions[1], Vec3::new(7.0, 0.0, 0.0));
    toy.pose(&Pose::Authored, &DMat4::IDENTITY, &mut posed).unwrap();
    assert_eq!(posed.positions[1], Vec3::new(2.0, 0.0, 3.0));
    assert!(
        matches!(toy.warnings(), [ToyWarning::MatrixDecomposed { .. }]),
        "{:?}",
        toy.warnings()
    );
}

/// A tetrahedron whose clip has these scales along x, one key for each picture of 24 a second.
fn tetrahedron_scaled_by(scales: &[f32]) -> Toy {
    let mut glb = triangle();
    let corner = |axis: usize| {
        let mut at = [0.0; 3];
        at[axis] = 1.0;
        at
    };
    let places = [[0.0; 3], corner(0), corner(1), corner(2)].concat();
    let position = glb.floats("VEC3", &places);
    let indices = glb.u16s("SCALAR", &[0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3]);
    glb.json["meshes"][0]["primitives"][0] =
        json!({ "attributes": { "POSITION": position }, "indices": indices });
    let times: Vec<f32> = (0_u16..)
        .zip(scales)
        .map(|(key, _)| f32::from(key) / 24.0)
        .collect();
    let values: Vec<f32> = scales.iter().flat_map(|scale| [*scale, 1.0, 1.0]).collect();
    let keys = [glb.floats("SCALAR", &times), glb.floats("VEC3", &values)];
    glb.animate("flip", "scale", "LINEAR", keys);
    read(&glb)
}

#[test]
fn a_part_that_a_clip_mirrors_is_seen_from_both_sides() {
    let closed = |scales: &[f32]| {
        let toy = tetrahedron_scaled_by(scales);
        (toy.shadow_indices().n_closed, toy.warnings().len())
    };
    assert_eq!((closed(&[1.0, 0.5]), closed(&[1.0, -1.0])), ((12, 0), (0, 1)));
    // A minute with a key for each picture, in one of which the part is mirrored: each of them.
    for key in [0, 1, 700, 701, 702, 703, 1439] {
        let mut scales = [1.0; 1440];
        scales[key] = -1.0;
        assert_eq!(closed(&scales), (0, 1), "key {key}");
    }
}
