//! The baseline: the published method on one scene, as good as the papers allow.

mod order;
pub(crate) mod plan;
mod readback;
pub mod uniform;
mod unseen;

use crate::baseline::order::{Pose, Step, order};
use crate::baseline::plan::BaselinePlan;
use crate::baseline::uniform::{Baseline as Uniform, Scene};
use crate::gpu::buffer::Buffer;
use crate::gpu::context::Gpu;
use crate::gpu::pass_run::Path;
use crate::gpu::recorder::Recorder;
use crate::gpu::texture::{Texture, TextureView};
use crate::passes::frame::Picture;
use crate::passes::globals::Globals;
use crate::passes::list::passes;
use crate::passes::pictures::Pictures;
use crate::passes::plate;
use crate::passes::plate::FINE_FORMAT;
use crate::passes::toy_mesh::ToyMesh;
use crate::plan::{Change, News};
use crate::readback::FloatMap;
use crate::readback::inject::{Injected, InjectedVisibility, upload};

passes!(BaselinePlan: masks, warp, pcss, eligible, census, search, box_filter, retarget);

/// The baseline of one scene: plan, targets and passes.
pub(crate) struct Baseline {
    pub(crate) plan: BaselinePlan,
    order: [Vec<(Path, Step)>; Change::ALL.len()],
    globals: Buffer,
    uniform: Buffer,
    plate: Texture,
    targets: Targets,
    injected: Injected,
    passes: Passes,
    plate_pass: plate::Pass,
}

/// The passes that run for `change`, `box_filter` several times.
pub fn planned(plan: &BaselinePlan, change: Change) -> Vec<(Path, &'static str)> {
    let steps = order(plan, change).into_iter();
    steps.map(|(path, step)| (path, step.pass())).collect()
}

impl Baseline {
    /// Allocates the resources of `plan`.
    pub(crate) fn new(gpu: &Gpu, plan: BaselinePlan, globals: &Globals, uniform: &Uniform) -> Self {
        Self {
            globals: gpu.uniform("globals", globals),
            uniform: gpu.uniform("baseline", uniform),
            plate: plate_target(gpu, &plan),
            targets: Targets::new(gpu, &plan),
            injected: Injected::default(),
            passes: Passes::new(gpu),
            plate_pass: plate::Pass::new(gpu),
            order: Change::ALL.map(|change| order(&plan, change)),
            plan,
        }
    }

    /// Follows the camera to another view, or other lights; textures are kept where region and lights stay as many.
    pub(crate) fn follow(&mut self, gpu: &Gpu, plan: BaselinePlan, globals: &Globals, uniform: &Uniform) {
        self.injected = Injected::default();
        let sizes = |plan: &BaselinePlan| (plan.region.size_px, plan.n_lights);
        if sizes(&plan) != sizes(&self.plan) {
            gpu.release_groups();
            self.plate = plate_target(gpu, &plan);
            self.targets = Targets::new(gpu, &plan);
        }
        gpu.write(&self.globals, &[*globals]);
        gpu.write(&self.uniform, &[*uniform]);
        self.order = Change::ALL.map(|change| order(&plan, change));
        self.plan = plan;
    }

