//! The film: each frame made from the keys beside it, blended and written.

use std::collections::BTreeSet;
use std::path::PathBuf;

use app_core::core::{Core, CoreError};
use app_core::preset::Preset;
use app_core::scene::{Image, Pose};
use desk::output::WriteError;
use desk::output::folder::OutputFolder;
use desk::page::film::write_picture;
use glam::DMat4;

use super::InbetweenError;
use super::blend::{FrameGrain, Mix};
use super::keys::{Key, Keys};
use super::light::LightPicture;
use super::page::write_page;
use super::report::{FrameEntry, Report, take_folder, write_report};
use super::shot::Shot;
use super::stage::Figure;
use super::timing::{Moment, Rate, moments};
use crate::ease::Ease;
use crate::sheet::Cell;

/// Folder of onion skins, below the output folder; each has the name of its frame.
pub(super) const ONION_FOLDER: &str = "onion";
/// Weights of the key before, the frame and the key after in an onion skin.
const ONION_WEIGHTS: [f32; 3] = [0.25, 0.5, 0.25];

/// First noise number of frames, far from those of the core's own pictures.
const OWN_NOISE: u32 = 1 << 31;

/// File names: a text before and after a number of at least four digits.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PictureNames {
    /// Before the number.
    pub prefix: String,
    /// Number of the first frame.
    pub first: usize,
}

impl PictureNames {
    /// File name of a frame, counted from 0.
    #[must_use]
    pub fn of(&self, frame: usize) -> String {
        format!("{}{:04}.png", self.prefix, self.first + frame)
    }
}

/// The options of a film.
#[derive(Clone, Debug)]
pub struct Options {
    /// Folder for pictures and lists, made if it is missing. Files of an earlier run in it are
    /// removed.
    pub out: PathBuf,
    /// How much work a frame may cost.
    pub preset: Preset,
    /// Number of frames.
    pub rate: Rate,
    /// Easing between two keys.
    pub ease: Ease,
    /// Number of frames of each picture.
    pub hold: usize,
    /// Names of the pictures.
    pub names: PictureNames,
    /// Whether keys are shown as they were photographed, with their own camera, exposure and place.
    pub keeps_keys: bool,
    /// Whether onion skins are written, too: each frame between the keys beside it.
    pub has_onion: bool,
}

/// The result.
pub struct Film {
    /// Number of frames.
    pub n_frames: usize,
    /// The keys and their corrections.
    pub keys: Keys,
    /// Possible mistakes of the pictures.
    pub warnings: Vec<String>,
}

/// A key that the core has learned.
struct Ready<'a> {
    index: usize,
    key: &'a Key,
    /// The print in the camera of the film. A figure has 24 bytes for each pixel, so only keys that
    /// are ready have theirs.
    figure: Figure,
    core: Core,
    world_from_shown: DMat4,
}

