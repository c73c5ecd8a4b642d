//! Makes pictures of a film, in a process that ends before its driver uses too much memory.

use std::collections::BTreeSet;
use std::io::{self, Read, Write};
use std::ops::Range;
use std::path::Path;
use std::process;
use std::thread;

use anyhow::{Context, ensure};
use app_core::core::Core;
use app_core::frame::FrameInput;
use app_core::gpu::AdapterChoice;
use app_core::grain::Grain;
use app_core::scene::{Pose, Scene, Shown};
use app_core::session::{Capture, Session};
use app_core::toy::Toy;
use app_core::wgpu;
use desk::alignment::{Alignments, Asked};
use desk::lens::through_lens;
use desk::output::write_png;
use desk::stored::Stored;
use glam::DMat4;

use super::fine::{write_exr, write_png_16};
use super::folder::{Film, FilmFolder, FilmFrame, SESSION_FOLDER};
use super::timeline::{FramePose, Moment};

/// Pictures per process on a software driver: Mesa 22.3 leaks some MiB per picture.
const N_PICTURES_OF_PROCESS: usize = 50;

/// Number of photographs of a moving film that precede a frame in its process, at least: the core
/// learns about a place from each, and a seam between two processes would be visible otherwise.
const N_LEARNED: usize = 12;

/// The pose of a frame.
///
/// # Errors
/// When the toy has no such clip.
pub fn pose_of(toy: &Toy, frame: &FramePose) -> anyhow::Result<Pose> {
    let moment = pose_at(toy, &frame.moment)?;
    Ok(match &frame.after {
        None => moment,
        Some(after) => toy.blended(&pose_at(toy, &after.from)?, &moment, after.share)?,
    })
}

fn pose_at(toy: &Toy, moment: &Moment) -> anyhow::Result<Pose> {
    let clip = toy
        .clip_ids()
        .nth(moment.clip)
        .context("film.json: a clip that the toy lacks")?;
    Ok(Pose::Clip {
        clip,
        time_secs: moment.time_secs,
    })
}

/// Prefix, in the output of the process that makes pictures, of a retargeted picture's number.
pub(super) const RETARGETED: &str = "retargeted ";
pub(super) const PASSED_THROUGH: &str = "passed through ";
/// Prefix of a warning.
pub(super) const WARNING: &str = "warning: ";

/// Makes the missing pictures of the film in `folder` with numbers in `range`, and writes a line
/// for each picture and each new warning to standard output. It may end before all are made. The
/// process ends when standard input closes, as it does when the parent ends.
///
/// # Errors
/// When the film cannot be read, or a picture cannot be made or written.
pub fn render(folder: &Path, range: &Range<u32>, adapter: &AdapterChoice) -> anyhow::Result<()> {
    end_with_stdin();
    let film = FilmFolder::film_in(folder)?.context("there is no film.json")?;
    let missing = missing(folder, &film, range);
    let capture = Capture::open(Stored::open(folder.join(SESSION_FOLDER))?)?;
    if missing.is_empty() {
        return Ok(());
    }
    let mut studio = Studio::new(&film, &capture)?;
    let mut core = pollster::block_on(Core::headless(&wgpu::Instance::default(), adapter))?;
    let scene = studio.alignments.scene(capture.scene());
    let scene = { studio.alignments.changed_scene(&scene, 0) }.unwrap_or(scene);
    let toy = scene.toy.clone();
    core.set_scene(with_film(scene, &film, studio.world_from_shown)?, film.preset()?)?;
    if film.has_layers {
        core.want_layers()?;
    }
    let mut warnings = Warnings::default();
    let of_alignment =
        { studio.alignments.of(0).into_iter() }.flat_map(|aligned| &aligned.alignment.warnings);
    warnings.say(capture.warnings().iter().map(ToString::to_string))?;
    warnings.say(of_alignment.map(ToString::to_string))?;
    let n_pictures = if core.is_software() {
        N_PICTURES_OF_PROCESS
    } else {
        usize::MAX
    };
    for frame in missing.into_iter().take(n_pictures) {
        let pose = pose_of(&toy, &frame.pose)?;
        let input = studio.input(&mut core, frame.photograph, &pose)?;
        warnings.say(std::mem::take(&mut studio.warnings).into_iter())?;
        let report = core.frame(&input.with_shown_pose(pose));
        let report = report.with_context(|| frame.file.clone())?;
        write_picture(folder, &studio, frame, &core)?;
        warnings.say(report.warnings.iter().map(ToString::to_string))?;
        let outcome = if report.region.is_some() {
            RETARGETED
        } else {
            PASSED_THROUGH
        };
        say(&format!("{outcome}{}", frame.number))?;
    }
    warnings.say(core.read_fit_warnings()?.iter().map(ToString::to_string))?;
    Ok(())
}

/// The input of the pictures.
struct Studio<'a> {
    film: &'a Film,
    capture: &'a Capture,
    /// The photographs of the film, in the order of its time.
    photographs: Vec<usize>,
    alignments: Alignments,
    /// The shown place of the toy throughout; `None` for the place of the real toy.
    world_from_shown: Option<DMat4>,
    /// About the session's frames, until they are told.
    warnings: Vec<String>,
    /// The photograph that the core received last, by its place among those of the film.
    latest: Option<(usize, FrameInput)>,
}

