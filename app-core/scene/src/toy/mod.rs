//! The toy: a glTF file as one posable mesh.
//!
//! [`Toy::from_glb`] reads a file once, checks everything in it, and lays out all data that does
//! not depend on the pose: triangles, materials, texture coordinates, and the same triangles as a
//! shape alone (`shadow_indices`), also with fewer of them (`casters`, `simplify`). [`Toy::pose`]
//! then moves the vertices: a clip's tracks (`clip`, `track`) or the caller set nodes and morph
//! weights (`rig`), the weights shape a surface (`geometry`), and its node or its skin's joints
//! carry it (`surface`, `skin`).
//!
//! Object space is the space of the glTF scene: right-handed, +Y up, in whatever unit the file was
//! made. [`Toy::displaced`] is the same toy with another shape in every pose. Extensions are
//! converted to plain glTF first (`mend`), or decoded (`meshopt`); triangles are cut along
//! materials' alpha cut-outs (`cut`), so that every pass sees the same shape. A toy opens no file
//! itself: [`packed`] makes one file of several, and pictures that are still outside are skipped
//! with a warning.

mod accessor;
mod assemble;
mod base64;
mod blend;
mod bounds;
mod casters;
mod check;
mod clip;
mod component;
mod container;
mod cut;
mod displaced;
mod error;
mod extensions;
mod foreign;
mod geometry;
mod graph;
mod instances;
mod limits;
mod material;
mod mend;
mod meshopt;
mod mirrored;
mod moment;
mod normal;
mod outward;
mod packed;
mod pieces;
mod pose;
mod rig;
mod shadow_indices;
mod simplify;
mod skin;
mod surface;
mod texture;
mod topology;
mod track;
mod uv_transform;
mod warning;
mod welded;

use std::fmt;
use std::sync::{Arc, OnceLock};

pub use bounds::Bounds;
pub use casters::Caster;
pub use clip::{Clip, ClipId};
pub use container::binary_gltf;
pub use error::{ToyError, ToyProblem};
pub use graph::Trs;
pub use limits::MAX_FILE_BYTES;
pub use material::{Material, MaterialTexture, Wrap};
pub use moment::{NodeId, NodePose, Pose};
pub use packed::packed;
pub use pose::PosedMesh;
pub use shadow_indices::ShadowIndices;
pub use surface::Part;
pub use texture::Texture;
pub use warning::ToyWarning;
pub use welded::Welded;

use geometry::Geometry;
use rig::Rig;
use surface::{Draws, Surface};

/// A toy's model: shape, appearance and animation from its file.
pub struct Toy {
    file: String,
    rig: Arc<Rig>,
    geometries: Vec<Geometry>,
    surfaces: Arc<[Surface]>,
    draws: Arc<Draws>,
    shadow_indices: Arc<ShadowIndices>,
    casters: OnceLock<Vec<Caster>>,
    /// Made when it is first asked for.
    welded: Arc<OnceLock<Welded>>,
    materials: Vec<Material>,
    textures: Arc<[Texture]>,
    warnings: Vec<ToyWarning>,
}

impl fmt::Debug for Toy {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (n_vertices, n_clips) = (self.n_vertices(), self.clips().len());
        write!(f, "Toy({:?}, {n_vertices} vertices, {n_clips} clips)", self.file)
    }
}

impl Toy {
    /// Reads a glTF 2.0 file, binary or as JSON with its data in it. `file` names it in messages.
    ///
    /// Only the default scene is drawn, or the first if there is no default. Unused vertices are
    /// dropped.
    ///
    /// # Errors
    /// [`ToyError::Malformed`] if the file violates glTF, if a number is not finite or too large,
    /// if a required extension is not supported, or if no triangle is left.
    pub fn from_glb(file: &str, bytes: &[u8]) -> Result<Self, ToyError> {
        assemble::assemble(file, bytes).map_err(|flaw| flaw.in_file(file))
    }

    /// The animation clips, in the order of the file.
    pub fn clips(&self) -> &[Clip] {
        &self.rig.clips
    }

    /// Names of the clips for the calls that take one, in the order of the file.
    pub fn clip_ids(&self) -> impl Iterator<Item = ClipId> + use<> {
        (0..self.clips().len()).map(ClipId)
    }

