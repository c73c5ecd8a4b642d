//! A session as it is stored, or with the lens as estimated from its pictures.

use std::path::Path;

use anyhow::Context;
use app_core::alignment::{Aligner, LensAlignment, RatioOutcome};
use app_core::session::{Capture, Session};

use crate::alignment::{Lights, Source};
use crate::program::open_session;
use crate::stored::Stored;

/// A session, and the estimate of its lens.
pub struct Opened {
    /// The session, with the lens removed from its photographs.
    pub capture: Capture,
    /// The estimate; `None` if it was not asked for.
    pub lens: Option<LensAlignment>,
}

/// Opens a folder or a recording. An estimated lens replaces the session's own.
///
/// # Errors
/// When it cannot be opened, or a frame cannot be read or aligned.
pub fn open(path: &Path, lens: Source, lights: Lights) -> anyhow::Result<Opened> {
    let opened = match lens {
        Source::Given => Opened {
            capture: Capture::open(open_session(path)?)?,
            lens: None,
        },
        Source::Found => with_found_lens(path, lights)?,
    };
    Ok(opened)
}

fn with_found_lens(path: &Path, lights: Lights) -> anyhow::Result<Opened> {
    let bent = Capture::open_with_lens(open_session(path)?, None)?;
    bent.check_pictures(0..bent.n_frames())?;
    let found = find(&bent, lights)?;
    let capture = match found.outcome {
        RatioOutcome::Corrected => Capture::open_with_lens(Stored::open(path)?, Some(found.distortion))?,
        RatioOutcome::AsGiven => bent,
        // The session's own lens is the better one.
        _ => Capture::open(Stored::open(path)?)?,
    };
    Ok(Opened {
        capture,
        lens: Some(found),
    })
}

/// Estimates the lens in the first frame that shows toy and shadows well enough, or in the last
/// frame.
fn find(bent: &Capture, lights: Lights) -> anyhow::Result<LensAlignment> {
    let aligner = Aligner::new(lights.known(bent.scene()));
    let mut found = None;
    for index in 0..bent.n_frames() {
        let tried = aligner.lens(&lights.input(&bent.frame(index)?))?;
        found = Some(tried);
        if tried.outcome != RatioOutcome::Unseen {
            break;
        }
    }
    found.context("a session without frames")
}
