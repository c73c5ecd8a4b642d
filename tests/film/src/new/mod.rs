//! A session from photographs alone: the toy is the marker. Its place in the photograph gives the
//! camera, its feet the table, and its shadow the lights.

mod error;
mod found;
mod shot;
mod table;
mod view;
mod written;

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use anyhow::Context;
use app_core::scene::{Camera, Intrinsics, Pose};
use app_core::toy::Toy;
use desk::output::write_png;
use glam::{DMat4, DVec3};

use crate::animate::grammar::{ClipFacts, once};
use crate::photograph::{Photograph, focal_px};
use crate::video::{MAX_PICTURES, PICTURES_PER_SEC, Video, is_video};

pub use error::NewError;
pub use shot::Key;
pub use view::{Side, View};

/// File name of the drawing in the session's folder.
pub const DRAWING: &str = "found.png";

/// Plausible heights of a toy by its model alone, in metres.
const LIKELY_M: [f64; 2] = [0.01, 1.0];

/// The options: photographs and known facts.
#[derive(Clone, Debug)]
pub struct Wanted {
    /// Photographs of the place without the toy, and that of the toy last.
    pub photographs: Vec<PathBuf>,
    /// The model, a .glb.
    pub toy: PathBuf,
    /// The toy's height as it stands, in metres; `None` for the model's.
    pub height_m: Option<f64>,
    /// The clip and the moment in seconds of the print's pose; `None` for the authored pose.
    pub moment: Option<(String, f64)>,
    /// Focal length as on 35 mm film, in millimetres, in place of the photograph's own.
    pub focal_35mm: Option<f64>,
    /// The visible side of the toy.
    pub view: View,
    /// The model's axis that points up, of unit length.
    pub up: DVec3,
    /// Height of the toy's lowest points above the table, in metres.
    pub lifted_m: f64,
    /// Photographs of further prints, in the order of the film, which make the session a shot as
    /// well.
    pub keys: Vec<Key>,
    /// Seconds of the film between two keys.
    pub apart_secs: f64,
}

/// The result.
#[derive(Clone, Debug)]
pub struct Made {
    /// The results in sentences.
    pub facts: Vec<String>,
    /// Possible mistakes.
    pub warnings: Vec<String>,
    /// The toy's first clip, as `animate` reads it.
    pub clip: Option<String>,
    /// Whether the session has all pictures of a video.
    pub is_video: bool,
}

/// The input, read before the search.
struct Given {
    plates: Vec<Photograph>,
    photograph: Photograph,
    /// The video whose first picture it is.
    video: Option<Video>,
    /// Photographs of further prints.
    keys: Vec<Photograph>,
    toy: Arc<Toy>,
    toy_bytes: Vec<u8>,
    pose: Pose,
    intrinsics: Intrinsics,
    /// Transform of the toy to its size, upright about the origin.
    upright: DMat4,
    /// The toy's height as it stands.
    height_m: f64,
    /// Corners of the model's box in that pose, in object space.
    corners: [DVec3; 2],
    facts: Vec<String>,
}

