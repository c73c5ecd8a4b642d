//! Writes a session from a recording of another format and from the arguments.

use std::collections::HashSet;
use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, bail, ensure};
use app_core::session::record::{
    BackgroundRecord, CaptureRecord, Encoding, FrameRecord, Index, PoseRecord, ToyRecord,
};
use app_core::session::{Capture, Session};
use app_core::toy::Toy;
use glam::{DMat4, DQuat, DVec3};
use serde::de::DeserializeOwned;

use super::imported::{Imported, ImportedDepth, ImportedFrame};
use super::pictures::{Fitted, fit};
use super::ply::glb_of_ply_file;
use super::source::Source;
use crate::files::{Folder, SESSION_FILE, index_text};
use crate::output::{make_folder, write_whole};
use crate::toy_file::read_toy;

/// Frames that show the place without the toy, counted from 0.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum PlateFrames {
    /// From the first to the last, both included.
    Frames(usize, usize),
    /// There are none.
    None,
}

/// Values that no format has; world is the session's, +Y up and in metres.
#[derive(Clone, Debug, Default, clap::Args)]
pub struct Lacking {
    /// Model of the toy: a .glb, or a .ply, which is converted
    #[arg(long, value_name = "FILE")]
    pub toy: Option<PathBuf>,
    /// Number of the toy's object, in a scene of several
    #[arg(long, value_name = "NUMBER")]
    pub object: Option<u32>,
    /// Pose of the toy: 16 numbers, column by column, object space to world, with blanks or commas
    /// between them; a scene of bop has it
    #[arg(long, value_name = "NUMBERS", allow_hyphen_values = true)]
    pub world_from_object: Option<String>,
    /// A plane that catches the shadow, as an entry of `receivers`; may be given several times
    #[arg(long, value_name = "JSON")]
    pub receiver: Vec<String>,
    /// A light, as an entry of `lights`, or `none` to have them estimated; may be given several
    /// times
    #[arg(long, value_name = "JSON|none")]
    pub light: Vec<String>,
    /// Frames that show the place without the toy, for example 0-11, or `none`; they become plates
    #[arg(long, value_name = "A-B|none")]
    pub plates: Option<String>,
    /// Up in the recording's world, three numbers; needed if the format does not have the direction
    /// of gravity
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true)]
    pub up: Option<String>,
    /// Metres per unit of the recording; needed if the format has no scale
    #[arg(long, value_name = "NUMBER")]
    pub metres: Option<f64>,
    /// Frames per second; needed if the format has no times
    #[arg(long, value_name = "NUMBER")]
    pub fps: Option<f64>,
}

impl Lacking {
    /// The arguments that are needed but missing.
    fn missing(&self, imported: &Imported) -> Vec<&'static str> {
        let needed = [
            ("--toy FILE", self.toy.is_none()),
            (
                "--world-from-object NUMBERS",
                self.world_from_object.is_none() && imported.recorded_from_object.is_none(),
            ),
            ("--receiver JSON", self.receiver.is_empty()),
            ("--light JSON|none", self.light.is_empty()),
            ("--plates A-B|none", self.plates.is_none()),
            ("--up X,Y,Z", self.up.is_none() && imported.up.is_none()),
            ("--metres NUMBER", self.metres.is_none() && !imported.is_metric),
            ("--fps NUMBER", self.fps.is_none() && !imported.has_times()),
        ];
        needed
            .into_iter()
            .filter_map(|(name, is_missing)| is_missing.then_some(name))
            .collect()
    }

    /// Frames that become plates.
    fn plate_frames(&self) -> anyhow::Result<PlateFrames> {
        let text = self.plates.as_deref().unwrap_or("none").trim();
        if text == "none" {
            return Ok(PlateFrames::None);
        }
        let (first, last) = text.split_once('-').unwrap_or((text, text));
        let [first, last] = [first, last].map(|end| end.trim().parse::<usize>());
        match (first, last) {
            (Ok(first), Ok(last)) if first <= last => Ok(PlateFrames::Frames(first, last)),
            _ => bail!("--plates: {text:?} is neither A-B nor none"),
        }
    }

    /// The session's world from the recording's: up becomes +Y by the shortest turn, lengths metres.
    fn world_from_recorded(&self, imported: &Imported) -> anyhow::Result<(DQuat, f64)> {
        let up = match (&self.up, imported.up) {
            (Some(text), _) => DVec3::from_array(numbers("--up", text)?),
            (None, Some(up)) => up,
            (None, None) => DVec3::Y,
        };
        let up = up.try_normalize().context("--up: has no direction")?;
        let metres = self.metres.unwrap_or(1.0);
        ensure!(
            metres.is_normal() && metres > 0.0,
            "--metres: {metres} is not above 0"
        );
        Ok((DQuat::from_rotation_arc(up, DVec3::Y), metres))
    }

    /// Time of each frame since the first one.
    fn times_s(&self, imported: &Imported) -> anyhow::Result<Vec<f64>> {
        let fps = self.fps.unwrap_or(1.0);
        ensure!(fps.is_normal() && fps > 0.0, "--fps: {fps} is not above 0");
        let stated: Option<Vec<f64>> = imported.frames.iter().map(|frame| frame.time_s).collect();
        Ok(match stated {
            Some(times_s) => times_s.iter().map(|time_s| time_s - times_s[0]).collect(),
            None => (0..imported.frames.len())
                .map(|place| place as f64 / fps)
                .collect(),
        })
    }
}

