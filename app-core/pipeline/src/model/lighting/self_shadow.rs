//! `self_shadow`: depth maps of the posed toy from points of each light, as tiles of one atlas.

use glam::{UVec2, Vec4};
use wgpu::{StoreOp, TextureFormat, VertexFormat};

use crate::geometry::shadow_atlas::ShadowAtlas;
use crate::gpu::bindings::{Resource, Slot};
use crate::gpu::buffer::Buffer;
use crate::gpu::context::Gpu;
use crate::gpu::pipeline::{Draw, DrawSpec, Stream, nearest_surface};
use crate::gpu::recorder::Recorder;
use crate::gpu::shader::{Mirrors, Shader, mirrors, shader};
use crate::gpu::shared::shared_struct;
use crate::gpu::texture::Texture;
use crate::model::plan::Plan;
use crate::passes::toy_mesh::{CasterLod, PoseBuffers, ToyMesh};
use app_scene::geometry::bounds::Sphere;
use app_scene::scene::MAX_LIGHTS;

/// Declarations of the maps for passes that read them.
pub(crate) const SELF_SHADOW_MAPS: Mirrors =
    mirrors!("common/self_shadow", structs: [SelfShadow], constants: [MAX_TILES]);
pub(crate) const SHADER: Shader = shader!("lighting/self_shadow");
/// Group of the maps, in this pass and in the passes that read them.
pub(crate) const GROUP_SELF_SHADOW: usize = 3;
/// Slots of the group in passes that read the maps.
pub(crate) const SELF_SHADOW_GROUP: &[Slot] = &[
    Slot::uniform::<SelfShadow>(),
    Slot::ShadowMap,
    Slot::Comparison,
    Slot::uniform::<SelfShadow>(),
    Slot::ShadowMap,
];
/// Slots of the group in the pass that draws the maps.
const TILES_GROUP: &[Slot] = &[Slot::uniform::<SelfShadow>()];
const STREAMS: &[Stream] = &[(0, VertexFormat::Float32x3)];
/// Maximum number of depth maps of the toy from the lights.
pub(crate) const MAX_TILES: usize = 64;

shared_struct! {
    /// The tiles of the atlas.
    pub(crate) struct SelfShadow {
        pub atlas_from_anchor: [[[f32; 4]; 4]; MAX_TILES],
        pub first_tile: [u32; MAX_LIGHTS],
        pub n_tiles: [u32; MAX_LIGHTS],
        pub texel_m: [f32; MAX_LIGHTS],
    }
}

impl SelfShadow {
    /// The tiles over a toy within `toy`. `light_points` are the points of each light, in anchor
    /// space.
    #[must_use]
    pub(crate) fn new(atlas: &ShadowAtlas, light_points: &[&[Vec4]], toy: &Sphere) -> Self {
        let mut uniform: Self = bytemuck::Zeroable::zeroed();
        let tiles = atlas.tiles(light_points, toy);
        for (slot, tile) in uniform.atlas_from_anchor.iter_mut().zip(&tiles) {
            *slot = tile.atlas_from_anchor.as_mat4().to_cols_array_2d();
            uniform.n_tiles[tile.light] += 1;
            #[allow(clippy::cast_possible_truncation, reason = "a width in metres")]
            let texel_m = tile.texel_m as f32;
            uniform.texel_m[tile.light] = uniform.texel_m[tile.light].max(texel_m);
        }
        for light in 1..MAX_LIGHTS {
            uniform.first_tile[light] = uniform.first_tile[light - 1] + uniform.n_tiles[light - 1];
        }
        uniform
    }
}

/// The depth maps of one pose.
pub(crate) struct Targets {
    tiles: Buffer,
    depth: Texture,
}

impl Targets {
    pub(crate) fn new(gpu: &Gpu, plan: &Plan) -> Self {
        let atlas = &plan.self_shadow;
        let none: SelfShadow = bytemuck::Zeroable::zeroed();
        let size_px = UVec2::splat(atlas.n_columns * atlas.tile_px);
        Self {
            tiles: gpu.uniform("self shadow tiles", &none),
            depth: Texture::target(gpu, "self shadow", size_px, TextureFormat::Depth32Float),
        }
    }

    /// Resources of [`SELF_SHADOW_GROUP`]: the maps of a pose, then those of the physical one.
    pub(crate) fn resources<'a>(&'a self, gpu: &'a Gpu, physical: &'a Self) -> [Resource<'a>; 5] {
        [
            (&self.tiles).into(),
            (&self.depth.view).into(),
            (&gpu.samplers.nearer).into(),
            (&physical.tiles).into(),
            (&physical.depth.view).into(),
        ]
    }
}

pub(crate) struct Pass {
    draw: Draw,
}

/// A posed toy, and the lights' points around it.
pub(crate) struct Inputs<'a> {
    pub(crate) toy: &'a ToyMesh,
    pub(crate) pose: &'a PoseBuffers,
    /// The points of each light, in anchor space.
    pub(crate) light_points: &'a [&'a [Vec4]],
    pub(crate) atlas: &'a ShadowAtlas,
    /// The shape that casts the shadow.
    pub(crate) caster: CasterLod,
}

impl Pass {
    pub(crate) fn new(gpu: &Gpu) -> Self {
        let groups = [&[][..], &[], &[], TILES_GROUP];
        Self {
            draw: gpu.draw(&DrawSpec {
                vertex: "vs_light",
                streams: STREAMS,
                depth: Some(nearest_surface()),
                ..DrawSpec::fullscreen(&SHADER, "fs_depth", groups, &[])
            }),
        }
    }

    pub(crate) fn encode(&self, recorder: &mut Recorder<'_>, inputs: &Inputs<'_>, targets: &Targets) {
        let tiles = SelfShadow::new(inputs.atlas, inputs.light_points, &inputs.pose.around);
        recorder.gpu.write(&targets.tiles, &[tiles]);
        let group = recorder.bind(&self.draw, GROUP_SELF_SHADOW, &[(&targets.tiles).into()]);
        let mut render = recorder.render(SHADER.name, &[], Some(&targets.depth.view), StoreOp::Store);
        render.begin(&self.draw, &[group]);
        let n_tiles = tiles.n_tiles.iter().sum();
        let corners = inputs.toy.shape(inputs.caster);
        corners.bind(&mut render, inputs.pose);
        corners.draw(&mut render, 0..n_tiles);
    }
}
