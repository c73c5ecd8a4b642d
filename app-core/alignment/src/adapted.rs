//! The toy's model, adapted to the toy that a photograph shows.

use std::sync::Arc;

use glam::{DMat4, DVec3};

use super::photograph::Photograph;
use super::pose;
use super::pose::adapt::{Adapted, Surface, adapt};
use super::report::ModelAlignment;
use super::shape::Shape;
use app_scene::scene::Scene;
use app_scene::toy::{Toy, ToyError};

/// Points that are displaced by less, over the most that any is, count as not displaced.
const TOLD: f64 = 0.01;

/// A toy whose outline is farther from that of its model, in pixels, is somewhere else or another one: no model is adapted to it. Of those
/// that were displaced by 1 mm, or have a fifth of the triangles, outlines came to 1.3.
pub(super) const MOST_ADAPTED_PX: f64 = 1.6;

/// A model that was adapted.
pub(super) struct AdaptedModel {
    pub(super) toy: Arc<Toy>,
    pub(super) report: ModelAlignment,
}

impl Photograph {
    /// The model of a toy in its place with the shape that its outline shows; none where the picture does not speak for another one.
    pub(super) fn adapted(
        &self,
        scene: &Scene,
        world_from_object: &DMat4,
    ) -> Result<Option<AdaptedModel>, ToyError> {
        let camera_from_object = self.camera_from_object(world_from_object);
        let posed = |scene: &Scene| -> Result<Surface, ToyError> {
            let shape = Shape::new(scene, &camera_from_object)?;
            Ok((shape, pose::Paint::new(scene, &camera_from_object)?))
        };
        let given = posed(scene)?;
        let normals = normals(&scene.toy, &given.0);
        let adapting = Adapting {
            scene,
            points: points(&scene.toy),
            object_from_camera: camera_from_object.inverse(),
        };
        let displaced = |displacements_m: &[DVec3]| posed(&adapting.displaced(displacements_m)?);
        let found = adapt((&given, &normals), self.pyramid(), displaced)?;
        let Some(found) = found else { return Ok(None) };
        Ok(Some(AdaptedModel {
            toy: adapting.displaced(&found.displacements_m)?.toy,
            report: ModelAlignment::new(&found, self.pyramid().picture_px()),
        }))
    }
}

/// A toy whose points are displaced.
struct Adapting<'a> {
    scene: &'a Scene,
    /// Of each of the toy's vertices, its place among the points of its shape; none where no triangle has it.
    points: Vec<Option<usize>>,
    object_from_camera: DMat4,
}

impl Adapting<'_> {
    /// The scene with its toy's points displaced, in camera space.
    fn displaced(&self, displacements_m: &[DVec3]) -> Result<Scene, ToyError> {
        let of_vertices = self.points.iter().map(|point| {
            let displacement = point.map(|point| displacements_m[point]);
            self.object_from_camera
                .transform_vector3(displacement.unwrap_or(DVec3::ZERO))
        });
        let of_vertices: Vec<DVec3> = of_vertices.collect();
        let toy = self
            .scene
            .toy
            .displaced(&self.scene.physical_pose, &of_vertices)?;
        Ok(self.scene.clone().with_toy(Arc::new(toy)))
    }
}

/// Of each vertex, its place among the points of the toy's shape.
fn points(toy: &Toy) -> Vec<Option<usize>> {
    let used = Shape::vertices(toy);
    let place = |first: &u32| used.binary_search(first).ok();
    toy.first_alike().iter().map(place).collect()
}

/// Of each point of a toy's shape the mean of its triangles' normals, by their areas, outwards; zero where it has no outside.
fn normals(toy: &Toy, shape: &Shape) -> Vec<DVec3> {
    let used = Shape::vertices(toy);
    let mut normals = vec![DVec3::ZERO; shape.points.len()];
    for corners in toy.shadow_indices().indices.as_chunks::<3>().0 {
        let places = corners.map(|corner| used.binary_search(&corner).unwrap_or_default());
        let [a, b, c] = places.map(|place| shape.points[place]);
        for place in places {
            normals[place] += (b - a).cross(c - a);
        }
    }
    normals.into_iter().map(DVec3::normalize_or_zero).collect()
}

impl ModelAlignment {
    pub(crate) fn new(found: &Adapted, picture_px: f64) -> Self {
        let most_m = found
            .displacements_m
            .iter()
            .fold(0.0, |most: f64, one| most.max(one.length()));
        // Where no outline tells anything, nothing is displaced.
        let told = found
            .displacements_m
            .iter()
            .filter(|one| one.length() > TOLD * most_m);
        let squares: Vec<f64> = told.map(|one| one.length_squared()).collect();
        Self {
            displaced_m: (squares.iter().sum::<f64>() / squares.len().max(1) as f64).sqrt(),
            most_displaced_m: most_m,
            n_pieces: found.n_pieces,
            outlines_px: found.outlines_px.map(|outline_px| picture_px * outline_px),
            evidence: found.evidence,
        }
    }
}
