//! Rows as a person reads them, and as a program does.

use crate::metrics::flicker::Flicker;
use crate::metrics::{Score, Scores};

use super::{Row, Times};

const CSV_HEADER: &str = "session,preset,n_frames,shadow_rmse,shadow_ssim,toy_rmse,toy_ssim,edge_rmse,edge_ssim,\
frame_rmse,frame_ssim,shadow_flicker,toy_flicker,edge_flicker,frame_flicker,align_ms,cpu_ms,gpu_ms,capture_ms,ratio_to_paper,taps_per_missing_texel,pass_shares";

/// One line a row under a header. What was not measured is empty; shares of passes are `name=share`, apart by spaces.
#[must_use]
pub fn csv(rows: &[Row]) -> String {
    let lines =
        rows.iter().map(|row| {
            let mut fields = vec![quoted(&row.session), row.preset.clone(), row.n_frames.to_string()];
            fields.extend(regions(row).into_iter().flat_map(|score| {
                [score.map(|score| score.rmse), score.map(|score| score.ssim)].map(number)
            }));
            fields.extend(flicker(row).map(number));
            let times = row.times.as_ref();
            let measured = [
                row.align_ms,
                times.and_then(|times| times.cpu_ms),
                times.and_then(|times| times.gpu_ms),
                times.and_then(|times| times.capture_ms),
                row.ratio_to_paper,
                row.n_taps,
            ];
            fields.extend(measured.map(number));
            fields.push(shares(times));
            fields.join(",")
        });
    std::iter::once(CSV_HEADER.to_owned())
        .chain(lines)
        .map(|line| line + "\n")
        .collect()
}

/// The rows in columns, and what the times are worth on this adapter.
#[must_use]
pub fn table(rows: &[Row], adapter: &str, is_software: bool) -> String {
    let heads = [
        "session",
        "preset",
        "shadow",
        "toy",
        "edge",
        "frame",
        "flicker",
        "toy's",
        "align ms",
        "CPU ms",
        "GPU ms",
        "capture ms",
        "x paper",
        "taps",
    ];
    let mut cells = vec![heads.map(str::to_owned).to_vec()];
    for row in rows {
        let score = |score: Option<Score>| {
            score.map_or("-".to_owned(), |score| {
                format!("{:.2} ({:.4})", score.rmse, score.ssim)
            })
        };
        let times = row.times.as_ref();
        let mut line = vec![row.session.clone(), row.preset.clone()];
        line.extend(regions(row).map(score));
        let [of_shadow, of_toy, ..] = flicker(row);
        line.extend([
            short(of_shadow, 2),
            short(of_toy, 2),
            short(row.align_ms, 1),
            short(times.and_then(|times| times.cpu_ms), 2),
            short(times.and_then(|times| times.gpu_ms), 2),
            short(times.and_then(|times| times.capture_ms), 2),
            short(row.ratio_to_paper, 2),
            short(row.n_taps, 0),
        ]);
        cells.push(line);
    }
    let mut text = aligned(&cells);
    text.push_str("Scores are RMSE in 8-bit codes (SSIM); flicker is that of changes from frame to frame, in the shadow and on the toy; times are medians of frames that learn nothing, but that of alignment, a mean over all frames.\n");
    for row in rows.iter().filter(|row| row.n_taps.is_some()) {
        let shares = shares(row.times.as_ref());
        text.push_str(&format!(
            "{} {}, share of each pass: {shares}\n",
            row.session, row.preset
        ));
    }
    if is_software {
        text.push_str(&format!(
            "{adapter} draws on the processor: its times say nothing about a phone.\n"
        ));
    }
    text
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

fn shares(times: Option<&Times>) -> String {
    let passes = times.map_or(&[][..], |times| &times.passes);
    let total_ms: f64 = passes.iter().map(|(_, ms)| ms).sum();
    let share = |(name, ms): &(&str, f64)| format!("{name}={:.3}", ms / total_ms);
    let is_measured = total_ms > 0.0;
    let shares: Vec<String> = passes.iter().filter(|_| is_measured).map(share).collect();
    shares.join(" ")
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

/// A field that may hold anything. Source: RFC 4180.
fn quoted(text: &str) -> String {
    if text.contains(['"', ',', '\n', '\r']) {
        format!("\"{}\"", text.replace('"', "\"\""))
    } else {
        text.to_owned()
    }
}
