//! The lists of the shells' imports, and stub libraries made from them alone.
//!
//! With such a stub, a link fails at a name that no list has; nothing of Android's or Apple's is
//! needed for it, and its result is not for distribution.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use anyhow::{Context, Result, bail};

/// Names by their library, each with its API level.
#[derive(Debug, Default)]
pub(crate) struct Imports {
    by_library: BTreeMap<String, BTreeMap<String, u32>>,
}

impl Imports {
    /// Reads a list: on each line a library, a name and, for Android, the first API level with it.
    /// For an iPhone, a library without a name is loaded without imports.
    pub(crate) fn read(path: &Path, has_level: bool) -> Result<Self> {
        let text = fs::read_to_string(path).with_context(|| path.display().to_string())?;
        Self::parse(&text, has_level).with_context(|| path.display().to_string())
    }

    fn parse(text: &str, has_level: bool) -> Result<Self> {
        let mut imports = Self::default();
        for (index, line) in text.lines().enumerate() {
            if line.is_empty() || line.starts_with('#') {
                continue;
            }
            let words: Vec<&str> = line.split(' ').collect();
            let (library, name, level) = match words[..] {
                [library, name, level] if has_level => (library, name, level.parse().ok()),
                [library, name] if !has_level => (library, name, Some(0)),
                [library] if !has_level => {
                    imports.by_library.entry(library.to_owned()).or_default();
                    continue;
                }
                _ => bail!("line {}: {line:?} is no entry", index + 1),
            };
            let level = level.with_context(|| format!("line {}: no API level", index + 1))?;
            let names = imports.by_library.entry(library.to_owned()).or_default();
            if names.insert(name.to_owned(), level).is_some() {
                bail!("line {}: {name} is listed twice", index + 1);
            }
        }
        Ok(imports)
    }

    /// Libraries, each with its names.
    pub(crate) fn libraries(&self) -> impl Iterator<Item = (&str, Vec<&str>)> {
        self.by_library
            .iter()
            .map(|(library, names)| (library.as_str(), names.keys().map(String::as_str).collect()))
    }

    /// The API level that has every name.
    pub(crate) fn level(&self) -> u32 {
        let levels = self.by_library.values().flat_map(BTreeMap::values);
        levels.copied().max().unwrap_or_default()
    }

    /// Fails if the names that a file `asks` for differ from those listed for `libraries`.
    pub(crate) fn compare(&self, asks: &BTreeSet<String>, is_linked: impl Fn(&str) -> bool) -> Result<()> {
        let listed: BTreeSet<&str> = self
            .libraries()
            .filter(|(library, _)| is_linked(library))
            .flat_map(|(_, names)| names)
            .collect();
        let asks: BTreeSet<&str> = asks.iter().map(String::as_str).collect();
        let list = |names: BTreeSet<&str>| names.into_iter().collect::<Vec<_>>().join(", ");
        let (unlisted, unused) = (&asks - &listed, &listed - &asks);
        if !unlisted.is_empty() {
            bail!("not on the list of imports: {}", list(unlisted));
        }
        if !unused.is_empty() {
            bail!("on the list of imports, and not used: {}", list(unused));
        }
        Ok(())
    }
}

/// Assembly of a library with `names` and no code.
pub(crate) fn assembly(names: &[&str]) -> String {
    let mut text = String::from(".text\n");
    for name in names {
        // Writing to a string does not fail.
        let _ = writeln!(text, ".globl {name}\n{name}:");
    }
    text.push_str(".quad 0\n");
    text
}

/// A text stub, version 4, of the library installed at `path` with `names`.
pub(crate) fn text_stub(path: &str, names: &[&str]) -> String {
    let names = names.iter().map(|name| format!("'{name}'")).collect::<Vec<_>>();
    format!(
        "--- !tapi-tbd\ntbd-version: 4\ntargets: [ arm64-ios ]\ninstall-name: '{path}'\n\
         exports:\n  - targets: [ arm64-ios ]\n    symbols: [ {} ]\n...\n",
        names.join(", ")
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    const LIST: &str = "# words\nlibc.so abort 21\nlibm.so cos 21\nlibandroid.so ALooper_new 26\n";

    fn asks(names: &[&str]) -> BTreeSet<String> {
        names.iter().map(|name| (*name).to_owned()).collect()
    }

    #[test]
    fn names_that_are_not_listed_or_not_used_are_told() {
        let imports = Imports::parse(LIST, true).expect("a list");
        assert_eq!(imports.level(), 26);
        let compare = |names: &[&str]| {
            let compared = imports.compare(&asks(names), |library| library != "libm.so");
            compared.map_err(|error| error.to_string())
        };
        assert_eq!(compare(&["abort", "ALooper_new"]), Ok(()));
        let more = compare(&["abort", "ALooper_new", "system"]).expect_err("one too many");
        assert!(more.ends_with("system"), "{more}");
        let less = compare(&["abort"]).expect_err("one too few");
        assert!(less.ends_with("ALooper_new"), "{less}");
    }

    #[test]
    fn lines_that_are_no_entries_are_refused() {
        for wrong in [
            "libc.so abort",
            "libc.so abort one",
            "libc.so abort 21 22",
            "libc.so abort 21\nlibc.so abort 21",
        ] {
            assert!(Imports::parse(wrong, true).is_err(), "{wrong}");
        }
        assert!(Imports::parse("/usr/lib/libA.dylib _abort 21", false).is_err());
    }

    #[test]
    fn a_text_stub_has_names_of_objective_c() {
        let stub = text_stub("/usr/lib/libobjc.A.dylib", &["_OBJC_CLASS_$_NSObject"]);
        assert!(stub.contains("install-name: '/usr/lib/libobjc.A.dylib'"));
        assert!(stub.contains("[ '_OBJC_CLASS_$_NSObject' ]"));
    }
}
