//! The clip and moment that are shown.

use app_scene::toy::{ClipId, Pose, Toy};

/// A clip, played in a loop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Playback {
    clip: Option<ClipId>,
    length_s: f64,
    time_s: f64,
    is_playing: bool,
}

impl Playback {
    /// Plays the toy's first clip from its start; the pose as authored if the toy has no clip.
    #[must_use]
    pub fn of(toy: &Toy) -> Self {
        let first = toy.clip_ids().next();
        let mut playback = Self {
            clip: None,
            length_s: 0.0,
            time_s: 0.0,
            is_playing: true,
        };
        playback.choose(toy, first);
        playback
    }

    /// Selects another clip, from its start, or the pose as authored.
    pub fn choose(&mut self, toy: &Toy, clip: Option<ClipId>) {
        self.clip = clip.filter(|clip| clip.index() < toy.clips().len());
        let length_s = self.clip.map(|clip| toy.clips()[clip.index()].duration_secs);
        (self.length_s, self.time_s) = (length_s.unwrap_or(0.0), 0.0);
    }

    /// Starts playing, or pauses.
    pub fn play(&mut self, is_playing: bool) {
        self.is_playing = is_playing;
    }

    /// Goes to a time; an invalid time, or one beyond the clip, becomes the nearest valid one.
    pub fn scrub(&mut self, time_s: f64) {
        if time_s.is_finite() {
            self.time_s = time_s.clamp(0.0, self.length_s);
        }
    }

    /// Lets `elapsed_s` pass, and restarts after the end.
    pub fn advance(&mut self, elapsed_s: f64) {
        if self.is_playing && self.length_s > 0.0 && elapsed_s.is_finite() {
            self.time_s = (self.time_s + elapsed_s.max(0.0)) % self.length_s;
        }
    }

    /// The pose at that moment.
    #[must_use]
    pub fn pose(&self) -> Pose {
        self.clip.map_or(Pose::Authored, |clip| Pose::Clip {
            clip,
            time_secs: self.time_s,
        })
    }

    /// The clip.
    #[must_use]
    pub fn clip(&self) -> Option<ClipId> {
        self.clip
    }

    /// Its length, in seconds.
    #[must_use]
    pub fn length_s(&self) -> f64 {
        self.length_s
    }

    /// The moment, in seconds.
    #[must_use]
    pub fn time_s(&self) -> f64 {
        self.time_s
    }

    /// Whether the clip plays.
    #[must_use]
    pub fn is_playing(&self) -> bool {
        self.is_playing
    }
}
