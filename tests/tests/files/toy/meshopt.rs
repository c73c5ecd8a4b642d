//! Toys whose buffers are compressed by meshopt are equal to uncompressed ones.
//!
//! The streams that are written out below come from the format's own encoder, meshoptimizer 1.0;
//! those for filters are made here.

#![expect(clippy::cast_possible_truncation, reason = "fractions of one, in few bits")]

use app_core::toy::{Pose, PosedMesh, Toy};
use glam::{DMat4, Vec3};
use serde_json::{Value, json};

use super::FILE;
use super::builder::{Glb, triangle};

/// Positions of the net, version 0.
const POSITIONS_0: &str = "\
    oAAABQ/D8Pz/gID/gID/gIA/D8AA/4CA/4CABTC8Lwt8fXx9fH3C8IAAfH18AAAFAAAMA/+AAMAAAIAFADAAAHwAgAAAAAAFAA88\
    8P///////wA8wAD///8FAA7/f3p7enl8eXx7ADvAAHp7egAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAA";

/// The same, version 1.
const POSITIONS_1: &str = "\
    oVoaWgA454CA/4CA/4CA/5wBgID/gIAFND0PQ3x9fH18fdD0AAB8fXwAAICAEACAASAEfAEAALX//////4AA/wDA73sBe3t6fHp8\
    e+ABewF7ewAAAAAAAAAAAAAAAAAAAAAAAAAAAAEBAQ==";

/// Three hundred elements of four 16-bit integers, in two blocks, version 1.
const RAMPS_1: &str = "\
    obmYqqqqqgqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqq\
    qqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqABUVFRUVFRUVFRUVFRUV\
    FRUVFRUVFRUVFRUVFRUVFRUVFRUVFRUVFRUVFRUVFRUVFRUVFRUVFRUVFRUVFRUVFRUVFRUVFRUVFRUVFRUVFRUVFRUVFRUVFRUV\
    FRUVFRUVFRUVFRUVFRUVFRUVFRUVFRUVFRUVFRUVFRUVFRUVFRUVFRUVFRUVFRUVFRUVFRUVFRUVFRUVFRUVFRUVFRUVFRUVFRUV\
    FRUVFRUVFRUVFRUVFRUVFRUVFRUVFRUVFRUVFRUVFRUVFRUVFRUVFRUVFRUVFRUVFRUVFRUVFRUVFRUVFRUVFRUVFRUVFRUVFRUV\
    FRUVFRUVFRUVFRUVFRUVFVRVVVUBAAIBAAIBAAIBAAIBAAIBAAIBAAIBAAIBAAIBAAIBAAIBAAIBAAIBAAIBAAJVVVVVJmZmZmZm\
    ZmZmZmZmZmZmZmZmZmZmZmZmZmZmZmZmZmZmZmZmZmZmZmZmZmZmZmZmZmZmZmZmZmZmZmZmZmZmZrmZKqqqqqqqqqqqqqqqqqqq\
    qqqqqqqqqqoAABUVFRUVFRUVFRUVFRUVFRUVFRUVFRUVFRUVFRUVFRUVFRUVFRUVFRUVFRUVAAEAAgEAAgEAAhVmZmZmZmZmZmZm\
    ZgAAAAAAAAAAAAAAAAAAAAAAoA8AAAAAAQA=";

/// The net's triangles.
const TRIANGLES: &str = "\
    4f4eEA4QDhAOzh4WDhUOFA7OHhQOFA4UDs4eFA4UDhQODwoAdodWZ3iphmWJaJgBaQAA";

/// Their corners as a sequence.
const SEQUENCE: &str = "\
    0QAEEAAOFBIEEAAOFBIEEAAOFBIEEAAOFA4EEAAOFBIEEAAOFBIEEAAOFBIEEAAOFA4EEAAOFBIEEAAOFBIEEAAOFBIEEAAOFA4E\
    EAAOFBIEEAAOFBIEEAAOFBIEEAAOFAAAAAA=";

const SIDE: u16 = 5;

/// A net of 5 x 5 points.
fn net() -> Vec<Vec3> {
    let point = |x: u16, y: u16| {
        let height = 0.0625 * f32::from(x * y % 3);
        Vec3::new(0.125 * f32::from(x), 0.125 * f32::from(y), height)
    };
    (0..SIDE)
        .flat_map(|y| (0..SIDE).map(move |x| point(x, y)))
        .collect()
}

fn corners() -> Vec<u32> {
    let side = u32::from(SIDE);
    let squares = (0..side - 1).flat_map(|y| (0..side - 1).map(move |x| y * side + x));
    squares
        .flat_map(|a| [a, a + 1, a + side, a + side, a + 1, a + side + 1])
        .collect()
}

