//! The passes once more: plain functions on the processor, in 64 bits, without anything of the graphics device.
//!
//! Each file is the CPU reference of the shader of its name. Here clarity comes first: a loop over pixels rather than a blend mode, a
//! ray against triangles rather than a flattened mesh, elimination with pivots rather than without.
//! What a scene fixes comes as arguments; what a shader fixes is read from that shader by [`shader_constant`].

pub mod appearance;
pub mod box_filter;
pub mod census;
pub mod composite;
pub mod detail;
pub mod eligible;
pub mod estimate;
pub mod fill;
pub mod fit;
pub mod grid;
pub mod least_squares;
pub mod lit;
pub mod model;
pub mod occlusion;
pub mod pcss;
pub mod plate;
pub mod raster;
pub mod residual;
pub mod retarget;
pub mod search;
pub mod self_shadow;
pub mod sets;
pub mod tint;
pub mod validity;
pub mod visibility;
pub mod withhold;

use std::str::FromStr;

use app_core::internals::shaders;
use thiserror::Error;

/// A constant that a shader does not declare as a plain number.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[error("shader {shader} declares no `const {name}` with a plain number")]
pub struct ConstantError {
    /// Name of the shader.
    pub shader: String,
    /// Name of the constant.
    pub name: String,
}

/// The value of `const name: … = number;` in the registry's `shader`, common parts included.
///
/// # Errors
/// When there is no such shader, no such constant, or its value is not a plain number.
pub fn shader_constant<T: FromStr>(shader: &str, name: &str) -> Result<T, ConstantError> {
    let head = format!("const {name}:");
    let number = |source: String| -> Option<T> {
        let declaration = source.lines().find_map(|line| line.strip_prefix(&head))?;
        let (_, value) = declaration.split_once('=')?;
        let (value, _) = value.split_once(';')?;
        value.trim().trim_end_matches(['u', 'i', 'f']).parse().ok()
    };
    shaders()
        .find(|candidate| candidate.name == shader)
        .and_then(|found| number(found.source()))
        .ok_or_else(|| ConstantError {
            shader: shader.to_owned(),
            name: name.to_owned(),
        })
}

/// Hermite step from 0 at `low` to 1 at `high`.
#[must_use]
pub fn smoothstep(low: f64, high: f64, x: f64) -> f64 {
    let t = ((x - low) / (high - low)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}
