//! Formatting of every source file, including modules that a macro declares, which `cargo fmt` does
//! not find.

use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result};

use crate::toolchain::Toolchain;

/// Folders of the workspace's members.
const FOLDERS: [&str; 5] = ["app-core", "app-ios", "app-android", "tests", "xtask"];

/// Rewrites every source file, or with `--check` only lists those that it would.
pub(crate) fn rustfmt(toolchain: &Toolchain, args: &[&str]) -> Result<Command> {
    let mut rustfmt = toolchain.command("rustfmt");
    rustfmt.args(["--edition", toolchain.edition.as_str()]).args(args);
    for folder in FOLDERS {
        rustfmt.args(sources(&toolchain.root.join(folder))?);
    }
    Ok(rustfmt)
}

/// Build outputs, such as those of the fuzz targets, are no sources.
const BUILD: &str = "target";

/// All Rust files in a folder and those below it, in a stable order.
fn sources(folder: &Path) -> Result<Vec<PathBuf>> {
    let mut found = Vec::new();
    for entry in folder.read_dir().with_context(|| folder.display().to_string())? {
        let path = entry.with_context(|| folder.display().to_string())?.path();
        if path.is_dir() {
            if path.ends_with(BUILD) {
                continue;
            }
            found.extend(sources(&path)?);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            found.push(path);
        }
    }
    found.sort();
    Ok(found)
}
