//! The camera's picture, in either format.

use std::fmt;
use std::sync::Arc;

use super::planar_image::PlanarImage;
use super::planes::half_size_px;
use crate::scene::Image;

/// A camera's picture. Two are identical if they share their memory: results computed for a picture
/// are then reused.
#[derive(Clone)]
pub enum CameraImage {
    /// sRGB codes, as in recorded sessions.
    Rgba(Arc<Image>),
    /// Luma and chroma, as phones deliver them; decoded on the device.
    Planes(Arc<PlanarImage>),
}

impl CameraImage {
    /// Width and height.
    #[must_use]
    pub fn size_px(&self) -> [u32; 2] {
        match self {
            Self::Rgba(image) => [image.width_px, image.height_px],
            Self::Planes(image) => image.size_px(),
        }
    }

    /// The picture as sRGB codes; planes are decoded at the first call.
    #[must_use]
    pub fn rgba(&self) -> &Arc<Image> {
        match self {
            Self::Rgba(image) => image,
            Self::Planes(image) => image.rgba(),
        }
    }

    /// A copy with its own bytes, for callers that keep several pictures: a platform lends only
    /// few.
    #[must_use]
    pub fn kept(&self) -> Self {
        match self {
            Self::Planes(image) => image.kept().map_or_else(|| self.clone(), Self::from),
            Self::Rgba(_) => self.clone(),
        }
    }

    /// Whether both share their memory.
    pub fn is(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Rgba(one), Self::Rgba(other)) => Arc::ptr_eq(one, other),
            (Self::Planes(one), Self::Planes(other)) => Arc::ptr_eq(one, other),
            _ => false,
        }
    }

    /// Number of bytes in memory.
    pub fn n_bytes(&self) -> usize {
        match self {
            Self::Rgba(image) => image.rgba8.len(),
            Self::Planes(image) => {
                let n_pixels = |[columns, rows]: [u32; 2]| columns as usize * rows as usize;
                n_pixels(image.size_px()) + 2 * n_pixels(half_size_px(image.size_px()))
            }
        }
    }

    /// Whether it has the given size, and all of its bytes.
    pub fn is_of_size(&self, size_px: [u32; 2]) -> bool {
        match self {
            Self::Rgba(image) => image.is_of_size(size_px),
            Self::Planes(image) => image.size_px() == size_px,
        }
    }
}

impl From<Arc<Image>> for CameraImage {
    fn from(image: Arc<Image>) -> Self {
        Self::Rgba(image)
    }
}

impl From<Image> for CameraImage {
    fn from(image: Image) -> Self {
        Self::Rgba(Arc::new(image))
    }
}

impl From<PlanarImage> for CameraImage {
    fn from(image: PlanarImage) -> Self {
        Self::Planes(Arc::new(image))
    }
}

impl fmt::Debug for CameraImage {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [width, height] = self.size_px();
        let form = match self {
            Self::Rgba(_) => "sRGB",
            Self::Planes(_) => "planes",
        };
        write!(f, "CameraImage({width} x {height} px, {form})")
    }
}
