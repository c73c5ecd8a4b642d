//! The published method on one scene: its textures, its passes and the order they run in.

mod uniform;
mod unseen;

use wgpu::TextureFormat;

use crate::capture::Pictures;
use crate::gpu::Gpu;
use crate::gpu::encoder::Encoder;
use crate::gpu::layout::{Globals, Published as PublishedLayout};
use crate::gpu::texture::{Texture, TextureLayers, TextureShape};
use crate::inject::Injected;
use crate::passes::box_filter::BoxFilter;
use crate::passes::census::{Census, SeenSets};
use crate::passes::composite::PICTURE_FORMAT;
use crate::passes::eligible::{ELIGIBLE_FORMAT, Eligible};
use crate::passes::masks::{MASKS_FORMAT, Masks};
use crate::passes::pcss::Pcss;
use crate::passes::plate::{PLATE_FORMAT, Plate};
use crate::passes::retarget::{N_SAMPLES, Retarget, RetargetInputs, RetargetTargets};
use crate::passes::search::{Search, SearchInputs, TAPS_FORMAT, TERM_FORMAT};
use crate::passes::toy_mesh::ToyMesh;
use crate::passes::warp::{Shadow, WARP_FORMAT, Warp};
use crate::plan::PublishedPlan;

pub(crate) use uniform::uniform;

/// The census is written and read on the device, cleared, and read back for warnings.
const CENSUS_USAGE: wgpu::BufferUsages = wgpu::BufferUsages::STORAGE.union(wgpu::BufferUsages::COPY_SRC);

/// Everything of the region's size, and the passes.
pub(crate) struct Published {
    pub(crate) plan: PublishedPlan,
    pub(crate) picture: Texture,
    pub(crate) plate: Texture,
    pub(crate) masks: Texture,
    pub(crate) eligible: Texture,
    pub(crate) taps: Texture,
    pub(crate) visibility: Texture,
    pub(crate) injected: Injected,
    globals: wgpu::Buffer,
    published: wgpu::Buffer,
    /// A layer a light.
    pub(crate) warp: TextureLayers,
    warp_depth: Texture,
    /// A word a receiver: bit s where the set s of lights occurs in its mask 3c.
    pub(crate) seen_sets: wgpu::Buffer,
    pub(crate) terms: Texture,
    terms_between: Texture,
    /// A layer a set of lights.
    pub(crate) filtered_terms: TextureLayers,
    samples: Texture,
    samples_depth: Texture,
    pub(crate) is_constant: bool,
    passes: Passes,
}

struct Passes {
    plate: Plate,
    masks: Masks,
    eligible: Eligible,
    census: Census,
    warp: Warp,
    search: Search,
    box_filter: BoxFilter,
    pcss: Pcss,
    retarget: Retarget,
}

impl Published {
    /// Allocates what `plan` asks for.
    pub(crate) fn new(
        gpu: &Gpu,
        plan: PublishedPlan,
        globals: &Globals,
        published: &PublishedLayout,
    ) -> Self {
        let shape = |format, n_samples| TextureShape {
            size_px: plan.region.size_px.to_array(),
            format,
            n_samples,
        };
        let target = |label, format, n_samples| Texture::target(gpu, label, shape(format, n_samples));
        let targets =
            |label, format, n_layers| TextureLayers::targets(gpu, label, shape(format, 1), n_layers);
        Self {
            globals: gpu.uniform("globals", globals),
            published: gpu.uniform("published", published),
            is_constant: published.is_constant == 1,
            plate: target("plate", PLATE_FORMAT, 1),
            masks: target("masks", MASKS_FORMAT, 1),
            eligible: target("eligible", ELIGIBLE_FORMAT, 1),
            warp: targets("warp", WARP_FORMAT, plan.n_lights),
            warp_depth: target("warp depth", TextureFormat::Depth32Float, 1),
            seen_sets: gpu.buffer(
                "seen sets",
                bytemuck::bytes_of(&SeenSets::default()),
                CENSUS_USAGE,
            ),
            terms: target("terms", TERM_FORMAT, 1),
            terms_between: target("terms between", TERM_FORMAT, 1),
            filtered_terms: targets("filtered terms", TERM_FORMAT, plan.n_sets),
            taps: target("taps", TAPS_FORMAT, 1),
            visibility: target("visibility", plan.visibility_format, 1),
            injected: Injected::default(),
            samples: target("retarget samples", PICTURE_FORMAT, N_SAMPLES),
            samples_depth: target("retarget depth", TextureFormat::Depth32Float, N_SAMPLES),
            picture: target("retarget", PICTURE_FORMAT, 1),
            passes: Passes {
                plate: Plate::new(gpu),
                masks: Masks::new(gpu),
                eligible: Eligible::new(gpu),
                census: Census::new(gpu),
                warp: Warp::new(gpu),
                search: Search::new(gpu),
                box_filter: BoxFilter::new(gpu, plan.n_receivers, plan.n_sets),
                pcss: Pcss::new(gpu, plan.visibility_format),
                retarget: Retarget::new(gpu),
            },
            plan,
        }
    }

