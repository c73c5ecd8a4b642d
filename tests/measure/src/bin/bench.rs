//! Measures presets over recorded sessions: speed against error, as a table and as bench.csv.

use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use anyhow::Context;
use app_core::core::Core;
use app_core::gpu::AdapterChoice;
use app_core::preset::Preset;
use app_core::session::Capture;
use app_core::wgpu;
use clap::Parser;
use desk::alignment::{Lights, RatioArgs};
use desk::files::BUNDLED_SESSION;
use desk::frames::Frames;
use desk::opened;
use desk::opened::Opened;
use desk::output::{make_folder, remove_file, write_png, write_whole};
use desk::program::{exit_code, open_session, print, repository};
use desk::shaders::ShaderArgs;
use measure::bench::{
    Options, Row, basin, basin_csv, basin_drawing, basin_table, bench, claims_drawing, claims_summary, csv,
    file_names, front_drawing, json, rebuild, rebuilt_table, table,
};
use measure::sized::{SizePx, parse_size};

/// Default folder of the result, below the top of the repository.
const RESULTS: &str = "target/bench";
/// File name of the result.
const CSV_FILE: &str = "bench.csv";
/// The same for programs.
const JSON_FILE: &str = "bench.json";
/// Error against time.
const FRONT_FILE: &str = "front.svg";
/// Errors of poses over claimed deviations, of all sessions together.
const CLAIMS_FILE: &str = "claims.svg";

/// Measure presets over recorded sessions: error, time of a frame and of the capture path, as a table, bench.csv and bench.json.
#[derive(Parser)]
#[command(name = "bench", bin_name = "cargo xtask bench")]
struct Args {
    /// Folders of sessions, or recordings [default: the bundled one]
    sessions: Vec<PathBuf>,
    /// Folder for bench.csv [default: target/bench]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Presets, separated by commas [default: all]
    #[arg(
        long = "preset",
        alias = "presets",
        value_name = "NAME,...",
        value_delimiter = ','
    )]
    presets: Vec<Preset>,
    /// Number of timings of each frame
    #[arg(long, value_name = "N", default_value_t = 3, value_parser = clap::value_parser!(u16).range(1..))]
    repeats: u16,
    /// Only these frames of each session: 3 is one frame, A..B goes from A up to but not including
    /// B, 3.. goes to the last, ..2 has the first two
    #[arg(long, value_name = "A..B")]
    frames: Option<Frames>,
    /// The first N frames; an older form of --frames
    #[arg(long, hide = true, conflicts_with = "frames", value_parser = clap::value_parser!(u16).range(1..))]
    first: Option<u16>,
    /// Time and count pictures of this size; errors are of the session's own [default: the session's]
    #[arg(long, value_name = "WIDTHxHEIGHT", value_parser = parse_size)]
    size: Option<SizePx>,
    /// Time and count pictures as a phone's planes of luma and chroma rather than as pixels
    #[arg(long)]
    planes: bool,
    /// Add rows with the governor's quality steps, one after the other, and draw error against time
    #[arg(long)]
    front: bool,
    /// Add rows with ray-traced visibility, which takes minutes
    #[arg(long)]
    exact: bool,
    /// Instead, render the photographs from the shadow of the first one alone, for sessions without
    /// a truth
    #[arg(long, conflicts_with_all = ["exact", "front", "repeats", "first", "frames", "lights", "focal_length", "world_scale", "lens"])]
    withheld: bool,
    /// Instead, disturb pose and lights of the first frame by growing amounts, align them, and draw
    /// the remaining errors
    #[arg(long, conflicts_with_all = ["exact", "front", "repeats", "first", "frames", "lights", "focal_length", "world_scale", "lens", "withheld", "as_given", "presets", "adapter"])]
    basin: bool,
    /// Seed of the directions of these disturbances
    #[arg(long, value_name = "N", default_value_t = 1, requires = "basin")]
    seed: u64,
    /// Number of disturbances
    #[arg(long, value_name = "N", default_value_t = 24, requires = "basin", value_parser = clap::value_parser!(u16).range(1..))]
    draws: u16,
    /// Take cameras, poses and lights as recorded, without aligning them by the pictures
    #[arg(long, conflicts_with_all = ["focal_length", "world_scale", "lens"])]
    as_given: bool,
    /// Ignore the session's list of lights, and estimate them from their shadows
    #[arg(long, value_enum, default_value_t, conflicts_with = "as_given")]
    lights: Lights,
    #[command(flatten)]
    ratio: RatioArgs,
    /// Part of a graphics adapter's name [default: the fastest]
    #[arg(long, value_name = "NAME")]
    adapter: Option<String>,
    #[command(flatten)]
    shaders: ShaderArgs,
}

fn main() -> ExitCode {
    exit_code(run(&Args::parse()))
}

