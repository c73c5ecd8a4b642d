//! The page of a film: the same viewer, with the sources of each frame in words, and errors over
//! film time if there is a truth.

use app_core::scene::Image;
use serde::Serialize;

use crate::false_color::{ERROR, Shown};
use crate::metrics::Scores;
use crate::output::WriteError;
use crate::output::folder::OutputFolder;
use crate::page::{PAGE_FILE, html, values};
use crate::report::{MapEntry, Mean, mean_scores};

/// A film to view. Paths of pictures are below the page's folder.
#[derive(Clone, Debug)]
pub struct Film<'a> {
    /// Its title.
    pub title: &'a str,
    /// Width and height of all pictures.
    pub size_px: [u32; 2],
    /// Kinds of pictures beside the film's own, in the order of the menu; frames refer to them by
    /// name.
    pub pictures: Vec<Shown>,
    /// Its frames, in the order of time.
    pub frames: Vec<FilmFrame>,
}

/// A frame of a film.
#[derive(Clone, Debug, Default, Serialize)]
pub struct FilmFrame {
    /// Its number in file names.
    pub index: usize,
    /// Time of the frame since the film's start.
    pub time_secs: f64,
    /// Its picture.
    pub picture: String,
    /// The photograph that it is made from; `None` if it is made from several.
    #[serde(skip)]
    pub photograph: Option<String>,
    /// The truth: what the camera would have seen.
    #[serde(skip)]
    pub truth: Option<String>,
    /// Its other pictures, such as the keys on both sides.
    pub maps: Vec<MapEntry>,
    /// Its sources, for example keys and their weights; one line each.
    pub words: Vec<String>,
    /// Its error against the truth.
    pub scores: Option<Scores>,
}

#[derive(Serialize)]
struct Data<'a> {
    is_film: bool,
    session: &'a str,
    size_px: [u32; 2],
    frames: Vec<Inputs<'a>>,
    shown: Vec<Shown>,
    presets: [Made<'a>; 1],
}

#[derive(Serialize)]
struct Inputs<'a> {
    index: usize,
    before: Option<&'a str>,
    truth: Option<&'a str>,
}

#[derive(Serialize)]
struct Made<'a> {
    folder: &'static str,
    report: FilmReport<'a>,
}

/// The parts of a report that viewer and error tables read.
#[derive(Serialize)]
struct FilmReport<'a> {
    preset: &'static str,
    warnings: [&'static str; 0],
    mean: Mean,
    mean_of_moving: Mean,
    frames: &'a [FilmFrame],
}

/// Writes a picture whose values the page can show; other pictures have none.
///
/// # Errors
/// When the picture's bytes do not fit its size, or the system refuses.
pub fn write_picture(output: &OutputFolder, file: &str, picture: &Image) -> Result<(), WriteError> {
    let png = output.write_png(file, picture)?;
    values::write(output, file, &png)
}

/// Writes the page of a film whose pictures are in a folder.
///
/// # Errors
/// When the system refuses.
pub fn write(output: &OutputFolder, film: &Film<'_>) -> Result<(), WriteError> {
    let scores: Vec<Scores> = film.frames.iter().filter_map(|frame| frame.scores).collect();
    let mean = Mean {
        n_scored: scores.len(),
        scores: mean_scores(&scores),
        ..Mean::default()
    };
    let inputs = film.frames.iter().map(|frame| Inputs {
        index: frame.index,
        before: frame.photograph.as_deref(),
        truth: frame.truth.as_deref(),
    });
    let data = Data {
        is_film: true,
        session: film.title,
        size_px: film.size_px,
        frames: inputs.collect(),
        shown: [ERROR].into_iter().chain(film.pictures.iter().copied()).collect(),
        presets: [Made {
            folder: "",
            report: FilmReport {
                preset: "film",
                warnings: [],
                mean: mean.clone(),
                mean_of_moving: mean,
                frames: &film.frames,
            },
        }],
    };
    let page = html(&data).map_err(|error| WriteError {
        path: output.root().join(PAGE_FILE),
        reason: error.to_string(),
    })?;
    output.write(PAGE_FILE, page.as_bytes())
}
