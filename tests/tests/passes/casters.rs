//! The toy in front of the lights: the shapes that cast shadows, and the points from which they are
//! cast.

use app_core::scene::Light;
use app_core::toy::PosedMesh;
use app_scene::geometry::disc::ambient_directions;
use glam::{DMat4, DVec3, DVec4};
use reference::occlusion::{Caster, Occluder};

use crate::stand::Stand;

impl Stand {
    /// Points of a light, in anchor space.
    pub(crate) fn light_points(&self, index: usize, n_points: usize) -> Vec<DVec4> {
        self.points_of(&self.setup.lights[index], n_points)
    }

    fn points_of(&self, light: &Light, n_points: usize) -> Vec<DVec4> {
        let points = light.points_in(&self.anchor_from_world, self.physical_centre(), n_points);
        points.iter().map(|point| point.as_dvec4()).collect()
    }

    /// A posed toy under points over light `index`, in the planned number, for each receiver.
    pub(crate) fn light_casters(&self, posed: &PosedMesh, index: usize, n_points: usize) -> Vec<Caster> {
        self.softened_casters(posed, (index, 1.0), n_points)
    }

    /// The same with the light this many times as wide.
    pub(crate) fn softened_casters(
        &self,
        posed: &PosedMesh,
        (index, softness): (usize, f64),
        n_points: usize,
    ) -> Vec<Caster> {
        let light = &self.setup.lights[index];
        let centre = self
            .anchor_from_world
            .inverse()
            .transform_point3(self.physical_centre());
        let in_anchor = self.points_of(&light.widened(centre, softness), n_points);
        self.casters(posed, |plane_from_anchor| {
            in_anchor
                .iter()
                .map(|point| *plane_from_anchor * *point)
                .collect()
        })
    }

    /// A posed toy under directions of the ambient light, in the planned number, for each receiver.
    pub(crate) fn ambient_casters(&self, posed: &PosedMesh, n_directions: usize) -> Vec<Caster> {
        let directions = ambient_directions(n_directions);
        // Each receiver has its own hemisphere.
        self.casters(posed, |_| {
            directions.iter().map(|point| point.as_dvec4()).collect()
        })
    }

    fn casters(&self, posed: &PosedMesh, light_points: impl Fn(&DMat4) -> Vec<DVec4>) -> Vec<Caster> {
        let planes = self
            .anchored
            .iter()
            .map(|receiver| receiver.world_from_plane.inverse() * self.anchor_from_world.inverse());
        planes
            .map(|plane_from_anchor| Caster {
                occluder: self.occluder_in(posed, &plane_from_anchor),
                light_points: light_points(&plane_from_anchor),
            })
            .collect()
    }

    /// A posed toy in anchor space.
    pub(crate) fn occluder(&self, posed: &PosedMesh) -> Occluder {
        self.occluder_in(posed, &DMat4::IDENTITY)
    }

    fn occluder_in(&self, posed: &PosedMesh, plane_from_anchor: &DMat4) -> Occluder {
        let positions = posed.positions.iter();
        let positions: Vec<DVec3> = positions
            .map(|position| plane_from_anchor.transform_point3(position.as_dvec3()))
            .collect();
        Occluder::new(&positions, self.toy.indices())
    }
}
