//! The toy on the device: what never changes, the physical pose, and the pose of the frame.

use std::ops::Range;

use glam::DVec4;
use wgpu::{BufferUsages, VertexFormat};

use crate::geometry::bounds::Sphere;
use crate::gpu::buffer::Buffer;
use crate::gpu::context::Gpu;
use crate::gpu::pipeline::{Pipeline, Stream};
use crate::gpu::recorder::{Group, Recorder, Render};
use crate::passes::materials::Materials;
use crate::toy::{Caster, PosedMesh, Toy};

/// Streams of a draw with materials: uvs, vertex colours, then positions and normals of the pose at locations 0 and 1.
pub(crate) const LOOK_STREAMS: [Stream; 4] = [
    (2, VertexFormat::Float32x2),
    (3, VertexFormat::Float32x4),
    (0, VertexFormat::Float32x3),
    (1, VertexFormat::Float32x3),
];

/// Positions and normals of a pose, in anchor space.
pub(crate) struct PoseBuffers {
    pub(crate) positions: Buffer,
    pub(crate) normals: Buffer,
    /// Holds all positions.
    pub(crate) around: Sphere,
}

impl PoseBuffers {
    fn new(gpu: &Gpu, mesh: &PosedMesh) -> Self {
        Self {
            positions: gpu.buffer(
                "positions",
                bytemuck::cast_slice(&mesh.positions),
                BufferUsages::VERTEX,
            ),
            normals: gpu.buffer(
                "normals",
                bytemuck::cast_slice(&mesh.normals),
                BufferUsages::VERTEX,
            ),
            around: Sphere::around(&mesh.positions),
        }
    }

    /// Replaces the pose by another of the same toy.
    pub(crate) fn write(&mut self, gpu: &Gpu, mesh: &PosedMesh) {
        self.around = Sphere::around(&mesh.positions);
        gpu.write(&self.positions, &mesh.positions);
        gpu.write(&self.normals, &mesh.normals);
    }
}

/// A run of indices with one material.
struct Run {
    indices: Range<u32>,
    /// Index of the material, which the shaders take from the instance.
    material: u32,
    /// Index of its look.
    look: usize,
}

/// Which of the shapes near the toy's casts a shadow.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Detail {
    /// The toy's own.
    Own,
    /// The coarsest that is as near, in units of the toy's file.
    Within(f64),
    /// The finest of as many triangles, or the coarsest.
    AtMost(u32),
}

/// Corners of a shape near the toy's.
struct CasterRange {
    /// How far it is from the toy's, in units of its file.
    error: f64,
    indices: Range<u32>,
}

impl CasterRange {
    fn n_triangles(&self) -> u32 {
        (self.indices.end - self.indices.start) / 3
    }
}

/// The toy's buffers.
pub(crate) struct ToyMesh {
    indices: Buffer,
    shadow_indices: Buffer,
    /// Within them, ever coarser; at least the first, which is the toy's own shape.
    casters: Vec<CasterRange>,
    /// Whether it is made of closed pieces alone.
    is_closed: bool,
    uvs: Buffer,
    colors: Buffer,
    runs: Vec<Run>,
    materials: Materials,
    /// The pose the real toy was made in.
    pub(crate) physical: PoseBuffers,
    /// The pose to be shown.
    pub(crate) shown: PoseBuffers,
}

impl ToyMesh {
    /// `simplified` are shapes that may cast shadows in place of the toy's.
    pub(crate) fn new(gpu: &Gpu, toy: &Toy, physical: &PosedMesh, simplified: &[Caster]) -> Self {
        let materials = Materials::new(gpu, toy);
        let (casters, shadow_indices) = casters(toy, simplified);
        Self {
            indices: gpu.buffer(
                "indices",
                bytemuck::cast_slice(toy.indices()),
                BufferUsages::INDEX,
            ),
            shadow_indices: gpu.buffer(
                "shadow indices",
                bytemuck::cast_slice(&shadow_indices),
                BufferUsages::INDEX,
            ),
            casters,
            is_closed: toy.shadow_indices().is_closed(),
            uvs: gpu.buffer("uvs", bytemuck::cast_slice(toy.uvs()), BufferUsages::VERTEX),
            colors: gpu.buffer(
                "colors",
                bytemuck::cast_slice(toy.colors_linear().unwrap_or(&vec![[1.0; 4]; toy.n_vertices()])),
                BufferUsages::VERTEX,
            ),
            runs: runs(toy, &materials),
            materials,
            physical: PoseBuffers::new(gpu, physical),
            shown: PoseBuffers::new(gpu, physical),
        }
    }

