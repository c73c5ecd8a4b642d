//! Writes a session anew, with the cameras, the toy's pose and the lights as its pictures show them.

use std::path::PathBuf;
use std::process::ExitCode;

use anyhow::Context;
use app_core::session::{Capture, Session};
use clap::Parser;
use harness::alignment::{Alignments, Asked, RatioArgs};
use harness::check::aligned_session;
use harness::program::{exit_code, open_session};
use harness::stored::Stored;

/// Write a session anew with cameras, pose and lights aligned by its pictures; all else stays as it is.
#[derive(Parser)]
#[command(name = "align", bin_name = "cargo xtask align")]
struct Args {
    /// Folder of the session, or a recording
    session: PathBuf,
    /// Folder for the corrected session, or a recording where it ends in .mcap, which must not be there yet
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    #[command(flatten)]
    ratio: RatioArgs,
}

fn main() -> ExitCode {
    exit_code(run(&Args::parse()))
}

fn run(args: &Args) -> anyhow::Result<()> {
    let session = open_session(&args.session)?;
    let capture =
        Capture::open(Stored::open(&args.session)?).with_context(|| args.session.display().to_string())?;
    let asked = Asked {
        ratio: args.ratio.asked(),
        ..Asked::default()
    };
    let alignments = Alignments::find(&capture, 0..capture.n_frames(), asked)?;
    let n_corrected = aligned_session::write(&session, &args.out, &alignments)?;
    println!(
        "{n_corrected} of {} frames have a corrected camera, focal length, pose, scale or lights: {}",
        capture.n_frames(),
        args.out.display()
    );
    Ok(())
}
