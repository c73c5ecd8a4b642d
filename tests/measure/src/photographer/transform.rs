//! The same world at another place, in another size, and mirrored: its pictures stay the same, or
//! are flipped by the mirror.

use app_core::scene::{Camera, Image, Intrinsics, Light};
use glam::{DMat4, DVec3};

use super::lamp::Lamp;
use super::motion::Key;
use super::world::{Ground, Part, World};

/// The mirror, which swaps the sign of x.
const MIRROR: DVec3 = DVec3::new(-1.0, 1.0, 1.0);

impl World {
    /// The world after a rigid motion.
    #[must_use]
    pub fn moved(mut self, new_from_old: &DMat4) -> Self {
        self.camera.world_from_camera = *new_from_old * self.camera.world_from_camera;
        self.world_from_object = *new_from_old * self.world_from_object;
        for ground in &mut self.grounds {
            ground.world_from_plane = *new_from_old * ground.world_from_plane;
        }
        for lamp in &mut self.lamps {
            lamp.light = lamp.light.moved(new_from_old);
        }
        self
    }

    /// The world with all lengths times a factor; the toy's file stays.
    #[must_use]
    pub fn scaled(mut self, factor: f64) -> Self {
        self.camera.world_from_camera.w_axis *= DVec3::splat(factor).extend(1.0);
        self.world_from_object = DMat4::from_scale(DVec3::splat(factor)) * self.world_from_object;
        for ground in &mut self.grounds {
            ground.world_from_plane.w_axis *= DVec3::splat(factor).extend(1.0);
            ground.half_extent_m *= factor;
        }
        for lamp in &mut self.lamps {
            if let Light::Sphere {
                position_in_world,
                radius_m,
            } = &mut lamp.light
            {
                *position_in_world *= factor;
                *radius_m *= factor;
                // So that the toy has the same light.
                lamp.color *= factor * factor;
            }
        }
        self
    }

    /// The mirrored world; its pictures are [`flipped`].
    #[must_use]
    pub fn mirrored(self) -> Self {
        let [width, _] = self.size_px.map(f64::from);
        let k = self.camera.intrinsics;
        Self {
            camera: Camera {
                intrinsics: Intrinsics {
                    cx_px: width - k.cx_px,
                    ..k
                },
                world_from_camera: mirrored(&self.camera.world_from_camera),
            },
            grounds: self.grounds.iter().map(mirrored_ground).collect(),
            lamps: self.lamps.iter().map(mirrored_lamp).collect(),
            parts: self.parts.iter().map(mirrored_part).collect(),
            world_from_object: mirrored(&self.world_from_object),
            ..self
        }
    }
}

/// A picture with its columns reversed.
#[must_use]
pub fn flipped(image: &Image) -> Image {
    let rows = image.rgba8.chunks_exact(4 * image.width_px as usize);
    let turned = rows.flat_map(|row| row.chunks_exact(4).rev().flatten().copied());
    Image {
        rgba8: turned.collect(),
        ..*image
    }
}

/// A rigid transform between mirrored spaces.
fn mirrored(transform: &DMat4) -> DMat4 {
    let mirror = DMat4::from_scale(MIRROR);
    mirror * *transform * mirror
}

fn mirrored_ground(ground: &Ground) -> Ground {
    Ground {
        world_from_plane: mirrored(&ground.world_from_plane),
        ..ground.clone()
    }
}

fn mirrored_lamp(lamp: &Lamp) -> Lamp {
    Lamp {
        light: lamp
            .light
            .map(|position| MIRROR * position, |direction| MIRROR * direction),
        ..*lamp
    }
}

fn mirrored_part(part: &Part) -> Part {
    let keys = part.keys.iter().map(|key| Key {
        stance: key.stance.mirrored(),
        ..*key
    });
    Part {
        shape: part.shape.mirrored(),
        rest: part.rest.mirrored(),
        keys: keys.collect(),
        ..part.clone()
    }
}
