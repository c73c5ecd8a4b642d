//! Stray Scanner: `odometry.csv`, the video's frames and the depths of LiDAR.
//!
//! A line is a time, a frame's number, position and quaternion (x, y, z, w), and in newer files the
//! frame's intrinsics; the oldest have neither header, time nor number. There are blanks after
//! commas, and empty columns at the end. The camera's axes are OpenCV's (y down, z forward), which
//! are ARKit's after half a turn about x; the world is ARKit's, +Y up.

use glam::DVec3;

use super::error::{ImportError, ImportReason};
use super::imported::{DepthEncoding, Imported, ImportedDepth, ImportedFrame};
use super::lens::Lens;
use super::paths::Known;
use super::values::{OPENCV_FROM_CAMERA, number, ordered, pose, time_s, without_picture};

pub(super) const ODOMETRY_FILE: &str = "odometry.csv";
pub(super) const MATRIX_FILE: &str = "camera_matrix.csv";

/// Folder of the video's frames.
const FOLDER: &str = "rgb/";
/// Limit for a frame's number.
const MAX_FRAME: u64 = 1 << 32;
/// Columns of a file that has no header.
const OLDEST: [&str; 7] = ["x", "y", "z", "qx", "qy", "qz", "qw"];

pub(super) fn parse(odometry: &str, matrix: Option<&str>, known: &Known) -> Result<Imported, ImportError> {
    let mut lines = odometry
        .lines()
        .enumerate()
        .filter(|(_, line)| !cells(line).is_empty())
        .peekable();
    let has_header = lines
        .peek()
        .is_some_and(|(_, line)| line.contains(|c: char| c.is_alphabetic() && c != 'e'));
    let header = match has_header.then(|| lines.next()).flatten() {
        Some((_, line)) => cells(line),
        None => OLDEST.to_vec(),
    };
    let shared = matrix.map(of_matrix).transpose()?;
    let rows = lines.map(|(line, text)| Row {
        line: line + 1,
        header: &header,
        cells: cells(text),
    });
    let numbered = rows
        .enumerate()
        .map(|(place, row)| Ok((row.frame(place as u64)?, row)));
    let numbered = numbered.collect::<Result<Vec<_>, ImportError>>()?;
    let frames = || numbered.iter().map(|(frame, _)| *frame);
    let [first_frame, last_frame] = [frames().min(), frames().max()].map(|frame| frame.unwrap_or(0));
    let first_number = known.first_number(FOLDER, [first_frame, last_frame]);
    let first_number = first_number.map_err(|numbers| {
        let reason = ImportReason::Numbering { numbers, last_frame };
        ImportError::new(FOLDER, "the pictures", reason)
    })?;
    let mut frames = Vec::new();
    let mut missing = Vec::new();
    for (frame, row) in &numbered {
        let number = frame + first_number;
        let names = ["jpg", "jpeg", "png"].map(|kind| format!("{FOLDER}{number:06}.{kind}"));
        match known.first(names) {
            Some(image) => frames.push(row.imported(image, depth(*frame, known), shared)?),
            None => missing.push(format!("{FOLDER}{number:06}.jpg")),
        }
    }
    let mut notes = Vec::from_iter(without_picture(&missing, numbered.len()));
    if first_number > 0 {
        notes.push(format!(
            "the pictures in {FOLDER} are counted from 1, the frames from 0"
        ));
    }
    Ok(Imported {
        frames: ordered(ODOMETRY_FILE, frames, missing.into_iter().next())?,
        up: Some(DVec3::Y),
        is_metric: true,
        recorded_from_object: None,
        notes,
    })
}

/// The depths of a frame; the scanner counts them from 0.
fn depth(frame: u64, known: &Known) -> Option<ImportedDepth> {
    Some(ImportedDepth {
        file: known.first([format!("depth/{frame:06}.png")])?,
        confidence: known.first([format!("confidence/{frame:06}.png")]),
        encoding: DepthEncoding::Png,
    })
}

/// Cells of a line, without blanks around them and empty ones at the end.
fn cells(line: &str) -> Vec<&str> {
    let mut cells: Vec<&str> = line.split(',').map(str::trim).collect();
    while cells.last().is_some_and(|cell| cell.is_empty()) {
        cells.pop();
    }
    cells
}