/// Makes a session's folder from photographs. Tells each step to `progress` as it begins.
///
/// # Errors
/// When `out` exists already, a file cannot be read, or the result is uncertain: nothing is written
/// then.
pub fn new(wanted: &Wanted, out: &Path, progress: &mut dyn FnMut(&str)) -> anyhow::Result<Made> {
    anyhow::ensure!(
        !out.exists(),
        "{}: exists already: delete it or name another folder",
        out.display()
    );
    let name = out.file_name().context("--out: has no name")?;
    let beside = |ending: &str| {
        let mut name = name.to_owned();
        name.push(ending);
        out.with_file_name(name)
    };
    let partial = beside(".partial");
    anyhow::ensure!(
        !partial.exists(),
        "{}: another run writes there, or was interrupted: remove it in that case",
        partial.display()
    );
    if let Some(above) = out.parent() {
        fs::create_dir_all(above).with_context(|| above.display().to_string())?;
    }
    progress("reading the photographs");
    let given = read(wanted, &beside(".video"))?;
    progress("searching for the toy, its table and its lights, which takes the longest");
    let found = found::find(&given, wanted)?;
    progress("writing the session");
    written::write(&given, &found, wanted, &partial)?;
    write_png(&partial.join(DRAWING), &found.drawn(&given)?)?;
    fs::rename(&partial, out).with_context(|| out.display().to_string())?;
    let mut facts = given.facts.clone();
    facts.extend(found.facts());
    let of_toy = given.toy.warnings().iter();
    let of_toy = of_toy.map(|warning| format!("{}: {warning}", wanted.toy.display()));
    Ok(Made {
        facts,
        warnings: of_toy.chain(found.warnings(&given)).collect(),
        clip: first_clip(&given.toy),
        is_video: given.video.is_some(),
    })
}

/// Reads all input; `folder` may be made for pictures of videos, and is removed with the returned
/// value.
fn read(wanted: &Wanted, folder: &Path) -> anyhow::Result<Given> {
    let (last, others) = wanted
        .photographs
        .split_last()
        .context("a photograph of the toy is needed")?;
    let mut plates = Vec::new();
    for path in others {
        let (plate, _) = read_first(path, folder, 1)?;
        plates.push(plate);
    }
    let (photograph, video) = read_first(last, folder, MAX_PICTURES)?;
    let mut keys = Vec::new();
    for key in &wanted.keys {
        keys.push(Photograph::read(&key.path)?);
    }
    for other in plates.iter().chain(&keys) {
        same_size(other, &photograph)?;
    }
    let stated_px = wanted
        .focal_35mm
        .map(|focal_35mm| focal_px(focal_35mm, &photograph.image));
    let focal_px = stated_px
        .or(photograph.focal_px)
        .ok_or_else(|| NewError::NoFocalLength {
            path: photograph.path.clone(),
        })?;
    let (toy, toy_bytes) = read_toy(&wanted.toy)?;
    let pose = match &wanted.moment {
        None => Pose::Authored,
        Some((clip, time_secs)) => Pose::Clip {
            clip: toy.find_clip(clip)?,
            time_secs: *time_secs,
        },
    };
    let bounds = toy.bounds_of_pose(&pose)?;
    let corners = [bounds.min, bounds.max].map(|corner| corner.as_dvec3());
    check_keys(&toy, &wanted.keys)?;
    let (upright, height_m) = upright(corners, wanted)?;
    if let (Pose::Clip { clip, time_secs }, Some((name, _))) = (&pose, &wanted.moment) {
        let (end_secs, is_beyond) = toy.clamp_time(*clip, *time_secs)?;
        anyhow::ensure!(!is_beyond, "--pose: the clip {name:?} ends at {end_secs:.3} s");
    }
    let facts = plates
        .iter()
        .chain([&photograph])
        .chain(&keys)
        .flat_map(|photograph| {
            let name = photograph.path.display();
            photograph.notes.iter().map(move |note| format!("{name}: {note}"))
        });
    let image = &photograph.image;
    Ok(Given {
        intrinsics: Intrinsics {
            fx_px: focal_px,
            fy_px: focal_px,
            cx_px: 0.5 * f64::from(image.width_px),
            cy_px: 0.5 * f64::from(image.height_px),
        },
        facts: facts.collect(),
        plates,
        photograph,
        video,
        keys,
        toy: toy.into(),
        toy_bytes,
        pose,
        upright,
        height_m,
        corners,
    })
}

/// Checks that the clips of further prints exist and are as long as their moments.
fn check_keys(toy: &Toy, keys: &[Key]) -> anyhow::Result<()> {
    for key in keys {
        let named = || key.path.display().to_string();
        let (name, time_secs) = &key.moment;
        let clip = toy.find_clip(name).with_context(named)?;
        let (end_secs, is_beyond) = toy.clamp_time(clip, *time_secs)?;
        anyhow::ensure!(
            !is_beyond,
            "{}: the clip {name:?} ends at {end_secs:.3} s",
            named()
        );
    }
    Ok(())
}

