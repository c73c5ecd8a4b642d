//! The formats, and the files of each.

use app_core::session::Files;

use super::error::{ImportError, ImportReason};
use super::imported::{Imported, MAX_TEXT_BYTES};
use super::paths::Known;
use super::{bop, colmap, nerfstudio, record3d, stray_scanner};

/// The program that wrote a recording.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Format {
    /// A folder with `transforms.json`.
    Nerfstudio,
    /// A .r3d, or a folder with `metadata` or `metadata.json` and pictures in `rgbd`, `rgb` or beside it.
    #[value(name = "record3d")]
    Record3d,
    /// A folder with `odometry.csv`, `camera_matrix.csv` and the video's frames in `rgb`.
    StrayScanner,
    /// A folder with COLMAP's `cameras` and `images`, .bin or .txt, in it or in `sparse/0`, and the pictures.
    Colmap,
    /// A scene's folder of a BOP data set: `scene_camera.json`, `scene_gt.json`, and the pictures in `rgb`.
    Bop,
}

/// Reads a folder, without its pictures. `object` is the number of the toy among a scene's objects.
///
/// # Errors
/// When a file is missing, or a number in it is invalid.
pub fn read(
    format: Format,
    files: &dyn Files,
    paths: &[String],
    object: Option<u32>,
) -> Result<Imported, ImportError> {
    let known = &Known::new(paths);
    let bytes = |file: &str| bytes(files, file);
    match format {
        Format::Nerfstudio => {
            let file = "transforms.json";
            nerfstudio::parse(file, &text(file, bytes(file)?)?, known)
        }
        Format::Record3d => {
            let file = ["metadata", "metadata.json"]
                .into_iter()
                .find(|file| known.has(file));
            let file = file.ok_or_else(|| ImportError::new("metadata", "the file", ImportReason::Missing))?;
            record3d::parse(file, &text(file, bytes(file)?)?, known)
        }
        Format::StrayScanner => {
            let file = |file: &str| text(file, bytes(file)?);
            let matrix = known
                .has(stray_scanner::MATRIX_FILE)
                .then(|| file(stray_scanner::MATRIX_FILE))
                .transpose()?;
            stray_scanner::parse(&file(stray_scanner::ODOMETRY_FILE)?, matrix.as_deref(), known)
        }
        Format::Colmap => {
            let model = colmap::find(known)?;
            let [cameras, images] = model.files();
            colmap::parse(&model, [&bytes(&cameras)?, &bytes(&images)?], known)
        }
        Format::Bop => {
            let file = |file: &str| text(file, bytes(file)?);
            let texts = [file(bop::CAMERA_FILE)?, file(bop::TRUTH_FILE)?];
            bop::parse([&texts[0], &texts[1]], known, object)
        }
    }
}

/// Reads the files of a format as they are (a COLMAP model's as binary if they are no text), for
/// tests that change them.
///
/// # Errors
/// As [`read`].
pub fn parse(format: Format, files: [&[u8]; 2], paths: &[String]) -> Result<Imported, ImportError> {
    let known = &Known::new(paths);
    let texts = || -> Result<[String; 2], ImportError> {
        Ok([
            text("the first", files[0].to_vec())?,
            text("the second", files[1].to_vec())?,
        ])
    };
    match format {
        Format::Nerfstudio => nerfstudio::parse("transforms.json", &texts()?[0], known),
        Format::Record3d => record3d::parse("metadata", &texts()?[0], known),
        Format::StrayScanner => {
            let [odometry, matrix] = texts()?;
            stray_scanner::parse(&odometry, Some(&matrix), known)
        }
        Format::Colmap => colmap::parse(&colmap::Model::by_bytes(files[0]), files, known),
        Format::Bop => {
            let [cameras, truth] = texts()?;
            bop::parse([&cameras, &truth], known, None)
        }
    }
}

fn bytes(files: &dyn Files, file: &str) -> Result<Vec<u8>, ImportError> {
    files
        .read(file, MAX_TEXT_BYTES)
        .map_err(|error| ImportError::new(file, "the file", error))
}

/// The text without the byte order mark that some editors write.
fn text(file: &str, bytes: Vec<u8>) -> Result<String, ImportError> {
    let text =
        String::from_utf8(bytes).map_err(|_| ImportError::new(file, "the file", ImportReason::NotText))?;
    Ok(match text.strip_prefix('\u{feff}') {
        Some(rest) => rest.to_owned(),
        None => text,
    })
}
