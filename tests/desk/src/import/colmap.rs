//! A model of COLMAP: `cameras` and `images`, each .bin or .txt. Points are ignored.
//!
//! Poses are from the world to a camera with OpenCV's axes (y down, z forward), as quaternion (w,
//! x, y, z) and translation. The first pixel's centre is at (.5, .5). A model has neither an up
//! direction nor a metric scale.

use std::collections::HashMap;

use super::error::{ImportError, ImportReason};
use super::imported::{Imported, ImportedFrame};
use super::lens::Lens;
use super::paths::{Known, Taken};
use super::values::{OPENCV_FROM_CAMERA, number, ordered, pose, without_picture};

/// Places of a model below the given folder.
const FOLDERS: [&str; 9] = [
    "",
    "sparse/0/",
    "sparse/",
    "colmap/sparse/0/",
    "dense/sparse/",
    "dense/0/sparse/",
    "distorted/sparse/0/",
    "colmap_sparse/0/",
    "colmap_text/",
];
/// Places of the pictures.
const PICTURES: [&str; 4] = ["images", "input", "dense/images", "dense/0/images"];
/// Bytes of a point in an image's record: two coordinates and the point's number.
const POINT_BYTES: u64 = 24;

/// The encoding of a model's files.
pub(super) struct Model {
    folder: &'static str,
    is_binary: bool,
}

impl Model {
    /// Paths of the cameras and of the images.
    pub(super) fn files(&self) -> [String; 2] {
        let ending = if self.is_binary { "bin" } else { "txt" };
        ["cameras", "images"].map(|name| format!("{}{name}.{ending}", self.folder))
    }

    /// The encoding of a file of cameras.
    pub(super) fn by_bytes(cameras: &[u8]) -> Self {
        Self {
            folder: "",
            is_binary: cameras.contains(&0),
        }
    }
}

/// The model in a folder.
pub(super) fn find(known: &Known) -> Result<Model, ImportError> {
    let mut models = FOLDERS
        .into_iter()
        .flat_map(|folder| [true, false].map(|is_binary| Model { folder, is_binary }));
    let found = models.find(|model| model.files().iter().all(|file| known.has(file)));
    found.ok_or_else(|| ImportError::new("cameras.bin, images.bin", "the files", ImportReason::Missing))
}

/// A camera.
#[derive(Clone, Copy, Debug)]
struct Camera {
    size_px: [f64; 2],
    intrinsics: [f64; 4],
    lens: Lens,
}

/// An image, with the pose camera from world.
struct Pose {
    quaternion_wxyz: [f64; 4],
    translation: [f64; 3],
    camera: u64,
    name: String,
}

pub(super) fn parse(model: &Model, bytes: [&[u8]; 2], known: &Known) -> Result<Imported, ImportError> {
    let files = model.files();
    let [cameras_file, images_file] = [0, 1].map(|index| files[index].as_str());
    let (cameras, poses) = if model.is_binary {
        (
            binary_cameras(cameras_file, bytes[0])?,
            binary_images(images_file, bytes[1])?,
        )
    } else {
        (
            text_cameras(cameras_file, bytes[0])?,
            text_images(images_file, bytes[1])?,
        )
    };
    let mut frames = Vec::new();
    let mut missing = Vec::new();
    let mut taken = Taken::new();
    for (index, image) in poses.iter().enumerate() {
        let field = format!("image {index}, {:?}", image.name);
        let Some(picture) = known.picture(&image.name, &PICTURES) else {
            missing.push(image.name.clone());
            continue;
        };
        if !taken.take(&picture, &image.name) {
            return Err(ImportError::new(images_file, field, ImportReason::Twice(picture)));
        }
        let camera = cameras.get(&image.camera);
        let camera = camera
            .ok_or_else(|| ImportError::new(images_file, &*field, ImportReason::NoCamera(image.camera)))?;
        let [w, x, y, z] = image.quaternion_wxyz;
        let opencv_from_world = pose(images_file, &field, [x, y, z, w], image.translation)?;
        frames.push(ImportedFrame {
            time_s: None,
            image: picture,
            depth: None,
            intrinsics: camera.intrinsics,
            size_px: Some(camera.size_px),
            lens: camera.lens,
            recorded_from_camera: opencv_from_world.inverse() * OPENCV_FROM_CAMERA,
        });
    }
    let notes = without_picture(&missing, poses.len());
    Ok(Imported {
        frames: ordered(images_file, frames, missing.into_iter().next())?,
        up: None,
        is_metric: false,
        recorded_from_object: None,
        notes: notes.into_iter().collect(),
    })
}

/// Name and number of numbers of each model, by its number in binary files.
const MODELS: [(&str, usize); 12] = [
    ("SIMPLE_PINHOLE", 3),
    ("PINHOLE", 4),
    ("SIMPLE_RADIAL", 4),
    ("RADIAL", 5),
    ("OPENCV", 8),
    ("OPENCV_FISHEYE", 8),
    ("FULL_OPENCV", 12),
    ("FOV", 5),
    ("SIMPLE_RADIAL_FISHEYE", 4),
    ("RADIAL_FISHEYE", 5),
    ("THIN_PRISM_FISHEYE", 12),
    ("RAD_TAN_THIN_PRISM_FISHEYE", 16),
];

