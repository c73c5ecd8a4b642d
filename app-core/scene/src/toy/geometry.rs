//! One primitive as read: its vertices at rest, without the effect of nodes, skin or morph targets.

use glam::{DVec3, Vec2, Vec3, Vec4};
use gltf::json::accessor::{Accessor, Type};
use gltf::json::mesh::{MorphTarget as JsonTarget, Primitive, Semantic};
use gltf::json::validation::Checked;
use gltf::json::{Index, mesh::Mode};

use super::accessor::{Source, grouped};
use super::check::{check_count, check_limit, check_range};
use super::container::{allowed, get};
use super::error::{Flaw, ToyProblem};
use super::limits::{COLOR, FACTOR, MAX_INDICES, MAX_TRIANGLES, MAX_VERTICES, UV};
use super::skin::{Influences, read_influences};
use super::topology::{compacted, triangles, unwelded};
use super::warning::ToyWarning;

/// A primitive in the space of its mesh.
#[derive(Clone)]
pub(super) struct Geometry {
    pub(super) positions: Vec<Vec3>,
    /// `None` if the file has none: triangles are then flat, with three vertices each of their own.
    pub(super) normals: Option<Vec<Vec3>>,
    pub(super) targets: Vec<MorphTarget>,
    pub(super) influences: Option<Influences>,
    /// Base colour texture coordinates.
    pub(super) uvs: Option<Vec<Vec2>>,
    /// Linear RGBA.
    pub(super) colors: Option<Vec<Vec4>>,
    /// Corners of triangles, counter-clockwise from outside.
    pub(super) indices: Vec<u32>,
}

/// Offsets of a morph target at full weight.
#[derive(Clone)]
pub(super) struct MorphTarget {
    positions: Option<Vec<Vec3>>,
    normals: Option<Vec<Vec3>>,
}

/// The bits of a point's coordinates, as a key for equal places; adding zero makes both zeros
/// equal.
pub(super) fn place_bits(point: Vec3) -> [u32; 3] {
    (point + 0.0).to_array().map(f32::to_bits)
}

impl MorphTarget {
    /// Whether it moves any vertex.
    pub(super) fn moves(&self) -> bool {
        self.positions.is_some()
    }

    /// The same with its lists mapped.
    pub(super) fn mapped(&self, map: impl Fn(&[Vec3]) -> Vec<Vec3>) -> Self {
        Self {
            positions: self.positions.as_deref().map(&map),
            normals: self.normals.as_deref().map(&map),
        }
    }

    /// Its offset of a vertex's position.
    pub(super) fn offset(&self, vertex: usize) -> Vec3 {
        self.positions
            .as_ref()
            .map_or(Vec3::ZERO, |positions| positions[vertex])
    }
}

/// A morph target and its weight, which is not zero.
pub(super) struct ActiveTarget<'a> {
    target: &'a MorphTarget,
    weight: f64,
}

impl Geometry {
    /// Corners of each triangle.
    pub(super) fn triangles(&self) -> &[[u32; 3]] {
        self.indices.as_chunks().0
    }

    /// Reverses a triangle.
    pub(super) fn turn_triangle(&mut self, triangle: usize) {
        let (b, c) = (3 * triangle + 1, 3 * triangle + 2);
        if self.normals.is_some() {
            self.indices.swap(b, c);
        } else {
            // Its vertices are consecutive, since its normal is computed from them.
            self.swap_vertices(b, c);
        }
    }

    /// Reverses the normal of a vertex, in every morph target.
    pub(super) fn turn_normal(&mut self, vertex: usize) {
        let of_targets = self
            .targets
            .iter_mut()
            .filter_map(|target| target.normals.as_mut());
        for normals in self.normals.iter_mut().chain(of_targets) {
            normals[vertex] = -normals[vertex];
        }
    }

    fn swap_vertices(&mut self, a: usize, b: usize) {
        let of_targets = self
            .targets
            .iter_mut()
            .filter_map(|target| target.positions.as_mut());
        for positions in of_targets.chain([&mut self.positions]) {
            positions.swap(a, b);
        }
        self.uvs.iter_mut().for_each(|uvs| uvs.swap(a, b));
        self.colors.iter_mut().for_each(|colors| colors.swap(a, b));
        self.influences.iter_mut().for_each(|all| all.swap(a, b));
    }

