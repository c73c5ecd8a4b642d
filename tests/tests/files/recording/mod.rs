//! Recordings: their content, the readable part of damaged ones, and the writer.

mod converted;
mod damage;
mod depths;
mod killed;
mod library;
mod limits;
mod rewritten;
mod small;
