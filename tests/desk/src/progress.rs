//! Progress of a replay: a bar on a terminal, a line per frame in a log, or nothing.

use std::io::{self, IsTerminal, Write};

use indicatif::{ProgressBar, ProgressStyle};

use app_core::preset::Preset;

use crate::report::FrameEntry;

/// A listener for the progress of a replay.
pub trait Progress {
    /// A session begins; `n_pictures` pictures will follow.
    fn start(&mut self, session: &str, n_pictures: usize);
    /// A frame is done with a preset.
    fn frame(&mut self, preset: Preset, entry: &FrameEntry);
    /// All pictures are done.
    fn finish(&mut self);
}

/// Progress on standard error: a bar on a terminal, lines in a log.
#[must_use]
pub fn on_stderr() -> Box<dyn Progress> {
    if io::stderr().is_terminal() {
        Box::new(Bar(ProgressBar::hidden()))
    } else {
        Box::new(Lines)
    }
}

/// Reports nothing.
pub struct Quiet;

impl Progress for Quiet {
    fn start(&mut self, _: &str, _: usize) {}
    fn frame(&mut self, _: Preset, _: &FrameEntry) {}
    fn finish(&mut self) {}
}

struct Bar(ProgressBar);

impl Progress for Bar {
    fn start(&mut self, session: &str, n_pictures: usize) {
        let style = ProgressStyle::with_template("{msg} [{bar:40}] {pos}/{len} pictures, {eta} left");
        self.0 = ProgressBar::new(n_pictures as u64)
            .with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()))
            .with_message(session.to_owned());
        self.0.tick();
    }

    fn frame(&mut self, preset: Preset, entry: &FrameEntry) {
        for warning in entry.warnings() {
            self.0
                .println(format!("frame {} with {preset}: {warning}", entry.index));
        }
        self.0.inc(1);
    }

    fn finish(&mut self) {
        self.0.finish_and_clear();
    }
}

struct Lines;

impl Progress for Lines {
    fn start(&mut self, session: &str, n_pictures: usize) {
        say(&format!("{session}: {n_pictures} pictures"));
    }

    fn frame(&mut self, preset: Preset, entry: &FrameEntry) {
        for warning in entry.warnings() {
            say(&format!("frame {} with {preset}: {warning}", entry.index));
        }
        let error = entry.scores.map_or_else(String::new, |scores| {
            format!(
                ", shadow RMSE {:.2} SSIM {:.4}",
                scores.shadow.rmse, scores.shadow.ssim
            )
        });
        say(&format!(
            "frame {} with {preset}: {:.0} ms{error}",
            entry.index, entry.wall_ms
        ));
    }

    fn finish(&mut self) {}
}

/// A closed standard error is no reason to stop.
fn say(line: &str) {
    let _ = writeln!(io::stderr(), "{line}");
}
