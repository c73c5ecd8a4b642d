//! Pictures of a recording by the paths in its index, which may be another machine's.

use std::cmp::Ordering;
use std::collections::{HashMap, HashSet};

/// File name extensions that a path may lack.
const ENDINGS: [&str; 7] = ["", ".png", ".jpg", ".jpeg", ".PNG", ".JPG", ".JPEG"];
/// nerfstudio's folders of smaller pictures.
const SMALLER: [&str; 3] = ["images_2", "images_4", "images_8"];

/// The existing files.
pub(super) struct Known<'a>(HashSet<&'a str>);

impl<'a> Known<'a> {
    pub(super) fn new(paths: &'a [String]) -> Self {
        Self(paths.iter().map(String::as_str).collect())
    }

    pub(super) fn has(&self, path: &str) -> bool {
        self.0.contains(path)
    }

    /// The first candidate that exists.
    pub(super) fn first(&self, candidates: impl IntoIterator<Item = String>) -> Option<String> {
        candidates.into_iter().find(|path| self.has(path))
    }

    /// The picture of a path that may begin with folders of another machine, be written for
    /// Windows, or have no extension; in one of `folders` or above them.
    pub(super) fn picture(&self, stated: &str, folders: &[&str]) -> Option<String> {
        let parts = parts(stated);
        let tails = (0..parts.len()).map(|skipped| parts[skipped..].join("/"));
        tails.into_iter().find_map(|tail| {
            let below = folders.iter().map(|folder| format!("{folder}/{tail}"));
            let smaller = tail.strip_prefix("images/").into_iter();
            let smaller = smaller.flat_map(|name| SMALLER.map(|folder| format!("{folder}/{name}")));
            let places = std::iter::once(tail.clone()).chain(below).chain(smaller);
            let mut named = places.flat_map(|place| ENDINGS.map(|ending| format!("{place}{ending}")));
            named.find(|path| self.has(path))
        })
    }

    /// Numbers of the numbered pictures in a folder.
    fn numbers(&self, folder: &str) -> Vec<u64> {
        let names = self.0.iter().filter_map(|path| path.strip_prefix(folder));
        let stems = names.filter_map(|name| {
            let (stem, ending) = name.rsplit_once('.')?;
            ["png", "jpg", "jpeg"].contains(&ending).then_some(stem)
        });
        let mut numbers: Vec<u64> = stems.filter_map(|stem| stem.parse().ok()).collect();
        numbers.sort_unstable();
        numbers
    }

    /// The offset from a frame's number, counted from 0, to its picture's number in `folder`: 0, or
    /// 1 if a program like ffmpeg counted from 1. If it cannot be known, the pictures' first and
    /// last number.
    pub(super) fn first_number(
        &self,
        folder: &str,
        [first_frame, last_frame]: [u64; 2],
    ) -> Result<u64, [u64; 2]> {
        let numbers = self.numbers(folder);
        match (numbers.first(), numbers.last()) {
            (Some(1), Some(last)) if *last == last_frame + 1 => Ok(1),
            (Some(1), Some(last)) if first_frame == 0 => Err([1, *last]),
            _ => Ok(0),
        }
    }
}

/// Folders and name of a path of any system.
fn parts(path: &str) -> Vec<&str> {
    let mut parts = Vec::new();
    for part in path.split(['/', '\\']) {
        match part {
            "" | "." => {}
            ".." => {
                parts.pop();
            }
            part => parts.push(part),
        }
    }
    parts
}

/// Pictures that are in use, to find frames that name different pictures but lead to the same file.
pub(super) struct Taken<'a>(HashMap<String, &'a str>);

impl<'a> Taken<'a> {
    pub(super) fn new() -> Self {
        Self(HashMap::new())
    }

    /// Reserves a picture for a path of the index; false if another path led to it.
    pub(super) fn take(&mut self, picture: &str, stated: &'a str) -> bool {
        *self.0.entry(picture.to_owned()).or_insert(stated) == stated
    }
}

/// Natural order of names: 2 before 10.
pub(super) fn natural(a: &str, b: &str) -> Ordering {
    let [mut a_rest, mut b_rest] = [a, b];
    loop {
        let [(a_text, a_number, a_next), (b_text, b_number, b_next)] = [a_rest, b_rest].map(piece);
        let by_number = || {
            let [a, b] = [a_number, b_number].map(|number| number.trim_start_matches('0'));
            a.len().cmp(&b.len()).then_with(|| a.cmp(b))
        };
        let order = a_text.cmp(b_text).then_with(by_number);
        if order.is_ne() || (a_next.is_empty() && b_next.is_empty()) {
            return order.then_with(|| a.cmp(b));
        }
        [a_rest, b_rest] = [a_next, b_next];
    }
}

/// The text before the first number, the number, and the rest.
fn piece(text: &str) -> (&str, &str, &str) {
    let begin = text.find(|c: char| c.is_ascii_digit()).unwrap_or(text.len());
    let (before, rest) = text.split_at(begin);
    let end = rest.find(|c: char| !c.is_ascii_digit()).unwrap_or(rest.len());
    let (number, after) = rest.split_at(end);
    (before, number, after)
}
