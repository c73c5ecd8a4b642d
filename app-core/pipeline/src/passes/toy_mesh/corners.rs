//! The corners of a posed shape that are drawn: all, those that face a viewer, or those near a
//! silhouette.

use std::ops::Range;
use std::sync::{Mutex, MutexGuard, PoisonError};

use glam::{Vec2, Vec3, Vec4};
use wgpu::BufferUsages;

use crate::geometry::rect::PixelRect;
use crate::geometry::silhouette::{Projection, Silhouette};
use crate::gpu::{Buffer, Gpu, Render};
use crate::passes::toy_mesh::{CasterLod, PoseBuffers};

/// The lists that the processor makes of a posed shape for a set of viewers.
pub(super) struct Lists {
    /// Triangles that face the viewers.
    pub(super) facing: Buffer,
    /// What these were found for.
    found: Mutex<Option<Facing>>,
    /// Triangles that meet tiles near a silhouette.
    silhouette: Buffer,
    /// These tiles: two triangles per run, in pixels of the region.
    tiles: Buffer,
}

/// A shape and viewpoints, and the number of corners that face one of them.
struct Facing {
    lod: CasterLod,
    points: Vec<Vec4>,
    n_corners: u32,
}

/// Maximum number of runs of tiles in a list.
const MAX_TILE_RUNS: usize = 1024;
/// Number of corners of two triangles.
const N_RUN_CORNERS: usize = 6;
/// Maximum number of corners of a shape whose silhouette is searched: for larger shapes the search
/// takes more time than it saves.
pub(super) const MAX_SILHOUETTE_CORNERS: usize = 3 << 16;

impl Lists {
    /// Lists for at most this number of corners.
    pub(super) fn new(gpu: &Gpu, n_corners: usize) -> Self {
        let indices = |label, n: usize| {
            let none = vec![0_u32; n];
            gpu.buffer(label, bytemuck::cast_slice(&none), BufferUsages::INDEX)
        };
        let no_tiles = vec![Vec3::ZERO; N_RUN_CORNERS * MAX_TILE_RUNS];
        Self {
            facing: indices("facing indices", n_corners),
            found: Mutex::new(None),
            silhouette: indices("silhouette indices", n_corners.min(MAX_SILHOUETTE_CORNERS)),
            tiles: gpu.buffer(
                "silhouette tiles",
                bytemuck::cast_slice(&no_tiles),
                BufferUsages::VERTEX,
            ),
        }
    }

    /// Number of corners in `facing`, if they were found for this shape and these viewpoints.
    pub(super) fn n_facing(&self, lod: CasterLod, points: &[Vec4]) -> Option<u32> {
        let found = self.found();
        let same = found
            .as_ref()
            .filter(|found| found.lod == lod && found.points == points);
        same.map(|found| found.n_corners)
    }

    /// Writes the corners that face viewpoints.
    pub(super) fn write_facing(&self, gpu: &Gpu, (lod, points): (CasterLod, &[Vec4]), facing: &[u32]) {
        gpu.write(&self.facing, facing);
        *self.found() = Some(Facing {
            lod,
            points: points.to_vec(),
            n_corners: n(facing),
        });
    }

    /// Has the corners found anew, for another pose.
    pub(super) fn forget(&self) {
        *self.found() = None;
    }

    fn found(&self) -> MutexGuard<'_, Option<Facing>> {
        self.found.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Writes the triangles that must be drawn once per viewpoint.
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

/// The triangles that are drawn once per viewpoint near a silhouette.
pub(crate) struct NearSilhouette<'a> {
    lists: &'a Lists,
    n_corners: u32,
    n_tile_corners: u32,
}

impl NearSilhouette<'_> {
    /// Excludes the tiles from the next draws, or admits them again.
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

/// The viewers that triangles must face.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Side {
    Camera,
    /// A light, by its index.
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

/// Corners to draw: those of a whole shape, or of its triangles that face a viewer.
pub(crate) struct Corners<'a> {
    pub(super) buffer: &'a Buffer,
    pub(super) indices: Range<u32>,
    /// Whether triangles that face away are left out; the draw then culls them, too.
    pub(crate) is_culled: bool,
    /// The part that must be drawn once per instance, while the rest is drawn once; without it
    /// everything is drawn once per instance.
    pub(crate) silhouette: Option<NearSilhouette<'a>>,
}

/// The target in which a shape's silhouette is searched.
pub(crate) struct SilhouetteTarget<'a> {
    pub(crate) projection: &'a dyn Projection,
    /// The part of the region.
    pub(crate) part: PixelRect,
    pub(crate) savings: Savings,
}

/// The savings from drawing only once far from silhouettes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Savings {
    /// Pixels inside the shape, whatever its triangles.
    Pixels,
    /// Triangles alone: there are no savings if the triangles are so large that most of them meet a
    /// silhouette, as in shapes of few triangles, or in thin open ones.
    Triangles,
}

/// Minimum number of corners of a closed shape for savings in triangles: with 1,000 to 3,500
/// triangles, 300 to 500 pixels high, there were none, with 5,000 half were saved.
const MIN_FINE_CORNERS: usize = 3 * 2000;

impl Savings {
    /// Whether the search for the silhouette is worth its cost for this number of corners.
    pub(super) fn is_worthwhile(self, n_corners: usize, is_closed: bool) -> bool {
        self == Self::Pixels || (is_closed && n_corners >= MIN_FINE_CORNERS)
    }
}

impl Corners<'_> {
    /// Binds the corners, and the positions of their pose in slot 0.
    pub(crate) fn bind(&self, render: &mut Render<'_>, pose: &PoseBuffers) {
        render.set_vertices(0, &pose.positions);
        render.set_indices(self.buffer);
    }

    /// Draws the part that must be drawn once per instance.
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

/// Number of indices of a list.
pub(super) fn n(indices: &[u32]) -> u32 {
    u32::try_from(indices.len()).unwrap_or(u32::MAX)
}
