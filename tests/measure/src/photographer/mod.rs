//! An analytic photographer: small worlds of convex shapes on planes, photographed by exact rays in
//! 64 bits.
//!
//! From a [`World`] it makes the parts of a session, in memory: the toy as a glTF binary, plate,
//! camera frame, and the photograph of the toy in its shown pose with the mask that scoring needs.
//! Light is direct light of spheres and directional lights, a uniform sky, and one diffuse bounce;
//! a toy may be glossy.
//! All is deterministic: rays follow fixed patterns, noise a fixed seed.

mod film;
pub mod folder;
mod lamp;
mod mirror;
mod motion;
mod paint;
mod rays;
pub mod shape;
mod sheen;
mod shot;
mod toy;
mod transform;
pub mod world;

pub use film::{Film, expose};
pub use lamp::Lamp;
pub use mirror::{Exposure, Ghost, Mirror};
pub use motion::{Key, Stance};
pub use paint::Paint;
pub use rays::Place;
pub use shape::Shape;
pub use shot::{Films, Photos, Shot};
pub use toy::{CLIP, STILL_CLIP, ToyFile, toy_glb};
pub use transform::flipped;
pub use world::{Ground, Part, Quality, Sensor, Sheen, Shown, World};
