//! Photos and videos that the platform's gallery has not been given yet.
//!
//! The platform copies them while pictures are drawn. A video that ends as the app is left is whole
//! only in the background, where the app may be ended: its name is kept for the next start.

use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use crate::folders::Folders;
use crate::kept;
use crate::record::shown_name;

const FILE: &str = "gallery.txt";

/// The list of these files, which threads share; without a folder it ends with the app.
#[derive(Clone, Debug)]
pub(crate) struct Gallery {
    own: Option<PathBuf>,
    waiting: Arc<Mutex<Vec<PathBuf>>>,
}

impl Gallery {
    /// The list of the last start, without files that no longer exist.
    pub(crate) fn kept_in(folders: &Folders) -> Self {
        let text = folders.own.as_deref().and_then(|own| kept::text(own, FILE));
        let text = text.unwrap_or_default();
        // Names only: an update moves the folders of an iPhone's app.
        let shared = folders.shared.as_deref().unwrap_or(Path::new(""));
        let waiting = text.lines().map(|name| shared.join(name));
        Self {
            own: folders.own.clone(),
            waiting: Arc::new(Mutex::new(waiting.filter(|file| file.is_file()).collect())),
        }
    }

    /// The files that wait.
    pub(crate) fn waiting(&self) -> Vec<PathBuf> {
        self.locked().clone()
    }

    /// Adds a file that is whole.
    pub(crate) fn add(&self, file: &Path) {
        self.change(|waiting| waiting.push(file.to_owned()));
    }

    /// Removes a file that the platform takes.
    pub(crate) fn remove(&self, file: &Path) {
        self.change(|waiting| waiting.retain(|other| other != file));
    }

    fn change(&self, change: impl FnOnce(&mut Vec<PathBuf>)) {
        let mut waiting = self.locked();
        change(&mut waiting);
        if let Some(own) = &self.own {
            let names: Vec<_> = waiting.iter().map(|file| shown_name(file)).collect();
            kept::store_or_say(own, FILE, names.join("\n").as_bytes());
        }
    }

    fn locked(&self) -> MutexGuard<'_, Vec<PathBuf>> {
        self.waiting.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
