//! `coverage`: fraction of each pixel that the posed toy covers, from many positions, in one pass.

use wgpu::{CompareFunction, VertexFormat};

use crate::gpu::bindings::GROUP_SCENE;
use crate::gpu::context::Gpu;
use crate::gpu::pipeline::{DrawSpec, Stream};
use crate::gpu::recorder::Recorder;
use crate::gpu::shader::{Part, Shader, part};
use crate::model::plan::Plan;
use crate::model::region::Region;
use crate::passes::counting::{CountingDraws, CountingTargets, TILES, counting, ordered};
use crate::passes::globals::{GLOBALS, GLOBALS_GROUP};
use crate::passes::parts::BEHIND;
use crate::passes::toy_mesh::{Detail, Saves, Side, SilhouetteTarget, ToyMesh};

/// Counting of a pixel's covered positions.
pub(crate) const COVERED: Part = part!("common/covered", constants: [N_POSITIONS, COVERED_CODES]);
pub(crate) const SHADER: Shader =
    Shader::new(&[&GLOBALS, &BEHIND, &COVERED, &TILES, &part!("frame/coverage")]);
const STREAMS: &[Stream] = &[(0, VertexFormat::Float32x3)];
/// Positions within a pixel that the toy's coverage is counted over. RMS error of the area that a straight edge of any
/// direction cuts off a pixel: 0.020, where four multisample positions have 0.092.
pub(crate) const N_POSITIONS: u32 = 32;
/// Increment per covered position, in 8-bit codes.
pub(crate) const COVERED_CODES: u32 = 7;

pub(crate) struct Pass {
    draws: CountingDraws,
}

pub(crate) struct Inputs<'a> {
    pub(crate) region: &'a Region,
    pub(crate) toy: &'a ToyMesh,
    pub(crate) camera_in_anchor: glam::Vec3,
}

/// Of the toy box's size.
pub(crate) struct Targets {
    pub(crate) covered: CountingTargets,
}

impl Targets {
    pub(crate) fn new(gpu: &Gpu, plan: &Plan) -> Self {
        Self {
            covered: CountingTargets::new(gpu, "coverage", plan.toy_box.size_px),
        }
    }
}

impl Pass {
    pub(crate) fn new(gpu: &Gpu) -> Self {
        let groups = [GLOBALS_GROUP, &[], &[], &[]];
        let each = DrawSpec {
            vertex: "vs_move",
            streams: STREAMS,
            targets: vec![counting()],
            depth: Some(ordered(CompareFunction::Greater)),
            ..DrawSpec::fullscreen(&SHADER, "fs_cover", groups, &[])
        };
        Self {
            draws: CountingDraws::new(gpu, &each),
        }
    }

    /// Draws the shown toy once for each position in a pixel, as far as its silhouette comes near.
    pub(crate) fn encode(&self, recorder: &mut Recorder<'_>, inputs: &Inputs<'_>, targets: &Targets) {
        let (toy, pose) = (inputs.toy, &inputs.toy.shown);
        let camera = inputs.camera_in_anchor.extend(1.0);
        let seen = (pose, Some(Side::Camera));
        let target = SilhouetteTarget {
            projection: &inputs.region.uniform.by_camera(),
            part: inputs.region.plan.toy_box,
            saves: Saves::Pixels,
        };
        let corners = toy.corners(recorder.gpu, seen, (&[camera], Detail::Own), Some(target));
        let globals = [(&inputs.region.globals).into()];
        let group = recorder.bind(self.draws.any(), GROUP_SCENE, &globals);
        let mut render = targets.covered.render(recorder, SHADER.name);
        render.part_of(inputs.region.plan.part_drawn());
        let drawn = (&corners, pose);
        // Before one receiver it is told from the vertices what is behind it.
        let n_plain = if inputs.region.plan.n_receivers == 1 {
            N_POSITIONS
        } else {
            0
        };
        self.draws
            .count(&mut render, &[group], drawn, (0..N_POSITIONS, n_plain));
    }
}
