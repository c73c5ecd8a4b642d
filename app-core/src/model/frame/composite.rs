//! `composite`: plate times new shadow, real toy and real shadow gone, the animated toy laid over it.

use glam::UVec2;
use wgpu::StoreOp;

use crate::geometry::rect::PixelRect;
use crate::geometry::tiles::Tiles;
use crate::gpu::bindings::{GROUP_DRAW, GROUP_PASS, GROUP_SCENE, Resource, Slot};
use crate::gpu::buffer::Buffer;
use crate::gpu::context::Gpu;
use crate::gpu::pipeline::{Draw, DrawSpec};
use crate::gpu::recorder::{Recorder, Render, cleared, n_pixels};
use crate::gpu::shader::{Shader, part};
use crate::gpu::shared::shared_struct;
use crate::gpu::texture::{Texture, TextureView};
use crate::model::diagnostics::outliers::{OUTLIER_ALL, OUTLIER_NONE, SHADOW_EVENNESS};
use crate::model::frame::coverage::COVERED;
use crate::model::frame::toy;
use crate::model::parts::{BETWEEN_CELLS, CELLS, MODEL};
use crate::model::plan::Plan;
use crate::model::region::Region;
use crate::model::state::grids::{GRID, Grids};
use crate::model::state::solution::{FIT, SCENE_SLOTS, Scene};
use crate::passes::finished::Picture;
use crate::passes::globals::GLOBALS;
use crate::passes::parts::{CHANNELS, FULLSCREEN, MARKS, PIXEL};
use crate::passes::present::REGION_FORMAT;
use crate::passes::toy_mesh::ToyMesh;

pub(crate) const SHADER: Shader = Shader::new(&[
    &GLOBALS,
    &FIT,
    &MODEL,
    &PIXEL,
    &GRID,
    &BETWEEN_CELLS,
    &CELLS,
    &CHANNELS,
    &COVERED,
    &FULLSCREEN,
    &MARKS,
    &part!("frame/composite", structs: [Drawing], constants: [OUTLIER_NONE, OUTLIER_ALL, SHADOW_EVENNESS]),
]);
const SLOTS: &[Slot] = &[
    Slot::uniform::<Grids>(),
    Slot::Read,
    Slot::Texture,
    Slot::Texture,
    Slot::Texture,
    Slot::Filtered,
    Slot::Texture,
    Slot::Filtered,
    Slot::Sampler,
    Slot::Texture,
    Slot::per_use::<Drawing>(),
];
/// What is read near a toy alone.
const TOY_SLOTS: &[Slot] = &[Slot::Texture; 8];
/// Pixels along each side of the tiles in which a toy is looked for.
const TILE_PX: u32 = 16;
/// Farthest that the validity and what is drawn of a toy tell of it, in pixels beyond its triangles.
const AROUND_TOY_PX: f32 = 10.0;

shared_struct! {
    /// How the receivers were drawn.
    pub(crate) struct Drawing {
        pub has_detail: u32,
    }
}

pub(crate) struct Pass {
    /// Clear of the toy in either pose.
    beside: Draw,
    /// Near it, where the toy was drawn once.
    drawn_once: Draw,
    drawn_four_times: Draw,
}

/// Visibility maps of one pose.
#[derive(Clone, Copy)]
pub(crate) struct Light<'a> {
    pub(crate) visibility: &'a TextureView,
    pub(crate) ambient: &'a TextureView,
}

pub(crate) struct Inputs<'a> {
    pub(crate) region: &'a Region,
    pub(crate) mesh: &'a ToyMesh,
    pub(crate) scene: Scene<'a>,
    pub(crate) grids: &'a Buffer,
    pub(crate) cells: &'a Buffer,
    pub(crate) frame: &'a TextureView,
    pub(crate) plate: &'a TextureView,
    pub(crate) validity: &'a TextureView,
    pub(crate) physical: Light<'a>,
    pub(crate) shown: Light<'a>,
    pub(crate) coverage: &'a TextureView,
    pub(crate) toy: &'a toy::Targets,
    pub(crate) moved_mask: &'a TextureView,
    /// Each pixel's own residual; without it the frame's own pixels serve.
    pub(crate) detail: Option<&'a TextureView>,
}

/// Of the region's size.
pub(crate) struct Targets {
    pub(crate) picture: Texture,
    /// View of its sRGB codes, not decoded.
    codes: TextureView,
}