fn camera(
    (file, field): (&str, &str),
    model: &str,
    size_px: [f64; 2],
    numbers: &[f64],
) -> Result<Camera, ImportError> {
    for value in numbers.iter().chain(&size_px) {
        number(file, field, *value)?;
    }
    let (intrinsics, lens) = match (model, numbers) {
        ("SIMPLE_PINHOLE", &[f, cx, cy]) => ([f, f, cx, cy], Lens::NONE),
        ("PINHOLE", &[fx, fy, cx, cy]) => ([fx, fy, cx, cy], Lens::NONE),
        ("SIMPLE_RADIAL", &[f, cx, cy, k]) => ([f, f, cx, cy], Lens::radial([k, 0.0, 0.0, 0.0])),
        ("RADIAL", &[f, cx, cy, k1, k2]) => ([f, f, cx, cy], Lens::radial([k1, k2, 0.0, 0.0])),
        ("OPENCV", &[fx, fy, cx, cy, k1, k2, p1, p2]) => (
            [fx, fy, cx, cy],
            Lens::Brown {
                radial: [k1, k2, 0.0, 0.0],
                divisor: [0.0; 3],
                tangential: [p1, p2],
            },
        ),
        ("FULL_OPENCV", &[fx, fy, cx, cy, k1, k2, p1, p2, k3, k4, k5, k6]) => (
            [fx, fy, cx, cy],
            Lens::Brown {
                radial: [k1, k2, k3, 0.0],
                divisor: [k4, k5, k6],
                tangential: [p1, p2],
            },
        ),
        ("OPENCV_FISHEYE", &[fx, fy, cx, cy, k1, k2, k3, k4]) => {
            ([fx, fy, cx, cy], Lens::Fisheye([k1, k2, k3, k4]))
        }
        ("SIMPLE_RADIAL_FISHEYE", &[f, cx, cy, k]) => ([f, f, cx, cy], Lens::Fisheye([k, 0.0, 0.0, 0.0])),
        ("RADIAL_FISHEYE", &[f, cx, cy, k1, k2]) => ([f, f, cx, cy], Lens::Fisheye([k1, k2, 0.0, 0.0])),
        _ => {
            return Err(ImportError::new(
                file,
                field,
                ImportReason::Lens(model.to_owned()),
            ));
        }
    };
    Ok(Camera {
        size_px,
        intrinsics,
        lens,
    })
}

fn text<'a>(file: &str, bytes: &'a [u8]) -> Result<&'a str, ImportError> {
    std::str::from_utf8(bytes).map_err(|_| ImportError::new(file, "the file", ImportReason::NotText))
}

/// Lines that are no comment, and their line numbers, counted from 1.
fn lines(text: &str) -> impl Iterator<Item = (usize, &str)> {
    let lines = (1..).zip(text.lines());
    lines.filter(|(_, line)| !line.starts_with('#'))
}

fn parsed<T: std::str::FromStr>(file: &str, field: &str, word: Option<&str>) -> Result<T, ImportError> {
    let word = word.ok_or_else(|| ImportError::new(file, field, ImportReason::Missing))?;
    word.parse()
        .map_err(|_| ImportError::new(file, field, ImportReason::NotANumber(word.to_owned())))
}

/// Parses one camera per line: number, model, width, height, parameters.
fn text_cameras(file: &str, bytes: &[u8]) -> Result<HashMap<u64, Camera>, ImportError> {
    let mut cameras = HashMap::new();
    for (line, text) in lines(text(file, bytes)?).filter(|(_, line)| !line.trim().is_empty()) {
        let field = format!("line {line}");
        let mut words = text.split_whitespace();
        let id = parsed(file, &field, words.next())?;
        let model = words.next().unwrap_or_default();
        let size_px = [
            parsed(file, &field, words.next())?,
            parsed(file, &field, words.next())?,
        ];
        let numbers = words.map(|word| parsed(file, &field, Some(word)));
        let numbers: Vec<f64> = numbers.collect::<Result<_, _>>()?;
        cameras.insert(id, camera((file, &field), model, size_px, &numbers)?);
    }
    Ok(cameras)
}

