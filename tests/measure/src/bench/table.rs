//! The results as a table for people, and as CSV and JSON.

use app_core::ledger::Ledger;
use serde_json::Value;

use crate::count::Counted;
use desk::metrics::flicker::Flicker;
use desk::metrics::{Score, Scores};

use super::{FRAME_KINDS, FrameKind, KindTimes, Row};

const CSV_HEADER: &str = "session,preset,width,height,frame_kind,n_frames,gpu_ms_median,cpu_ms_median,spread_ms,align_ms,\
ratio_to_paper,times_faster_than_paper,triangles,mebibytes_moved,copies_counted,peak_gpu_mib,objects_made,kib_made,shadow_rmse,shadow_ssim,toy_rmse,toy_ssim,edge_rmse,edge_ssim,frame_rmse,frame_ssim,\
shadow_flicker,toy_flicker,edge_flicker,frame_flicker,taps_per_missing_texel,stage_ms,pass_ms";

/// One line per row and kind of frame, under a header. Missing measurements are empty; stages and
/// passes are `name=milliseconds`, separated by spaces.
#[must_use]
pub fn csv(rows: &[Row]) -> String {
    std::iter::once(CSV_HEADER.to_owned())
        .chain(
            rows.iter()
                .flat_map(|row| kinds(row).into_iter().map(|kind| csv_line(row, kind))),
        )
        .map(|line| line + "\n")
        .collect()
}

/// The same as an array of objects, by the names of the columns; missing measurements are null,
/// stages and passes are objects.
#[must_use]
pub fn json(rows: &[Row]) -> Value {
    let heads: Vec<&str> = CSV_HEADER.split(',').collect();
    let of_row = |row: &Row| -> Vec<Value> {
        let of_kind = |kind: Option<&KindTimes>| {
            let values = fields(row, kind).into_iter().map(Field::json);
            heads.iter().map(|head| (*head).to_owned()).zip(values).collect()
        };
        kinds(row).into_iter().map(of_kind).map(Value::Object).collect()
    };
    rows.iter().flat_map(of_row).collect()
}

