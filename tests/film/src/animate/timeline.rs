//! The pose that each frame of a film shows.

use serde::{Deserialize, Serialize};
use thiserror::Error;

use super::grammar::{ClipFacts, Item};
use crate::ease::Ease;

/// Largest number of frames of a film: more than an hour at 24 per second.
pub const MAX_FRAMES: u32 = 100_000;

/// Parts of a frame that rounding may add to a sum of lengths.
const ROUNDING_FRAMES: f64 = 1e-6;

/// A photograph at most this much later than a frame belongs to that frame.
pub const ROUNDING_SECS: f64 = 1e-4;

/// The end of a film.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum End {
    /// It ends with the last pose.
    #[default]
    Once,
    /// It ends before its first frame, which follows the last one.
    Loop,
    /// It ends with the way back to its second frame.
    PingPong,
}

/// The conversion of items to frames.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Timing {
    /// Frames per second.
    pub fps: f64,
    /// Number of frames of each pose.
    pub on: u32,
    /// The end of the film.
    pub end: End,
    /// The easing of each clip.
    pub ease: Ease,
    /// Number of frames in which a clip's start is blended with the pose before it.
    pub n_blend_frames: u32,
    /// Start of the film within the items, in seconds.
    pub from_secs: f64,
    /// End of the film within the items; `None` for their end.
    pub to_secs: Option<f64>,
}

impl Default for Timing {
    fn default() -> Self {
        Self {
            fps: 24.0,
            on: 1,
            end: End::Once,
            ease: Ease::Linear,
            n_blend_frames: 0,
            from_secs: 0.0,
            to_secs: None,
        }
    }
}

/// A moment of a clip.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Moment {
    /// Index of the clip among the toy's.
    pub clip: usize,
    /// Time within it.
    pub time_secs: f64,
}

/// The content of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct FramePose {
    /// The moment.
    pub moment: Moment,
    /// The moment to blend from, and the share of the present one.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub after: Option<Blend>,
    /// Whether a pose is held.
    pub is_held: bool,
}

/// A blend from another pose.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Blend {
    /// The other pose.
    pub from: Moment,
    /// The share of the present pose, above 0 and below 1.
    pub share: f64,
}

/// The reason why a film cannot have that length.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum TimelineError {
    /// The film would be too long.
    #[error("the film would have {n_frames:.0} frames; the limit is {MAX_FRAMES}")]
    TooLong {
        /// Number of frames.
        n_frames: f64,
    },
    /// No frame would be left.
    #[error("nothing lies from {from_secs} s to {to_secs} s: the clips last {length_secs:.3} s")]
    Empty {
        /// The requested start.
        from_secs: f64,
        /// The requested end.
        to_secs: f64,
        /// Total length of the items.
        length_secs: f64,
    },
}

/// A stretch of the film, in frames.
struct Segment {
    start: f64,
    length: f64,
    shows: Shows,
    /// The pose that a clip is blended from.
    after: Option<Moment>,
}

#[derive(Clone, Copy)]
enum Shows {
    Held(Moment),
    Clip(Played),
}

#[derive(Clone, Copy)]
struct Played {
    clip: usize,
    duration_secs: f64,
    n_times: f64,
    is_backward: bool,
}

impl Played {
    fn at(&self, progress: f64) -> Moment {
        let times = self.n_times * progress;
        // All repetitions end with the clip's end; a single repetition ends with the start of the
        // next.
        let share = if times >= self.n_times { 1.0 } else { times.fract() };
        let share = if self.is_backward { 1.0 - share } else { share };
        Moment {
            clip: self.clip,
            time_secs: share * self.duration_secs,
        }
    }
}

