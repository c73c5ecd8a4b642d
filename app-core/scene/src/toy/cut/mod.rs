//! What materials cut out by alpha, cut out of the triangles: leaves, feathers and hair on cards.
//!
//! Shadows, coverage, outline and colour need the same shape, in few passes that know nothing of textures. So a cut-out is
//! made once, when the file is read: triangles are divided along their edges until none is longer than a texel where alpha
//! crosses the cutoff, or than what any picture of the toy shows, and are then cut along the crossing. Toys without cut-outs
//! are not touched.

mod field;
mod grown;
mod refine;
mod welded;

use glam::DVec3;

use super::geometry::Geometry;
use super::material::{Alpha, Material};
use super::rig::{Rig, RigPose};
use super::surface::Surface;
use super::texture::Texture;
use super::warning::ToyWarning;
use crate::geometry::bounds::Bounds;
use field::Field;
use refine::{Finest, refined};

/// What is left of BLEND; blending needs what is behind.
const BLEND_CUTOFF: f32 = 0.5;
/// Triangles of all cut parts together.
const MAX_TRIANGLES: usize = 100_000;
/// The finest edge over the size of the toy: no picture shows it.
const FINEST: f64 = 1.0 / 1024.0;
/// Texels of the coarsest cut.
const COARSEST: u32 = 1 << 12;

/// A toy's shape at rest, to be cut.
pub(super) struct Shape<'a> {
    pub(super) rig: &'a Rig,
    pub(super) rest: &'a RigPose,
    pub(super) geometries: &'a mut Vec<Geometry>,
    pub(super) surfaces: &'a mut Vec<Surface>,
}

/// Materials and pictures, by which it is cut.
pub(super) struct Looks<'a> {
    pub(super) materials: &'a [Material],
    pub(super) textures: &'a [Texture],
}

/// A geometry to cut.
struct Part<'a> {
    geometry: usize,
    /// How often it is drawn.
    n_surfaces: usize,
    field: Field<'a>,
    /// Lengths at rest, over those in the file.
    scale: f64,
    material: usize,
    is_blend: bool,
}

/// Cuts all that is to be cut, and drops what nothing is left of.
pub(super) fn apply(shape: &mut Shape, looks: &Looks, warnings: &mut Vec<ToyWarning>) {
    let is_solid = |surface: &Surface| looks.materials[surface.material].alpha == Alpha::Opaque;
    if shape.surfaces.iter().all(is_solid) {
        return;
    }
    let (parts, size) = parts(shape, looks);
    let mut texels = 1;
    let cut = loop {
        let finest = |part: &Part| Finest {
            texels: texels as f32,
            length: FINEST * size / part.scale.max(f64::MIN_POSITIVE),
        };
        match all_cut(shape.geometries, &parts, finest) {
            Some(cut) => break cut,
            None if texels < COARSEST => texels *= 2,
            None => break Vec::new(),
        }
    };
    let is_emptied = |g: usize| {
        cut.iter()
            .any(|(part, made)| parts[*part].geometry == g && made.indices.is_empty())
    };
    // A toy of glass alone is drawn whole.
    let is_all_gone = shape.surfaces.iter().all(|surface| is_emptied(surface.geometry));
    for (part, made) in cut {
        let part = &parts[part];
        let field = format!("materials[{}]", part.material);
        if part.is_blend && is_all_gone {
            continue;
        }
        let mut say = |warning: ToyWarning| {
            if !warnings.contains(&warning) {
                warnings.push(warning);
            }
        };
        if part.is_blend {
            say(ToyWarning::BlendCut { field: field.clone() });
        }
        if texels > 1 {
            say(ToyWarning::CutCoarse { field, texels });
        }
        shape.geometries[part.geometry] = made;
    }
    lay_anew(shape);
}

/// The geometries to cut, and the size of the toy.
fn parts<'a>(shape: &Shape, looks: &Looks<'a>) -> (Vec<Part<'a>>, f64) {
    let mut all: Option<Bounds> = None;
    let mut parts: Vec<Part> = Vec::new();
    for surface in shape.surfaces.iter() {
        let geometry = &shape.geometries[surface.geometry];
        let active = geometry.active_targets(shape.rig.morph_weights(shape.rest, surface.node));
        let mut posed: Vec<DVec3> = Vec::with_capacity(geometry.positions.len());
        surface.deform(geometry, shape.rest, &active, |_, position, _| {
            posed.push(position)
        });
        let here = Bounds::around(posed.into_iter());
        let corners = all.iter().flat_map(Bounds::corners).chain(here.corners());
        all = Some(Bounds::around(corners.collect::<Vec<_>>().into_iter()));
        let material = &looks.materials[surface.material];
        let cutoff = match material.alpha {
            Alpha::Opaque => continue,
            Alpha::Mask(cutoff) => cutoff,
            Alpha::Blend => BLEND_CUTOFF,
        };
        if let Some(known) = parts.iter_mut().find(|part| part.geometry == surface.geometry) {
            known.n_surfaces += 1;
            continue;
        }
        let own = Bounds::around(geometry.positions.iter().map(|position| position.as_dvec3()));
        parts.push(Part {
            geometry: surface.geometry,
            n_surfaces: 1,
            field: Field::new(material, looks.textures, cutoff),
            scale: size(&here) / size(&own).max(f64::MIN_POSITIVE),
            material: surface.material,
            is_blend: material.alpha == Alpha::Blend,
        });
    }
    (parts, all.as_ref().map_or(0.0, size))
}

fn size(bounds: &Bounds) -> f64 {
    (bounds.max - bounds.min).max(DVec3::ZERO).length()
}

/// What is left of each part that loses something; `None` if these are too many triangles.
fn all_cut(
    geometries: &[Geometry],
    parts: &[Part],
    finest: impl Fn(&Part) -> Finest,
) -> Option<Vec<(usize, Geometry)>> {
    let mut n_triangles = 0;
    let mut cut = Vec::new();
    for (index, part) in parts.iter().enumerate() {
        let geometry = &geometries[part.geometry];
        let most = (MAX_TRIANGLES - n_triangles) / part.n_surfaces + geometry.triangles().len();
        let mesh = refined(geometry, &part.field, &finest(part), most)?;
        if let Some(mesh) = mesh.cut(&part.field) {
            n_triangles += part.n_surfaces * mesh.triangles.len();
            if n_triangles > MAX_TRIANGLES {
                return None;
            }
            cut.push((index, grown::geometry(geometry, &mesh)));
        }
    }
    Some(cut)
}

/// Drops surfaces without triangles, and counts vertices anew.
fn lay_anew(shape: &mut Shape) {
    let geometries = &*shape.geometries;
    shape
        .surfaces
        .retain(|surface| !geometries[surface.geometry].indices.is_empty());
    let mut first_vertex = 0;
    for surface in shape.surfaces.iter_mut() {
        surface.first_vertex = first_vertex;
        first_vertex += geometries[surface.geometry].positions.len();
    }
}
