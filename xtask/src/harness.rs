//! The programs of the workspace, and the demo that uses them.

use std::env;
use std::ffi::{OsStr, OsString};
use std::path::Path;
use std::process::{Command, ExitCode};

use anyhow::{Context, Result};

use crate::command::line;
use crate::toolchain::Toolchain;
use crate::vulkan;
use crate::{Program, REPLAY};

/// Replays the bundled session and names the files to look at.
pub(crate) fn demo(toolchain: &Toolchain) -> Result<ExitCode> {
    let out = toolchain.root.join("target/demo");
    let code = run(
        toolchain,
        &REPLAY,
        &[
            "--preset".into(),
            "flat,paper,balanced,best".into(),
            "--out".into(),
            out.clone().into_os_string(),
        ],
    )?;
    if code == ExitCode::SUCCESS {
        println!("To see it, open {}", from_here(&out.join("index.html")).display());
    }
    Ok(code)
}

/// Runs a program with `args` and returns its exit code.
pub(crate) fn run(toolchain: &Toolchain, program: &Program, args: &[OsString]) -> Result<ExitCode> {
    let mut cargo = command_of(toolchain, program, args)?;
    let status = cargo.status().with_context(|| line(&cargo))?;
    let code = status.code().and_then(|code| u8::try_from(code).ok());
    Ok(code.map_or(ExitCode::FAILURE, ExitCode::from))
}

/// Replaces this process by the program, so that a signal ends it and no child stays behind; the
/// same as [`run`] on systems without `exec`.
pub(crate) fn become_program(
    toolchain: &Toolchain,
    program: &Program,
    args: &[OsString],
) -> Result<ExitCode> {
    #[cfg(unix)]
    {
        use std::os::unix::process::CommandExt;
        let mut cargo = command_of(toolchain, program, args)?;
        // Cargo also replaces itself by the program. This returns only if there is no cargo.
        let error = cargo.exec();
        Err(error).with_context(|| line(&cargo))
    }
    #[cfg(not(unix))]
    run(toolchain, program, args)
}

fn command_of(toolchain: &Toolchain, program: &Program, args: &[OsString]) -> Result<Command> {
    if program.needs_device && !asks_only(args) {
        vulkan::ensure()?;
    }
    let mut cargo = toolchain.cargo("run");
    cargo.args(["--package", program.package, "--bin", program.name]);
    // A first build takes minutes, which must not look like a standstill.
    if asks_only(args) || args.iter().any(|arg| arg == OsStr::new("--quiet")) {
        cargo.arg("--quiet");
    }
    cargo.arg("--").args(args);
    Ok(cargo)
}

fn asks_only(args: &[OsString]) -> bool {
    args.iter().any(|arg| arg == "--help" || arg == "-h")
}

/// A path relative to the caller's folder.
fn from_here(path: &Path) -> &Path {
    let here = env::current_dir().ok();
    here.and_then(|here| path.strip_prefix(here).ok()).unwrap_or(path)
}
