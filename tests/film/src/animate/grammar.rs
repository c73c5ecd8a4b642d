//! The text of `--clips`: the order of clips, their repetitions and speeds, and held poses.

use std::num::NonZeroU32;

use thiserror::Error;

/// Largest number of repetitions of a clip, and of frames of a hold.
pub const MAX_COUNT: u32 = 10_000;

/// Highest speed of a clip; its inverse is the lowest.
const MAX_SPEED: f64 = 100.0;

/// The properties of a toy's clip that a film needs.
#[derive(Clone, Debug, PartialEq)]
pub struct ClipFacts {
    /// Name of the clip.
    pub name: String,
    /// Its length.
    pub duration_secs: f64,
}

/// An item of a film.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Item {
    /// A clip is played.
    Clip {
        /// Index of the clip among the toy's.
        clip: usize,
        /// Number of repetitions.
        n_times: NonZeroU32,
        /// Speed; negative to run backwards.
        speed: f64,
    },
    /// The pose before it is held; at the start, the first pose after it.
    Hold {
        /// Length, in frames of the film.
        n_frames: NonZeroU32,
    },
}

/// The reason why a text describes no film.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum GrammarError {
    /// There is nothing between two commas, or nothing at all.
    #[error(
        "item {number} is empty: an item is a clip such as Look, Look*2, Look@0.5x, Look*2@-1x, or a hold such as hold:12"
    )]
    Empty {
        /// Number of the item, from 1.
        number: usize,
    },
    /// No clip has that name.
    #[error("item {number}, \"{item}\": no clip is called \"{name}\"; {}", known(.clips))]
    UnknownClip {
        /// Number of the item, from 1.
        number: usize,
        /// Its text.
        item: String,
        /// The name in it.
        name: String,
        /// The existing clips.
        clips: Vec<String>,
    },
    /// An invalid speed.
    #[error(
        "item {number}, \"{item}\": \"{speed}\" is no speed: write one such as 0.5x, from 0.01x to 100x, or a negative one to run backwards"
    )]
    Speed {
        /// Number of the item, from 1.
        number: usize,
        /// Its text.
        item: String,
        /// The text in place of the speed.
        speed: String,
    },
    /// An invalid number of repetitions or frames.
    #[error("item {number}, \"{item}\": \"{count}\" is no number from 1 to {MAX_COUNT}")]
    Count {
        /// Number of the item, from 1.
        number: usize,
        /// Its text.
        item: String,
        /// The text in place of the number.
        count: String,
    },
    /// No clip is played.
    #[error("no clip is played: a hold needs a clip before or after it; {}", known(.clips))]
    HoldsAlone {
        /// The existing clips.
        clips: Vec<String>,
    },
}

/// The names of a toy's clips, as half a sentence.
fn known(clips: &[String]) -> String {
    if clips.is_empty() {
        "the toy has none".to_owned()
    } else {
        format!("the toy has {}", clips.join(", "))
    }
}

/// Parses a list such as `Look,Step*2@0.5x,hold:12`. A clip without a name of its own, or with a
/// comma in it, is named by its number from 0, such as `#1`.
///
/// # Errors
/// When an item is invalid; the error names it.
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

/// The text of [`items`] that plays a clip once: its name, or its number if the name means something
/// else there, as one with a comma or `*` in it does.
#[must_use]
pub fn once(clip: usize, clips: &[ClipFacts]) -> String {
    let name = clips.get(clip).map_or("", |clip| &clip.name);
    let plays = |text: &str| {
        let items = items(text, clips);
        matches!(items.as_deref(), Ok([Item::Clip { clip: other, n_times, speed }])
            if *other == clip && n_times.get() == 1 && *speed == 1.0)
    };
    if plays(name) {
        name.to_owned()
    } else {
        format!("#{clip}")
    }
}

fn names(clips: &[ClipFacts]) -> Vec<String> {
    clips.iter().map(|clip| clip.name.clone()).collect()
}

/// A name has priority over a number.
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
        // If the whole text is a name, marks in it belong to the name.
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
