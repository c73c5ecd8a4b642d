//! Alpha cut-outs are cut out of the triangles: the remaining area is where alpha is, and nothing
//! else.

#![expect(clippy::cast_possible_truncation, reason = "alpha is from 0 to 255")]

use std::collections::HashMap;
use std::f32::consts::PI;
use std::io::Cursor;

use app_core::toy::{Toy, ToyWarning};
use glam::Vec2;
use serde_json::json;

use super::builder::Glb;
use super::extensions::read;

const SIDE_PX: u32 = 64;

/// A picture of a ring with a border as soft as a texel.
fn ring() -> Vec<u8> {
    let picture = image::RgbaImage::from_fn(SIDE_PX, SIDE_PX, |x, y| {
        image::Rgba([
            40,
            90,
            30,
            (255.0 * ring_alpha(Vec2::new(x as f32, y as f32) + 0.5)).round() as u8,
        ])
    });
    let mut bytes = Cursor::new(Vec::new());
    picture.write_to(&mut bytes, image::ImageFormat::Png).unwrap();
    bytes.into_inner()
}

const RADII_PX: [f32; 2] = [12.0, 26.0];

fn ring_alpha(at_px: Vec2) -> f32 {
    let radius = at_px.distance(Vec2::splat(SIDE_PX as f32 / 2.0));
    let inside = (radius - RADII_PX[0]).min(RADII_PX[1] - radius);
    (inside + 0.5).clamp(0.0, 1.0)
}

/// A square card of two triangles, which shows the picture `n` times along each side.
fn card(n: f32, has_normals: bool, material: serde_json::Value) -> Glb {
    let mut glb = Glb::new();
    let position = glb.floats(
        "VEC3",
        &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 1.0, 0.0],
    );
    let uv = glb.floats("VEC2", &[0.0, n, n, n, n, 0.0, 0.0, 0.0]);
    let indices = glb.u16s("SCALAR", &[0, 1, 2, 0, 2, 3]);
    let mut attributes = json!({ "POSITION": position, "TEXCOORD_0": uv });
    if has_normals {
        attributes["NORMAL"] = glb.floats("VEC3", &[0.0, 0.0, 1.0].repeat(4)).into();
    }
    let mesh = glb.mesh(json!({ "attributes": attributes, "indices": indices, "material": 0 }));
    glb.push("nodes", json!({ "mesh": mesh }));
    let view = glb.view(&ring());
    glb.json["images"] = json!([{ "bufferView": view }]);
    glb.json["textures"] = json!([{ "source": 0 }]);
    let base = json!({ "baseColorTexture": { "index": 0 } });
    glb.json["materials"] = json!([{ "pbrMetallicRoughness": base }]);
    for (key, value) in material.as_object().unwrap() {
        glb.json["materials"][0][key] = value.clone();
    }
    glb
}

/// Triangles in texture coordinates, in texels.
fn triangles(toy: &Toy) -> Vec<[Vec2; 3]> {
    let corners = toy.indices().as_chunks().0.iter();
    corners
        .map(|corners: &[u32; 3]| {
            corners.map(|corner| Vec2::from(toy.uvs()[corner as usize]) * SIDE_PX as f32)
        })
        .collect()
}

fn area([a, b, c]: [Vec2; 3]) -> f32 {
    0.5 * (b - a).perp_dot(c - a)
}

fn holds(triangle: [Vec2; 3], point: Vec2) -> bool {
    let [a, b, c] = triangle;
    let sides = [(a, b), (b, c), (c, a)].map(|(from, to)| (to - from).perp_dot(point - from));
    sides.iter().all(|side| *side >= 0.0) || sides.iter().all(|side| *side <= 0.0)
}

