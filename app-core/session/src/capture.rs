//! Reads `shadow-capture` folders, version 1: `capture.json`, a glTF binary and pictures.

mod convert;
mod field;
mod light_estimate;
mod light_probe;
mod place;
pub mod record;
#[cfg(feature = "schema")]
mod rules;
#[cfg(feature = "schema")]
mod schema;
mod uncertainty;
mod written;

use std::collections::HashSet;
use std::ops::Range;
use std::sync::{Arc, Mutex, PoisonError};

use glam::DMat4;
use serde::Deserialize;

use self::field::{LENS, WHOLE_FILE, at, frame_field, in_index, read_named};
use self::record::{CaptureRecord, FORMAT, Header, VERSION};
use super::error::{PictureError, SessionError, SessionErrorKind};
use super::files::{Files, INDEX_FILE, MAX_INDEX_BYTES};
use super::picture::{
    PictureSize, check_depth, check_head, check_people, decode_depth, decode_mask, decode_people,
    decode_photo,
};
use super::tags::exif_orientation;
use super::{GroundTruth, Session, SessionFrame, SessionWarning, Truth};
use app_scene::depth::Depth;
use app_scene::lens::{Distortion, Lens};
use app_scene::people::People;
use app_scene::scene::{Camera, Image, Intrinsics, LightEstimate, Pose, Scene};

pub use convert::{toy_bytes, toy_neighbours};
#[cfg(feature = "schema")]
pub use schema::schema;
pub use written::ScenePaths;

/// The byte order mark of UTF-8.
const BYTE_ORDER_MARK: &[u8] = b"\xef\xbb\xbf";

/// A `shadow-capture` folder.
///
/// Opening checks all of `capture.json` and reads the toy, the plates and the pictures of a probe.
/// The frames' pictures are read on demand.
pub struct Capture {
    store: PictureStore,
    scene: Scene,
    warnings: Vec<SessionWarning>,
    frames: Vec<Frame>,
    /// The last frame's picture: a still camera repeats one picture many times.
    last_picture: Mutex<Option<(FrameKey, Photo)>>,
    /// The last frame's depths, and its mask of people.
    last_depth: Mutex<Option<(String, Depth)>>,
    last_people: Mutex<Option<(String, People)>>,
}

/// A picture, and the camera whose distortion is removed from it.
type FrameKey = (String, Option<Lens>);

/// A photograph, with its file's orientation tag.
#[derive(Clone)]
struct Photo {
    /// The photograph without distortion.
    image: Arc<Image>,
    /// The photograph as taken.
    as_taken: Arc<Image>,
    orientation: u8,
}

impl Photo {
    /// The warning about it, if any, for the field that names it.
    fn warning(&self, file: &str, field: &str) -> Option<SessionWarning> {
        (self.orientation != 1).then(|| SessionWarning::Turned {
            file: file.to_owned(),
            field: field.to_owned(),
            orientation: self.orientation,
        })
    }
}

/// A frame whose picture is not read yet.
struct Frame {
    time_secs: f64,
    picture: String,
    camera: Camera,
    world_from_object: DMat4,
    exposure: f64,
    light_estimate: Option<LightEstimate>,
    /// File of its depth picture.
    depth: Option<String>,
    /// File of its mask of people.
    people: Option<String>,
    shown_pose: Pose,
    world_from_shown: Option<DMat4>,
    warnings: Vec<SessionWarning>,
    truth: Option<TruthFiles>,
}

struct TruthFiles {
    picture: String,
    mask: String,
}

impl Capture {
    /// Opens the capture that `files` reads from.
    ///
    /// # Errors
    /// When `capture.json`, the toy, a plate or a picture of the probe is missing, damaged or breaks a
    /// rule of the format. The error names the file, the field and the reason.
    pub fn open(files: impl Files + 'static) -> Result<Self, SessionError> {
        let record = read_index(&files)?;
        let distortion = convert::distortion(&record)?;
        convert::capture_from_record(Box::new(files), record, distortion)
    }

    /// Opens the capture with the given lens, or as a pinhole's, whatever its index states.
    ///
    /// # Errors
    /// As [`Self::open`], and if the lens folds a picture.
    pub fn open_with_lens(
        files: impl Files + 'static,
        distortion: Option<Distortion>,
    ) -> Result<Self, SessionError> {
        let record = read_index(&files)?;
        convert::capture_from_record(Box::new(files), record, distortion)
    }

