//! The lights of a list whose shadows are retargeted.

use std::sync::Arc;

use glam::DMat4;

use super::nearest_receivers::nearest_to_toy;
use crate::scene::{Light, MAX_LIGHTS, MAX_RECEIVERS, Scene};

/// The lights of a list that are used, and those that are left out.
pub struct UsedLights {
    /// Indices of the first [`MAX_LIGHTS`] that are above any receiver.
    pub indices: Vec<usize>,
    /// Indices of those that are above none.
    pub below: Vec<usize>,
    /// Number of further ones that are above a receiver.
    pub n_left_out: usize,
}

impl UsedLights {
    /// Selects lights of a list, given the transform from the world to the plane space of each receiver.
    #[must_use]
    pub fn new(listed: &[Light], planes_from_world: &[DMat4]) -> Self {
        let is_above_any = |light: &Light| {
            let mut planes = planes_from_world.iter();
            planes.any(|plane_from_world| light.is_above(plane_from_world))
        };
        let (mut indices, below): (Vec<usize>, Vec<usize>) =
            (0..listed.len()).partition(|index| is_above_any(&listed[*index]));
        let n_left_out = indices.len().saturating_sub(MAX_LIGHTS);
        indices.truncate(MAX_LIGHTS);
        Self {
            indices,
            below,
            n_left_out,
        }
    }

    /// The same for the receivers of a scene that are nearest to its toy in a place.
    #[must_use]
    pub fn near(scene: &Scene, listed: &[Light], world_from_object: &DMat4) -> Self {
        let nearest = nearest_to_toy(scene, world_from_object);
        let nearest = nearest.into_iter().take(MAX_RECEIVERS);
        let planes_from_world: Vec<DMat4> = nearest
            .map(|index| scene.receivers[index].world_from_plane.inverse())
            .collect();
        Self::new(listed, &planes_from_world)
    }

    /// The used lights of that list.
    #[must_use]
    pub fn of<T: FromIterator<Light>>(&self, listed: &[Light]) -> T {
        self.indices.iter().map(|index| listed[*index]).collect()
    }

    /// That list with others in place of those that are used.
    #[must_use]
    pub fn replaced(&self, listed: &[Light], by: &[Light]) -> Arc<[Light]> {
        let mut replaced = listed.to_vec();
        for (index, light) in self.indices.iter().zip(by) {
            replaced[*index] = *light;
        }
        replaced.into()
    }
}
