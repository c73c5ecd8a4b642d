//! A folder of results that belongs to one run while it writes. A list of the written files lies in
//! it, so that the next run removes these and nothing else.

use std::collections::HashMap;
use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::{Component, Path, PathBuf};

use app_core::scene::Image;

use crate::output::{WriteError, make_folder, png_of, remove_file, write_whole};

/// The list of written files, which the running program holds locked.
pub const MANIFEST_FILE: &str = ".written";
/// Files that desktops leave in every folder they show; they are ignored, and so are hidden files.
const OF_DESKTOPS: [&str; 2] = ["Thumbs.db", "desktop.ini"];

/// A folder that only this run writes to, until it is dropped.
#[derive(Debug)]
pub struct OutputFolder {
    root: PathBuf,
    manifest: File,
}

impl OutputFolder {
    /// Takes a folder, which is made if it is missing, and removes the files of earlier runs.
    ///
    /// # Errors
    /// When another run writes into it, or a file lies in it that no run wrote or that has changed
    /// since: nothing is removed then.
    pub fn take(root: &Path) -> Result<Self, WriteError> {
        refuse_unlisted(root)?;
        let folder = Self::reopen(root)?;
        let written = folder.written()?;
        let present = check(root, &written)?;
        present.iter().try_for_each(|path| remove_file(path))?;
        for file in written.keys() {
            remove_empty_folders(root, file);
        }
        folder
            .manifest
            .set_len(0)
            .and_then(|()| (&folder.manifest).rewind())
            .map_err(|error| WriteError::new(&root.join(MANIFEST_FILE), error))?;
        Ok(folder)
    }

    /// Refuses a folder that [`Self::take`] would refuse for its files, and changes nothing. Call it
    /// before long work.
    ///
    /// # Errors
    /// When a file lies in it that no run wrote or that has changed since, or cannot be read.
    pub fn check(root: &Path) -> Result<(), WriteError> {
        let path = root.join(MANIFEST_FILE);
        let manifest = match fs::read_to_string(&path) {
            Err(error) if error.kind() != io::ErrorKind::NotFound => {
                return Err(WriteError::new(&path, error));
            }
            read => read.unwrap_or_default(),
        };
        if root.is_dir() {
            check(root, &listed(&manifest))?;
        }
        Ok(())
    }

    /// Takes a folder to continue in it: existing files stay.
    ///
    /// # Errors
    /// When another run writes into it, or the system refuses.
    pub fn reopen(root: &Path) -> Result<Self, WriteError> {
        make_folder(root)?;
        let path = root.join(MANIFEST_FILE);
        let failed = |error| WriteError::new(&path, error);
        let options = OpenOptions::new()
            .read(true)
            .write(true)
            .create(true)
            .truncate(false)
            .open(&path);
        let manifest = options.map_err(failed)?;
        match manifest.try_lock() {
            Ok(()) => {}
            Err(TryLockError::WouldBlock) => {
                return Err(WriteError::new(
                    root,
                    "another run is writing into this folder: wait for its end, or choose another folder",
                ));
            }
            // Some file systems have no locks; the list is useful there, too.
            Err(TryLockError::Error(error)) if error.kind() == io::ErrorKind::Unsupported => {}
            Err(TryLockError::Error(error)) => return Err(failed(error)),
        }
        // Windows does not lock a file that is open for appending alone.
        (&manifest).seek(SeekFrom::End(0)).map_err(failed)?;
        Ok(Self {
            root: root.to_owned(),
            manifest,
        })
    }

    /// Path of the folder.
    #[must_use]
    pub fn root(&self) -> &Path {
        &self.root
    }

    /// Writes a file; its path is below the folder, with `/` between its parts.
    ///
    /// # Errors
    /// When the system refuses.
    pub fn write(&self, file: &str, bytes: &[u8]) -> Result<(), WriteError> {
        let path = self.root.join(file);
        if let Some(folder) = path.parent() {
            make_folder(folder)?;
        }
        // Listed before it exists: a run that is killed between the two steps leaves no unlisted
        // file.
        let line = format!("{:08x} {file}\n", crc32fast::hash(bytes));
        (&self.manifest)
            .write_all(line.as_bytes())
            .map_err(|error| WriteError::new(&self.root.join(MANIFEST_FILE), error))?;
        write_whole(&path, bytes)
    }

