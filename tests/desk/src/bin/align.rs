//! Writes a session anew, with cameras, toy pose and lights as estimated from its pictures.

use std::path::PathBuf;
use std::process::ExitCode;

use anyhow::Context;
use app_core::session::Session;
use clap::Parser;
use desk::alignment::{Alignments, Asked, Lights, RatioArgs};
use desk::check::aligned_session::{self, Assumed};
use desk::convert::check_out;
use desk::opened;
use desk::opened::Opened;
use desk::program::{exit_code, print};
use desk::stored::Stored;

/// Write a session anew with cameras, pose and lights aligned by its pictures; all else stays as it
/// is.
#[derive(Parser)]
#[command(name = "align", bin_name = "cargo xtask align")]
struct Args {
    /// Folder of the session, or a recording
    session: PathBuf,
    /// Folder for the corrected session, or a recording if it ends in .mcap; it must not exist yet
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Ignore the session's list of lights, and write those that were estimated from shadows; if
    /// there are none, the list stays
    #[arg(long, value_enum, default_value_t)]
    lights: Lights,
    #[command(flatten)]
    ratio: RatioArgs,
}

fn main() -> ExitCode {
    exit_code(run(&Args::parse()))
}

fn run(args: &Args) -> anyhow::Result<()> {
    let session = Stored::open(&args.session)?;
    check_out(&session, &args.out)?;
    let opened = opened::open(&args.session, args.ratio.lens(), args.lights);
    let Opened { capture, lens } = opened.with_context(|| args.session.display().to_string())?;
    let asked = Asked {
        lights: args.lights,
        ratio: args.ratio.asked(),
    };
    let alignments = Alignments::find(&capture, 0..capture.n_frames(), asked)?.with_lens(lens);
    let n_corrected = aligned_session::write(&session, &args.out, &alignments, Assumed::Omitted)?;
    print(&format!(
        "{n_corrected} of {} frames have a corrected camera, focal length, lens, pose, scale or lights: {}\n",
        capture.n_frames(),
        args.out.display()
    ))
}