/// A view of a compressed stream, which is in a buffer of its own.
fn compressed(glb: &mut Glb, stream: &str, (extension, how): (&str, Value)) -> usize {
    if glb.json["buffers"].is_null() {
        glb.json["buffers"] = json!([{ "byteLength": 0 }, { "byteLength": 0, "extensions": { extension: { "fallback": true } } }]);
    }
    let uri = format!("data:application/octet-stream;base64,{stream}");
    let buffer = glb.push("buffers", json!({ "byteLength": 0, "uri": uri }));
    let n_bytes = stream.trim_end_matches('=').len() * 6 / 8;
    let mut extended = how.clone();
    extended["buffer"] = buffer.into();
    extended["byteLength"] = n_bytes.into();
    let plain = how["count"].as_u64().unwrap() * how["byteStride"].as_u64().unwrap();
    let view = json!({ "buffer": 1, "byteLength": plain, "extensions": { extension: extended } });
    glb.push("bufferViews", view)
}

const EXT: &str = "EXT_meshopt_compression";
const KHR: &str = "KHR_meshopt_compression";

fn compressed_net(extension: &str, positions: &str, indices: (&str, &str)) -> Glb {
    let mut glb = Glb::new();
    let how = json!({ "count": 25, "byteStride": 12, "mode": "ATTRIBUTES", "filter": "NONE" });
    let view = compressed(&mut glb, positions, (extension, how));
    glb.push(
        "accessors",
        json!({ "bufferView": view, "componentType": 5126, "type": "VEC3", "count": 25 }),
    );
    let how = json!({ "count": 96, "byteStride": 2, "mode": indices.0 });
    let view = compressed(&mut glb, indices.1, (extension, how));
    glb.push(
        "accessors",
        json!({ "bufferView": view, "componentType": 5123, "type": "SCALAR", "count": 96 }),
    );
    let mesh = glb.mesh(json!({ "attributes": { "POSITION": 0 }, "indices": 1 }));
    glb.push("nodes", json!({ "mesh": mesh }));
    glb.json["extensionsUsed"] = json!([extension]);
    glb.json["extensionsRequired"] = json!([extension]);
    glb
}

fn posed(toy: &Toy) -> Vec<Vec3> {
    let mut posed = PosedMesh::default();
    toy.pose(&Pose::Authored, &DMat4::IDENTITY, &mut posed).unwrap();
    let corners = toy.indices().iter();
    corners.map(|corner| posed.positions[*corner as usize]).collect()
}

#[test]
fn compressed_buffers_are_those_that_were_compressed() {
    let points = net();
    let expected: Vec<Vec3> = corners().iter().map(|corner| points[*corner as usize]).collect();
    // The codec may rotate the corners of a triangle, but change nothing else.
    let whole = |toy: &Toy| {
        let triangles = posed(toy);
        for (found, expected) in triangles.chunks(3).zip(expected.chunks(3)) {
            let turned = (0..3).any(|by| (0..3).all(|i| found[(i + by) % 3] == expected[i]));
            assert!(turned, "{found:?}, not {expected:?}");
        }
        assert_eq!(triangles.len(), expected.len());
    };
    let triangles = ("TRIANGLES", TRIANGLES);
    for (extension, positions, indices) in [
        (EXT, POSITIONS_0, triangles),
        (KHR, POSITIONS_1, triangles),
        (EXT, POSITIONS_0, ("INDICES", SEQUENCE)),
    ] {
        let toy = Toy::from_glb(FILE, &compressed_net(extension, positions, indices).bytes()).unwrap();
        assert!(toy.warnings().is_empty(), "{:?}", toy.warnings());
        whole(&toy);
    }
}

#[test]
fn blocks_follow_one_another() {
    let mut glb = Glb::new();
    let how = json!({ "count": 300, "byteStride": 8, "mode": "ATTRIBUTES" });
    let view = compressed(&mut glb, RAMPS_1, (KHR, how));
    glb.json["bufferViews"][view]["byteStride"] = 8.into();
    glb.push(
        "accessors",
        json!({ "bufferView": view, "componentType": 5123, "type": "VEC3", "count": 300 }),
    );
    let mesh = glb.mesh(json!({ "attributes": { "POSITION": 0 }, "mode": 5 }));
    glb.push("nodes", json!({ "mesh": mesh }));
    let toy = Toy::from_glb(FILE, &glb.bytes()).unwrap();
    let strip = posed(&toy);
    for (i, triangle) in (0_u16..).zip(strip.chunks(3)) {
        let point = |i: u16| Vec3::new(f32::from(5 * i), f32::from(4000 - 11 * i), f32::from(i / 16));
        let mut expected = [point(i), point(i + 1), point(i + 2)];
        expected.sort_by(|a, b| a.x.total_cmp(&b.x));
        let mut found = triangle.to_vec();
        found.sort_by(|a, b| a.x.total_cmp(&b.x));
        assert_eq!(found, expected, "triangle {i}");
    }
    assert_eq!(strip.len(), 3 * 298);
}

