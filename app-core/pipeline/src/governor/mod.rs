//! The governor: keeps a frame's time within that of a screen's by moving along a ladder of quality steps.
//!
//! It has no clock: each frame it is told how long the device took, or else how long the frame was shown, and how warm the
//! phone is. It looks at the *load*, which is that time over what a frame may take.
//!
//! - **Down**: where the median load of `WINDOW` frames is above `HIGH`, it takes as many steps at once as are expected
//!   to bring it to `AIM`.
//! - **Up**: one step, where the load that is expected then has been below `AIM` for `UP_FRAMES` frames. What a step
//!   brings is learned when it is taken. A step up that is taken back within `TRIAL_FRAMES` frames is tried again only
//!   after twice as long, up to `MAX_WAIT_FRAMES`: a load that lies between two steps ends in the cheaper one.
//! - **Without device times** a frame that is ready early looks like any other, so that only frames that come late tell
//!   anything: a step down where one in five of `LATE_WINDOW` is late, two where half of them are. A step up is a trial,
//!   after `BLIND_UP_FRAMES` frames of which hardly one was late.
//! - **The end**: where all steps are taken and frames are slow for `END_FRAMES[0]` of them, or the phone has been too warm for
//!   `END_FRAMES[1]` since the latest step, [`Governor::exhausted`] says so: a cheaper preset is what is left.
//! - **Heat** narrows what a frame may take at once, and widens it only after `COOL_FRAMES` frames; there is no step up
//!   above [`Thermal::Fair`].
//!
//! From a sudden load of twice the time it is back within 40 frames, whether steps bring half or one and a half times of
//! what is expected; without device times after a window of late frames for each step or two. Back at its best it is after
//! `UP_FRAMES` and a window for each step. Simulations hold all of that.

mod ladder;
mod window;

pub use ladder::{BALANCED_QUALITY_LADDER, QualitySetting, QualityStep};
use window::Window;

/// Frames whose median load decides.
pub const WINDOW: usize = 15;
/// Frames after a change that still show what was before.
pub const SETTLE_FRAMES: u32 = 4;
/// Median load above which a step is taken down.
const HIGH: f64 = 0.9;
/// Load that steps aim at.
const AIM: f64 = 0.75;
/// Frames of a low load before a step up.
pub const UP_FRAMES: u32 = 120;
/// Frames within which a step up has failed if it is taken back.
const TRIAL_FRAMES: u32 = 600;
/// Most frames that a step up waits for after failures.
const MAX_WAIT_FRAMES: u32 = 9600;
/// Frames of which late ones are counted, without device times.
const LATE_WINDOW: usize = 30;
/// Frames before a trial, without device times.
const BLIND_UP_FRAMES: u32 = 600;
/// Frames that a phone must be cooler for until it counts.
const COOL_FRAMES: u32 = 3600;

/// Frames at the end of the ladder that are too slow, or since the latest step while the phone is too warm, before more is to be done.
const END_FRAMES: [u32; 2] = [90, 900];

/// Interval over that of the screen from which a frame is late.
pub const LATE: f64 = 1.4;
/// Part of the frames that may be late, without device times; and from which two steps are taken.
const MANY_LATE: [f64; 2] = [0.2, 0.5];
/// Part of the frames that may be late before a trial.
const FEW_LATE: f64 = 0.05;
/// What a step may be learned to bring: load after it over load before.
const GAINS: [f64; 2] = [0.4, 0.98];

/// How warm a phone says that it is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum Thermal {
    /// As it should be.
    #[default]
    Nominal,
    /// A little above.
    Fair,
    /// The phone has begun to slow down.
    Serious,
    /// It must cool down now.
    Critical,
}

impl Thermal {
    /// Part of a frame's time that may be used.
    fn part(self) -> f64 {
        match self {
            Self::Nominal => 1.0,
            Self::Fair => 0.9,
            Self::Serious => 0.65,
            Self::Critical => 0.45,
        }
    }
}

/// What is known of a frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measured {
    /// Time on the device, where it can tell; of a frame or two before.
    pub gpu_ms: Option<f64>,
    /// Time since the frame before was shown.
    pub interval_ms: f64,
    /// How warm the phone is.
    pub thermal: Thermal,
}

/// Steps that were taken.
#[derive(Clone, Debug, PartialEq)]
pub struct Turned {
    /// Steps of the ladder before.
    pub from: usize,
    /// Steps of the ladder from now on.
    pub to: usize,
}

