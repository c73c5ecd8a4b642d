//! Films of a recording with a moving camera: each frame shows the photograph of its time.

use std::collections::BTreeSet;
use std::fs;
use std::io::ErrorKind;
use std::path::Path;

use anyhow::{Context, ensure};
use app_core::session::{Capture, Session};
use desk::alignment::{Alignments, Asked};
use desk::check::aligned_session::{self, Assumed};
use desk::files::{SESSION_FILE, index_of};
use desk::output::write_whole;
use desk::stored::Stored;

use super::folder::{Film, SESSION_FOLDER};
use super::timeline::ROUNDING_SECS;

/// Warnings of the alignment, in the film's copy of the session: later runs repeat them.
const WARNINGS_FILE: &str = "warnings.txt";

/// Time of each photograph of a session, in seconds since the first.
///
/// # Errors
/// When the index cannot be read, or times decrease.
pub(super) fn times_secs(session: &Stored) -> anyhow::Result<Vec<f64>> {
    let index = index_of(session)?;
    let frames = index["frames"].as_array().into_iter().flatten();
    let times: Vec<f64> = frames.filter_map(|frame| frame["time"].as_f64()).collect();
    let first = times.first().copied().unwrap_or_default();
    ensure!(
        times.is_sorted(),
        "{SESSION_FILE}: frames[].time: a moving film needs photographs in the order of their times; sort them"
    );
    Ok(times.into_iter().map(|time| time - first).collect())
}

/// Copies a session with cameras, poses and lights of its first `n_used` frames aligned by their photographs, one after the other.
///
/// # Errors
/// When a frame cannot be read or aligned, or the copy cannot be written.
pub(super) fn write_aligned(
    session: &Stored,
    capture: &Capture,
    n_used: usize,
    to: &Path,
    say: &dyn Fn(&str),
) -> anyhow::Result<()> {
    let given = capture.scene();
    let mut alignments = Alignments::new(given, Asked::default());
    for index in 0..n_used {
        say(&format!("aligning photograph {} of {n_used}", index + 1));
        alignments.align(given, index, &capture.frame(index)?)?;
    }
    aligned_session::write(session, to, &alignments, Assumed::Written)?;
    let aligned = (0..n_used).filter_map(|index| alignments.of(index));
    let warnings = aligned.flat_map(|aligned| &aligned.alignment.warnings);
    let mut warnings: BTreeSet<String> = warnings.map(ToString::to_string).collect();
    if (0..n_used).any(|index| alignments.changed_scene(given, index).is_some()) {
        warnings.insert(
            "a moving film takes the toy's shape and the plates' light as the session has them".to_owned(),
        );
    }
    let lines: String = warnings.iter().map(|warning| format!("{warning}\n")).collect();
    write_whole(&to.join(WARNINGS_FILE), lines.as_bytes())?;
    Ok(())
}

/// Warnings of the alignment of the photographs of a film in a folder.
///
/// # Errors
/// When the file cannot be read.
pub(super) fn warnings(folder: &Path) -> anyhow::Result<BTreeSet<String>> {
    let path = folder.join(SESSION_FOLDER).join(WARNINGS_FILE);
    match fs::read_to_string(&path) {
        Ok(text) => Ok(text.lines().map(str::to_owned).collect()),
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(BTreeSet::new()),
        Err(error) => Err(error).with_context(|| path.display().to_string()),
    }
}

/// Notes about photographs that the film does not show, or about their end before the film's.
///
/// # Errors
/// When the index cannot be read.
pub(super) fn said_of_photographs(session: &Stored, film: &Film) -> anyhow::Result<String> {
    if film.is_moving {
        let end_secs = times_secs(session)?.last().copied().unwrap_or_default();
        let n_frames = film.frames.len() as f64;
        let film_secs = film.timing.from_secs + (n_frames - 1.0) / film.timing.fps;
        let is_longer = film_secs > end_secs + ROUNDING_SECS;
        let said = format!("the photographs end at {end_secs:.2} s: the last one stays to the film's end\n");
        return Ok(if is_longer { said } else { String::new() });
    }
    let index = index_of(session)?;
    let frames = index["frames"].as_array().into_iter().flatten();
    let photographs: BTreeSet<&str> = frames.filter_map(|frame| frame["image"].as_str()).collect();
    Ok(match photographs.len() {
        0 | 1 => String::new(),
        n => format!("the first of {n} photographs is animated; --moving shows each at its time\n"),
    })
}
