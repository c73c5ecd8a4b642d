//! Maps of frames and the mesh of the place in recordings: each kind is counted and named apart from
//! pictures, in the chunk of its frame.

use std::collections::BTreeMap;
use std::fs;

use app_core::depth::Depth;
use app_core::people::People;
use app_core::place_mesh::PlaceMesh;
use app_core::recording::{
    Ending, Item, Limits, LiveFrame, Loss, Maps, Picture, PictureCodec, Recording, RecordingJob,
    RecordingOptions, WriteError, Writer,
};
use app_core::scene::FieldError;
use app_core::session::{Capture, Files, Session};
use desk::convert::write;
use desk::files::BUNDLED_SESSION;
use desk::stored::Stored;
use glam::{UVec2, Vec3};
use harness::bundled_session;
use harness::temporary::Temporary;

use crate::recording::small::{CHUNK, open, records};

/// Depths of the shape of the bundled session's pictures.
fn depth(first_mm: u16) -> Depth {
    let depths: Vec<u16> = (0..64 * 36).map(|index| first_mm + index % 7).collect();
    Depth::new(UVec2::new(64, 36), depths).unwrap()
}

/// A mask of the shape of the bundled session's pictures.
fn people(first: u32) -> People {
    let codes: Vec<u8> = (0..32 * 18)
        .map(|index| if index < first { 255 } else { 0 })
        .collect();
    People::new(UVec2::new(32, 18), codes).unwrap()
}

fn mesh() -> PlaceMesh {
    let points = [Vec3::ZERO, Vec3::X, Vec3::Z, Vec3::new(0.5, 0.02, 0.5)];
    PlaceMesh::new(points, [[0, 2, 1], [1, 2, 3]], Some(0.002)).unwrap()
}

/// Four frames: the second repeats the first one's picture, the third has neither depths nor people,
/// and the last has no people.
fn recorded() -> Vec<u8> {
    let session = bundled_session();
    let scene = session.scene().clone().with_place_mesh(Some(mesh()));
    let frame = session.frame(0).unwrap();
    let live = LiveFrame {
        image: frame.image.clone().into(),
        camera: frame.camera,
        world_from_object: frame.world_from_object,
        exposure: 1.0,
        light_estimate: None,
        depth: Some(depth(300)),
        people: Some(people(40)),
        shown_pose: frame.shown_pose,
        world_from_shown: None,
    };
    let other = LiveFrame {
        image: session.scene().plates[0].image.clone().into(),
        depth: None,
        people: None,
        ..live.clone()
    };
    let last = LiveFrame {
        depth: Some(depth(500)),
        people: None,
        ..live.clone()
    };
    let (sender, job) = RecordingJob::new(1, scene, live.camera.intrinsics);
    for (time_ns, frame) in [(0, live.clone()), (1, live), (2, other), (3, last)] {
        sender.offer(time_ns, Item::Live(Box::new(frame))).unwrap();
    }
    drop(sender);
    let toy = fs::read(format!("{BUNDLED_SESSION}/toy.glb")).unwrap();
    let options = RecordingOptions {
        toy: &toy,
        codec: PictureCodec::PHONE,
        device: BTreeMap::new(),
        limits: Limits::APP,
    };
    let mut sink = Vec::new();
    let outcome = job.run(&mut sink, options);
    assert_eq!((outcome.n_frames, outcome.ending), (4, Ending::Asked));
    sink
}

/// Depths and people of a frame.
type Told = (Option<Vec<u16>>, Option<Vec<u8>>);

fn told(capture: &Capture) -> Vec<Told> {
    let frames = (0..capture.n_frames()).map(|index| capture.frame(index).unwrap());
    let maps = frames.map(|frame| {
        let depths = frame.depth.map(|depth| depth.depths_mm().to_vec());
        (depths, frame.people.map(|people| people.codes().to_vec()))
    });
    maps.collect()
}

/// The corners of its triangles, which are not shared once it was read.
fn corners(mesh: &PlaceMesh) -> Vec<[Vec3; 3]> {
    let point = |index: u32| mesh.points()[index as usize];
    mesh.triangles()
        .iter()
        .map(|corners| corners.map(point))
        .collect()
}

