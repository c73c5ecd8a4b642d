//! Converts another program's recording to a session.

use std::path::PathBuf;
use std::process::ExitCode;

use app_core::session::Session;
use clap::Parser;
use desk::import::{Format, Lacking, Source, Written, read, write};
use desk::program::{exit_code, print};

/// Convert another program's recording to a session. The program asks by name for each value that
/// the format lacks. Extract a video's frames beforehand.
#[derive(Parser)]
#[command(name = "import", bin_name = "cargo xtask import")]
struct Args {
    /// Format of the recording
    format: Format,
    /// Folder of the recording, or a .r3d of Record3D
    recording: PathBuf,
    /// Folder of the session to write, which must not exist yet
    out: PathBuf,
    #[command(flatten)]
    lacking: Lacking,
}

fn main() -> ExitCode {
    exit_code(run(&Args::parse()))
}

fn run(args: &Args) -> anyhow::Result<()> {
    let files = Source::open(&args.recording)?;
    let imported = read(args.format, &files, &files.paths()?, args.lacking.object)?;
    let recording = args.recording.canonicalize()?;
    let name = recording.file_name().unwrap_or_default().to_string_lossy();
    let Written { capture, notes } = write(&name, &files, &imported, &args.lacking, &args.out)?;
    let notes: String = notes.iter().map(|note| format!("note: {note}\n")).collect();
    print(&format!(
        "{notes}{}: {} frames, {} plates\n",
        args.out.display(),
        capture.n_frames(),
        capture.scene().plates.len()
    ))
}
