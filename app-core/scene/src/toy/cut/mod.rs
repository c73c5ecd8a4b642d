//! Cuts triangles along alpha cut-outs of materials: leaves, feathers and hair on cards.
//!
//! Shadows, coverage, outline and colour need the same shape, and most passes have no textures. So
//! the cut is made once, when the file is read: triangles are divided along their edges until none
//! is longer than a texel at the crossing of the cutoff, or than any visible detail, and are then
//! cut along the crossing. Toys without cut-outs do not change.

mod field;
mod grown;
mod refine;
mod welded;

use std::collections::{HashMap, HashSet};

use glam::DVec3;

use super::geometry::Geometry;
use super::material::{Alpha, Material};
use super::rig::{Rig, RigPose};
use super::surface::Surface;
use super::texture::Texture;
use super::warning::ToyWarning;
use crate::geometry::bounds::Bounds;
use field::{Field, Pyramids};
use refine::{Finest, is_clear, refined};

/// Cutoff for BLEND, since blending would need the background.
const BLEND_CUTOFF: f32 = 0.5;
/// Limit for the triangles of all cut parts together.
const MAX_TRIANGLES: usize = 100_000;
/// The finest edge over the size of the toy: below the detail of any picture.
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

/// Materials and pictures that define the cut.
pub(super) struct Looks<'a> {
    pub(super) materials: &'a [Material],
    pub(super) textures: &'a [Texture],
}

/// A geometry to cut.
struct Part<'a> {
    geometry: usize,
    /// Number of surfaces that draw it.
    n_surfaces: usize,
    field: Field<'a>,
    /// Scale at rest relative to the file; the largest of all surfaces.
    scale: f64,
    /// Size in the file.
    own_size: f64,
    material: usize,
    is_blend: bool,
}

/// Makes all cuts, and drops empty parts.
pub(super) fn apply(shape: &mut Shape, looks: &Looks, warnings: &mut Vec<ToyWarning>) {
    let is_solid = |surface: &Surface| looks.materials[surface.material].alpha == Alpha::Opaque;
    if shape.surfaces.iter().all(is_solid) {
        return;
    }
    let (parts, size) = parts(shape, looks);
    let (texels, mut cut) = finest_cut(shape.geometries, &parts, size);
    keep_glass(shape.surfaces, &parts, &mut cut);
    let cut_materials: HashSet<usize> = parts
        .iter()
        .zip(&cut)
        .filter_map(|(part, made)| made.is_some().then_some(part.material))
        .collect();
    for (part, made) in parts.iter().zip(cut) {
        let geometry = &mut shape.geometries[part.geometry];
        let is_cut = cut_materials.contains(&part.material);
        for warning in part.warnings(is_cut, texels) {
            if !warnings.contains(&warning) && (is_cut || is_clear(geometry, &part.field)) {
                warnings.push(warning);
            }
        }
        if let Some(made) = made {
            *geometry = made;
        }
    }
    lay_anew(shape);
}

/// The rest of each part that loses something, and the texel size of the cut; `None` if even the
/// coarsest cut has too many triangles.
fn finest_cut(geometries: &[Geometry], parts: &[Part], size: f64) -> (Option<u32>, Vec<Option<Geometry>>) {
    let mut texels = 1;
    while texels <= COARSEST {
        let finest = |part: &Part| Finest {
            texels: texels as f32,
            length: FINEST * part.toy_size(size),
        };
        if let Some(cut) = all_cut(geometries, parts, finest) {
            return (Some(texels), cut);
        }
        texels *= 2;
    }
    (None, parts.iter().map(|_| None).collect())
}

/// Keeps a toy made only of glass whole.
fn keep_glass(surfaces: &[Surface], parts: &[Part], cut: &mut [Option<Geometry>]) {
    let emptied: HashSet<usize> = parts
        .iter()
        .zip(&*cut)
        .filter(|(_, made)| made.as_ref().is_some_and(|made| made.indices.is_empty()))
        .map(|(part, _)| part.geometry)
        .collect();
    if !surfaces.iter().all(|surface| emptied.contains(&surface.geometry)) {
        return;
    }
    for (part, made) in parts.iter().zip(cut) {
        if part.is_blend {
            *made = None;
        }
    }
}

