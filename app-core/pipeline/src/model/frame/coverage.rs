//! `coverage`: fraction of each pixel that the posed toy covers, sampled at many positions in one
//! pass.

use std::sync::OnceLock;

use wgpu::{BlendOperation, CompareFunction, TextureFormat, VertexFormat};

use crate::gpu::bindings::{GROUP_PASS, GROUP_SCENE, Resource, Slot};
use crate::gpu::context::Gpu;
use crate::gpu::pipeline::{DrawSpec, Stream};
use crate::gpu::recorder::{Recorder, cleared};
use crate::gpu::shader::{Mirrors, Shader, mirrors, shader};
use crate::gpu::shared::shared_struct;
use crate::gpu::texture::{Texture, TextureView};
use crate::model::plan::Plan;
use crate::model::region::Region;
use crate::passes::counting::{CountingDraws, InstanceOrder, counting, ordered};
use crate::passes::globals::GLOBALS_GROUP;
use crate::passes::toy_mesh::{CasterLod, Savings, SeenToy, Side, SilhouetteTarget, ToyMesh};

/// Count of a pixel's covered positions.
pub(crate) const COVERED: Mirrors = mirrors!("common/covered", constants: [N_POSITIONS, COVERED_CODES]);
/// The lattice of these positions, for the background of an outline.
pub(crate) const BEHIND_OUTLINE: Mirrors = mirrors!("common/behind_outline", constants: [OUTLINE_ROW_STEP]);
pub(crate) const SHADER: Shader = shader!("frame/coverage", structs: [Positions]);
const SLOTS: &[Slot] = &[Slot::per_use::<Positions>()];
/// Entry points and slots beside things with fronts.
const OVER_THINGS: [&str; 2] = ["vs_before_fronts", "fs_cover_over_things"];
const OVER_THINGS_SLOTS: &[Slot] = &[SLOTS[0], Slot::Texture];
const STREAMS: &[Stream] = &[(0, VertexFormat::Float32x3)];
/// Number of lattice positions within a pixel at which the toy's coverage is sampled.
pub(crate) const N_POSITIONS: u32 = 32;
/// Rows from one column's position to the next.
const OUTLINE_ROW_STEP: u32 = 9;
/// Format of the count, in whole codes.
const COUNT_FORMAT: TextureFormat = TextureFormat::R8Unorm;
/// Increment per covered position, in 8-bit codes.
pub(crate) const COVERED_CODES: u32 = 7;

shared_struct! {
    /// A lattice of positions.
    pub(crate) struct Positions {
        pub n: u32,
        pub row_step: u32,
    }
}

/// All positions, and half of them. RMS error of the area that a straight edge of any direction
/// cuts off a pixel: 0.020 and 0.035, nearly or exactly the least of all row steps; four
/// multisample positions have 0.092.
const ALL: Positions = Positions {
    n: N_POSITIONS,
    row_step: OUTLINE_ROW_STEP,
};
const HALF: Positions = Positions {
    n: N_POSITIONS / 2,
    row_step: 5,
};

pub(crate) struct Pass {
    draws: CountingDraws,
    /// Beside things before the toy with fronts; made on first use.
    over_things: OnceLock<CountingDraws>,
}

pub(crate) struct Inputs<'a> {
    pub(crate) region: &'a Region,
    pub(crate) toy: &'a ToyMesh,
    pub(crate) camera_in_anchor: glam::Vec3,
    /// Marks of things before the toy, if their fronts are known.
    pub(crate) marks_before: Option<&'a TextureView>,
}

/// Targets of the toy box's size.
pub(crate) struct Targets {
    order: InstanceOrder,
    pub(crate) covered: Texture,
}

impl Targets {
    pub(crate) fn new(gpu: &Gpu, plan: &Plan) -> Self {
        Self {
            order: InstanceOrder::new(gpu, "coverage order", plan.toy_box.size_px),
            covered: Texture::target(gpu, "coverage", plan.toy_box.size_px, COUNT_FORMAT),
        }
    }
}

impl Pass {
    pub(crate) fn new(gpu: &Gpu) -> Self {
        Self {
            draws: counting_draws(gpu, ["vs_move", "fs_cover"], SLOTS),
            over_things: OnceLock::new(),
        }
    }

    /// Draws the shown toy once for each position in a pixel, in the tiles near its silhouette.
    pub(crate) fn encode(&self, recorder: &mut Recorder<'_>, inputs: &Inputs<'_>, targets: &Targets) {
        let (toy, pose) = (inputs.toy, &inputs.toy.shown);
        let camera = inputs.camera_in_anchor.extend(1.0);
        let seen = SeenToy {
            pose,
            side: Some(Side::Camera),
            points: &[camera],
            lod: CasterLod::Own,
        };
        let target = SilhouetteTarget {
            projection: &inputs.region.uniform.by_camera(),
            part: inputs.region.plan.toy_box,
            savings: Savings::Pixels,
        };
        let plan = &inputs.region.plan;
        // Only where each position is drawn are the fronts of things tested.
        let target = inputs.marks_before.is_none().then_some(target);
        let corners = toy.corners(recorder.gpu, &seen, target);
        let globals = [(&inputs.region.globals).into()];
        let is_half = plan.n_coverage_positions < N_POSITIONS;
        let positions = if is_half { HALF } else { ALL };
        let n_positions = positions.n;
        let draws = match inputs.marks_before {
            Some(_) => self
                .over_things
                .get_or_init(|| counting_draws(recorder.gpu, OVER_THINGS, OVER_THINGS_SLOTS)),
            None => &self.draws,
        };
        let resources: Vec<Resource<'_>> = [Resource::PerUse]
            .into_iter()
            .chain(inputs.marks_before.map(Into::into))
            .collect();
        let groups = [
            recorder.bind(draws.any(), GROUP_SCENE, &globals),
            recorder.bind_with(draws.any(), GROUP_PASS, &positions, &resources),
        ];
        let count = cleared(&targets.covered.view);
        let mut render = targets.order.render(recorder, SHADER.name, count);
        render.part_of(plan.part_drawn(&plan.toy_box));
        let drawn = (&corners, pose);
        // In front of a single receiver, the vertices alone decide what is behind it.
        let is_plain = plan.n_receivers == 1 && inputs.marks_before.is_none();
        let n_plain = if is_plain { n_positions } else { 0 };
        draws.count(&mut render, &groups, drawn, 0..n_positions, n_plain);
    }
}

fn counting_draws(gpu: &Gpu, [vertex, fragment]: [&'static str; 2], slots: &'static [Slot]) -> CountingDraws {
    CountingDraws::new(
        gpu,
        &DrawSpec {
            vertex,
            streams: STREAMS,
            targets: vec![counting(COUNT_FORMAT, BlendOperation::Add)],
            depth: Some(ordered(CompareFunction::Greater)),
            ..DrawSpec::fullscreen(&SHADER, fragment, [GLOBALS_GROUP, slots, &[], &[]], &[])
        },
    )
}
