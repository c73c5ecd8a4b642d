//! The subject of the photographs: toy, receivers, lights, camera, sensor.

use app_core::scene::{Camera, Intrinsics, Light};
use glam::{DMat4, DQuat, DVec2, DVec3};

use super::lamp::Lamp;
use super::motion::{Key, Stance};
use super::paint::Paint;
use super::shape::Shape;

/// A toy on its receivers under lights, and the camera that looks at it.
#[derive(Clone, Debug)]
pub struct World {
    /// Name for people.
    pub name: String,
    /// Width and height of all pictures.
    pub size_px: [u32; 2],
    /// The camera of plate and frame.
    pub camera: Camera,
    /// Planes, the table first.
    pub grounds: Vec<Ground>,
    /// Lights, all of which the scene lists.
    pub lamps: Vec<Lamp>,
    /// Radiance of the uniform sky, linear: that of a white surface that sees nothing else.
    pub sky: DVec3,
    /// Whether surfaces illuminate each other, with one bounce.
    pub bounces: bool,
    /// The toy.
    pub parts: Vec<Part>,
    /// Gloss of the toy, if there is any.
    pub sheen: Option<Sheen>,
    /// Object space to world: a rotation, a translation and one positive scale.
    pub world_from_object: DMat4,
    /// The pose in the truth.
    pub shown: Shown,
    /// Properties of the camera's pictures.
    pub sensor: Sensor,
    /// Numbers of rays.
    pub quality: Quality,
}

/// Uniform gloss of a toy.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sheen {
    /// Slope of Beckmann's distribution of facets.
    pub roughness: f64,
    /// Reflectance over that of plastic.
    pub strength: f64,
}

/// A rectangle, local y = 0, that catches shadows.
#[derive(Clone, Debug)]
pub struct Ground {
    /// Pose, rigid.
    pub world_from_plane: DMat4,
    /// Half its sides along x and z.
    pub half_extent_m: DVec2,
    /// Its colours.
    pub paint: Paint,
}

/// A shape of the toy, which is a node of its file.
#[derive(Clone, Debug)]
pub struct Part {
    /// Its shape.
    pub shape: Shape,
    /// Reflectance, linear.
    pub color: DVec3,
    /// Its stance in the physical pose.
    pub rest: Stance,
    /// Its motion in the clip, in order of time; a part without keys stands still.
    pub keys: Vec<Key>,
}

/// A pose of the toy.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shown {
    /// The pose of the real toy.
    Rest,
    /// A moment of the clip.
    At {
        /// Since the clip began.
        time_secs: f64,
    },
}

/// Properties of the camera's pictures.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sensor {
    /// Exposure and white balance of the plate.
    pub plate_gain: DVec3,
    /// Exposure and white balance of frame and truth.
    pub frame_gain: DVec3,
    /// Standard deviation of the noise of plate and frame, in codes.
    pub noise_codes: f64,
    /// Seed of the noise.
    pub seed: u64,
}

/// Numbers of rays.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Quality {
    /// Rays through a pixel along each side.
    pub n_across: u32,
    /// Number of rays to each light from each intersection.
    pub n_light_rays: u32,
    /// Rays into the hemisphere.
    pub n_sky_rays: u32,
}

impl Default for Sensor {
    fn default() -> Self {
        Self {
            plate_gain: DVec3::ONE,
            frame_gain: DVec3::ONE,
            noise_codes: 0.0,
            seed: 1,
        }
    }
}

impl Default for Quality {
    fn default() -> Self {
        Self {
            n_across: 2,
            n_light_rays: 128,
            n_sky_rays: 64,
        }
    }
}

impl World {
    /// A box with an arm on a grey table, under a bulb at 50 degrees; within a second of its clip the box turns and the arm
    /// goes along and up.
    #[must_use]
    pub fn boxes() -> Self {
        let size_px = [256, 144];
        Self {
            name: "boxes".to_owned(),
            size_px,
            camera: camera(
                size_px,
                DVec3::new(0.06, 0.24, 0.36),
                DVec3::new(0.02, 0.04, 0.01),
            ),
            grounds: vec![Ground::table(Paint::Even(DVec3::new(0.40, 0.37, 0.33)))],
            lamps: vec![Lamp::bulb(toward(50.0, 30.0), 0.01, 0.75)],
            sky: DVec3::splat(0.35),
            bounces: true,
            parts: vec![body(), arm()],
            sheen: None,
            world_from_object: DMat4::IDENTITY,
            shown: Shown::At { time_secs: 1.0 },
            sensor: Sensor::default(),
            quality: Quality::default(),
        }
    }

