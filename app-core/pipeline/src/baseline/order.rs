//! The order of the baseline's steps: the same list is planned and run.

use crate::baseline::plan::BaselinePlan;
use crate::baseline::{box_filter, census, search};
use crate::gpu::pass_run::Path;
use crate::plan::{Change, News};

/// Which of the toy's poses.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Pose {
    Physical,
    Shown,
}

/// One step of the baseline.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Step {
    Plate,
    Masks,
    /// The shadow of one light in a pose.
    Warp(Pose, u32),
    Pcss(Pose),
    Eligible,
    Census,
    Search,
    BoxFilter,
    Retarget,
}

impl Step {
    /// The pass that it runs; `box_filter` several times.
    pub(crate) fn pass(self) -> &'static str {
        match self {
            Self::Plate => "plate",
            Self::Masks => "masks",
            Self::Warp(..) => "warp",
            Self::Pcss(_) => "pcss",
            Self::Eligible => "eligible",
            Self::Census => "census",
            Self::Search => "search",
            Self::BoxFilter => "box_filter",
            Self::Retarget => "retarget",
        }
    }

    /// Whether it runs: of a paused toy a new picture changes the colours alone.
    pub(crate) fn is_due(self, news: News) -> bool {
        match self {
            Self::Warp(Pose::Shown, _) | Self::Pcss(Pose::Shown) => !news.keeps_pose(),
            _ => !news.keeps_picture(),
        }
    }
}

/// The steps that run for `change`.
pub(crate) fn order(plan: &BaselinePlan, change: Change) -> Vec<(Path, Step)> {
    let mut steps = Vec::new();
    if change >= Change::View {
        steps.extend([Step::Plate, Step::Masks].map(on(Path::Capture)));
        steps.extend(shadow(plan, Pose::Physical).map(on(Path::Capture)));
        steps.push((Path::Capture, Step::Eligible));
        add_if(&mut steps, census::is_needed(plan), (Path::Capture, Step::Census));
    }
    // The plate is brought to the exposure of the new picture.
    add_if(&mut steps, change == Change::Picture, (Path::Frame, Step::Plate));
    steps.extend(shadow(plan, Pose::Shown).map(on(Path::Frame)));
    add_if(&mut steps, search::is_needed(plan), (Path::Frame, Step::Search));
    add_if(
        &mut steps,
        box_filter::is_needed(plan),
        (Path::Frame, Step::BoxFilter),
    );
    steps.push((Path::Frame, Step::Retarget));
    steps
}

/// Warps and visibility of a pose.
fn shadow(plan: &BaselinePlan, pose: Pose) -> impl Iterator<Item = Step> {
    (0..plan.n_lights)
        .map(move |light| Step::Warp(pose, light))
        .chain([Step::Pcss(pose)])
}

fn on(path: Path) -> impl Fn(Step) -> (Path, Step) {
    move |step| (path, step)
}

fn add_if(steps: &mut Vec<(Path, Step)>, is_needed: bool, step: (Path, Step)) {
    if is_needed {
        steps.push(step);
    }
}
