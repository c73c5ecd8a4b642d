//! `coverage`: fraction of each pixel that the posed toy covers, from many positions, in one pass.

use wgpu::{CompareFunction, Face, VertexFormat};

use crate::gpu::bindings::GROUP_SCENE;
use crate::gpu::buffer::Buffer;
use crate::gpu::context::Gpu;
use crate::gpu::pipeline::{Draw, DrawSpec, Stream};
use crate::gpu::recorder::Recorder;
use crate::gpu::shader::{Part, Shader, part};
use crate::model::plan::Plan;
use crate::passes::counting::{CountingTargets, counting, ordered};
use crate::passes::globals::{GLOBALS, GLOBALS_GROUP};
use crate::passes::parts::BEHIND;
use crate::passes::toy_mesh::ToyMesh;

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
    draw: Draw,
}

pub(crate) struct Inputs<'a> {
    pub(crate) globals: &'a Buffer,
    pub(crate) toy: &'a ToyMesh,
    pub(crate) camera_in_anchor: glam::Vec3,
}

/// Of the region's size.
pub(crate) struct Targets {
    pub(crate) covered: CountingTargets,
}

impl Targets {
    pub(crate) fn new(gpu: &Gpu, plan: &Plan) -> Self {
        Self {
            covered: CountingTargets::new(gpu, "coverage", plan.region.size_px),
        }
    }
}

impl Pass {
    pub(crate) fn new(gpu: &Gpu) -> Self {
        let groups = [GLOBALS_GROUP, &[], &[], &[]];
        Self {
            draw: gpu.draw(&DrawSpec {
                vertex: "vs_move",
                streams: STREAMS,
                targets: vec![counting()],
                depth: Some(ordered(CompareFunction::Greater)),
                culled: Some(Face::Back),
                ..DrawSpec::fullscreen(&SHADER, "fs_cover", groups, &[])
            }),
        }
    }

    /// Draws the shown toy once for each position in a pixel.
    pub(crate) fn encode(&self, recorder: &mut Recorder<'_>, inputs: &Inputs<'_>, targets: &Targets) {
        let group = recorder.bind(&self.draw, GROUP_SCENE, &[inputs.globals.into()]);
        let (toy, pose) = (inputs.toy, &inputs.toy.shown);
        let is_within = pose.around.holds(inputs.camera_in_anchor.as_dvec3().extend(1.0));
        let triangles = toy.shadow_ranges.seen_from(is_within);
        let mut render = targets.covered.render(recorder, SHADER.name);
        render.begin(&self.draw, &[group]);
        toy.bind_positions(&mut render, &pose.positions);
        render.draw_indexed(triangles, 0..N_POSITIONS);
    }
}
