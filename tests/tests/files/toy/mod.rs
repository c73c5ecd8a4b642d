//! Toys compared with closed forms: the positions of vertices, the look of the toy, and the refused
//! files.

pub(crate) mod builder;
mod casters;
mod cut;
mod extensions;
mod hard;
mod mended;
mod meshopt;
mod out_of_range;
mod poses;
mod refusals;
mod shadow;
mod wrong_files;

use std::f64::consts::FRAC_PI_2;
use std::sync::Arc;

use app_core::toy::{NodePose, Pose, PosedMesh, Toy, ToyError, ToyWarning, Trs, Wrap};
use glam::{DMat4, DQuat, DVec3, Vec3};
use serde_json::json;

use builder::{Glb, skinned, triangle};
use poses::{Case, cases, turning};

const FILE: &str = "bad.glb";

/// Largest error of a position or normal of size one: a few 32-bit roundings.
const TOLERANCE: f32 = 1e-6;

#[test]
fn vertices_stand_where_the_closed_form_says() {
    let turn = DQuat::from_axis_angle(DVec3::new(1.0, 2.0, 3.0).normalize(), 1.0);
    let shift = DVec3::new(0.3, -0.2, 0.1);
    let anchors = [
        DMat4::IDENTITY,
        DMat4::from_scale_rotation_translation(DVec3::splat(0.01), turn, shift),
    ];
    let mut posed = PosedMesh::default();
    for case in &cases() {
        let toy =
            Toy::from_glb(FILE, &case.glb.bytes()).unwrap_or_else(|error| panic!("{}: {error}", case.name));
        let pose = case
            .moment
            .map_or(Pose::Authored, |(clip, time_secs)| Pose::Clip {
                clip: toy.find_clip(clip).unwrap(),
                time_secs,
            });
        assert_eq!(toy.indices(), case.indices, "{}", case.name);
        for anchor_from_object in &anchors {
            toy.pose(&pose, anchor_from_object, &mut posed).unwrap();
            check_vertices(case, anchor_from_object, &posed);
        }
        check_winding(case, &posed);
        let bounds = toy.bounds_of_pose(&pose).unwrap();
        let points = || case.expected.iter().map(|(point, _)| Vec3::from_array(*point));
        let (min, max) = (
            points().reduce(Vec3::min).unwrap(),
            points().reduce(Vec3::max).unwrap(),
        );
        assert!((bounds.min - min).length() < TOLERANCE && (bounds.max - max).length() < TOLERANCE);
    }
}

fn check_vertices(case: &Case, anchor_from_object: &DMat4, posed: &PosedMesh) {
    assert_eq!(posed.positions.len(), case.expected.len(), "{}", case.name);
    for (vertex, (position, normal)) in case.expected.iter().enumerate() {
        let position = anchor_from_object.transform_point3(Vec3::from_array(*position).as_dvec3());
        let normal = anchor_from_object.transform_vector3(Vec3::from_array(*normal).as_dvec3());
        let off = posed.positions[vertex].distance(position.as_vec3());
        assert!(off < TOLERANCE, "{}: vertex {vertex} is {off} away", case.name);
        let off = posed.normals[vertex].distance(normal.normalize().as_vec3());
        assert!(off < TOLERANCE, "{}: normal {vertex} is {off} away", case.name);
    }
}

/// Triangles with an area are counter-clockwise when seen against their normals.
fn check_winding(case: &Case, posed: &PosedMesh) {
    for triangle in case.indices.chunks(3) {
        let [a, b, c] = [0, 1, 2].map(|i| posed.positions[triangle[i] as usize]);
        let out = (b - a).cross(c - a).dot(posed.normals[triangle[0] as usize]);
        assert!(out > 0.0 || case.name == "flattened", "{}: inside out", case.name);
    }
}

/// Two pixels, (200, 10, 30) and (0, 128, 255).
const PNG: &str =
    "iVBORw0KGgoAAAANSUhEUgAAAAIAAAABCAIAAAB7QOjdAAAAD0lEQVR42mM4wSXH0PAfAAdgAnASTWIEAAAAAElFTkSuQmCC";

