//! The project's toolchain: fetched if it is missing, and used for every command.

use std::env;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result};

use crate::command;

/// Parts of the toolchain that commands need besides the compiler.
const COMPONENTS: [&str; 2] = ["clippy", "rustfmt"];

/// The pinned toolchain, or an installed one.
pub(crate) struct Toolchain {
    /// Top of the repository.
    pub(crate) root: PathBuf,
    /// Edition of the language, from the workspace.
    pub(crate) edition: String,
    /// The pinned version; `None` without rustup, which alone can switch.
    version: Option<String>,
}

impl Toolchain {
    /// Fetches the pinned toolchain if it is missing.
    pub(crate) fn pinned() -> Result<Self> {
        let root = Path::new(env!("CARGO_MANIFEST_DIR"))
            .parent()
            .context("xtask lies in no folder")?
            .to_owned();
        let manifest = root.join("Cargo.toml");
        let (version, edition) = (pinned(&manifest, "rust-version")?, pinned(&manifest, "edition")?);
        if command::find("rustup").is_none() {
            let cargo =
                command::output("cargo", &["--version"]).context("neither rustup nor cargo runs here")?;
            eprintln!(
                "no rustup here: going on with {}; the project's own is {version}",
                cargo.trim()
            );
            return Ok(Self {
                root,
                edition,
                version: None,
            });
        }
        let list = ["component", "list", "--installed", "--toolchain", &version];
        let installed = command::output("rustup", &list).unwrap_or_default();
        if !COMPONENTS.iter().all(|component| lists(&installed, component)) {
            let mut install = Command::new("rustup");
            install.args(["toolchain", "install", &version, "--profile", "minimal"]);
            install.args(COMPONENTS.iter().flat_map(|component| ["--component", component]));
            command::run(&mut install)?;
        }
        Ok(Self {
            root,
            edition,
            version: Some(version),
        })
    }

    /// Fetches the standard library for `target` if it is missing.
    pub(crate) fn ensure_target(&self, target: &str) -> Result<()> {
        let Some(version) = &self.version else {
            return Ok(());
        };
        let list = ["target", "list", "--installed", "--toolchain", version];
        if lists(&command::output("rustup", &list).unwrap_or_default(), target) {
            return Ok(());
        }
        command::run(Command::new("rustup").args(["target", "add", "--toolchain", version, target]))
    }

    /// The folder that cargo builds into.
    pub(crate) fn build_folder(&self) -> PathBuf {
        env::var_os("CARGO_TARGET_DIR").map_or_else(|| self.root.join("target"), PathBuf::from)
    }

    /// A program of the toolchain.
    pub(crate) fn command(&self, program: &str) -> Command {
        let mut command = Command::new(program);
        if let Some(version) = &self.version {
            command.env("RUSTUP_TOOLCHAIN", version);
        }
        command
    }

    /// `cargo SUBCOMMAND` for this workspace, from any folder of the caller.
    pub(crate) fn cargo(&self, subcommand: &str) -> Command {
        let mut cargo = self.command("cargo");
        cargo
            .arg(subcommand)
            .arg("--manifest-path")
            .arg(self.root.join("Cargo.toml"));
        // Environment variables of the calling cargo must not reach another version.
        cargo.env_remove("CARGO");
        if env::var_os("XDG_RUNTIME_DIR").is_none_or(|folder| !Path::new(&folder).is_dir()) {
            // Without a desktop, Mesa's device selection only prints an error.
            cargo.env("NODEVICE_SELECT", "1");
        }
        cargo
    }
}

/// Whether a list of rustup has `name`, which a dash and the host may follow.
fn lists(list: &str, name: &str) -> bool {
    list.lines().any(|line| {
        line.trim()
            .strip_prefix(name)
            .is_some_and(|rest| rest.is_empty() || rest.starts_with('-'))
    })
}

/// The workspace manifest's value of `key`.
fn pinned(manifest: &Path, key: &str) -> Result<String> {
    let text = fs::read_to_string(manifest).with_context(|| manifest.display().to_string())?;
    let value = text
        .lines()
        .find_map(|line| line.strip_prefix(key)?.trim_start().strip_prefix('='));
    let value = value.with_context(|| format!("{}: no {key}", manifest.display()))?;
    Ok(value.trim().trim_matches('"').to_owned())
}
