//! The scene of a toy: all that stays the same for a whole session.
//!
//! World space is right-handed, +Y up, in metres. Camera space is +X right, +Y up and looks along
//! -Z.

pub mod check;
mod light;
mod light_estimate;
mod probe;
mod uncertainty;

use std::fmt;
use std::sync::Arc;

use glam::{DMat4, DVec2, DVec3};

use crate::place_mesh::PlaceMesh;
use crate::toy::Toy;

pub use crate::toy::Pose;
pub use check::{FieldError, InputError};
pub use light::Light;
pub use light_estimate::{LightEstimate, N_HARMONICS};
pub use probe::MAX_FURTHER_PICTURES;
pub use probe::{Facet, FacetSlope, MAX_FACETS, MAX_PROBE_PICTURES, Probe, ProbePicture, ProbeShape};
pub use uncertainty::{LightUncertainty, PoseUncertainty, Uncertainty};

/// Number of lights whose shadows are retargeted; shadows of further lights stay as photographed,
/// with a warning.
pub const MAX_LIGHTS: usize = 4;
/// Number of receivers on which shadows are retargeted; on further receivers they stay as
/// photographed, with a warning.
pub const MAX_RECEIVERS: usize = 4;

/// Largest number of a scene's plates. Each is kept in memory decoded, 4 bytes per pixel, and
/// compared with overlapping ones when the scene is set.
pub const MAX_SCENE_PLATES: usize = 512;

/// The inputs that precede the first frame: toy, receivers, lights, plates.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Scene {
    /// Name for people, or empty.
    pub name: String,
    /// Width of every camera picture of the session.
    pub width_px: u32,
    /// Height of every camera picture of the session.
    pub height_px: u32,
    /// The toy's model.
    pub toy: Arc<Toy>,
    /// Initial transform of the real toy; frames have their own. From the model's scene space to
    /// world: a rotation, a translation and one positive scale.
    pub world_from_object: DMat4,
    /// The pose of the real toy.
    pub physical_pose: Pose,
    /// Whether the real toy rests on the receiver below it. If `None`, alignment assumes that a toy
    /// close to a receiver rests there, unless the picture contradicts it.
    pub resting: Option<bool>,
    /// Planes that catch the shadow; at least one, in any order.
    pub receivers: Vec<Receiver>,
    /// Known lights, unless a frame has its own. If empty, alignment searches for them; if it finds
    /// none, the toy moves in ambient light.
    pub lights: Vec<Light>,
    /// Pictures of the scene without the toy: up to [`MAX_SCENE_PLATES`], or none.
    pub plates: Vec<Plate>,
    /// A light probe in the scene, if any: lights are estimated from it if none are listed.
    pub probe: Option<Probe>,
    /// A measured mesh of the place, if there is one. Only alignment uses it, to find planes on
    /// which things let the shadow fall.
    pub place_mesh: Option<PlaceMesh>,
    /// Uncertainty of camera, toy and lights.
    pub uncertainty: Uncertainty,
    /// All poses and places that frames will show, if known beforehand: learning then covers all of
    /// them from the first frame on, and no frame depends on those before it. Empty if unknown.
    pub film: Arc<[Shown]>,
}

/// A pose at a place.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Shown {
    /// The shown pose of the toy.
    pub pose: Pose,
    /// Its place, if it differs from the real toy's.
    pub world_from_shown: Option<DMat4>,
}

impl Scene {
    /// A scene without name, known lights, plates or probe, with the real toy in the authored pose.
    /// `size_px` is width, then height, of every camera picture.
    #[must_use]
    pub fn new(size_px: [u32; 2], toy: Arc<Toy>, world_from_object: DMat4, receivers: Vec<Receiver>) -> Self {
        let [width_px, height_px] = size_px;
        Self {
            name: String::new(),
            width_px,
            height_px,
            toy,
            world_from_object,
            physical_pose: Pose::default(),
            resting: None,
            receivers,
            lights: Vec::new(),
            plates: Vec::new(),
            probe: None,
            place_mesh: None,
            uncertainty: Uncertainty::default(),
            film: Arc::default(),
        }
    }

    /// Sets the name for people.
    #[must_use]
    pub fn with_name(mut self, name: impl Into<String>) -> Self {
        self.name = name.into();
        self
    }