#[test]
fn looks_are_read_per_part() {
    let mut glb = triangle();
    let uv = glb.floats("VEC2", &[0.25, 0.75].repeat(3));
    let attributes = glb.json["meshes"][0]["primitives"][0]["attributes"].clone();
    let mut textured = json!({ "attributes": attributes, "material": 1 });
    textured["attributes"]["TEXCOORD_1"] = uv.into();
    let colors = glb.u8s("VEC3", true, &[255, 0, 51].repeat(3));
    let mut colored = json!({ "attributes": attributes });
    colored["attributes"]["COLOR_0"] = colors.into();
    let points = json!({ "attributes": attributes, "mode": 0 });
    glb.json["meshes"][0]["primitives"] = json!([textured, points, colored]);
    let base_color = json!({ "baseColorFactor": [0.5, 0.25, 1.0, 1.0],
        "baseColorTexture": { "index": 0, "texCoord": 1 } });
    glb.json["materials"] = json!([{}, { "pbrMetallicRoughness": base_color, "doubleSided": true }]);
    glb.json["textures"] = json!([{ "source": 0, "sampler": 0 }]);
    glb.json["samplers"] = json!([{ "wrapS": 33071, "wrapT": 33648 }]);
    glb.json["images"] = json!([{ "uri": format!("data:image/png;base64,{PNG}") }]);

    let toy = Toy::from_glb(FILE, &glb.bytes()).unwrap();
    let [first, second] = toy.parts() else {
        panic!("{:?}", toy.parts())
    };
    assert_eq!((first.material, first.indices.clone()), (1, 0..3));
    assert_eq!((second.material, second.indices.clone()), (2, 3..6));
    let material = &toy.materials()[1];
    assert_eq!(material.base_color_linear, [0.5, 0.25, 1.0, 1.0]);
    assert!(material.double_sided && !toy.materials()[2].double_sided);
    assert_eq!(toy.materials()[2].base_color_linear, [1.0; 4]);
    let texture = material.base_color_texture.unwrap();
    assert_eq!(
        (texture.wrap_u, texture.wrap_v),
        (Wrap::ClampToEdge, Wrap::MirroredRepeat)
    );
    let picture = &toy.textures()[texture.texture];
    assert_eq!((picture.width_px, picture.height_px), (2, 1));
    assert_eq!(picture.rgba8_srgb, [200, 10, 30, 255, 0, 128, 255, 255]);
    assert_eq!(toy.uvs()[..3], [[0.25, 0.75]; 3]);
    let colors = toy.colors_linear().unwrap();
    assert_eq!((colors[0], colors[5]), ([1.0; 4], [1.0, 0.0, 0.2, 1.0]));
    let skipped = ToyWarning::PrimitiveSkipped {
        field: "meshes[0].primitives[1]".to_owned(),
    };
    assert_eq!(toy.warnings(), [skipped]);

    glb.json["images"] = json!([{ "uri": "skin.png" }]);
    let plain = Toy::from_glb(FILE, &glb.bytes()).unwrap();
    assert_eq!(plain.materials()[1].base_color_texture, None);
    assert!(plain.warnings().contains(&ToyWarning::ImageOutside {
        field: "images[0]".to_owned(),
        name: "skin.png".to_owned(),
    }));
}

#[test]
fn broken_files_are_refused_with_field_and_reason() {
    for refusal in refusals::refusals() {
        let error = Toy::from_glb(FILE, &refusal.bytes)
            .expect_err(refusal.name)
            .to_string();
        for word in [FILE].iter().chain(&refusal.words) {
            assert!(error.contains(word), "{}: no {word:?} in {error:?}", refusal.name);
        }
    }
    // No prefix of a file is read beyond its end.
    let whole = triangle().bytes();
    for n_bytes in 0..whole.len() {
        Toy::from_glb(FILE, &whole[..n_bytes]).unwrap_err();
    }
}

#[test]
fn a_clip_that_cannot_be_read_is_refused_once_it_is_asked_for() {
    for broken in refusals::broken_clips() {
        let toy = Toy::from_glb(FILE, &broken.bytes).expect(broken.name);
        let said: String = toy.warnings().iter().map(ToString::to_string).collect();
        let refused = toy.find_clip("move").expect_err(broken.name).to_string();
        for word in &broken.words {
            let is_said = said.contains(word) && refused.contains(word);
            assert!(is_said, "{}: no {word:?} in {said:?}, {refused:?}", broken.name);
        }
    }
}

