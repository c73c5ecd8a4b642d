//! Recordings: what they hold, what is left of damaged ones, and how they are written.

mod converted;
mod damage;
mod killed;
mod library;
mod limits;
mod rewritten;
mod small;