#[test]
fn broken_streams_are_refused() {
    let whole = compressed_net(EXT, POSITIONS_0, ("TRIANGLES", TRIANGLES));
    for view in [0, 1] {
        let place = format!("/bufferViews/{view}/extensions/{EXT}");
        let length = whole.json.pointer(&place).unwrap()["byteLength"]
            .as_u64()
            .unwrap();
        for cut in 0..length {
            let mut glb = whole.clone();
            glb.json.pointer_mut(&place).unwrap()["byteLength"] = cut.into();
            let refused = Toy::from_glb(FILE, &glb.bytes()).unwrap_err().to_string();
            assert!(refused.contains("compressed data is broken"), "{cut}: {refused}");
        }
    }
    for (key, value) in [
        ("count", json!(8)),
        ("byteStride", json!(10)),
        ("mode", json!("LINES")),
        ("filter", json!("NOISE")),
    ] {
        let mut glb = whole.clone();
        glb.json
            .pointer_mut(&format!("/bufferViews/0/extensions/{EXT}"))
            .unwrap()[key] = value;
        let refused = Toy::from_glb(FILE, &glb.bytes()).unwrap_err().to_string();
        assert!(refused.contains("bufferViews[0]"), "{key}: {refused}");
    }
}

/// A stream of version 0 without any compression: each byte's difference in eight bits.
fn plain(elements: &[&[u8]]) -> Vec<u8> {
    let stride = elements[0].len();
    let n_groups = elements.len().div_ceil(16);
    let mut stream = vec![0xa0];
    for byte in 0..stride {
        stream.extend(vec![0xff; n_groups.div_ceil(4)]);
        let mut before = elements[0][byte];
        let mut lane = vec![0; 16 * n_groups];
        for (code, element) in lane.iter_mut().zip(elements) {
            let step = element[byte].wrapping_sub(before);
            *code = (step << 1) ^ (step.cast_signed() >> 7).cast_unsigned();
            before = element[byte];
        }
        stream.extend(lane);
    }
    stream.extend(vec![0; 32_usize.saturating_sub(stride)]);
    stream.extend(elements[0]);
    stream
}

/// A triangle with one attribute replaced by one of filtered elements.
fn filtered(key: &str, filter: &str, accessor: Value, elements: &[&[u8]]) -> Toy {
    let mut glb = triangle();
    let stream = plain(elements);
    let view = glb.view(&stream);
    let extended = json!({ "buffer": 0, "byteOffset": glb.json["bufferViews"][view]["byteOffset"], "byteLength": stream.len(),
        "count": elements.len(), "byteStride": elements[0].len(), "mode": "ATTRIBUTES", "filter": filter });
    glb.json["bufferViews"][view] = json!({ "buffer": 0, "byteLength": elements.len() * elements[0].len(),
        "byteStride": elements[0].len(), "extensions": { KHR: extended } });
    let mut accessor = accessor;
    accessor["bufferView"] = view.into();
    accessor["count"] = elements.len().into();
    let accessor = glb.push("accessors", accessor);
    glb.json["meshes"][0]["primitives"][0]["attributes"][key] = accessor.into();
    Toy::from_glb(FILE, &glb.bytes()).unwrap()
}

