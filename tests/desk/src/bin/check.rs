//! Reports the mistakes of a session, and draws its predictions over its first frame.

use std::path::PathBuf;
use std::process::ExitCode;

use anyhow::Context;
use clap::Parser;
use desk::alignment::{Asked, Lights, RatioArgs};
use desk::check::check;
use desk::output::make_folder;
use desk::program::{exit_code, print, repository};

/// Default folder of drawings, below the top of the repository.
const RESULTS: &str = "target/check";

/// Report all mistakes of a session at once, and draw its predictions over its first frame:
/// outlines of the toy and of its shadows, as given and as aligned. The exit code is 1 if there is
/// any mistake.
#[derive(Parser)]
#[command(name = "check", bin_name = "cargo xtask check")]
struct Args {
    /// Folder of the session, or a recording
    session: PathBuf,
    /// Folder for the drawing [default: target/check]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Ignore the session's list of lights, and compare it with the lights that are estimated from
    /// shadows
    #[arg(long, value_enum, default_value_t)]
    lights: Lights,
    #[command(flatten)]
    ratio: RatioArgs,
}

fn main() -> ExitCode {
    let args = Args::parse();
    match run(&args) {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::FAILURE,
        Err(error) => exit_code(Err(error)),
    }
}

fn run(args: &Args) -> anyhow::Result<bool> {
    let results = || repository().join(RESULTS);
    let out = args.out.clone().unwrap_or_else(results);
    make_folder(&out)?;
    let asked = Asked {
        lights: args.lights,
        ratio: args.ratio.asked(),
    };
    let findings = check(&args.session, &out, (asked, args.ratio.lens()))
        .with_context(|| args.session.display().to_string())?;
    let facts = findings.facts.iter().map(|line| format!("{line}\n"));
    let wrong = findings.wrong.iter().map(|line| format!("wrong: {line}\n"));
    let drawing = findings.drawing.iter().map(|drawing| {
        format!(
            "red as given, green as aligned, blue receivers, yellow lights as aligned: {}\n",
            drawing.display()
        )
    });
    print(&facts.chain(wrong).chain(drawing).collect::<String>())?;
    Ok(findings.wrong.is_empty())
}
