//! Makes a film from a session's photograph and clips of its toy.

use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use anyhow::{Context, ensure};
use app_core::gpu::AdapterChoice;
use app_core::preset::Preset;
use app_core::shadow_style::{SOFTNESS, STRENGTH, ShadowStyle};
use clap::Parser;
use desk::files::BUNDLED_SESSION;
use desk::program::{exit_code, print, results_of};
use film::animate::folder::FilmFolder;
use film::animate::frame_files::{FrameRange, NamePattern};
use film::animate::render::render;
use film::animate::run::{Order, run};
use film::animate::timeline::{End, Timing};
use film::ease::Ease;

/// Default folder of films, below the top of the repository.
const RESULTS: &str = "target/film";

/// Make a film from one photograph: clips of the toy become numbered pictures, a contact sheet, an
/// exposure sheet (xsheet.csv) and previews that play. Run an interrupted film again to continue
/// it.
#[derive(Parser)]
#[command(name = "animate", bin_name = "cargo xtask animate")]
struct Args {
    /// Folder of the session, or a recording; its first photograph is animated, or with --moving all of them [default: the bundled one]
    session: Option<PathBuf>,
    /// Clips to play, such as 'Look,Step*2@0.5x,hold:12': in this order, with repetitions and
    /// speeds, and frames to hold a pose; `clips` lists a toy's
    #[arg(long, value_name = "CLIPS", required_unless_present = "render")]
    clips: Option<String>,
    /// Frames per second
    #[arg(long, value_name = "N", default_value_t = 24.0, value_parser = parse_fps)]
    fps: f64,
    /// Number of frames of each pose: 2 is "on twos"
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=24))]
    on: u32,
    /// Omit the last pose, which the first one follows
    #[arg(long = "loop", conflicts_with = "pingpong")]
    is_loop: bool,
    /// Play the film back to the start, too
    #[arg(long)]
    pingpong: bool,
    /// Change of each clip's speed over its length
    #[arg(long, value_enum, default_value_t)]
    ease: Ease,
    /// Number of frames in which a clip's start is blended with the pose before it
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = clap::value_parser!(u32).range(0..=240))]
    blend: u32,
    /// Start within the clips, and with --moving within the recording, in seconds
    #[arg(long, value_name = "SECS", default_value_t = 0.0, value_parser = parse_secs)]
    from: f64,
    /// End, in seconds
    #[arg(long, value_name = "SECS", value_parser = parse_secs)]
    to: Option<f64>,
    /// How much work a frame may cost
    #[arg(long, value_name = "NAME", default_value = "best")]
    preset: Preset,
    /// Strength of the shadow, from 0, none, to 4: 1 is the truth, 2 squares the light left in the shadow
    #[arg(long, value_name = "TIMES", default_value_t = 1.0, value_parser = parse_strength)]
    shadow_strength: f64,
    /// Softness of the shadow, from 0, that of point lights, to 4: 1 is the truth, 2 has an edge
    /// twice as wide
    #[arg(long, value_name = "TIMES", default_value_t = 1.0, value_parser = parse_softness)]
    shadow_softness: f64,
    /// Bits of a picture's channels: 8, or 16
    #[arg(long, value_name = "BITS", default_value = "8", value_parser = ["8", "16"])]
    bits: String,
    /// Write each picture as OpenEXR, too, of linear half floats, with layers: clean plate, shadow ratio, toy, masks
    #[arg(long)]
    exr: bool,
    /// Make only these frames, by their numbers: 3, 3.., ..9 or 3..9, exclusive of the end. Several
    /// such runs may share a folder
    #[arg(long, value_name = "A..B")]
    frames: Option<FrameRange>,
    /// Number of the first frame
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(0..=9_000_000))]
    start: u32,
    /// Names of the pictures, with a # for each digit of the number; without it the session's name and four digits
    #[arg(long, value_name = "NAME_####")]
    name: Option<NamePattern>,
    /// Make existing pictures again, and remove another film's pictures
    #[arg(long, conflicts_with = "frames")]
    force: bool,
    /// Folder of the film [default: target/film/ and the name of folder or recording]
    #[arg(long, value_name = "FILM")]
    out: Option<PathBuf>,
    /// Take camera, pose and lights as recorded, without aligning them by the photograph
    #[arg(long)]
    as_given: bool,
    /// Show each photograph at its time, for a recording with a moving camera
    #[arg(long)]
    moving: bool,
    /// Make only the pictures
    #[arg(long)]
    no_preview: bool,
    /// Part of a graphics adapter's name [default: the fastest]
    #[arg(long, value_name = "NAME")]
    adapter: Option<String>,
    /// Print nothing but errors
    #[arg(long)]
    quiet: bool,
    /// Make some pictures of the film in this folder; the program starts itself with this option
    #[arg(long, value_name = "FILM", hide = true)]
    render: Option<PathBuf>,
}