    /// Writes a picture as PNG, alpha included, and returns its bytes.
    ///
    /// # Errors
    /// When its bytes do not fit its size, or the system refuses.
    pub fn write_png(&self, file: &str, image: &Image) -> Result<Vec<u8>, WriteError> {
        let png = png_of(&self.root.join(file), image)?;
        self.write(file, &png)?;
        Ok(png)
    }

    /// The checksums under which each file was written.
    fn written(&self) -> Result<HashMap<String, Vec<u32>>, WriteError> {
        let mut text = String::new();
        let mut manifest = &self.manifest;
        manifest
            .rewind()
            .and_then(|()| manifest.read_to_string(&mut text))
            .map_err(|error| WriteError::new(&self.root.join(MANIFEST_FILE), error))?;
        Ok(listed(&text))
    }
}

/// The files that a list names, each with its checksums.
fn listed(manifest: &str) -> HashMap<String, Vec<u32>> {
    let mut listed: HashMap<String, Vec<u32>> = HashMap::new();
    // A line that was cut off by a kill or an editor lists nothing.
    for (checksum, file) in manifest.lines().filter_map(|line| line.split_once(' ')) {
        let is_below = Path::new(file)
            .components()
            .all(|part| matches!(part, Component::Normal(_)));
        if let (Ok(checksum), true) = (u32::from_str_radix(checksum, 16), is_below) {
            listed.entry(file.to_owned()).or_default().push(checksum);
        }
    }
    listed
}

/// Refuses a folder that has files but no list, before a list is made in it.
fn refuse_unlisted(root: &Path) -> Result<(), WriteError> {
    if !root.is_dir() || root.join(MANIFEST_FILE).exists() {
        return Ok(());
    }
    check(root, &HashMap::new()).map(drop)
}

/// The existing files of the list; an error if there are others.
fn check(root: &Path, written: &HashMap<String, Vec<u32>>) -> Result<Vec<PathBuf>, WriteError> {
    let mut present = Vec::new();
    for (file, path) in files_below(root)? {
        let refused = |reason| Err(WriteError::new(root, format!("{file} {reason}")));
        match written.get(&file) {
            Some(checksums) => {
                let bytes = fs::read(&path).map_err(|error| WriteError::new(&path, error))?;
                if !checksums.contains(&crc32fast::hash(&bytes)) {
                    return refused(
                        "was changed since an earlier run wrote it; move it away, or choose another folder",
                    );
                }
            }
            None if is_remnant(&file, written) => {}
            None => {
                return refused(
                    "was not written by an earlier run, or was written by an earlier version of this program: delete the folder, move the \
                     file away, or choose another folder",
                );
            }
        }
        present.push(path);
    }
    Ok(present)
}

/// Whether a file is the remnant of a killed run.
fn is_remnant(file: &str, written: &HashMap<String, Vec<u32>>) -> bool {
    let whole = file
        .strip_suffix(".partial")
        .and_then(|file| file.rsplit_once('.'));
    whole.is_some_and(|(file, process)| process.parse::<u32>().is_ok() && written.contains_key(file))
}

/// All relevant files below a folder, in order, each with its path as in the list.
fn files_below(root: &Path) -> Result<Vec<(String, PathBuf)>, WriteError> {
    let mut files = Vec::new();
    let mut folders = vec![(String::new(), root.to_owned())];
    while let Some((prefix, folder)) = folders.pop() {
        let failed = |error| WriteError::new(&folder, error);
        for entry in fs::read_dir(&folder).map_err(failed)? {
            let entry = entry.map_err(failed)?;
            let name = entry.file_name().to_string_lossy().into_owned();
            if name.starts_with('.') || OF_DESKTOPS.contains(&name.as_str()) {
                continue;
            }
            let file = format!("{prefix}{name}");
            // Links are not followed: their targets are not ours.
            if entry.file_type().map_err(failed)?.is_dir() {
                folders.push((format!("{file}/"), entry.path()));
            } else {
                files.push((file, entry.path()));
            }
        }
    }
    files.sort();
    Ok(files)
}

/// Removes the folders around a file, up to the first one that is not empty.
fn remove_empty_folders(root: &Path, file: &str) {
    let folders = Path::new(file).ancestors().skip(1);
    for folder in folders.filter(|folder| !folder.as_os_str().is_empty()) {
        // A folder that is not empty stays, which is no error.
        if fs::remove_dir(root.join(folder)).is_err() {
            return;
        }
    }
}