    pub(crate) fn n_materials(&self) -> usize {
        self.materials.n()
    }

    /// Group `GROUP_DRAW` of a pipeline, one a look.
    pub(crate) fn bind_materials<T>(&self, recorder: &Recorder<'_>, pipeline: &Pipeline<T>) -> Vec<Group> {
        self.materials.bind(recorder, pipeline)
    }

    /// Whether triangles that face away from points, homogeneous and in anchor space, hide nothing from them that others do
    /// not.
    pub(crate) fn is_culled(&self, pose: &PoseBuffers, mut points: impl Iterator<Item = DVec4>) -> bool {
        self.is_closed && !points.any(|point| pose.around.holds(point))
    }

    /// Draws the whole mesh as these instances, without materials; positions are in slot 0.
    pub(crate) fn draw_positions(&self, render: &mut Render<'_>, positions: &Buffer, instances: Range<u32>) {
        self.bind_positions(render, positions);
        self.draw_caster(render, instances, Detail::Own);
    }

    /// Binds what [`ToyMesh::draw_caster`] draws; positions are in slot 0.
    pub(crate) fn bind_positions(&self, render: &mut Render<'_>, positions: &Buffer) {
        render.set_vertices(0, positions);
        render.set_indices(&self.shadow_indices);
    }

    /// Draws each triangle of a shape once for each instance.
    pub(crate) fn draw_caster(&self, render: &mut Render<'_>, instances: Range<u32>, detail: Detail) {
        let mut casters = self.casters.iter();
        let caster = match detail {
            Detail::Own => casters.next(),
            Detail::Within(error) => casters.take_while(|caster| caster.error <= error).last(),
            Detail::AtMost(n) => casters
                .find(|caster| caster.n_triangles() <= n)
                .or(self.casters.last()),
        };
        if let Some(caster) = caster {
            render.draw_indexed(caster.indices.clone(), instances);
        }
    }

    /// Draws every part with its material; `streams` are the poses, from slot 2 on.
    pub(crate) fn draw_parts(&self, render: &mut Render<'_>, streams: &[&PoseBuffers], looks: &[Group]) {
        render.set_vertices(0, &self.uvs);
        render.set_vertices(1, &self.colors);
        for (slot, pose) in (2..).step_by(2).zip(streams) {
            render.set_vertices(slot, &pose.positions);
            render.set_vertices(slot + 1, &pose.normals);
        }
        render.set_indices(&self.indices);
        let mut current = None;
        for run in &self.runs {
            if current != Some(run.look)
                && let Some(look) = looks.get(run.look)
            {
                render.set(look);
                current = Some(run.look);
            }
            render.draw_indexed(run.indices.clone(), run.material..run.material + 1);
        }
    }
}

/// The toy's own shape and those near it, one after the other, and their corners.
fn casters(toy: &Toy, simplified: &[Caster]) -> (Vec<CasterRange>, Vec<u32>) {
    let mut all = toy.shadow_indices().indices.clone();
    let n = |indices: &[u32]| u32::try_from(indices.len()).unwrap_or(u32::MAX);
    let mut ranges = vec![CasterRange {
        error: 0.0,
        indices: 0..n(&all),
    }];
    for caster in simplified {
        let first = n(&all);
        all.extend(&caster.indices);
        ranges.push(CasterRange {
            error: caster.error,
            indices: first..n(&all),
        });
    }
    (ranges, all)
}

/// The draws of a toy, those with the same material as one where they follow one another.
fn runs(toy: &Toy, materials: &Materials) -> Vec<Run> {
    let mut runs: Vec<Run> = Vec::new();
    for part in toy.parts() {
        let indices = part.indices.clone();
        // Materials are counted when they are read.
        let material = u32::try_from(part.material).unwrap_or(u32::MAX);
        match (runs.last_mut(), materials.look(part.material)) {
            (Some(last), _) if last.material == material && last.indices.end == indices.start => {
                last.indices.end = indices.end;
            }
            (_, Some(look)) => runs.push(Run {
                indices,
                material,
                look,
            }),
            (_, None) => {}
        }
    }
    runs
}
