//! The unknown to estimate, and a plate and a frame with one value of it.

use std::sync::Arc;

use app_scene::frame::FrameInput;
use app_scene::lens::{Distortion, Lens};
use app_scene::scene::{Camera, Image, Plate};

/// The unknown to estimate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Unknown {
    FocalLength,
    WorldScale,
    /// A lens of a family.
    Lens(Bend),
}

/// A one-parameter family of lenses: a distortion and its direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Bend {
    pub(super) from: Distortion,
    /// The distortion that is 1 at the farthest corner.
    pub(super) by: Distortion,
}

impl Bend {
    pub(super) fn at(self, at: f64) -> Distortion {
        Distortion {
            k1: at.mul_add(self.by.k1, self.from.k1),
            k2: at.mul_add(self.by.k2, self.from.k2),
        }
    }

    /// A photograph undistorted to a pinhole's; `None` if the lens folds it.
    fn pinhole(self, at: f64, camera: &Camera, image: &Arc<Image>) -> Option<Arc<Image>> {
        let distortion = self.at(at);
        if distortion == Distortion::NONE {
            return Some(Arc::clone(image));
        }
        let size_px = [image.width_px, image.height_px];
        let lens = Lens::new(distortion, &camera.intrinsics, size_px).ok()?;
        Some(Arc::new(lens.to_pinhole(image)))
    }
}

/// A plate and a frame with a number.
pub(super) struct Taken {
    pub(super) plate: Plate,
    pub(super) frame: FrameInput,
}

impl Unknown {
    /// A plate and a frame with a number; `None` if a lens folds them.
    pub(super) fn taken(self, at: f64, plate: &Plate, frame: &FrameInput) -> Option<Taken> {
        let (mut plate, mut frame) = (plate.clone(), frame.clone());
        match self {
            Self::FocalLength => {
                plate.camera = plate.camera.with_focal_length(at.exp());
                frame.camera = frame.camera.with_focal_length(at.exp());
            }
            Self::WorldScale => {}
            Self::Lens(bend) => {
                plate.image = bend.pinhole(at, &plate.camera, &plate.image)?;
                frame.image = bend.pinhole(at, &frame.camera, frame.image.rgba())?.into();
            }
        }
        Some(Taken { plate, frame })
    }
}
