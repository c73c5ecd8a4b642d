//! Recordings of other programs as sessions: nerfstudio's `transforms.json`, Record3D, Stray Scanner, models of COLMAP, scenes of BOP.
//!
//! Source: docs.nerf.studio, «Data conventions»; strayrobots/scanner, `docs/format.md` and `OdometryEncoder.swift`;
//! Record3D's exported `metadata`; colmap.github.io, «Output Format»; bop_toolkit, `docs/bop_datasets_format.md`.

mod bop;
mod colmap;
mod depth;
mod error;
mod formats;
mod glb;
mod imported;
mod lens;
mod nerfstudio;
mod paths;
mod pictures;
mod ply;
mod record3d;
mod source;
mod stray_scanner;
mod values;
mod write;
mod write_nerfstudio;

pub use error::{ImportError, ImportReason};
pub use formats::{Format, parse, read};
pub use imported::{DepthEncoding, Imported, ImportedDepth, ImportedFrame};
pub use lens::Lens;
pub use ply::glb_of_ply;
pub use source::Source;
pub use write::{Lacking, PlateFrames, Written, write};
pub use write_nerfstudio::write_transforms;
