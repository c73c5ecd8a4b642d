//! The conditions of a photograph: its softness, and the other things in it.

use std::sync::{Arc, OnceLock};

use glam::DMat4;

use super::unlit::UnlitToy;
use super::{MOST_OUTLINE_PX, Photograph, base};
use crate::found_planes::FoundReceiver;
use crate::lights::{Counted, FoundReflection, Unlit, Watched};
use crate::measured_points::MeasuredPoints;
use crate::picture::Pyramid;
use crate::things::Colored;
use crate::{gloss, lights, pose, softness, things};
use app_scene::frame::FrameInput;
use app_scene::gloss::Gloss;
use app_scene::grain::Grain;
use app_scene::scene::{Camera, Light, Scene};
use app_scene::sharpness::{Sharpness, Spread};
use app_scene::things::{Mark, Things};
use app_scene::toy::ToyError;

/// Things beside the toy.
#[derive(Default)]
pub(crate) struct Sighted {
    /// `None` if the pictures cannot show any.
    pub(crate) things: Option<Things>,
    /// Planes of things.
    pub(crate) planes: Vec<FoundReceiver>,
    /// Memory for the search in the next picture; `None` if the pictures cannot show any things.
    pub(crate) memory: Option<things::Memory>,
}

impl Photograph {
    /// With the plate blurred by a spread, in pixels of the picture.
    pub(crate) fn with_plate_as_soft(self, spread: Spread) -> Self {
        let in_level = spread.times(self.pyramid.picture_px().powi(-2));
        let is_soft = spread != Spread::NONE;
        let softened = is_soft.then(|| self.pyramid.with_softened_plate(in_level));
        self.or_with_pictures(softened.flatten())
    }

    /// With unknown pixels at things and at wrong parts of the plate.
    pub(crate) fn clear_of(&self, things: &Things) -> Self {
        self.with_unknown(things.marks())
    }

    fn with_unknown(&self, marks: &[Mark]) -> Self {
        self.with_pictures(self.pyramid.clear_of(marks))
    }

    /// With other pictures, if there are any.
    pub(super) fn or_with_pictures(self, pyramid: Option<Pyramid>) -> Self {
        match pyramid {
            Some(pyramid) => self.with_pictures(pyramid),
            None => self,
        }
    }

    /// The same place and camera with other pictures.
    fn with_pictures(&self, pyramid: Pyramid) -> Self {
        Self {
            pyramid: Arc::new(pyramid),
            receivers: self.receivers.clone(),
            in_scene: self.in_scene.clone(),
            camera_from_world: self.camera_from_world,
            unlit: OnceLock::new(),
        }
    }

    /// With an estimated plate where it is wrong, around a toy in its place.
    pub(crate) fn with_mended_plate(
        &self,
        scene: &Scene,
        input: &FrameInput,
        things: &Things,
    ) -> Result<Self, ToyError> {
        let shape = self.shape(scene, &input.world_from_object)?;
        let level = self.pyramid.level(0);
        let coverage = pose::covered(&shape, level);
        let mended = things::with_mended_plate(level, &coverage, things.marks());
        Ok(self.with_pictures(self.pyramid.with_largest(mended)))
    }

    /// With unknown pixels at listed planes of things and around them; `None` if none is listed.
    pub(crate) fn without_tops(&self) -> Option<Self> {
        let marks = things::marks_of_listed(&self.receivers, self.pyramid.level(0))?;
        Some(self.with_unknown(&marks))
    }

    /// With unknown pixels except on the table around the toy's base; `None` without a table.
    pub(crate) fn around_base(&self, scene: &Scene, input: &FrameInput) -> Result<Option<Self>, ToyError> {
        let shape = self.shape(scene, &input.world_from_object)?;
        let marks = base::marks_beyond(&shape, &self.receivers, self.pyramid.level(0));
        Ok(marks.map(|marks| self.with_unknown(&marks)))
    }