#[test]
fn what_is_left_is_where_alpha_is() {
    for has_normals in [true, false] {
        let toy = read(&card(1.0, has_normals, json!({ "alphaMode": "MASK" })));
        assert!(toy.warnings().is_empty(), "{:?}", toy.warnings());
        let triangles = triangles(&toy);
        let mut n_seen = [0; 2];
        for step in 0..1600_u16 {
            let at_px = Vec2::new(f32::from(step % 40), f32::from(step / 40)) * 1.6 + 0.37;
            let radius = at_px.distance(Vec2::splat(32.0));
            // The picture is smooth within half a texel there.
            if RADII_PX.iter().any(|border| (radius - border).abs() < 0.5) {
                continue;
            }
            let is_there = triangles.iter().any(|triangle| holds(*triangle, at_px));
            let is_ring = (RADII_PX[0]..RADII_PX[1]).contains(&radius);
            assert_eq!(is_there, is_ring, "at {at_px}");
            n_seen[usize::from(is_ring)] += 1;
        }
        assert!(n_seen.iter().all(|n| *n > 400), "{n_seen:?}");
        let found: f32 = triangles.iter().map(|triangle| area(*triangle).abs()).sum();
        let expected = PI * (RADII_PX[1].powi(2) - RADII_PX[0].powi(2));
        assert!((found / expected - 1.0).abs() < 0.005, "{found}, not {expected}");
        assert!(triangles.len() < 3000, "{}", triangles.len());
    }
}

#[test]
fn no_gap_opens_between_triangles() {
    let toy = read(&card(2.0, true, json!({ "alphaMode": "MASK" })));
    let mut uses: HashMap<[u32; 2], i32> = HashMap::new();
    for [a, b, c] in toy.indices().as_chunks().0 {
        for (from, to) in [(a, b), (b, c), (c, a)] {
            *uses.entry([*from.min(to), *from.max(to)]).or_default() += 1;
        }
    }
    let place = |vertex: u32| Vec2::from(toy.uvs()[vertex as usize]) * SIDE_PX as f32;
    let mut n_borders = 0;
    for (edge, n) in uses {
        assert!(n <= 2, "{edge:?}");
        if n == 1 {
            n_borders += 1;
            for at_px in edge.map(place) {
                let radius = at_px.rem_euclid(Vec2::splat(64.0)).distance(Vec2::splat(32.0));
                let is_border = RADII_PX.iter().any(|border| (radius - border).abs() < 0.5);
                assert!(is_border, "an open edge at {at_px}");
            }
        }
    }
    assert!(n_borders > 400, "{n_borders}");
}

#[test]
fn blend_is_cut_at_a_half_and_said() {
    let masked = read(&card(
        1.0,
        true,
        json!({ "alphaMode": "MASK", "alphaCutoff": 0.5 }),
    ));
    let blended = read(&card(1.0, true, json!({ "alphaMode": "BLEND" })));
    assert_eq!(
        (masked.indices(), masked.uvs()),
        (blended.indices(), blended.uvs())
    );
    assert!(
        matches!(blended.warnings(), [ToyWarning::BlendCut { .. }]),
        "{:?}",
        blended.warnings()
    );
    // A toy of glass alone is drawn whole.
    let glass = json!({ "baseColorFactor": [1.0, 1.0, 1.0, 0.3] });
    let glass = read(&card(
        1.0,
        true,
        json!({ "alphaMode": "BLEND", "pbrMetallicRoughness": glass }),
    ));
    assert_eq!(glass.indices().len(), 6);
    let whole = |toy: &Toy| matches!(toy.warnings(), [ToyWarning::BlendWhole { .. }]);
    assert!(whole(&glass), "{:?}", glass.warnings());
    // A blended material without transparent parts is drawn whole, too, and an opaque one needs no
    // blending.
    for (alpha, is_said) in [(0.7, true), (1.0, false)] {
        let factor = json!({ "baseColorFactor": [1.0, 1.0, 1.0, alpha] });
        let toy = read(&card(
            1.0,
            true,
            json!({ "alphaMode": "BLEND", "pbrMetallicRoughness": factor }),
        ));
        assert_eq!(toy.indices().len(), 6);
        assert_eq!(whole(&toy), is_said, "{alpha}: {:?}", toy.warnings());
        assert_eq!(toy.warnings().is_empty(), !is_said);
    }
}

