//! The two shells: checked on any machine, built and packaged where the platform's own tools are.

use std::env;
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, bail};

use crate::command;
use crate::toolchain::Toolchain;

/// Oldest Android that the shell runs on, as an API level.
const ANDROID_API: u32 = 27;

/// A shell.
pub(crate) struct Phone {
    /// Its package in the workspace.
    package: &'static str,
    /// Its compilation target.
    pub(crate) target: &'static str,
}

/// The iPhone shell.
pub(crate) const IOS: Phone = Phone {
    package: "app-ios",
    target: "aarch64-apple-ios",
};
/// The Android shell.
pub(crate) const ANDROID: Phone = Phone {
    package: "app-android",
    target: "aarch64-linux-android",
};

/// What to do with a shell.
pub(crate) enum Action {
    Check,
    Build,
    Package,
}

impl Phone {
    /// Type check and lints.
    pub(crate) fn check(&self, toolchain: &Toolchain) -> Command {
        let mut clippy = toolchain.cargo("clippy");
        clippy.args([
            "--locked",
            "--package",
            self.package,
            "--target",
            self.target,
            "--",
            "-D",
            "warnings",
        ]);
        clippy
    }

    fn build(&self, toolchain: &Toolchain) -> Result<Command> {
        let mut build = toolchain.cargo("build");
        build.args(["--release", "--package", self.package, "--target", self.target]);
        if self.is_android() {
            build.envs(ndk_tools()?);
        }
        Ok(build)
    }

    fn is_android(&self) -> bool {
        self.target == ANDROID.target
    }
}

/// Checks, builds or packages a shell.
pub(crate) fn run(toolchain: &Toolchain, phone: &Phone, action: Action) -> Result<()> {
    toolchain.ensure_target(phone.target)?;
    match action {
        Action::Check => command::run(&mut phone.check(toolchain)),
        Action::Build => command::run(&mut phone.build(toolchain)?),
        Action::Package => package(toolchain, phone),
    }
}

fn package(toolchain: &Toolchain, phone: &Phone) -> Result<()> {
    let missing = if phone.is_android() {
        missing_for_android()
    } else {
        missing_for_ios()
    };
    if !missing.is_empty() {
        bail!(
            "{} cannot be packaged here, missing: {}",
            phone.package,
            missing.join("; ")
        );
    }
    command::run(&mut phone.build(toolchain)?)?;
    if phone.is_android() {
        return Ok(());
    }
    let folder = toolchain.root.join(phone.package);
    command::run(Command::new("xcodegen").arg("generate").current_dir(&folder))?;
    println!(
        "open {}, choose a signing team and run",
        folder.join("ShadowRetargeting.xcodeproj").display()
    );
    Ok(())
}

fn missing_for_ios() -> Vec<&'static str> {
    let mut missing = Vec::new();
    if !cfg!(target_os = "macos") {
        missing.push("a Mac (linking and signing run nowhere else)");
    }
    if command::find("xcodebuild").is_none() {
        missing.push("Xcode (from the App Store)");
    }
    if command::find("xcodegen").is_none() {
        missing.push("xcodegen (brew install xcodegen)");
    }
    missing
}

/// Never empty so far.
fn missing_for_android() -> Vec<&'static str> {
    let mut missing = Vec::new();
    if ndk().is_none() {
        missing.push("the NDK (ANDROID_NDK_HOME names its folder)");
    }
    if sdk().is_none() {
        missing.push("the SDK (ANDROID_HOME names its folder)");
    }
    if command::find("gradle").is_none() {
        missing.push("Gradle");
    }
    missing.push("a Gradle project (app-android has none yet)");
    missing
}

/// Where cargo finds the NDK's linker, and build scripts its compiler.
fn ndk_tools() -> Result<[(&'static str, PathBuf); 3]> {
    let ndk = ndk().context("no NDK found; set ANDROID_NDK_HOME to its folder")?;
    let prebuilt = ndk.join("toolchains/llvm/prebuilt");
    let host = match env::consts::OS {
        "macos" => "darwin-x86_64",
        "windows" => "windows-x86_64",
        _ => "linux-x86_64",
    };
    let bin = prebuilt.join(host).join("bin");
    let script = if cfg!(windows) { ".cmd" } else { "" };
    let clang = bin.join(format!("aarch64-linux-android{ANDROID_API}-clang{script}"));
    if !clang.is_file() {
        bail!("{} is missing from the NDK", clang.display());
    }
    Ok([
        ("CARGO_TARGET_AARCH64_LINUX_ANDROID_LINKER", clang.clone()),
        ("CC_aarch64_linux_android", clang),
        (
            "AR_aarch64_linux_android",
            bin.join(format!("llvm-ar{}", env::consts::EXE_SUFFIX)),
        ),
    ])
}

fn ndk() -> Option<PathBuf> {
    let named = ["ANDROID_NDK_HOME", "ANDROID_NDK_ROOT"]
        .iter()
        .find_map(|name| folder_named_by(name));
    named.or_else(|| newest_folder(&sdk()?.join("ndk")))
}

fn sdk() -> Option<PathBuf> {
    ["ANDROID_HOME", "ANDROID_SDK_ROOT"]
        .iter()
        .find_map(|name| folder_named_by(name))
}

fn folder_named_by(variable: &str) -> Option<PathBuf> {
    env::var_os(variable)
        .filter(|value: &OsString| !value.is_empty())
        .map(PathBuf::from)
        .filter(|path| path.is_dir())
}

/// The SDK keeps NDKs under their version numbers.
fn newest_folder(parent: &Path) -> Option<PathBuf> {
    let folders = parent
        .read_dir()
        .ok()?
        .flatten()
        .map(|entry| entry.path())
        .filter(|path| path.is_dir());
    folders.max_by_key(|path| {
        let name = path
            .file_name()
            .unwrap_or_default()
            .to_string_lossy()
            .into_owned();
        name.split('.')
            .map(|part| part.parse().unwrap_or(0))
            .collect::<Vec<u64>>()
    })
}