#[test]
fn filters_are_undone() {
    // Normals (0, 0, 1), (.6, 0, .8) and (0, -.6, -.8): on the octahedron (.6, 0) / 1.4, and the
    // last one folded over.
    let byte = |value: f32| ((value * 127.0).round() as i8).cast_unsigned();
    let elements = [[0.0, 0.0, 1.0], [0.6 / 1.4, 0.0, 1.0], [1.0, -(1.0 - 0.0), 1.0]]
        .map(|[x, y, one]: [f32; 3]| [byte(x), byte(y), byte(one), 0]);
    let views: Vec<&[u8]> = elements.iter().map(<[u8; 4]>::as_slice).collect();
    let toy = filtered(
        "NORMAL",
        "OCTAHEDRAL",
        json!({ "componentType": 5120, "normalized": true, "type": "VEC3" }),
        &views,
    );
    let mut posed = PosedMesh::default();
    toy.pose(&Pose::Authored, &DMat4::IDENTITY, &mut posed).unwrap();
    // Two eight-bit numbers have an error of half a 127th each.
    let expected = [Vec3::Z, Vec3::new(0.6, 0.0, 0.8), Vec3::NEG_Z];
    for (normal, expected) in posed.normals.iter().zip(expected) {
        assert!(normal.distance(expected) < 0.012, "{normal}, not {expected}");
    }

    // 3 * 2^-2 and -5 * 2^1.
    let number = |mantissa: i32, exponent: i32| ((mantissa & 0xff_ffff) | exponent << 24).to_le_bytes();
    let points = [
        [(3, -2), (0, 0), (0, 0)],
        [(-5, 1), (0, 0), (0, 0)],
        [(0, 0), (1, 3), (7, -3)],
    ];
    let elements = points.map(|point| point.map(|(m, e)| number(m, e)).concat());
    let views: Vec<&[u8]> = elements.iter().map(Vec::as_slice).collect();
    let toy = filtered(
        "POSITION",
        "EXPONENTIAL",
        json!({ "componentType": 5126, "type": "VEC3" }),
        &views,
    );
    toy.pose(&Pose::Authored, &DMat4::IDENTITY, &mut posed).unwrap();
    let expected = [
        Vec3::new(0.75, 0.0, 0.0),
        Vec3::new(-10.0, 0.0, 0.0),
        Vec3::new(0.0, 8.0, 0.875),
    ];
    assert_eq!(posed.positions, expected);

    // Luma .5 without colour; pure green; and half of alpha, each in eight bits, all of which are
    // used.
    let elements: [[u8; 4]; 3] = [[127, 0, 0, 255], [127, 0, 127, 255], [0, 0, 0, 192]];
    let views: Vec<&[u8]> = elements.iter().map(<[u8; 4]>::as_slice).collect();
    let toy = filtered(
        "COLOR_0",
        "COLOR",
        json!({ "componentType": 5121, "normalized": true, "type": "VEC4" }),
        &views,
    );
    let colors = toy.colors_linear().unwrap();
    let expected = [[0.5, 0.5, 0.5, 1.0], [0.0, 1.0, 0.0, 1.0], [0.0, 0.0, 0.0, 0.5]];
    for (color, expected) in colors.iter().zip(expected) {
        let is_near = color
            .iter()
            .zip(expected)
            .all(|(a, b): (&f32, f32)| (a - b).abs() < 0.01);
        assert!(is_near, "{color:?}, not {expected:?}");
    }
}

#[test]
fn a_filtered_rotation_turns_a_node() {
    // A quarter turn about z, as x, y and z: z and w are the largest, and w is left out.
    let part = |value: f64| ((value * 2.0_f64.sqrt() * 32767.0).round() as i16).to_le_bytes();
    // The order after the one that is left out.
    let element = [
        part(0.0),
        part(0.0),
        part(0.5_f64.sqrt()),
        (32764_i16 | 3).to_le_bytes(),
    ]
    .concat();
    let mut glb = triangle();
    let stream = plain(&[&element]);
    let view = glb.view(&stream);
    let extended = json!({ "buffer": 0, "byteOffset": glb.json["bufferViews"][view]["byteOffset"], "byteLength": stream.len(),
        "count": 1, "byteStride": 8, "mode": "ATTRIBUTES", "filter": "QUATERNION" });
    glb.json["bufferViews"][view] = json!({ "buffer": 0, "byteLength": 8, "extensions": { EXT: extended } });
    let accessor =
        json!({ "bufferView": view, "componentType": 5122, "normalized": true, "type": "VEC4", "count": 1 });
    let output = glb.push("accessors", accessor);
    let input = glb.floats("SCALAR", &[0.0]);
    glb.animate("turn", "rotation", "LINEAR", [input, output]);
    let toy = Toy::from_glb(FILE, &glb.bytes()).unwrap();
    let clip = toy.find_clip("turn").unwrap();
    let mut posed = PosedMesh::default();
    let pose = Pose::Clip { clip, time_secs: 0.0 };
    toy.pose(&pose, &DMat4::IDENTITY, &mut posed).unwrap();
    let expected = [Vec3::ZERO, Vec3::Y, Vec3::NEG_X];
    for (position, expected) in posed.positions.iter().zip(expected) {
        assert!(position.distance(expected) < 1e-3, "{position}, not {expected}");
    }
}
