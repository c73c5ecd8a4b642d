//! Recordings of other programs: what each format is known to do otherwise, one by one.

mod models;
mod phones;
mod pictures;
mod places;
mod small;
