//! All checks that a change must pass, the cheap ones first.

use std::process::Command;
use std::time::{Duration, Instant};

use anyhow::{Context, Result};

use crate::command;
use crate::format;
use crate::phone::{ANDROID, IOS};
use crate::toolchain::Toolchain;
use crate::vulkan;

/// Runs all steps until the first failure.
pub(crate) fn run(toolchain: &Toolchain) -> Result<()> {
    vulkan::ensure()?;
    for phone in [&IOS, &ANDROID] {
        toolchain.ensure_target(phone.target)?;
    }
    let mut times = Vec::new();
    for (name, mut command) in steps(toolchain)? {
        times.push(format!("{name} {}", seconds(run_step(name, &mut command)?)));
    }
    println!("==> all passed: {}", times.join(", "));
    Ok(())
}

fn steps(toolchain: &Toolchain) -> Result<Vec<(&'static str, Command)>> {
    let step = |subcommand: &str, args: &[&str]| {
        let mut command = toolchain.cargo(subcommand);
        command.args(args);
        command
    };
    let mut doc = step("doc", &["--locked", "--workspace", "--no-deps"]);
    doc.env("RUSTDOCFLAGS", "-D warnings");
    Ok(vec![
        ("format", format::rustfmt(toolchain, &["--check"])?),
        (
            "lints",
            step(
                "clippy",
                &["--locked", "--workspace", "--all-targets", "--", "-D", "warnings"],
            ),
        ),
        ("ios check", IOS.check(toolchain)),
        ("android check", ANDROID.check(toolchain)),
        ("documentation", doc),
        // Licences and sources of all dependencies are among the tests.
        (
            "tests",
            step("test", &["--locked", "--workspace", "--no-fail-fast"]),
        ),
    ])
}

fn run_step(name: &str, command: &mut Command) -> Result<Duration> {
    println!("==> {name}: {}", command::line(command));
    let start = Instant::now();
    let result = command::run(command);
    let time = start.elapsed();
    result.with_context(|| format!("the step \"{name}\" failed after {}", seconds(time)))?;
    println!("==> {name}: passed in {}", seconds(time));
    Ok(time)
}

fn seconds(time: Duration) -> String {
    format!("{:.1} s", time.as_secs_f64())
}
