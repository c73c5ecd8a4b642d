//! The toy on the device: its constant data, the physical pose, and the pose of the frame.

mod corners;
mod runs;

use std::ops::Range;
use std::sync::OnceLock;

use glam::{UVec2, Vec4};
use wgpu::{BufferUsages, VertexFormat};

use crate::geometry::rect::PixelRect;
use crate::geometry::seen::{mark_seen, seen_rect};
use crate::geometry::silhouette::{Projection, Shape, Viewers, find_silhouette};
use crate::geometry::tiles::Tiles;
use crate::gpu::{Buffer, Gpu, Group, Pipeline, Recorder, Render, Stream};
use crate::passes::materials::Materials;
pub(crate) use crate::passes::toy_mesh::corners::{Corners, Savings, Side, SilhouetteTarget};
use crate::passes::toy_mesh::corners::{Lists, MAX_SILHOUETTE_CORNERS, n};
pub(crate) use crate::passes::toy_mesh::runs::Sided;
use crate::passes::toy_mesh::runs::{Run, runs};
use app_scene::geometry::bounds::Sphere;
use app_scene::geometry::edges::{Edge, edges};
use app_scene::scene::MAX_LIGHTS;
use app_scene::toy::{Caster, PosedMesh, Toy};

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
    /// A ball that contains all positions.
    pub(crate) around: Sphere,
    /// The pose on the processor.
    mesh: PosedMesh,
    /// Lists for the camera and for each light.
    lists: Vec<Lists>,
}

impl PoseBuffers {
    /// The pixels of a target of `size_px` in which the toy may be visible.
    pub(crate) fn seen_rect(&self, projection: &dyn Projection, size_px: UVec2) -> Option<PixelRect> {
        seen_rect(&self.mesh.positions, projection, size_px)
    }

    /// Buffers with lists for these numbers of corners.
    fn new(gpu: &Gpu, mesh: &PosedMesh, lists: impl Iterator<Item = usize>) -> Self {
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
            mesh: mesh.clone(),
            lists: lists.map(|n_corners| Lists::new(gpu, n_corners)).collect(),
        }
    }

    /// Whether the buffers hold this pose.
    pub(crate) fn is(&self, mesh: &PosedMesh) -> bool {
        self.mesh == *mesh
    }

    /// Replaces the pose by another of the same toy.
    pub(crate) fn write(&mut self, gpu: &Gpu, mesh: &PosedMesh) {
        self.around = Sphere::around(&mesh.positions);
        self.mesh.clone_from(mesh);
        gpu.write(&self.positions, &mesh.positions);
        gpu.write(&self.normals, &mesh.normals);
        self.forget_lists();
    }

    /// Has the lists made anew.
    fn forget_lists(&self) {
        self.lists.iter().for_each(Lists::forget);
    }
}

/// Level of detail of the shadow caster.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CasterLod {
    /// The toy's own.
    Own,
    /// The coarsest shape within this distance, in units of the toy's file.
    Within(f64),
    /// The finest shape with at most this number of triangles, or the coarsest.
    AtMost(u32),
}

/// Corners of a shape similar to the toy's.
struct CasterRange {
    /// Distance from the toy's shape, in units of its file.
    error: f64,
    indices: Range<u32>,
    /// Number of corners of closed pieces, which come first.
    n_closed: usize,
    /// Edges, computed at their first use.
    edges: OnceLock<Vec<Edge>>,
}

impl CasterRange {
    fn n_triangles(&self) -> u32 {
        (self.indices.end - self.indices.start) / 3
    }
}

/// The way in which a method draws the toy's shadows.
pub(crate) struct Casting<'a> {
    /// Shapes that may cast shadows instead of the toy's own.
    pub(crate) simplified: &'a [Caster],
    /// Whether triangles that face away are left out.
    pub(crate) is_culled: bool,
}

/// The toy in a pose, with the viewpoints from which it is drawn.
#[derive(Clone, Copy)]
pub(crate) struct SeenToy<'a> {
    pub(crate) pose: &'a PoseBuffers,
    /// The viewpoints' list in the pose.
    pub(crate) side: Option<Side>,
    /// Viewpoints, homogeneous, in anchor space.
    pub(crate) points: &'a [Vec4],
    pub(crate) lod: CasterLod,
}

/// The toy's buffers.
pub(crate) struct ToyMesh {
    indices: Buffer,
    shadow_indices: Buffer,
    /// Corners of the shadow casters, on the processor.
    shadow_corners: Vec<u32>,
    /// Ranges of these corners, of ever coarser shapes; the first is the toy's own shape.
    casters: Vec<CasterRange>,
    /// Whether the toy consists of closed pieces alone.
    is_closed: bool,
    uvs: Buffer,
    colors: Buffer,
    runs: Vec<Run>,
    materials: Materials,
    /// The pose of the real toy.
    pub(crate) physical: PoseBuffers,
    /// The pose to be shown.
    pub(crate) shown: PoseBuffers,
}

