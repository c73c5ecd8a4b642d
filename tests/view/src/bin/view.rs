//! The app on a desktop with a session as its camera: in a window, or on a tour through all of its
//! screens.

use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::Arc;

use anyhow::{Context, Result, bail};
use app_core::Core;
use app_core::app::{LaunchHistory, ShellEvent};
use app_core::gpu::AdapterChoice;
use app_core::interface::{Insets, Screen};
use app_core::live::Live;
use app_core::preset::Preset;
use app_core::wgpu;
use app_shell::record::clock;
use app_shell::worker::Pace;
use clap::{Parser, ValueEnum};
use desk::files::BUNDLED_SESSION;
use desk::program::{exit_code, open_session, print, repository};
use desk::shaders::ShaderArgs;
use view::desktop::{Desk, Keeping};
use view::fault::Fault;
use view::feed::Feed;
use view::tour::{Tour, Way};
use view::window;
use view::window::Options;

/// Default folder of photos and the tour's pictures, below the top of the repository.
const RESULTS: &str = "target/view";

/// Run the app on a desktop: a session is its camera, the mouse a finger, the wheel turns the toy's
/// outline; I writes a page of the present moment, with all presets side by side, maps, lights and
/// times.
#[derive(Parser)]
#[command(name = "view", bin_name = "cargo xtask view")]
struct Args {
    /// Folder of a session, or a recording [default: the bundled one]
    session: Option<PathBuf>,
    /// Preset
    #[arg(long, value_name = "NAME", default_value = "balanced")]
    preset: Preset,
    /// Fault to simulate, and its time in seconds, such as too-fast@20; it lasts 5 seconds
    #[arg(long, value_name = "FAULT@SECONDS", value_parser = fault_at)]
    fault: Vec<(Fault, f64)>,
    /// Without a window: a simulated person visits every screen, and each is written as a picture
    #[arg(long)]
    tour: bool,
    /// On the tour: straight to the toy that moves, with touches and seconds counted
    #[arg(long, requires = "tour")]
    straight: bool,
    /// Width and height of the window or of the tour's screen, in points
    #[arg(long, value_name = "WxH", default_value = "844x390", value_parser = size)]
    size: [u32; 2],
    /// Physical pixels per point of the tour's screen
    #[arg(long, value_name = "N", default_value_t = 1.5, requires = "tour")]
    scale: f64,
    /// Keep this many frames per second by reducing quality
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=240))]
    hold: Option<u32>,
    /// Scale of the letters
    #[arg(long, value_name = "N", default_value_t = 1.0)]
    text_scale: f64,
    /// Folder for photos and the tour's pictures [default: target/view]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Quality of a recording's pictures, 1 to 100 [default: lossless]
    #[arg(long, value_name = "QUALITY", value_parser = clap::value_parser!(u8).range(1..=100))]
    jpeg: Option<u8>,
    /// Toy for "Another toy": a binary glTF file, or a folder of them to choose from; a file can
    /// also be dropped on the window
    #[arg(long, value_name = "PATH")]
    toy: Option<PathBuf>,
    #[command(flatten)]
    shaders: ShaderArgs,
    /// Close the window after this many seconds
    #[arg(long, value_name = "N", conflicts_with = "tour")]
    seconds: Option<f64>,
}

fn main() -> ExitCode {
    exit_code(run(Args::parse()))
}

fn run(args: Args) -> Result<()> {
    let path = args.session.unwrap_or_else(|| PathBuf::from(BUNDLED_SESSION));
    let feed = Feed::of_stored(open_session(&path)?).with_context(|| path.display().to_string())?;
    let results = || repository().join(RESULTS);
    let out = args.out.unwrap_or_else(results);
    let keeping = Keeping {
        out: out.clone(),
        jpeg_quality: args.jpeg,
        toy_to_pick: args.toy,
    };
    if !args.tour {
        return window::open(
            feed,
            Options {
                preset: args.preset,
                size_points: args.size,
                faults: args.fault,
                text_scale: args.text_scale,
                hold: args.hold,
                keeping,
                shaders: args.shaders.watched(),
                seconds: args.seconds,
            },
        );
    }
    // A tour begins like the first launch.
    let mut history = LaunchHistory::default();
    history.begin();
    let mut core = pollster::block_on(Core::headless(
        &wgpu::Instance::default(),
        &AdapterChoice::Fastest,
    ))?;
    args.shaders.hand_to(&mut core)?;
    let mut live = Live::new(core, Arc::clone(&feed.scene().toy), args.preset);
    args.hold.into_iter().for_each(|hold| live.set_target_fps(hold));
    live.set_clock(clock());
    let mut desk = Desk::new(live, feed, keeping, Pace::Repeatable);
    desk.tell(ShellEvent::Started(history));
    #[allow(clippy::cast_possible_truncation, reason = "pixels of a screen")]
    let size_px = args
        .size
        .map(|points| (f64::from(points) * args.scale).round() as u32);
    let screen = Screen {
        size_px,
        pixels_per_point: args.scale,
        insets: Insets::default(),
        text_scale: args.text_scale,
    };
    if args.straight {
        let Way {
            n_touches,
            camera_s,
            machine_s: [ghost, searched, moves],
        } = Tour::new(&mut desk, screen, &out)?.straight()?;
        return print(&format!(
            "{n_touches} touches, {camera_s:.1} s of the camera; computed: the first ghost after {ghost:.1} s, the search ended {searched:.1} s later, the toy moved {moves:.1} s later\n"
        ));
    }
    let pictures = Tour::new(&mut desk, screen, &out)?.go()?;
    print(&format!("{} screens: {}\n", pictures.len(), out.display()))
}

fn fault_at(text: &str) -> Result<(Fault, f64)> {
    let (name, seconds) = text
        .split_once('@')
        .context("FAULT@SECONDS, such as too-fast@20")?;
    let fault = Fault::from_str(name, true).map_err(anyhow::Error::msg)?;
    let seconds: f64 = seconds.parse()?;
    if !(seconds.is_finite() && seconds > 0.0) {
        bail!("the time is after the start");
    }
    Ok((fault, seconds))
}

fn size(text: &str) -> Result<[u32; 2]> {
    let (width, height) = text.split_once('x').context("WxH, such as 844x390")?;
    let size = [width.parse()?, height.parse()?];
    if size.iter().any(|side| !(64..=8192).contains(side)) {
        bail!("each side has 64 to 8192 points");
    }
    Ok(size)
}