    pub(super) fn active_targets(&self, weights: &[f64]) -> Vec<ActiveTarget<'_>> {
        let all = self
            .targets
            .iter()
            .zip(weights)
            .map(|(target, &weight)| ActiveTarget { target, weight });
        all.filter(|active| active.weight != 0.0).collect()
    }

    pub(super) fn morphed_position(&self, vertex: usize, active: &[ActiveTarget]) -> DVec3 {
        morphed(
            &self.positions,
            vertex,
            active.iter().map(|a| (a.weight, a.target.positions.as_deref())),
        )
    }

    /// The normal before skinning, not of unit length; `normals` are this geometry's.
    pub(super) fn morphed_normal(normals: &[Vec3], vertex: usize, active: &[ActiveTarget]) -> DVec3 {
        morphed(
            normals,
            vertex,
            active.iter().map(|a| (a.weight, a.target.normals.as_deref())),
        )
    }
}

fn morphed<'a>(
    base: &[Vec3],
    vertex: usize,
    deltas: impl Iterator<Item = (f64, Option<&'a [Vec3]>)>,
) -> DVec3 {
    let added = |(weight, deltas): (f64, Option<&[Vec3]>)| Some(deltas?[vertex].as_dvec3() * weight);
    base[vertex].as_dvec3() + deltas.filter_map(added).sum::<DVec3>()
}

/// Reads a primitive; `None` for points or lines. `tex_coord` is the coordinate set of its
/// material.
pub(super) fn read(
    source: &Source,
    field: &str,
    primitive: &Primitive,
    tex_coord: u32,
    warnings: &mut Vec<ToyWarning>,
) -> Result<Option<Geometry>, Flaw> {
    let mode = allowed(primitive.mode, &format!("{field}.mode"))?;
    let attribute = |semantic| primitive.attributes.get(&Checked::Valid(semantic)).copied();
    let position_field = format!("{field}.attributes.POSITION");
    let positions = attribute(Semantic::Positions).ok_or_else(|| ToyProblem::Missing.at(&position_field))?;
    let positions = source.vec3s(&position_field, positions)?;
    let n_vertices = check_limit("vertices", positions.len(), MAX_VERTICES, &position_field)?;
    let Some(triangles) = read_triangles(source, field, primitive, mode, n_vertices)? else {
        return Ok(None);
    };
    let normals = attribute(Semantic::Normals);
    let corners = match normals {
        Some(_) => compacted(&triangles, n_vertices),
        None => unwelded(triangles),
    };
    check_limit("vertices", corners.sources.len(), MAX_VERTICES, &position_field)?;
    let gather = Gather {
        source,
        field,
        n_vertices,
        sources: &corners.sources,
    };
    let targets = primitive.targets.iter().flatten().enumerate();
    let targets = targets
        .map(|(i, target)| gather.target(i, target, normals.is_some()))
        .collect::<Result<_, _>>()?;
    let mut colors = gather.attribute("COLOR_0", attribute(Semantic::Colors(0)), read_colors)?;
    colors
        .iter_mut()
        .for_each(|colors| clamp_colors(colors, field, warnings));
    let influences = read_influences(source, field, primitive, n_vertices)?;
    if let Some(influences) = &influences {
        source.charge(
            field,
            influences.n_per_vertex.saturating_mul(2 * corners.sources.len()),
        )?;
    }
    let mut uvs = gather.attribute(
        &format!("TEXCOORD_{tex_coord}"),
        attribute(Semantic::TexCoords(tex_coord)),
        Source::uvs,
    )?;
    let material = primitive.material.map(|material| material.value());
    if let (Some(uvs), Some(transform)) = (&mut uvs, source.uv_transform(material)) {
        uvs.iter_mut().for_each(|uv| *uv = transform.apply(*uv));
        let moved: Vec<f32> = uvs.iter().flat_map(Vec2::to_array).collect();
        check_range(
            &format!("{field}.attributes.TEXCOORD_{tex_coord}"),
            &moved,
            2,
            &UV,
        )?;
    }
    Ok(Some(Geometry {
        targets,
        influences: influences.map(|all| all.gather(&corners.sources)),
        uvs,
        colors,
        normals: gather.attribute("NORMAL", normals, Source::vec3s)?,
        positions: gather.picked(&positions)?,
        indices: corners.indices,
    }))
}

