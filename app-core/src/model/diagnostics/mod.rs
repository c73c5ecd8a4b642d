//! What the scene state tells of itself: how far it is constrained, and what the model cannot explain.

pub(crate) mod conditioning;
pub(crate) mod outliers;
