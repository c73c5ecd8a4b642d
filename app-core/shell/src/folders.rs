//! Where files go, and what they are called.

use std::path::PathBuf;
use std::time::{SystemTime, UNIX_EPOCH};

/// Where files go; a folder can be missing, as that of a card that was taken out.
#[derive(Clone, Debug, Default)]
pub struct Folders {
    /// What people get at.
    pub shared: Option<PathBuf>,
    /// Where toys are that a person can choose from.
    pub toys: Option<PathBuf>,
    /// What is the app's own.
    pub own: Option<PathBuf>,
}

impl Folders {
    /// The path of a file that people get at, but for its extension; none without a folder.
    pub(crate) fn stem(&self, what: &str, number: u128) -> Option<PathBuf> {
        let folder = self.shared.as_ref()?;
        Some(folder.join(format!("{what}_{number}")))
    }
}

/// Milliseconds since 1970: names with it grow with time. A clock that is set before then gives every file the same name.
pub(crate) fn unix_ms() -> u128 {
    let since = SystemTime::now().duration_since(UNIX_EPOCH);
    since.unwrap_or_default().as_millis()
}