/// Moves along a ladder of quality steps.
#[derive(Clone, Debug)]
pub struct Governor {
    ladder: Vec<QualityStep>,
    frames_per_second: u32,
    /// Steps taken.
    level: usize,
    /// Load after each step over that before, as far as it is known.
    gains: Vec<f64>,
    loads: Window,
    lates: Window,
    /// Frames since the last change.
    age: u32,
    /// Frames for which a step up would have done.
    low_frames: u32,
    /// Frames that each step waits for until it is taken back.
    waits: Vec<u32>,
    /// The latest change was a step up, which is on trial.
    is_trial: bool,
    /// Median load before the latest change, and the level then.
    before: Option<(usize, f64)>,
    thermal: Thermal,
    cooler_frames: u32,
    /// Frames at the ladder's end that were all too slow, and since the latest step, all made while the phone was too warm.
    end_frames: [u32; 2],
}

/// Why all steps together are not enough.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Exhausted {
    /// Frames still take too long.
    Slow,
    /// The phone is still too warm.
    Warm,
}

impl Governor {
    /// At its best, for a screen of so many frames a second.
    #[must_use]
    pub fn new(ladder: &[QualityStep], frames_per_second: u32) -> Self {
        Self {
            gains: ladder.iter().map(|step| step.gain).collect(),
            waits: vec![0; ladder.len()],
            ladder: ladder.to_vec(),
            frames_per_second: frames_per_second.max(1),
            level: 0,
            loads: Window::new(WINDOW),
            lates: Window::new(LATE_WINDOW),
            age: 0,
            low_frames: 0,
            is_trial: false,
            before: None,
            thermal: Thermal::Nominal,
            cooler_frames: 0,
            end_frames: [0; 2],
        }
    }

    /// Why the steps of the ladder are not enough; none while there are more, or they are. What helps then is a cheaper preset.
    #[must_use]
    pub fn exhausted(&self) -> Option<Exhausted> {
        let [is_slow, is_warm] = [0, 1].map(|index| self.end_frames[index] >= END_FRAMES[index]);
        match (is_slow, is_warm) {
            (true, _) => Some(Exhausted::Slow),
            (_, true) => Some(Exhausted::Warm),
            _ => None,
        }
    }

    /// Counts frames that nothing helps any more.
    fn count_end(&mut self, thermal: Thermal) {
        let is_slow = self.loads.median().is_some_and(|load| load > HIGH)
            || self.lates.mean().is_some_and(|late| late >= MANY_LATE[0]);
        let is_slow_at_end = is_slow && self.level == self.ladder.len();
        // Whatever steps were taken for it: each begins the count anew.
        let is_warm = thermal >= Thermal::Serious;
        for (frames, is_end) in self.end_frames.iter_mut().zip([is_slow_at_end, is_warm]) {
            *frames = if is_end { frames.saturating_add(1) } else { 0 };
        }
    }

    /// The steps that are taken: what is turned down, each over those of the same setting before it.
    #[must_use]
    pub fn turned_down(&self) -> &[QualityStep] {
        &self.ladder[..self.level]
    }

    /// The value of a setting; none if it is not reduced.
    #[must_use]
    pub fn value(&self, setting: QualitySetting) -> Option<u32> {
        let steps = self.turned_down().iter().rev();
        steps
            .filter(|step| step.setting == setting)
            .map(|step| step.value)
            .next()
    }

    /// Frames a second that are to be shown.
    #[must_use]
    pub fn frames_per_second(&self) -> u32 {
        self.value(QualitySetting::FramesPerSecond)
            .map_or(self.frames_per_second, |limit| limit.min(self.frames_per_second))
    }

    /// Takes what is known of a frame; tells where it goes another way from the next frame on.
    pub fn take(&mut self, frame: &Measured) -> Option<Turned> {
        self.feel(frame.thermal);
        self.age = self.age.saturating_add(1);
        if self.age <= SETTLE_FRAMES {
            return None;
        }
        let budget_ms = 1e3 / f64::from(self.frames_per_second());
        let to = match frame.gpu_ms {
            Some(gpu_ms) if gpu_ms.is_finite() => {
                self.loads.push(gpu_ms / (budget_ms * self.thermal.part()));
                self.by_load()
            }
            _ => {
                let is_late = frame.interval_ms > LATE * budget_ms;
                self.lates.push(if is_late { 1.0 } else { 0.0 });
                self.by_lateness()
            }
        };
        self.count_end(frame.thermal);
        to.map(|to| self.go(to))
    }

