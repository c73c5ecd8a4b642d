//! Untrusted bytes for every reader: nothing may panic, and accepted values are finite.
//!
//! Fuzzing (`tests/fuzz`) and property tests (`tests/tests/files/mutated.rs`) call the same
//! functions.

use std::sync::Arc;

use app_core::recording::Recording;
use app_core::session::{Capture, FileError, Files, GroundTruth, Session, check_path};
use app_core::toy::{Pose, PosedMesh, Toy};
use glam::{DMat4, Vec3};
use serde_json::json;

use desk::check::wrong_of_picture;
use desk::import;
use desk::import::Format;
use measure::glb::{chunks, container};

/// A `capture.json` of pictures of 2 x 2 pixels whose toy is [`TOY`].
pub const INDEX: &[u8] = include_bytes!("../fuzz/seeds/capture/good.json");
/// A triangle with a clip, a skin and a morph target.
pub const TOY: &[u8] = include_bytes!("../fuzz/seeds/toy/skinned.glb");
/// A picture of 2 x 2 pixels, colours and alpha.
pub const PICTURE: &[u8] = include_bytes!("../fuzz/seeds/picture/good.png");

/// A recording of a session of these files, finished.
pub const RECORDING: &[u8] = include_bytes!("../fuzz/seeds/recording/good.mcap");

/// Pictures beside the imported texts.
const IMPORTED: [&str; 8] = [
    "images/1.png",
    "rgb/000002.png",
    "images/a.png",
    "images/b.jpg",
    "rgbd/0.jpg",
    "rgbd/1.jpg",
    "rgb/000000.jpg",
    "rgb/000001.jpg",
];

/// Number of a session's frames that are checked.
const MAX_FRAMES: usize = 4;
/// Limit for the size of a small session's file.
const MAX_FILE_BYTES: u64 = 1 << 20;

/// Reads a toy's file and poses it.
///
/// # Panics
/// When an accepted toy has an accepted pose that is not finite.
pub fn toy(bytes: &[u8]) {
    if let Ok(toy) = Toy::from_glb("fuzzed.glb", bytes) {
        check_toy(&toy);
    }
}

/// The same for a file built from its two chunks: two bytes with the first one's length, then both.
///
/// # Panics
/// As [`toy`].
pub fn toy_chunks(bytes: &[u8]) {
    toy(&glb_from_chunks(bytes));
}

/// Packs a glTF with this text and external files, and reads the toy; returns whether that
/// succeeded. Every external file has the bytes of [`TOY`].
///
/// # Panics
/// As [`toy`].
pub fn packed(bytes: &[u8]) -> bool {
    let (_, bin) = chunks(TOY);
    let whole = app_core::toy::packed("fuzzed.gltf", bytes, &mut |_| Ok(bin.to_vec()));
    let toy = whole.and_then(|whole| Toy::from_glb("fuzzed.gltf", &whole));
    toy.is_ok_and(|toy| {
        check_toy(&toy);
        true
    })
}

/// The text of [`TOY`] with its bytes and a picture as external files.
#[must_use]
pub fn text_of_toy() -> Vec<u8> {
    let (mut json, _) = chunks(TOY);
    json["buffers"][0]["uri"] = "toy.bin".into();
    json["images"] = json!([{ "uri": "skin.png" }]);
    json.to_string().into_bytes()
}

/// Opens a session whose `capture.json` has these bytes, and reads its frames.
///
/// # Panics
/// When an accepted session holds a number that is not finite.
pub fn capture(bytes: &[u8]) {
    session(bytes, TOY, PICTURE);
}

/// Decodes a picture and a mask of 2 x 2 pixels, and reads their tags.
///
/// # Panics
/// When an accepted picture has another size.
pub fn picture(bytes: &[u8]) {
    let _ = wrong_of_picture(bytes);
    session(INDEX, TOY, bytes);
}

