//! The governor: keeps a frame's time within the interval of the screen by moving along a ladder of
//! quality steps.
//!
//! It has no clock: for each frame it gets the time on the device, or else the time for which the
//! frame was shown, and the phone's heat. It controls the *load*, the ratio of that time to the
//! time that a frame may take.
//!
//! - **Down**: if the median load of `WINDOW` frames is above `HIGH`, it takes as many steps at
//!   once as are expected to reduce it to `AIM`.
//! - **Up**: one step, if the load that is then expected has been below `AIM` for `UP_FRAMES`
//!   frames. The gain of a step is learned when it is taken. A step up that is taken back within
//!   `TRIAL_FRAMES` frames is repeated only after twice the time, up to `MAX_WAIT_FRAMES`: a load
//!   that lies between two steps ends in the cheaper one.
//! - **Without device times** a frame that is ready early looks like any other, so that only late
//!   frames are evidence: a step down if one in five of `LATE_WINDOW` is late, two if half of them
//!   are. A step up is a trial after `BLIND_UP_FRAMES` frames of which hardly any was late.
//! - **The end**: if all steps are taken and frames are slow for `END_FRAMES[0]` of them, or the
//!   phone has been too warm for `END_FRAMES[1]` since the latest step, [`Governor::exhausted`]
//!   reports it: only a cheaper preset is left.
//! - **Heat** reduces the time that a frame may take at once, and restores it only after
//!   `COOL_FRAMES` frames; there is no step up above [`Thermal::Fair`].
//!
//! After a sudden load of twice the time it recovers within 40 frames, whether the gains of steps
//! are half or one and a half times the expected ones; without device times it needs a window of
//! late frames for each step or two. It returns to the best level after `UP_FRAMES` and a window
//! for each step. Simulations verify all of this.

mod ladder;
mod window;

pub use ladder::{BALANCED_QUALITY_LADDER, QualitySetting, QualityStep};
use window::Window;

/// Frames whose median load decides.
pub const WINDOW: usize = 15;
/// Frames after a change that still show the previous state.
pub const SETTLE_FRAMES: u32 = 4;
/// Median load above which a step is taken down.
const HIGH: f64 = 0.9;
/// Load that steps aim at.
const AIM: f64 = 0.75;
/// Frames of a low load before a step up.
pub const UP_FRAMES: u32 = 120;
/// Frames within which a step up has failed if it is taken back.
const TRIAL_FRAMES: u32 = 600;
/// Longest wait of a step up after failures, in frames.
const MAX_WAIT_FRAMES: u32 = 9600;
/// Number of frames among which late ones are counted, without device times.
const LATE_WINDOW: usize = 30;
/// Frames before a trial, without device times.
const BLIND_UP_FRAMES: u32 = 600;
/// Frames for which a phone must be cooler before that counts.
const COOL_FRAMES: u32 = 3600;

/// Number of slow frames at the end of the ladder, and number of frames since the latest step while
/// the phone is too warm, before the ladder counts as exhausted.
const END_FRAMES: [u32; 2] = [90, 900];

/// Ratio of the interval to that of the screen from which a frame is late.
pub const LATE: f64 = 1.4;
/// Share of late frames, without device times, from which one step is taken, and from which two
/// are.
const MANY_LATE: [f64; 2] = [0.2, 0.5];
/// Largest share of late frames before a trial.
const FEW_LATE: f64 = 0.05;
/// Range of the gain that may be learned for a step: load after it over load before.
const GAINS: [f64; 2] = [0.4, 0.98];

/// The heat that a phone reports.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum Thermal {
    /// The normal temperature.
    #[default]
    Nominal,
    /// Slightly warmer than normal.
    Fair,
    /// The phone has begun to slow down.
    Serious,
    /// The phone must cool down now.
    Critical,
}

impl Thermal {
    /// Share of a frame's time that may be used.
    fn part(self) -> f64 {
        match self {
            Self::Nominal => 1.0,
            Self::Fair => 0.9,
            Self::Serious => 0.65,
            Self::Critical => 0.45,
        }
    }
}

/// Measurements of a frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measured {
    /// Time on the device, if it can be measured, of a frame or two before.
    pub gpu_ms: Option<f64>,
    /// Time since the previous frame was shown.
    pub interval_ms: f64,
    /// The phone's heat.
    pub thermal: Thermal,
}

/// A change of the level.
#[derive(Clone, Debug, PartialEq)]
pub struct Turned {
    /// Number of steps before.
    pub from: usize,
    /// Number of steps from now on.
    pub to: usize,
}

/// Moves along a ladder of quality steps.
#[derive(Clone, Debug)]
pub struct Governor {
    ladder: Vec<QualityStep>,
    frames_per_second: u32,
    /// Number of steps taken.
    level: usize,
    /// Load after each step over the load before it, as far as it is known.
    gains: Vec<f64>,
    loads: Window,
    lates: Window,
    /// Frames since the last change.
    age: u32,
    /// Frames at which a step up would have been possible.
    low_frames: u32,
    /// Number of frames that each step up waits.
    waits: Vec<u32>,
    /// Whether the latest change was a step up, which is on trial.
    is_trial: bool,
    /// The level before the latest change, and its median load.
    before: Option<(usize, f64)>,
    thermal: Thermal,
    cooler_frames: u32,
    /// Consecutive slow frames at the ladder's end, and frames since the latest step, all made
    /// while the phone was too warm.
    end_frames: [u32; 2],
}