fn read_triangles(
    source: &Source,
    field: &str,
    primitive: &Primitive,
    mode: Mode,
    n_vertices: usize,
) -> Result<Option<Vec<u32>>, Flaw> {
    let field = format!("{field}.indices");
    let corners = match primitive.indices {
        Some(indices) => source.integers(&field, indices, Type::Scalar)?,
        None => (0..).take(n_vertices).collect(),
    };
    check_limit("indices", corners.len(), MAX_INDICES, &field)?;
    if let Some(&index) = corners.iter().find(|&&corner| corner as usize >= n_vertices) {
        return Err(ToyProblem::NoSuch {
            what: "vertex",
            index: index as usize,
            n: n_vertices,
        }
        .at(field));
    }
    if mode == Mode::Triangles {
        let whole = corners.len().next_multiple_of(3);
        check_count("corners of triangles", corners.len(), whole, &field)?;
    }
    let triangles = triangles(mode, &corners);
    let n_triangles = triangles.as_ref().map_or(0, Vec::len) / 3;
    check_limit("triangles", n_triangles, MAX_TRIANGLES, &field)?;
    Ok(triangles)
}

/// Reads attributes and keeps the requested vertices.
struct Gather<'a> {
    source: &'a Source<'a>,
    field: &'a str,
    n_vertices: usize,
    sources: &'a [u32],
}

impl<'a> Gather<'a> {
    fn attribute<T: Copy>(
        &self,
        name: &str,
        index: Option<Index<Accessor>>,
        read: impl Fn(&Source<'a>, &str, Index<Accessor>) -> Result<Vec<T>, Flaw>,
    ) -> Result<Option<Vec<T>>, Flaw> {
        let Some(index) = index else { return Ok(None) };
        let field = format!("{}.attributes.{name}", self.field);
        let all = read(self.source, &field, index)?;
        check_count("elements", all.len(), self.n_vertices, &field)?;
        self.picked(&all).map(Some)
    }

    fn target(&self, i: usize, target: &JsonTarget, has_normals: bool) -> Result<MorphTarget, Flaw> {
        let name = |attribute| format!("{attribute} of targets[{i}]");
        // Without normals at rest, the morphed triangles are flat as well.
        let normals = target.normals.filter(|_| has_normals);
        Ok(MorphTarget {
            positions: self.attribute(&name("POSITION"), target.positions, Source::vec3s)?,
            normals: self.attribute(&name("NORMAL"), normals, Source::vec3s)?,
        })
    }

    fn picked<T: Copy>(&self, all: &[T]) -> Result<Vec<T>, Flaw> {
        let n_values = self
            .sources
            .len()
            .saturating_mul(size_of::<T>() / size_of::<f32>());
        self.source.charge(self.field, n_values)?;
        Ok(self.sources.iter().map(|&source| all[source as usize]).collect())
    }
}

/// Colours with or without alpha.
fn read_colors(source: &Source, field: &str, index: Index<Accessor>) -> Result<Vec<Vec4>, Flaw> {
    let read = |shape| source.floats_within(field, index, shape, &COLOR);
    match get(source.root, field, index, "accessor")?.type_ {
        Checked::Valid(Type::Vec3) => {
            let colors = grouped::<3, Vec3>(&read(Type::Vec3)?);
            Ok(colors.into_iter().map(|rgb| rgb.extend(1.0)).collect())
        }
        _ => Ok(grouped(&read(Type::Vec4)?)),
    }
}

/// Clamps colours of vertices, as glTF requires.
///
/// Source: glTF 2.0 specification, 3.7.2.1 (meshes, overview).
fn clamp_colors(colors: &mut [Vec4], field: &str, warnings: &mut Vec<ToyWarning>) {
    let mut n_vertices = 0;
    for color in colors {
        let clamped = color.clamp(Vec4::splat(*FACTOR.start()), Vec4::splat(*FACTOR.end()));
        n_vertices += usize::from(clamped != *color);
        *color = clamped;
    }
    if n_vertices > 0 {
        let field = format!("{field}.attributes.COLOR_0");
        warnings.push(ToyWarning::ColorsClamped { field, n_vertices });
    }
}
