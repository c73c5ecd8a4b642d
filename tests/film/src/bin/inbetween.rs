//! Makes the frames between key poses that were printed and photographed one by one.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use anyhow::Context;
use app_core::core::Core;
use app_core::gpu::AdapterChoice;
use app_core::preset::Preset;
use app_core::wgpu;
use clap::Parser;
use desk::page::PAGE_FILE;
use desk::program::{exit_code, print, repository};
use film::ease::Ease;
use film::inbetween::shot::Shot;
use film::inbetween::timing::Rate;
use film::inbetween::{CONTACT_FILE, Options, PictureNames, REPORT_FILE, SHEET_FILE, findings, make};

/// Default folder of results, below the top of the repository.
const RESULTS: &str = "target/inbetween";

/// Make the frames between key poses that were printed and photographed one by one. Misplaced
/// prints, a nudged camera and changing light are detected, corrected and reported.
#[derive(Parser)]
#[command(name = "inbetween", bin_name = "cargo xtask inbetween")]
struct Args {
    /// Folder of the shot, or its shot.json
    shot: PathBuf,
    /// Folder for pictures, xsheet.csv, contact sheet and report [default: target/inbetween/ and the name of the shot's folder]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Number of frames between two keys
    #[arg(long, value_name = "N", default_value_t = 3, conflicts_with = "fps")]
    between: usize,
    /// Frames per second, by the times of the keys, in place of --between
    #[arg(long, value_name = "RATE", value_parser = parse_fps)]
    fps: Option<f64>,
    /// Number of frames of each picture
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..))]
    on: u16,
    /// Change of speed from key to key
    #[arg(long, value_enum, default_value_t)]
    ease: Ease,
    /// How much work a frame may cost
    #[arg(long, value_name = "NAME", default_value_t)]
    preset: Preset,
    /// Number of the first frame
    #[arg(long, value_name = "N", default_value_t = 1)]
    start: u32,
    /// Name of the pictures before their number
    #[arg(long, value_name = "TEXT", default_value = "frame_", value_parser = parse_prefix)]
    name: String,
    /// Show keys as they were photographed, although camera, light and place of the toy jump there
    #[arg(long)]
    keep_keys: bool,
    /// Write onion skins into the folder onion, too: each frame overlaid with the keys beside it
    #[arg(long)]
    onion: bool,
    /// Part of a graphics adapter's name [default: the fastest]
    #[arg(long, value_name = "NAME")]
    adapter: Option<String>,
    /// Print nothing but errors
    #[arg(long)]
    quiet: bool,
}

fn main() -> ExitCode {
    exit_code(run(&Args::parse()))
}

fn run(args: &Args) -> anyhow::Result<()> {
    let out = match &args.out {
        Some(out) => out.clone(),
        None => default_out(&args.shot)?,
    };
    let shot = Shot::open(&args.shot).with_context(|| args.shot.display().to_string())?;
    let adapter = args
        .adapter
        .clone()
        .map_or(AdapterChoice::Fastest, AdapterChoice::Named);
    let core = pollster::block_on(Core::headless(&wgpu::Instance::default(), &adapter))?;
    let options = Options {
        out: out.clone(),
        preset: args.preset,
        rate: args.fps.map_or(Rate::Between(args.between), Rate::PerSecond),
        ease: args.ease,
        hold: usize::from(args.on),
        names: PictureNames {
            prefix: args.name.clone(),
            first: usize::try_from(args.start)?,
        },
        keeps_keys: args.keep_keys,
        has_onion: args.onion,
    };
    let mut progress = |step: usize, n_steps: usize| {
        if !args.quiet {
            eprint!("\r{} of {n_steps} steps", step + 1);
        }
    };
    let film = make(&shot, &core, &options, &mut progress)?;
    if args.quiet {
        return Ok(());
    }
    eprintln!();
    let mut lines = findings(&film.keys);
    let of_shot = shot.warnings().iter().map(ToString::to_string);
    let warnings = of_shot.chain(film.warnings.iter().cloned());
    lines.extend(warnings.map(|warning| format!("warning: {warning}")));
    lines.push(format!(
        "{} pictures, {SHEET_FILE}, {CONTACT_FILE}, {REPORT_FILE} and {PAGE_FILE}, which compares them with the keys, in {}\n",
        film.n_frames,
        out.display()
    ));
    print(&lines.join("\n"))
}

fn default_out(shot: &Path) -> anyhow::Result<PathBuf> {
    // `.` and `..` have a name only after they are resolved.
    let shot = shot.canonicalize().with_context(|| shot.display().to_string())?;
    let folder = if shot.is_file() {
        shot.parent()
    } else {
        Some(&*shot)
    };
    let name = folder.and_then(Path::file_name).unwrap_or("shot".as_ref());
    Ok(repository().join(RESULTS).join(name))
}

fn parse_fps(text: &str) -> Result<f64, String> {
    let fps: f64 = text.parse().map_err(|_| "not a number".to_owned())?;
    if (0.1..=1000.0).contains(&fps) {
        Ok(fps)
    } else {
        Err("not from 0.1 to 1000".to_owned())
    }
}

/// A part of a file name.
fn parse_prefix(text: &str) -> Result<String, String> {
    if text.contains(['/', '\\', ':']) || text.chars().any(char::is_control) {
        Err("it may hold no folder, colon or control character".to_owned())
    } else {
        Ok(text.to_owned())
    }
}
