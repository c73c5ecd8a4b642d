//! Writes a recording until it is killed, for the test of that case.

use std::env;
use std::path::PathBuf;
use std::process::ExitCode;

use anyhow::Context;
use desk::program::exit_code;
use harness::endless::write;

fn main() -> ExitCode {
    let out = env::args_os().nth(1).map(PathBuf::from).context("no file");
    exit_code(out.and_then(|out| write(&out, std::io::stdout())))
}
