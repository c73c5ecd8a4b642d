//! `moved_mask`: mask of the visible surface of the real toy that has moved in the shown pose.

use glam::Vec3;
use wgpu::{Face, StoreOp, TextureFormat, VertexFormat};

use crate::gpu::bindings::GROUP_SCENE;
use crate::gpu::context::Gpu;
use crate::gpu::pipeline::{Draw, DrawSpec, Stream, nearest_surface};
use crate::gpu::recorder::{Recorder, sampled};
use crate::gpu::shader::{Shader, shader};
use crate::gpu::texture::Texture;
use crate::model::plan::Plan;
use crate::model::region::Region;
use crate::passes::globals::GLOBALS_GROUP;
use crate::passes::toy_mesh::{CasterLod, SeenToy, Side, ToyMesh};

pub(crate) const SHADER: Shader = shader!("frame/moved_mask");
/// Vertices of both poses; the physical one is drawn.
const STREAMS: &[Stream] = &[(0, VertexFormat::Float32x3), (1, VertexFormat::Float32x3)];
/// Format of the mask, a fraction of each pixel.
pub(crate) const MOVED_FORMAT: TextureFormat = TextureFormat::R8Unorm;
/// Samples per pixel, so that parts thinner than a pixel count as well; if the toy is drawn with
/// one sample, so is its mask.
const N_SAMPLES: u32 = 4;

pub(crate) struct Pass {
    /// Draws with both sides of each triangle, or with the side that faces the camera.
    draws: [Draw; 2],
    /// The same with one sample.
    single: [Draw; 2],
}

/// Targets of the toy box's size: the mask, and the samples, which are never stored.
pub(crate) struct Targets {
    /// The samples; `None` if a pixel has only one.
    samples: Option<Texture>,
    depth: Texture,
    pub(crate) moved: Texture,
}

impl Targets {
    pub(crate) fn new(gpu: &Gpu, plan: &Plan) -> Self {
        let size_px = plan.toy_box.size_px;
        let n_samples = plan.n_toy_samples;
        let on_chip = |label, format| Texture::samples(gpu, label, size_px, (format, n_samples));
        Self {
            samples: (n_samples > 1).then(|| on_chip("moved_mask samples", MOVED_FORMAT)),
            depth: on_chip("moved_mask depth", TextureFormat::Depth32Float),
            moved: Texture::target(gpu, "moved_mask", size_px, MOVED_FORMAT),
        }
    }
}

impl Pass {
    pub(crate) fn new(gpu: &Gpu) -> Self {
        let groups = [GLOBALS_GROUP, &[], &[], &[]];
        let spec = |n_samples, culled| DrawSpec {
            vertex: "vs_physical",
            streams: STREAMS,
            n_samples,
            depth: Some(nearest_surface()),
            culled,
            ..DrawSpec::fullscreen(&SHADER, "fs_moved", groups, &[MOVED_FORMAT])
        };
        let draws = |n_samples| [None, Some(Face::Back)].map(|culled| gpu.draw(&spec(n_samples, culled)));
        Self {
            draws: draws(N_SAMPLES),
            single: draws(1),
        }
    }

    pub(crate) fn encode(
        &self,
        recorder: &mut Recorder<'_>,
        region: &Region,
        toy: &ToyMesh,
        targets: &Targets,
    ) {
        let camera = Vec3::from(region.uniform.camera_in_anchor).extend(1.0);
        let seen = SeenToy {
            pose: &toy.physical,
            side: Some(Side::Camera),
            points: &[camera],
            lod: CasterLod::Own,
        };
        let corners = toy.corners(recorder.gpu, &seen, None);
        let samples = targets.samples.as_ref().map(|samples| &samples.view);
        let mask = sampled(samples, &targets.moved.view);
        let draws = if samples.is_some() {
            &self.draws
        } else {
            &self.single
        };
        let draw = &draws[usize::from(corners.is_culled)];
        let group = recorder.bind(draw, GROUP_SCENE, &[(&region.globals).into()]);
        let depth = Some(&targets.depth.view);
        let mut render = recorder.render(SHADER.name, &[Some(mask)], depth, StoreOp::Discard);
        render.part_of(region.plan.part_drawn(&region.plan.toy_box));
        render.begin(draw, &[group]);
        corners.bind(&mut render, &toy.physical);
        render.set_vertices(1, &toy.shown.positions);
        corners.draw(&mut render, 0..1);
    }
}