/// Parses two lines per image: number, quaternion, translation, camera, name; the second line has
/// its points and may be empty.
fn text_images(file: &str, bytes: &[u8]) -> Result<Vec<Pose>, ImportError> {
    let mut images = Vec::new();
    let mut lines = lines(text(file, bytes)?);
    while let Some((line, text)) = lines.next() {
        if text.trim().is_empty() {
            continue;
        }
        let field = format!("line {line}");
        let mut rest = text.trim();
        let mut words = Vec::new();
        for _ in 0..9 {
            let (word, after) = rest.split_once(char::is_whitespace).unwrap_or((rest, ""));
            words.push(word);
            rest = after.trim_start();
        }
        let word = |index: usize| words.get(index).copied().filter(|word| !word.is_empty());
        let value = |index: usize| parsed(file, &field, word(index));
        if rest.is_empty() {
            return Err(ImportError::new(
                file,
                format!("{field}, name"),
                ImportReason::Missing,
            ));
        }
        images.push(Pose {
            quaternion_wxyz: [value(1)?, value(2)?, value(3)?, value(4)?],
            translation: [value(5)?, value(6)?, value(7)?],
            camera: parsed(file, &field, word(8))?,
            name: rest.to_owned(),
        });
        lines.next();
    }
    Ok(images)
}

/// The unread part of a binary file.
struct Bytes<'a> {
    file: &'a str,
    all: &'a [u8],
    at: usize,
}

impl<'a> Bytes<'a> {
    fn cut(&self) -> ImportError {
        ImportError::new(self.file, "the file", ImportReason::Cut(self.at))
    }

    fn take(&mut self, n_bytes: u64) -> Result<&'a [u8], ImportError> {
        let n_bytes = usize::try_from(n_bytes).map_err(|_| self.cut())?;
        let end = self.at.checked_add(n_bytes).ok_or_else(|| self.cut())?;
        let taken = self.all.get(self.at..end).ok_or_else(|| self.cut())?;
        self.at = end;
        Ok(taken)
    }

    fn array<const N: usize>(&mut self) -> Result<[u8; N], ImportError> {
        let bytes = self.take(N as u64)?;
        bytes.try_into().map_err(|_| self.cut())
    }

    fn u32(&mut self) -> Result<u32, ImportError> {
        self.array().map(u32::from_le_bytes)
    }

    fn u64(&mut self) -> Result<u64, ImportError> {
        self.array().map(u64::from_le_bytes)
    }

    fn f64(&mut self) -> Result<f64, ImportError> {
        self.array().map(f64::from_le_bytes)
    }

    /// A text that ends at a zero byte.
    fn name(&mut self) -> Result<String, ImportError> {
        let rest = self.all.get(self.at..).unwrap_or_default();
        let end = rest
            .iter()
            .position(|byte| *byte == 0)
            .ok_or_else(|| self.cut())?;
        let name = text(self.file, &rest[..end])?.to_owned();
        self.at += end + 1;
        Ok(name)
    }

    /// A number of entries that have at least `least_bytes` bytes each.
    fn count(&mut self, least_bytes: u64) -> Result<u64, ImportError> {
        let n = self.u64()?;
        let left = (self.all.len() - self.at) as u64;
        if n <= left / least_bytes {
            Ok(n)
        } else {
            Err(ImportError::new(self.file, "the file", ImportReason::Count(n)))
        }
    }
}

fn binary_cameras(file: &str, all: &[u8]) -> Result<HashMap<u64, Camera>, ImportError> {
    const LEAST_BYTES: u64 = 24 + 3 * 8;
    let mut bytes = Bytes { file, all, at: 0 };
    let mut cameras = HashMap::new();
    for _ in 0..bytes.count(LEAST_BYTES)? {
        let id = bytes.u32()?;
        let model = bytes.u32()?;
        let field = format!("camera {id}");
        let known = usize::try_from(model).ok().and_then(|model| MODELS.get(model));
        let unknown = || ImportError::new(file, &*field, ImportReason::Lens(format!("model {model}")));
        let (name, n_numbers) = *known.ok_or_else(unknown)?;
        #[expect(clippy::cast_precision_loss, reason = "a picture's size")]
        let size_px = [bytes.u64()? as f64, bytes.u64()? as f64];
        let numbers: Vec<f64> = (0..n_numbers).map(|_| bytes.f64()).collect::<Result<_, _>>()?;
        cameras.insert(id.into(), camera((file, &field), name, size_px, &numbers)?);
    }
    Ok(cameras)
}

fn binary_images(file: &str, all: &[u8]) -> Result<Vec<Pose>, ImportError> {
    const LEAST_BYTES: u64 = 4 + 7 * 8 + 4 + 1 + 8;
    let mut bytes = Bytes { file, all, at: 0 };
    let mut images = Vec::new();
    for _ in 0..bytes.count(LEAST_BYTES)? {
        let _id = bytes.u32()?;
        let quaternion_wxyz = [bytes.f64()?, bytes.f64()?, bytes.f64()?, bytes.f64()?];
        let translation = [bytes.f64()?, bytes.f64()?, bytes.f64()?];
        let camera = bytes.u32()?.into();
        let name = bytes.name()?;
        let n_points = bytes.count(POINT_BYTES)?;
        bytes.take(n_points * POINT_BYTES)?;
        images.push(Pose {
            quaternion_wxyz,
            translation,
            camera,
            name,
        });
    }
    Ok(images)
}
