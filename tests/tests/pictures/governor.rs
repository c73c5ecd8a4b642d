//! The governor with a simulated phone: it returns to a frame's time, restores quality, and does
//! not oscillate.

use app_core::governor::{
    BALANCED_QUALITY_LADDER, Exhausted, Governor, Measured, QualitySetting, SETTLE_FRAMES, Thermal, Turned,
    UP_FRAMES, WINDOW,
};

/// A screen's frame at 60 Hz.
const SCREEN_MS: f64 = 1e3 / 60.0;
/// Number of frames until a device time is known.
const N_DELAY: usize = 2;
/// Number of frames in a minute.
const MINUTE: usize = 3600;

/// A device whose steps have other gains than the governor expects.
struct Phone {
    governor: Governor,
    /// Time of a frame at full quality.
    full_ms: f64,
    /// Exponent of a step's expected gain: 1 is the expected gain, 0 is none.
    truth: f64,
    /// Relative standard deviation of a frame's time.
    noise: f64,
    /// Share of frames that take three times as long.
    spikes: f64,
    has_stamps: bool,
    thermal: Thermal,
    state: u64,
    times_ms: Vec<f64>,
    turns: Vec<(usize, Turned)>,
}

impl Phone {
    fn new(full_ms: f64) -> Self {
        Self {
            governor: Governor::new(BALANCED_QUALITY_LADDER, 60),
            full_ms,
            truth: 1.0,
            noise: 0.05,
            spikes: 0.02,
            has_stamps: true,
            thermal: Thermal::Nominal,
            state: 1,
            times_ms: Vec::new(),
            turns: Vec::new(),
        }
    }

    /// Uniform in 0 to 1. Source: Knuth's linear congruential generator (MMIX).
    fn uniform(&mut self) -> f64 {
        self.state = self
            .state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.state >> 11) as f64 / (1u64 << 53) as f64
    }

    /// A frame's time on the device, from the steps taken, noise and spikes.
    fn time_ms(&mut self) -> f64 {
        let taken = self.governor.quality_reductions().iter();
        let cost = taken.filter(|step| step.setting != QualitySetting::FramesPerSecond);
        let gain: f64 = cost.map(|step| step.gain.powf(self.truth)).product();
        let normal: f64 = (0..12).map(|_| self.uniform()).sum::<f64>() - 6.0;
        let spike = if self.uniform() < self.spikes { 3.0 } else { 1.0 };
        self.full_ms * gain * (1.0 + self.noise * normal).max(0.1) * spike
    }

    fn budget_ms(&self) -> f64 {
        1e3 / f64::from(self.governor.frames_per_second())
    }

    fn run(&mut self, n_frames: usize) {
        for _ in 0..n_frames {
            let time_ms = self.time_ms();
            self.times_ms.push(time_ms);
            let known = self.times_ms.len().checked_sub(1 + N_DELAY);
            // A screen shows a frame for an integer number of its own.
            let screens = (time_ms / SCREEN_MS).ceil().max(self.budget_ms() / SCREEN_MS);
            let frame = Measured {
                gpu_ms: known
                    .filter(|_| self.has_stamps)
                    .map(|index| self.times_ms[index]),
                interval_ms: screens.round() * SCREEN_MS,
                thermal: self.thermal,
            };
            if let Some(turned) = self.governor.take(&frame) {
                self.turns.push((self.times_ms.len(), turned));
            }
        }
    }

    fn level(&self) -> usize {
        self.governor.quality_reductions().len()
    }

    /// Share of the latest frames that took longer than permitted.
    fn late_share(&self, n_frames: usize) -> f64 {
        let latest = &self.times_ms[self.times_ms.len() - n_frames..];
        let n_late = latest.iter().filter(|time| **time > self.budget_ms()).count();
        n_late as f64 / n_frames as f64
    }

    /// Number of changes of direction among the latest steps.
    fn n_reversals(&self, from: usize) -> usize {
        let ups: Vec<bool> = self
            .turns
            .iter()
            .filter(|(at, _)| *at > from)
            .map(|(_, t)| t.to < t.from)
            .collect();
        ups.windows(2).filter(|pair| pair[0] != pair[1]).count()
    }
}