impl<'a> Ready<'a> {
    fn new(
        (keys, index): (&'a Keys, usize),
        figure: Figure,
        core: &Core,
        preset: Preset,
    ) -> Result<Self, InbetweenError> {
        let key = keys.keys.get(index).ok_or(InbetweenError::NoKey)?;
        let mut core = core.beside();
        let failed = |reason| InbetweenError::Core { index, reason };
        core.set_scene(key.scene.clone(), preset).map_err(failed)?;
        Ok(Self {
            index,
            key,
            figure,
            core,
            world_from_shown: keys.world_from_shown,
        })
    }

    /// The core's warnings about the key.
    fn warnings(&self) -> Result<Vec<String>, InbetweenError> {
        let index = self.index;
        let warnings = self.core.read_fit_warnings();
        let warnings = warnings.map_err(|reason| InbetweenError::Core { index, reason })?;
        Ok(warnings
            .iter()
            .map(|warning| format!("key {index}: {warning}"))
            .collect())
    }

    /// The toy in a pose at its common place.
    fn picture(&mut self, pose: &Pose) -> Result<LightPicture, InbetweenError> {
        let input = self.key.input.clone().with_shown_pose(pose.clone());
        let input = input.with_world_from_shown(Some(self.world_from_shown));
        let picture = self.core.frame(&input).and_then(|_| self.core.read_picture());
        let failed = |reason: CoreError| InbetweenError::Core {
            index: self.index,
            reason,
        };
        Ok(LightPicture::of(&picture.map_err(failed)?))
    }
}

/// Makes the film of a shot on the device of `core`. Reports each step and their number to
/// `progress`.
///
/// # Errors
/// When a key cannot be used, or a file cannot be written; earlier pictures stay.
pub fn make(
    shot: &Shot,
    core: &Core,
    options: &Options,
    progress: &mut dyn FnMut(usize, usize),
) -> Result<Film, InbetweenError> {
    let output = take_folder(&options.out, shot)?;
    let times: Vec<f64> = (0..shot.n_keys())
        .map(|index| shot.key(index).map(|key| key.time_secs))
        .collect::<Result<_, _>>()?;
    let moments = moments(&times, options.rate, options.ease, options.hold)?;
    let n_steps = shot.n_keys() + moments.len();
    let keys = Keys::find(shot, |index| progress(index, n_steps))?;
    let mut maker = Maker {
        shot,
        keys: &keys,
        core,
        options,
        output: &output,
        ready: Vec::new(),
        last: None,
        warnings: BTreeSet::new(),
    };
    let mut report = Report::new(shot, &keys, core);
    let mut cells = Vec::new();
    for (index, moment) in moments.iter().enumerate() {
        progress(shot.n_keys() + index, n_steps);
        let (entry, image) = maker.frame(index, moment)?;
        cells.push(Cell::new(&image, entry.is_key));
        report.frames.push(entry);
    }
    report.warnings.extend(maker.warnings.iter().cloned());
    let warnings = maker.warnings.into_iter().collect();
    write_report(&output, &report, &cells)?;
    write_page(&output, &report, &keys, options.has_onion)?;
    Ok(Film {
        n_frames: moments.len(),
        keys,
        warnings,
    })
}

struct Maker<'a> {
    shot: &'a Shot,
    keys: &'a Keys,
    core: &'a Core,
    options: &'a Options,
    output: &'a OutputFolder,
    /// The keys beside the latest frame.
    ready: Vec<Ready<'a>>,
    /// The latest moment with its picture, for frames that hold it.
    last: Option<(Moment, FrameEntry, Image)>,
    /// The core's warnings.
    warnings: BTreeSet<String>,
}

