//! The unknowns of the light on a toy.

use app_scene::scene::MAX_LIGHTS;
use nalgebra::SVector;

/// Ambient light from above and from below, and each lamp.
pub(super) const N_COLUMNS: usize = 2 + MAX_LIGHTS;
/// One value for each unknown.
pub(super) type Columns = SVector<f64, N_COLUMNS>;
