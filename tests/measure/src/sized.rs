//! A session's scene and frames in pictures of another size: their cost depends on it, their
//! content does not.

use std::sync::Arc;

use app_core::camera_frame::CameraImage;
use app_core::frame::FrameInput;
use app_core::scene::{Camera, Image, Intrinsics, Plate, Scene};

/// Width and height.
pub type SizePx = [u32; 2];

/// Parses `1280x720`.
///
/// # Errors
/// When it is invalid, or a side is not from 1 to 8192.
pub fn parse_size(text: &str) -> Result<SizePx, String> {
    let side = |side: &str| side.parse().ok().filter(|side| (1..=8192).contains(side));
    let (width, height) = text.split_once('x').ok_or("WIDTHxHEIGHT, such as 1280x720")?;
    let both = side(width).zip(side(height));
    both.map(|(width, height)| [width, height])
        .ok_or_else(|| format!("{text}: both sides are from 1 to 8192 px"))
}

/// The transform that fills the other size, like a screen: pictures are scaled uniformly, and
/// cropped equally on both sides.
#[derive(Clone, Copy, Debug)]
struct Filling {
    scale: f64,
    /// Width of the crop on each side, in pixels of the larger picture.
    cut_px: [f64; 2],
    to_px: SizePx,
}

impl Filling {
    fn new(from_px: SizePx, to_px: SizePx) -> Self {
        let ratio = |axis: usize| f64::from(to_px[axis]) / f64::from(from_px[axis]);
        let scale = ratio(0).max(ratio(1));
        let cut = |axis: usize| 0.5 * (scale * f64::from(from_px[axis]) - f64::from(to_px[axis]));
        Self {
            scale,
            cut_px: [cut(0), cut(1)],
            to_px,
        }
    }

    fn camera(&self, camera: &Camera) -> Camera {
        let given = &camera.intrinsics;
        Camera {
            intrinsics: Intrinsics {
                fx_px: self.scale * given.fx_px,
                fy_px: self.scale * given.fy_px,
                cx_px: self.scale * given.cx_px - self.cut_px[0],
                cy_px: self.scale * given.cy_px - self.cut_px[1],
            },
            ..*camera
        }
    }

    /// Nearest-neighbour resampling.
    #[allow(clippy::cast_possible_truncation, reason = "within the picture")]
    fn image(&self, image: &Image) -> Image {
        let nearest = |at: u32, axis: usize, most: u32| {
            let from = (f64::from(at) + 0.5 + self.cut_px[axis]) / self.scale;
            (from as u32).min(most - 1)
        };
        let columns: Vec<usize> = (0..self.to_px[0])
            .map(|x| nearest(x, 0, image.width_px) as usize)
            .collect();
        let row = |y: u32| {
            let first = nearest(y, 1, image.height_px) as usize * image.width_px as usize;
            columns.iter().map(move |column| 4 * (first + column))
        };
        let texels = (0..self.to_px[1]).flat_map(row);
        Image {
            width_px: self.to_px[0],
            height_px: self.to_px[1],
            rgba8: texels.flat_map(|at| &image.rgba8[at..at + 4]).copied().collect(),
        }
    }
}

/// A scene in pictures of `size_px`.
#[must_use]
pub fn sized_scene(scene: &Scene, size_px: SizePx) -> Scene {
    let filling = Filling::new([scene.width_px, scene.height_px], size_px);
    let plate = |plate: &Plate| Plate {
        camera: filling.camera(&plate.camera),
        image: Arc::new(filling.image(&plate.image)),
    };
    scene
        .clone()
        .with_size_px(size_px)
        .with_plates(scene.plates.iter().map(plate).collect())
}

/// A frame in a picture of `size_px`, without depths and the mask of people, which are of the
/// picture's shape.
#[must_use]
pub fn sized_input(input: &FrameInput, size_px: SizePx) -> FrameInput {
    let filling = Filling::new(input.image.size_px(), size_px);
    input
        .clone()
        .with_image(CameraImage::from(filling.image(input.image.rgba())))
        .with_camera(filling.camera(&input.camera))
        .with_depth(None)
        .with_people(None)
}
