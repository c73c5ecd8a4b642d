//! The baseline: the published method on one scene, as good as the papers allow.

pub(crate) mod plan;
mod readback;
pub mod uniform;
mod unseen;

use crate::baseline::plan::BaselinePlan;
use crate::baseline::uniform::{Baseline as Uniform, Scene};
use crate::gpu::{Buffer, Gpu, PassGroup, Recorder, Texture, TextureView};
use crate::passes::globals::Globals;
use crate::passes::list::passes;
use crate::passes::pictures::{Picture, Pictures};
use crate::passes::plate;
use crate::passes::plate::FINE_FORMAT;
use crate::passes::toy_mesh::{PoseBuffers, ToyMesh};
use crate::plan::{Change, FrameDelta};
use crate::readback::FloatMap;
use crate::readback::inject::{Injected, InjectedVisibility, upload};

passes!(BaselinePlan: masks, warp, pcss, eligible, census, search, box_filter, retarget);

/// The baseline of one scene: plan, targets and passes.
pub(crate) struct Baseline {
    pub(crate) plan: BaselinePlan,
    globals: Buffer,
    uniform: Buffer,
    plate: Texture,
    targets: Targets,
    injected: Injected,
    passes: Passes,
    plate_pass: plate::Pass,
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
            plan,
        }
    }

    /// Adapts to another view or to other lights. Textures are kept if the region's size and the
    /// number of lights stay the same.
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
        self.plan = plan;
    }

    /// The region's picture.
    pub(crate) fn picture(&self) -> Picture<'_> {
        self.targets.retarget.picture()
    }

    /// Encodes the passes of a frame, and before them the capture passes that `change` requires.
    pub(crate) fn encode(
        &self,
        recorder: &mut Recorder<'_>,
        toy: &ToyMesh,
        pictures: &Pictures<'_>,
        delta: FrameDelta,
    ) {
        let (passes, targets, scene) = (&self.passes, &self.targets, self.scene());
        if delta.change >= Change::View {
            recorder.group = PassGroup::Capture;
            self.encode_plate(recorder, pictures);
            passes.masks.encode(recorder, &self.globals, toy, &targets.masks);
            self.encode_shadow(recorder, toy, &toy.physical, self.injected.physical.as_ref());
            let inputs = eligible::Inputs {
                scene,
                mask: &targets.masks.mask.view,
                visibility: &targets.pcss.visibility.view,
            };
            passes.eligible.encode(recorder, &inputs, &targets.eligible);
            if census::is_needed(&self.plan) {
                let labels = &targets.eligible.labels;
                passes.census.encode(recorder, labels, &targets.census);
            }
        }
        recorder.group = PassGroup::Frame;
        if delta.change == Change::Picture {
            // The plate is converted to the exposure of the new picture.
            self.encode_plate(recorder, pictures);
        }
        if !delta.keeps_pose() {
            self.encode_shadow(recorder, toy, &toy.shown, self.injected.shown.as_ref());
        }
        if !delta.keeps_picture() {
            self.encode_picture(recorder, toy, pictures);
        }
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

    /// Encodes warps and visibility of a pose.
    fn encode_shadow(
        &self,
        recorder: &mut Recorder<'_>,
        toy: &ToyMesh,
        pose: &PoseBuffers,
        injected: Option<&Texture>,
    ) {
        let (passes, targets) = (&self.passes, &self.targets);
        for light in 0..self.plan.n_lights {
            let inputs = warp::Inputs {
                globals: &self.globals,
                toy,
                pose,
                light,
                n_receivers: self.plan.n_receivers,
            };
            passes.warp.encode(recorder, &inputs, &targets.warp);
        }
        let maps = &targets.warp.maps.view;
        passes.pcss.encode(recorder, self.scene(), maps, &targets.pcss);
        if let Some(injected) = injected {
            recorder.copy(injected, &targets.pcss.visibility);
        }
    }

    fn encode_picture(&self, recorder: &mut Recorder<'_>, toy: &ToyMesh, pictures: &Pictures<'_>) {
        let (passes, targets) = (&self.passes, &self.targets);
        if search::is_needed(&self.plan) {
            let inputs = self.search_inputs(pictures);
            passes.search.encode(recorder, &inputs, &targets.search);
        }
        if box_filter::is_needed(&self.plan) {
            let inputs = box_filter::Inputs {
                scene: self.scene(),
                terms: &targets.search.terms.view,
                n_receivers: self.plan.n_receivers,
            };
            passes.box_filter.encode(recorder, &inputs, &targets.box_filter);
        }
        let inputs = self.retarget_inputs(toy, pictures);
        passes.retarget.encode(recorder, &inputs, &targets.retarget);
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

/// The frame with all values decoded, as the baseline reads it.
fn decoded<'a>(pictures: &Pictures<'a>) -> &'a TextureView {
    let [light, _] = pictures.frame.views();
    light
}

fn plate_target(gpu: &Gpu, plan: &BaselinePlan) -> Texture {
    Texture::target(gpu, "plate", plan.region.size_px, FINE_FORMAT)
}
