//! Frames of a session as an argument names them: one, or a range that may be open at either end.

use std::fmt;
use std::ops::Range;
use std::str::FromStr;

use thiserror::Error;

/// A selection of frames, counted from 0: `3` is one frame, `2..5` goes from 2 to 4, `3..` to the
/// last, `..2` has the first two.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Frames {
    start: usize,
    /// The end of the range, exclusive; `None` for all to the last.
    end: Option<usize>,
}

impl Frames {
    /// All frames.
    pub const ALL: Self = Self { start: 0, end: None };

    /// The selected range within a session of `n_frames`.
    ///
    /// # Errors
    /// When it has not all of them, or none at all is left.
    pub fn within(self, n_frames: usize) -> Result<Range<usize>, NoSuchFrames> {
        let frames = self.start..self.end.unwrap_or(n_frames.max(self.start));
        if frames.end <= n_frames && (self == Self::ALL || !frames.is_empty()) {
            Ok(frames)
        } else {
            Err(NoSuchFrames {
                asked: self,
                n_frames,
            })
        }
    }
}

impl From<Range<usize>> for Frames {
    fn from(frames: Range<usize>) -> Self {
        Self {
            start: frames.start,
            end: Some(frames.end),
        }
    }
}

impl FromStr for Frames {
    type Err = FramesError;

    fn from_str(text: &str) -> Result<Self, FramesError> {
        let number = |text: &str| text.parse::<usize>().map_err(|_| FramesError);
        let open = |text: &str| (!text.is_empty()).then(|| number(text)).transpose();
        let (start, end) = match text.split_once("..") {
            Some(("", "")) => return Err(FramesError),
            Some((start, end)) => (open(start)?.unwrap_or(0), open(end)?),
            None => {
                let index = number(text)?;
                (index, Some(index.checked_add(1).ok_or(FramesError)?))
            }
        };
        match end {
            Some(end) if end <= start => Err(FramesError),
            _ => Ok(Self { start, end }),
        }
    }
}

impl fmt::Display for Frames {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match (self.start, self.end) {
            (start, None) => write!(out, "{start}.."),
            (start, Some(end)) if end == start + 1 => write!(out, "{start}"),
            (0, Some(end)) => write!(out, "..{end}"),
            (start, Some(end)) => write!(out, "{start}..{end}"),
        }
    }
}

/// A text that is no selection of frames.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[error("a number, or two of them A..B, the first smaller than the second; one of the two may be missing")]
pub struct FramesError;

/// Frames that the session does not have.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[error("frames {asked} are asked for, but the session has {n_frames}, counted from 0")]
pub struct NoSuchFrames {
    /// The frames asked for.
    pub asked: Frames,
    /// Number of frames of the session.
    pub n_frames: usize,
}