impl<'a> Studio<'a> {
    fn new(film: &'a Film, capture: &'a Capture) -> anyhow::Result<Self> {
        let first = capture.frame(0)?;
        let mut alignments = Alignments::none();
        if !film.is_moving {
            // Each process aligns the photograph by itself, and so in the same way: no file holds
            // all estimates.
            if !film.is_as_given {
                alignments = Alignments::new(capture.scene(), Asked::default());
            }
            alignments.align(capture.scene(), 0, &first)?;
        }
        Ok(Self {
            film,
            capture,
            photographs: film.photographs(),
            alignments,
            world_from_shown: first.world_from_shown,
            warnings: first.warnings.iter().map(ToString::to_string).collect(),
            latest: None,
        })
    }

    /// A photograph as the core's input in some pose, after the core has received the photographs
    /// before it.
    fn input(&mut self, core: &mut Core, photograph: usize, pose: &Pose) -> anyhow::Result<FrameInput> {
        let at = self.photographs.partition_point(|shown| *shown < photograph);
        let next = match &self.latest {
            Some((latest, input)) if *latest == at => return Ok(input.clone()),
            Some((latest, _)) if *latest < at => latest + 1,
            _ => 0,
        };
        for index in next.max(at.saturating_sub(N_LEARNED))..at {
            let before = self.photographed(self.photographs[index])?;
            core.frame(&before.with_shown_pose(pose.clone()))?;
        }
        let input = self.photographed(photograph)?;
        self.latest = Some((at, input.clone()));
        Ok(input)
    }

    fn photographed(&mut self, index: usize) -> anyhow::Result<FrameInput> {
        let frame = self.capture.frame(index)?;
        self.warnings
            .extend(frame.warnings.iter().map(ToString::to_string));
        if self.film.is_moving {
            // They were aligned when the session was copied; observations of earlier ones are
            // dropped.
            self.alignments = Alignments::none();
        }
        self.alignments.align(self.capture.scene(), index, &frame)?;
        let input = self.alignments.input(index, &frame, self.film.preset()?);
        let grain = Grain::of(self.capture.scene(), input.image.rgba(), &input.camera);
        let input = input.with_grain(grain).with_shadow_style(self.film.shadow);
        Ok(input.with_world_from_shown(self.world_from_shown))
    }
}

/// Writes the picture that the core has made, and its layers if requested; the picture last, since
/// its file marks both as complete.
fn write_picture(folder: &Path, studio: &Studio, frame: &FilmFrame, core: &Core) -> anyhow::Result<()> {
    let failed = || frame.file.clone();
    if studio.film.has_layers {
        let (light, layers) = (core.read_light(), core.read_layers());
        let path = folder.join(frame.layers_file());
        write_exr(&path, &light.with_context(failed)?, &layers.with_context(failed)?)?;
    }
    let path = folder.join(&frame.file);
    if studio.film.bits > 8 {
        write_png_16(&path, &core.read_light().with_context(failed)?)?;
    } else {
        let picture = core.read_picture().with_context(failed)?;
        write_png(&path, &through_lens(studio.capture, frame.photograph, picture)?)?;
    }
    Ok(())
}

fn say(line: &str) -> io::Result<()> {
    let mut out = io::stdout().lock();
    writeln!(out, "{line}")?;
    out.flush()
}

/// Warnings that were printed.
#[derive(Default)]
struct Warnings(BTreeSet<String>);

impl Warnings {
    fn say(&mut self, warnings: impl Iterator<Item = String>) -> io::Result<()> {
        for warning in warnings {
            if self.0.insert(warning.clone()) {
                say(&format!("{WARNING}{warning}"))?;
            }
        }
        Ok(())
    }
}

/// The scene with all shown poses, so that no frame depends on those made before it.
fn with_film(scene: Scene, film: &Film, world_from_shown: Option<DMat4>) -> anyhow::Result<Scene> {
    let mut poses: Vec<&FramePose> = Vec::new();
    for frame in &film.frames {
        if !poses.contains(&&frame.pose) {
            poses.push(&frame.pose);
        }
    }
    let shown = poses.into_iter().map(|frame| {
        Ok(Shown {
            pose: pose_of(&scene.toy, frame)?,
            world_from_shown,
        })
    });
    let shown = shown.collect::<anyhow::Result<Vec<Shown>>>()?;
    ensure!(!shown.is_empty(), "film.json: a film without frames");
    Ok(scene.with_film(shown))
}

/// Frames of a film in a range of numbers whose pictures are missing.
#[must_use]
pub fn missing<'a>(folder: &Path, film: &'a Film, range: &Range<u32>) -> Vec<&'a FilmFrame> {
    let frames = film.frames.iter().filter(|frame| range.contains(&frame.number));
    frames
        .filter(|frame| !film.files_of(frame).iter().all(|file| folder.join(file).exists()))
        .collect()
}

/// The parent process holds the other end of standard input, which closes when the parent ends in
/// any way.
fn end_with_stdin() {
    thread::spawn(|| {
        let mut sink = [0; 64];
        while matches!(io::stdin().read(&mut sink), Ok(1..)) {}
        process::exit(1);
    });
}
