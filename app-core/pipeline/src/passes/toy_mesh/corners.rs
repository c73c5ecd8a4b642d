//! Corners to draw of a shape in a pose: all, those that face somebody, and those that a silhouette comes near.

use std::ops::Range;

use glam::{Vec2, Vec3};
use wgpu::BufferUsages;

use crate::geometry::rect::PixelRect;
use crate::geometry::silhouette::{Projection, Silhouette};
use crate::gpu::{Buffer, Gpu, Render};
use crate::passes::toy_mesh::PoseBuffers;

/// What the processor lists of a shape in a pose, for whom looks at it.
pub(super) struct Lists {
    /// Triangles that face them.
    pub(super) facing: Buffer,
    /// Those of them that meet tiles which a silhouette comes near.
    silhouette: Buffer,
    /// These tiles: two triangles a run, in pixels of the region.
    tiles: Buffer,
}

/// Most runs of tiles that a list holds.
const MAX_TILE_RUNS: usize = 1024;
/// Corners of two triangles.
const N_RUN_CORNERS: usize = 6;
/// Most corners of a shape whose silhouette is looked for: of more it would take the processor longer than it saves.
pub(super) const MAX_SILHOUETTE_CORNERS: usize = 3 << 16;

impl Lists {
    /// With room for so many corners.
    pub(super) fn new(gpu: &Gpu, n_corners: usize) -> Self {
        let indices = |label, n: usize| {
            let none = vec![0_u32; n];
            gpu.buffer(label, bytemuck::cast_slice(&none), BufferUsages::INDEX)
        };
        let no_tiles = vec![Vec3::ZERO; N_RUN_CORNERS * MAX_TILE_RUNS];
        Self {
            facing: indices("facing indices", n_corners),
            silhouette: indices("silhouette indices", n_corners.min(MAX_SILHOUETTE_CORNERS)),
            tiles: gpu.buffer(
                "silhouette tiles",
                bytemuck::cast_slice(&no_tiles),
                BufferUsages::VERTEX,
            ),
        }
    }

    /// Writes what has to be drawn once for each point.
    pub(super) fn silhouette(
        &self,
        gpu: &Gpu,
        silhouette: &Silhouette,
        origin_px: Vec2,
    ) -> Option<NearSilhouette<'_>> {
        let runs = silhouette
            .tiles
            .runs()
            .map(|run| run.map(|corner| corner + origin_px));
        let corners: Vec<Vec3> = runs
            .flat_map(|[low, high]| {
                let [left, right] = [low.x, high.x];
                let strip = [[left, low.y], [left, high.y], [right, low.y], [right, high.y]];
                [0, 1, 2, 2, 1, 3].map(|corner: usize| Vec2::from(strip[corner]).extend(0.0))
            })
            .collect();
        if corners.len() > N_RUN_CORNERS * MAX_TILE_RUNS {
            return None;
        }
        gpu.write(&self.tiles, &corners);
        gpu.write(&self.silhouette, &silhouette.corners);
        Some(NearSilhouette {
            lists: self,
            n_corners: n(&silhouette.corners),
            n_tile_corners: u32::try_from(corners.len()).unwrap_or(0),
        })
    }
}

/// What is drawn once for each point, where a silhouette comes near.
pub(crate) struct NearSilhouette<'a> {
    lists: &'a Lists,
    n_corners: u32,
    n_tile_corners: u32,
}

impl NearSilhouette<'_> {
    /// Closes the tiles to what is drawn next, or opens them again.
    pub(crate) fn draw_tiles(&self, render: &mut Render<'_>, is_closed: bool) {
        let instance = u32::from(is_closed);
        render.set_vertices(0, &self.lists.tiles);
        render.draw(0..self.n_tile_corners, instance..instance + 1);
    }

    /// Draws the triangles that meet the tiles, once for each instance.
    pub(crate) fn draw_corners(&self, render: &mut Render<'_>, pose: &PoseBuffers, instances: Range<u32>) {
        render.set_vertices(0, &pose.positions);
        render.set_indices(&self.lists.silhouette);
        render.draw_indexed(0..self.n_corners, instances);
    }
}

/// Whom triangles are to face.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Side {
    Camera,
    /// By its index.
    Light(usize),
}

impl Side {
    pub(super) fn index(self) -> usize {
        match self {
            Self::Camera => 0,
            Self::Light(index) => 1 + index,
        }
    }
}

/// Corners to draw: those of a whole shape, or of its triangles that face somebody.
pub(crate) struct Corners<'a> {
    pub(super) buffer: &'a Buffer,
    pub(super) indices: Range<u32>,
    /// Whether triangles that face away are left out, which the draw then leaves out, too.
    pub(crate) is_culled: bool,
    /// What of them has to be drawn once for each instance, the rest but once; without it all of them have.
    pub(crate) silhouette: Option<NearSilhouette<'a>>,
}

/// Where a shape's silhouette is looked for.
pub(crate) struct SilhouetteTarget<'a> {
    pub(crate) projection: &'a dyn Projection,
    /// The part of the region.
    pub(crate) part: PixelRect,
    pub(crate) saves: Saves,
}

/// What it saves to draw but once where no silhouette is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Saves {
    /// Pixels of the shape's inside, whatever its triangles.
    Pixels,
    /// Triangles alone: nothing where they are so large that most meet a silhouette, as in shapes of few, or thin open ones.
    Triangles,
}

/// Fewest corners of a closed shape of which triangles are saved: of 1,000 to 3,500 triangles, 300 to 500 pixels high, none
/// were, of 5,000 half.
const MIN_FINE_CORNERS: usize = 3 * 2000;

impl Saves {
    /// Whether it pays to look for the silhouette of a shape of so many corners to draw.
    pub(super) fn pays(self, n_corners: usize, is_closed: bool) -> bool {
        self == Self::Pixels || (is_closed && n_corners >= MIN_FINE_CORNERS)
    }
}

impl Corners<'_> {
    /// Binds them, and the positions of their pose in slot 0.
    pub(crate) fn bind(&self, render: &mut Render<'_>, pose: &PoseBuffers) {
        render.set_vertices(0, &pose.positions);
        render.set_indices(self.buffer);
    }

    /// Draws what has to be drawn once for each instance.
    pub(crate) fn draw_each(&self, render: &mut Render<'_>, pose: &PoseBuffers, instances: Range<u32>) {
        if let Some(silhouette) = &self.silhouette {
            silhouette.draw_corners(render, pose, instances);
        } else {
            self.bind(render, pose);
            self.draw(render, instances);
        }
    }

    /// Draws each triangle once for each instance.
    pub(crate) fn draw(&self, render: &mut Render<'_>, instances: Range<u32>) {
        render.draw_indexed(self.indices.clone(), instances);
    }
}

/// Of a list.
pub(super) fn n(indices: &[u32]) -> u32 {
    u32::try_from(indices.len()).unwrap_or(u32::MAX)
}
