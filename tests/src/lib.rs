//! What tests alone use: goldens and their comparison, fuzzing's functions, a recording without end.

pub mod compare;
pub mod endless;
pub mod fuzz;
pub mod golden;
pub mod session_format;
