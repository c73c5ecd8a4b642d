//! The table of the shells' calls of their platforms, with the test status of each.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use anyhow::{Context, Result};

use super::imports::Imports;

const HEAD: &str = "\
# What the shells call of their platforms

Made by `cargo xtask calls`; a test compares it with the sources. Nothing here has run on a phone.

- **linked**: the name is resolved when the app is linked, against the list of imports.
- **emulated**: its calling convention ran in an emulator of the phone's processor, with a C function in its place.
- **faked**: the code around it runs in desktop tests, with a function of the same signature in its place.
- **untried**: compiled for the phone, and nothing more. A class stands for all messages to it that no other row names.
";

/// A source file of the shells, and the form of its calls.
struct Source {
    text: String,
    path: String,
}

/// The sources of a shell and of the packages beside it.
fn sources(shell: &Path, packages: [&str; 2]) -> Result<Vec<Source>> {
    let mut folders = vec![shell.join("src")];
    folders.extend(packages.map(|package| shell.join(package).join("src")));
    let mut sources = Vec::new();
    while let Some(folder) = folders.pop() {
        for path in fs::read_dir(&folder)?.flatten().map(|entry| entry.path()) {
            if path.is_dir() {
                folders.push(path);
            } else if !path.ends_with("tests.rs") {
                let text = fs::read_to_string(&path).with_context(|| path.display().to_string())?;
                let path = path.strip_prefix(shell)?.display().to_string();
                sources.push(Source { text, path });
            }
        }
    }
    sources.sort_by(|one, other| one.path.cmp(&other.path));
    Ok(sources)
}

/// Names that a file imports from packages whose names begin with `package`: classes, structs,
/// functions.
fn taken_from(text: &str, package: &str) -> Vec<String> {
    let taking = format!("use {package}");
    let uses = text.split(&taking).skip(1);
    let names = uses.filter_map(|rest| {
        let list = rest.split(';').next()?.split_once("::")?.1;
        let words = list.split(|letter: char| !(letter.is_alphanumeric() || letter == '_' || letter == ':'));
        Some(words.filter_map(|word| word.rsplit("::").next()))
    });
    names
        .flatten()
        .filter(|name| name.chars().next().is_some_and(char::is_uppercase))
        .map(str::to_owned)
        .collect()
}

/// The contents of the brackets after each `before`.
fn inside<'a>(text: &'a str, before: &'a str) -> impl Iterator<Item = &'a str> {
    text.split(before)
        .skip(1)
        .filter_map(|rest| rest.split([')', '(']).next())
}

/// The whole table.
pub(crate) fn table(root: &Path) -> Result<String> {
    let mut text = HEAD.to_owned();
    let (ios, android) = (root.join("app-ios"), root.join("app-android"));
    text.push_str("\n## iPhone\n");
    let mut calls = Calls::default();
    calls.linked(&Imports::read(&ios.join("imports.txt"), false)?);
    for source in sources(&ios, ["arkit", "media"])? {
        for selector in inside(&source.text, "selector(sel!(") {
            calls.add(
                "emulated",
                "messages through the shim for SIMD matrices",
                selector,
            );
        }
        for name in taken_from(&source.text, "objc2_") {
            calls.add(
                "untried",
                &format!("classes and functions in {}", source.path),
                &name,
            );
        }
        for message in source.text.split("msg_send![").skip(1) {
            let message = message.split(']').next().unwrap_or_default();
            let selector = message.split_once(',').map_or(message, |(_, selector)| selector);
            let selector = selector.split(':').next().unwrap_or_default().trim();
            calls.add(
                "untried",
                &format!("messages by name in {}", source.path),
                selector,
            );
        }
        for callback in inside(&source.text, "#[unsafe(method(") {
            calls.add("untried", &format!("callbacks in {}", source.path), callback);
        }
    }
    text.push_str(&calls.rows());
    text.push_str("\n## Android\n");
    let mut calls = Calls::default();
    calls.linked(&Imports::read(&android.join("imports.txt"), true)?);
    for source in sources(&android, ["arcore", "media"])? {
        if source.path.ends_with("arcore/src/ffi.rs") {
            for name in inside(&source.text, "    fn Ar") {
                calls.add(
                    "faked",
                    "libarcore_sdk_c.so, looked up while the app runs",
                    &format!("Ar{name}"),
                );
            }
        }
        for package in ["android_activity", "ndk", "jni"] {
            for name in taken_from(&source.text, package) {
                calls.add("untried", &format!("{package} in {}", source.path), &name);
            }
        }
    }
    text.push_str(&calls.rows());
    Ok(text)
}

/// Names by mark and place.
#[derive(Default)]
struct Calls(BTreeMap<(&'static str, String), Vec<String>>);

impl Calls {
    fn add(&mut self, mark: &'static str, place: &str, name: &str) {
        let names = self.0.entry((mark, place.to_owned())).or_default();
        if !names.iter().any(|other| other == name) {
            names.push(name.to_owned());
        }
    }

    fn linked(&mut self, imports: &Imports) {
        for (library, names) in imports.libraries() {
            // Other entries are values that are passed at run time.
            let is_library = library.starts_with('/') || library.ends_with(".so");
            let mark = if is_library { "linked" } else { "untried" };
            for name in names {
                self.add(mark, library, name);
            }
        }
    }

    fn rows(&self) -> String {
        let mut text = String::from("\n| mark | where | calls |\n| --- | --- | --- |\n");
        for ((mark, place), names) in &self.0 {
            let mut names: Vec<String> = names.iter().map(|name| format!("`{name}`")).collect();
            names.sort();
            // Writing to a string does not fail.
            let _ = writeln!(text, "| {mark} | {place} | {} |", names.join(" "));
        }
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_committed_table_is_that_of_the_sources() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
        let committed = fs::read_to_string(root.join("xtask/doc/calls.md")).expect("the table");
        let made = table(&root).expect("a table");
        assert!(
            committed == made,
            "run `cargo xtask calls` and look at what changed"
        );
    }

    #[test]
    fn calls_are_found_where_they_stand() {
        let names = taken_from(
            "use objc2_foo::{Bar, baz::Qux};\nuse other::No;\nuse objc2_x::FooGet;\n",
            "objc2_",
        );
        assert_eq!(names, ["Bar", "Qux", "FooGet"]);
        let selectors: Vec<&str> =
            inside("columns4(p, selector(sel!(transform))).0", "selector(sel!(").collect();
        assert_eq!(selectors, ["transform"]);
    }
}
