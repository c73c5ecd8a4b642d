//! WGSL files of a folder in place of the built-in ones, for development.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, ensure};
use app_core::Core;
use app_core::gpu::ShaderTexts;
use app_core::session::{Files, Folder};
use app_pipeline::shaders;

const ENDING: &str = ".wgsl";
const MAX_FILE_BYTES: u64 = 1 << 20;

/// The option that names a folder of shaders.
#[derive(Clone, Debug, clap::Args)]
pub struct ShaderArgs {
    /// Draw with the WGSL files of this folder, which has the layout of `shaders`, in place of the
    /// built-in ones
    #[arg(long = "shaders", value_name = "DIR")]
    folder: Option<PathBuf>,
}

impl ShaderArgs {
    /// The folder as one to watch.
    #[must_use]
    pub fn watched(self) -> Option<ShaderFolder> {
        self.folder.map(ShaderFolder::new)
    }

    /// Hands the files of the folder to a core; without a folder, the core keeps its own.
    ///
    /// # Errors
    /// As [`read_shaders`], or when the core's device refuses a shader.
    pub fn hand_to(&self, core: &mut Core) -> Result<()> {
        let Some(folder) = &self.folder else {
            return Ok(());
        };
        let given = read_shaders(folder).and_then(|texts| Ok(core.replace_shaders(texts)?));
        given.with_context(|| folder.display().to_string())
    }
}

/// A folder of shaders that is read repeatedly.
#[derive(Debug)]
pub struct ShaderFolder {
    path: PathBuf,
    /// The latest texts, or the latest error.
    latest: Option<Result<ShaderTexts, String>>,
}

impl ShaderFolder {
    /// A folder that has not been read yet.
    #[must_use]
    pub fn new(path: PathBuf) -> Self {
        Self { path, latest: None }
    }

    /// Its texts, or the error of reading them; `None` if nothing changed since the last call.
    ///
    /// All files are read: they are few and small, and modification times are unreliable.
    pub fn changed(&mut self) -> Option<Result<ShaderTexts, String>> {
        let read = read_shaders(&self.path);
        let read = read.map_err(|error| format!("{}: {error:#}", self.path.display()));
        (self.latest.as_ref() != Some(&read)).then(|| self.latest.insert(read).clone())
    }

    /// Makes the next call report a change.
    pub fn forget(&mut self) {
        self.latest = None;
    }
}

/// Reads the WGSL files of a folder that has the layout of `shaders`; hidden files, as editors make
/// them, are skipped.
///
/// # Errors
/// When folder or file cannot be read, a file is larger than 1 MiB or leads out of the folder, or
/// no file is a pass's.
pub fn read_shaders(folder: &Path) -> Result<ShaderTexts> {
    let files = Folder::open(folder)?;
    let mut texts = Vec::new();
    for group in names(folder)? {
        let within = folder.join(&group);
        if !within.is_dir() {
            continue;
        }
        for name in names(&within)? {
            if let Some(stem) = name.strip_suffix(ENDING) {
                let text = read_text(&files, &format!("{group}/{name}"))?;
                texts.push((format!("{group}/{stem}"), text));
            }
        }
    }
    let is_pass = |path: &str| shaders().any(|shader| shader.mirrors.path == path);
    ensure!(
        texts.iter().any(|(path, _)| is_pass(path)),
        "holds no shader, such as frame/composite{ENDING}"
    );
    Ok(texts.into_iter().collect())
}

fn read_text(files: &Folder, path: &str) -> Result<String> {
    let bytes = files
        .read(path, MAX_FILE_BYTES)
        .with_context(|| path.to_owned())?;
    String::from_utf8(bytes).with_context(|| path.to_owned())
}

/// Names of the entries of a folder that are not hidden.
fn names(folder: &Path) -> Result<Vec<String>> {
    let entries = fs::read_dir(folder)?.collect::<Result<Vec<_>, _>>()?;
    let names = entries
        .into_iter()
        .filter_map(|entry| entry.file_name().into_string().ok());
    Ok(names.filter(|name| !name.starts_with('.')).collect())
}