impl Lacking {
    fn world_from_object(&self, imported: &Imported) -> anyhow::Result<[f64; 16]> {
        if let Some(text) = &self.world_from_object {
            return numbers("--world-from-object", text);
        }
        let (rotation, metres) = self.world_from_recorded(imported)?;
        let world_from_recorded =
            DMat4::from_scale_rotation_translation(DVec3::splat(metres), rotation, DVec3::ZERO);
        let recorded_from_object = imported.recorded_from_object.context("--world-from-object")?;
        Ok((world_from_recorded * recorded_from_object).to_cols_array())
    }

    /// The toy's file as a .glb.
    fn toy(&self) -> anyhow::Result<Vec<u8>> {
        let toy = self.toy.as_deref().context("--toy")?;
        let named = toy.display().to_string();
        let bytes = fs::read(toy).with_context(|| named.clone())?;
        let bytes = if bytes.starts_with(b"ply") {
            glb_of_ply_file(toy, &bytes).with_context(|| named.clone())?
        } else {
            read_toy(toy)?
        };
        Toy::from_glb(&named, &bytes)?;
        Ok(bytes)
    }
}

fn numbers<const N: usize>(argument: &str, text: &str) -> anyhow::Result<[f64; N]> {
    let texts = text.split([',', ' ', '[', ']']).filter(|text| !text.is_empty());
    let numbers = texts.map(|text| {
        text.parse()
            .with_context(|| format!("{argument}: {text:?} is no number"))
    });
    let numbers = numbers.collect::<anyhow::Result<Vec<f64>>>()?;
    let n = numbers.len();
    numbers
        .try_into()
        .ok()
        .with_context(|| format!("{argument}: {n} numbers, {N} are needed"))
}

/// Parses entries of a list of the index.
fn entries<T: DeserializeOwned>(argument: &str, texts: &[String]) -> anyhow::Result<Vec<T>> {
    let texts = texts.iter().filter(|text| *text != "none");
    texts
        .map(|text| serde_json::from_str(text).with_context(|| argument.to_owned()))
        .collect()
}

/// A written session.
pub struct Written {
    /// The session as its reader opens it.
    pub capture: Capture,
    /// Messages about skipped or changed values.
    pub notes: Vec<String>,
}

/// Writes a session's folder from a recording, and opens it.
///
/// # Errors
/// When an argument is missing, which is named, `out` exists already, or the result is no valid
/// session.
pub fn write(
    name: &str,
    files: &Source,
    imported: &Imported,
    lacking: &Lacking,
    out: &Path,
) -> anyhow::Result<Written> {
    let missing = lacking.missing(imported);
    ensure!(
        missing.is_empty(),
        "the format lacks values that a session needs: give {}",
        missing.join(", ")
    );
    ensure!(
        !out.exists(),
        "{}: exists already: delete it or name another folder",
        out.display()
    );
    let fitted = fit(files, imported)?;
    let index = index(name, imported, &fitted, lacking)?;
    let text = index_text(&Index::from(index.clone()))?;
    let toy = lacking.toy()?;
    make_folder(out)?;
    if files.holds(out)? {
        fs::remove_dir(out)?;
        bail!(
            "{}: lies in the recording itself: name a folder outside of it",
            out.display()
        );
    }
    let capture = write_files((files, imported, &fitted), (&toy, &index, &text), out).inspect_err(|_| {
        // The rest is no valid session; the error gives the reason.
        let _ = fs::remove_dir_all(out);
    })?;
    let n_times = imported.n_times();
    let mixed = (n_times > 0 && !imported.has_times()).then(|| {
        let n = imported.frames.len();
        format!("only {n_times} of {n} frames have a time: --fps gives the times of all")
    });
    let notes = imported.notes.iter().chain(&fitted.notes).cloned();
    Ok(Written {
        notes: notes.chain(mixed).collect(),
        capture,
    })
}

