//! How a program of the harness ends.

use std::io::{self, Write};
use std::process::ExitCode;

/// Success, or failure with one line on standard error that tells the whole cause.
#[must_use]
pub fn exit_code(result: anyhow::Result<()>) -> ExitCode {
    let Err(error) = result else {
        return ExitCode::SUCCESS;
    };
    // Drivers and parsers may speak in several lines.
    let message = format!("{error:#}")
        .lines()
        .map(str::trim)
        .collect::<Vec<_>>()
        .join(" ");
    // Where even this cannot be written, the exit code still tells.
    let _ = writeln!(io::stderr(), "error: {message}");
    ExitCode::FAILURE
}
