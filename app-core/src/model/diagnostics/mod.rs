//! Diagnostics of the scene state: conditioning of the fits, what the pictures show, and outliers of the model.

pub(crate) mod conditioning;
pub(crate) mod evidence;
pub(crate) mod outliers;
