//! `retarget`: the baseline's picture: the plate in the masks, the new shadow over it, and the toy
//! by projective texturing.

use wgpu::{CompareFunction, DepthStencilState, StoreOp, TextureFormat, VertexFormat};

use crate::baseline::plan::BaselinePlan;
use crate::baseline::uniform::{SCENE_SLOTS, Scene};
use crate::gpu::{
    Draw, DrawSpec, GROUP_PASS, GROUP_SCENE, Gpu, Recorder, Shader, Slot, Stream, Texture, TextureView,
    nearest_surface, resolved, shader,
};
use crate::passes::pictures::Picture;
use crate::passes::present::REGION_FORMAT;
use crate::passes::toy_mesh::ToyMesh;

pub(crate) const SHADER: Shader = shader!("baseline/retarget");
const SLOTS: &[Slot] = &[
    Slot::Filtered,
    Slot::Texture,
    Slot::Texture,
    Slot::Texture,
    Slot::Layers,
    Slot::Sampler,
    Slot::WholeNumbers,
];
/// Vertices of the shown pose, which is drawn, and of the physical one.
const STREAMS: &[Stream] = &[(0, VertexFormat::Float32x3), (1, VertexFormat::Float32x3)];
/// Samples per pixel at the toy's silhouette.
const N_SAMPLES: u32 = 4;

pub(crate) struct Pass {
    receiver: Draw,
    toy: Draw,
}

pub(crate) struct Inputs<'a> {
    pub(crate) scene: Scene<'a>,
    pub(crate) toy: &'a ToyMesh,
    pub(crate) frame: &'a TextureView,
    pub(crate) plate: &'a TextureView,
    pub(crate) mask: &'a TextureView,
    pub(crate) labels: &'a TextureView,
    pub(crate) visibility: &'a TextureView,
    pub(crate) terms: &'a TextureView,
}

/// Targets of the region's size: two multisampled ones that are never stored, and the picture.
pub(crate) struct Targets {
    samples: Texture,
    depth: Texture,
    pub(crate) picture: Texture,
    /// View of the picture's sRGB codes, which does not decode them.
    codes: TextureView,
}

impl Targets {
    pub(crate) fn new(gpu: &Gpu, plan: &BaselinePlan) -> Self {
        let size_px = plan.region.size_px;
        let samples = |label, format| Texture::samples(gpu, label, size_px, (format, N_SAMPLES));
        let picture = Texture::target(gpu, "retarget", size_px, REGION_FORMAT);
        Self {
            samples: samples("retarget samples", REGION_FORMAT),
            depth: samples("retarget depth", TextureFormat::Depth32Float),
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
        let groups = [SCENE_SLOTS, SLOTS, &[], &[]];
        let draw = |fragment, depth| DrawSpec {
            n_samples: N_SAMPLES,
            depth: Some(depth),
            ..DrawSpec::fullscreen(&SHADER, fragment, groups, &[REGION_FORMAT])
        };
        Self {
            receiver: gpu.draw(&draw("fs_receiver", behind_all())),
            toy: gpu.draw(&DrawSpec {
                vertex: "vs_toy",
                streams: STREAMS,
                ..draw("fs_toy", nearest_surface())
            }),
        }
    }

    pub(crate) fn encode(&self, recorder: &mut Recorder<'_>, inputs: &Inputs<'_>, targets: &Targets) {
        let resources = [
            inputs.frame.into(),
            inputs.plate.into(),
            inputs.mask.into(),
            inputs.visibility.into(),
            inputs.terms.into(),
            (&recorder.gpu.samplers.linear).into(),
            inputs.labels.into(),
        ];
        let groups = [
            recorder.bind(&self.receiver, GROUP_SCENE, &inputs.scene.resources()),
            recorder.bind(&self.receiver, GROUP_PASS, &resources),
        ];
        let colors = [Some(resolved(&targets.samples.view, &targets.picture.view))];
        let depth = Some(&targets.depth.view);
        let mut render = recorder.render(SHADER.name, &colors, depth, StoreOp::Discard);
        render.begin(&self.receiver, &groups);
        render.draw(0..3, 0..1);
        render.begin(&self.toy, &groups);
        let toy = inputs.toy;
        render.set_vertices(1, &toy.physical.positions);
        toy.draw_positions(&mut render, &toy.shown.positions, 0..1);
    }
}

/// Depth state of the background: it neither tests nor writes depth.
fn behind_all() -> DepthStencilState {
    DepthStencilState {
        depth_write_enabled: Some(false),
        depth_compare: Some(CompareFunction::Always),
        ..nearest_surface()
    }
}
