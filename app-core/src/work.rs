//! The two ways to a picture behind one face: the model, and the published method.

use crate::capture::{Capture, Pictures};
use crate::frame::Warning;
use crate::gpu::encoder::Encoder;
use crate::gpu::layout::Globals;
use crate::gpu::texture::Texture;
use crate::gpu::{Gpu, GpuError};
use crate::inject::{Injected, InjectedVisibility, upload};
use crate::knowledge::Knowledge;
use crate::maps::{FloatMap, Map};
use crate::passes::toy_mesh::ToyMesh;
use crate::pipeline::Passes;
use crate::plan::{Change, LeftOut, Path, Plan, PlannedPass};
use crate::published::Published;
use crate::region::PixelRect;

/// A scene's textures and passes, and what was learned.
pub(crate) enum Work {
    /// The additive model of the receivers.
    Model(Box<Model>),
    /// The published method.
    Published(Box<Published>),
}

/// The additive model at work.
pub(crate) struct Model {
    pub(crate) knowledge: Knowledge,
    pub(crate) capture: Capture,
    pub(crate) passes: Passes,
}

impl Work {
    pub(crate) fn region(&self) -> PixelRect {
        match self {
            Self::Model(model) => model.capture.plan.region,
            Self::Published(published) => published.plan.region,
        }
    }

    pub(crate) fn passes(&self) -> &[PlannedPass] {
        match self {
            Self::Model(model) => &model.capture.plan.passes,
            Self::Published(published) => &published.plan.passes,
        }
    }

    pub(crate) fn left_out(&self) -> &[LeftOut] {
        match self {
            Self::Model(model) => &model.capture.plan.left_out,
            Self::Published(published) => &published.plan.left_out,
        }
    }

    /// The region's picture.
    pub(crate) fn picture(&self) -> &Texture {
        match self {
            Self::Model(model) => &model.capture.picture,
            Self::Published(published) => &published.picture,
        }
    }

    /// The model, where it is at work.
    pub(crate) fn model(&self) -> Option<&Model> {
        match self {
            Self::Model(model) => Some(model),
            Self::Published(_) => None,
        }
    }

    /// Encodes the frame path, and before it what the change asks for.
    pub(crate) fn encode(
        &self,
        gpu: &Gpu,
        encoder: &mut Encoder,
        toy: &ToyMesh,
        pictures: &Pictures<'_>,
        change: Change,
    ) {
        match self {
            Self::Model(model) => model.encode(gpu, encoder, toy, pictures, change),
            Self::Published(published) => {
                if change >= Change::View {
                    encoder.path = Path::Capture;
                    published.encode_plate(gpu, encoder, pictures);
                    published.encode_view(gpu, encoder, toy);
                }
                encoder.path = Path::Frame;
                if change == Change::Picture {
                    published.encode_plate(gpu, encoder, pictures);
                }
                published.encode_frame(gpu, encoder, toy, pictures);
            }
        }
    }

    /// Replaces visibilities from the next frame on; see [`Core::inject_visibility`](crate::core::Core).
    pub(crate) fn inject(&mut self, gpu: &Gpu, maps: &InjectedVisibility) {
        let upload = |map: &Option<FloatMap>, like: &Texture| map.as_ref().map(|map| upload(gpu, map, like));
        match self {
            Self::Model(model) => {
                let capture = &mut model.capture;
                capture.physical.injected = upload(&maps.physical, &capture.physical.lights);
                capture.shown.injected = upload(&maps.shown, &capture.shown.lights);
            }
            Self::Published(published) => {
                published.injected = Injected {
                    physical: upload(&maps.physical, &published.visibility),
                    shown: upload(&maps.shown, &published.visibility),
                };
            }
        }
    }

    /// Waits for the device and returns a map, where this way to a picture makes it.
    pub(crate) fn read_map(&self, gpu: &Gpu, map: Map) -> Result<Option<FloatMap>, GpuError> {
        match self {
            Self::Model(model) => model.read_map(gpu, map),
            Self::Published(published) => published.read_map(gpu, map),
        }
    }

    /// Waits for the device and returns what the published method lacks; the model tells by its fit.
    pub(crate) fn read_warnings(&self, gpu: &Gpu) -> Result<Vec<Warning>, GpuError> {
        match self {
            Self::Model(_) => Ok(Vec::new()),
            Self::Published(published) => published.read_warnings(gpu),
        }
    }
}

impl Model {
    fn encode(
        &self,
        gpu: &Gpu,
        encoder: &mut Encoder,
        toy: &ToyMesh,
        pictures: &Pictures<'_>,
        change: Change,
    ) {
        let (capture, passes, knowledge) = (&self.capture, &self.passes, &self.knowledge);
        if change == Change::Place {
            knowledge.forget(gpu, &mut encoder.raw);
        }
        if change >= Change::View {
            encoder.path = Path::Capture;
            capture.encode(gpu, encoder, passes, (toy, knowledge), (pictures, change));
        } else {
            encoder.path = Path::Frame;
        }
        if change == Change::Picture {
            capture.encode_levels(gpu, encoder, passes, knowledge, pictures.frame);
        }
        if change >= Change::Picture {
            capture.encode_appearance(gpu, encoder, passes, (knowledge, pictures.frame));
        }
        encoder.path = Path::Frame;
        passes.encode_frame(gpu, encoder, (capture, knowledge), toy, pictures.frame);
    }

    /// Follows the camera to another view; textures stay if they are large enough.
    pub(crate) fn follow(&mut self, gpu: &Gpu, plan: Plan, globals: &Globals) {
        self.passes.prepare(gpu, &plan);
        if plan.region.size_px == self.capture.plan.region.size_px {
            self.capture.follow(gpu, plan, globals);
        } else {
            let light_points = self.capture.lighting.points.clone();
            self.capture = Capture::new(gpu, plan, globals, light_points);
        }
    }
}