    /// Encodes the plate of this view, at the exposure of its picture.
    pub(crate) fn encode_plate(&self, gpu: &Gpu, encoder: &mut Encoder, pictures: &Pictures<'_>) {
        let plates = (pictures.plate_views, pictures.plates);
        let plate = &self.passes.plate;
        plate.encode(gpu, encoder, &self.globals, plates, &self.plate.view);
    }

    /// Encodes the masks of the physical pose.
    pub(crate) fn encode_view(&self, gpu: &Gpu, encoder: &mut Encoder, toy: &ToyMesh) {
        self.passes
            .masks
            .encode(gpu, encoder, &self.globals, toy, &self.masks.view);
        self.encode_visibility(
            gpu,
            encoder,
            (toy, &toy.physical.positions),
            self.injected.physical.as_ref(),
        );
        let shared = (&self.globals, &self.published);
        let sources = (&self.masks.view, &self.visibility.view);
        self.passes
            .eligible
            .encode(gpu, encoder, shared, sources, &self.eligible.view);
        if !self.is_constant {
            let mask = (&self.eligible.view, self.plan.region.size_px);
            self.passes.census.encode(gpu, encoder, mask, &self.seen_sets);
        }
    }

    /// Encodes warps and visibility of the pose at `shown`; a visibility that is `injected` replaces the latter.
    fn encode_visibility(
        &self,
        gpu: &Gpu,
        encoder: &mut Encoder,
        shown: (&ToyMesh, &wgpu::Buffer),
        injected: Option<&Texture>,
    ) {
        for (light, layer) in (0..).zip(&self.warp.layers) {
            let targets = (layer, &self.warp_depth.view);
            let shadow = Shadow {
                light,
                n_receivers: self.plan.n_receivers,
            };
            self.passes
                .warp
                .encode(gpu, encoder, (&self.globals, shadow), shown, targets);
        }
        let shared = (&self.globals, &self.published);
        self.passes
            .pcss
            .encode(gpu, encoder, shared, &self.warp.view, &self.visibility.view);
        if let Some(injected) = injected {
            self.visibility.encode_copy(encoder, injected);
        }
    }

    /// Encodes the shadow of the shown pose and the picture of the region.
    pub(crate) fn encode_frame(
        &self,
        gpu: &Gpu,
        encoder: &mut Encoder,
        toy: &ToyMesh,
        pictures: &Pictures<'_>,
    ) {
        self.encode_visibility(
            gpu,
            encoder,
            (toy, &toy.shown.positions),
            self.injected.shown.as_ref(),
        );
        if !self.is_constant {
            let inputs = SearchInputs {
                globals: &self.globals,
                published: &self.published,
                warp: &self.warp.view,
                eligible: &self.eligible.view,
                seen_sets: &self.seen_sets,
                frame: pictures.frame,
                plate: &self.plate.view,
            };
            self.passes
                .search
                .encode(gpu, encoder, &inputs, (&self.terms.view, &self.taps.view));
            self.passes.box_filter.encode(
                gpu,
                encoder,
                (&self.globals, &self.published),
                &self.terms.view,
                (&self.terms_between.view, &self.filtered_terms.layers),
            );
        }
        let inputs = RetargetInputs {
            globals: &self.globals,
            published: &self.published,
            frame: pictures.frame,
            plate: &self.plate.view,
            masks: &self.masks.view,
            eligible: &self.eligible.view,
            visibility: &self.visibility.view,
            terms: &self.filtered_terms.view,
        };
        let targets = RetargetTargets {
            samples: &self.samples.view,
            depth: &self.samples_depth.view,
            picture: &self.picture.view,
        };
        self.passes.retarget.encode(gpu, encoder, toy, &inputs, &targets);
    }
}