/// The poses of a film's frames.
///
/// # Errors
/// When it would have none, or too many.
pub fn frames(items: &[Item], clips: &[ClipFacts], timing: &Timing) -> Result<Vec<FramePose>, TimelineError> {
    let segments = segments(items, clips, timing);
    let length = segments.last().map_or(0.0, |last| last.start + last.length);
    let from = timing.from_secs * timing.fps;
    let to = timing
        .to_secs
        .map_or(length, |secs| (secs * timing.fps).min(length));
    // The last pose of a clip is shown, too, unless the first one follows it; a hold already shows
    // its pose long enough.
    let ends_in_clip = matches!(
        segments.last(),
        Some(Segment {
            shows: Shows::Clip(_),
            ..
        })
    );
    let is_whole = timing.to_secs.is_none_or(|_| to >= length);
    let is_end_shown = timing.end != End::Loop && ends_in_clip && is_whole;
    let span = to - from;
    if span < 0.0 || (span < ROUNDING_FRAMES && !is_end_shown) {
        return Err(TimelineError::Empty {
            from_secs: timing.from_secs,
            to_secs: to / timing.fps,
            length_secs: length / timing.fps,
        });
    }
    let n_frames = if is_end_shown {
        (span + ROUNDING_FRAMES).floor() + 1.0
    } else {
        (span - ROUNDING_FRAMES).ceil()
    };
    if n_frames > f64::from(MAX_FRAMES) {
        return Err(TimelineError::TooLong { n_frames });
    }
    #[allow(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "from 0 to the most"
    )]
    let n_frames = n_frames as u32;
    let on = timing.on.max(1);
    let n_poses = n_frames.div_ceil(on);
    let shown = |pose: u32| {
        // The last pose belongs to the end, even if it comes too late for its turn.
        let is_last = is_end_shown && pose + 1 == n_poses;
        let frame = if is_last { n_frames - 1 } else { pose * on };
        pose_at(&segments, timing, from + f64::from(frame))
    };
    let mut poses: Vec<FramePose> = (0..n_poses).filter_map(shown).collect();
    // The way back mirrors the way there pose by pose: each has the same length.
    if timing.end == End::PingPong && poses.len() > 2 {
        let back: Vec<FramePose> = poses[1..poses.len() - 1].iter().rev().copied().collect();
        poses.extend(back);
    }
    let held = poses
        .iter()
        .flat_map(|pose| std::iter::repeat_n(*pose, on as usize));
    Ok(if timing.end == End::PingPong {
        held.collect()
    } else {
        held.take(n_frames as usize).collect()
    })
}

/// Index of the latest photograph at a time of the film; both times count from the first
/// photograph. The last one stays to the film's end.
#[must_use]
pub fn photograph_at(times_secs: &[f64], film_secs: f64) -> usize {
    let n_taken = times_secs.partition_point(|time| *time <= film_secs + ROUNDING_SECS);
    n_taken.saturating_sub(1)
}

fn segments(items: &[Item], clips: &[ClipFacts], timing: &Timing) -> Vec<Segment> {
    let mut segments: Vec<Segment> = Vec::new();
    let mut start = 0.0;
    let mut before: Option<Moment> = None;
    for (index, item) in items.iter().enumerate() {
        let (length, shows) = match item {
            Item::Hold { n_frames } => {
                let first = || items[index..].iter().find_map(|item| played(item, clips));
                let held = before.or_else(|| Some(first()?.at(0.0)));
                let Some(held) = held else { continue };
                (f64::from(n_frames.get()), Shows::Held(held))
            }
            Item::Clip { speed, n_times, .. } => {
                let Some(played) = played(item, clips) else {
                    continue;
                };
                let once = played.duration_secs * timing.fps / speed.abs();
                // A clip of one key has no length: it is a pose.
                let once = if once > 0.0 { once } else { 1.0 };
                (once * f64::from(n_times.get()), Shows::Clip(played))
            }
        };
        let after = before.filter(|_| matches!(shows, Shows::Clip(_)));
        before = Some(match shows {
            Shows::Held(moment) => moment,
            Shows::Clip(played) => played.at(1.0),
        });
        segments.push(Segment {
            start,
            length,
            shows,
            after,
        });
        start += length;
    }
    // A loop blends its start with its end.
    if timing.end == End::Loop
        && let Some(first) = segments.first_mut()
        && matches!(first.shows, Shows::Clip(_))
    {
        first.after = before;
    }
    segments
}

fn played(item: &Item, clips: &[ClipFacts]) -> Option<Played> {
    match item {
        Item::Hold { .. } => None,
        Item::Clip { clip, n_times, speed } => Some(Played {
            clip: *clip,
            duration_secs: clips.get(*clip)?.duration_secs,
            n_times: f64::from(n_times.get()),
            is_backward: *speed < 0.0,
        }),
    }
}

fn pose_at(segments: &[Segment], timing: &Timing, at: f64) -> Option<FramePose> {
    let begun = segments.iter().rev();
    let segment = { begun }.find(|segment| at + ROUNDING_FRAMES >= segment.start);
    let segment = segment.or(segments.first())?;
    let passed = (at - segment.start).clamp(0.0, segment.length);
    let played = match segment.shows {
        Shows::Held(moment) => {
            return Some(FramePose {
                moment,
                after: None,
                is_held: true,
            });
        }
        Shows::Clip(played) => played,
    };
    let reached = passed / segment.length;
    let reached = if segment.length - passed < ROUNDING_FRAMES {
        1.0
    } else {
        reached
    };
    let n_blend = f64::from(timing.n_blend_frames).min(segment.length);
    let share = Ease::InOut.way(((passed + 1.0) / (n_blend + 1.0)).min(1.0));
    Some(FramePose {
        moment: played.at(timing.ease.way(reached)),
        after: segment
            .after
            .filter(|_| share < 1.0)
            .map(|from| Blend { from, share }),
        is_held: false,
    })
}