/// A photograph, or the first picture of a video with the video.
fn read_first(path: &Path, folder: &Path, n_most: u32) -> anyhow::Result<(Photograph, Option<Video>)> {
    if !is_video(path) {
        return Ok((Photograph::read(path)?, None));
    }
    let video = Video::open(path, folder, n_most)?;
    let mut photograph = Photograph::read(&video.pictures()[0])?;
    path.clone_into(&mut photograph.path);
    let n_pictures = video.pictures().len();
    photograph.notes.push(match n_most {
        1 => "is a video: its first picture is used".to_owned(),
        _ => format!(
            "is a video: {n_pictures} pictures are used, {PICTURES_PER_SEC} a second, of a camera that is assumed to stand still"
        ),
    });
    Ok((photograph, Some(video)))
}

fn same_size(plate: &Photograph, photograph: &Photograph) -> Result<(), NewError> {
    let size_px = |photograph: &Photograph| [photograph.image.width_px, photograph.image.height_px];
    let [own, expected] = [size_px(plate), size_px(photograph)];
    if own == expected {
        return Ok(());
    }
    Err(NewError::Size {
        path: plate.path.clone(),
        size_px: own,
        expected_px: expected,
    })
}

fn read_toy(path: &Path) -> anyhow::Result<(Toy, Vec<u8>)> {
    let name = path.display().to_string();
    let bytes = desk::toy_file::read_toy(path)?;
    Ok((Toy::from_glb(&name, &bytes)?, bytes))
}

/// The first clip in the words of a film's clips.
fn first_clip(toy: &Toy) -> Option<String> {
    let facts = toy.clip_names().into_iter().map(|name| ClipFacts {
        name,
        duration_secs: 0.0,
    });
    let facts: Vec<ClipFacts> = facts.collect();
    (!facts.is_empty()).then(|| once(0, &facts))
}

/// Turns the model upright and scales it to its height, which is returned, too.
fn upright([min, max]: [DVec3; 2], wanted: &Wanted) -> Result<(DMat4, f64), NewError> {
    let turn = DMat4::from_quat(glam::DQuat::from_rotation_arc(wanted.up, DVec3::Y));
    let heights = (0..8).map(|corner| {
        let pick = |axis: usize| {
            if corner >> axis & 1 == 0 {
                min[axis]
            } else {
                max[axis]
            }
        };
        turn.transform_point3(DVec3::new(pick(0), pick(1), pick(2))).y
    });
    let (lowest, highest) = heights.fold((f64::INFINITY, f64::NEG_INFINITY), |(least, most), y| {
        (least.min(y), most.max(y))
    });
    let own_m = highest - lowest;
    let is_likely = (LIKELY_M[0]..=LIKELY_M[1]).contains(&own_m);
    let height_m = wanted.height_m.or(is_likely.then_some(own_m));
    let height_m = height_m.ok_or(NewError::NoHeight { own: own_m })?;
    if !(own_m.is_normal() && own_m > 0.0) {
        return Err(NewError::Flat);
    }
    Ok((DMat4::from_scale(DVec3::splat(height_m / own_m)) * turn, height_m))
}

impl Given {
    /// A camera at the origin of its own space.
    fn camera(&self) -> Camera {
        Camera {
            intrinsics: self.intrinsics,
            world_from_camera: DMat4::IDENTITY,
        }
    }

    /// Length of the diagonal of the toy's box, in metres.
    fn diagonal_m(&self) -> f64 {
        let [min, max] = self.corners;
        self.upright.transform_vector3(max - min).length()
    }

    /// The centre of the toy's box, in object space.
    fn middle(&self) -> DVec3 {
        0.5 * (self.corners[0] + self.corners[1])
    }
}
