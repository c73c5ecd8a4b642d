//! The programs of the harness, and the demo on top of them.

use std::env;
use std::ffi::{OsStr, OsString};
use std::path::Path;
use std::process::ExitCode;

use anyhow::{Context, Result};

use crate::command::line;
use crate::toolchain::Toolchain;
use crate::vulkan;
use crate::{Program, REPLAY};

/// Replays the bundled session and names what to look at.
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

/// Runs a program with `args` and hands on its exit code.
pub(crate) fn run(toolchain: &Toolchain, program: &Program, args: &[OsString]) -> Result<ExitCode> {
    if program.needs_device && !asks_only(args) {
        vulkan::ensure()?;
    }
    let mut cargo = toolchain.cargo("run");
    cargo.args(["--package", program.package, "--bin", program.name]);
    // A first build takes minutes, which must not look like a standstill.
    if asks_only(args) || args.iter().any(|arg| arg == OsStr::new("--quiet")) {
        cargo.arg("--quiet");
    }
    let status = cargo
        .arg("--")
        .args(args)
        .status()
        .with_context(|| line(&cargo))?;
    let code = status.code().and_then(|code| u8::try_from(code).ok());
    Ok(code.map_or(ExitCode::FAILURE, ExitCode::from))
}

fn asks_only(args: &[OsString]) -> bool {
    args.iter().any(|arg| arg == "--help" || arg == "-h")
}

/// A path as seen from where the command was called.
fn from_here(path: &Path) -> &Path {
    let here = env::current_dir().ok();
    here.and_then(|here| path.strip_prefix(here).ok()).unwrap_or(path)
}