    fn frame_at(&self, index: usize) -> Result<&Frame, SessionError> {
        let n_frames = self.frames.len();
        self.frames.get(index).ok_or_else(|| {
            in_index(
                &frame_field(index, ""),
                SessionErrorKind::NoSuchFrame { n_frames },
            )
        })
    }

    fn frame_picture(&self, index: usize) -> Result<(&Frame, Photo), SessionError> {
        let frame = self.frame_at(index)?;
        let path = &frame.picture;
        let key = (path.clone(), self.store.lens(&frame.camera.intrinsics)?);
        let mut last = self.last_picture.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((_, photo)) = last.as_ref().filter(|(of_last, _)| *of_last == key) {
            return Ok((frame, photo.clone()));
        }
        let field = frame_field(index, ".image");
        let photo = self.store.photo(path, &field, &frame.camera.intrinsics)?;
        *last = Some((key, photo.clone()));
        Ok((frame, photo))
    }

    /// A picture of a frame that is in a file of its own, decoded once for frames that repeat it.
    fn beside<T: Clone>(
        &self,
        (path, field): (Option<&String>, &str),
        last: &Mutex<Option<(String, T)>>,
        decode: impl Fn(&[u8], PictureSize) -> Result<T, PictureError>,
    ) -> Result<Option<T>, SessionError> {
        let Some(path) = path else {
            return Ok(None);
        };
        let mut last = last.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((_, decoded)) = last.as_ref().filter(|(of_last, _)| of_last == path) {
            return Ok(Some(decoded.clone()));
        }
        let decoded = self.store.read(path, field, decode)?;
        *last = Some((path.clone(), decoded.clone()));
        Ok(Some(decoded))
    }

    fn depth(&self, index: usize, frame: &Frame) -> Result<Option<Depth>, SessionError> {
        let field = frame_field(index, ".depth");
        self.beside((frame.depth.as_ref(), &field), &self.last_depth, decode_depth)
    }

    fn people(&self, index: usize, frame: &Frame) -> Result<Option<People>, SessionError> {
        let field = frame_field(index, ".people");
        self.beside((frame.people.as_ref(), &field), &self.last_people, decode_people)
    }
}

/// Checks format and size of a picture without decoding it.
type Check = fn(&[u8], PictureSize) -> Result<(), PictureError>;

impl Session for Capture {
    fn scene(&self) -> &Scene {
        &self.scene
    }

    fn warnings(&self) -> &[SessionWarning] {
        &self.warnings
    }

    fn n_frames(&self) -> usize {
        self.frames.len()
    }

    fn frame(&self, index: usize) -> Result<SessionFrame, SessionError> {
        let (frame, photo) = self.frame_picture(index)?;
        let turned = photo.warning(&frame.picture, &frame_field(index, ".image"));
        Ok(SessionFrame {
            time_secs: frame.time_secs,
            image: photo.image,
            camera: frame.camera,
            world_from_object: frame.world_from_object,
            exposure: frame.exposure,
            light_estimate: frame.light_estimate,
            depth: self.depth(index, frame)?,
            people: self.people(index, frame)?,
            shown_pose: frame.shown_pose.clone(),
            world_from_shown: frame.world_from_shown,
            warnings: frame.warnings.iter().cloned().chain(turned).collect(),
        })
    }

    fn check_pictures(&self, frames: Range<usize>) -> Result<(), SessionError> {
        let (mut known, mut known_others) = (HashSet::new(), HashSet::new());
        for index in frames {
            let frame = self.frame_at(index)?;
            let truth = frame.truth.as_ref();
            let pictures = [
                (Some(&frame.picture), ".image", false),
                (truth.map(|files| &files.picture), ".truth", false),
                (truth.map(|files| &files.mask), ".mask", true),
            ];
            for (path, field, is_mask) in pictures {
                if let Some(path) = path.filter(|path| known.insert((path.as_str(), is_mask))) {
                    let check = |bytes: &[u8], size| check_head(bytes, size, is_mask);
                    self.store.read(path, &frame_field(index, field), check)?;
                }
            }
            let others: [(_, _, Check); 2] = [
                (frame.depth.as_ref(), ".depth", check_depth),
                (frame.people.as_ref(), ".people", check_people),
            ];
            for (path, field, check) in others {
                if let Some(path) = path.filter(|path| known_others.insert((path.as_str(), field))) {
                    self.store.read(path, &frame_field(index, field), check)?;
                }
            }
        }
        Ok(())
    }

    fn photograph(&self, index: usize) -> Result<Arc<Image>, SessionError> {
        Ok(self.frame_picture(index)?.1.as_taken)
    }