/// Reads another program's recording: a byte for the format, the first file, and after a zero the
/// second. Binary files of COLMAP are split in the middle, since they contain zeros; a mesh is one
/// file.
///
/// # Panics
/// When accepted data is not finite.
pub fn import(bytes: &[u8]) {
    const FORMATS: [Format; 5] = [
        Format::Nerfstudio,
        Format::Record3d,
        Format::StrayScanner,
        Format::Colmap,
        Format::Bop,
    ];
    let Some((format, files)) = bytes.split_first() else {
        return;
    };
    let paths = IMPORTED.map(str::to_owned);
    let format = usize::from(*format) % (FORMATS.len() + 2);
    let imported = match FORMATS.get(format) {
        Some(format) => {
            let end = files.iter().position(|byte| *byte == 0).unwrap_or(files.len());
            let (first, second) = files.split_at(end);
            import::parse(*format, [first, second.get(1..).unwrap_or_default()], &paths)
        }
        None if format == FORMATS.len() => {
            let (first, second) = files.split_at(files.len() / 2);
            import::parse(Format::Colmap, [first, second], &paths)
        }
        None => {
            if let Ok(glb) = import::glb_of_ply(files, &|_| None) {
                toy(&glb);
            }
            return;
        }
    };
    for frame in imported.into_iter().flat_map(|imported| imported.frames) {
        assert!(frame.recorded_from_camera.is_finite());
        assert!(frame.intrinsics.iter().all(|number| number.is_finite()));
        assert!(frame.time_s.is_none_or(f64::is_finite));
    }
}

/// Opens a recording of these bytes, and its session; then once more without its checksums, which
/// would reject most changes.
///
/// # Panics
/// When an accepted session holds a number that is not finite.
pub fn recording(bytes: &[u8]) {
    recorded(bytes.to_vec());
    recorded(without_checksums(bytes));
}

/// Whether a recording can be opened without losses, and every frame of its session can be read.
#[must_use]
pub fn opens_recording(bytes: &[u8]) -> bool {
    let is_whole = |recording: &Recording| recording.losses().is_empty();
    let recording = Recording::open(bytes.to_vec()).ok().filter(is_whole);
    recording
        .and_then(|recording| Capture::open(recording).ok())
        .is_some_and(|capture| (0..capture.n_frames()).all(|index| capture.frame(index).is_ok()))
}

fn recorded(bytes: Vec<u8>) {
    let Ok(recording) = Recording::open(bytes) else {
        return;
    };
    for path in recording.paths() {
        let _ = recording.read(path, MAX_FILE_BYTES);
    }
    if let Ok(capture) = Capture::open(recording) {
        check_capture(&capture);
    }
}

/// A recording whose chunks and attached files have the checksum zero, which means none.
#[must_use]
pub fn without_checksums(bytes: &[u8]) -> Vec<u8> {
    const CHUNK: u8 = 6;
    const ATTACHMENT: u8 = 9;
    let mut bytes = bytes.to_vec();
    let mut at = 8;
    while let Some((opcode, length)) = bytes
        .get(at..)
        .and_then(|rest| rest.split_first())
        .and_then(|(opcode, rest)| Some((*opcode, u64::from_le_bytes(*rest.first_chunk()?))))
    {
        let body = at + 9;
        let end = usize::try_from(length)
            .ok()
            .and_then(|length| body.checked_add(length))
            .unwrap_or(usize::MAX);
        let checksum = match opcode {
            CHUNK => body + 24..body + 28,
            ATTACHMENT if end > 4 => end - 4..end,
            _ => 0..0,
        };
        if let Some(checksum) = bytes.get_mut(checksum) {
            checksum.fill(0);
        }
        at = end;
    }
    bytes
}

/// Whether a session of these three files can be opened, and every frame read.
#[must_use]
pub fn opens(index: &[u8], toy: &[u8], picture: &[u8]) -> bool {
    open(index, toy, picture)
        .is_some_and(|capture| (0..capture.n_frames()).all(|index| capture.frame(index).is_ok()))
}

