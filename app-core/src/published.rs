//! The published method on one scene: its textures, its passes and the order they run in.

use glam::DMat4;
use wgpu::TextureFormat;

use crate::capture::Pictures;
use crate::gpu::Gpu;
use crate::gpu::encoder::Encoder;
use crate::gpu::layout::{Globals, Published as PublishedLayout};
use crate::gpu::texture::{Texture, TextureShape};
use crate::inject::Injected;
use crate::light_points::light_in_plane;
use crate::passes::box_filter::BoxFilter;
use crate::passes::composite::PICTURE_FORMAT;
use crate::passes::eligible::{ELIGIBLE_FORMAT, Eligible};
use crate::passes::masks::{MASKS_FORMAT, Masks};
use crate::passes::pcss::{PCSS_FORMAT, Pcss};
use crate::passes::plate::{PLATE_FORMAT, Plate};
use crate::passes::retarget::{N_SAMPLES, Retarget, RetargetInputs, RetargetTargets};
use crate::passes::search::{Search, SearchInputs, TAPS_FORMAT, TERM_FORMAT};
use crate::passes::toy_mesh::ToyMesh;
use crate::passes::warp::{WARP_FORMAT, Warp};
use crate::plan::PublishedPlan;
use crate::preset::PublishedSettings;
use crate::scene::{Light, Surface};

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
    pub(crate) warp: Texture,
    warp_depth: Texture,
    pub(crate) terms: Texture,
    terms_between: Texture,
    pub(crate) filtered_terms: Texture,
    samples: Texture,
    samples_depth: Texture,
    is_constant: bool,
    passes: Passes,
}

struct Passes {
    plate: Plate,
    masks: Masks,
    eligible: Eligible,
    warp: Warp,
    search: Search,
    box_filter: BoxFilter,
    pcss: Pcss,
    retarget: Retarget,
}

impl Published {
    /// Allocates what `plan` asks for. `tallest_m` bounds the height of the toy in any pose.
    pub(crate) fn new(
        gpu: &Gpu,
        plan: PublishedPlan,
        globals: &Globals,
        published: &PublishedLayout,
        tallest_m: f64,
    ) -> Self {
        let target = |label, format, n_samples| {
            let size_px = plan.region.size_px.to_array();
            Texture::target(
                gpu,
                label,
                TextureShape {
                    size_px,
                    format,
                    n_samples,
                },
            )
        };
        Self {
            globals: gpu.uniform("globals", globals),
            published: gpu.uniform("published", published),
            is_constant: published.is_constant == 1,
            plate: target("plate", PLATE_FORMAT, 1),
            masks: target("masks", MASKS_FORMAT, 1),
            eligible: target("eligible", ELIGIBLE_FORMAT, 1),
            warp: target("warp", WARP_FORMAT, 1),
            warp_depth: target("warp depth", TextureFormat::Depth32Float, 1),
            terms: target("terms", TERM_FORMAT, 1),
            terms_between: target("terms between", TERM_FORMAT, 1),
            filtered_terms: target("filtered terms", TERM_FORMAT, 1),
            taps: target("taps", TAPS_FORMAT, 1),
            visibility: target("visibility", PCSS_FORMAT, 1),
            injected: Injected::default(),
            samples: target("retarget samples", PICTURE_FORMAT, N_SAMPLES),
            samples_depth: target("retarget depth", TextureFormat::Depth32Float, N_SAMPLES),
            picture: target("retarget", PICTURE_FORMAT, 1),
            passes: Passes {
                plate: Plate::new(gpu),
                masks: Masks::new(gpu),
                eligible: Eligible::new(gpu),
                warp: Warp::new(gpu),
                search: Search::new(gpu),
                box_filter: BoxFilter::new(gpu),
                pcss: Pcss::new(gpu, tallest_m),
                retarget: Retarget::new(gpu),
            },
            plan,
        }
    }

    /// Encodes the plate of this view, and the masks of the physical pose.
    pub(crate) fn encode_view(
        &self,
        gpu: &Gpu,
        encoder: &mut Encoder,
        toy: &ToyMesh,
        pictures: &Pictures<'_>,
    ) {
        self.passes.plate.encode(
            gpu,
            encoder,
            &self.globals,
            (&pictures.plate_views, pictures.plates),
            &self.plate.view,
        );
        self.passes
            .masks
            .encode(gpu, encoder, &self.globals, toy, &self.masks.view);
        self.encode_visibility(
            gpu,
            encoder,
            (toy, &toy.physical.positions),
            self.injected.physical.as_ref(),
        );
        let sources = (&self.masks.view, &self.visibility.view);
        self.passes
            .eligible
            .encode(gpu, encoder, &self.published, sources, &self.eligible.view);
    }

    /// Encodes warp and visibility of the pose at `shown`; a visibility that is `injected` replaces the latter.
    fn encode_visibility(
        &self,
        gpu: &Gpu,
        encoder: &mut Encoder,
        shown: (&ToyMesh, &wgpu::Buffer),
        injected: Option<&Texture>,
    ) {
        let shared = (&self.globals, &self.published);
        self.passes.warp.encode(
            gpu,
            encoder,
            shared,
            shown,
            (&self.warp.view, &self.warp_depth.view),
        );
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
                frame: pictures.frame,
                plate: &self.plate.view,
            };
            self.passes
                .search
                .encode(gpu, encoder, &inputs, (&self.terms.view, &self.taps.view));
            self.passes.box_filter.encode(
                gpu,
                encoder,
                &self.published,
                &self.terms.view,
                (&self.terms_between.view, &self.filtered_terms.view),
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

/// The shaders' view of the settings and of the one light that the published method takes here.
pub(crate) fn uniform(
    light: &Light,
    plane_from_world: &DMat4,
    surface: Surface,
    settings: &PublishedSettings,
) -> PublishedLayout {
    PublishedLayout {
        light: light_in_plane(light, plane_from_world).as_vec4().to_array(),
        #[allow(clippy::cast_possible_truncation, reason = "a shader takes no more")]
        light_radius: match *light {
            Light::Sphere { radius_m, .. } => radius_m,
            Light::Directional {
                angular_radius_rad, ..
            } => angular_radius_rad.tan(),
        } as f32,
        is_textured: u32::from(surface == Surface::Textured),
        is_constant: u32::from(settings.constant_ratio.is_some()),
        constant_ratio: settings.constant_ratio.unwrap_or_default(),
        eligible_margin_px: settings.eligible_margin_px,
        ring_step_px: settings.ring_step_px,
        n_ring_directions: settings.n_ring_directions,
        n_rings: settings.n_rings,
        box_radius_px: settings.box_radius_px,
        seam_px: settings.seam_px,
        n_blocker_taps: settings.n_blocker_taps,
        n_filter_taps: settings.n_filter_taps,
    }
}
