//! The camera's picture on the device, in its original form.
//!
//! Planes are read directly by the screen and by the model; only a reader that filters light of the
//! whole picture has all of it decoded.

use std::sync::OnceLock;

use glam::UVec2;
use wgpu::TextureFormat;

use crate::gpu::{Gpu, LentTextures, Recorder, Texture, TextureView};
use crate::passes::camera_planes;
use crate::passes::camera_planes::Planes;
use crate::passes::pictures::{Frame, FramePlanes, Picture};
use app_scene::camera_frame::{CameraImage, PlanarImage};

pub(crate) struct CameraTexture {
    size_px: UVec2,
    /// The picture on the device.
    image: Option<CameraImage>,
    /// Whether all of it is there; a refused frame may have left it incomplete.
    is_certain: bool,
    /// The whole picture: one that came as pixels, or one that was decoded on request.
    whole: OnceLock<SrgbTexture>,
    is_whole_there: bool,
    decoder: OnceLock<camera_planes::Pass>,
    /// Own textures for planes, once planes have come as bytes.
    own_planes: Option<Planes>,
    /// Whether they were made for this picture.
    are_planes_new: bool,
    /// The platform's planes, as long as they are those of the picture.
    lent: Option<[TextureView; 2]>,
}

/// A picture that is written as codes and read as light.
struct SrgbTexture {
    texture: Texture,
    /// View of the picture's codes, which does not decode them.
    codes: TextureView,
}

impl SrgbTexture {
    fn new(gpu: &Gpu, size_px: UVec2) -> Self {
        let texture = Texture::target(gpu, "frame", size_px, TextureFormat::Rgba8UnormSrgb);
        Self {
            codes: texture.codes(gpu),
            texture,
        }
    }

    fn picture(&self) -> Picture<'_> {
        Picture {
            light: &self.texture.view,
            codes: &self.codes,
        }
    }
}

impl CameraTexture {
    pub(crate) fn new(size_px: UVec2) -> Self {
        Self {
            size_px,
            image: None,
            is_certain: false,
            whole: OnceLock::new(),
            is_whole_there: false,
            decoder: OnceLock::new(),
            own_planes: None,
            are_planes_new: false,
            lent: None,
        }
    }

    /// Uploads a picture in its original form, unless it is already there.
    pub(crate) fn take(&mut self, gpu: &Gpu, image: &CameraImage) {
        if self.is_certain && self.image.as_ref().is_some_and(|known| known.is(image)) {
            return;
        }
        self.is_whole_there = false;
        self.are_planes_new = false;
        self.lent = None;
        match image {
            CameraImage::Rgba(image) => {
                self.whole(gpu).texture.write(gpu, &image.rgba8);
                self.is_whole_there = true;
            }
            CameraImage::Planes(image) => self.take_planes(gpu, image),
        }
        self.image = Some(image.clone());
        self.is_certain = true;
    }

    fn take_planes(&mut self, gpu: &Gpu, image: &PlanarImage) {
        let opened = gpu.opened.as_ref();
        let lent = opened.and_then(|opened| LentTextures::on(image, &opened.device.handle()));
        self.lent = lent.map(|textures| textures.map(|texture| TextureView::of_other(gpu, texture)));
        if self.lent.is_none() {
            self.are_planes_new = self.own_planes.is_none();
            self.own_planes
                .get_or_insert_with(|| Planes::new(gpu, image.size_px()))
                .write(gpu, image);
        }
    }

    /// Has the next picture uploaded in any case, after refused work. Until then the picture is shown
    /// as far as it is there; black instead, if the refusal may be that of its textures.
    pub(crate) fn forget(&mut self) {
        self.is_certain = false;
        self.is_whole_there = false;
        if matches!(self.image, Some(CameraImage::Planes(_))) {
            // An older picture may be in it.
            self.whole = OnceLock::new();
        }
        if self.are_planes_new {
            self.own_planes = None;
        }
        if self.lent.take().is_some() {
            self.image = None;
        }
    }

    /// The picture in its original form.
    pub(crate) fn frame(&self, gpu: &Gpu) -> Frame<'_> {
        match self.planes() {
            Some(planes) => Frame::Planes(planes),
            None => Frame::Picture(self.whole(gpu).picture()),
        }
    }

    /// The whole picture, decoded.
    pub(crate) fn decoded(&self, recorder: &mut Recorder<'_>) -> Picture<'_> {
        let whole = self.whole(recorder.gpu);
        if !self.is_whole_there {
            self.decode(recorder, &whole.codes);
        }
        whole.picture()
    }

    /// The same for a reader over several frames: decoded once.
    pub(crate) fn keep_decoded(&mut self, recorder: &mut Recorder<'_>) -> Picture<'_> {
        self.decoded(recorder);
        self.is_whole_there = true;
        self.whole(recorder.gpu).picture()
    }

    fn whole(&self, gpu: &Gpu) -> &SrgbTexture {
        self.whole.get_or_init(|| SrgbTexture::new(gpu, self.size_px))
    }

    fn planes(&self) -> Option<FramePlanes<'_>> {
        let Some(CameraImage::Planes(image)) = &self.image else {
            return None;
        };
        let own = || self.own_planes.as_ref().map(Planes::views);
        let lent = self.lent.as_ref().map(|[luma, chroma]| [luma, chroma]);
        Some(FramePlanes {
            views: lent.or_else(own)?,
            encoding: image.encoding(),
        })
    }

    fn decode(&self, recorder: &mut Recorder<'_>, codes: &TextureView) {
        if let Some(planes) = self.planes() {
            let pass = self
                .decoder
                .get_or_init(|| camera_planes::Pass::new(recorder.gpu));
            pass.encode(recorder, &planes, codes);
        }
    }
}
