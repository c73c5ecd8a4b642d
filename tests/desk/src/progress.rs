//! How a replay shows how far it is: a bar on a terminal, a line per frame in a log, or nothing.

use std::io::{self, IsTerminal, Write};

use indicatif::{ProgressBar, ProgressStyle};

use crate::report::FrameEntry;

/// Someone who wants to know how far a replay is.
pub trait Progress {
    /// A session begins, with this many frames to come.
    fn start(&mut self, session: &str, n_frames: usize);
    /// A frame is done.
    fn frame(&mut self, entry: &FrameEntry);
    /// All frames are done.
    fn finish(&mut self);
}

/// Tells a terminal by a bar, and a log by lines; both on standard error.
#[must_use]
pub fn on_stderr() -> Box<dyn Progress> {
    if io::stderr().is_terminal() {
        Box::new(Bar(ProgressBar::hidden()))
    } else {
        Box::new(Lines { n_frames: 0 })
    }
}

/// Tells no one.
pub struct Quiet;

impl Progress for Quiet {
    fn start(&mut self, _: &str, _: usize) {}
    fn frame(&mut self, _: &FrameEntry) {}
    fn finish(&mut self) {}
}

struct Bar(ProgressBar);

impl Progress for Bar {
    fn start(&mut self, session: &str, n_frames: usize) {
        let style = ProgressStyle::with_template("{msg} [{bar:40}] {pos}/{len} frames, {eta} left");
        self.0 = ProgressBar::new(n_frames as u64)
            .with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()))
            .with_message(session.to_owned());
        self.0.tick();
    }

    fn frame(&mut self, entry: &FrameEntry) {
        for warning in &entry.warnings {
            self.0.println(format!("frame {}: {warning}", entry.index));
        }
        self.0.inc(1);
    }

    fn finish(&mut self) {
        self.0.finish_and_clear();
    }
}

struct Lines {
    n_frames: usize,
}

impl Progress for Lines {
    fn start(&mut self, session: &str, n_frames: usize) {
        self.n_frames = n_frames;
        say(&format!("{session}: {n_frames} frames"));
    }

    fn frame(&mut self, entry: &FrameEntry) {
        for warning in &entry.warnings {
            say(&format!("frame {}: {warning}", entry.index));
        }
        let error = entry.scores.map_or_else(String::new, |scores| {
            format!(
                ", shadow RMSE {:.2} SSIM {:.4}",
                scores.shadow.rmse, scores.shadow.ssim
            )
        });
        say(&format!("frame {}: {:.0} ms{error}", entry.index, entry.wall_ms));
    }

    fn finish(&mut self) {}
}

/// Progress that no one can read is no reason to stop.
fn say(line: &str) {
    let _ = writeln!(io::stderr(), "{line}");
}
