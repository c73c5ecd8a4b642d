//! Replays a recorded session through the core and writes its pictures and a report.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use anyhow::{Context, bail};
use app_core::core::Core;
use app_core::gpu::AdapterChoice;
use app_core::preset::Preset;
use app_core::wgpu;
use clap::Parser;
use desk::alignment::{Lights, RatioArgs};
use desk::files::BUNDLED_SESSION;
use desk::frames::Frames;
use desk::opened;
use desk::opened::Opened;
use desk::page::PAGE_FILE;
use desk::program::{exit_code, print, results_of};
use desk::progress::{Progress, Quiet, on_stderr};
use desk::replay::{Options, REPORT_FILE, check_out, replay};
use desk::report::{FrameEntry, Report};
use desk::shaders::ShaderArgs;

/// Default folder of results, below the top of the repository.
const RESULTS: &str = "target/replay";

/// The reason to pass a frame through that shows the toy in its own pose.
const AS_RECORDED: &str = "the shown pose is the physical pose";

/// Replay a recorded session: one picture per frame, report.json with times, passes and (if there
/// is a truth) errors, and index.html to look at it all.
#[derive(Parser)]
#[command(name = "replay", bin_name = "cargo xtask replay")]
struct Args {
    /// Folder of the session, or a recording [default: the bundled one]
    session: Option<PathBuf>,
    /// Folder for pictures, report and page [default: target/replay/ and the name of folder or recording]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// How much work a frame may cost; several are shown side by side
    #[arg(long = "preset", value_name = "NAME,...", value_delimiter = ',', default_values_t = [Preset::default()])]
    presets: Vec<Preset>,
    /// Only these frames: 3 is one frame, A..B goes from A up to but not including B, 3.. goes to
    /// the last, ..2 has the first two
    #[arg(long, value_name = "A..B")]
    frames: Option<Frames>,
    /// Part of a graphics adapter's name [default: the fastest]
    #[arg(long, value_name = "NAME")]
    adapter: Option<String>,
    #[command(flatten)]
    shaders: ShaderArgs,
    /// Take cameras, poses and lights as recorded, without aligning them by the pictures
    #[arg(long, conflicts_with_all = ["focal_length", "world_scale", "lens"])]
    as_given: bool,
    /// Ignore the session's list of lights, and estimate them from their shadows
    #[arg(long, value_enum, default_value_t, conflicts_with = "as_given")]
    lights: Lights,
    #[command(flatten)]
    ratio: RatioArgs,
    /// End with exit code 1 if there was any warning, or if a frame was passed through although the
    /// toy is to be shown elsewhere
    #[arg(long)]
    strict: bool,
    /// Print nothing but errors
    #[arg(long)]
    quiet: bool,
}

fn main() -> ExitCode {
    exit_code(run(&Args::parse()))
}

fn run(args: &Args) -> anyhow::Result<()> {
    let folder = args.session.as_deref().unwrap_or(Path::new(BUNDLED_SESSION));
    let out = match &args.out {
        Some(out) => out.clone(),
        None => results_of(folder, RESULTS)?,
    };
    check_out(&out)?;
    let opened = opened::open(folder, args.ratio.lens(), args.lights);
    let Opened { capture, lens } = opened.with_context(|| folder.display().to_string())?;
    let adapter = args
        .adapter
        .clone()
        .map_or(AdapterChoice::Fastest, AdapterChoice::Named);
    let mut core = pollster::block_on(Core::headless(&wgpu::Instance::default(), &adapter))?;
    args.shaders.hand_to(&mut core)?;
    let options = Options {
        presets: without_repeats(&args.presets),
        quality_reductions: &[],
        frames: args.frames.unwrap_or(Frames::ALL),
        out: Some(out.clone()),
        is_aligned: !args.as_given,
        lights: args.lights,
        ratio: args.ratio.asked(),
        lens,
    };
    let mut progress: Box<dyn Progress> = if args.quiet { Box::new(Quiet) } else { on_stderr() };
    let reports = replay(&capture, Some(&capture), &mut core, &options, progress.as_mut())?;
    if !args.quiet {
        print(&summary(&reports, &out))?;
    }
    let complaints = complaints(&reports);
    match complaints.first() {
        Some(first) if args.strict => {
            bail!(
                "{} complaints under --strict, the first: {first}",
                complaints.len()
            )
        }
        _ => Ok(()),
    }
}