impl Maker<'_> {
    fn frame(&mut self, index: usize, moment: &Moment) -> Result<(FrameEntry, Image), InbetweenError> {
        let held = self.last.take().filter(|(last, ..)| last == moment);
        let (entry, image) = match held {
            Some((_, entry, image)) => (entry, image),
            None => self.made(index, moment)?,
        };
        let entry = FrameEntry {
            number: self.options.names.first + index,
            picture: self.options.names.of(index),
            ..entry
        };
        write_picture(self.output, &entry.picture, &image)?;
        if self.options.has_onion {
            self.write_onion(&entry, moment, &image)?;
        }
        self.last = Some((*moment, entry.clone(), image.clone()));
        Ok((entry, image))
    }

    fn made(&mut self, index: usize, moment: &Moment) -> Result<(FrameEntry, Image), InbetweenError> {
        let keys = self.keys;
        let is_key = moment.share == 0.0;
        let right = if is_key { moment.left } else { moment.left + 1 };
        let pose = self.pose(moment)?;
        let pictures = [moment.left, right].map(|key| self.picture(key, &pose));
        let [left_picture, right_picture] = pictures;
        let (left_picture, right_picture) = (left_picture?, right_picture?);
        let figure = self.figure(&pose, &keys.world_from_shown)?;
        let touched = figure.touched(&self.shot.scene().receivers, &keys.lights);
        let [left_ready, right_ready] = [self.ready(moment.left)?, self.ready(right)?];
        let seen = [left_ready, right_ready].map(|ready| figure.seen_in(&ready.figure));
        #[allow(clippy::cast_possible_truncation, reason = "from 0 to 1")]
        let share = moment.share as f32;
        let mix = Mix {
            pictures: [&left_picture, &right_picture],
            share,
            seen: [&seen[0], &seen[1]],
            covered: &figure.covered(),
            touched: &touched,
            grain: [moment.left, right]
                .iter()
                .find_map(|key| keys.keys[*key].input.grain)
                .map(|grain| FrameGrain {
                    grain,
                    frame: OWN_NOISE | u32::try_from(index).unwrap_or(u32::MAX),
                }),
        };
        let image = if is_key && self.options.keeps_keys {
            self.shot.key(moment.left)?.image.as_ref().clone()
        } else {
            mix.blended(Some(&keys.reference)).encoded()
        };
        let gain = |key: usize| keys.keys[key].found.gains;
        let entry = FrameEntry {
            number: 0,
            picture: String::new(),
            is_key,
            time_secs: moment.time_secs,
            pose: self.shot.pose_text(&pose),
            keys: if is_key {
                vec![moment.left]
            } else {
                vec![moment.left, right]
            },
            weights: if is_key {
                vec![1.0]
            } else {
                vec![1.0 - moment.share, moment.share]
            },
            gains: if is_key {
                vec![gain(moment.left)]
            } else {
                vec![gain(moment.left), gain(right)]
            },
            unseen: mix.unseen(),
        };
        Ok((entry, image))
    }

    /// The picture of a pose made from a key.
    fn picture(&mut self, key: usize, pose: &Pose) -> Result<LightPicture, InbetweenError> {
        let is_new = !self.ready.iter().any(|ready| ready.index == key);
        if is_new {
            // Keys before the previous one are no longer needed.
            self.ready.retain(|ready| ready.index + 1 == key);
            let of_key = self.keys.keys.get(key).ok_or(InbetweenError::NoKey)?;
            let figure = self.figure(&of_key.pose, &of_key.input.world_from_object)?;
            let ready = Ready::new((self.keys, key), figure, self.core, self.options.preset)?;
            self.ready.push(ready);
        }
        let ready = self.ready.iter_mut().find(|ready| ready.index == key);
        let ready = ready.ok_or(InbetweenError::NoKey)?;
        let picture = ready.picture(pose)?;
        if is_new {
            self.warnings.extend(ready.warnings()?);
        }
        Ok(picture)
    }

    /// The toy in the camera of the film.
    fn figure(&self, pose: &Pose, world_from_object: &DMat4) -> Result<Figure, InbetweenError> {
        let scene = self.shot.scene();
        let size_px = [scene.width_px as usize, scene.height_px as usize];
        let placed = (pose, world_from_object);
        Ok(Figure::new(&scene.toy, placed, &self.keys.camera, size_px)?)
    }

    /// A key of which a picture was made.
    fn ready(&self, key: usize) -> Result<&Ready<'_>, InbetweenError> {
        let ready = self.ready.iter().find(|ready| ready.index == key);
        ready.ok_or(InbetweenError::NoKey)
    }

    /// The pose at a moment.
    fn pose(&self, moment: &Moment) -> Result<Pose, InbetweenError> {
        let of = |index: usize| self.keys.keys.get(index).map(|key| &key.pose);
        let left = of(moment.left).ok_or(InbetweenError::NoKey)?;
        if moment.share == 0.0 {
            return Ok(left.clone());
        }
        let right = of(moment.left + 1).ok_or(InbetweenError::NoKey)?;
        match (left, right) {
            (
                Pose::Clip { clip, time_secs },
                Pose::Clip {
                    clip: next_clip,
                    time_secs: next_secs,
                },
            ) if clip == next_clip => Ok(Pose::Clip {
                clip: *clip,
                time_secs: time_secs + moment.share * (next_secs - time_secs),
            }),
            _ => Ok(self.shot.scene().toy.blended(left, right, moment.share)?),
        }
    }

    /// The frame overlaid with the keys beside it.
    fn write_onion(&self, entry: &FrameEntry, moment: &Moment, image: &Image) -> Result<(), WriteError> {
        let last = self.keys.keys.len() - 1;
        let key = |index: usize| LightPicture::of(self.keys.keys[index.min(last)].input.image.rgba());
        let mut sum = LightPicture::of(image);
        let [left, right] = [key(moment.left), key(moment.left + 1)];
        for ((pixel, left), right) in sum.rgb.iter_mut().zip(&left.rgb).zip(&right.rgb) {
            for channel in 0..3 {
                let lights = [left[channel], pixel[channel], right[channel]];
                pixel[channel] = lights
                    .iter()
                    .zip(ONION_WEIGHTS)
                    .map(|(light, weight)| light * weight)
                    .sum();
            }
        }
        let file = format!("{ONION_FOLDER}/{}", entry.picture);
        write_picture(self.output, &file, &sum.encoded())
    }
}