impl ToyMesh {
    pub(crate) fn new(gpu: &Gpu, toy: &Toy, physical: &PosedMesh, casting: &Casting<'_>) -> Self {
        let materials = Materials::new(gpu, toy);
        let (casters, shadow_indices) = casters(toy, casting.simplified);
        let shape = toy.shadow_indices();
        let (runs, indices) = runs(toy, &materials);
        // Triangles are left out of closed pieces alone, and for the shadows of other pieces a
        // silhouette is not worth its cost; the toy's own shape has the most triangles.
        let n_lists = match casting.is_culled {
            true if shape.n_closed > 0 => 1 + MAX_LIGHTS,
            true if shape.indices.len() <= MAX_SILHOUETTE_CORNERS => 1,
            _ => 0,
        };
        let lists = std::iter::repeat_n(shape.indices.len(), n_lists);
        Self {
            indices: gpu.buffer("indices", bytemuck::cast_slice(&indices), BufferUsages::INDEX),
            shadow_indices: gpu.buffer(
                "shadow indices",
                bytemuck::cast_slice(&shadow_indices),
                BufferUsages::INDEX,
            ),
            shadow_corners: shadow_indices,
            casters,
            is_closed: shape.is_closed(),
            uvs: gpu.buffer("uvs", bytemuck::cast_slice(toy.uvs()), BufferUsages::VERTEX),
            colors: gpu.buffer(
                "colors",
                bytemuck::cast_slice(toy.colors_linear().unwrap_or(&vec![[1.0; 4]; toy.n_vertices()])),
                BufferUsages::VERTEX,
            ),
            runs,
            materials,
            physical: PoseBuffers::new(gpu, physical, lists.clone()),
            shown: PoseBuffers::new(gpu, physical, lists),
        }
    }

    pub(crate) fn n_materials(&self) -> usize {
        self.materials.n()
    }

    /// Group `GROUP_DRAW` of a pipeline, one per look.
    pub(crate) fn bind_materials<T>(&self, recorder: &Recorder<'_>, pipeline: &Pipeline<T>) -> Vec<Group> {
        self.materials.bind(recorder, pipeline)
    }

