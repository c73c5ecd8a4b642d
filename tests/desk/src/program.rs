//! Start and end of a desktop program: its session, its exit code.

use std::ffi::OsString;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use anyhow::Context;
use app_core::CoreError;
use app_core::gpu::GpuError;

use crate::stored::{Stored, StoredError};

/// Advice for a machine without a graphics adapter.
const SOFTWARE_DRIVER: &str =
    "; on Debian or Ubuntu `apt-get install mesa-vulkan-drivers` brings a software one";

/// The top folder of the repository, below which programs write by default.
#[must_use]
pub fn repository() -> &'static Path {
    let package = Path::new(env!("CARGO_MANIFEST_DIR"));
    package.ancestors().nth(2).unwrap_or(package)
}

/// The default folder of a session's results below the repository: `results`, and in it the name of
/// the session's folder or recording.
///
/// # Errors
/// When there is no such session.
pub fn results_of(session: &Path, results: &str) -> anyhow::Result<PathBuf> {
    Ok(repository().join(results).join(name_of(session)?))
}

/// The name of a session's folder or recording, without the recording's extension.
///
/// # Errors
/// When there is no such session.
pub fn name_of(session: &Path) -> anyhow::Result<OsString> {
    // `.` and `..` have a name only after they are resolved.
    let session = session
        .canonicalize()
        .with_context(|| session.display().to_string())?;
    let name = if session.is_file() {
        session.file_stem()
    } else {
        session.file_name()
    };
    Ok(name.unwrap_or("session".as_ref()).to_owned())
}

/// Opens a folder or a recording, and reports a damaged recording's losses on standard error.
///
/// # Errors
/// When there is none.
pub fn open_session(path: &Path) -> Result<Stored, StoredError> {
    let session = Stored::open(path)?;
    for loss in session.losses() {
        let _ = writeln!(io::stderr(), "warning: {}: {loss}", path.display());
    }
    Ok(session)
}

/// Writes a text to standard output.
///
/// # Errors
/// When standard output is closed.
pub fn print(text: &str) -> anyhow::Result<()> {
    io::stdout()
        .write_all(text.as_bytes())
        .context("writing to standard output")
}

/// Success, or failure with one line on standard error: the whole cause, and advice if there is
/// any.
#[must_use]
pub fn exit_code(result: anyhow::Result<()>) -> ExitCode {
    let Err(error) = result else {
        return ExitCode::SUCCESS;
    };
    // Messages of drivers and parsers may have several lines.
    let message = format!("{error:#}")
        .lines()
        .map(str::trim)
        .collect::<Vec<_>>()
        .join(" ");
    let advice = match error.downcast_ref() {
        Some(CoreError::Gpu(GpuError::NoAdapter { .. })) => SOFTWARE_DRIVER,
        _ => "",
    };
    // If even this cannot be written, the exit code reports the failure.
    let _ = writeln!(io::stderr(), "error: {message}{advice}");
    ExitCode::FAILURE
}
