//! The pictures of the place without the toy: which of them a view takes, on the device, and their exposures.

pub(crate) mod choice;
pub(crate) mod exposure;
mod sight;
pub(crate) mod store;