    /// Finds a clip by its name, or by `#N`, its number from 0. A name has priority over a number.
    ///
    /// # Errors
    /// [`ToyError::UnknownClip`], which lists the existing names; [`ToyError::BrokenClip`] for an
    /// unreadable one.
    pub fn find_clip(&self, name: &str) -> Result<ClipId, ToyError> {
        let by_name = || {
            self.clips()
                .iter()
                .position(|clip| clip.name.as_deref() == Some(name))
        };
        let by_number = || {
            name.strip_prefix('#')?
                .parse()
                .ok()
                .filter(|&number| number < self.clips().len())
        };
        let found = by_name()
            .or_else(by_number)
            .ok_or_else(|| ToyError::UnknownClip {
                file: self.file.clone(),
                name: name.to_owned(),
                known: self.clip_names(),
            })?;
        match &self.clips()[found].flaw {
            None => Ok(ClipId(found)),
            Some(reason) => Err(ToyError::BrokenClip {
                file: self.file.clone(),
                name: name.to_owned(),
                reason: reason.clone(),
            }),
        }
    }

    /// A name for each clip that [`Toy::find_clip`] accepts: `#N` for those without one.
    pub fn clip_names(&self) -> Vec<String> {
        let clips = self.clips().iter().enumerate();
        clips
            .map(|(i, clip)| clip.name.clone().unwrap_or_else(|| format!("#{i}")))
            .collect()
    }

    /// Clamps a time to a clip, and returns whether it was beyond its end.
    ///
    /// # Errors
    /// An id of another toy, or a time that is negative or not finite.
    pub fn clamp_time(&self, id: ClipId, time_secs: f64) -> Result<(f64, bool), ToyError> {
        let end_secs = self.clip(id)?.duration_secs;
        if !time_secs.is_finite() || time_secs < 0.0 {
            return Err(ToyError::Time {
                file: self.file.clone(),
                time_secs,
            });
        }
        Ok((time_secs.min(end_secs), time_secs > end_secs))
    }

    /// The materials that parts refer to.
    pub fn materials(&self) -> &[Material] {
        &self.materials
    }

    /// The textures that materials refer to.
    pub fn textures(&self) -> &[Texture] {
        &self.textures
    }

    /// The draws, which together cover all of [`Toy::indices`].
    pub fn parts(&self) -> &[Part] {
        &self.draws.parts
    }

    /// Corners of all triangles, counter-clockwise from outside; each below [`Toy::n_vertices`].
    pub fn indices(&self) -> &[u32] {
        &self.draws.indices
    }

    /// The same triangles for passes that need only positions.
    pub fn shadow_indices(&self) -> &ShadowIndices {
        &self.shadow_indices
    }

    /// Base colour texture coordinates, one for each vertex, v downwards; zero for a part without
    /// any.
    pub fn uvs(&self) -> &[[f32; 2]] {
        &self.draws.uvs
    }

    /// Linear RGBA, one for each vertex, white for a part without any; `None` if no part has any.
    pub fn colors_linear(&self) -> Option<&[[f32; 4]]> {
        (!self.draws.colors_linear.is_empty()).then_some(&self.draws.colors_linear)
    }

    /// Number of vertices; at least three.
    pub fn n_vertices(&self) -> usize {
        self.draws.uvs.len()
    }

    /// Features of the file that are not supported or were repaired.
    pub fn warnings(&self) -> &[ToyWarning] {
        &self.warnings
    }

    fn node(&self, id: NodeId) -> Result<&graph::Node, ToyError> {
        let nodes = &self.rig.graph.nodes;
        nodes.get(id.0).ok_or_else(|| ToyError::ForeignNode {
            file: self.file.clone(),
            node: id.0,
            n_nodes: nodes.len(),
        })
    }

    fn clip(&self, id: ClipId) -> Result<&Clip, ToyError> {
        let n_clips = self.clips().len();
        let foreign = || ToyError::ForeignClip {
            file: self.file.clone(),
            clip: id.0,
            n_clips,
        };
        self.clips().get(id.0).ok_or_else(foreign)
    }
}
