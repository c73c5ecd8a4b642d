//! The environment of cases: one core on one device for all of them.

use std::sync::Arc;

use app_core::core::{Core, CoreError};
use app_core::frame::{FrameInput, Warning};
use app_core::preset::Preset;
use app_core::scene::Image;
use app_pipeline::core::inspect::Inspect;
use app_pipeline::geometry::rect::PixelRect;
use app_pipeline::model::state::solution::Fit;
use app_pipeline::readback::{FloatMap, Map};

use super::case::Scope;
use super::gap::Gap;
use super::row::{Bound, Findings, Measured, Row};
use crate::photographer::Shot;

/// Memory that a planted fault leaks per picture, in pictures.
const LEAKED_PICTURES: usize = 4;

/// One core, the scope, and the planted fault, if any.
pub struct Lab {
    core: Core,
    scope: Scope,
    is_planted: bool,
    n_pictures: usize,
    latest_warnings: Vec<Warning>,
    is_retargeted: bool,
    latest_reference: Option<(Shot, Image)>,
    leaked: Vec<Vec<u8>>,
}

/// A picture, or the core's error.
pub type Made = Result<Image, CoreError>;

impl Lab {
    /// A lab with a core. With a planted fault, pictures of a case have a wrong part, except every
    /// second of eight; no warning is given, and learned numbers are NaN; each picture is read
    /// twice and leaks memory. Each group must then find a broken bound.
    #[must_use]
    pub fn new(core: Core, scope: Scope, is_planted: bool) -> Self {
        Self {
            core,
            scope,
            is_planted,
            n_pictures: 0,
            latest_warnings: Vec::new(),
            is_retargeted: false,
            latest_reference: None,
            leaked: Vec::new(),
        }
    }

    /// The used part of a list: all of it, or in a quick run the last few.
    #[must_use]
    pub fn some_of<T>(&self, all: impl IntoIterator<Item = T>, n_quick: usize) -> Vec<T> {
        let mut all: Vec<T> = all.into_iter().collect();
        match self.scope {
            Scope::Whole | Scope::Named => all,
            Scope::Quick => all.split_off(all.len().saturating_sub(n_quick)),
        }
    }

    /// The reference picture of comparisons, without a planted fault. Many cases start from the
    /// same one, which is then made once.
    ///
    /// # Errors
    /// As for [`Lab::picture`].
    pub fn reference(&mut self, shot: &Shot) -> Made {
        if let Some((latest, picture)) = &self.latest_reference
            && is_same(latest, shot)
        {
            return Ok(picture.clone());
        }
        self.core.set_scene(shot.scene.clone(), Preset::Balanced)?;
        self.core.frame(&shot.input)?;
        let picture = self.core.read_picture()?;
        self.latest_reference = Some((shot.clone(), picture.clone()));
        Ok(picture)
    }

    /// Rows of variations of a shot, with the difference of each picture from the shot's: a bound,
    /// and its measure.
    ///
    /// # Errors
    /// When the core fails, except by refusing a variation.
    pub fn compare(
        &mut self,
        label: Label,
        (bound, number_of): (Bound, fn(&Gap) -> f64),
        shot: &Shot,
        others: impl IntoIterator<Item = (String, Shot)>,
    ) -> anyhow::Result<Findings> {
        let expected = self.reference(shot)?;
        let mut rows = Vec::new();
        for (parameter, other) in self.some_of(others, 1) {
            let made = self.picture(&other);
            rows.push(label.against(parameter, bound, (&expected, made), number_of)?);
        }
        Ok(rows.into())
    }

    /// Begins a case.
    pub fn begin(&mut self) {
        self.n_pictures = 0;
        self.leaked.clear();
    }

    /// Name of the device.
    #[must_use]
    pub fn adapter(&self) -> String {
        self.core.adapter_name()
    }

    /// Whether the device is a software renderer.
    #[must_use]
    pub fn is_software(&self) -> bool {
        self.core.is_software()
    }

    /// Number of objects created on the device so far.
    #[must_use]
    pub fn n_made(&self) -> u64 {
        self.core.n_created().iter().map(|(_, n)| n).sum()
    }

    /// Whether the latest picture differs from the camera frame.
    #[must_use]
    pub fn is_retargeted(&self) -> bool {
        self.is_retargeted
    }

    /// Whether a fault is planted.
    #[must_use]
    pub fn is_planted(&self) -> bool {
        self.is_planted
    }

    /// The picture of a shot's frame, after all learning from it.
    ///
    /// # Errors
    /// When the core refuses the shot, or the device is lost.
    pub fn picture(&mut self, shot: &Shot) -> Made {
        self.picture_by(Preset::Balanced, shot)
    }

    /// The same with another preset.
    ///
    /// # Errors
    /// As for [`Lab::picture`].
    pub fn picture_by(&mut self, preset: Preset, shot: &Shot) -> Made {
        self.core.set_scene(shot.scene.clone(), preset)?;
        self.next(&shot.input)
    }

