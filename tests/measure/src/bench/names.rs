//! Names of files about single sessions of several.

use std::path::PathBuf;

use desk::program::name_of;

/// A name for each session's files: that of its folder or recording, with a number if an earlier
/// session has it. Several sessions may be variants of one that all have its own name.
///
/// # Errors
/// When there is no such session.
pub fn file_names(sessions: &[PathBuf]) -> anyhow::Result<Vec<String>> {
    let mut names: Vec<String> = Vec::new();
    for session in sessions {
        let own = name_of(session)?.to_string_lossy().into_owned();
        let mut name = own.clone();
        let mut number = 1;
        while names.contains(&name) {
            number += 1;
            name = format!("{own}-{number}");
        }
        names.push(name);
    }
    Ok(names)
}
