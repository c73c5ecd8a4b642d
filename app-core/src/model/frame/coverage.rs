//! `coverage`: fraction of each pixel that the posed toy covers, from many positions, in one pass.

use wgpu::{CompareFunction, Face, VertexFormat};

use crate::gpu::bindings::GROUP_SCENE;
use crate::gpu::context::Gpu;
use crate::gpu::pipeline::{Draw, DrawSpec, Stream};
use crate::gpu::recorder::Recorder;
use crate::gpu::shader::{Part, Shader, part};
use crate::model::plan::Plan;
use crate::model::region::Region;
use crate::passes::counting::{CountingTargets, counting, ordered};
use crate::passes::globals::{GLOBALS, GLOBALS_GROUP};
use crate::passes::parts::BEHIND;
use crate::passes::toy_mesh::{Detail, Side, ToyMesh};

/// Counting of a pixel's covered positions.
pub(crate) const COVERED: Part = part!("common/covered", constants: [N_POSITIONS, COVERED_CODES]);
pub(crate) const SHADER: Shader = Shader::new(&[&GLOBALS, &BEHIND, &COVERED, &part!("frame/coverage")]);
const STREAMS: &[Stream] = &[(0, VertexFormat::Float32x3)];
/// Positions within a pixel that the toy's coverage is counted over. RMS error of the area that a straight edge of any
/// direction cuts off a pixel: 0.020, where four multisample positions have 0.092.
pub(crate) const N_POSITIONS: u32 = 32;
/// Increment per covered position, in 8-bit codes.
pub(crate) const COVERED_CODES: u32 = 7;

pub(crate) struct Pass {
    /// Draws both sides of each triangle, or the one that faces the camera.
    draws: [Draw; 2],
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
        let spec = |culled| DrawSpec {
            vertex: "vs_move",
            streams: STREAMS,
            targets: vec![counting()],
            depth: Some(ordered(CompareFunction::Greater)),
            culled,
            ..DrawSpec::fullscreen(&SHADER, "fs_cover", groups, &[])
        };
        Self {
            draws: [None, Some(Face::Back)].map(|culled| gpu.draw(&spec(culled))),
        }
    }

    /// Draws the shown toy once for each position in a pixel.
    pub(crate) fn encode(&self, recorder: &mut Recorder<'_>, inputs: &Inputs<'_>, targets: &Targets) {
        let (toy, pose) = (inputs.toy, &inputs.toy.shown);
        let camera = inputs.camera_in_anchor.extend(1.0);
        let seen = (pose, Some(Side::Camera));
        let corners = toy.corners(recorder.gpu, seen, (&[camera], Detail::Own));
        let draw = &self.draws[usize::from(corners.is_culled)];
        let group = recorder.bind(draw, GROUP_SCENE, &[(&inputs.region.globals).into()]);
        let mut render = targets.covered.render(recorder, SHADER.name);
        render.part_of(inputs.region.plan.part_drawn());
        render.begin(draw, &[group]);
        corners.bind(&mut render, pose);
        corners.draw(&mut render, 0..N_POSITIONS);
    }
}
