//! Profiles a session, or reads an existing profile: a trace for Perfetto, and the layout of the
//! paper's Table 1.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use anyhow::Context;
use app_core::core::Core;
use app_core::gpu::AdapterChoice;
use app_core::preset::Preset;
use app_core::session::Capture;
use app_core::wgpu;
use clap::Parser;
use desk::files::BUNDLED_SESSION;
use desk::output::{make_folder, write_whole};
use desk::program::{exit_code, open_session, print, repository};
use desk::shaders::ShaderArgs;
use measure::profiled::{parse, profile, tables};

/// Default folder of the trace, below the top of the repository.
const RESULTS: &str = "target/profile";

/// Profile a session: profile.json, which Perfetto opens, and for each kind of frame a table in the
/// layout of the paper's Table 1. For an existing profile.json, such as a phone's, print the tables
/// alone.
#[derive(Parser)]
#[command(name = "profile", bin_name = "cargo xtask profile")]
struct Args {
    /// Folder of a session, a recording, or a profile.json [default: the bundled session]
    of: Option<PathBuf>,
    /// Folder for profile.json [default: target/profile]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// The preset
    #[arg(long, value_name = "NAME", default_value_t)]
    preset: Preset,
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
    let of = args.of.clone().unwrap_or_else(|| PathBuf::from(BUNDLED_SESSION));
    let text = if of.extension().is_some_and(|ending| ending == "json") {
        let text = fs::read_to_string(&of).with_context(|| of.display().to_string())?;
        tables(&parse(&text).with_context(|| of.display().to_string())?)
    } else {
        measure(&of, args)?
    };
    print(&text)
}

fn measure(folder: &Path, args: &Args) -> anyhow::Result<String> {
    let results = || repository().join(RESULTS);
    let out = args.out.clone().unwrap_or_else(results);
    make_folder(&out)?;
    let adapter = args
        .adapter
        .clone()
        .map_or(AdapterChoice::Fastest, AdapterChoice::Named);
    let mut core = pollster::block_on(Core::headless(&wgpu::Instance::default(), &adapter))?;
    args.shaders.hand_to(&mut core)?;
    let session = Capture::open(open_session(folder)?)?;
    let measured = profile(&session, &mut core, args.preset)?;
    let file = out.join("profile.json");
    write_whole(&file, &serde_json::to_vec(&measured)?)?;
    Ok(format!("{}{}\n", tables(&measured), file.display()))
}