    /// The picture of another frame of the scene.
    ///
    /// # Errors
    /// When the core refuses the frame, or the device is lost.
    pub fn next(&mut self, input: &FrameInput) -> Made {
        let report = self.core.frame(input)?;
        self.latest_warnings = report.warnings;
        self.is_retargeted = report.region.is_some();
        let mut picture = self.core.read_picture()?;
        if self.is_planted {
            self.core.read_picture()?;
            self.leaked.push(vec![1; LEAKED_PICTURES * picture.rgba8.len()]);
        }
        if self.is_planted && self.n_pictures % 8 != 1 {
            spoil(&mut picture);
        }
        self.n_pictures += 1;
        Ok(picture)
    }

    /// Warnings of the latest picture's frame and of the learning up to it.
    ///
    /// # Errors
    /// When the device is lost.
    pub fn warnings(&self) -> Result<Vec<Warning>, CoreError> {
        if self.is_planted {
            return Ok(Vec::new());
        }
        let learned = self.core.read_fit_warnings()?;
        Ok(self.latest_warnings.iter().cloned().chain(learned).collect())
    }

    /// The work region of a shot's frame and the visibility of its lights with the real toy there,
    /// or `None` if the frame passes through.
    ///
    /// # Errors
    /// As for [`Lab::next`].
    pub fn visibility(&mut self, shot: &Shot) -> Result<Option<(PixelRect, FloatMap)>, CoreError> {
        self.core.set_scene(shot.scene.clone(), Preset::Balanced)?;
        let region = self.core.frame(&shot.input)?.region;
        let mut map = self.core.read_map(Map::PhysicalVisibility)?;
        if let Some(map) = map.as_mut().filter(|_| self.is_planted) {
            map.texels.iter_mut().for_each(|texel| texel[0] = 1.0 - texel[0]);
        }
        Ok(region.zip(map))
    }

    /// The fits' results in the latest frame.
    ///
    /// # Errors
    /// When the device is lost.
    pub fn fit(&self) -> Result<Option<Fit>, CoreError> {
        let mut fit = self.core.read_fit()?;
        if let Some(fit) = fit.as_mut().filter(|_| self.is_planted) {
            fit.gain[0] = f32::NAN;
        }
        Ok(fit)
    }
}

/// Whether two shots are identical: they share their photographs.
fn is_same(a: &Shot, b: &Shot) -> bool {
    let plates = |shot: &Shot| -> Vec<_> {
        let plates = shot.scene.plates.iter();
        plates
            .map(|plate| (Arc::as_ptr(&plate.image), plate.camera))
            .collect()
    };
    Arc::ptr_eq(a.input.image.rgba(), b.input.image.rgba())
        && plates(a) == plates(b)
        && a.glb == b.glb
        && a.scene.lights == b.scene.lights
        && a.scene.receivers == b.scene.receivers
        && a.scene.world_from_object == b.scene.world_from_object
        && a.scene.physical_pose == b.scene.physical_pose
        && a.input.shown_pose == b.input.shown_pose
        && a.input.camera == b.input.camera
        && a.input.exposure == b.input.exposure
}

/// Flips a bit of the colours in the centre of a picture, where the toy is.
fn spoil(picture: &mut Image) {
    let (width, height) = (picture.width_px as usize, picture.height_px as usize);
    for y in 2 * height / 5..3 * height / 5 {
        for x in 2 * width / 5..3 * width / 5 {
            let pixel = 4 * (y * width + x);
            picture.rgba8[pixel..pixel + 3]
                .iter_mut()
                .for_each(|code| *code ^= 0x40);
        }
    }
}

/// Group and name of a case, to make its rows.
#[derive(Clone, Copy, Debug)]
pub struct Label {
    /// Group.
    pub group: &'static str,
    /// Name.
    pub case: &'static str,
}

impl Label {
    /// A row with a number.
    #[must_use]
    pub fn row(self, parameter: impl Into<String>, bound: Bound, number: f64) -> Row {
        Row {
            group: self.group,
            case: self.case,
            parameter: parameter.into(),
            bound,
            measured: Measured::Number(number),
            cpu_f32: None,
            cpu_f64: None,
            note: String::new(),
        }
    }

    /// A row of a picture's difference from another, or of its refusal.
    ///
    /// # Errors
    /// When the core failed, except by refusing an input.
    pub fn against(
        self,
        parameter: impl Into<String>,
        bound: Bound,
        (expected, made): (&Image, Made),
        number_of: fn(&Gap) -> f64,
    ) -> Result<Row, CoreError> {
        match made {
            Ok(picture) => {
                let gap = Gap::between(expected, &picture);
                let mut row = self.row(parameter, bound, number_of(&gap));
                if gap.n_bytes > 0.0 {
                    row.note = format!(
                        "{} bytes differ, RMS {:.3}, most {} codes",
                        gap.n_bytes, gap.rms, gap.max
                    );
                }
                Ok(row)
            }
            Err(error) => self.refused(parameter, bound, error),
        }
    }

    /// A row of a refused input.
    ///
    /// # Errors
    /// The error itself when the core failed otherwise.
    pub fn refused(
        self,
        parameter: impl Into<String>,
        bound: Bound,
        error: CoreError,
    ) -> Result<Row, CoreError> {
        match error {
            CoreError::Input(reason) => Ok(Row {
                measured: Measured::Refused(reason.to_string()),
                ..self.row(parameter, bound, 0.0)
            }),
            other => Err(other),
        }
    }
}
