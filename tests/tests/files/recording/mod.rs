//! Recordings: their content, the readable part of damaged ones, and the writer.

mod converted;
mod damage;
mod killed;
mod library;
mod limits;
mod maps;
mod rewritten;
mod small;
