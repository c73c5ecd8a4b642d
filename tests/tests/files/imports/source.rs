//! The modules of a crate, as text.

use std::fs;
use std::path::Path;

/// A file of a crate.
pub(crate) struct Module {
    /// Path below `crate`, such as `model::plan`; empty for the root.
    pub(crate) path: String,
    pub(crate) text: String,
}

/// All files below `src` of a package, which is named by its folder.
pub(crate) fn modules(package: &str) -> Vec<Module> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("..")
        .join(package)
        .join("src");
    let mut modules = Vec::new();
    collect(&root, "", &mut modules);
    assert!(!modules.is_empty(), "{package} has no files");
    modules
}

fn collect(folder: &Path, path: &str, modules: &mut Vec<Module>) {
    for entry in fs::read_dir(folder).unwrap() {
        let file = entry.unwrap().path();
        let name = file.file_stem().unwrap().to_str().unwrap();
        // A program is a separate crate.
        if name == "bin" {
            continue;
        }
        let below = match (path, name) {
            ("", "lib") => String::new(),
            (_, "mod") => path.to_owned(),
            ("", _) => name.to_owned(),
            _ => format!("{path}::{name}"),
        };
        if file.is_dir() {
            collect(&file, &below, modules);
        } else if file.extension().is_some_and(|extension| extension == "rs") {
            modules.push(Module {
                path: below,
                text: fs::read_to_string(&file).unwrap(),
            });
        }
    }
}
