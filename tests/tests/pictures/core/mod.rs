//! The core as a shell uses it, on the bundled session.

pub(crate) mod bundled;
mod camera;
mod coplanar;
mod file;
mod layers;
mod lent;
mod normals;
mod people;
mod quirks;
mod refused;
mod reuse;
mod scale;
mod shaders;
mod shadow_style;
mod shown;
mod still;
mod things;
mod warnings;
