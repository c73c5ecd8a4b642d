//! Converts a session's folder to a recording, and a recording to a folder.

use std::path::PathBuf;
use std::process::ExitCode;

use clap::Parser;
use desk::convert::write;
use desk::import::write_transforms;
use desk::program::{exit_code, open_session, print};

/// Write a session anew, as a recording if the new path ends in .mcap, else as a folder. Pictures
/// keep their bytes. Of a damaged recording, the readable part is written.
#[derive(Parser)]
#[command(name = "convert", bin_name = "cargo xtask convert")]
struct Args {
    /// Folder of the session, or a recording
    session: PathBuf,
    /// Path to write, which must not exist yet
    out: PathBuf,
    /// Write the frames in nerfstudio's format, a folder with transforms.json
    #[arg(long)]
    nerfstudio: bool,
}

fn main() -> ExitCode {
    exit_code(run(&Args::parse()))
}

fn run(args: &Args) -> anyhow::Result<()> {
    let session = open_session(&args.session)?;
    if args.nerfstudio {
        write_transforms(&session, &args.out)?;
    } else {
        write(&session, None, &args.out)?;
    }
    print(&format!("{}\n", args.out.display()))
}