fn main() -> ExitCode {
    exit_code(start(Args::parse()))
}

fn start(args: Args) -> anyhow::Result<()> {
    if let Some(folder) = &args.render {
        return render_part(folder, &args);
    }
    let is_quiet = args.quiet;
    let said = run(&order(args)?)?;
    if is_quiet { Ok(()) } else { print(&said) }
}

fn render_part(folder: &Path, args: &Args) -> anyhow::Result<()> {
    let film = FilmFolder::film_in(folder)?.context("there is no film.json")?;
    let first = film.frames.first().context("a film without frames")?.number;
    let last = film.frames.last().context("a film without frames")?.number;
    let all = first..last + 1;
    let range = args
        .frames
        .as_ref()
        .map_or(Some(all.clone()), |frames| frames.within(&all));
    let adapter = args.adapter.clone();
    let adapter = adapter.map_or(AdapterChoice::Fastest, AdapterChoice::Named);
    render(
        folder,
        &range.context("--frames: the film has no such frames")?,
        &adapter,
    )
}

fn order(args: Args) -> anyhow::Result<Order> {
    let session = args.session.unwrap_or_else(|| BUNDLED_SESSION.into());
    ensure!(
        args.to.is_none_or(|to| to >= args.from),
        "--to lies before --from"
    );
    Ok(Order {
        out: match args.out {
            Some(out) => out,
            None => results_of(&session, RESULTS)?,
        },
        session,
        clips: args.clips.context("--clips is missing")?,
        timing: Timing {
            fps: args.fps,
            on: args.on,
            end: match (args.is_loop, args.pingpong) {
                (true, _) => End::Loop,
                (_, true) => End::PingPong,
                _ => End::Once,
            },
            ease: args.ease,
            n_blend_frames: args.blend,
            from_secs: args.from,
            to_secs: args.to,
        },
        preset: args.preset,
        shadow: ShadowStyle {
            strength: args.shadow_strength,
            softness: args.shadow_softness,
        },
        bits: if args.bits == "16" { 16 } else { 8 },
        has_layers: args.exr,
        is_as_given: args.as_given,
        is_moving: args.moving,
        start: args.start,
        name: args.name,
        frames: args.frames,
        is_forced: args.force,
        is_without_preview: args.no_preview,
        adapter: args.adapter,
        is_quiet: args.quiet,
    })
}

fn parse_fps(text: &str) -> Result<f64, String> {
    let fps = text.parse().ok().filter(|fps| (1.0..=240.0).contains(fps));
    fps.ok_or_else(|| "a number of frames per second from 1 to 240".to_owned())
}

fn parse_strength(text: &str) -> Result<f64, String> {
    within(text, &STRENGTH)
}

fn parse_softness(text: &str) -> Result<f64, String> {
    within(text, &SOFTNESS)
}

fn within(text: &str, range: &RangeInclusive<f64>) -> Result<f64, String> {
    let number = text.parse().ok().filter(|number| range.contains(number));
    number.ok_or_else(|| format!("a number from {} to {}", range.start(), range.end()))
}

fn parse_secs(text: &str) -> Result<f64, String> {
    let secs = text.strip_suffix('s').unwrap_or(text).parse().ok();
    let secs = secs.filter(|secs| (0.0..=86_400.0).contains(secs));
    secs.ok_or_else(|| "a number of seconds, such as 1.5 or 1.5s".to_owned())
}
