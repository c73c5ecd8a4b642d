//! The pictures that a page shows beside the results.

use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use app_core::scene::Image;

use crate::output::{WriteError, make_folder, write_png};

/// Writes pictures into one folder. One that is the same as the last of its name is not written again: what is learned
/// from the real shadow stays for many frames.
pub(crate) struct Pictures {
    root: PathBuf,
    folder: &'static str,
    latest: HashMap<&'static str, (Arc<Image>, String)>,
}

impl Pictures {
    /// Into `folder` below `root`; nothing is made yet.
    pub(crate) fn new(root: &Path, folder: &'static str) -> Self {
        Self {
            root: root.to_owned(),
            folder,
            latest: HashMap::new(),
        }
    }

    /// Writes the picture `name` of frame `index` and returns its path below the root.
    pub(crate) fn write(
        &mut self,
        name: &'static str,
        index: usize,
        image: Arc<Image>,
    ) -> Result<String, WriteError> {
        if let Some((latest, file)) = self.latest.get(name)
            && *latest == image
        {
            return Ok(file.clone());
        }
        make_folder(&self.root.join(self.folder))?;
        let file = format!("{}/{name}_{index:04}.png", self.folder);
        write_png(&self.root.join(&file), &image)?;
        self.latest.insert(name, (image, file.clone()));
        Ok(file)
    }
}
