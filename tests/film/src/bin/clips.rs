//! A program for animators.

fn main() {}