    /// The corners of a shape that must be drawn for viewpoints. In closed pieces, and from
    /// outside, the triangles that face away from all viewpoints hide nothing that others do not
    /// hide: they are left out if the pose has a list for the viewpoints. In that case the
    /// silhouette is determined as well, if requested.
    pub(crate) fn corners<'a>(
        &'a self,
        gpu: &Gpu,
        seen: &SeenToy<'a>,
        target: Option<SilhouetteTarget<'_>>,
    ) -> Corners<'a> {
        let SeenToy {
            pose,
            side,
            points,
            lod,
        } = *seen;
        let is_inside = points.iter().any(|point| pose.around.holds(point.as_dvec4()));
        let is_culled = self.is_closed && !is_inside;
        let viewers = Viewers::around(points).filter(|_| !is_inside);
        let listed = viewers.zip(side.and_then(|side| pose.lists.get(side.index())));
        let Some((viewers, lists)) = listed else {
            return Corners {
                is_culled,
                ..self.shape(lod)
            };
        };
        // A silhouette is searched among the corners.
        if target.is_none()
            && let Some(n_facing) = lists.n_facing(lod, points)
        {
            return Corners {
                buffer: &lists.facing,
                indices: 0..n_facing,
                is_culled,
                silhouette: None,
            };
        }
        let (closed, open) = self.split_caster(lod);
        let mut facing = viewers.facing(&pose.mesh.positions, closed);
        facing.extend(open);
        lists.write_facing(gpu, (lod, points), &facing);
        let worth_it = target.filter(|target| target.savings.is_worthwhile(facing.len(), self.is_closed));
        let silhouette = worth_it.and_then(|target| {
            let shape = self.small_shape(pose, lod)?;
            let silhouette =
                find_silhouette(shape, &viewers, target.projection, &facing, target.part.size_px)?;
            lists.silhouette(gpu, &silhouette, target.part.origin_px.as_vec2())
        });
        Corners {
            buffer: &lists.facing,
            indices: 0..n(&facing),
            is_culled,
            silhouette,
        }
    }

    /// Has all lists made anew, after work that reached no device.
    pub(crate) fn forget_lists(&self) {
        self.physical.forget_lists();
        self.shown.forget_lists();
    }

    /// Marks the tiles of a target within `reach_px` of the places where a posed shape may be
    /// visible.
    pub(crate) fn mark_seen(
        &self,
        tiles: &mut Tiles,
        pose: &PoseBuffers,
        lod: CasterLod,
        projection: &dyn Projection,
        reach_px: f32,
    ) {
        let (closed, open) = self.split_caster(lod);
        for corners in [closed, open] {
            mark_seen(tiles, &pose.mesh.positions, corners, projection, reach_px);
        }
    }

    /// A posed shape, if it is small enough for the search for its silhouette.
    fn small_shape<'a>(&'a self, pose: &'a PoseBuffers, lod: CasterLod) -> Option<Shape<'a>> {
        let caster = self.caster(lod)?;
        let [start, end] = [caster.indices.start, caster.indices.end].map(|index| index as usize);
        let corners = self.shadow_corners.get(start..end)?;
        (corners.len() <= MAX_SILHOUETTE_CORNERS).then(|| Shape {
            positions: &pose.mesh.positions,
            corners,
            edges: caster.edges.get_or_init(|| edges(corners.as_chunks().0)),
        })
    }

    /// Corners of a whole shape.
    pub(crate) fn shape(&self, lod: CasterLod) -> Corners<'_> {
        Corners {
            buffer: &self.shadow_indices,
            indices: self.corners_of(lod),
            is_culled: false,
            silhouette: None,
        }
    }

    /// Draws the whole mesh as these instances, without materials; positions are in slot 0.
    pub(crate) fn draw_positions(&self, render: &mut Render<'_>, positions: &Buffer, instances: Range<u32>) {
        render.set_vertices(0, positions);
        render.set_indices(&self.shadow_indices);
        render.draw_indexed(self.corners_of(CasterLod::Own), instances);
    }

    /// Corners of a shape: those of closed pieces, and those of open ones.
    fn split_caster(&self, lod: CasterLod) -> (&[u32], &[u32]) {
        let corners = self.caster(lod).and_then(|caster| {
            let [start, end] = [caster.indices.start, caster.indices.end].map(|index| index as usize);
            self.shadow_corners
                .get(start..end)?
                .split_at_checked(caster.n_closed)
        });
        corners.unwrap_or_default()
    }

    /// Corners of the shape of a level of detail, as a range of all corners.
    fn corners_of(&self, lod: CasterLod) -> Range<u32> {
        self.caster(lod).map_or(0..0, |caster| caster.indices.clone())
    }

    fn caster(&self, lod: CasterLod) -> Option<&CasterRange> {
        let mut casters = self.casters.iter();
        match lod {
            CasterLod::Own => casters.next(),
            CasterLod::Within(error) => casters.take_while(|caster| caster.error <= error).last(),
            CasterLod::AtMost(n) => casters
                .find(|caster| caster.n_triangles() <= n)
                .or(self.casters.last()),
        }
    }

    /// Draws every part with its material; `streams` are the poses, from slot 2 on, the first of
    /// which is visible.
    ///
    /// In closed pieces, and from outside, only the side that faces the camera is drawn.
    pub(crate) fn draw_parts(
        &self,
        render: &mut Render<'_>,
        sided: &Sided<'_>,
        streams: &[&PoseBuffers],
        looks: &[Group],
    ) {
        let camera = sided.camera_in_anchor.extend(1.0).as_dvec4();
        let is_inside = streams.first().is_some_and(|pose| pose.around.holds(camera));
        let closed = if is_inside { sided.both } else { sided.culled };
        // Slots persist over a change to a pipeline of the same layout.
        render.begin(closed, sided.groups);
        self.set_streams(render, streams);
        self.draw_runs(render, looks, |run| &run.closed);
        if self.runs.iter().any(|run| !run.open.is_empty()) {
            render.begin(sided.both, &[]);
            self.draw_runs(render, looks, |run| &run.open);
        }
    }

    fn set_streams(&self, render: &mut Render<'_>, streams: &[&PoseBuffers]) {
        render.set_vertices(0, &self.uvs);
        render.set_vertices(1, &self.colors);
        for (slot, pose) in (2..).step_by(2).zip(streams) {
            render.set_vertices(slot, &pose.positions);
            render.set_vertices(slot + 1, &pose.normals);
        }
        render.set_indices(&self.indices);
    }

    /// Draws a part of each run.
    fn draw_runs(&self, render: &mut Render<'_>, looks: &[Group], part: impl Fn(&Run) -> &Range<u32>) {
        let mut current = None;
        for run in self.runs.iter().filter(|run| !part(run).is_empty()) {
            if current != Some(run.look)
                && let Some(look) = looks.get(run.look)
            {
                render.set(look);
                current = Some(run.look);
            }
            render.draw_indexed(part(run).clone(), run.material..run.material + 1);
        }
    }
}

/// The ranges of the toy's own shape and its simplified ones, in sequence, and their corners.
fn casters(toy: &Toy, simplified: &[Caster]) -> (Vec<CasterRange>, Vec<u32>) {
    let mut all = toy.shadow_indices().indices.clone();
    let mut ranges = vec![CasterRange {
        error: 0.0,
        indices: 0..n(&all),
        n_closed: toy.shadow_indices().n_closed,
        edges: OnceLock::new(),
    }];
    for caster in simplified {
        let first = n(&all);
        all.extend(&caster.indices);
        ranges.push(CasterRange {
            error: caster.error,
            indices: first..n(&all),
            n_closed: caster.n_closed,
            edges: OnceLock::new(),
        });
    }
    (ranges, all)
}