    fn lens(&self, index: usize) -> Result<Option<Lens>, SessionError> {
        self.store.lens(&self.frame_at(index)?.camera.intrinsics)
    }
}

impl GroundTruth for Capture {
    fn truth(&self, index: usize) -> Result<Option<Truth>, SessionError> {
        let Some(files) = &self.frame_at(index)?.truth else {
            return Ok(None);
        };
        let image = self
            .store
            .read(&files.picture, &frame_field(index, ".truth"), decode_photo)?;
        let mask = self
            .store
            .read(&files.mask, &frame_field(index, ".mask"), decode_mask)?;
        Ok(Some(Truth { image, mask }))
    }
}

/// Reads pictures of one size.
struct PictureStore {
    files: Box<dyn Files>,
    size: PictureSize,
    /// Distortion of all photographs, but not of labels.
    distortion: Option<Distortion>,
}

impl PictureStore {
    /// The lens of a camera.
    fn lens(&self, intrinsics: &Intrinsics) -> Result<Option<Lens>, SessionError> {
        let size_px = [self.size.width_px, self.size.height_px];
        let lens = self
            .distortion
            .map(|distortion| Lens::new(distortion, intrinsics, size_px));
        at(LENS, lens.transpose())
    }

    /// A photograph by the given camera.
    fn photo(&self, path: &str, field: &str, intrinsics: &Intrinsics) -> Result<Photo, SessionError> {
        let lens = self.lens(intrinsics)?;
        self.read(path, field, |bytes, size| {
            let as_taken = Arc::new(decode_photo(bytes, size)?);
            Ok(Photo {
                image: lens.map_or_else(|| Arc::clone(&as_taken), |lens| lens.to_pinhole(&as_taken).into()),
                as_taken,
                orientation: exif_orientation(bytes),
            })
        })
    }

    fn read<T>(
        &self,
        path: &str,
        field: &str,
        decode: impl Fn(&[u8], PictureSize) -> Result<T, PictureError>,
    ) -> Result<T, SessionError> {
        let bytes = read_named(self.files.as_ref(), path, field, self.size.max_file_bytes())?;
        decode(&bytes, self.size).map_err(|error| SessionError::new(path, field, error))
    }
}

/// The text of a session's index, without the byte order mark that some editors write and JSON does
/// not allow.
///
/// # Errors
/// When it cannot be read, or is larger than [`MAX_INDEX_BYTES`].
pub fn index_bytes(files: &dyn Files) -> Result<Vec<u8>, SessionError> {
    let mut bytes = files
        .read(INDEX_FILE, MAX_INDEX_BYTES)
        .map_err(|error| in_index(WHOLE_FILE, error))?;
    if bytes.starts_with(BYTE_ORDER_MARK) {
        bytes.drain(..BYTE_ORDER_MARK.len());
    }
    Ok(bytes)
}

fn read_index(files: &dyn Files) -> Result<CaptureRecord, SessionError> {
    parse_index(&index_bytes(files)?)
}

/// Checks format and version first: another version may break every other rule.
fn parse_index(bytes: &[u8]) -> Result<CaptureRecord, SessionError> {
    let header: Header = match parse(bytes) {
        Ok(header) => header,
        // For a syntax error everything is parsed again, which can name the field.
        Err(error) if !is_about_values(&error) => {
            return Err(parse::<CaptureRecord>(bytes).err().unwrap_or(error));
        }
        Err(error) => return Err(error),
    };
    if header.format != FORMAT {
        let kind = SessionErrorKind::Format {
            found: header.format,
            supported: FORMAT,
        };
        return Err(in_index("format", kind));
    }
    if header.version != VERSION {
        let kind = SessionErrorKind::Version {
            found: header.version,
            supported: VERSION,
        };
        return Err(in_index("version", kind));
    }
    parse(bytes)
}

fn is_about_values(error: &SessionError) -> bool {
    matches!(error.kind.as_ref(), SessionErrorKind::Json(error) if error.is_data())
}

fn parse<'json, T: Deserialize<'json>>(bytes: &'json [u8]) -> Result<T, SessionError> {
    let mut json = serde_json::Deserializer::from_slice(bytes);
    let record = serde_path_to_error::deserialize(&mut json).map_err(|error| {
        let field = error.path().to_string();
        in_index(if field == "." { WHOLE_FILE } else { &field }, error.into_inner())
    })?;
    json.end().map_err(|error| in_index(WHOLE_FILE, error))?;
    Ok(record)
}