    /// The loss that lights leave, with the toy in its place; `None` if too little of the receivers
    /// is visible.
    pub(crate) fn watch(
        &self,
        scene: &Scene,
        input: &FrameInput,
        lights: (&[Light], Counted),
    ) -> Result<Option<Watched>, ToyError> {
        let shape = self.shape(scene, &input.world_from_object)?;
        let posed = (&shape, &self.receivers[..]);
        let unlit = || {
            let unlit = Unlit::of(posed, &self.pyramid, &self.camera_from_world);
            UnlitToy::new(scene, input, unlit)
        };
        let known = self.unlit.get_or_init(unlit);
        let anew = (!known.is_of(scene, input)).then(unlit);
        let unlit = anew.as_ref().unwrap_or(known).unlit.as_ref();
        Ok(unlit.and_then(|unlit| lights::watch(lights, unlit, posed, &self.camera_from_world)))
    }

    /// Reflection of the receiver below the toy, in given lights; `None` if the picture does not
    /// constrain it.
    pub(crate) fn reflection(
        &self,
        scene: &Scene,
        input: &FrameInput,
        lights: &[Light],
    ) -> Result<Option<FoundReflection>, ToyError> {
        let shape = self.shape(scene, &input.world_from_object)?;
        let world_from_camera = &input.camera.world_from_camera;
        Ok(lights::reflection(
            lights,
            (&shape, &self.receivers),
            &self.pyramid,
            world_from_camera,
        ))
    }

    /// The photograph as if the receiver below the toy were matt.
    pub(crate) fn freed_of(
        &self,
        scene: &Scene,
        input: &FrameInput,
        found: &FoundReflection,
    ) -> Result<Self, ToyError> {
        let shape = self.shape(scene, &input.world_from_object)?;
        let mut level = self.pyramid.level(0).clone();
        let reflection = &found.reflection;
        let (surroundings, toy) = (reflection.surroundings, reflection.toy_above_surroundings);
        for (at, reflectance, hidden) in lights::reflected((&shape, &self.receivers), &level, reflection) {
            #[allow(clippy::cast_possible_truncation, reason = "light, to 7 digits")]
            let light = |channel: usize, hidden: f64, gain: f64| {
                let light = f64::from(surroundings[channel]) + hidden * f64::from(toy[channel]);
                (-gain * reflectance * light) as f32
            };
            level.frame.add(
                at,
                [0, 1, 2].map(|channel| light(channel, hidden, found.gain[channel])),
            );
            if let Some(plate) = &mut level.plate {
                plate.add(at, [0, 1, 2].map(|channel| light(channel, 0.0, 1.0)));
            }
        }
        Ok(self.with_pictures(self.pyramid.with_largest(level)))
    }

    /// Other things beside the toy in its place, under given lights; `None` if they cannot be
    /// detected. `memory` is that of the search in the previous picture, if there was any.
    pub(crate) fn things(
        &self,
        scene: &Scene,
        input: &FrameInput,
        lights: &[Light],
        (planes_of, memory): (Option<Colored>, Option<&things::Memory>),
    ) -> Result<Sighted, ToyError> {
        let shape = self.shape(scene, &input.world_from_object)?;
        let paint = pose::Paint::new(scene, &self.camera_from_object(&input.world_from_object))?;
        // They are of use to planes alone.
        let points = match planes_of {
            Some(_) => MeasuredPoints::of(scene, input),
            None => Vec::new(),
        };
        let (found, memory) = things::find(&things::Sight {
            shape: &shape,
            paint: &paint,
            receivers: &self.receivers,
            pyramid: &self.pyramid,
            lights,
            world_from_camera: &input.camera.world_from_camera,
            points: &points,
            planes_of,
            memory,
        });
        let Some(found) = found else {
            return Ok(Sighted {
                memory,
                ..Sighted::default()
            });
        };
        let planes = found.planes.into_iter().map(|found| {
            let name = if found.report.is_upright() {
                "a side".to_owned()
            } else {
                format!("{:.0} mm up", 1e3 * found.report.height_m)
            };
            let receiver = found.plane.receiver(name, &input.camera.world_from_camera);
            FoundReceiver {
                receiver,
                instead_of: found
                    .instead_of
                    .and_then(|index| self.in_scene.get(index).copied()),
                report: found.report,
            }
        });
        // Camera of the largest level, which may be smaller than the picture.
        let camera = Camera {
            intrinsics: input.camera.intrinsics.scaled(self.pyramid.picture_px().recip()),
            ..input.camera
        };
        Ok(Sighted {
            planes: planes.collect(),
            memory,
            things: Things::new(found.size_px.as_uvec2(), found.marks, camera).map(|things| {
                // The marks are known without points, too.
                let raised = things.clone().with_raised(found.raised);
                raised.unwrap_or(things).with_fronts(found.fronts)
            }),
        })
    }

