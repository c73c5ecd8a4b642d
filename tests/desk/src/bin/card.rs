//! The card to print: pages for a printer, and the reference picture by which a platform recognises
//! it.

use std::path::PathBuf;
use std::process::ExitCode;

use anyhow::Result;
use app_core::card::{PATTERN_M, reference};
use clap::Parser;
use desk::card::{CROSSES_M, Paper, page, png};
use desk::output::{make_folder, write_whole};
use desk::program::{exit_code, print, repository};

/// Default folder of the pages, below the top of the repository.
const RESULTS: &str = "target/card";

/// Write a card to print and to lay beside the toy: it gives a tracker something to hold on to, and
/// has a place for the lens of a light probe.
#[derive(Parser)]
#[command(name = "card", bin_name = "cargo xtask card")]
struct Args {
    /// Folder for the pages [default: target/card]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

fn main() -> ExitCode {
    exit_code(run(Args::parse()))
}

fn run(args: Args) -> Result<()> {
    let results = || repository().join(RESULTS);
    let out = args.out.unwrap_or_else(results);
    make_folder(&out)?;
    let mut written = String::new();
    for paper in Paper::ALL {
        let path = out.join(format!("card_{}.png", paper.name()));
        write_whole(&path, &png(&page(paper))?)?;
        written.push_str(&format!("{}\n", path.display()));
    }
    let path = out.join("card_reference.png");
    write_whole(&path, &png(&reference())?)?;
    let [across, down] = (1e3 * CROSSES_M).to_array();
    print(&format!(
        "{written}{}: {:.0} mm wide when printed\nPrint at 100 %: the crosses are {across:.0} mm apart across and {down:.0} mm down.\n",
        path.display(),
        1e3 * PATTERN_M
    ))
}