    /// The region's picture.
    pub(crate) fn picture(&self) -> Picture<'_> {
        self.targets.retarget.picture()
    }

    /// Encodes the frame path, and before it the capture passes that `change` needs.
    pub(crate) fn encode(
        &self,
        recorder: &mut Recorder<'_>,
        toy: &ToyMesh,
        pictures: &Pictures<'_>,
        news: News,
    ) {
        let steps = self.order[news.change as usize].iter();
        for (path, step) in steps.filter(|(_, step)| step.is_due(news)) {
            recorder.path = *path;
            self.encode_step(recorder, (toy, pictures), *step);
        }
        recorder.path = Path::Frame;
    }

    /// Replaces visibilities from the next frame on.
    pub(crate) fn inject(&mut self, gpu: &Gpu, maps: &InjectedVisibility) {
        let visibility = &self.targets.pcss.visibility;
        let upload = |map: &Option<FloatMap>| map.as_ref().map(|map| upload(gpu, map, visibility));
        self.injected = Injected {
            physical: upload(&maps.physical),
            shown: upload(&maps.shown),
        };
    }

    fn encode_step(
        &self,
        recorder: &mut Recorder<'_>,
        (toy, pictures): (&ToyMesh, &Pictures<'_>),
        step: Step,
    ) {
        let (passes, targets, scene) = (&self.passes, &self.targets, self.scene());
        match step {
            Step::Plate => self.encode_plate(recorder, pictures),
            Step::Masks => passes.masks.encode(recorder, &self.globals, toy, &targets.masks),
            Step::Warp(pose, light) => {
                let inputs = self.warp_inputs(toy, pose, light);
                passes.warp.encode(recorder, &inputs, &targets.warp);
            }
            Step::Pcss(pose) => {
                passes
                    .pcss
                    .encode(recorder, scene, &targets.warp.maps.view, &targets.pcss);
                let injected = match pose {
                    Pose::Physical => &self.injected.physical,
                    Pose::Shown => &self.injected.shown,
                };
                if let Some(injected) = injected {
                    recorder.copy(injected, &targets.pcss.visibility);
                }
            }
            Step::Eligible => {
                let inputs = eligible::Inputs {
                    scene,
                    mask: &targets.masks.mask.view,
                    visibility: &targets.pcss.visibility.view,
                };
                passes.eligible.encode(recorder, &inputs, &targets.eligible);
            }
            Step::Census => passes
                .census
                .encode(recorder, &targets.eligible.labels, &targets.census),
            Step::Search => {
                let inputs = self.search_inputs(pictures);
                passes.search.encode(recorder, &inputs, &targets.search);
            }
            Step::BoxFilter => {
                let inputs = box_filter::Inputs {
                    scene,
                    terms: &targets.search.terms.view,
                    n_receivers: self.plan.n_receivers,
                };
                passes.box_filter.encode(recorder, &inputs, &targets.box_filter);
            }
            Step::Retarget => {
                let inputs = self.retarget_inputs(toy, pictures);
                passes.retarget.encode(recorder, &inputs, &targets.retarget);
            }
        }
    }

    fn encode_plate(&self, recorder: &mut Recorder<'_>, pictures: &Pictures<'_>) {
        let inputs = plate::Inputs {
            globals: &self.globals,
            views: pictures.plate_views,
            plates: pictures.plates,
            is_same_view: pictures.is_same_view,
        };
        self.plate_pass.encode(recorder, &inputs, &self.plate);
    }

    fn warp_inputs<'a>(&'a self, toy: &'a ToyMesh, pose: Pose, light: u32) -> warp::Inputs<'a> {
        warp::Inputs {
            globals: &self.globals,
            toy,
            pose: match pose {
                Pose::Physical => &toy.physical,
                Pose::Shown => &toy.shown,
            },
            light,
            n_receivers: self.plan.n_receivers,
        }
    }

    fn search_inputs<'a>(&'a self, pictures: &Pictures<'a>) -> search::Inputs<'a> {
        search::Inputs {
            scene: self.scene(),
            warp: &self.targets.warp.maps.view,
            labels: &self.targets.eligible.labels.view,
            seen_sets: &self.targets.census.seen_sets,
            frame: decoded(pictures),
            plate: &self.plate.view,
        }
    }

    fn retarget_inputs<'a>(&'a self, toy: &'a ToyMesh, pictures: &Pictures<'a>) -> retarget::Inputs<'a> {
        retarget::Inputs {
            scene: self.scene(),
            toy,
            frame: decoded(pictures),
            plate: &self.plate.view,
            mask: &self.targets.masks.mask.view,
            labels: &self.targets.eligible.labels.view,
            visibility: &self.targets.pcss.visibility.view,
            terms: &self.targets.box_filter.sums.view,
        }
    }

    fn scene(&self) -> Scene<'_> {
        Scene {
            globals: &self.globals,
            baseline: &self.uniform,
        }
    }
}

/// The frame, all of which is decoded for the baseline.
fn decoded<'a>(pictures: &Pictures<'a>) -> &'a TextureView {
    let [light, _] = pictures.frame.views();
    light
}

fn plate_target(gpu: &Gpu, plan: &BaselinePlan) -> Texture {
    Texture::target(gpu, "plate", plan.region.size_px, FINE_FORMAT)
}