#[test]
fn noise_alone_turns_nothing() {
    let mut phone = Phone::new(0.72 * SCREEN_MS);
    phone.noise = 0.15;
    phone.run(10 * MINUTE);
    assert_eq!(phone.turns, [], "at a load of .72");
}

#[test]
fn a_step_of_the_load_is_answered_within_half_a_second_and_taken_back_when_it_is_over() {
    // Exponent of the steps' gains, from half to one and a half times the expected.
    for truth in [0.5, 1.0, 1.5] {
        let mut phone = Phone::new(0.6 * SCREEN_MS);
        phone.truth = truth;
        phone.run(MINUTE);
        assert_eq!(phone.level(), 0);
        phone.full_ms = 1.2 * SCREEN_MS;
        let begin = phone.times_ms.len();
        // Two decisions, the second because the gain was less than expected: two thirds of a
        // second.
        phone.run(40);
        let level = phone.level();
        phone.run(30);
        assert!(phone.late_share(30) < 0.15, "{truth}: {:?}", phone.turns);
        phone.run(MINUTE);
        assert!(
            phone.late_share(MINUTE) < 0.03,
            "{truth}: {}",
            phone.late_share(MINUTE)
        );
        assert!(
            level > 0 && phone.n_reversals(begin) <= 1,
            "{truth}: {:?}",
            phone.turns
        );
        assert!(!phone.governor.quality_reductions()[0].what.is_empty());
        // Each step up waits for its time and a window.
        phone.full_ms = 0.5 * SCREEN_MS;
        let wait = UP_FRAMES as usize + WINDOW + SETTLE_FRAMES as usize + N_DELAY;
        phone.run((phone.level() + 1) * wait);
        assert_eq!(phone.level(), 0, "{truth}: {:?}", phone.turns);
    }
}

#[test]
fn whatever_the_load_it_comes_to_rest() {
    for truth in [0.5, 1.0, 1.5, 4.0] {
        for percent in (50..260).step_by(7) {
            let mut phone = Phone::new(f64::from(percent) / 100.0 * SCREEN_MS);
            phone.truth = truth;
            phone.run(5 * MINUTE);
            let before = phone.times_ms.len();
            phone.run(10 * MINUTE);
            let late: Vec<_> = phone.turns.iter().filter(|(at, _)| *at > before).collect();
            assert!(late.len() <= 1, "{truth} at {percent} %: {late:?}");
            let is_at_end = phone.level() == BALANCED_QUALITY_LADDER.len();
            assert!(
                phone.late_share(MINUTE) < 0.05 || is_at_end,
                "{truth} at {percent} %"
            );
        }
    }
}

#[test]
fn slow_heat_goes_down_step_by_step_and_comes_back_only_when_it_lasts() {
    let mut phone = Phone::new(0.7 * SCREEN_MS);
    for minute in 0..20 {
        // The phone throttles: its frames take longer with every minute.
        phone.full_ms = 0.7 * SCREEN_MS * (1.0 + 0.04 * f64::from(minute));
        phone.thermal = match minute {
            0..6 => Thermal::Nominal,
            6..12 => Thermal::Fair,
            _ => Thermal::Serious,
        };
        phone.run(MINUTE);
        assert!(
            phone.late_share(MINUTE / 2) < 0.05,
            "minute {minute}: {:?}",
            phone.turns
        );
    }
    let ups = phone.turns.iter().filter(|(_, turned)| turned.to < turned.from);
    assert_eq!(ups.count(), 0, "{:?}", phone.turns);
    let hot = phone.level();
    assert!(hot >= 3, "{:?}", phone.turns);
    // A phone that alternately reports being cool and not being cool is not believed.
    phone.full_ms = 0.5 * SCREEN_MS;
    for _ in 0..20 {
        phone.thermal = Thermal::Nominal;
        phone.run(MINUTE / 2);
        phone.thermal = Thermal::Serious;
        phone.run(60);
    }
    assert_eq!(phone.level(), hot, "{:?}", phone.turns);
    phone.thermal = Thermal::Nominal;
    phone.run(MINUTE + hot * 200);
    assert_eq!(phone.level(), 0, "{:?}", phone.turns);
}