/// A clip may enlarge a part that is small or absent at rest; the largest size of a part counts.
#[test]
fn a_part_that_is_small_at_rest_is_cut_as_finely() {
    let material = json!({ "alphaMode": "MASK" });
    let n_triangles = |scales: &[f64]| {
        let mut glb = card(1.0, true, material.clone());
        glb.json["nodes"] = json!([]);
        for scale in scales {
            glb.push("nodes", json!({ "mesh": 0, "scale": [scale, scale, scale] }));
        }
        let nodes: Vec<usize> = (0..scales.len()).collect();
        glb.json["scenes"] = json!([{ "nodes": nodes }]);
        read(&glb).indices().len() / 3 / scales.len()
    };
    let expected = n_triangles(&[1.0]);
    assert!(expected > 500, "{expected}");
    assert_eq!(n_triangles(&[0.0, 1.0]), expected);
    assert_eq!(n_triangles(&[0.001, 1.0]), expected);
    assert_eq!(n_triangles(&[1.0, 0.001]), expected);
    assert_eq!(n_triangles(&[0.0]), expected);
}

#[test]
fn what_has_too_many_triangles_to_be_cut_is_said() {
    const SIDE: u16 = 229;
    let mut glb = card(
        1.0,
        true,
        json!({ "alphaMode": "MASK", "pbrMetallicRoughness": {} }),
    );
    let mut places = Vec::new();
    let mut colors = Vec::new();
    for y in 0..=SIDE {
        for x in 0..=SIDE {
            places.extend([f32::from(x), f32::from(y), 0.0]);
            colors.extend([1.0, 1.0, 1.0, f32::from(u8::from(x + y > 0))]);
        }
    }
    let mut indices = Vec::new();
    for y in 0..SIDE {
        for x in 0..SIDE {
            let [a, b] = [y, y + 1].map(|y| y * (SIDE + 1) + x);
            indices.extend([a, a + 1, b + 1, a, b + 1, b]);
        }
    }
    let attributes =
        json!({ "POSITION": glb.floats("VEC3", &places), "COLOR_0": glb.floats("VEC4", &colors) });
    let indices = glb.u16s("SCALAR", &indices);
    glb.json["meshes"][0]["primitives"][0] =
        json!({ "attributes": attributes, "indices": indices, "material": 0 });
    let toy = read(&glb);
    assert_eq!(toy.indices().len() / 3, 2 * usize::from(SIDE).pow(2));
    assert!(
        matches!(toy.warnings(), [ToyWarning::NotCut { .. }]),
        "{:?}",
        toy.warnings()
    );
}

#[test]
fn nothing_is_cut_without_a_cut_out() {
    for material in [
        json!({}),
        json!({ "alphaMode": "OPAQUE", "alphaCutoff": 0.9 }),
        json!({ "alphaMode": "MASK", "alphaCutoff": 0.0 }),
    ] {
        assert_eq!(read(&card(1.0, true, material)).indices(), [0, 1, 2, 0, 2, 3]);
    }
}

#[test]
fn alpha_of_vertices_is_cut_straight() {
    let mut glb = card(
        1.0,
        true,
        json!({ "alphaMode": "MASK", "pbrMetallicRoughness": {} }),
    );
    let colors = [[1.0, 1.0, 1.0, 0.0], [1.0; 4], [1.0; 4], [1.0, 1.0, 1.0, 0.0]].concat();
    let colors = glb.floats("VEC4", &colors);
    glb.json["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] = colors.into();
    let toy = read(&glb);
    let left: f32 = triangles(&toy).iter().map(|triangle| area(*triangle).abs()).sum();
    assert!((left / (SIDE_PX as f32).powi(2) - 0.5).abs() < 1e-6, "{left}");
    assert_eq!(toy.indices().len(), 9);
}

#[test]
fn a_fine_picture_is_cut_as_fine_as_may_be() {
    let toy = read(&card(40.0, true, json!({ "alphaMode": "MASK" })));
    assert!(
        matches!(toy.warnings(), [ToyWarning::CutCoarse { .. }]),
        "{:?}",
        toy.warnings()
    );
    let n_triangles = toy.indices().len() / 3;
    assert!((10_000..=100_000).contains(&n_triangles), "{n_triangles}");
}
