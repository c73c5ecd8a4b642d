//! The text of `--clips`: which clips follow one another, how often, how fast, and where a pose is held.

use std::num::NonZeroU32;

use thiserror::Error;

/// Most repetitions of a clip, and frames of a hold.
pub const MAX_COUNT: u32 = 10_000;

/// Fastest that a clip is played, and its inverse the slowest.
const MAX_SPEED: f64 = 100.0;

/// A clip of a toy, as far as a film needs to know it.
#[derive(Clone, Debug, PartialEq)]
pub struct ClipFacts {
    /// A name that finds it.
    pub name: String,
    /// Its length.
    pub duration_secs: f64,
}

/// One of what follows one another in a film.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Item {
    /// A clip is played.
    Clip {
        /// Its index among the toy's.
        clip: usize,
        /// How often.
        n_times: NonZeroU32,
        /// How fast; below zero it runs backwards.
        speed: f64,
    },
    /// The pose before it is held; at the start, the first one after it.
    Hold {
        /// How long, in frames of the film.
        n_frames: NonZeroU32,
    },
}

/// Why a text says no film.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum GrammarError {
    /// There is nothing between two commas, or nothing at all.
    #[error(
        "item {number} is empty: an item is a clip such as Look, Look*2, Look@0.5x, Look*2@-1x, or a hold such as hold:12"
    )]
    Empty {
        /// From 1.
        number: usize,
    },
    /// A name that no clip has.
    #[error("item {number}, \"{item}\": no clip is called \"{name}\"; {}", known(.clips))]
    UnknownClip {
        /// From 1.
        number: usize,
        /// Its text.
        item: String,
        /// The name in it.
        name: String,
        /// Those that there are.
        clips: Vec<String>,
    },
    /// A speed that is none.
    #[error(
        "item {number}, \"{item}\": \"{speed}\" is no speed: one is such as 0.5x, from 0.01x to 100x, or below zero to run backwards"
    )]
    Speed {
        /// From 1.
        number: usize,
        /// Its text.
        item: String,
        /// What stands for the speed.
        speed: String,
    },
    /// A number of times or frames that is none.
    #[error("item {number}, \"{item}\": \"{count}\" is no number from 1 to {MAX_COUNT}")]
    Count {
        /// From 1.
        number: usize,
        /// Its text.
        item: String,
        /// What stands for the number.
        count: String,
    },
    /// No clip is played.
    #[error("no clip is played: there is a pose to hold only beside one; {}", known(.clips))]
    HoldsAlone {
        /// Those that there are.
        clips: Vec<String>,
    },
}

/// The names of a toy's clips, as a half sentence.
fn known(clips: &[String]) -> String {
    if clips.is_empty() {
        "the toy has none".to_owned()
    } else {
        format!("the toy has {}", clips.join(", "))
    }
}

/// Reads a list such as `Look,Step*2@0.5x,hold:12`. A clip without a name of its own, or with a comma in it, is called by its number
/// from 0, such as `#1`.
///
/// # Errors
/// When an item is none; the error says which one.
pub fn items(text: &str, clips: &[ClipFacts]) -> Result<Vec<Item>, GrammarError> {
    let texts = text.split(',').map(str::trim).enumerate();
    let items: Vec<Item> = texts
        .map(|(index, text)| {
            ItemText {
                number: index + 1,
                text,
            }
            .item(clips)
        })
        .collect::<Result<_, _>>()?;
    if items.iter().all(|item| matches!(item, Item::Hold { .. })) {
        return Err(GrammarError::HoldsAlone { clips: names(clips) });
    }
    Ok(items)
}

fn names(clips: &[ClipFacts]) -> Vec<String> {
    clips.iter().map(|clip| clip.name.clone()).collect()
}

/// A name wins over a number.
fn find(name: &str, clips: &[ClipFacts]) -> Option<usize> {
    let by_name = clips.iter().position(|clip| clip.name == name);
    let by_number = || {
        name.strip_prefix('#')?
            .parse()
            .ok()
            .filter(|index| *index < clips.len())
    };
    by_name.or_else(by_number)
}

struct ItemText<'a> {
    number: usize,
    text: &'a str,
}

impl ItemText<'_> {
    fn item(&self, clips: &[ClipFacts]) -> Result<Item, GrammarError> {
        if self.text.is_empty() {
            return Err(GrammarError::Empty { number: self.number });
        }
        let once = |clip| Item::Clip {
            clip,
            n_times: NonZeroU32::MIN,
            speed: 1.0,
        };
        // Whatever marks a name has in it, it is a name.
        if let Some(clip) = find(self.text, clips) {
            return Ok(once(clip));
        }
        if let Some(count) = self.text.strip_prefix("hold:") {
            let n_frames = self.count(count)?;
            return Ok(Item::Hold { n_frames });
        }
        let (rest, speed) = match self.text.rsplit_once('@') {
            Some((rest, speed)) => (rest, self.speed(speed)?),
            None => (self.text, 1.0),
        };
        let (name, n_times) = match (find(rest, clips), rest.rsplit_once('*')) {
            (None, Some((name, count))) => (name, self.count(count)?),
            _ => (rest, NonZeroU32::MIN),
        };
        let clip = find(name, clips).ok_or_else(|| GrammarError::UnknownClip {
            number: self.number,
            item: self.text.to_owned(),
            name: name.to_owned(),
            clips: names(clips),
        })?;
        Ok(Item::Clip { clip, n_times, speed })
    }

    fn speed(&self, text: &str) -> Result<f64, GrammarError> {
        let number = text
            .strip_suffix('x')
            .and_then(|number| number.parse::<f64>().ok());
        let allowed = MAX_SPEED.recip()..=MAX_SPEED;
        number
            .filter(|speed| allowed.contains(&speed.abs()))
            .ok_or_else(|| GrammarError::Speed {
                number: self.number,
                item: self.text.to_owned(),
                speed: text.to_owned(),
            })
    }

    fn count(&self, text: &str) -> Result<NonZeroU32, GrammarError> {
        let number = text.parse::<NonZeroU32>().ok();
        number
            .filter(|number| number.get() <= MAX_COUNT)
            .ok_or_else(|| GrammarError::Count {
                number: self.number,
                item: self.text.to_owned(),
                count: text.to_owned(),
            })
    }
}