/// The value of a column.
enum Field {
    Text(String),
    Whole(u64),
    Number(Option<f64>),
    Times(Vec<(&'static str, f64)>),
    None,
}

impl Field {
    fn csv(self) -> String {
        match self {
            Self::Text(text) => quoted(&text),
            Self::Whole(number) => number.to_string(),
            Self::Number(value) => number(value),
            Self::Times(times) => listed(&times),
            Self::None => String::new(),
        }
    }

    fn json(self) -> Value {
        match self {
            Self::Text(text) => text.into(),
            Self::Whole(number) => number.into(),
            Self::Number(value) => value.into(),
            Self::Times(times) => times.into_iter().collect(),
            Self::None => Value::Null,
        }
    }
}

/// The timed kinds of frame, or one placeholder.
fn kinds(row: &Row) -> Vec<Option<&KindTimes>> {
    if row.times.is_empty() {
        return vec![None];
    }
    row.times.iter().map(Some).collect()
}

fn csv_line(row: &Row, kind: Option<&KindTimes>) -> String {
    let fields: Vec<String> = fields(row, kind).into_iter().map(Field::csv).collect();
    fields.join(",")
}

/// Values in the order of the header.
fn fields(row: &Row, kind: Option<&KindTimes>) -> Vec<Field> {
    let of_kind = |of: fn(&KindTimes) -> Option<f64>| kind.and_then(of);
    let ratio = of_kind(|times| times.ratio_to_paper);
    let mut fields = vec![
        Field::Text(row.session.clone()),
        Field::Text(row.preset.clone()),
        Field::Whole(row.size_px[0].into()),
        Field::Whole(row.size_px[1].into()),
        kind.map_or(Field::None, |times| Field::Text(times.kind.name().to_owned())),
        Field::Whole(row.n_frames as u64),
    ];
    let times = [
        of_kind(|times| times.gpu_ms),
        of_kind(|times| times.cpu_ms),
        of_kind(|times| times.spread_ms),
        row.align_ms,
        ratio,
        ratio.filter(|ratio| *ratio > 0.0).map(f64::recip),
    ];
    fields.extend(times.map(Field::Number));
    fields.extend(counts(kind));
    fields.extend(
        regions(row)
            .into_iter()
            .flat_map(|score| [score.map(|score| score.rmse), score.map(|score| score.ssim)])
            .chain(flicker(row))
            .chain([row.n_taps])
            .map(Field::Number),
    );
    fields.push(kind.map_or(Field::None, |kind| Field::Times(kind.stages.clone())));
    fields.push(kind.map_or(Field::None, |kind| Field::Times(kind.passes.clone())));
    fields
}

/// Triangles, mebibytes, copies and peak by the ledger, then objects and KiB created on the device.
fn counts(kind: Option<&KindTimes>) -> [Field; 6] {
    let counted = kind.and_then(|kind| kind.counted.as_ref());
    let ledger = counted.map(|counted| &counted.ledger);
    [
        ledger.map_or(Field::None, |ledger| Field::Whole(ledger.total().triangles())),
        Field::Number(ledger.map(Ledger::mebibytes_moved)),
        Field::Number(ledger.map(Ledger::copies_moved)),
        Field::Number(counted.map(Counted::peak_mib)),
        kind.map_or(Field::None, |kind| Field::Whole(kind.n_made)),
        Field::Number(kind.map(|kind| kind.made_bytes as f64 / 1024.0)),
    ]
}

/// The rows in columns, then their times by kind of frame, and a note on their significance on this
/// adapter.
#[must_use]
pub fn table(rows: &[Row], adapter: &str, is_software: bool) -> String {
    let mut text = aligned(&errors(rows));
    text.push_str("Scores are RMSE in 8-bit codes (SSIM); flicker is that of changes from frame to frame, in the shadow and on the toy; alignment is a mean over all frames.\n\n");
    text.push_str(&aligned(&times(rows)));
    text.push('\n');
    text.push_str(&aligned(&costs(rows)));
    text.push_str("By the ledger, the same on any device, with showing the picture on a screen of its size: triangles, copies of that screen; most memory of textures and buffers.\n\n");
    text.push_str(
        "Medians. New in a frame: the pose shown; the camera's picture as well; the camera's pose as well.\n",
    );
    for row in rows.iter().filter(|row| row.n_taps.is_some()) {
        for kind in &row.times {
            let (name, passes) = (kind.kind.name(), listed(&kind.passes));
            text.push_str(&format!(
                "{} {} {name}, ms of each pass: {passes}\n",
                row.session, row.preset
            ));
        }
    }
    if is_software {
        text.push_str(&format!(
            "{adapter} draws on the processor: its times do not apply to a phone.\n"
        ));
    }
    text
}

fn errors(rows: &[Row]) -> Vec<Vec<String>> {
    let heads = [
        "session", "preset", "shadow", "toy", "edge", "frame", "flicker", "toy's", "align ms", "taps",
    ];
    let mut cells = vec![heads.map(str::to_owned).to_vec()];
    for row in rows {
        let score = |score: Option<Score>| {
            score.map_or("-".to_owned(), |score| {
                format!("{:.2} ({:.4})", score.rmse, score.ssim)
            })
        };
        let mut line = vec![row.session.clone(), row.preset.clone()];
        line.extend(regions(row).map(score));
        let [of_shadow, of_toy, ..] = flicker(row);
        line.extend([
            short(of_shadow, 2),
            short(of_toy, 2),
            short(row.align_ms, 1),
            short(row.n_taps, 0),
        ]);
        cells.push(line);
    }
    cells
}

/// Three columns for each kind of frame.
fn times(rows: &[Row]) -> Vec<Vec<String>> {
    let of_kind =
        |kind: FrameKind| ["CPU ms", "GPU ms", "x paper"].map(|head| format!("{} {head}", kind.name()));
    let heads = ["session", "preset"].map(str::to_owned);
    let mut cells = vec![
        heads
            .into_iter()
            .chain(FRAME_KINDS.into_iter().flat_map(of_kind))
            .collect(),
    ];
    for row in rows.iter().filter(|row| !row.times.is_empty()) {
        let mut line = vec![row.session.clone(), row.preset.clone()];
        for kind in FRAME_KINDS {
            let times = row.times.iter().find(|times| times.kind == kind);
            line.extend([
                short(times.and_then(|times| times.cpu_ms), 2),
                short(times.and_then(|times| times.gpu_ms), 2),
                short(times.and_then(|times| times.ratio_to_paper), 2),
            ]);
        }
        cells.push(line);
    }
    cells
}

/// Two columns for each kind of frame, then the peak.
fn costs(rows: &[Row]) -> Vec<Vec<String>> {
    let of_kind = |kind: FrameKind| ["triangles", "copies"].map(|head| format!("{} {head}", kind.name()));
    let mut heads = ["session", "preset", "size"].map(str::to_owned).to_vec();
    heads.extend(FRAME_KINDS.into_iter().flat_map(of_kind));
    heads.push("peak MiB".to_owned());
    let mut cells = vec![heads];
    for row in rows.iter().filter(|row| !row.times.is_empty()) {
        let [width, height] = row.size_px;
        let mut line = vec![
            row.session.clone(),
            row.preset.clone(),
            format!("{width} x {height}"),
        ];
        let counted = |kind| {
            let times = row.times.iter().find(|times| times.kind == kind);
            times.and_then(|times| times.counted.as_ref())
        };
        for kind in FRAME_KINDS {
            let ledger = counted(kind).map(|counted| &counted.ledger);
            line.push(ledger.map_or("-".to_owned(), |ledger| ledger.total().triangles().to_string()));
            line.push(short(ledger.map(Ledger::copies_moved), 2));
        }
        line.push(short(counted(FrameKind::View).map(Counted::peak_mib), 1));
        cells.push(line);
    }
    cells
}

fn regions(row: &Row) -> [Option<Score>; 4] {
    let score = |region: fn(&Scores) -> Score| row.scores.as_ref().map(region);
    [
        score(|scores| scores.shadow),
        score(|scores| scores.toy),
        score(|scores| scores.edge),
        score(|scores| scores.frame),
    ]
}

fn flicker(row: &Row) -> [Option<f64>; 4] {
    let of = |region: fn(&Flicker) -> f64| row.flicker.as_ref().map(region);
    [
        of(|flicker| flicker.shadow),
        of(|flicker| flicker.toy),
        of(|flicker| flicker.edge),
        of(|flicker| flicker.frame),
    ]
}

fn listed(times: &[(&str, f64)]) -> String {
    let times = times
        .iter()
        .map(|(name, ms)| format!("{}={ms:.3}", name.replace(' ', "_")));
    times.collect::<Vec<_>>().join(" ")
}

pub(crate) fn aligned(cells: &[Vec<String>]) -> String {
    let n_columns = cells.first().map_or(0, Vec::len);
    let width = |column: usize| cells.iter().map(|line| line[column].chars().count()).max();
    let widths: Vec<usize> = (0..n_columns).filter_map(width).collect();
    let line = |line: &Vec<String>| {
        let padded = line
            .iter()
            .zip(&widths)
            .map(|(cell, width)| format!("{cell:<width$}"));
        padded.collect::<Vec<_>>().join("  ").trim_end().to_owned() + "\n"
    };
    cells.iter().map(line).collect()
}

fn short(value: Option<f64>, n_digits: usize) -> String {
    value.map_or("-".to_owned(), |value| format!("{value:.n_digits$}"))
}

fn number(value: Option<f64>) -> String {
    value.map_or_else(String::new, |value| format!("{value:.6}"))
}

/// A field with arbitrary text. Source: RFC 4180.
pub(crate) fn quoted(text: &str) -> String {
    if text.contains(['"', ',', '\n', '\r']) {
        format!("\"{}\"", text.replace('"', "\"\""))
    } else {
        text.to_owned()
    }
}
