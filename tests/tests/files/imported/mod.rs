//! Recordings of other programs: the known peculiarities of each format, one by one.

mod depths;
mod models;
mod phones;
mod pictures;
mod places;
mod small;
