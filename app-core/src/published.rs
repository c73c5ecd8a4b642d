//! The published method on one scene: its textures, its passes and the order they run in.

use wgpu::TextureFormat;

use crate::capture::Pictures;
use crate::frame::Warning;
use crate::gpu::encoder::Encoder;
use crate::gpu::layout::{Globals, MAX_LIGHTS, Published as PublishedLayout};
use crate::gpu::texture::{Texture, TextureLayers, TextureShape};
use crate::gpu::{Gpu, GpuError};
use crate::inject::Injected;
use crate::maps::{FloatMap, Map};
use crate::passes::box_filter::BoxFilter;
use crate::passes::census::{CENSUS_BYTES, Census};
use crate::passes::composite::{CompositeTargets, N_SAMPLES, PICTURE_FORMAT};
use crate::passes::eligible::{ELIGIBLE_FORMAT, Eligible};
use crate::passes::masks::{MASKS_FORMAT, Masks};
use crate::passes::pcss::Pcss;
use crate::passes::retarget::{Retarget, RetargetInputs};
use crate::passes::search::{Search, SearchInputs, TAPS_FORMAT, TERM_FORMAT};
use crate::passes::toy_mesh::ToyMesh;
use crate::passes::warp::{WARP_FORMAT, Warp};
use crate::plan::PublishedPlan;
use crate::preset::PublishedSettings;
use crate::scene::{Light, Surface};

/// The census is written and read on the device, cleared, and read back for warnings.
const CENSUS_USAGE: wgpu::BufferUsages = wgpu::BufferUsages::STORAGE.union(wgpu::BufferUsages::COPY_SRC);

/// Everything of the region's size, and the passes.
pub(crate) struct Published {
    pub(crate) plan: PublishedPlan,
    pub(crate) picture: Texture,
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
    /// Bit s where the set s of lights occurs in mask 3c.
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
    /// Allocates what `plan` asks for. `tallest_m` bounds the height of the toy in any pose.
    pub(crate) fn new(
        gpu: &Gpu,
        plan: PublishedPlan,
        globals: &Globals,
        published: &PublishedLayout,
        tallest_m: f64,
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
            masks: target("masks", MASKS_FORMAT, 1),
            eligible: target("eligible", ELIGIBLE_FORMAT, 1),
            warp: targets("warp", WARP_FORMAT, plan.n_lights),
            warp_depth: target("warp depth", TextureFormat::Depth32Float, 1),
            seen_sets: gpu.buffer("seen sets", &CENSUS_BYTES, CENSUS_USAGE),
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
                masks: Masks::new(gpu),
                eligible: Eligible::new(gpu),
                census: Census::new(gpu),
                warp: Warp::new(gpu),
                search: Search::new(gpu),
                box_filter: BoxFilter::new(gpu, plan.n_sets),
                pcss: Pcss::new(gpu, tallest_m, plan.visibility_format),
                retarget: Retarget::new(gpu),
            },
            plan,
        }
    }

    /// Encodes the masks of the physical pose.
    pub(crate) fn encode_masks(&self, gpu: &Gpu, encoder: &mut Encoder, toy: &ToyMesh) {
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
            self.passes
                .warp
                .encode(gpu, encoder, (&self.globals, light), shown, targets);
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
                plate: pictures.plate,
            };
            self.passes
                .search
                .encode(gpu, encoder, &inputs, (&self.terms.view, &self.taps.view));
            self.passes.box_filter.encode(
                gpu,
                encoder,
                &self.published,
                &self.terms.view,
                (&self.terms_between.view, &self.filtered_terms.layers),
            );
        }
        let inputs = RetargetInputs {
            globals: &self.globals,
            published: &self.published,
            frame: pictures.frame,
            plate: pictures.plate,
            masks: &self.masks.view,
            eligible: &self.eligible.view,
            visibility: &self.visibility.view,
            terms: &self.filtered_terms.view,
        };
        let targets = CompositeTargets {
            samples: &self.samples.view,
            depth: &self.samples_depth.view,
            picture: &self.picture.view,
        };
        self.passes.retarget.encode(gpu, encoder, toy, &inputs, &targets);
    }
}

impl Published {
    /// Waits for the device and returns what real shadow was not seen, for the pose shown last.
    pub(crate) fn read_warnings(&self, gpu: &Gpu) -> Result<Vec<Warning>, GpuError> {
        if self.is_constant {
            return Ok(Vec::new());
        }
        let seen: u32 = bytemuck::pod_read_unaligned(&gpu.read_buffer(&self.seen_sets)?);
        if seen == 0 {
            return Ok(vec![Warning::NothingToSample]);
        }
        let needed = self.read_map(gpu, Map::Terms)?.map(|terms| sets_in(&terms));
        let unseen = needed.unwrap_or_default() & !seen;
        let lights = |set: u32| (0..MAX_LIGHTS).filter(|light| set >> light & 1 == 1).collect();
        let lights: Vec<_> = (1..=self.plan.n_sets)
            .filter(|set| unseen >> set & 1 == 1)
            .map(lights)
            .collect();
        let is_any = !lights.is_empty();
        Ok(is_any
            .then_some(Warning::OverlapsUnseen { lights })
            .into_iter()
            .collect())
    }
}

/// Bit s where a term stands for the set s.
fn sets_in(terms: &FloatMap) -> u32 {
    #[allow(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "sets are whole numbers below 16"
    )]
    let sets = terms.texels.iter().map(|term| term[3] as u32);
    sets.fold(0, |seen, set| seen | 1 << set) & !1
}

/// The shaders' view of the settings, and of what they must know of the lights besides where they are.
pub(crate) fn uniform(lights: &[Light], surface: Surface, settings: &PublishedSettings) -> PublishedLayout {
    let mut light_radii = [0.0; MAX_LIGHTS];
    for (slot, light) in light_radii.iter_mut().zip(lights) {
        *slot = disc_radius(light);
    }
    PublishedLayout {
        light_radii,
        is_textured: u32::from(surface == Surface::Textured),
        is_constant: u32::from(settings.constant_ratio.is_some()),
        constant_ratio: settings
            .constant_ratio
            .map_or(0.0, |of_all| ratio_per_light(of_all, lights.len())),
        eligible_margin_px: settings.eligible_margin_px,
        ring_step_px: settings.ring_step_px,
        n_ring_directions: settings.n_ring_directions,
        n_rings: settings.n_rings,
        box_radius_px: settings.box_radius_px,
        seam_px: settings.seam_px,
        n_blocker_taps: settings.n_blocker_taps,
        n_filter_taps: settings.n_filter_taps,
        _pad: 0,
    }
}

/// Each light's ratio, such that the product over all lights is `of_all`: shadows of AR products multiply.
fn ratio_per_light(of_all: f32, n_lights: usize) -> f32 {
    #[allow(clippy::cast_precision_loss, reason = "at most MAX_LIGHTS")]
    let n_lights = n_lights.max(1) as f32;
    of_all.powf(n_lights.recip())
}

/// Metres for a sphere, slope for a directional light.
fn disc_radius(light: &Light) -> f32 {
    let radius = match *light {
        Light::Sphere { radius_m, .. } => radius_m,
        Light::Directional {
            angular_radius_rad, ..
        } => angular_radius_rad.tan(),
    };
    #[allow(clippy::cast_possible_truncation, reason = "a shader takes no more")]
    {
        radius as f32
    }
}
