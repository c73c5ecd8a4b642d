//! The two ways to a picture behind one face: the model, and the published method.

use crate::capture::{Capture, Pictures};
use crate::frame::Warning;
use crate::gpu::encoder::Encoder;
use crate::gpu::texture::Texture;
use crate::gpu::{Gpu, GpuError};
use crate::inject::{Injected, InjectedVisibility, upload};
use crate::maps::{FloatMap, Map};
use crate::passes::toy_mesh::ToyMesh;
use crate::pipeline::Passes;
use crate::plan::{LeftOut, Path, PlannedPass};
use crate::published::Published;
use crate::region::PixelRect;

/// A scene's textures and passes, and what was learned.
pub(crate) enum Work {
    /// The additive model of the receiver.
    Model(Box<(Capture, Passes)>),
    /// The published method.
    Published(Box<Published>),
}

impl Work {
    pub(crate) fn region(&self) -> PixelRect {
        match self {
            Self::Model(model) => model.0.plan.region,
            Self::Published(published) => published.plan.region,
        }
    }

    pub(crate) fn passes(&self) -> &[PlannedPass] {
        match self {
            Self::Model(model) => &model.0.plan.passes,
            Self::Published(published) => &published.plan.passes,
        }
    }

    pub(crate) fn left_out(&self) -> &[LeftOut] {
        match self {
            Self::Model(model) => &model.0.plan.left_out,
            Self::Published(published) => &published.plan.left_out,
        }
    }

    /// The region's picture.
    pub(crate) fn picture(&self) -> &Texture {
        match self {
            Self::Model(model) => &model.0.picture,
            Self::Published(published) => &published.picture,
        }
    }

    /// The model's capture, where the model is at work.
    pub(crate) fn capture(&self) -> Option<&Capture> {
        match self {
            Self::Model(model) => Some(&model.0),
            Self::Published(_) => None,
        }
    }

    /// Encodes the frame path, and before it what the news ask for.
    pub(crate) fn encode(
        &self,
        gpu: &Gpu,
        encoder: &mut Encoder,
        toy: &ToyMesh,
        pictures: &Pictures<'_>,
        news: News,
    ) {
        match self {
            Self::Model(model) => {
                let (capture, passes) = model.as_ref();
                encoder.path = Path::Capture;
                if news.is_place_new {
                    capture.encode(gpu, encoder, passes, toy, pictures);
                } else {
                    encoder.path = Path::Frame;
                }
                if news.is_place_new || news.is_image_new {
                    capture.encode_appearance(gpu, encoder, passes, pictures.frame);
                }
                encoder.path = Path::Frame;
                passes.encode_frame(gpu, encoder, capture, toy, pictures);
            }
            Self::Published(published) => {
                encoder.path = Path::Capture;
                if news.is_place_new {
                    published.encode_masks(gpu, encoder, toy);
                }
                encoder.path = Path::Frame;
                published.encode_frame(gpu, encoder, toy, pictures);
            }
        }
    }

    /// Replaces visibilities from the next frame on; see [`Core::inject_visibility`](crate::core::Core).
    pub(crate) fn inject(&mut self, gpu: &Gpu, maps: &InjectedVisibility) {
        let upload = |map: &Option<FloatMap>, like: &Texture| map.as_ref().map(|map| upload(gpu, map, like));
        match self {
            Self::Model(model) => {
                let capture = &mut model.0;
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
            Self::Model(model) => model.0.read_map(gpu, map),
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

/// What is new with a frame.
#[derive(Clone, Copy, Debug)]
pub(crate) struct News {
    /// Place, camera or clip: the capture path runs.
    pub(crate) is_place_new: bool,
    /// The camera's picture.
    pub(crate) is_image_new: bool,
}

impl News {
    /// Which of the planned passes run, all but `present`, and on which path.
    ///
    /// A new camera picture of a known place needs the toy's colours anew: then `appearance` is the frame's.
    pub(crate) fn runs(self, passes: &[PlannedPass]) -> impl Iterator<Item = (Path, &'static str)> + '_ {
        passes
            .iter()
            .filter(|pass| pass.name != "present")
            .filter_map(move |pass| {
                let is_frames = pass.path == Path::Frame || (pass.name == "appearance" && !self.is_place_new);
                let is_run = pass.path == Path::Frame
                    || self.is_place_new
                    || (pass.name == "appearance" && self.is_image_new);
                is_run.then_some((if is_frames { Path::Frame } else { Path::Capture }, pass.name))
            })
    }
}
