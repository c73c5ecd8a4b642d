//! Names of a film's pictures, and ranges of their numbers.

use std::ops::Range;
use std::str::FromStr;

use thiserror::Error;

/// Fewest digits of a number, as tools for stop motion want them.
const MIN_DIGITS: usize = 4;

/// A name with one run of `#` in it, which a frame's number stands for.
#[derive(Clone, Debug, PartialEq)]
pub struct NamePattern {
    before: String,
    n_digits: usize,
    after: String,
}

/// Why a text is no pattern of names.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum PatternError {
    /// No place for the number, or two.
    #[error("\"{0}\" must have one run of #, such as shot_####: a frame's number stands there")]
    Runs(String),
    /// Not a name of a file.
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

/// Frames by their numbers in the film: `3`, `3..`, `..9` or `3..9`, without the one after the dots.
#[derive(Clone, Debug, PartialEq)]
pub struct FrameRange {
    first: Option<u32>,
    end: Option<u32>,
}

impl FromStr for FrameRange {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let wanted = || "frames are such as 3, 3.., ..9 or 3..9, without the one after the dots".to_owned();
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
    /// Those of a film with frames `numbers`; none where it has not all that are asked for.
    #[must_use]
    pub fn within(&self, numbers: &Range<u32>) -> Option<Range<u32>> {
        let range = self.first.unwrap_or(numbers.start)..self.end.unwrap_or(numbers.end);
        let is_within = range.start >= numbers.start && range.end <= numbers.end && !range.is_empty();
        is_within.then_some(range)
    }
}
