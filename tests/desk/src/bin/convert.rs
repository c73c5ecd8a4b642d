//! Makes a recording of a session's folder, and a folder of a recording.

use std::path::PathBuf;
use std::process::ExitCode;

use clap::Parser;
use desk::convert::write;
use desk::import::write_transforms;
use desk::program::{exit_code, open_session};

/// Write a session anew, as a recording where the new path ends in .mcap, else as a folder. Pictures stay the bytes that
/// they are. A recording that is damaged is written without what is lost.
#[derive(Parser)]
#[command(name = "convert", bin_name = "cargo xtask convert")]
struct Args {
    /// Folder of the session, or a recording
    session: PathBuf,
    /// What to write, which must not be there yet
    out: PathBuf,
    /// Write the frames as nerfstudio has them, a folder with transforms.json
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
    println!("{}", args.out.display());
    Ok(())
}
