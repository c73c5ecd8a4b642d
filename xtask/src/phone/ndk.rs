//! Paths of Android's own tools: NDK and SDK.

use std::env;
use std::ffi::OsString;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};

/// Oldest supported Android, as an API level. The manifest has the same, and the list of imports
/// shows why.
pub(super) const ANDROID_API: u32 = 28;

/// The NDK's linker for cargo, and its compiler for build scripts.
pub(super) fn ndk_tools() -> Result<[(&'static str, PathBuf); 3]> {
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

pub(super) fn ndk() -> Option<PathBuf> {
    let named = ["ANDROID_NDK_HOME", "ANDROID_NDK_ROOT"]
        .iter()
        .find_map(|name| folder_named_by(name));
    named.or_else(|| newest_folder(&sdk()?.join("ndk")))
}

pub(super) fn sdk() -> Option<PathBuf> {
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

/// The SDK keeps versions of a part in folders of their numbers.
pub(super) fn newest_folder(parent: &Path) -> Option<PathBuf> {
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
        let parts = name.split(|letter: char| !letter.is_ascii_digit());
        parts.filter_map(|part| part.parse().ok()).collect::<Vec<u64>>()
    })
}
