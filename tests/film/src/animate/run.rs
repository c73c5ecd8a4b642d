//! Makes a film or a part of it, in processes that make its pictures.

use std::collections::BTreeSet;
use std::io::{self, BufRead, BufReader, IsTerminal, Write};
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Instant;
use std::{env, fs};

use anyhow::{Context, ensure};
use app_core::core::Core;
use app_core::gpu::AdapterChoice;
use app_core::preset::{Preset, Settings};
use app_core::session::{Capture, Session};
use app_core::shadow_style::ShadowStyle;
use app_core::toy::Toy;
use app_core::wgpu;
use desk::convert;
use desk::files::{SESSION_FILE, index_of, index_text};
use desk::output::write_whole;
use desk::program::open_session;
use desk::stored::Stored;
use indicatif::{ProgressBar, ProgressStyle};

use super::folder::{Film, FilmFolder, FilmFrame, MadeBy, sources};
use super::frame_files::{FrameRange, NamePattern};
use super::grammar::{ClipFacts, items};
use super::moving;
use super::outputs;
use super::render::{PASSED_THROUGH, WARNING, missing};
use super::timeline::{Timing, frames, photograph_at};

/// The options of a film.
pub struct Order {
    /// The session.
    pub session: PathBuf,
    /// The folder of the film.
    pub out: PathBuf,
    /// The text of the clips.
    pub clips: String,
    /// Conversion of clips to frames.
    pub timing: Timing,
    /// How much work a frame may cost.
    pub preset: Preset,
    /// Style of the shadow.
    pub shadow: ShadowStyle,
    /// Bits of a picture's channels: 8 or 16.
    pub bits: u8,
    /// Whether each picture's layers are written beside it.
    pub has_layers: bool,
    /// Whether camera, pose and lights are the session's.
    pub is_as_given: bool,
    /// Whether each frame shows the photograph of its time.
    pub is_moving: bool,
    /// Number of the first frame.
    pub start: u32,
    /// Names of pictures; `None` for the session's.
    pub name: Option<NamePattern>,
    /// Frames to make; `None` for all.
    pub frames: Option<FrameRange>,
    /// Whether existing pictures are made again.
    pub is_forced: bool,
    /// Whether previews are omitted.
    pub is_without_preview: bool,
    /// Part of a graphics adapter's name.
    pub adapter: Option<String>,
    /// Whether nothing is printed.
    pub is_quiet: bool,
}

/// The clips of a toy.
#[must_use]
pub fn clip_facts(toy: &Toy) -> Vec<ClipFacts> {
    let names = toy.clip_names().into_iter().zip(toy.clips());
    names
        .map(|(name, clip)| ClipFacts {
            name,
            duration_secs: clip.duration_secs,
        })
        .collect()
}

/// Makes a film, or its missing frames. Returns a text for the user.
///
/// # Errors
/// When the options are invalid, the session cannot be read, or a picture cannot be made or
/// written.
pub fn run(order: &Order) -> anyhow::Result<String> {
    let named = || order.session.display().to_string();
    let capture = Capture::open(open_session(&order.session)?).with_context(named)?;
    check_output(order, &capture)?;
    let session = Stored::open(&order.session)?;
    let film = planned(order, &capture, &session)?;
    let last = film.frames.last().context("a film without frames")?;
    let all = order.start..last.number + 1;
    let range = match &order.frames {
        None => all.clone(),
        Some(asked) => asked
            .within(&all)
            .with_context(|| format!("--frames: the film has frames {} to {}", all.start, last.number))?,
    };
    let is_part = order.frames.is_some();
    let folder = FilmFolder::take(&order.out, is_part)?;
    if !is_part {
        folder.remove_partial()?;
    }
    let say = |line: &str| {
        if !order.is_quiet {
            let _ = writeln!(io::stderr(), "{line}");
        }
    };
    folder.begin(&film, order.is_forced, |to| {
        write_session(&session, &capture, &film, to, &say)
    })?;
    let made_before = by_others(&folder, &film)?;
    outputs::write_xsheet(folder.path(), &film, &clip_facts(&capture.scene().toy))?;
    let n_missing = missing(folder.path(), &film, &range).len();
    let start = Instant::now();
    let made = make(order, folder.path(), &film, &range)?;
    let secs = start.elapsed().as_secs_f64();
    let now = match n_missing {
        0 => "none had to be made".to_owned(),
        _ => format!(
            "{n_missing} made now in {secs:.1} s, {:.2} a second",
            n_missing as f64 / secs
        ),
    };
    let mut said: String = moving::warnings(folder.path())?
        .union(&made.warnings)
        .map(|warning| format!("warning: {warning}\n"))
        .collect();
    said += &made_before;
    if made.n_passed_through > 0 {
        said += &format!(
            "{} of {n_missing} frames passed through: they show the photograph as it is\n",
            made.n_passed_through
        );
    }
    said += &format!(
        "{} of {} frames are there, {now}: {}\n",
        film.frames.len() - missing(folder.path(), &film, &all).len(),
        film.frames.len(),
        order.out.display()
    );
    said += &moving::said_of_photographs(&session, &film)?;
    if !is_part && !order.is_without_preview {
        say("writing previews");
        said += &outputs::write_previews(folder.path(), &film)?;
    }
    Ok(said)
}