    /// Sets the size of every camera picture: width, then height.
    #[must_use]
    pub fn with_size_px(mut self, size_px: [u32; 2]) -> Self {
        [self.width_px, self.height_px] = size_px;
        self
    }

    /// Sets the toy's model.
    #[must_use]
    pub fn with_toy(mut self, toy: Arc<Toy>) -> Self {
        self.toy = toy;
        self
    }

    /// Sets the initial transform of the real toy.
    #[must_use]
    pub fn with_world_from_object(mut self, world_from_object: DMat4) -> Self {
        self.world_from_object = world_from_object;
        self
    }

    /// Sets the pose of the real toy.
    #[must_use]
    pub fn with_physical_pose(mut self, pose: Pose) -> Self {
        self.physical_pose = pose;
        self
    }

    /// Sets whether the real toy rests on the receiver below it.
    #[must_use]
    pub fn with_resting(mut self, resting: Option<bool>) -> Self {
        self.resting = resting;
        self
    }

    /// Sets the known lights.
    #[must_use]
    pub fn with_lights(mut self, lights: Vec<Light>) -> Self {
        self.lights = lights;
        self
    }

    /// Sets the pictures of the scene without the toy.
    #[must_use]
    pub fn with_plates(mut self, plates: Vec<Plate>) -> Self {
        self.plates = plates;
        self
    }

    /// Sets the light probe in the scene.
    #[must_use]
    pub fn with_probe(mut self, probe: Option<Probe>) -> Self {
        self.probe = probe;
        self
    }

    /// Sets the measured mesh of the place.
    #[must_use]
    pub fn with_place_mesh(mut self, place_mesh: Option<PlaceMesh>) -> Self {
        self.place_mesh = place_mesh;
        self
    }

    /// Sets all poses and places that frames will show.
    #[must_use]
    pub fn with_film(mut self, film: impl Into<Arc<[Shown]>>) -> Self {
        self.film = film.into();
        self
    }

    /// Sets the uncertainty of camera, toy and lights.
    #[must_use]
    pub fn with_uncertainty(mut self, uncertainty: Uncertainty) -> Self {
        self.uncertainty = uncertainty;
        self
    }

    /// Validates the scene.
    pub fn check(&self) -> Result<(), InputError> {
        let similarity = check::similarity(self.world_from_object.to_cols_array());
        InputError::at("world_from_object", similarity)?;
        for (index, shown) in self.film.iter().enumerate() {
            let Some(world_from_shown) = &shown.world_from_shown else {
                continue;
            };
            let similarity = check::similarity(world_from_shown.to_cols_array());
            InputError::at(&format!("film[{index}].world_from_shown"), similarity)?;
        }
        let size = check::picture_size(self.width_px, self.height_px);
        InputError::at("width_px, height_px", size)?;
        if self.receivers.is_empty() {
            return InputError::at("receivers", Err(FieldError::Empty));
        }
        for (index, receiver) in self.receivers.iter().enumerate() {
            receiver.check(&format!("receivers[{index}]"))?;
        }
        for (index, light) in self.lights.iter().enumerate() {
            light.check(&format!("lights[{index}]"))?;
        }
        InputError::at("plates", check::at_most(self.plates.len(), MAX_SCENE_PLATES))?;
        for (index, plate) in self.plates.iter().enumerate() {
            check::camera(&format!("plates[{index}].camera"), &plate.camera)?;
        }
        self.uncertainty.check("uncertainty")?;
        self.probe.as_ref().map_or(Ok(()), |probe| probe.check("probe"))
    }
}

impl Receiver {
    fn check(&self, field: &str) -> Result<(), InputError> {
        let world_from_plane = check::rigid(self.world_from_plane.to_cols_array());
        InputError::at(&format!("{field}.world_from_plane"), world_from_plane)?;
        for extent_m in self.half_extent_m.to_array() {
            let extent_m = check::number(extent_m, &check::EXTENT_M);
            InputError::at(&format!("{field}.half_extent_m"), extent_m)?;
        }
        Ok(())
    }
}

/// Appearance of a receiver, which determines how its shadow is sampled.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Surface {
    /// Uniform colour.
    Uniform,
    /// Varying colour.
    Textured,
}

