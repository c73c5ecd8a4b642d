//! The camera's picture on the device, in whichever form it came.
//!
//! A screen shows a picture's planes as they are. The method reads a picture's part in the work region, which is cut out of it;
//! only who reads the whole picture has all of it decoded.

use std::sync::OnceLock;

use glam::UVec2;
use wgpu::TextureFormat;

use crate::camera_frame::{CameraImage, PlanarImage, YcbcrEncoding};
use crate::geometry::rect::PixelRect;
use crate::gpu::context::Gpu;
use crate::gpu::recorder::Recorder;
use crate::gpu::texture::{Texture, TextureView};
use crate::passes::camera_planes::{self, Planes};
use crate::passes::finished::{Frame, FramePlanes, Picture};

pub(crate) struct CameraTexture {
    size_px: UVec2,
    /// The picture that is there.
    image: Option<CameraImage>,
    /// All of it: of a picture that came as one, and of one that somebody wanted as one.
    whole: OnceLock<SrgbTexture>,
    is_whole_there: bool,
    /// The part of it in a rectangle.
    cut: Option<SrgbTexture>,
    /// Where that is, once it is there.
    cut_rect: Option<PixelRect>,
    decoder: OnceLock<camera_planes::Pass>,
    /// Once planes have come as bytes.
    planes: Option<Planes>,
    /// The platform's planes, while they are those of the picture.
    lent: Option<[TextureView; 2]>,
}

/// A picture that is written as codes and read as light.
struct SrgbTexture {
    texture: Texture,
    /// View of its codes, not decoded.
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
            whole: OnceLock::new(),
            is_whole_there: false,
            cut: None,
            cut_rect: None,
            decoder: OnceLock::new(),
            planes: None,
            lent: None,
        }
    }

    /// Takes a picture as it comes, unless it is the one that is there already.
    pub(crate) fn take(&mut self, gpu: &Gpu, image: &CameraImage) {
        if self.image.as_ref().is_some_and(|known| known.is(image)) {
            return;
        }
        self.forget();
        match image {
            CameraImage::Rgba(image) => {
                self.whole(gpu).texture.write(gpu, &image.rgba8);
                self.is_whole_there = true;
            }
            CameraImage::Planes(image) => self.take_planes(gpu, image),
        }
        self.image = Some(image.clone());
    }

    fn take_planes(&mut self, gpu: &Gpu, image: &PlanarImage) {
        let opened = gpu.opened.as_ref();
        let lent = opened.and_then(|opened| image.textures_on(&opened.device.handle()));
        self.lent = lent.map(|textures| textures.map(|texture| TextureView::of_other(gpu, texture)));
        if self.lent.is_none() {
            self.planes
                .get_or_insert_with(|| Planes::new(gpu, image.size_px()))
                .write(gpu, image);
        }
    }

    /// Takes what is there for unknown.
    pub(crate) fn forget(&mut self) {
        self.image = None;
        self.is_whole_there = false;
        self.cut_rect = None;
        self.lent = None;
    }

    /// The picture as a screen takes it.
    pub(crate) fn frame(&self, gpu: &Gpu) -> Frame<'_> {
        match self.planes_with_encoding() {
            Some((views, encoding)) => Frame::Planes(FramePlanes { views, encoding }),
            None => Frame::Picture(self.whole(gpu).picture()),
        }
    }

    /// All of it, decoded.
    pub(crate) fn decoded(&self, recorder: &mut Recorder<'_>) -> Picture<'_> {
        let whole = self.whole(recorder.gpu);
        if !self.is_whole_there {
            self.decode(recorder, (&whole.codes, UVec2::ZERO));
        }
        whole.picture()
    }

    /// The same for who reads it over several frames: decoded once.
    pub(crate) fn keep_decoded(&mut self, recorder: &mut Recorder<'_>) -> &TextureView {
        self.decoded(recorder);
        self.is_whole_there = true;
        &self.whole(recorder.gpu).texture.view
    }

    /// Cuts out the part in `rect`, unless that is there already.
    pub(crate) fn cut(&mut self, recorder: &mut Recorder<'_>, rect: PixelRect) {
        if self.cut_rect == Some(rect) {
            return;
        }
        let known = self.cut.take();
        let known = known.filter(|cut| cut.texture.size_px() == rect.size_px);
        let cut = known.unwrap_or_else(|| SrgbTexture::new(recorder.gpu, rect.size_px));
        match &self.image {
            Some(CameraImage::Rgba(image)) => {
                let from = (rect.origin_px, image.width_px);
                cut.texture.write_part_of(recorder.gpu, &image.rgba8, from);
            }
            _ => self.decode(recorder, (&cut.codes, rect.origin_px)),
        }
        self.cut = Some(cut);
        self.cut_rect = Some(rect);
    }

    /// View of that part, decoded where it is read; of the whole picture before the first cut.
    pub(crate) fn cut_view(&self, gpu: &Gpu) -> &TextureView {
        let texture = self.cut.as_ref().unwrap_or_else(|| self.whole(gpu));
        &texture.texture.view
    }

    /// That part, once it was cut out.
    pub(crate) fn cut_texture(&self) -> Option<&Texture> {
        self.cut.as_ref().map(|cut| &cut.texture)
    }

    fn whole(&self, gpu: &Gpu) -> &SrgbTexture {
        self.whole.get_or_init(|| SrgbTexture::new(gpu, self.size_px))
    }

    fn planes_with_encoding(&self) -> Option<([&TextureView; 2], YcbcrEncoding)> {
        let Some(CameraImage::Planes(image)) = &self.image else {
            return None;
        };
        let own = || self.planes.as_ref().map(Planes::views);
        let lent = self.lent.as_ref().map(|[luma, chroma]| [luma, chroma]);
        Some((lent.or_else(own)?, image.encoding()))
    }

    /// Decodes as much of the planes as a target holds, from a corner on.
    fn decode(&self, recorder: &mut Recorder<'_>, (codes, corner_px): (&TextureView, UVec2)) {
        if let Some((planes, encoding)) = self.planes_with_encoding() {
            let pass = self
                .decoder
                .get_or_init(|| camera_planes::Pass::new(recorder.gpu));
            pass.encode(recorder, encoding, planes, (codes, corner_px));
        }
    }
}
