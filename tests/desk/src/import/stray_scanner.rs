//! Stray Scanner: `odometry.csv` and the video's frames.
//!
//! A line is a time, a frame's number, position and quaternion (x, y, z, w), and in newer files the frame's intrinsics;
//! the oldest have neither header, time nor number. There are blanks after commas, and empty columns at the end. The
//! camera's axes are those of OpenCV (y down, z forward), ARKit's turned by half about x; the world is ARKit's, +Y up.

use glam::{DMat4, DVec3};

use super::error::{ImportError, ImportReason};
use super::{Imported, ImportedFrame, number, picture, pose, whole};

pub(super) const ODOMETRY_FILE: &str = "odometry.csv";
pub(super) const MATRIX_FILE: &str = "camera_matrix.csv";

/// Columns of a file that has no header.
const OLDEST: [&str; 7] = ["x", "y", "z", "qx", "qy", "qz", "qw"];

pub(super) fn parse(odometry: &str, matrix: Option<&str>, paths: &[String]) -> Result<Imported, ImportError> {
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
    let mut frames = Vec::new();
    for (place, (line, text)) in lines.enumerate() {
        let row = Row {
            line: line + 1,
            header: &header,
            cells: cells(text),
        };
        let index = match row.cell("frame") {
            Some(_) => row.number("frame")?,
            None => place as f64,
        };
        let names = ["jpg", "jpeg", "png"].map(|kind| format!("rgb/{index:06}.{kind}"));
        let Some(image) = picture(paths, names) else {
            continue;
        };
        let camera = |name: &str| row.cell(name).map(|_| row.number(name)).transpose();
        let own = [camera("fx")?, camera("fy")?, camera("cx")?, camera("cy")?];
        let intrinsics = match (own, shared) {
            ([Some(fx), Some(fy), Some(cx), Some(cy)], _) => [fx, fy, cx, cy],
            (_, Some(shared)) => shared,
            _ => return Err(ImportError::new(MATRIX_FILE, "the file", ImportReason::Missing)),
        };
        let quaternion = [
            row.number("qx")?,
            row.number("qy")?,
            row.number("qz")?,
            row.number("qw")?,
        ];
        let position = [row.number("x")?, row.number("y")?, row.number("z")?];
        let recorded_from_opencv = pose(ODOMETRY_FILE, &row.field("qw"), quaternion, position)?;
        frames.push(ImportedFrame {
            time_s: camera("timestamp")?,
            image,
            intrinsics,
            recorded_from_camera: recorded_from_opencv * DMat4::from_scale(DVec3::new(1.0, -1.0, -1.0)),
        });
    }
    Ok(Imported {
        frames: whole(ODOMETRY_FILE, frames)?,
        lens: None,
        up: Some(DVec3::Y),
        is_metric: true,
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
    /// Counted from 1.
    line: usize,
    header: &'a [&'a str],
    cells: Vec<&'a str>,
}

impl<'a> Row<'a> {
    fn field(&self, name: &str) -> String {
        format!("line {}, {name}", self.line)
    }

    /// None where there is no such column, or nothing in it.
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

/// Rows of a matrix of 3 x 3.
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