    /// The same world in another size of picture, the camera's angles kept.
    #[must_use]
    pub fn resized(mut self, size_px: [u32; 2]) -> Self {
        let factor = f64::from(size_px[0]) / f64::from(self.size_px[0]);
        let old = self.camera.intrinsics;
        self.camera.intrinsics = Intrinsics {
            fx_px: factor * old.fx_px,
            fy_px: factor * old.fy_px,
            cx_px: factor * old.cx_px,
            cy_px: factor * old.cy_px,
        };
        self.size_px = size_px;
        self
    }

    /// The same world under other lights.
    #[must_use]
    pub fn lit_by(mut self, lamps: Vec<Lamp>) -> Self {
        self.lamps = lamps;
        self
    }

    /// The lights as a scene lists them.
    #[must_use]
    pub fn lights(&self) -> Vec<Light> {
        self.lamps.iter().map(|lamp| lamp.light).collect()
    }
}

impl Ground {
    /// A table of three metres at the world's origin.
    #[must_use]
    pub fn table(paint: Paint) -> Self {
        Self {
            world_from_plane: DMat4::IDENTITY,
            half_extent_m: DVec2::splat(1.5),
            paint,
        }
    }
}

/// Unit vector towards elevation and azimuth, degrees; azimuth 0 is +Z, 90 is +X.
#[must_use]
pub fn toward(elevation_deg: f64, azimuth_deg: f64) -> DVec3 {
    let (up, level) = elevation_deg.to_radians().sin_cos();
    let (x, z) = azimuth_deg.to_radians().sin_cos();
    DVec3::new(level * x, up, level * z)
}

/// A camera at `eye` that looks at `target`, upright, with a horizontal field of view of 58
/// degrees.
#[must_use]
pub fn camera(size_px: [u32; 2], eye: DVec3, target: DVec3) -> Camera {
    let backward = (eye - target).normalize();
    // A camera that looks straight down has the world's -Z on top.
    let right = DVec3::Y.cross(backward).try_normalize().unwrap_or(DVec3::X);
    let up = backward.cross(right);
    let [width, height] = size_px.map(f64::from);
    Camera {
        intrinsics: Intrinsics {
            fx_px: 0.9 * width,
            fy_px: 0.9 * width,
            cx_px: 0.5 * width,
            cy_px: 0.5 * height,
        },
        world_from_camera: DMat4::from_cols(
            right.extend(0.0),
            up.extend(0.0),
            backward.extend(0.0),
            eye.extend(1.0),
        ),
    }
}

fn body() -> Part {
    let rest = Stance::at(DVec3::new(0.0, 0.05, 0.0));
    let end = rest.turned(DQuat::from_rotation_y(35f64.to_radians()));
    Part {
        shape: Shape::cuboid(DVec3::new(0.03, 0.05, 0.02)),
        color: DVec3::new(0.60, 0.35, 0.25),
        rest,
        keys: keys(rest, end),
    }
}

fn arm() -> Part {
    let rest = Stance::at(DVec3::new(0.05, 0.085, 0.0));
    let turn = DQuat::from_rotation_y(35f64.to_radians()) * DQuat::from_rotation_z(20f64.to_radians());
    let end = Stance::at(DVec3::new(0.04, 0.085, -0.03)).turned(turn);
    Part {
        shape: Shape::cuboid(DVec3::new(0.03, 0.008, 0.01)),
        color: DVec3::new(0.60, 0.35, 0.25),
        rest,
        keys: keys(rest, end),
    }
}

/// From one stance to another within a second.
fn keys(from: Stance, to: Stance) -> Vec<Key> {
    let key = |time_secs, stance| Key { time_secs, stance };
    vec![key(0.0, from), key(1.0, to)]
}