/// A rectangle that catches shadows: local y = 0 with its normal along local +Y.
#[derive(Clone, Debug, PartialEq)]
pub struct Receiver {
    /// Name for people.
    pub name: String,
    /// Rigid transform from the plane's space to world.
    pub world_from_plane: DMat4,
    /// The rectangle is `|x| <= half_extent_m.x`, `|z| <= half_extent_m.y`; both positive.
    pub half_extent_m: DVec2,
    /// Appearance of the receiver.
    pub surface: Surface,
}

/// Pinhole projection, in pixels of the picture.
///
/// Pixel (0, 0) is top left and its centre lies at (0.5, 0.5). The point (x, y, z) in camera
/// space lands at `u = cx_px + fx_px * x / -z`, `v = cy_px - fy_px * y / -z`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Intrinsics {
    /// Focal length along the picture's rows; positive.
    pub fx_px: f64,
    /// Focal length along the picture's columns; positive.
    pub fy_px: f64,
    /// Principal point, from the left border.
    pub cx_px: f64,
    /// Principal point, from the top border.
    pub cy_px: f64,
}

impl Intrinsics {
    /// The same projection for a picture `factor` times as large.
    pub fn scaled(&self, factor: f64) -> Self {
        Self {
            fx_px: factor * self.fx_px,
            fy_px: factor * self.fy_px,
            cx_px: factor * self.cx_px,
            cy_px: factor * self.cy_px,
        }
    }

    /// The ray through a pixel, in camera space: its point at a depth of 1.
    #[must_use]
    pub fn ray(&self, pixel: DVec2) -> DVec3 {
        DVec3::new(
            (pixel.x - self.cx_px) / self.fx_px,
            -(pixel.y - self.cy_px) / self.fy_px,
            -1.0,
        )
    }

    /// The image of a point in camera space, in pixels; `None` behind the camera.
    #[must_use]
    pub fn pixel_of(&self, point: DVec3) -> Option<DVec2> {
        let depth_m = -point.z;
        (depth_m > 0.0).then(|| {
            DVec2::new(
                self.cx_px + self.fx_px * point.x / depth_m,
                self.cy_px - self.fy_px * point.y / depth_m,
            )
        })
    }
}

/// A pinhole camera in the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// Its projection.
    pub intrinsics: Intrinsics,
    /// Rigid transform: the camera's pose.
    pub world_from_camera: DMat4,
}

impl Camera {
    /// The pixel that shows a point of the world; `None` for a point that is not before the camera.
    pub fn pixel_of(&self, point: DVec3) -> Option<DVec2> {
        let in_camera = self.world_from_camera.inverse().transform_point3(point);
        self.intrinsics.pixel_of(in_camera)
    }

    /// The same camera with its focal length multiplied by `ratio`.
    pub fn with_focal_length(&self, ratio: f64) -> Self {
        let intrinsics = Intrinsics {
            fx_px: ratio * self.intrinsics.fx_px,
            fy_px: ratio * self.intrinsics.fy_px,
            ..self.intrinsics
        };
        Self { intrinsics, ..*self }
    }
}

/// A picture: sRGB-encoded, 8 bit, four bytes per pixel, rows from the top without padding.
#[derive(Clone, PartialEq, Eq)]
pub struct Image {
    /// Pixels in a row; at least one.
    pub width_px: u32,
    /// Rows; at least one.
    pub height_px: u32,
    /// `width_px * height_px * 4` bytes. Alpha is 255 unless the picture documents another meaning.
    pub rgba8: Vec<u8>,
}

impl Image {
    /// Whether it has the given size, width first, and all of its bytes.
    pub fn is_of_size(&self, size_px: [u32; 2]) -> bool {
        let n_bytes = 4 * u64::from(self.width_px) * u64::from(self.height_px);
        [self.width_px, self.height_px] == size_px && self.rgba8.len() as u64 == n_bytes
    }
}

impl fmt::Debug for Image {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Image({} x {} px)", self.width_px, self.height_px)
    }
}

/// A picture of the scene without the toy.
#[derive(Clone, Debug)]
pub struct Plate {
    /// The camera of the picture.
    pub camera: Camera,
    /// The picture, of the session's size.
    pub image: Arc<Image>,
}