impl Targets {
    pub(crate) fn new(gpu: &Gpu, plan: &Plan) -> Self {
        let picture = Texture::target(gpu, "composite", plan.region.size_px, REGION_FORMAT);
        Self {
            codes: picture.codes(gpu),
            picture,
        }
    }

    /// Both views of the picture.
    pub(crate) fn picture(&self) -> Picture<'_> {
        Picture {
            light: &self.picture.view,
            codes: &self.codes,
        }
    }
}

impl Pass {
    pub(crate) fn new(gpu: &Gpu) -> Self {
        let draw = |fragment, of_toy| {
            let groups = [SCENE_SLOTS, SLOTS, of_toy, &[]];
            gpu.draw(&DrawSpec::fullscreen(&SHADER, fragment, groups, &[REGION_FORMAT]))
        };
        Self {
            beside: draw("fs_beside", &[]),
            drawn_once: draw("fs_drawn_once", TOY_SLOTS),
            drawn_four_times: draw("fs_drawn_four_times", TOY_SLOTS),
        }
    }

    pub(crate) fn encode(&self, recorder: &mut Recorder<'_>, inputs: &Inputs<'_>, targets: &Targets) {
        let resources = [
            inputs.grids.into(),
            inputs.cells.into(),
            inputs.frame.into(),
            inputs.plate.into(),
            inputs.physical.visibility.into(),
            inputs.physical.ambient.into(),
            inputs.shown.visibility.into(),
            inputs.shown.ambient.into(),
            (&recorder.gpu.samplers.linear).into(),
            // A placeholder that is not read where there is none.
            inputs.detail.unwrap_or(inputs.plate).into(),
            Resource::PerUse,
        ];
        let drawing = Drawing {
            has_detail: u32::from(inputs.detail.is_some()),
        };
        let near_toy = match inputs.toy.n_draws() {
            1 => &self.drawn_once,
            _ => &self.drawn_four_times,
        };
        let groups = [
            recorder.bind(&self.beside, GROUP_SCENE, &inputs.scene.resources()),
            recorder.bind_with(&self.beside, GROUP_PASS, &drawing, &resources),
        ];
        let of_toy = recorder.bind(near_toy, GROUP_DRAW, &inputs.of_toy());
        let target = &targets.picture.view;
        let [near, beside] = inputs.parts(target.size_px());
        let mut render = recorder.render(SHADER.name, &[Some(cleared(target))], None, StoreOp::Discard);
        render.begin(&self.beside, &groups);
        beside.iter().for_each(|part| fill(&mut render, part));
        render.narrow(near.iter().map(|part| n_pixels(part.size_px)).sum());
        render.begin(near_toy, &[of_toy]);
        near.iter().for_each(|part| fill(&mut render, part));
    }
}

fn fill(render: &mut Render<'_>, part: &PixelRect) {
    render.clip((part.origin_px, part.size_px));
    render.draw(0..3, 0..1);
}

impl<'a> Inputs<'a> {
    fn of_toy(&self) -> [Resource<'a>; 8] {
        let [toy_0, toy_1, toy_2, toy_3] = self.toy.views();
        [
            self.validity.into(),
            toy_0.into(),
            toy_1.into(),
            toy_2.into(),
            toy_3.into(),
            (&self.toy.moved.view).into(),
            self.moved_mask.into(),
            self.coverage.into(),
        ]
    }

    /// Rectangles of a region of `size_px`: those near the toy in either pose, and the others.
    fn parts(&self, size_px: UVec2) -> [Vec<PixelRect>; 2] {
        let toy_box = self.region.plan.toy_box;
        let mut tiles = Tiles::over(toy_box.size_px, TILE_PX);
        if self.region.plan.is_shadow_withheld {
            // The validity then tells of shadows, too.
            tiles.mark_all();
        } else {
            let camera = self.region.uniform.by_camera();
            for pose in [&self.mesh.physical, &self.mesh.shown] {
                self.mesh.mark_seen(&mut tiles, pose, (&camera, AROUND_TOY_PX));
            }
        }
        let in_region = |is_near| {
            let rects = tiles.rects(is_near).into_iter();
            rects.map(|rect| PixelRect {
                origin_px: rect.origin_px + toy_box.origin_px,
                ..rect
            })
        };
        [
            in_region(true).collect(),
            in_region(false).chain(toy_box.around(size_px)).collect(),
        ]
    }
}
