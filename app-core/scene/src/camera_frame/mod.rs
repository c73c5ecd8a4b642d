//! A camera frame as phones deliver it: planes of luma and chroma, time, and presentation.

mod arrival;
mod display;
mod encoding;
mod fade;
mod frame;
mod image;
mod planar_image;
mod planes;

pub use arrival::{Arrival, Arrivals, LONGEST_GAP_S, Stamp};
pub use display::{Display, Fit};
pub use encoding::{CodeRange, LumaCoefficients, YcbcrEncoding};
pub use fade::Fade;
pub use frame::{Anchor, CameraFrame, Exposure, FoundPlane, Tracking};
pub use image::CameraImage;
pub use planar_image::{LentPlanes, PlanarImage};
pub use planes::{Plane, PlaneError, Planes, half_size_px};
