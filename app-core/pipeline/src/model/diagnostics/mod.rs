//! Diagnostics of the scene state: conditioning of the fits, what the pictures show, and outliers of the model.

pub mod conditioning;
pub(crate) mod evidence;
pub mod outliers;