/// The reason why all steps together are not enough.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Exhausted {
    /// Frames still take too long.
    Slow,
    /// The phone is still too warm.
    Warm,
}

impl Governor {
    /// A governor at the best level, for a screen with this frame rate.
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

    /// The reason why the steps of the ladder are not enough; `None` if there are further steps, or
    /// if they are enough. Then only a cheaper preset helps.
    #[must_use]
    pub fn exhausted(&self) -> Option<Exhausted> {
        let [is_slow, is_warm] = [0, 1].map(|index| self.end_frames[index] >= END_FRAMES[index]);
        match (is_slow, is_warm) {
            (true, _) => Some(Exhausted::Slow),
            (_, true) => Some(Exhausted::Warm),
            _ => None,
        }
    }

    /// Counts the frames that no further step can improve.
    fn count_end(&mut self, thermal: Thermal) {
        let is_slow = self.loads.median().is_some_and(|load| load > HIGH)
            || self.lates.mean().is_some_and(|late| late >= MANY_LATE[0]);
        let is_slow_at_end = is_slow && self.level == self.ladder.len();
        // Every step for that reason restarts the count.
        let is_warm = thermal >= Thermal::Serious;
        for (frames, is_end) in self.end_frames.iter_mut().zip([is_slow_at_end, is_warm]) {
            *frames = if is_end { frames.saturating_add(1) } else { 0 };
        }
    }

    /// The steps that are taken: the reduced settings; a later step of a setting overrides the
    /// earlier ones.
    #[must_use]
    pub fn quality_reductions(&self) -> &[QualityStep] {
        &self.ladder[..self.level]
    }

    /// The value of a setting; `None` if it is not reduced.
    #[must_use]
    pub fn value(&self, setting: QualitySetting) -> Option<u32> {
        let steps = self.quality_reductions().iter().rev();
        steps
            .filter(|step| step.setting == setting)
            .map(|step| step.value)
            .next()
    }

    /// The frame rate to be shown.
    #[must_use]
    pub fn frames_per_second(&self) -> u32 {
        self.value(QualitySetting::FramesPerSecond)
            .map_or(self.frames_per_second, |limit| limit.min(self.frames_per_second))
    }

    /// Takes the measurements of a frame; returns the change if the level changes from the next
    /// frame on.
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

    /// Follows the heat: upwards at once, downwards after it has lasted.
    fn feel(&mut self, thermal: Thermal) {
        if thermal >= self.thermal {
            self.cooler_frames = 0;
        } else {
            self.cooler_frames += 1;
        }
        if thermal > self.thermal || self.cooler_frames >= COOL_FRAMES {
            self.thermal = thermal;
            self.cooler_frames = 0;
            // Earlier loads are ratios to another time.
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

    /// The first level at which the expected load is low enough.
    fn down_to(&self, load: f64) -> usize {
        let mut expected = load;
        let gains = &self.gains[self.level..];
        let n_steps = gains.iter().position(|gain| {
            expected *= gain;
            expected <= AIM
        });
        n_steps.map_or(self.ladder.len(), |last| self.level + last + 1)
    }

    /// Learns the gains of the steps that were taken last.
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
            // The gain of a lower frame rate is known exactly.
            if step.setting != QualitySetting::FramesPerSecond {
                *gain = (*gain * each).clamp(GAINS[0], GAINS[1]);
            }
        }
    }

    fn by_lateness(&mut self) -> Option<usize> {
        let late = self.lates.mean()?;
        let n_steps = MANY_LATE.iter().filter(|part| late >= **part).count();
        // Heat alone requires steps as well if no frame time shows it.
        let n_steps = n_steps.max(usize::from(self.is_too_warm()));
        if n_steps > 0 && self.level < self.ladder.len() {
            return Some((self.level + n_steps).min(self.ladder.len()));
        }
        let above = self.level.checked_sub(1)?;
        let is_low = late <= FEW_LATE && self.thermal <= Thermal::Fair;
        self.low_frames = if is_low { self.low_frames + 1 } else { 0 };
        (self.low_frames >= self.waits[above].max(BLIND_UP_FRAMES)).then_some(above)
    }

    /// Whether the steps taken have, by their own values, too little effect for a phone this warm
    /// to cool down.
    fn is_too_warm(&self) -> bool {
        let taken: f64 = self.ladder[..self.level].iter().map(|step| step.gain).product();
        taken > self.thermal.part()
    }

    fn go(&mut self, to: usize) -> Turned {
        let from = self.level;
        if to > from {
            if self.is_trial && self.age <= TRIAL_FRAMES {
                // The step that was taken up last is the first one to be taken back.
                let wait = self.waits[from].max(if self.loads.median().is_some() {
                    UP_FRAMES
                } else {
                    BLIND_UP_FRAMES
                });
                self.waits[from] = (2 * wait).min(MAX_WAIT_FRAMES);
            }
        } else if self.is_trial && self.age > TRIAL_FRAMES {
            // The previous trial succeeded.
            self.waits[from] = 0;
        }
        self.is_trial = to < from;
        // If the frame rate changes, a load is a ratio to another time, and the gain is the step's
        // value.
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
