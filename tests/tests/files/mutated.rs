//! No change of a file's bytes makes its reader panic, and every requested pose is finite or
//! refused.

use std::sync::Arc;

use app_core::toy::{NodePose, Pose, Toy, Trs};
use glam::{DMat4, DQuat, DVec3};
use harness::fuzz;
use harness::fuzz::{INDEX, PICTURE, RECORDING, TOY};
use proptest::prelude::*;
use proptest::sample::select;

/// Replacements for a part of a file: other numbers, of any size, and the punctuation of JSON.
const TOKENS: [&str; 20] = [
    "0",
    "-1",
    "1e30",
    "-1e38",
    "1e999",
    "4294967295",
    "18446744073709551615",
    "0.5",
    "null",
    "true",
    "\"\"",
    "[]",
    "{}",
    "[[",
    "}",
    "\"",
    ",",
    ":",
    "\u{0}",
    "nan",
];

/// One change: its position, as a fraction of the file, and the new content.
#[derive(Clone, Debug)]
enum Change {
    Byte(f64, u8),
    Number(f64, [u8; 4]),
    Token(f64, &'static str),
    Cut(f64),
    Repeat(f64, f64),
}

fn changes() -> impl Strategy<Value = Vec<Change>> {
    let at = || 0.0..1.0_f64;
    let extremes = select(vec![
        0.0_f32,
        -1.0,
        1e30,
        f32::MAX,
        f32::NAN,
        f32::INFINITY,
        f32::MIN_POSITIVE,
    ]);
    let change = prop_oneof![
        4 => (at(), any::<u8>()).prop_map(|(at, byte)| Change::Byte(at, byte)),
        4 => (at(), extremes).prop_map(|(at, value)| Change::Number(at, value.to_le_bytes())),
        4 => (at(), select(&TOKENS[..])).prop_map(|(at, token)| Change::Token(at, token)),
        1 => at().prop_map(Change::Cut),
        1 => (at(), at()).prop_map(|(from, to)| Change::Repeat(from, to)),
    ];
    proptest::collection::vec(change, 1..6)
}

/// The bytes after all changes, in sequence.
fn changed(whole: &[u8], changes: &[Change]) -> Vec<u8> {
    let mut bytes = whole.to_vec();
    for change in changes {
        #[expect(clippy::cast_possible_truncation, reason = "a place in a small file")]
        let place = |fraction: &f64| (fraction * bytes.len() as f64) as usize;
        match change {
            Change::Byte(at, byte) => {
                let at = place(at);
                bytes.splice(at..(at + 1).min(bytes.len()), [*byte]);
            }
            Change::Number(at, number) => {
                let at = place(at) / 4 * 4;
                bytes.splice(at..(at + 4).min(bytes.len()), *number);
            }
            Change::Token(at, token) => {
                let from = place(at);
                let is_number = |byte: &u8| byte.is_ascii_digit() || b"+-.e".contains(byte);
                let n = bytes[from..].iter().take_while(|byte| is_number(byte)).count();
                bytes.splice(from..from + n, token.bytes());
            }
            Change::Cut(at) => {
                let at = place(at);
                bytes.truncate(at);
            }
            Change::Repeat(from, to) => {
                let (from, to) = (place(from), place(to));
                let again = bytes[from.min(to)..from.max(to)].to_vec();
                bytes.splice(from..from, again);
            }
        }
    }
    bytes
}

/// The chunks of [`TOY`] as [`fuzz::toy_chunks`] expects them: their lengths are corrected after
/// every change.
fn chunks() -> Vec<u8> {
    let n_json = u32::from_le_bytes(TOY[12..16].try_into().unwrap());
    let json_end = 20 + n_json as usize;
    let n_json = u16::try_from(n_json).unwrap();
    [
        &n_json.to_le_bytes()[..],
        &TOY[20..json_end],
        &TOY[json_end + 8..],
    ]
    .concat()
}

/// Numbers of every size, and NaN and infinities.
fn number() -> impl Strategy<Value = f64> {
    prop_oneof![-2.0..2.0, -1e7..1e7, any::<f64>(), Just(0.0), Just(-0.0)]
}

fn vector() -> impl Strategy<Value = DVec3> {
    [number(), number(), number()].prop_map(DVec3::from_array)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 2000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn a_changed_toy_is_read_or_refused(changes in changes()) {
        fuzz::toy(&changed(TOY, &changes));
        fuzz::toy_chunks(&changed(&chunks(), &changes));
    }

    #[test]
    fn a_changed_toy_of_several_files_is_read_or_refused(changes in changes()) {
        fuzz::packed(&changed(&fuzz::text_of_toy(), &changes));
    }

    #[test]
    fn a_changed_session_is_read_or_refused(changes in changes()) {
        fuzz::capture(&changed(INDEX, &changes));
    }

    #[test]
    fn a_changed_recording_is_read_or_refused(changes in changes()) {
        fuzz::recording(&changed(RECORDING, &changes));
    }

    #[test]
    fn a_changed_picture_is_read_or_refused(changes in changes()) {
        fuzz::picture(&changed(PICTURE, &changes));
    }

    #[test]
    fn a_pose_of_any_numbers_is_finite_or_refused(
        places in [vector(), vector(), vector()],
        scales in [vector(), vector(), vector()],
        turns in proptest::collection::vec(number(), 12),
        weight in number(),
    ) {
        let toy = Toy::from_glb("toy.glb", TOY).unwrap();
        let nodes = ["body", "a", "b"].map(|name| toy.find_node(name).unwrap());
        let parent_from_node = nodes.into_iter().enumerate().map(|(k, node)| {
            let rotation = DQuat::from_slice(&turns[4 * k..]);
            (node, Trs { translation: places[k], rotation, scale: scales[k] })
        });
        let pose = NodePose {
            parent_from_node: parent_from_node.collect(),
            morph_weights: vec![(nodes[0], vec![weight])],
        };
        fuzz::pose(&toy, &Pose::Nodes(Arc::new(pose)), &DMat4::IDENTITY);
    }

    #[test]
    fn a_pose_of_ordinary_numbers_is_never_refused(
        places in proptest::array::uniform3(-1e3..1e3_f64),
        scale in -10.0..10.0_f64,
        weight in -10.0..10.0_f64,
    ) {
        let toy = Toy::from_glb("toy.glb", TOY).unwrap();
        let [body, joint] = ["body", "b"].map(|name| toy.find_node(name).unwrap());
        let trs = Trs {
            translation: DVec3::from_array(places),
            rotation: DQuat::from_rotation_x(places[0]),
            scale: DVec3::splat(scale),
        };
        let pose = NodePose {
            parent_from_node: vec![(joint, trs)],
            morph_weights: vec![(body, vec![weight])],
        };
        prop_assert!(fuzz::pose(&toy, &Pose::Nodes(Arc::new(pose)), &DMat4::IDENTITY));
    }
}

/// A scale whose square is no longer a number of full precision.
#[test]
fn a_toy_that_is_flattened_to_nothing_has_unit_normals() {
    let toy = Toy::from_glb("toy.glb", TOY).unwrap();
    for scale in [1e-150, 1.5597805497951474e-161, 5e-324] {
        let flattened = Trs {
            translation: DVec3::ZERO,
            rotation: DQuat::from_xyzw(0.0, 1.0, 0.0, 1.0),
            scale: DVec3::new(0.0, 0.0, scale),
        };
        let pose = NodePose {
            parent_from_node: ["body", "a", "b"]
                .map(|name| (toy.find_node(name).unwrap(), flattened))
                .into(),
            morph_weights: Vec::new(),
        };
        assert!(
            fuzz::pose(&toy, &Pose::Nodes(Arc::new(pose)), &DMat4::IDENTITY),
            "{scale}"
        );
    }
}

/// The seeds themselves are accepted: mutations of files that are refused anyway would prove
/// nothing.
#[test]
fn the_seeds_are_good() {
    let toy = Toy::from_glb("toy.glb", TOY).unwrap();
    assert!(fuzz::pose(&toy, &Pose::Authored, &DMat4::IDENTITY));
    assert_eq!(toy.clip_names(), ["Wave"]);
    assert!(fuzz::packed(&fuzz::text_of_toy()));
    assert!(!fuzz::packed(b"{}"));
    assert!(fuzz::opens(INDEX, TOY, PICTURE));
    assert!(!fuzz::opens(b"{}", TOY, PICTURE));
    assert!(fuzz::opens_recording(RECORDING));
    assert!(fuzz::opens_recording(&fuzz::without_checksums(RECORDING)));
    assert!(!fuzz::opens_recording(&RECORDING[..RECORDING.len() - 1]));
    // The same file, as written by the format's library in Python: by encoders that the tests do
    // not have.
    for rewritten in [
        &include_bytes!("../../fuzz/seeds/recording/zstd.mcap")[..],
        include_bytes!("../../fuzz/seeds/recording/lz4.mcap"),
        include_bytes!("../../fuzz/seeds/recording/unchunked.mcap"),
    ] {
        assert!(fuzz::opens_recording(rewritten));
        assert!(!fuzz::opens_recording(&rewritten[..rewritten.len() - 1]));
    }
}

/// Control: a pose that is not finite is detected.
#[test]
#[should_panic(expected = "is_finite")]
fn what_is_not_finite_panics() {
    fuzz::check_finite(&[glam::Vec3::ONE, glam::Vec3::NAN]);
}