    /// Follows the heat: up at once, down when it has lasted.
    fn feel(&mut self, thermal: Thermal) {
        if thermal >= self.thermal {
            self.cooler_frames = 0;
        } else {
            self.cooler_frames += 1;
        }
        if thermal > self.thermal || self.cooler_frames >= COOL_FRAMES {
            self.thermal = thermal;
            self.cooler_frames = 0;
            // Loads so far are over another time.
            self.loads.clear();
            self.before = None;
        }
    }

    fn by_load(&mut self) -> Option<usize> {
        let load = self.loads.median()?;
        self.learn(load);
        if load > HIGH && self.level < self.ladder.len() {
            return Some(self.down_to(load));
        }
        let above = self.level.checked_sub(1)?;
        let is_low = load / self.gains[above] <= AIM && self.thermal <= Thermal::Fair;
        self.low_frames = if is_low { self.low_frames + 1 } else { 0 };
        (self.low_frames >= self.waits[above].max(UP_FRAMES)).then_some(above)
    }

    /// The first level that is expected to bring the load to where it should be.
    fn down_to(&self, load: f64) -> usize {
        let mut expected = load;
        let gains = &self.gains[self.level..];
        let n_steps = gains.iter().position(|gain| {
            expected *= gain;
            expected <= AIM
        });
        n_steps.map_or(self.ladder.len(), |last| self.level + last + 1)
    }

    /// Learns what the steps bring that were taken last.
    fn learn(&mut self, load: f64) {
        let Some((from, before)) = self.before.take() else {
            return;
        };
        let (low, high) = (from.min(self.level), from.max(self.level));
        let is_down = self.level > from;
        let whole = if is_down { load / before } else { before / load };
        let steps = &mut self.gains[low..high];
        let expected: f64 = steps.iter().product();
        if whole.is_nan() || steps.is_empty() {
            return;
        }
        let each = (whole / expected).max(0.0).powf(1.0 / steps.len() as f64);
        for (gain, step) in steps.iter_mut().zip(&self.ladder[low..high]) {
            // The rate of frames brings what it says.
            if step.setting != QualitySetting::FramesPerSecond {
                *gain = (*gain * each).clamp(GAINS[0], GAINS[1]);
            }
        }
    }

    fn by_lateness(&mut self) -> Option<usize> {
        let late = self.lates.mean()?;
        let n_steps = MANY_LATE.iter().filter(|part| late >= **part).count();
        // Heat alone asks for steps as well, where no time tells of it.
        let n_steps = n_steps.max(usize::from(self.is_too_warm()));
        if n_steps > 0 && self.level < self.ladder.len() {
            return Some((self.level + n_steps).min(self.ladder.len()));
        }
        let above = self.level.checked_sub(1)?;
        let is_low = late <= FEW_LATE && self.thermal <= Thermal::Fair;
        self.low_frames = if is_low { self.low_frames + 1 } else { 0 };
        (self.low_frames >= self.waits[above].max(BLIND_UP_FRAMES)).then_some(above)
    }

    /// Whether so few steps are taken that a phone this warm would not cool down by them, as far as they say themselves.
    fn is_too_warm(&self) -> bool {
        let taken: f64 = self.ladder[..self.level].iter().map(|step| step.gain).product();
        taken > self.thermal.part()
    }

    fn go(&mut self, to: usize) -> Turned {
        let from = self.level;
        if to > from {
            if self.is_trial && self.age <= TRIAL_FRAMES {
                // The step that was taken up last is the first of those that are taken back.
                let wait = self.waits[from].max(if self.loads.median().is_some() {
                    UP_FRAMES
                } else {
                    BLIND_UP_FRAMES
                });
                self.waits[from] = (2 * wait).min(MAX_WAIT_FRAMES);
            }
        } else if self.is_trial && self.age > TRIAL_FRAMES {
            // The trial before this one held.
            self.waits[from] = 0;
        }
        self.is_trial = to < from;
        // Where the rate of frames changes, a load is over another time: it is what that step says.
        self.before = self.loads.median().map(|load| (from, load));
        self.level = to;
        self.end_frames = [0; 2];
        self.age = 0;
        self.low_frames = 0;
        self.loads.clear();
        self.lates.clear();
        Turned { from, to }
    }
}
