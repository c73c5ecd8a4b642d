//! Programs that only packaging needs: searched, and on Debian installed if permitted.

use anyhow::{Result, bail};

use crate::command;
use crate::debian;

/// A program, and the package of Debian 12 that has it.
pub(super) struct Tool {
    pub(super) program: &'static str,
    pub(super) package: &'static str,
}

/// Makes sure that all of `tools` are installed.
pub(super) fn ensure(tools: &[Tool]) -> Result<()> {
    let packages = || {
        let missing = tools.iter().filter(|tool| command::find(tool.program).is_none());
        let mut packages: Vec<&str> = missing.map(|tool| tool.package).collect();
        packages.dedup();
        packages
    };
    let missing = packages();
    if missing.is_empty() {
        return Ok(());
    }
    let needs = format!("packaging needs {}", missing.join(" "));
    if command::find("apt-get").is_none() {
        bail!("{needs}, as Debian 12 calls them");
    }
    debian::install(&needs, &missing)?;
    let missing = packages();
    if missing.is_empty() {
        Ok(())
    } else {
        bail!("{} are installed, but not their programs", missing.join(" "))
    }
}
