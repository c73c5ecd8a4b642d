//! Adapts the toy's model to the real toy of a photograph.

use std::sync::Arc;

use glam::{DMat4, DVec3};

use super::photograph::Photograph;
use super::pose;
use super::pose::adapt::{Adapted, Surface, adapt};
use super::report::ModelAlignment;
use super::shape::Shape;
use app_scene::scene::Scene;
use app_scene::toy::{Toy, ToyError};

/// Displacements below this fraction of the largest count as zero.
const SIGNIFICANT: f64 = 0.01;

/// Largest distance, in pixels, between the outlines of toy and model for which the model is
/// adapted; beyond, the toy is at another place or another one. Models displaced by 1 mm, or with a
/// fifth of the triangles, came to 1.3.
pub(super) const MOST_ADAPTED_PX: f64 = 1.6;

/// An adapted model.
pub(super) struct AdaptedModel {
    pub(super) toy: Arc<Toy>,
    pub(super) report: ModelAlignment,
}

impl Photograph {
    /// The model of a toy in its place, with the shape that its outline shows; `None` if the
    /// picture does not support another shape.
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

/// A toy with displaced points.
struct Adapting<'a> {
    scene: &'a Scene,
    /// For each of the toy's vertices, the index of its point in the shape; `None` for an unused
    /// vertex.
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

/// For each vertex, the index of its point in the toy's shape.
fn points(toy: &Toy) -> Vec<Option<usize>> {
    let used = &toy.welded().vertices;
    let place = |first: &u32| used.binary_search(first).ok();
    toy.first_alike().iter().map(place).collect()
}

/// For each point of a toy's shape the mean outward normal of its triangles, weighted by area; zero
/// if it has no outside.
fn normals(toy: &Toy, shape: &Shape) -> Vec<DVec3> {
    let used = &toy.welded().vertices;
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
        // Points that the outline does not constrain are not displaced.
        let significant = found
            .displacements_m
            .iter()
            .filter(|one| one.length() > SIGNIFICANT * most_m);
        let squares: Vec<f64> = significant.map(|one| one.length_squared()).collect();
        Self {
            displaced_m: (squares.iter().sum::<f64>() / squares.len().max(1) as f64).sqrt(),
            most_displaced_m: most_m,
            n_pieces: found.n_pieces,
            outlines_px: found.outlines_px.map(|outline_px| picture_px * outline_px),
            evidence: found.evidence,
        }
    }
}
