//! The moment of the film that each frame shows.

use std::fmt;

use crate::ease::Ease;

/// The frame rate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Rate {
    /// Number of frames between two keys, whatever their times.
    Between(usize),
    /// Frames per second, by the times of the keys.
    PerSecond(f64),
}

/// The content of a frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moment {
    /// The key before it, or at it.
    pub left: usize,
    /// The part of the way to the next key, from 0; below 1, and 0 at the last key.
    pub share: f64,
    /// Seconds of the film.
    pub time_secs: f64,
}

/// A film with too many frames.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TooMany {
    /// The limit.
    pub most: usize,
}

impl fmt::Display for TooMany {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "the film would have more than {} frames", self.most)
    }
}

impl std::error::Error for TooMany {}

/// Limit for a film's length: more than two hours at 24 frames per second.
const MOST_FRAMES: usize = 1 << 18;
/// A frame this close to a key, as a fraction of the way, shows the key.
const AT_KEY: f64 = 1e-6;

/// The moments of a film whose keys are at `times_secs`, in their order. A picture stays for `hold` frames, or until the next key.
///
/// # Errors
/// When there would be too many.
pub fn moments(times_secs: &[f64], rate: Rate, ease: Ease, hold: usize) -> Result<Vec<Moment>, TooMany> {
    let too_many = TooMany { most: MOST_FRAMES };
    let n_gaps = times_secs.len().saturating_sub(1);
    let parts: Vec<(usize, f64)> = match rate {
        Rate::Between(n) => {
            let n_frames = n.checked_add(1).and_then(|n| n.checked_mul(n_gaps));
            if n_frames.is_none_or(|n_frames| n_frames > MOST_FRAMES) {
                return Err(too_many);
            }
            let gaps = (0..n_gaps).flat_map(|gap| (0..=n).map(move |k| (gap, k as f64 / (n + 1) as f64)));
            gaps.chain([(n_gaps, 0.0)]).collect()
        }
        Rate::PerSecond(fps) => {
            let (Some(first), Some(last)) = (times_secs.first(), times_secs.last()) else {
                return Ok(Vec::new());
            };
            // The last key is shown, even if it lies between two frames.
            let n_steps = ((last - first) * fps - AT_KEY).ceil().max(0.0);
            if !(0.0..MOST_FRAMES as f64).contains(&n_steps) {
                return Err(too_many);
            }
            #[allow(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "checked above"
            )]
            let frames = 0..=n_steps as u32;
            frames
                .map(|k| part_at(times_secs, first + f64::from(k) / fps))
                .collect()
        }
    };
    let moment = |(left, part): (usize, f64)| {
        let next = times_secs.get(left + 1).unwrap_or(&times_secs[left]);
        Moment {
            left,
            share: ease.way(part),
            time_secs: times_secs[left] + part * (next - times_secs[left]),
        }
    };
    Ok(held(&parts, hold.max(1)).into_iter().map(moment).collect())
}

/// Each part shown for `hold` frames. A key is always shown, from its own frame on, and the count
/// starts anew there.
fn held(parts: &[(usize, f64)], hold: usize) -> Vec<(usize, f64)> {
    let last = parts.len().saturating_sub(1);
    let mut shown = Vec::<(usize, f64)>::with_capacity(parts.len());
    let mut n_held = 0;
    for (frame, part) in parts.iter().enumerate() {
        // With frames by time, a key may lie between two frames: the first frame after it shows it.
        let is_new_key = frame == 0 || frame == last || part.1 == 0.0 || part.0 != parts[frame - 1].0;
        match shown.last() {
            Some(before) if !is_new_key && n_held < hold => {
                shown.push(*before);
                n_held += 1;
            }
            _ => {
                shown.push(*part);
                n_held = 1;
            }
        }
    }
    shown
}

/// The key before a time, and the share of the time to the next.
fn part_at(times_secs: &[f64], time_secs: f64) -> (usize, f64) {
    let last = times_secs.len() - 1;
    let left = times_secs
        .partition_point(|key| *key <= time_secs)
        .clamp(1, last.max(1))
        - 1;
    let (start, end) = (times_secs[left], times_secs[(left + 1).min(last)]);
    // Times of a shot increase from key to key.
    let part = if end > start {
        ((time_secs - start) / (end - start)).clamp(0.0, 1.0)
    } else {
        0.0
    };
    if part < AT_KEY {
        (left, 0.0)
    } else if part > 1.0 - AT_KEY {
        (left + 1, 0.0)
    } else {
        (left, part)
    }
}
