//! Makes a session of another program's recording.

use std::path::PathBuf;
use std::process::ExitCode;

use app_core::session::Session;
use clap::Parser;
use desk::files::Folder;
use desk::import::{Format, Lacking, Written, read, write};
use desk::program::exit_code;

/// Make a session of another program's recording. What its format does not tell is asked for by name. Video is taken as
/// frames that were extracted beforehand.
#[derive(Parser)]
#[command(name = "import", bin_name = "cargo xtask import")]
struct Args {
    /// Who wrote it
    format: Format,
    /// Folder of the recording
    recording: PathBuf,
    /// Folder of the session to write, which must not be there yet
    out: PathBuf,
    #[command(flatten)]
    lacking: Lacking,
}

fn main() -> ExitCode {
    exit_code(run(&Args::parse()))
}

fn run(args: &Args) -> anyhow::Result<()> {
    let folder = Folder::open(&args.recording)?;
    let imported = read(args.format, &folder, &folder.paths()?, args.lacking.object)?;
    let recording = args.recording.canonicalize()?;
    let name = recording.file_name().unwrap_or_default().to_string_lossy();
    let Written { capture, notes } = write(&name, &folder, &imported, &args.lacking, &args.out)?;
    for note in notes {
        println!("note: {note}");
    }
    println!(
        "{}: {} frames, {} plates",
        args.out.display(),
        capture.n_frames(),
        capture.scene().plates.len()
    );
    Ok(())
}
