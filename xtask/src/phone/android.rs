//! The library of the Android shell: linked by the NDK, or without one against stub libraries.
//!
//! The stubs have the names of `app-android/imports.txt` and nothing else, so that the link proves
//! that a phone of the listed API level has all that the library imports. Its result is not for
//! distribution: Android expects the NDK's own start-up code and unwinder.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, bail};

use super::apk;
use super::arcore::Arcore;
use super::elf::{AARCH64, Library};
use super::imports::{Imports, assembly};
use super::ndk::{self, ANDROID_API};
use super::tools::{self, Tool};
use super::zip::PAGE;
use super::{ANDROID, Profile};
use crate::command;
use crate::toolchain::Toolchain;

const CLANG: &str = "clang-19";
const LINKER: &str = "ld.lld-19";
/// Linkers alone; the tools of a package are `apk`'s.
#[rustfmt::skip] // One tool a line.
const TOOLS: [Tool; 2] = [
    Tool { program: CLANG, package: "clang-19" },
    Tool { program: LINKER, package: "lld-19" },
];
/// Debian's unwinder for the phone's processor, in place of the NDK's.
const UNWINDER: &str = "libunwind-19-dev";
/// Strips function names from the library. This argument belongs to the last link alone, so that
/// nothing else is rebuilt.
const STRIP: &str = "-Wl,--strip-all";
/// Functions of glibc that this unwinder needs, implemented by Android's library.
const SHIM: &str = r"
extern int *__errno(void);
extern void abort(void);
int *__errno_location(void) { return __errno(); }
void __assert_fail(const char *what, const char *file, unsigned line, const char *function) { abort(); }
int __fprintf_chk(void *to, int flag, const char *format, ...) { return 0; }
";

/// Links the library and packages it.
pub(super) fn package(toolchain: &Toolchain, profile: Profile, arcore: Option<&Arcore>) -> Result<()> {
    let shell = toolchain.root.join(ANDROID.package);
    let folder = toolchain.root.join("target/phone/android");
    fs::create_dir_all(&folder)?;
    let imports = Imports::read(&shell.join("imports.txt"), true)?;
    let (library, linked) = if ndk::ndk().is_some() {
        command::run(&mut ANDROID.build(toolchain, profile, &[STRIP.to_owned()])?)?;
        (built(toolchain, profile), "by the NDK")
    } else {
        let library = link_without_ndk(toolchain, profile, &folder, &imports)?;
        (library, "against stand-ins, without the NDK: not for a phone")
    };
    let file = fs::read(&library).with_context(|| library.display().to_string())?;
    fs::write(folder.join("libapp_android.so"), &file)?;
    let read = Library::read(&file).with_context(|| library.display().to_string())?;
    check(&read)?;
    if ndk::ndk().is_none() && profile == Profile::Release {
        imports.compare(&read.imports, is_linked)?;
    }
    println!(
        "{}: {} bytes, linked {linked}\n  segments: multiples of {} bytes\n  imports: {} of {}, all of API level {} or earlier",
        library.display(),
        file.len(),
        PAGE,
        read.imports.len(),
        read.needed.iter().cloned().collect::<Vec<_>>().join(" "),
        imports.level(),
    );
    apk::make(&shell, &folder, file, arcore)
}

/// Whether a name is resolved at the start; others are looked up at run time.
fn is_linked(library: &str) -> bool {
    Path::new(library).extension().is_some_and(|end| end == "so")
}

fn built(toolchain: &Toolchain, profile: Profile) -> PathBuf {
    toolchain
        .build_folder()
        .join(ANDROID.target)
        .join(profile.name())
        .join("libapp_android.so")
}

fn check(library: &Library) -> Result<()> {
    if library.machine != AARCH64 {
        bail!("machine {} is not a 64-bit ARM", library.machine);
    }
    if let Some(alignment) = library
        .alignments
        .iter()
        .find(|alignment| !alignment.is_multiple_of(PAGE as u64))
    {
        bail!("a segment is aligned to {alignment} bytes, phones with pages of 16 KB refuse it");
    }
    // The activity's glue starts here.
    if !library.exports.contains("ANativeActivity_onCreate") {
        bail!("no ANativeActivity_onCreate: the activity could not start");
    }
    Ok(())
}

