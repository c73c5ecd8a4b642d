//! Measures numerical stability on hard cases: a table, stability.csv, and drawings of the sweeps.

use std::io::{self, Write};
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Instant;

use anyhow::ensure;
use app_core::core::Core;
use app_core::gpu::AdapterChoice;
use app_core::wgpu;
use clap::Parser;
use desk::output::{make_folder, remove_file, write_whole};
use desk::program::{exit_code, repository};
use measure::photographer::{Shot, World, folder};
use measure::stability::{Case, Lab, Row, Scope, cases, csv, draw, run as run_case, table};

/// Default folder of the result, below the top of the repository.
const RESULTS: &str = "target/stability";
/// File name of the result.
const CSV_FILE: &str = "stability.csv";

/// Vary hard cases and compare measurements with bounds: a table, stability.csv, drawings of
/// sweeps. The exit code is 1 if a bound is broken.
#[derive(Parser)]
#[command(name = "stability", bin_name = "cargo xtask stability")]
struct Args {
    /// Only the group or the case of that name
    #[arg(long, value_name = "NAME")]
    only: Option<String>,
    /// Only the cases that `cargo xtask test` runs
    #[arg(long)]
    quick: bool,
    /// Folder for stability.csv and drawings [default: target/stability]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Plant a fault in the measurements, which each group must find
    #[arg(long)]
    plant: bool,
    /// Instead, photograph the box of the truth sweep with its light at 30 degrees of azimuth, as a
    /// session for replay
    #[arg(long, value_name = "DIR", conflicts_with_all = ["only", "quick", "plant"])]
    photograph: Option<PathBuf>,
    /// Part of a graphics adapter's name [default: the fastest]
    #[arg(long, value_name = "NAME")]
    adapter: Option<String>,
}

impl Args {
    fn asks_for(&self, case: &Case) -> bool {
        let is_named = |only: &String| *only == case.label.group || *only == case.label.case;
        let is_of_scope = match case.scope {
            Scope::Quick => true,
            Scope::Whole => !self.quick,
            Scope::Named => self.only.as_deref() == Some(case.label.case),
        };
        self.only.as_ref().is_none_or(is_named) && is_of_scope
    }
}

fn main() -> ExitCode {
    exit_code(run(&Args::parse()))
}

fn run(args: &Args) -> anyhow::Result<()> {
    if let Some(out) = &args.photograph {
        let world = World::boxes();
        return Ok(folder::write(out, &Shot::of(&world)?)?);
    }
    measure(args)
}

fn measure(args: &Args) -> anyhow::Result<()> {
    let asked: Vec<&Case> = cases().filter(|case| args.asks_for(case)).collect();
    let names: Vec<&str> = cases().map(|case| case.label.case).collect();
    ensure!(
        !asked.is_empty(),
        "there is no such case; there are {}",
        names.join(", ")
    );
    let results = || repository().join(RESULTS);
    let out = args.out.clone().unwrap_or_else(results);
    make_folder(&out)?;
    remove_file(&out.join(CSV_FILE))?;
    let adapter = args
        .adapter
        .clone()
        .map_or(AdapterChoice::Fastest, AdapterChoice::Named);
    let core = pollster::block_on(Core::headless(&wgpu::Instance::default(), &adapter))?;
    let scope = if args.quick { Scope::Quick } else { Scope::Whole };
    let mut lab = Lab::new(core, scope, args.plant);
    let mut rows: Vec<Row> = Vec::new();
    for case in asked {
        let start = Instant::now();
        let findings = run_case(&mut lab, case)?;
        let n_broken = findings.rows.iter().filter(|row| row.is_broken()).count();
        writeln!(
            io::stderr(),
            "{}, {}: {n_broken} of {} bounds broken, {:.1} s",
            case.label.group,
            case.label.case,
            findings.rows.len(),
            start.elapsed().as_secs_f64()
        )?;
        for sweep in &findings.sweeps {
            draw(&out, sweep)?;
        }
        rows.extend(findings.rows);
    }
    write_whole(&out.join(CSV_FILE), csv(&rows).as_bytes())?;
    write!(io::stdout(), "{}", table(&rows, &lab.adapter()))?;
    let n_broken = rows.iter().filter(|row| row.is_broken()).count();
    ensure!(n_broken == 0, "{n_broken} bounds are broken");
    Ok(())
}