#[test]
fn maps_and_mesh_come_back_also_by_a_folder() {
    let folder = Temporary::new("recorded-maps");
    let [path, unpacked, again] = ["a.mcap", "folder", "b.mcap"].map(|name| folder.0.join(name));
    fs::write(&path, recorded()).unwrap();
    write(&Stored::open(&path).unwrap(), None, &unpacked).unwrap();
    write(&Stored::open(&unpacked).unwrap(), None, &again).unwrap();
    let [near, far] = [300, 500].map(|mm| Some(depth(mm).depths_mm().to_vec()));
    for path in [&path, &unpacked, &again] {
        let capture = Capture::open(Stored::open(path).unwrap()).unwrap();
        capture.check_pictures(0..4).unwrap();
        let first = (near.clone(), Some(people(40).codes().to_vec()));
        let expected = [first.clone(), first, (None, None), (far.clone(), None)];
        assert_eq!(told(&capture), expected);
        let read = capture.scene().place_mesh.as_ref().unwrap();
        assert_eq!(read.deviation_m(), Some(0.002));
        assert_eq!(corners(read), corners(&mesh()));
    }
    let stored = Stored::open(&path).unwrap();
    let paths = stored.paths().unwrap();
    let of =
        |folder: &str| -> Vec<&String> { paths.iter().filter(|path| path.starts_with(folder)).collect() };
    assert_eq!(of("depths/"), ["depths/000000.png", "depths/000001.png"]);
    assert_eq!(of("people/"), ["people/000000.png"]);
}

/// Recorders attached maps like any other file before these had channels.
fn is_read_if_attached(key: &str) {
    let mut writer = Writer::new(Vec::new(), "{}", BTreeMap::new(), Limits::default()).unwrap();
    writer.file(0, "map.png", b"map").unwrap();
    let entry = format!(r#"{{"image":"a.png","{key}":"map.png"}}"#);
    writer.frame(0, Picture::New(b"picture"), &entry).unwrap();
    let (bytes, _) = writer.finish().unwrap();
    let recording = open(&bytes).unwrap();
    assert_eq!((recording.n_frames(), recording.losses().len()), (1, 0));
    assert_eq!(recording.read("map.png", 100).unwrap(), b"map");
}

#[test]
fn attached_depths_are_read() {
    is_read_if_attached("depth");
}

#[test]
fn attached_people_are_read() {
    is_read_if_attached("people");
}

/// A frame with a map, its repetition a chunk later, and no frame whose map is that of one without.
fn is_told_if_lost(maps: impl Fn(Picture<'static>) -> Maps<Picture<'static>>, key: &str) {
    let entry = |image: &str| format!(r#"{{"image":"{image}","{key}":"a-map.png"}}"#);
    let mut writer = Writer::new(Vec::new(), "{}", BTreeMap::new(), Limits::default()).unwrap();
    let [picture, map] = [b"picture", b"a  map "].map(|bytes| Picture::New(bytes));
    let numbers = maps(map).map(|_| 0);
    let written = writer.frame_with_maps(0, picture, maps(map), &entry("a.png"));
    assert_eq!(written.unwrap(), (0, numbers));
    let again = maps(Picture::Again(0));
    let written = writer.frame_with_maps(2_000_000_000, picture, again, &entry("b.png"));
    assert_eq!(written.unwrap(), (1, numbers));
    let missing = maps(Picture::Again(1));
    let missing = writer.frame_with_maps(3_000_000_000, picture, missing, &entry("c.png"));
    assert_eq!(missing, Err(WriteError::NoSuchPicture { sequence: 1 }));
    let (bytes, _) = writer.finish().unwrap();
    let whole = open(&bytes).unwrap();
    assert_eq!((whole.n_frames(), whole.losses()), (2, &[][..]));
    assert_eq!(whole.read("a-map.png", 100).unwrap(), b"a  map ");
    assert_eq!(whole.read("b.png", 100).unwrap(), b"picture");

    let mut damaged = bytes.clone();
    let (_, first) = records(&bytes)
        .into_iter()
        .find(|(kind, _)| *kind == CHUNK)
        .unwrap();
    damaged[first.end - 20] ^= 1;
    let left: Recording = open(&damaged).unwrap();
    assert_eq!(left.n_frames(), 0, "{:?}", left.losses());
    let lost = left
        .losses()
        .iter()
        .any(|loss| matches!(loss, Loss::Pictures { n_frames: 1 }));
    assert!(lost, "{:?}", left.losses());
}

#[test]
fn a_frame_whose_depths_are_lost_is_left_out_and_told() {
    let maps = |depth| Maps {
        depth: Some(depth),
        people: None,
    };
    is_told_if_lost(maps, "depth");
}

#[test]
fn a_frame_whose_people_are_lost_is_left_out_and_told() {
    let maps = |people| Maps {
        depth: None,
        people: Some(people),
    };
    is_told_if_lost(maps, "people");
}

#[test]
fn a_mesh_without_points_or_triangles_is_empty() {
    let empty = [
        PlaceMesh::new([], [[0, 1, 2]], None),
        PlaceMesh::new([Vec3::ZERO, Vec3::X, Vec3::Z], [], None),
    ];
    for made in empty {
        assert_eq!(made.err(), Some(FieldError::Empty));
    }
}
