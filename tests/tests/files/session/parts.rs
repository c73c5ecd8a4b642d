//! A small capture in memory, whose parts the tests spoil.

use std::collections::HashMap;
use std::io::Cursor;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use app_core::session::{Capture, FileError, Files, GroundTruth, Session, SessionError, check_path};
use image::{DynamicImage, ImageFormat};
use serde_json::{Value, json};

use crate::toy::builder::triangle;

/// A capture in memory, whose parts the tests spoil.
pub(crate) struct Parts {
    pub(crate) index: Value,
    /// Bytes in place of `index`, for content that is not JSON.
    pub(crate) raw_index: Option<Vec<u8>>,
    pub(crate) files: HashMap<String, Vec<u8>>,
}

pub(crate) struct Memory {
    files: HashMap<String, Vec<u8>>,
    n_reads: Arc<AtomicUsize>,
}

impl Files for Memory {
    fn read(&self, path: &str, max_bytes: u64) -> Result<Vec<u8>, FileError> {
        check_path(path)?;
        self.n_reads.fetch_add(1, Ordering::Relaxed);
        let bytes = self.files.get(path).ok_or(FileError::Missing)?;
        if bytes.len() as u64 > max_bytes {
            return Err(FileError::TooLarge { max_bytes });
        }
        Ok(bytes.clone())
    }
}

impl Parts {
    pub(crate) fn good() -> Self {
        let photo = DynamicImage::new_rgb8(2, 2);
        let files = [
            ("toy.glb", toy_glb(true)),
            ("place.glb", toy_glb(true)),
            ("frame.png", encode(&photo, ImageFormat::Png)),
            ("plate.jpg", encode(&photo, ImageFormat::Jpeg)),
            (
                "depth.png",
                encode(&DynamicImage::new_luma16(4, 4), ImageFormat::Png),
            ),
            (
                "people.png",
                encode(&DynamicImage::new_luma8(4, 4), ImageFormat::Png),
            ),
            (
                "mask.png",
                encode(&DynamicImage::new_rgba8(2, 2), ImageFormat::Png),
            ),
        ];
        let files = files.map(|(name, bytes)| (name.to_owned(), bytes)).into();
        Self {
            index: good_index(),
            raw_index: None,
            files,
        }
    }

    pub(crate) fn into_memory(self) -> (Memory, Arc<AtomicUsize>) {
        let mut files = self.files;
        let index = self
            .raw_index
            .unwrap_or_else(|| self.index.to_string().into_bytes());
        files.insert("capture.json".to_owned(), index);
        let n_reads = Arc::new(AtomicUsize::new(0));
        (
            Memory {
                files,
                n_reads: Arc::clone(&n_reads),
            },
            n_reads,
        )
    }

    pub(crate) fn open(self) -> Result<Capture, SessionError> {
        Capture::open(self.into_memory().0)
    }

    /// Opens the capture and reads all of it.
    pub(crate) fn read_all(self) -> Result<(), SessionError> {
        let capture = self.open()?;
        for i in 0..capture.n_frames() {
            capture.frame(i)?;
            capture.truth(i)?;
        }
        Ok(())
    }

    /// Replaces the value at a path as the errors write it, such as `frames[0].image`.
    pub(crate) fn set(&mut self, field: &str, value: Value) {
        let pointer = format!("/{}", field.replace(['.', '['], "/").replace(']', ""));
        *self.index.pointer_mut(&pointer).unwrap() = value;
    }
}

pub(crate) const IDENTITY: [f64; 16] = [1., 0., 0., 0., 0., 1., 0., 0., 0., 0., 1., 0., 0., 0., 0., 1.];

pub(crate) fn good_index() -> Value {
    json!({
        "format": "shadow-capture", "version": 1, "name": "tiny", "a key from the future": [1, 2],
        "width": 2, "height": 2, "encoding": "srgb",
        "intrinsics": {"fx": 2.0, "fy": 2.0, "cx": 1.0, "cy": 1.0},
        "toy": {
            "file": "toy.glb",
            "world_from_object": [0, 0, -0.5, 0, 0, 0.5, 0, 0, 0.5, 0, 0, 0, 1, 2, 3, 1],
            "physical_pose": {"clip": null, "time": 0.0}
        },
        "receivers": [{"name": "table", "world_from_plane": IDENTITY, "half_extent": [1.5, 2.5],
            "surface": "textured"}],
        "lights": [
            {"kind": "sphere", "position": [0, 1, 0], "radius": 0.1},
            {"kind": "directional", "direction_to_light": [0, 2, 0], "angular_radius_deg": 45}
        ],
        "backgrounds": [{"image": "plate.jpg", "world_from_camera": IDENTITY,
            "intrinsics": {"fx": 2.5, "fy": 2.5, "cx": 1.0, "cy": 1.0}}],
        "frames": [
            {"time": 0.0, "image": "frame.png", "world_from_camera": IDENTITY,
                "animation": {"clip": "Wave", "time": 0.25}, "truth": "frame.png", "mask": "mask.png", "depth": "depth.png",
                "people": "people.png"},
            {"time": 0.1, "image": "frame.png", "world_from_camera": IDENTITY,
                "intrinsics": {"fx": 2.5, "fy": 2.5, "cx": 1.0, "cy": 1.0}, "exposure": 0.5,
                "light_estimate": {"direction_to_light": [0, 2, 0], "intensity": [1, 2, 3],
                    "ambient_intensity": 1000, "color_temperature": 5600, "spherical_harmonics": vec![0.5; 27]},
                "world_from_object": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0.25, 0, 0, 1],
                "world_from_shown": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0.5, 0, 0, 1],
                "animation": {"clip": null, "time": 0}}
        ],
        "probe": {"kind": "fresnel_lens", "world_from_lens": IDENTITY, "radius": 0.05,
            "image": "frame.png", "exposure_ratio": 0.125, "focal_length": 0.03,
            "facets": [{"at": 0.5, "slope_deg": 30}],
            "pictures": [{"image": "frame.png", "exposure_ratio": 0.25, "world_from_camera": IDENTITY,
                "intrinsics": {"fx": 2.5, "fy": 2.5, "cx": 1.0, "cy": 1.0}}]},
        "place_mesh": {"file": "place.glb", "deviation": 0.002},
        "uncertainty": {"toy": {"position": 0.002, "rotation_deg": 1}, "camera": {"position": 0, "rotation_deg": 0.5},
            "lights": {"direction_deg": 20, "distance_ratio": 1.5, "size_ratio": 2}}
    })
}

pub(crate) fn encode(image: &DynamicImage, format: ImageFormat) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    image.write_to(&mut bytes, format).unwrap();
    bytes.into_inner()
}

/// One triangle that moves up during the clip `Wave`, one second long.
pub(crate) fn toy_glb(has_mesh: bool) -> Vec<u8> {
    let mut glb = triangle();
    let keys = [
        glb.floats("SCALAR", &[0.0, 1.0]),
        glb.floats("VEC3", &[0.0, 0.0, 0.0, 0.0, 1.0, 0.0]),
    ];
    glb.animate("Wave", "translation", "LINEAR", keys);
    if !has_mesh {
        glb.json["nodes"] = json!([{}]);
        glb.json.as_object_mut().unwrap().remove("meshes");
    }
    glb.bytes()
}
