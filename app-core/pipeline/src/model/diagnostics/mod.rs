//! Diagnostics of the scene state: conditioning of the fits, evidence in the pictures, and outliers
//! of the model.

pub mod conditioning;
pub(crate) mod evidence;
pub mod outliers;
