//! Lists beside the pictures: the exposure sheet, the report and the contact sheet.

use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

use app_core::core::Core;
use desk::files::SESSION_FILE;
use desk::output::WriteError;
use desk::output::folder::OutputFolder;
use serde::Serialize;

use super::InbetweenError;
use super::keys::{Keys, PoseDifference};
use super::shot::{SHOT_FILE, Shot};
use super::words::findings;
use crate::sheet::{Cell, contact_sheet};

/// The exposure sheet in the output folder.
pub const SHEET_FILE: &str = "xsheet.csv";
/// The report in the output folder.
pub const REPORT_FILE: &str = "inbetween.json";
/// The contact sheet in the output folder.
pub const CONTACT_FILE: &str = "contact.png";
/// Pictures side by side on the contact sheet.
const COLUMNS: u32 = 5;

/// A frame of the film.
#[derive(Clone, Debug, Serialize)]
pub(super) struct FrameEntry {
    pub(super) number: usize,
    pub(super) picture: String,
    pub(super) is_key: bool,
    pub(super) time_secs: f64,
    pub(super) pose: String,
    /// Numbers of the keys that it is made from, counted from 0.
    pub(super) keys: Vec<usize>,
    /// One weight for each of them.
    pub(super) weights: Vec<f64>,
    /// For each of them the factors of red, green and blue of the photograph.
    pub(super) gains: Vec<[f64; 3]>,
    /// Share of the toy that neither key shows.
    pub(super) unseen: Option<f64>,
}

/// A key and its corrections.
#[derive(Clone, Debug, Serialize)]
struct KeyEntry {
    time_secs: f64,
    pose: String,
    camera: Option<PoseDifferenceEntry>,
    print: Option<PoseDifferenceEntry>,
    gains: [f64; 3],
    warnings: Vec<String>,
}

#[derive(Clone, Debug, Serialize)]
struct PoseDifferenceEntry {
    moved_px: f64,
    moved_mm: f64,
    turned_deg: f64,
}

impl From<PoseDifference> for PoseDifferenceEntry {
    fn from(off: PoseDifference) -> Self {
        Self {
            moved_px: off.moved_px,
            moved_mm: 1e3 * off.moved_m,
            turned_deg: off.turned_rad.to_degrees(),
        }
    }
}

/// The whole film.
#[derive(Clone, Debug, Serialize)]
pub(super) struct Report {
    pub(super) shot: String,
    adapter: String,
    pub(super) warnings: Vec<String>,
    findings: Vec<String>,
    is_shown_on_mark: bool,
    keys: Vec<KeyEntry>,
    pub(super) frames: Vec<FrameEntry>,
}

impl Report {
    pub(super) fn new(shot: &Shot, keys: &Keys, core: &Core) -> Self {
        let entries = keys.keys.iter().map(|key| KeyEntry {
            time_secs: key.time_secs,
            pose: shot.pose_text(&key.pose),
            camera: key.found.camera.map(PoseDifferenceEntry::from),
            print: key.found.print.map(PoseDifferenceEntry::from),
            gains: key.found.gains,
            warnings: key.found.warnings.clone(),
        });
        Self {
            shot: shot.scene().name.clone(),
            adapter: core.adapter_name(),
            warnings: shot.warnings().iter().map(ToString::to_string).collect(),
            findings: findings(keys),
            is_shown_on_mark: keys.is_mark,
            keys: entries.collect(),
            frames: Vec::new(),
        }
    }
}

/// Takes the output folder, and removes the files of an earlier run. A folder with a shot or a
/// session in it is refused, even if a program wrote that, too.
pub(super) fn take_folder(folder: &Path, shot: &Shot) -> Result<OutputFolder, InbetweenError> {
    let refused = |reason| {
        Err(InbetweenError::Out {
            folder: folder.to_owned(),
            reason,
        })
    };
    if shot.folder().is_some_and(|of_shot| is_within(of_shot, folder)) {
        return refused("holds the shot itself; choose another folder for the film");
    }
    if [SHOT_FILE, SESSION_FILE]
        .iter()
        .any(|file| folder.join(file).exists())
    {
        return refused("holds a shot or a session; choose another folder for the film");
    }
    Ok(OutputFolder::take(folder)?)
}

/// Whether a folder is another one, or lies in it. A missing folder contains nothing.
fn is_within(inner: &Path, outer: &Path) -> bool {
    let real = |path: &Path| -> Option<PathBuf> { fs::canonicalize(path).ok() };
    real(inner)
        .zip(real(outer))
        .is_some_and(|(inner, outer)| inner.starts_with(outer))
}

/// Writes all lists; the report last.
pub(super) fn write_report(output: &OutputFolder, report: &Report, cells: &[Cell]) -> Result<(), WriteError> {
    output.write(SHEET_FILE, exposure_sheet(report).as_bytes())?;
    if let Some(sheet) = contact_sheet(cells, COLUMNS) {
        output.write_png(CONTACT_FILE, &sheet)?;
    }
    let mut json = serde_json::to_vec_pretty(report).map_err(|error| WriteError {
        path: output.root().join(REPORT_FILE),
        reason: error.to_string(),
    })?;
    json.push(b'\n');
    output.write(REPORT_FILE, &json)
}

/// One line per frame. Numbers of keys are counted from 0; missing values are empty.
fn exposure_sheet(report: &Report) -> String {
    let mut text =
        "frame,picture,source,time_s,pose,left_key,right_key,left_weight,right_weight,unseen_share,\
                    left_gain,right_gain,left_camera_px,right_camera_px,left_print_mm,right_print_mm\n"
            .to_owned();
    for frame in &report.frames {
        let source = if frame.is_key { "key" } else { "in-between" };
        let of_keys = |value: &dyn Fn(usize) -> Option<String>| {
            let value = |at: usize| frame.keys.get(at).and_then(|_| value(at)).unwrap_or_default();
            format!("{},{}", value(0), value(1))
        };
        let camera = |at: usize| {
            report.keys[frame.keys[at]]
                .camera
                .as_ref()
                .map(|off| off.moved_px)
        };
        let print = |at: usize| report.keys[frame.keys[at]].print.as_ref().map(|off| off.moved_mm);
        let unseen = frame
            .unseen
            .map_or(String::new(), |unseen| format!("{unseen:.4}"));
        // Writing to a text cannot fail.
        let _ = writeln!(
            text,
            "{},{},{source},{:.4},{},{},{},{unseen},{},{},{}",
            frame.number,
            quoted(&frame.picture),
            frame.time_secs,
            quoted(&frame.pose),
            of_keys(&|at| Some(frame.keys[at].to_string())),
            of_keys(&|at| Some(format!("{:.4}", frame.weights[at]))),
            of_keys(&|at| Some(format!("{:.4}", frame.gains[at].iter().sum::<f64>() / 3.0))),
            of_keys(&|at| camera(at).map(|px| format!("{px:.2}"))),
            of_keys(&|at| print(at).map(|mm| format!("{mm:.2}"))),
        );
    }
    text
}

/// A text as a field of a table.
fn quoted(text: &str) -> String {
    format!("\"{}\"", text.replace('"', "\"\""))
}
