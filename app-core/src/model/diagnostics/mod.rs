//! Diagnostics of the scene state: conditioning of the fits, and outliers of the model.

pub(crate) mod conditioning;
pub(crate) mod outliers;