fn open(index: &[u8], toy: &[u8], picture: &[u8]) -> Option<Capture> {
    let files = Memory {
        index: index.into(),
        toy: toy.into(),
        picture: picture.into(),
    };
    Capture::open(files).ok()
}

fn session(index: &[u8], toy: &[u8], picture: &[u8]) {
    if let Some(capture) = open(index, toy, picture) {
        check_capture(&capture);
    }
}

fn check_capture(capture: &Capture) {
    let scene = capture.scene();
    assert!(scene.world_from_object.is_finite());
    for index in 0..capture.n_frames().min(MAX_FRAMES) {
        if let Ok(frame) = capture.frame(index) {
            assert!(frame.world_from_object.is_finite() && frame.camera.world_from_camera.is_finite());
            let n_bytes = 4 * frame.image.width_px as usize * frame.image.height_px as usize;
            assert_eq!(frame.image.rgba8.len(), n_bytes);
            pose(&scene.toy, &frame.shown_pose, &frame.world_from_object);
        }
        if let Ok(Some(truth)) = capture.truth(index) {
            assert_eq!(truth.image.rgba8.len(), truth.mask.rgba8.len());
        }
    }
}

/// Poses a toy as authored and at moments of each clip, and computes its bounds.
///
/// # Panics
/// When an accepted pose is not finite.
pub fn check_toy(toy: &Toy) {
    let _ = toy.bounds_of_pose(&Pose::Authored);
    pose(toy, &Pose::Authored, &DMat4::IDENTITY);
    for caster in toy.casters() {
        assert!(caster.error.is_finite());
        assert!(
            caster
                .indices
                .iter()
                .all(|index| (*index as usize) < toy.n_vertices())
        );
    }
    for name in toy.clip_names().iter().take(4) {
        let Ok(clip) = toy.find_clip(name) else { continue };
        let end_secs = toy.clips()[clip.index()].duration_secs;
        for fraction in [0.0, 0.3, 1.0] {
            let time_secs = fraction * end_secs;
            pose(toy, &Pose::Clip { clip, time_secs }, &DMat4::IDENTITY);
        }
    }
}

/// Poses a toy; returns whether that succeeded.
///
/// # Panics
/// When an accepted pose is not finite, or has a normal of another length than 1.
pub fn pose(toy: &Toy, pose: &Pose, anchor_from_object: &DMat4) -> bool {
    let mut posed = PosedMesh::default();
    if toy.pose(pose, anchor_from_object, &mut posed).is_err() {
        return false;
    }
    check_finite(&posed.positions);
    assert!(posed.normals.iter().all(|normal| normal.is_normalized()));
    assert_eq!(posed.positions.len(), toy.n_vertices());
    assert!(
        toy.indices()
            .iter()
            .all(|index| (*index as usize) < toy.n_vertices())
    );
    true
}

/// Checks that all positions are finite.
///
/// # Panics
/// When one is not.
pub fn check_finite(positions: &[Vec3]) {
    assert!(positions.iter().all(|position| position.is_finite()));
}

fn glb_from_chunks(bytes: &[u8]) -> Vec<u8> {
    let (length, chunks) = bytes.split_first_chunk().unwrap_or((&[0; 2], &[]));
    let n_json = usize::from(u16::from_le_bytes(*length)).min(chunks.len());
    let (json, bin) = chunks.split_at(n_json);
    container(json, bin)
}

/// A session of three files.
struct Memory {
    index: Arc<[u8]>,
    toy: Arc<[u8]>,
    picture: Arc<[u8]>,
}

impl Files for Memory {
    fn read(&self, path: &str, max_bytes: u64) -> Result<Vec<u8>, FileError> {
        check_path(path)?;
        let bytes = match path.rsplit_once('.') {
            Some((_, "json")) => &self.index,
            Some((_, "glb")) => &self.toy,
            Some((_, "png" | "jpg")) => &self.picture,
            _ => return Err(FileError::Missing),
        };
        if bytes.len() as u64 > max_bytes {
            return Err(FileError::TooLarge { max_bytes });
        }
        Ok(bytes.to_vec())
    }
}