fn run(args: &Args) -> anyhow::Result<()> {
    let bundled = [PathBuf::from(BUNDLED_SESSION)];
    let folders = if args.sessions.is_empty() {
        &bundled[..]
    } else {
        &args.sessions
    };
    let adapter = args
        .adapter
        .clone()
        .map_or(AdapterChoice::Fastest, AdapterChoice::Named);
    let results = || repository().join(RESULTS);
    let out = args.out.clone().unwrap_or_else(results);
    make_folder(&out)?;
    if args.basin {
        return basins(folders, args, &out);
    }
    let mut core = pollster::block_on(Core::headless(&wgpu::Instance::default(), &adapter))?;
    args.shaders.hand_to(&mut core)?;
    if args.withheld {
        return rebuild_all(folders, &mut core, args, &out);
    }
    // None of an earlier run lies beside the new ones.
    for file in [CSV_FILE, JSON_FILE, FRONT_FILE] {
        remove_file(&out.join(file))?;
    }
    let mut rows = Vec::new();
    let measured = of_each(folders, |_, folder| {
        rows.extend(measure(folder, &mut core, args)?);
        Ok(())
    });
    if !rows.is_empty() {
        report(&rows, &core, args.front, &out)?;
    }
    measured
}

/// Writes and prints the rows.
fn report(rows: &[Row], core: &Core, has_front: bool, out: &Path) -> anyhow::Result<()> {
    write_whole(&out.join(JSON_FILE), format!("{:#}\n", json(rows)).as_bytes())?;
    if has_front {
        let drawing = front_drawing(rows).map_err(anyhow::Error::msg)?;
        write_whole(&out.join(FRONT_FILE), drawing.as_bytes())?;
    }
    let result = out.join(CSV_FILE);
    write_whole(&result, csv(rows).as_bytes())?;
    let text = table(rows, &core.adapter_name(), core.is_software());
    print(&format!("{text}{}\n", result.display()))
}

/// Measures one session after the other, each under a name of its own, up to the first that fails.
fn of_each(
    folders: &[PathBuf],
    mut measure: impl FnMut(&str, &Path) -> anyhow::Result<()>,
) -> anyhow::Result<()> {
    for (name, folder) in file_names(folders)?.iter().zip(folders) {
        let _ = writeln!(io::stderr(), "{}", folder.display());
        measure(name, folder).with_context(|| folder.display().to_string())?;
    }
    Ok(())
}

/// Prints the basin of convergence of alignment, and writes tables and drawings, of several sessions
/// also one of all. Needs no device.
fn basins(folders: &[PathBuf], args: &Args, out: &Path) -> anyhow::Result<()> {
    let mut text = String::new();
    let mut all = Vec::new();
    let measured = of_each(folders, |name, folder| {
        let capture = Capture::open(open_session(folder)?)?;
        let draws = basin(&capture, args.seed, args.draws)?;
        let drawing = basin_drawing(name, &draws).map_err(anyhow::Error::msg)?;
        write_whole(
            &out.join(format!("{name}-basin.csv")),
            basin_csv(&draws).as_bytes(),
        )?;
        write_whole(&out.join(format!("{name}-basin.svg")), drawing.as_bytes())?;
        text.push_str(&format!("{name}\n{}", basin_table(&draws)));
        all.push(draws);
        Ok(())
    });
    if all.len() > 1 {
        let drawing = claims_drawing(&all).map_err(anyhow::Error::msg)?;
        write_whole(&out.join(CLAIMS_FILE), drawing.as_bytes())?;
        text.extend(claims_summary(&all).map(|summary| format!("all\n{summary}\n")));
    }
    text.push_str(
        "Median and worst remaining error, relative to the recorded values; a row has the starts beyond those of the row above.\n",
    );
    if !all.is_empty() {
        print(&format!("{text}{}\n", out.display()))?;
    }
    measured
}

/// Prints the accuracy of predicted shadows, and writes the pictures.
fn rebuild_all(folders: &[PathBuf], core: &mut Core, args: &Args, out: &Path) -> anyhow::Result<()> {
    let mut all = Vec::new();
    let measured = of_each(folders, |name, folder| {
        let capture = Capture::open(open_session(folder)?)?;
        for one in rebuild(&capture, core, &presets(args), !args.as_given)? {
            let file = format!("{name}-{}-rebuilt_{:04}.png", one.preset, one.frame);
            write_png(&out.join(file), &one.picture)?;
            all.push(one);
        }
        Ok(())
    });
    if !all.is_empty() {
        print(&format!("{}{}\n", rebuilt_table(&all), out.display()))?;
    }
    measured
}

fn presets(args: &Args) -> Vec<Preset> {
    if args.presets.is_empty() {
        Preset::ALL.to_vec()
    } else {
        args.presets.clone()
    }
}

fn frames(args: &Args) -> Frames {
    let first = args.first.map(|n_frames| Frames::from(0..usize::from(n_frames)));
    args.frames.or(first).unwrap_or(Frames::ALL)
}

fn measure(folder: &Path, core: &mut Core, args: &Args) -> anyhow::Result<Vec<Row>> {
    let Opened { capture, .. } = opened::open(folder, args.ratio.lens(), args.lights)?;
    let options = Options {
        presets: presets(args),
        with_front: args.front,
        n_repeats: usize::from(args.repeats),
        frames: frames(args),
        size_px: args.size,
        as_planes: args.planes,
        with_exact: args.exact,
        is_aligned: !args.as_given,
        lights: args.lights,
        ratio: args.ratio.asked(),
    };
    Ok(bench(&capture, core, &options)?)
}