/// A warning if existing pictures may come from another program or driver.
fn by_others(folder: &FilmFolder, film: &Film) -> anyhow::Result<String> {
    let begun = FilmFolder::film_in(folder.path())?.context("there is no film.json")?;
    let n_there = begun.frames.len() - missing(folder.path(), &begun, &(0..u32::MAX)).len();
    let now = &film.made_by;
    let by = match &begun.made_by {
        by if *by == MadeBy::default() => &MadeBy {
            build: "an earlier version".to_owned(),
            driver: "an unknown driver".to_owned(),
        },
        by => by,
    };
    Ok(if by == now || n_there == 0 {
        String::new()
    } else {
        format!(
            "warning: {n_there} of the pictures were made earlier, by {} on {}; this is {} on {}, whose pictures may differ slightly: --force makes all again\n",
            by.build, by.driver, now.build, now.driver
        )
    })
}

/// This program and the driver that it will use.
fn made_by(order: &Order) -> anyhow::Result<MadeBy> {
    let program = env::current_exe().context("this program's own path")?;
    let bytes = fs::read(&program).with_context(|| program.display().to_string())?;
    let adapter = order.adapter.clone();
    let adapter = adapter.map_or(AdapterChoice::Fastest, AdapterChoice::Named);
    let core = pollster::block_on(Core::headless(&wgpu::Instance::default(), &adapter))?;
    Ok(MadeBy {
        build: format!("build {:08x}", crc32fast::hash(&bytes)),
        driver: core.adapter_name(),
    })
}

/// Refuses options that the preset or the session does not support.
fn check_output(order: &Order, capture: &Capture) -> anyhow::Result<()> {
    let is_model = matches!(Settings::from(order.preset), Settings::Model(_));
    let is_fine = order.bits > 8 || order.has_layers;
    let preset = order.preset.name();
    ensure!(
        is_model || order.shadow == ShadowStyle::TRUE,
        "--shadow-strength, --shadow-softness: preset {preset} draws shadows as published; choose fast, balanced or best"
    );
    ensure!(
        is_model || !is_fine,
        "--bits 16, --exr: preset {preset} makes pictures of 8 bits without layers; choose fast, balanced or best"
    );
    ensure!(
        !is_fine || capture.lens(0)?.is_none(),
        "--bits 16, --exr: the session has a lens, and only pictures of 8 bits can be distorted by it; leave the options out"
    );
    Ok(())
}

fn planned(order: &Order, capture: &Capture, session: &Stored) -> anyhow::Result<Film> {
    let scene = capture.scene();
    let clips = clip_facts(&scene.toy);
    let items = items(&order.clips, &clips).context("--clips")?;
    let poses = frames(&items, &clips, &order.timing)?;
    let name = order.name.clone();
    let name = name.unwrap_or_else(|| NamePattern::of_session(&scene.name));
    let times_secs = if order.is_moving {
        moving::times_secs(session)?
    } else {
        vec![0.0]
    };
    let numbered = (order.start..).zip(poses);
    Ok(Film {
        version: env!("CARGO_PKG_VERSION").to_owned(),
        made_by: made_by(order)?,
        name: scene.name.clone(),
        sources: sources(session, order.is_moving)?,
        is_as_given: order.is_as_given,
        is_moving: order.is_moving,
        preset: order.preset.name().to_owned(),
        shadow: order.shadow,
        bits: order.bits,
        has_layers: order.has_layers,
        clips: order.clips.clone(),
        timing: order.timing,
        frames: numbered
            .map(|(number, pose)| FilmFrame {
                number,
                file: name.file(number),
                photograph: photograph_at(
                    &times_secs,
                    order.timing.from_secs + f64::from(number - order.start) / order.timing.fps,
                ),
                pose,
            })
            .collect(),
    })
}