fn link_without_ndk(
    toolchain: &Toolchain,
    profile: Profile,
    folder: &Path,
    imports: &Imports,
) -> Result<PathBuf> {
    tools::ensure(&TOOLS)?;
    let stubs = folder.join("stubs");
    let _ = fs::remove_dir_all(&stubs);
    fs::create_dir_all(&stubs)?;
    for (library, names) in imports.libraries().filter(|(library, _)| is_linked(library)) {
        let source = stubs.join(library).with_extension("s");
        fs::write(&source, assembly(&names))?;
        let mut link = clang();
        link.args(["-shared", &format!("-Wl,-soname,{library}"), "-o"]);
        command::run(link.arg(stubs.join(library)).arg(&source))?;
    }
    let (source, shim) = (stubs.join("shim.c"), stubs.join("shim.o"));
    fs::write(&source, SHIM)?;
    command::run(
        clang()
            .args(["-w", "-fPIC", "-O1", "-c", "-o"])
            .arg(&shim)
            .arg(&source),
    )?;
    fs::copy(unwinder(folder)?, stubs.join("libunwind.a"))?;
    // Android's threads are part of its C library.
    fs::write(stubs.join("libpthread.a"), "!<arch>\n")?;

    let search = format!("-L{}", stubs.display());
    let shim = shim.display().to_string();
    let page = format!("-Wl,-z,max-page-size={PAGE}");
    let mut args: Vec<String> = target_args().into();
    args.extend([search, shim, page]);
    args.extend(["-Wl,--no-undefined", "-Wl,-soname,libapp_android.so", STRIP].map(str::to_owned));
    let mut build = ANDROID.build(toolchain, profile, &args)?;
    build.env("CARGO_TARGET_AARCH64_LINUX_ANDROID_LINKER", CLANG);
    command::run(&mut build)?;
    Ok(built(toolchain, profile))
}

fn target_args() -> [String; 3] {
    let linker = command::find(LINKER).unwrap_or_else(|| LINKER.into());
    [
        format!("--target=aarch64-linux-android{ANDROID_API}"),
        format!("--ld-path={}", linker.display()),
        "-nostdlib".to_owned(),
    ]
}

fn clang() -> Command {
    let mut clang = Command::new(CLANG);
    clang.args(target_args()).arg("-Wno-unused-command-line-argument");
    clang
}

/// Fetches the unwinder with its own lists and cache, so that the machine keeps its one
/// architecture.
fn unwinder(folder: &Path) -> Result<PathBuf> {
    let unpacked = folder.join("unwinder");
    let library = unpacked.join("usr/lib/llvm-19/lib/libunwind.a");
    if library.is_file() {
        return Ok(library);
    }
    let apt = folder.join("apt");
    for part in ["lists/partial", "cache/archives/partial"] {
        fs::create_dir_all(apt.join(part))?;
    }
    let apt_get = |args: &[&str]| {
        let mut command = Command::new("apt-get");
        for (key, value) in [
            ("APT::Architecture", "arm64".into()),
            ("APT::Architectures::", "arm64".into()),
            ("APT::Sandbox::User", "root".into()),
            ("Dir::State::lists", apt.join("lists").display().to_string()),
            ("Dir::State::status", "/dev/null".into()),
            ("Dir::Cache", apt.join("cache").display().to_string()),
        ] {
            command.arg("-o").arg(format!("{key}={value}"));
        }
        command::run(command.arg("--quiet").args(args).current_dir(&apt))
    };
    apt_get(&["update"])?;
    apt_get(&["download", UNWINDER])?;
    let archive = fs::read_dir(&apt)?
        .flatten()
        .map(|entry| entry.path())
        .find(|path| path.extension().is_some_and(|end| end == "deb"))
        .with_context(|| format!("{UNWINDER} was not fetched"))?;
    command::run(
        Command::new("dpkg-deb")
            .arg("--extract")
            .arg(archive)
            .arg(&unpacked),
    )?;
    if !library.is_file() {
        bail!("{UNWINDER} has no {}", library.display());
    }
    Ok(library)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shell() -> PathBuf {
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../app-android")
    }

    #[test]
    fn the_oldest_android_of_the_manifest_is_the_first_that_has_every_import() {
        let imports = Imports::read(&shell().join("imports.txt"), true).expect("a list");
        let manifest = fs::read_to_string(shell().join("AndroidManifest.xml")).expect("a manifest");
        assert_eq!(imports.level(), ANDROID_API);
        assert!(manifest.contains(&format!("android:minSdkVersion=\"{ANDROID_API}\"")));
    }
}