#[test]
fn without_device_times_late_frames_tell_and_trials_grow_rare() {
    let mut phone = Phone::new(0.6 * SCREEN_MS);
    phone.has_stamps = false;
    // If hardly a frame is late for another reason, nothing else prevents trials.
    (phone.noise, phone.spikes) = (0.01, 0.0);
    phone.run(5 * MINUTE);
    assert_eq!(phone.turns, []);
    phone.full_ms = 1.15 * SCREEN_MS;
    phone.run(MINUTE);
    assert!(phone.level() > 0);
    phone.run(30 * MINUTE);
    // Half an hour under a load that only the steps reduce: each trial is late for less than a
    // second.
    assert!(
        phone.late_share(30 * MINUTE) < 0.03,
        "{}",
        phone.late_share(30 * MINUTE)
    );
    // The wait has doubled to its maximum, 9600 frames; a trial changes direction twice.
    let last = phone.times_ms.len() - 10 * MINUTE;
    let n_late = phone.turns.iter().filter(|(at, _)| *at > last).count();
    assert!(n_late <= 10, "{:?}", phone.turns);
    phone.full_ms = 0.5 * SCREEN_MS;
    phone.run(30 * MINUTE);
    assert_eq!(phone.level(), 0, "{:?}", phone.turns);
}

/// A governor that never waits oscillates, and the test's measure detects it.
#[test]
fn a_planted_swing_is_found() {
    let mut phone = Phone::new(0.6 * SCREEN_MS);
    for burst in 0..20 {
        phone.full_ms = SCREEN_MS * if burst % 2 == 0 { 1.3 } else { 0.4 };
        phone.run(MINUTE / 6);
    }
    assert!(phone.n_reversals(0) > 4, "{:?}", phone.turns);
}

#[test]
fn thirty_frames_a_second_are_the_last_resort_and_a_frame_then_has_twice_the_time() {
    let mut phone = Phone::new(2.2 * SCREEN_MS);
    phone.run(MINUTE);
    assert_eq!(phone.governor.frames_per_second(), 30);
    assert_eq!(
        phone.governor.quality_reductions().last().unwrap().setting,
        QualitySetting::FramesPerSecond
    );
    assert!(phone.late_share(MINUTE / 2) < 0.05);
}

#[test]
fn what_no_step_helps_is_said_so_that_a_cheaper_preset_can() {
    let after = |gpu_ms: f64, thermal: Thermal| {
        let mut governor = Governor::new(BALANCED_QUALITY_LADDER, 30);
        (0..3000).find_map(|n| {
            governor.take(&Measured {
                gpu_ms: Some(gpu_ms),
                interval_ms: 33.0,
                thermal,
            });
            governor.exhausted().map(|why| (why, n))
        })
    };
    assert_eq!(after(5.0, Thermal::Fair), None);
    let (why, n_frames) = after(200.0, Thermal::Nominal).expect("too slow at any step");
    assert!(
        why == Exhausted::Slow && (90..300).contains(&n_frames),
        "{why:?} after {n_frames}"
    );
    let (why, n_frames) = after(5.0, Thermal::Serious).expect("still too warm");
    assert!(
        why == Exhausted::Warm && (900..1000).contains(&n_frames),
        "{why:?} after {n_frames}"
    );
}