/// A copy of the session as the source of the film. For a film of one photograph it has the first
/// frame alone, which each process aligns by itself. The used photographs of a moving film are
/// aligned here.
fn write_session(
    session: &Stored,
    capture: &Capture,
    film: &Film,
    to: &Path,
    say: &dyn Fn(&str),
) -> anyhow::Result<()> {
    if film.is_moving && !film.is_as_given {
        let n_used = film.photographs().last().map_or(0, |last| last + 1);
        return moving::write_aligned(session, capture, n_used, to, say);
    }
    convert::write(session, None, to)?;
    if film.is_moving {
        return Ok(());
    }
    let mut index = index_of(&Stored::open(to)?)?;
    if let Some(frames) = index["frames"].as_array_mut() {
        frames.truncate(1);
    }
    write_whole(&to.join(SESSION_FILE), &index_text(&index)?)?;
    Ok(())
}

/// Output of the processes.
#[derive(Default)]
struct Made {
    warnings: BTreeSet<String>,
    n_passed_through: usize,
}

/// Starts one process after the other until all pictures exist.
fn make(order: &Order, folder: &Path, film: &Film, range: &Range<u32>) -> anyhow::Result<Made> {
    let program = env::current_exe().context("this program's own path")?;
    let mut made = Made::default();
    let mut n_missing = missing(folder, film, range).len();
    let progress = Progress::new(n_missing, order.is_quiet);
    while n_missing > 0 {
        let mut command = Command::new(&program);
        command
            .arg("--render")
            .arg(folder)
            .args(["--frames", &format!("{}..{}", range.start, range.end)]);
        if let Some(adapter) = &order.adapter {
            command.args(["--adapter", adapter]);
        }
        let process = command.stdin(Stdio::piped()).stdout(Stdio::piped()).spawn();
        let mut process = process.with_context(|| program.display().to_string())?;
        let lines = process.stdout.take().map(BufReader::new);
        for line in lines.into_iter().flat_map(BufRead::lines) {
            let line = line?;
            if let Some(warning) = line.strip_prefix(WARNING) {
                made.warnings.insert(warning.to_owned());
                continue;
            }
            made.n_passed_through += usize::from(line.starts_with(PASSED_THROUGH));
            progress.next();
        }
        let status = process.wait()?;
        ensure!(
            status.success(),
            "the process that makes the pictures has ended with {status}"
        );
        let n_left = missing(folder, film, range).len();
        ensure!(
            n_left < n_missing,
            "the process that makes the pictures has made none"
        );
        n_missing = n_left;
    }
    progress.0.finish_and_clear();
    Ok(made)
}

/// Progress of a film, with the time left: a bar on a terminal, an occasional line in a log.
struct Progress(ProgressBar, bool);

impl Progress {
    fn new(n_pictures: usize, is_quiet: bool) -> Self {
        let is_terminal = io::stderr().is_terminal();
        let bar = if is_quiet || !is_terminal {
            ProgressBar::hidden()
        } else {
            let style = ProgressStyle::with_template("[{bar:40}] {pos}/{len} pictures, {eta} left");
            ProgressBar::no_length().with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()))
        };
        bar.set_length(n_pictures as u64);
        Self(bar, !is_quiet && !is_terminal)
    }

    fn next(&self) {
        self.0.inc(1);
        let (position, length) = (self.0.position(), self.0.length().unwrap_or_default());
        if self.1 && (position.is_multiple_of(24) || position == length) {
            let left_secs = self.0.elapsed().as_secs_f64() / position as f64 * (length - position) as f64;
            let _ = writeln!(
                io::stderr(),
                "{position} of {length} pictures, {left_secs:.0} s left"
            );
        }
    }
}

/// Reads a film's picture.
pub(crate) fn picture(folder: &Path, frame: &FilmFrame) -> anyhow::Result<image::RgbImage> {
    let path = folder.join(&frame.file);
    let named = || path.display().to_string();
    let bytes = fs::read(&path).with_context(named)?;
    Ok(image::load_from_memory(&bytes).with_context(named)?.to_rgb8())
}
