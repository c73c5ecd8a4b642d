//! Names of a film's pictures, and ranges of their numbers.

use std::ops::Range;
use std::str::FromStr;

use thiserror::Error;

/// Smallest number of digits, as tools for stop motion want them.
const MIN_DIGITS: usize = 4;

/// A name with one run of `#`, which is replaced by a frame's number.
#[derive(Clone, Debug, PartialEq)]
pub struct NamePattern {
    before: String,
    n_digits: usize,
    after: String,
}

/// The reason why a text is no pattern of names.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum PatternError {
    /// The text has no place for the number, or two.
    #[error("\"{0}\" must have one run of #, such as shot_####, for the frame's number")]
    Runs(String),
    /// The text is no file name.
    #[error(
        "\"{0}\" must be the name of a file, of letters, digits, spaces and . _ - ( ) alone, and begin with none of . and -"
    )]
    Signs(String),
}

impl FromStr for NamePattern {
    type Err = PatternError;

    fn from_str(text: &str) -> Result<Self, PatternError> {
        let text = text.strip_suffix(".png").unwrap_or(text);
        let runs = || PatternError::Runs(text.to_owned());
        let (before, rest) = text.split_once('#').ok_or_else(runs)?;
        let after = rest.trim_start_matches('#');
        if after.contains('#') {
            return Err(runs());
        }
        let is_allowed = |sign: char| sign.is_alphanumeric() || " ._-()".contains(sign);
        if !(before.chars().chain(after.chars()).all(is_allowed)) || text.starts_with(['.', '-']) {
            return Err(PatternError::Signs(text.to_owned()));
        }
        Ok(Self {
            before: before.to_owned(),
            n_digits: 1 + rest.len() - after.len(),
            after: after.to_owned(),
        })
    }
}

impl NamePattern {
    /// Names that begin with a session's.
    #[must_use]
    pub fn of_session(name: &str) -> Self {
        let is_allowed = |sign: char| sign.is_alphanumeric() || "_-".contains(sign);
        let sign = |sign: char| if is_allowed(sign) { sign } else { '_' };
        let name: String = name.chars().map(sign).collect();
        let name = name.trim_matches(['_', '-']);
        Self {
            before: format!("{}_", if name.is_empty() { "film" } else { name }),
            n_digits: MIN_DIGITS,
            after: String::new(),
        }
    }

    /// The file of a frame.
    #[must_use]
    pub fn file(&self, number: u32) -> String {
        let Self {
            before,
            n_digits,
            after,
        } = self;
        format!("{before}{number:0n_digits$}{after}.png")
    }
}

/// Frames by their numbers in the film: `3`, `3..`, `..9` or `3..9`, exclusive of the end.
#[derive(Clone, Debug, PartialEq)]
pub struct FrameRange {
    first: Option<u32>,
    end: Option<u32>,
}

impl FromStr for FrameRange {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let wanted =
            || "write frames as 3, 3.., ..9 or 3..9; the number after the dots is not included".to_owned();
        let number = |text: &str| text.parse::<u32>().map_err(|_| wanted());
        let optional = |text: &str| Some(text).filter(|text| !text.is_empty()).map(number).transpose();
        let range = match text.split_once("..") {
            Some((first, end)) => Self {
                first: optional(first)?,
                end: optional(end)?,
            },
            None => {
                let first = number(text)?;
                Self {
                    first: Some(first),
                    end: Some(first.checked_add(1).ok_or_else(wanted)?),
                }
            }
        };
        match (range.first, range.end) {
            (Some(first), Some(end)) if first >= end => Err(wanted()),
            _ => Ok(range),
        }
    }
}

impl FrameRange {
    /// The selected frames of a film with frames `numbers`; `None` if it does not have all of them.
    #[must_use]
    pub fn within(&self, numbers: &Range<u32>) -> Option<Range<u32>> {
        let range = self.first.unwrap_or(numbers.start)..self.end.unwrap_or(numbers.end);
        let is_within = range.start >= numbers.start && range.end <= numbers.end && !range.is_empty();
        is_within.then_some(range)
    }
}