#[test]
fn clips_are_found_and_times_brought_into_them() {
    let mut glb = triangle();
    let keys = [
        glb.floats("SCALAR", &[0.0, 2.0]),
        glb.floats("VEC3", &[0.0, 0.0, 0.0, 4.0, 0.0, 0.0]),
    ];
    glb.animate("walk", "translation", "LINEAR", keys);
    // From x = 0 back to x = 0, through x = 1 half-way.
    let mut arc = [0.0; 18];
    [arc[6], arc[9]] = [4.0, -4.0];
    let keys = [glb.floats("SCALAR", &[0.0, 1.0]), glb.floats("VEC3", &arc)];
    glb.animate("nameless", "translation", "CUBICSPLINE", keys);
    glb.json["animations"][1].as_object_mut().unwrap().remove("name");
    let toy = Toy::from_glb(FILE, &glb.bytes()).unwrap();
    let [walk, run] = ["walk", "#1"].map(|name| toy.find_clip(name).unwrap());
    assert_eq!(
        (walk.index(), run.index(), toy.clips()[1].duration_secs),
        (0, 1, 1.0)
    );
    assert_eq!(
        toy.find_clip("fly").unwrap_err().to_string(),
        "bad.glb: clip: none is called \"fly\"; it has walk, #1"
    );
    assert_eq!(toy.clamp_time(walk, 1.5).unwrap(), (1.5, false));
    assert_eq!(toy.clamp_time(walk, 2.5).unwrap(), (2.0, true));
    for time_secs in [-0.1, f64::NAN, f64::INFINITY] {
        assert!(matches!(
            toy.clamp_time(walk, time_secs),
            Err(ToyError::Time { .. })
        ));
    }
    let bounds = toy.bounds_over_clip(run).unwrap();
    assert_eq!((bounds.min, bounds.max), (Vec3::ZERO, Vec3::new(2.0, 1.0, 0.0)));

    let still = Toy::from_glb("still.glb", &triangle().bytes()).unwrap();
    let moment = Pose::Clip {
        clip: run,
        time_secs: 0.0,
    };
    let error = still.pose(&moment, &DMat4::IDENTITY, &mut PosedMesh::default());
    assert!(matches!(
        error,
        Err(ToyError::ForeignClip {
            clip: 1,
            n_clips: 0,
            ..
        })
    ));
    let far = DMat4::from_scale(DVec3::splat(1e39));
    let error = still.pose(&Pose::Authored, &far, &mut PosedMesh::default());
    assert!(matches!(error, Err(ToyError::PoseOverflow { vertex: 1, .. })));
}

/// A clip's moment and the same transforms, given by name, are one pose.
#[test]
fn a_pose_can_be_given_by_its_nodes() {
    let toy = Toy::from_glb(FILE, &turning().bytes()).unwrap();
    let moment = |time_secs| Pose::Clip {
        clip: toy.find_clip("move").unwrap(),
        time_secs,
    };
    let arm = toy.find_node("arm").unwrap();
    let authored = toy.authored_transform(arm).unwrap().unwrap();
    let turned = Trs {
        // A quaternion of any length.
        rotation: DQuat::from_rotation_z(FRAC_PI_2) * 3.0,
        ..authored
    };
    let by_node = |trs| {
        let parent_from_node = vec![(arm, trs)];
        Pose::Nodes(Arc::new(NodePose {
            parent_from_node,
            ..NodePose::default()
        }))
    };
    let posed = |pose: &Pose| {
        let mut posed = PosedMesh::default();
        toy.pose(pose, &DMat4::IDENTITY, &mut posed).map(|()| posed)
    };
    let (by_clip, by_name) = (posed(&moment(1.0)).unwrap(), posed(&by_node(turned)).unwrap());
    for (a, b) in by_clip.positions.iter().zip(&by_name.positions) {
        assert!((a - b).length() < TOLERANCE, "{a} and {b}");
    }
    assert_ne!(by_name, posed(&Pose::Authored).unwrap());
    assert_eq!(
        posed(&by_node(authored)).unwrap(),
        posed(&Pose::Authored).unwrap()
    );

    let refused = |trs| posed(&by_node(trs)).unwrap_err().to_string();
    let nowhere = Trs {
        translation: DVec3::NAN,
        ..authored
    };
    let unturned = Trs {
        rotation: DQuat::from_xyzw(0.0, 0.0, 0.0, 0.0),
        ..authored
    };
    assert!(refused(nowhere).contains("not finite"));
    assert!(refused(unturned).contains("no quaternion"));
    let weights = Pose::Nodes(Arc::new(NodePose {
        morph_weights: vec![(arm, vec![0.5])],
        ..NodePose::default()
    }));
    assert!(posed(&weights).unwrap_err().to_string().contains("morph weights"));
    assert!(
        toy.find_node("leg")
            .unwrap_err()
            .to_string()
            .contains("\"leg\"; it has arm")
    );
}

#[test]
fn repaired_weights_are_counted_once() {
    let joints = |glb: &mut Glb| glb.u16s("VEC4", &[0; 12]);
    let weights = |glb: &mut Glb| {
        glb.floats(
            "VEC4",
            &[1.0, 0.0, 0.0, 0.0, 2.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
        )
    };
    let toy = Toy::from_glb(FILE, &skinned(joints, weights).bytes()).unwrap();
    assert_eq!(toy.warnings(), [ToyWarning::WeightsRepaired { n_vertices: 2 }]);
}