impl Part<'_> {
    /// Size of the toy in units of the file, at this part's scale at rest; the part's own size if
    /// it is practically hidden at rest, since a clip enlarges it.
    fn toy_size(&self, size: f64) -> f64 {
        /// Parts smaller than this relative to the toy are hidden.
        const HIDDEN: f64 = 1e-6;
        let here = self.scale * self.own_size;
        match here > HIDDEN * size {
            true => size / self.scale,
            false => self.own_size,
        }
    }

    /// Warnings about its material, if alpha is below 1 somewhere.
    fn warnings(&self, is_cut: bool, texels: Option<u32>) -> Vec<ToyWarning> {
        let field = || format!("materials[{}]", self.material);
        let Some(texels) = texels else {
            return vec![ToyWarning::NotCut { field: field() }];
        };
        let mut warnings = Vec::new();
        if self.is_blend && is_cut {
            warnings.push(ToyWarning::BlendCut { field: field() });
        } else if self.is_blend {
            warnings.push(ToyWarning::BlendWhole { field: field() });
        }
        if is_cut && texels > 1 {
            let field = field();
            warnings.push(ToyWarning::CutCoarse { field, texels });
        }
        warnings
    }
}

/// The geometries to cut, and the size of the toy.
fn parts<'a>(shape: &Shape, looks: &Looks<'a>) -> (Vec<Part<'a>>, f64) {
    let mut all: Option<Bounds> = None;
    let mut parts: Vec<Part> = Vec::new();
    let mut place_of: HashMap<usize, usize> = HashMap::new();
    let mut pyramids = Pyramids::new(looks.textures);
    for surface in shape.surfaces.iter() {
        let geometry = &shape.geometries[surface.geometry];
        let here = bounds(shape, surface);
        let corners = all.iter().flat_map(Bounds::corners).chain(here.corners());
        all = Some(Bounds::around(corners.collect::<Vec<_>>().into_iter()));
        let material = &looks.materials[surface.material];
        let cutoff = match material.alpha {
            Alpha::Opaque => continue,
            Alpha::Mask(cutoff) => cutoff,
            Alpha::Blend => BLEND_CUTOFF,
        };
        let place = *place_of.entry(surface.geometry).or_insert_with(|| {
            let own = Bounds::around(geometry.positions.iter().map(|position| position.as_dvec3()));
            parts.push(Part {
                geometry: surface.geometry,
                n_surfaces: 0,
                field: Field::new(material, &mut pyramids, cutoff),
                scale: 0.0,
                own_size: size(&own),
                material: surface.material,
                is_blend: material.alpha == Alpha::Blend,
            });
            parts.len() - 1
        });
        let part = &mut parts[place];
        part.n_surfaces += 1;
        part.scale = part.scale.max(size(&here) / part.own_size.max(f64::MIN_POSITIVE));
    }
    (parts, all.as_ref().map_or(0.0, size))
}

/// Bounds of a surface at rest.
fn bounds(shape: &Shape, surface: &Surface) -> Bounds {
    let geometry = &shape.geometries[surface.geometry];
    let active = geometry.active_targets(shape.rig.morph_weights(shape.rest, surface.node));
    let mut posed: Vec<DVec3> = Vec::with_capacity(geometry.positions.len());
    surface.deform(geometry, shape.rest, &active, |_, position, _| {
        posed.push(position)
    });
    Bounds::around(posed.into_iter())
}

fn size(bounds: &Bounds) -> f64 {
    (bounds.max - bounds.min).max(DVec3::ZERO).length()
}

/// For each part, its rest if it loses something; `None` if there would be too many triangles.
fn all_cut(
    geometries: &[Geometry],
    parts: &[Part],
    finest: impl Fn(&Part) -> Finest,
) -> Option<Vec<Option<Geometry>>> {
    let mut n_triangles = 0;
    let mut cut = Vec::new();
    for part in parts {
        let geometry = &geometries[part.geometry];
        let most = (MAX_TRIANGLES - n_triangles) / part.n_surfaces + geometry.triangles().len();
        let mesh = refined(geometry, &part.field, &finest(part), most)?;
        let mesh = mesh.cut(&part.field);
        n_triangles += part.n_surfaces * mesh.as_ref().map_or(0, |mesh| mesh.triangles.len());
        if n_triangles > MAX_TRIANGLES {
            return None;
        }
        cut.push(mesh.map(|mesh| grown::geometry(geometry, &mesh)));
    }
    Some(cut)
}

/// Drops surfaces without triangles, and renumbers vertices.
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
