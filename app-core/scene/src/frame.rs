//! Inputs of one frame.

use std::sync::Arc;

use glam::DMat4;

use crate::camera_frame::CameraImage;
use crate::depth::Depth;
use crate::gloss::Gloss;
use crate::grain::Grain;
use crate::people::People;
use crate::reflection::Reflection;
use crate::scene::check;
use crate::scene::{Camera, InputError, Light, LightEstimate, Pose, Scene};
use crate::shadow_style::ShadowStyle;
use crate::sharpness::Sharpness;
use crate::things::Things;

/// A camera frame of the real, static toy, and the pose to show.
///
/// No change from frame to frame recompiles a pipeline; the architecture document lists the changes
/// that lead to new learning.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct FrameInput {
    /// The camera's picture, of the scene's size.
    pub image: CameraImage,
    /// The camera that took it.
    pub camera: Camera,
    /// Exposure of the picture, relative to the scene's other frames: duration times sensitivity. 1
    /// if unknown; the fit then estimates it from the pixels.
    pub exposure: f64,
    /// Transform of the real toy, from the model's scene space to world: a rotation, a translation and one positive
    /// scale.
    pub world_from_object: DMat4,
    /// The lights, if they differ from the scene's.
    pub lights: Option<Arc<[Light]>>,
    /// The platform's estimate of the light, if there is one. Only alignment uses it, and only if
    /// no light is listed.
    pub light_estimate: Option<LightEstimate>,
    /// Depths of the picture, of its shape, if a sensor measured them. Only alignment uses them, to find planes on
    /// which things let the shadow fall.
    pub depth: Option<Depth>,
    /// The people in the picture, in a mask of its shape, if the platform shows where they are: one whose mask overlaps the
    /// toy is before it, others are beside it. They stay as the camera shows them, and nothing is
    /// learned from their pixels.
    pub people: Option<People>,
    /// Other things in the picture, if any are known.
    pub things: Option<Things>,
    /// Measured softness of the picture, which is applied to everything that is composed into it.
    /// Alignment measures it.
    pub sharpness: Sharpness,
    /// Gloss of the real toy, if it was measured: its highlights then move as reflections, and
    /// otherwise as paint. It belongs to the toy and not to the picture: after a change everything
    /// is learned again. Alignment measures it; only presets of the model use it.
    pub gloss: Gloss,
    /// Reflection of the receiver below the toy; `None` if it is matt or unknown. Alignment
    /// measures it. Only presets of the model use it, and only if the lights leave a channel.
    pub reflection: Option<Reflection>,
    /// The pose to show.
    pub shown_pose: Pose,
    /// The place to show the toy, if it differs from the real toy's: by the rules of
    /// `world_from_object`.
    pub world_from_shown: Option<DMat4>,
    /// Shown share of the effect, from 0, the camera's picture, to 1: an app fades it while pose or
    /// lights are unknown. At 0 nothing is learned.
    pub effect: f64,
    /// The picture's noise, which is added to synthesised pixels; `None` if the picture is clean.
    /// It is read with a new picture or pose, and only by presets of the model. Alignment measures it.
    pub grain: Option<Grain>,
    /// Artistic strength and softness of the shown shadow, for presets of the model. The first
    /// frame with a strength other than 1 compiles a shader; a softness above all earlier ones may
    /// enlarge the work region, which is then learned again.
    pub shadow_style: ShadowStyle,
}

/// Properties of a picture other than camera, toy pose and lights.
#[derive(Clone, Debug)]
pub struct Observations {
    things: Option<Things>,
    sharpness: Sharpness,
    grain: Option<Grain>,
    reflection: Option<Reflection>,
    gloss: Gloss,
}

impl FrameInput {
    /// A frame of unknown exposure in the scene's light, which shows the authored pose with the
    /// whole effect.
    #[must_use]
    pub fn new(image: impl Into<CameraImage>, camera: Camera, world_from_object: DMat4) -> Self {
        Self {
            image: image.into(),
            camera,
            exposure: 1.0,
            world_from_object,
            lights: None,
            light_estimate: None,
            depth: None,
            people: None,
            things: None,
            sharpness: Sharpness::SHARP,
            gloss: Gloss::NONE,
            reflection: None,
            shown_pose: Pose::default(),
            world_from_shown: None,
            effect: 1.0,
            grain: None,
            shadow_style: ShadowStyle::TRUE,
        }
    }

    /// Sets the picture.
    #[must_use]
    pub fn with_image(mut self, image: impl Into<CameraImage>) -> Self {
        self.image = image.into();
        self
    }

    /// Sets the camera of the picture.
    #[must_use]
    pub fn with_camera(mut self, camera: Camera) -> Self {
        self.camera = camera;
        self
    }

    /// Sets the exposure of the picture.
    #[must_use]
    pub fn with_exposure(mut self, exposure: f64) -> Self {
        self.exposure = exposure;
        self
    }

    /// Sets the transform of the real toy.
    #[must_use]
    pub fn with_world_from_object(mut self, world_from_object: DMat4) -> Self {
        self.world_from_object = world_from_object;
        self
    }

    /// Sets the lights; `None` for the scene's.
    #[must_use]
    pub fn with_lights(mut self, lights: Option<Arc<[Light]>>) -> Self {
        self.lights = lights;
        self
    }