struct Row<'a> {
    /// Line number, counted from 1.
    line: usize,
    header: &'a [&'a str],
    cells: Vec<&'a str>,
}

impl<'a> Row<'a> {
    /// The number of its frame, or its place if there is no such column.
    fn frame(&self, place: u64) -> Result<u64, ImportError> {
        let Some(cell) = self.cell("frame") else {
            return Ok(place);
        };
        let wrong = || {
            let reason = ImportReason::NotANumber(cell.to_owned());
            ImportError::new(ODOMETRY_FILE, self.field("frame"), reason)
        };
        let number: u64 = cell.parse().map_err(|_| wrong())?;
        if number < MAX_FRAME {
            Ok(number)
        } else {
            Err(wrong())
        }
    }

    fn imported(
        &self,
        image: String,
        depth: Option<ImportedDepth>,
        shared: Option<[f64; 4]>,
    ) -> Result<ImportedFrame, ImportError> {
        let camera = |name: &str| self.cell(name).map(|_| self.number(name)).transpose();
        let own = [camera("fx")?, camera("fy")?, camera("cx")?, camera("cy")?];
        let intrinsics = match (own, shared) {
            ([Some(fx), Some(fy), Some(cx), Some(cy)], _) => [fx, fy, cx, cy],
            (_, Some(shared)) => shared,
            _ => return Err(ImportError::new(MATRIX_FILE, "the file", ImportReason::Missing)),
        };
        let quaternion = [
            self.number("qx")?,
            self.number("qy")?,
            self.number("qz")?,
            self.number("qw")?,
        ];
        let position = [self.number("x")?, self.number("y")?, self.number("z")?];
        let recorded_from_opencv = pose(ODOMETRY_FILE, &self.field("qw"), quaternion, position)?;
        Ok(ImportedFrame {
            time_s: self.time_s()?,
            image,
            depth,
            intrinsics,
            size_px: None,
            lens: Lens::NONE,
            recorded_from_camera: recorded_from_opencv * OPENCV_FROM_CAMERA,
        })
    }

    fn time_s(&self) -> Result<Option<f64>, ImportError> {
        let Some(cell) = self.cell("timestamp") else {
            return Ok(None);
        };
        let field = self.field("timestamp");
        let reason = || ImportReason::NotANumber(cell.to_owned());
        let value = cell
            .parse()
            .map_err(|_| ImportError::new(ODOMETRY_FILE, field.clone(), reason()))?;
        time_s(ODOMETRY_FILE, &field, value).map(Some)
    }

    fn field(&self, name: &str) -> String {
        format!("line {}, {name}", self.line)
    }

    /// The text of a cell; `None` if there is no such column, or if it is empty.
    fn cell(&self, name: &str) -> Option<&'a str> {
        let column = self.header.iter().position(|other| *other == name)?;
        self.cells.get(column).copied().filter(|cell| !cell.is_empty())
    }

    fn number(&self, name: &str) -> Result<f64, ImportError> {
        let field = self.field(name);
        let Some(cell) = self.cell(name) else {
            return Err(ImportError::new(ODOMETRY_FILE, field, ImportReason::Missing));
        };
        parsed(ODOMETRY_FILE, &field, cell)
    }
}

fn parsed(file: &str, field: &str, cell: &str) -> Result<f64, ImportError> {
    match cell.parse() {
        Ok(value) => number(file, field, value),
        Err(_) => Err(ImportError::new(
            file,
            field,
            ImportReason::NotANumber(cell.to_owned()),
        )),
    }
}

/// Parses the rows of a 3 x 3 matrix.
fn of_matrix(text: &str) -> Result<[f64; 4], ImportError> {
    let rows: Vec<Vec<&str>> = text.lines().map(cells).filter(|row| !row.is_empty()).collect();
    let at = |row: usize, column: usize| {
        let field = format!("row {}, column {}", row + 1, column + 1);
        match rows.get(row).and_then(|row| row.get(column)) {
            Some(cell) => parsed(MATRIX_FILE, &field, cell),
            None => Err(ImportError::new(MATRIX_FILE, field, ImportReason::Missing)),
        }
    };
    Ok([at(0, 0)?, at(1, 1)?, at(0, 2)?, at(1, 2)?])
}