    /// Gloss of the toy at its place, in given lights, by its pixels that no thing hides.
    pub(crate) fn gloss(
        &self,
        scene: &Scene,
        world_from_object: &DMat4,
        (lights, things): (&[Light], Option<&Things>),
    ) -> Result<Gloss, ToyError> {
        let shape = self.shape(scene, world_from_object)?;
        let paint = pose::Paint::new(scene, &self.camera_from_object(world_from_object))?;
        // Other marks of the toy's pixels are about what is behind it.
        let shown = things.map(|things| things.only(|mark| mark == Mark::BeforeToy));
        let clear = shown.map(|others| self.pyramid.clear_of(others.marks()));
        let level = clear.as_ref().unwrap_or(&self.pyramid).level(0);
        let surfels = paint.surfels(level, &pose::covered(&shape, level), gloss::MOST_SURFELS);
        let lights = gloss::Lights::new(lights, &self.camera_from_world);
        Ok(gloss::gloss(&gloss::Look::new(&shape, &surfels, &lights)))
    }

    /// Grain of the picture beside its plate, which is made as soft; `None` if the
    /// picture is clean, or too large or without a plate, so that its grain is unknown.
    pub(crate) fn grain(&self, plate_spread: Spread) -> Option<Grain> {
        let level = self.pyramid.level(0);
        // The means of several pixels have less noise than the picture.
        if self.pyramid.picture_px() > 1.0 {
            return None;
        }
        let sharp = level.plate.as_ref()?;
        let softened = (plate_spread != Spread::NONE).then(|| sharp.softened(plate_spread));
        let plate = softened.as_ref().unwrap_or(sharp);
        let size_px = level.frame.size_px.as_uvec2().to_array();
        Grain::between(
            size_px,
            |index| level.frame.pixel(index),
            |index| plate.pixel(index),
        )
    }

    /// Softness for given camera and pose, and whether the toy's outline is seen at its place.
    pub(crate) fn sharpness_as_given(
        &self,
        scene: &Scene,
        world_from_object: &DMat4,
    ) -> Result<(Sharpness, bool), ToyError> {
        let start = self.start(scene, *world_from_object)?;
        let outline = pose::OutlineBlur::new(start.subject(), &self.pyramid);
        let outline_px = outline.spread_px(MOST_OUTLINE_PX / self.pyramid.picture_px());
        Ok((self.sharpness_beside(&outline, outline_px), outline_px.is_some()))
    }

    /// The softness around a toy at its place, whose outline has the given blur in pixels; `None`
    /// for an outline that was not measured.
    pub(crate) fn sharpness(
        &self,
        scene: &Scene,
        world_from_object: &DMat4,
        outline_px: Option<f64>,
    ) -> Result<Sharpness, ToyError> {
        let start = self.start(scene, *world_from_object)?;
        let outline = pose::OutlineBlur::new(start.subject(), &self.pyramid);
        Ok(self.sharpness_beside(&outline, outline_px.map(|px| px / self.pyramid.picture_px())))
    }

    /// The same for an outline whose blur is in pixels of the largest level.
    fn sharpness_beside(&self, outline: &pose::OutlineBlur<'_>, outline_px: Option<f64>) -> Sharpness {
        let picture_px = self.pyramid.picture_px();
        let levels = (0..=Pyramid::SMALLEST).map(|level| self.pyramid.level(level));
        let in_level = softness::sharpness(
            levels.map(|level| (level, pose::covered(outline.shape(), level))),
            &softness::Outline {
                px: outline_px,
                directed: &|| outline.directed(),
                beyond_px: &|known| outline.beyond_px(known),
            },
        );
        let in_picture = |spread: Spread| spread.times(picture_px * picture_px);
        Sharpness {
            plate_spread: in_picture(in_level.plate_spread),
            outline_spread: in_picture(in_level.outline_spread),
        }
    }
}