    /// Sets the platform's estimate of the light.
    #[must_use]
    pub fn with_light_estimate(mut self, estimate: Option<LightEstimate>) -> Self {
        self.light_estimate = estimate;
        self
    }

    /// Sets the depths of the picture.
    #[must_use]
    pub fn with_depth(mut self, depth: Option<Depth>) -> Self {
        self.depth = depth;
        self
    }

    /// Sets the people in the picture.
    #[must_use]
    pub fn with_people(mut self, people: Option<People>) -> Self {
        self.people = people;
        self
    }

    /// All observations of the picture, for another input with the same picture.
    #[must_use]
    pub fn observations(&self) -> Observations {
        Observations {
            things: self.things.clone(),
            sharpness: self.sharpness,
            grain: self.grain,
            reflection: self.reflection,
            gloss: self.gloss,
        }
    }

    /// Sets all observations of the picture.
    #[must_use]
    pub fn with_observations(self, observations: Observations) -> Self {
        self.with_things(observations.things)
            .with_sharpness(observations.sharpness)
            .with_grain(observations.grain)
            .with_reflection(observations.reflection)
            .with_gloss(observations.gloss)
    }

    /// Sets the things in the picture beside the toy.
    #[must_use]
    pub fn with_things(mut self, things: Option<Things>) -> Self {
        self.things = things;
        self
    }

    /// Sets the softness of the picture.
    #[must_use]
    pub fn with_sharpness(mut self, sharpness: Sharpness) -> Self {
        self.sharpness = sharpness;
        self
    }

    /// Sets how glossy the toy is.
    #[must_use]
    pub fn with_gloss(mut self, gloss: Gloss) -> Self {
        self.gloss = gloss;
        self
    }

    /// Sets how the receiver that the toy stands on reflects.
    #[must_use]
    pub fn with_reflection(mut self, reflection: Option<Reflection>) -> Self {
        self.reflection = reflection;
        self
    }

    /// Sets the pose to show.
    #[must_use]
    pub fn with_shown_pose(mut self, pose: Pose) -> Self {
        self.shown_pose = pose;
        self
    }

    /// Sets the place to show the toy; `None` for the real toy's place.
    #[must_use]
    pub fn with_world_from_shown(mut self, world_from_shown: Option<DMat4>) -> Self {
        self.world_from_shown = world_from_shown;
        self
    }

    /// Sets the shown share of the effect, from 0 to 1.
    #[must_use]
    pub fn with_effect(mut self, effect: f64) -> Self {
        self.effect = effect;
        self
    }

    /// Sets the noise of synthesised pixels.
    #[must_use]
    pub fn with_grain(mut self, grain: Option<Grain>) -> Self {
        self.grain = grain;
        self
    }

    /// Sets strength and softness of the shown shadow.
    #[must_use]
    pub fn with_shadow_style(mut self, style: ShadowStyle) -> Self {
        self.shadow_style = style;
        self
    }

    /// The lights of the frame: its own, or the scene's.
    #[must_use]
    pub fn lights_in(&self, scene: &Scene) -> Arc<[Light]> {
        let own = self.lights.clone();
        own.unwrap_or_else(|| scene.lights.as_slice().into())
    }

    /// Whether it asks for the toy in the scene's pose of the real toy and at that toy's place.
    #[must_use]
    pub fn shows_real_toy(&self, scene: &Scene) -> bool {
        let place = self.world_from_shown.unwrap_or(self.world_from_object);
        place == self.world_from_object && self.shown_pose == scene.physical_pose
    }

    /// Validates the input.
    pub fn check(&self) -> Result<(), InputError> {
        check::camera("camera", &self.camera)?;
        InputError::at("exposure", check::number(self.exposure, &check::EXPOSURE))?;
        InputError::at("effect", check::number(self.effect, &(0.0..=1.0)))?;
        let similarity = check::similarity(self.world_from_object.to_cols_array());
        InputError::at("world_from_object", similarity)?;
        if let Some(world_from_shown) = &self.world_from_shown {
            let similarity = check::similarity(world_from_shown.to_cols_array());
            InputError::at("world_from_shown", similarity)?;
        }
        self.grain.map_or(Ok(()), |grain| grain.check())?;
        for (index, light) in self.lights.iter().flat_map(|lights| lights.iter()).enumerate() {
            light.check(&format!("lights[{index}]"))?;
        }
        self.sharpness.check("sharpness")?;
        self.gloss.check("gloss")?;
        self.reflection
            .map_or(Ok(()), |reflection| reflection.check("reflection"))?;
        self.shadow_style.check("shadow_style")?;
        if let Some(things) = &self.things {
            let [width_px, height_px] = things.size_px().to_array();
            InputError::at("things", check::picture_size(width_px, height_px))?;
            check::camera("things.camera", things.camera())?;
        }
        if let Some(people) = &self.people {
            let size = check::map_size(people.size_px().to_array(), self.image.size_px());
            InputError::at("people", size)?;
        }
        if let Some(depth) = &self.depth {
            let size = check::map_size(depth.size_px().to_array(), self.image.size_px());
            InputError::at("depth", size)?;
        }
        let estimate = self.light_estimate.as_ref();
        estimate.map_or(Ok(()), |estimate| estimate.check("light_estimate"))
    }
}
