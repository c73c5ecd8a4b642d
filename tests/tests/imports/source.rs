//! The modules of `app-core`, as text.

use std::fs;
use std::path::Path;

/// A file of the crate.
pub(crate) struct Module {
    /// Its path below `crate`, such as `model::plan`; empty for the root.
    pub(crate) path: String,
    pub(crate) text: String,
}

/// Every file below `app-core/src`.
pub(crate) fn core_modules() -> Vec<Module> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../app-core/src");
    let mut modules = Vec::new();
    collect(&root, "", &mut modules);
    assert!(modules.len() > 80, "only {} files are found", modules.len());
    modules
}

fn collect(folder: &Path, path: &str, modules: &mut Vec<Module>) {
    for entry in fs::read_dir(folder).unwrap() {
        let file = entry.unwrap().path();
        let name = file.file_stem().unwrap().to_str().unwrap();
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
