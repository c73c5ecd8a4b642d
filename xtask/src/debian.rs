//! Installs packages of Debian and Ubuntu, if that is permitted.

use std::io::{self, IsTerminal, Write};
use std::process::Command;

use anyhow::{Result, bail};

use crate::command;

/// Installs `packages` as root, after a question if `sudo` is needed, or else prints the line to
/// run.
pub(crate) fn install(reason: &str, packages: &[&str]) -> Result<()> {
    let line = format!("apt-get update && apt-get install --yes {}", packages.join(" "));
    let is_root = command::output("id", &["-u"]).is_some_and(|id| id.trim() == "0");
    if is_root {
        install_as(&[], packages)
    } else if command::find("sudo").is_some() && agreed(&line) {
        install_as(&["sudo"], packages)
    } else {
        bail!("{reason}; run this as root, then the command again: {line}");
    }
}

fn install_as(prefix: &[&str], packages: &[&str]) -> Result<()> {
    println!("Installing {}.", packages.join(" and "));
    let apt_get = |args: &[&str]| {
        let words = [
            prefix,
            &["env", "DEBIAN_FRONTEND=noninteractive", "apt-get"],
            args,
        ]
        .concat();
        command::run(Command::new(words[0]).args(&words[1..]))
    };
    apt_get(&["update", "--quiet"])?;
    apt_get(
        &[
            ["install", "--quiet", "--yes", "--no-install-recommends"].as_slice(),
            packages,
        ]
        .concat(),
    )
}

/// Asks whether `line` may be run as root. Without a terminal the answer is no.
fn agreed(line: &str) -> bool {
    if !io::stdin().is_terminal() {
        return false;
    }
    print!("Run `{line}` with sudo? [y/N] ");
    let mut answer = String::new();
    let asked = io::stdout()
        .flush()
        .and_then(|()| io::stdin().read_line(&mut answer));
    asked.is_ok() && matches!(answer.trim(), "y" | "Y" | "yes")
}
