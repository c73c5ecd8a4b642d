//! Profiles of sessions and of other sources, in the layout of the paper's Table 1.

use std::time::Instant;

use app_core::camera_frame::Display;
use app_core::core::{Core, CoreError};
use app_core::frame::{Clock, StageTime};
use app_core::preset::Preset;
use app_core::profile::{About, Args, DEVICE, FRAME, Frame, PROCESSOR, Profile};
use app_core::session::{Session, SessionError};
use desk::alignment::{Alignments, Asked};
use desk::replay::ReplayError;
use thiserror::Error;

use crate::bench::aligned;
use crate::median::median;

/// The tasks of Table 1, with the times on an iPhone X. Source: Casas et al. 2018, Table 1.
pub const TASKS: [(&str, f64); 9] = [
    ("Object Registration", 1.83),
    ("Auxiliary masks", 2.59),
    ("Object Appearance Retargeting", 1.93),
    ("Shadow Warping", 3.13),
    ("Discretized Search", 15.78),
    ("Uniform Shadow Blurring", 7.36),
    ("Percentage Closer Soft Shadows", 5.27),
    ("Background Inpainting", 2.43),
    ("Scene Rendering", 0.98),
];

/// The reason why there is no profile.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ProfileError {
    /// The session cannot be read.
    #[error(transparent)]
    Session(#[from] SessionError),
    /// The core refuses it.
    #[error(transparent)]
    Core(#[from] CoreError),
    /// A frame cannot be aligned.
    #[error(transparent)]
    Align(#[from] ReplayError),
    /// A profile of another version.
    #[error("version {found}: this program reads version {known}", known = app_core::profile::VERSION)]
    Version {
        /// Its version.
        found: u32,
    },
    /// A file that is no profile.
    #[error("no profile: {0}")]
    Json(#[from] serde_json::Error),
}

/// The task of Table 1 to which a pass or a stage belongs; `None` for work that the paper does not
/// list.
#[must_use]
pub fn task(name: &str) -> Option<&'static str> {
    let index = match name {
        "align" | "placement" => 0,
        "masks" | "eligible" | "census" | "gbuffer" | "validity" | "things" | "withhold" | "moved_mask"
        | "coverage" => 1,
        "toy" | "appearance" | "rim" | "unmix" | "gloss" | "tint" | "tint_fill" | "self_shadow" => 2,
        "warp" | "occlusion" => 3,
        // Sampling of the real shadow: by a search there, by a fit and a residual here.
        "search" | "lit" | "fit" | "fit_solve" | "residual" | "fill" | "detail" => 4,
        "box_filter" => 5,
        "pcss" => 6,
        "plate" | "soften" | "estimate" => 7,
        "camera_planes" | "retarget" | "on_things" | "composite" | "present" | "screen" => 8,
        _ => return None,
    };
    Some(TASKS[index].0)
}

/// Aligns all frames of a session, as other programs do, runs them with a preset twice, and profiles
/// the second run, in which nothing is compiled.
///
/// # Errors
/// When a frame cannot be read, aligned or made.
pub fn profile(session: &dyn Session, core: &mut Core, preset: Preset) -> Result<Profile, ProfileError> {
    let alignments = Alignments::find(session, 0..session.n_frames(), Asked::default())?;
    run(session, &alignments, core, preset)?;
    run(session, &alignments, core, preset)
}

fn run(
    session: &dyn Session,
    alignments: &Alignments,
    core: &mut Core,
    preset: Preset,
) -> Result<Profile, ProfileError> {
    let scene = session.scene();
    let start = Instant::now();
    let now_ms = move || 1e3 * start.elapsed().as_secs_f64();
    core.set_scene(alignments.scene(scene), preset)?;
    core.time_passes(true)?;
    core.time_stages(Some(Clock::new(now_ms)));
    let mut profile = Profile::new(About {
        session: scene.name.clone(),
        preset: preset.name().to_owned(),
        device: core.adapter_name(),
        picture_px: [scene.width_px, scene.height_px],
        ..About::default()
    });
    let screen = core.hidden_screen([scene.width_px, scene.height_px]);
    let mut before_ms = None;
    for number in 0..session.n_frames() {
        let input = alignments.input(number, &session.frame(number)?, preset);
        if let Some(changed) = alignments.changed_scene(scene, number) {
            core.set_scene(changed, preset)?;
        }
        let begin_ms = now_ms();
        let report = core.frame(&input)?;
        let drawn_from_ms = now_ms();
        if let Some(screen) = &screen {
            core.draw_on(screen, Display::default())?;
        }
        let end_ms = now_ms();
        let on_screen = StageTime {
            stage: "screen",
            begin_ms: drawn_from_ms,
            cpu_ms: end_ms - drawn_from_ms,
        };
        let pass_times = core.read_pass_times()?;
        let args = Args {
            number: Some(number as u64),
            kind: report.change.map(|change| change.name().to_owned()),
            interval_ms: before_ms.map(|before: f64| begin_ms - before),
            ..Args::default()
        };
        before_ms = Some(begin_ms);
        let frame = Frame {
            begin_ms,
            cpu_ms: end_ms - begin_ms,
            further_stages: &[on_screen],
            pass_times: &pass_times,
            args,
        };
        profile.add(&report, frame);
    }
    core.time_stages(None);
    Ok(profile)
}

/// Reads a profile of a phone, or of another run.
///
/// # Errors
/// When it is invalid, or has another version.
pub fn parse(text: &str) -> Result<Profile, ProfileError> {
    let profile: Profile = serde_json::from_str(text)?;
    if profile.about.version != app_core::profile::VERSION {
        return Err(ProfileError::Version {
            found: profile.about.version,
        });
    }
    Ok(profile)
}

/// For each kind of frame the tasks of Table 1, beside the paper's; then the stages on the
/// processor, and the passes.
#[must_use]
pub fn tables(profile: &Profile) -> String {
    let about = &profile.about;
    let [width, height] = about.picture_px;
    let mut text = format!(
        "{} {} {width} x {height} on {}\n",
        about.session, about.preset, about.device
    );
    text.push_str(&camera_words(profile));
    for kind in ["pose", "picture", "view", "scene"] {
        let frames = frames_of(profile, kind);
        if !frames.is_empty() {
            let heads = [kind, "ms", "%", "paper ms", "paper %"]
                .map(str::to_owned)
                .to_vec();
            text.push_str(&format!("\nnew {kind}, mean of {} frames\n", frames.len()));
            text.push_str(&aligned(&task_rows(profile, &frames, heads)));
        }
    }
    text
}

/// Age of the camera's pictures when they were shown, and number of dropped ones; empty without a
/// camera's data.
fn camera_words(profile: &Profile) -> String {
    let frames = || profile.scopes(PROCESSOR).filter(|event| event.name == FRAME);
    let ages_ms: Vec<f64> = frames()
        .filter_map(|frame| frame.args.camera_to_present_ms)
        .collect();
    let longest = ages_ms.iter().copied().max_by(f64::total_cmp);
    let Some((median, longest)) = median(ages_ms).zip(longest) else {
        return String::new();
    };
    let n_dropped: u64 = frames().filter_map(|frame| frame.args.dropped).sum();
    format!(
        "camera to present: median {median:.1} ms, longest {longest:.1} ms; {n_dropped} pictures dropped\n"
    )
}

/// Start and end of each frame of a kind, in microseconds.
fn frames_of(profile: &Profile, kind: &str) -> Vec<(f64, f64)> {
    let all: Vec<_> = profile
        .scopes(PROCESSOR)
        .filter(|event| event.name == FRAME)
        .collect();
    let of_kind = all
        .iter()
        .enumerate()
        .filter(|(_, event)| event.args.kind.as_deref() == Some(kind));
    // Events of a frame begin before the next frame does.
    let end = |index: usize| all.get(index + 1).map_or(f64::INFINITY, |next| next.ts);
    of_kind.map(|(index, event)| (event.ts, end(index))).collect()
}

fn task_rows(profile: &Profile, frames: &[(f64, f64)], heads: Vec<String>) -> Vec<Vec<String>> {
    let per_frame = 1e-3 / frames.len() as f64;
    let is_within = |ts: f64| frames.iter().any(|(begin, end)| (*begin..*end).contains(&ts));
    let mean_ms = |threads: &[u32], wanted: &dyn Fn(&str) -> bool| -> f64 {
        let events = threads.iter().flat_map(|tid| profile.scopes(*tid));
        let events = events.filter(|event| event.name != FRAME && is_within(event.ts) && wanted(&event.name));
        // In this order no time counts twice: stages and passes of a task are disjoint.
        events.fold(0.0, |sum, event| sum + event.dur) * per_frame
    };
    let of_task = |name: &str| mean_ms(&[PROCESSOR, DEVICE], &|scope| task(scope) == Some(name));
    let total: f64 = TASKS.iter().map(|(name, _)| of_task(name)).sum();
    let published: f64 = TASKS.iter().map(|(_, ms)| ms).sum();
    let row = |name: &str, ms: f64, paper_ms: f64| {
        let percent = |part: f64, whole: f64| if whole > 0.0 { 100.0 * part / whole } else { 0.0 };
        vec![
            name.to_owned(),
            format!("{ms:.2}"),
            format!("{:.2}", percent(ms, total)),
            format!("{paper_ms:.2}"),
            format!("{:.2}", percent(paper_ms, published)),
        ]
    };
    let mut rows = vec![heads];
    rows.extend(TASKS.iter().map(|(name, ms)| row(name, of_task(name), *ms)));
    rows.push(row("Total", total, published));
    let blank = |name: String, ms: f64| {
        vec![
            name,
            format!("{ms:.2}"),
            String::new(),
            String::new(),
            String::new(),
        ]
    };
    for tid in [PROCESSOR, DEVICE] {
        let mut names: Vec<&str> = Vec::new();
        for event in profile
            .scopes(tid)
            .filter(|event| event.name != FRAME && is_within(event.ts))
        {
            if !names.contains(&event.name.as_str()) {
                names.push(&event.name);
            }
        }
        let place = if tid == PROCESSOR {
            "on the processor"
        } else {
            "on the device"
        };
        rows.extend(names.iter().map(|name| {
            blank(
                format!("{place}: {name}"),
                mean_ms(&[tid], &|scope| scope == *name),
            )
        }));
    }
    rows
}