fn write_files(
    (files, imported, fitted): (&Source, &Imported, &Fitted),
    (toy, index, text): (&[u8], &CaptureRecord, &[u8]),
    out: &Path,
) -> anyhow::Result<Capture> {
    write_whole(&out.join("toy.glb"), toy)?;
    let depths: HashSet<String> = index
        .frames
        .iter()
        .filter_map(|frame| frame.depth.clone())
        .collect();
    for (place, frame) in imported.frames.iter().enumerate() {
        let file = out.join(fitted.path(&frame.image));
        make_folder(file.parent().unwrap_or(out))?;
        write_whole(&file, &fitted.picture(files, imported, place)?)?;
        let depth = frame.depth.as_ref();
        // A plate has none.
        if let Some(depth) = depth.filter(|depth| depths.contains(&depth.path())) {
            let file = out.join(depth.path());
            make_folder(file.parent().unwrap_or(out))?;
            write_whole(&file, &depth.png(files)?)?;
        }
    }
    write_whole(&out.join(SESSION_FILE), text)?;
    let capture = Capture::open(Folder::open(out)?)?;
    capture.check_pictures(0..capture.n_frames())?;
    Ok(capture)
}

/// `capture.json`.
fn index(
    name: &str,
    imported: &Imported,
    fitted: &Fitted,
    lacking: &Lacking,
) -> anyhow::Result<CaptureRecord> {
    let mut frames = frames(imported, fitted, lacking)?;
    let first = fitted.intrinsics.first().context("no frame")?;
    let plates: Vec<FrameRecord> = match lacking.plate_frames()? {
        PlateFrames::None => Vec::new(),
        PlateFrames::Frames(first, last) => {
            let n = frames.len();
            ensure!(last < n, "--plates: the recording has {n} frames, counted from 0");
            frames.drain(first..=last).collect()
        }
    };
    ensure!(!frames.is_empty(), "--plates: no frame is left");
    let plate = |frame: FrameRecord| BackgroundRecord {
        image: frame.image,
        intrinsics: frame.intrinsics,
        world_from_camera: frame.world_from_camera,
    };
    Ok(CaptureRecord {
        name: name.to_owned(),
        width: fitted.size_px[0],
        height: fitted.size_px[1],
        encoding: Encoding::Srgb,
        intrinsics: first.into(),
        lens: fitted.lens,
        toy: ToyRecord {
            file: "toy.glb".to_owned(),
            world_from_object: lacking.world_from_object(imported)?,
            physical_pose: PoseRecord::default(),
            resting: None,
        },
        receivers: entries("--receiver", &lacking.receiver)?,
        lights: entries("--light", &lacking.light)?,
        backgrounds: plates.into_iter().map(plate).collect(),
        frames,
        probe: None,
        place_mesh: None,
        uncertainty: None,
    })
}

/// Entries of all frames, plates included.
fn frames(imported: &Imported, fitted: &Fitted, lacking: &Lacking) -> anyhow::Result<Vec<FrameRecord>> {
    let (rotation, metres) = lacking.world_from_recorded(imported)?;
    let times_s = lacking.times_s(imported)?;
    let entry = |(place, frame): (usize, &ImportedFrame)| {
        let (_, of_camera, position) = frame.recorded_from_camera.to_scale_rotation_translation();
        let world_from_camera =
            DMat4::from_rotation_translation(rotation * of_camera, rotation * (metres * position));
        FrameRecord {
            time: times_s[place],
            image: fitted.path(&frame.image),
            depth: frame.depth.as_ref().map(ImportedDepth::path),
            intrinsics: fitted.intrinsics.get(place).map(Into::into),
            world_from_camera: world_from_camera.to_cols_array(),
            ..FrameRecord::default()
        }
    };
    Ok(imported.frames.iter().enumerate().map(entry).collect())
}
