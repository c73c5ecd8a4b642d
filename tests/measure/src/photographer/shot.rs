//! The core's inputs of a world, scene and frame, and the truth for scoring.

use std::sync::Arc;

use app_core::frame::FrameInput;
use app_core::scene::{Image, Plate, Pose, Receiver, Scene};
use app_core::session::Truth;
use app_core::toy::{Toy, ToyError};
use glam::DVec3;

use super::film::{Film, expose};
use super::rays::Place;
use super::toy::{CLIP, ToyFile, toy_glb};
use super::world::{Sensor, Shown, World};

/// A camera's views of a world, before they become codes.
#[derive(Clone, Debug)]
pub struct Films {
    /// The place without the toy.
    pub plate: Film,
    /// The toy in its physical pose.
    pub real: Film,
    /// The toy in the shown pose.
    pub moved: Film,
}

/// Pictures of a world.
#[derive(Clone, Debug)]
pub struct Photos {
    /// The place without the toy.
    pub plate: Arc<Image>,
    /// The toy in its physical pose.
    pub frame: Arc<Image>,
    /// The toy in the shown pose, without noise.
    pub truth: Truth,
}

/// A session of one frame, in memory.
#[derive(Clone, Debug)]
pub struct Shot {
    /// The scene.
    pub scene: Scene,
    /// The frame.
    pub input: FrameInput,
    /// The truth, which the core does not receive.
    pub truth: Truth,
    /// The toy's file.
    pub glb: Vec<u8>,
}

impl Films {
    /// Renders a world: its place, its toy as it stands, its toy in the shown pose.
    #[must_use]
    pub fn of(world: &World) -> Self {
        Self {
            plate: expose(&Place::empty(world), &world.camera),
            real: expose(&Place::new(world, Shown::Rest), &world.camera),
            moved: expose(&Place::new(world, world.shown), &world.camera),
        }
    }

    /// The pictures of a sensor.
    #[must_use]
    pub fn develop(&self, sensor: &Sensor) -> Photos {
        // Plate and frame have independent noise.
        let picture =
            |film: &Film, gain: DVec3, seed: u64| Arc::new(film.develop(gain, sensor.noise_codes, seed));
        Photos {
            plate: picture(&self.plate, sensor.plate_gain, sensor.seed),
            frame: picture(&self.real, sensor.frame_gain, !sensor.seed),
            truth: Truth {
                image: self.moved.develop(sensor.frame_gain, 0.0, 0),
                mask: self.moved.mask(&self.real),
            },
        }
    }
}

impl Photos {
    /// Photographs a world.
    #[must_use]
    pub fn of(world: &World) -> Self {
        Films::of(world).develop(&world.sensor)
    }
}

impl Shot {
    /// Photographs a world and describes it as a session.
    ///
    /// # Errors
    /// When the core refuses the toy's file.
    pub fn of(world: &World) -> Result<Self, ToyError> {
        Self::described(world, &Photos::of(world), &ToyFile::default())
    }

    /// Describes a world with existing pictures, and with the toy's file written in a variant.
    ///
    /// # Errors
    /// When the core refuses the toy's file.
    pub fn described(world: &World, photos: &Photos, file: &ToyFile) -> Result<Self, ToyError> {
        let glb = toy_glb(world, file);
        let toy = Toy::from_glb("toy.glb", &glb)?;
        let shown_pose = match world.shown {
            Shown::Rest => Pose::Authored,
            Shown::At { time_secs } => Pose::Clip {
                clip: toy.find_clip(CLIP)?,
                time_secs,
            },
        };
        let grounds = world.grounds.iter().enumerate();
        let receivers = grounds.map(|(index, ground)| Receiver {
            name: format!("ground {index}"),
            world_from_plane: ground.world_from_plane,
            half_extent_m: ground.half_extent_m,
            surface: ground.paint.surface(),
        });
        Ok(Self {
            scene: Scene::new(
                world.size_px,
                Arc::new(toy),
                world.world_from_object,
                receivers.collect(),
            )
            .with_name(world.name.clone())
            .with_lights(world.lights())
            .with_plates(vec![Plate {
                camera: world.camera,
                image: Arc::clone(&photos.plate),
            }]),
            input: FrameInput::new(Arc::clone(&photos.frame), world.camera, world.world_from_object)
                .with_shown_pose(shown_pose),
            truth: photos.truth.clone(),
            glb,
        })
    }
}
