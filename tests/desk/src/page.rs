//! The report as a page: one file to open from disk, with its pictures beside it and nothing from a network.

pub(crate) mod pictures;

use std::ops::Range;
use std::path::Path;

use app_core::session::{GroundTruth, Session};
use app_pipeline::readback::Map;
use serde::Serialize;

use crate::false_color::{ERROR, LIGHTS, Shown, describe};
use crate::output::{WriteError, write_whole};
use crate::page::pictures::Pictures;
use crate::replay::ReplayError;
use crate::report::Report;

/// File name of the page in the output folder.
pub const PAGE_FILE: &str = "index.html";
/// Folder of camera frames and truths, below the output folder.
pub const INPUTS_FOLDER: &str = "inputs";
/// Folder of errors and maps, beside the report that lists them.
pub const MAPS_FOLDER: &str = "maps";

const TEMPLATE: &str = include_str!("page/page.html");
const STYLE: &str = include_str!("page/page.css");
/// The last starts the others.
const SCRIPTS: [&str; 3] = [
    include_str!("page/viewer.js"),
    include_str!("page/numbers.js"),
    include_str!("page/page.js"),
];

/// Everything that the page's script needs to know.
#[derive(Serialize)]
struct Data<'a> {
    session: &'a str,
    size_px: [u32; 2],
    frames: Vec<Inputs>,
    /// Pictures that differ from preset to preset, in the order they are offered.
    shown: Vec<Shown>,
    presets: Vec<PresetData<'a>>,
}

/// What all presets start from and are compared with.
#[derive(Serialize)]
struct Inputs {
    index: usize,
    before: String,
    truth: Option<String>,
}

#[derive(Serialize)]
struct PresetData<'a> {
    /// Goes before the paths in the report.
    folder: String,
    report: &'a Report,
}

/// Writes the page of `reports`, each of which lies in its folder below `out`, and the pictures it compares them with.
///
/// # Errors
/// When a frame or a truth of `frames` cannot be read, or the page cannot be written.
pub(crate) fn write(
    out: &Path,
    (session, truth): (&dyn Session, Option<&dyn GroundTruth>),
    frames: Range<usize>,
    reports: &[(String, Report)],
) -> Result<(), ReplayError> {
    let mut pictures = Pictures::new(out, INPUTS_FOLDER);
    let frames: Result<Vec<Inputs>, ReplayError> = frames
        .map(|index| write_inputs(&mut pictures, session, truth, index))
        .collect();
    let scene = session.scene();
    let data = Data {
        session: &scene.name,
        size_px: [scene.width_px, scene.height_px],
        frames: frames?,
        shown: [ERROR, LIGHTS]
            .into_iter()
            .chain(Map::ALL.iter().filter_map(|map| describe(*map)))
            .collect(),
        presets: reports
            .iter()
            .map(|(folder, report)| PresetData {
                folder: folder.clone(),
                report,
            })
            .collect(),
    };
    let path = out.join(PAGE_FILE);
    let html = html(&data).map_err(|error| WriteError {
        path: path.clone(),
        reason: error.to_string(),
    })?;
    Ok(write_whole(&path, html.as_bytes())?)
}

fn write_inputs(
    pictures: &mut Pictures,
    session: &dyn Session,
    truth: Option<&dyn GroundTruth>,
    index: usize,
) -> Result<Inputs, ReplayError> {
    let before = pictures.write("before", index, session.photograph(index)?)?;
    let truth = match truth {
        Some(truth) => truth.truth(index)?,
        None => None,
    };
    let truth = truth.map(|truth| pictures.write("truth", index, truth.image.into()));
    Ok(Inputs {
        index,
        before,
        truth: truth.transpose()?,
    })
}

fn html(data: &Data<'_>) -> Result<String, serde_json::Error> {
    // No text from a session may end the element that the data stands in.
    let json = serde_json::to_string(data)?.replace('<', "\\u003c");
    // The data comes last: what it holds is not looked at for marks.
    Ok(TEMPLATE
        .replace("{{style}}", STYLE)
        .replace("{{script}}", &SCRIPTS.concat())
        .replace("{{data}}", &json))
}
