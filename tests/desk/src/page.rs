//! The report as a page: one file to open from disk, with its pictures beside it and no use of a
//! network.

pub mod film;
pub(crate) mod pictures;
pub(crate) mod values;

use std::rc::Rc;
use std::sync::Arc;

use app_core::scene::{Image, Scene};
use app_core::session::Truth;
use app_pipeline::readback::Map;
use serde::Serialize;

use crate::false_color::{ERROR, LIGHTS, Shown, describe};
use crate::output::WriteError;
use crate::output::folder::OutputFolder;
use crate::page::pictures::Pictures;
pub use crate::page::values::VALUES_FOLDER;
use crate::report::Report;

/// File name of the page in the output folder.
pub const PAGE_FILE: &str = "index.html";
/// Folder of camera frames and truths, below the output folder.
pub const INPUTS_FOLDER: &str = "inputs";
/// Folder of errors and maps, beside the report that lists them.
pub const MAPS_FOLDER: &str = "maps";

const TEMPLATE: &str = include_str!("page/page.html");
const STYLE: &str = include_str!("page/page.css");
/// Each script uses definitions of those before it; the last one starts the page.
const SCRIPTS: [&str; 8] = [
    include_str!("page/base.js"),
    include_str!("page/values.js"),
    include_str!("page/view.js"),
    include_str!("page/viewer.js"),
    include_str!("page/numbers.js"),
    include_str!("page/times.js"),
    include_str!("page/found.js"),
    include_str!("page/page.js"),
];

/// The data of the page's script.
#[derive(Serialize)]
struct Data<'a> {
    session: &'a str,
    size_px: [u32; 2],
    frames: Vec<Inputs>,
    /// Pictures that differ between presets, in the order of the menu.
    shown: Vec<Shown>,
    presets: Vec<PresetData<'a>>,
}

/// Pictures and data that all presets have in common.
#[derive(Serialize)]
struct Inputs {
    index: usize,
    before: String,
    truth: Option<String>,
}

#[derive(Serialize)]
struct PresetData<'a> {
    /// Prefix of the report's paths.
    folder: String,
    report: &'a Report,
}

/// The page of a replay, while it runs.
pub(crate) struct Page {
    output: Rc<OutputFolder>,
    pictures: Pictures,
    frames: Vec<Inputs>,
}

impl Page {
    pub(crate) fn new(output: &Rc<OutputFolder>) -> Self {
        Self {
            output: Rc::clone(output),
            pictures: Pictures::new(output, "", INPUTS_FOLDER).with_values(),
            frames: Vec::new(),
        }
    }

    /// Writes the pictures of a frame that all presets have in common.
    pub(crate) fn add(
        &mut self,
        index: usize,
        photograph: Arc<Image>,
        truth: Option<Truth>,
    ) -> Result<(), WriteError> {
        let before = self.pictures.write("before", index, photograph)?;
        let truth = truth.map(|truth| self.pictures.write("truth", index, truth.image.into()));
        self.frames.push(Inputs {
            index,
            before,
            truth: truth.transpose()?,
        });
        Ok(())
    }

    /// Writes the page of the reports of all presets.
    pub(crate) fn write(self, scene: &Scene, reports: &[Report]) -> Result<(), WriteError> {
        let data = Data {
            session: &scene.name,
            size_px: [scene.width_px, scene.height_px],
            frames: self.frames,
            shown: [ERROR, LIGHTS]
                .into_iter()
                .chain(Map::ALL.iter().filter_map(|map| describe(*map)))
                .collect(),
            presets: reports
                .iter()
                .map(|report| PresetData {
                    folder: folder_of(report.preset, reports.len()),
                    report,
                })
                .collect(),
        };
        let html = html(&data).map_err(|error| WriteError {
            path: self.output.root().join(PAGE_FILE),
            reason: error.to_string(),
        })?;
        self.output.write(PAGE_FILE, html.as_bytes())
    }
}

/// Folder of a preset below the output folder: the output folder itself for a single preset.
pub(crate) fn folder_of(preset: &str, n_presets: usize) -> String {
    match n_presets {
        1 => String::new(),
        _ => format!("{preset}/"),
    }
}

fn html(data: &impl Serialize) -> Result<String, serde_json::Error> {
    // No text of a session may end the element of the data.
    let json = serde_json::to_string(data)?.replace('<', "\\u003c");
    // The data comes last, so that no mark in it is replaced.
    Ok(TEMPLATE
        .replace("{{style}}", STYLE)
        .replace("{{script}}", &SCRIPTS.concat())
        .replace("{{data}}", &json))
}