fn without_repeats(presets: &[Preset]) -> Vec<Preset> {
    let mut unique = Vec::new();
    for preset in presets {
        if !unique.contains(preset) {
            unique.push(*preset);
        }
    }
    unique
}

fn summary(reports: &[Report], out: &Path) -> String {
    let mut lines: Vec<String> = reports.iter().flat_map(summary_of).collect();
    let n_pictures: usize = reports.iter().map(|report| report.frames.len()).sum();
    lines.push(format!(
        "{n_pictures} pictures and {REPORT_FILE} in {}, to be seen in {PAGE_FILE}",
        out.display()
    ));
    lines.join("\n") + "\n"
}

fn summary_of(report: &Report) -> Vec<String> {
    let mut lines = vec![format!(
        "{} with preset {} on {}",
        report.session, report.preset, report.adapter
    )];
    lines.push(frames_of(report));
    lines.extend(
        report
            .warnings
            .iter()
            .map(|warning| format!("warning: {warning}")),
    );
    if let Some(lens) = &report.lens {
        lines.push(format!(
            "lens k1 {:.4}, k2 {:.4}: {}",
            lens.distortion.k1, lens.distortion.k2, lens.outcome
        ));
    }
    let mean = &report.mean_of_moving;
    if let Some(scores) = mean.scores {
        let regions = [
            ("shadow", scores.shadow),
            ("toy", scores.toy),
            ("edge", scores.edge),
            ("frame", scores.frame),
        ]
        .map(|(name, score)| format!("{name} {:.2} ({:.4})", score.rmse, score.ssim));
        lines.push(format!(
            "mean RMSE (SSIM) against the truth over {} retargeted frames: {}",
            mean.n_scored,
            regions.join(", ")
        ));
    }
    if let Some(flicker) = mean.flicker {
        lines.push(format!(
            "mean flicker (RMSE of changes from frame to frame): shadow {:.2}, toy {:.2}, edge {:.2}, frame {:.2}",
            flicker.shadow, flicker.toy, flicker.edge, flicker.frame
        ));
    }
    lines
}

/// The number of retargeted frames, and the reasons of the others.
fn frames_of(report: &Report) -> String {
    let mut reasons: Vec<(&str, usize)> = Vec::new();
    for reason in report.frames.iter().filter_map(FrameEntry::reason_to_pass) {
        match reasons.iter_mut().find(|(known, _)| *known == reason) {
            Some((_, n_frames)) => *n_frames += 1,
            None => reasons.push((reason, 1)),
        }
    }
    let n_retargeted = report.frames.iter().filter(|frame| frame.is_retargeted()).count();
    let passed = reasons
        .iter()
        .map(|(reason, n_frames)| format!("; {n_frames} passed through, since {reason}"));
    format!(
        "{n_retargeted} of {} frames retargeted{}",
        report.frames.len(),
        passed.collect::<String>()
    )
}

/// The reasons for which a strict replay fails: each warning, and each frame that was passed
/// through although it requests another pose.
fn complaints(reports: &[Report]) -> Vec<String> {
    let mut all = Vec::new();
    for report in reports {
        all.extend(report.warnings.iter().cloned());
        for frame in &report.frames {
            let place = format!("frame {} with {}", frame.index, report.preset);
            all.extend(frame.warnings().map(|warning| format!("{place}: {warning}")));
            let reason = frame.reason_to_pass().filter(|reason| *reason != AS_RECORDED);
            all.extend(reason.map(|reason| format!("{place} was passed through, since {reason}")));
        }
    }
    all
}
