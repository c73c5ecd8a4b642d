//! The Android package: resources, manifest, library and, if available, ARCore's classes; aligned,
//! signed, verified.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, bail};

use super::arcore::{Arcore, Unpacked, files_below, unzip};
use super::tools::{self, Tool};
use super::zip::{self, Entry};
use super::{NOTICES, ndk};
use crate::command;

/// Tools of a package in place of Android's own.
#[rustfmt::skip] // One tool a line.
const TOOLS: [Tool; 4] = [
    Tool { program: "aapt2", package: "aapt" },
    Tool { program: "apksigner", package: "apksigner" },
    Tool { program: "unzip", package: "unzip" },
    Tool { program: "keytool", package: "default-jre-headless" },
];
/// Debian's framework resources, of Android 10, which manifests refer to.
const FRAMEWORK: &str = "/usr/share/android-framework-res/framework-res.apk";
const FRAMEWORK_PACKAGE: &str = "android-framework-res";
const KEYSTORE_PASSWORD: &str = "android";
const HAS_CODE: &str = "android:hasCode=\"true\"";
const LIBRARIES: &str = "lib/arm64-v8a";
/// API level of the Android that introduced `<queries>`: older tools refuse the element.
const QUERIES: u32 = 30;
/// Attributes of our manifest that tools below an API level refuse.
const NEWER_ATTRIBUTES: [(&str, u32); 1] = [("android:enableOnBackInvokedCallback=\"false\"", 33)];

/// Paths of the tools: the SDK's, or Debian's.
struct Tools {
    aapt2: PathBuf,
    apksigner: PathBuf,
    /// The framework to compile against.
    framework: PathBuf,
    /// Its API level, which decides on the permitted parts of a manifest.
    framework_api: u32,
    /// The compiler from Java classes to an Android program; only the SDK has it.
    d8: Option<PathBuf>,
}

/// Makes, signs and verifies a package around the shell's `library`, and describes it.
pub(super) fn make(shell: &Path, folder: &Path, library: Vec<u8>, arcore: Option<&Arcore>) -> Result<()> {
    make_with(&Tools::find()?, shell, folder, library, arcore)
}

fn make_with(
    tools: &Tools,
    shell: &Path,
    folder: &Path,
    library: Vec<u8>,
    arcore: Option<&Arcore>,
) -> Result<()> {
    let arcore = arcore.map(|arcore| arcore.unpack(folder)).transpose()?;
    let has_code = arcore.is_some() && tools.d8.is_some();
    let manifest = manifest_for(
        &fs::read_to_string(shell.join("AndroidManifest.xml"))?,
        arcore.as_ref().map(|arcore| arcore.manifest.as_str()),
        has_code,
        tools.framework_api,
    )?;
    let sources = folder.join("sources");
    let mut entries = resources(tools, shell, folder, &sources, &manifest, arcore.as_ref())?;
    entries.push(entry("lib/arm64-v8a/libapp_android.so", library));
    let notices = fs::read(shell.with_file_name(NOTICES))?;
    entries.push(entry(&format!("assets/{NOTICES}"), notices));
    if let Some(arcore) = arcore {
        let program = arcore.program(&tools.framework, tools.d8.as_deref(), &sources)?;
        entries.push(entry("lib/arm64-v8a/libarcore_sdk_c.so", arcore.library));
        entries.extend(program.map(|program| entry("classes.dex", program)));
    }
    let apk = folder.join("shadow-retargeting.apk");
    fs::write(&apk, zip::write(&entries)?)?;
    sign(tools, folder, &apk)?;
    report(&apk, has_code)
}

fn entry(name: &str, bytes: Vec<u8>) -> Entry {
    Entry {
        name: name.to_owned(),
        bytes,
        is_program: false,
    }
}

impl Tools {
    fn find() -> Result<Self> {
        let of_sdk = ndk::sdk().and_then(|sdk| {
            let tools = Self::of_sdk(&sdk);
            tools
                .inspect_err(|error| println!("the SDK in {} is not used: {error}", sdk.display()))
                .ok()
        });
        if let Some(tools) = of_sdk {
            return Ok(tools);
        }
        tools::ensure(&TOOLS)?;
        if !Path::new(FRAMEWORK).is_file() {
            crate::debian::install(&format!("packaging needs {FRAMEWORK}"), &[FRAMEWORK_PACKAGE])?;
        }
        Ok(Self {
            aapt2: "aapt2".into(),
            apksigner: "apksigner".into(),
            framework_api: framework_level(FRAMEWORK),
            framework: FRAMEWORK.into(),
            d8: None,
        })
    }

    /// The newest tools of the SDK.
    fn of_sdk(sdk: &Path) -> Result<Self> {
        let tools = ndk::newest_folder(&sdk.join("build-tools")).context("it has no build-tools")?;
        let platform = ndk::newest_folder(&sdk.join("platforms")).context("it has no platforms")?;
        let level =
            level_of(&platform).with_context(|| format!("{}: of which API level?", platform.display()))?;
        Ok(Self {
            aapt2: tools.join("aapt2"),
            apksigner: tools.join("apksigner"),
            framework_api: level,
            framework: platform.join("android.jar"),
            d8: Some(tools.join("d8")),
        })
    }
}

/// The API level of an SDK's platform, from its folder's name: `android-36`, `android-36.1`,
/// `android-36-ext18`.
fn level_of(platform: &Path) -> Option<u32> {
    let name = platform.file_name()?.to_str()?;
    let number = name.strip_prefix("android-")?;
    number
        .split(|letter: char| !letter.is_ascii_digit())
        .next()?
        .parse()
        .ok()
}

/// The API level that a framework states; the oldest supported one if it states none.
fn framework_level(framework: &str) -> u32 {
    let told = command::output("aapt2", &["dump", "badging", framework]).unwrap_or_default();
    let level = told
        .split_once("sdkVersion:'")
        .and_then(|(_, rest)| rest.split('\'').next()?.parse().ok());
    level.unwrap_or(ndk::ANDROID_API)
}

/// Our manifest, merged with ARCore's, with the right statement about classes, and without parts
/// that the framework of that level does not know: such a package is for inspection only.
fn manifest_for(ours: &str, arcore: Option<&str>, has_code: bool, framework_api: u32) -> Result<String> {
    if ours.matches(HAS_CODE).count() != 1 {
        bail!("the manifest does not say {HAS_CODE} once");
    }
    let mut manifest = ours.replace(HAS_CODE, &format!("android:hasCode=\"{has_code}\""));
    for (attribute, level) in NEWER_ATTRIBUTES {
        if framework_api < level && manifest.contains(attribute) {
            println!("{attribute} is left out: it is of API level {level}, the framework of {framework_api}");
            manifest = manifest.replace(attribute, "");
        }
    }
    for (tag, before) in [("application", "</application>"), ("queries", "<application")] {
        let Some(inside) = arcore.and_then(|manifest| inside(manifest, tag)) else {
            continue;
        };
        let inside = if tag == "queries" {
            if framework_api < QUERIES {
                println!(
                    "<queries> is left out: it is of API level {QUERIES}, the framework of {framework_api}"
                );
                continue;
            }
            format!("<queries>{inside}</queries>")
        } else {
            inside.to_owned()
        };
        let at = manifest
            .find(before)
            .with_context(|| format!("no {before} in the manifest"))?;
        manifest.insert_str(at, &inside);
    }
    Ok(manifest)
}

/// The contents of the first element `tag`.
fn inside<'a>(xml: &'a str, tag: &str) -> Option<&'a str> {
    let from = &xml[xml.find(&format!("<{tag}"))?..];
    let inside = &from[from.find('>')? + 1..];
    Some(&inside[..inside.find(&format!("</{tag}>"))?])
}

/// Manifest and resources as Android reads them; the sources of their R classes go to the second
/// folder.
fn resources(
    tools: &Tools,
    shell: &Path,
    folder: &Path,
    sources: &Path,
    manifest: &str,
    arcore: Option<&Unpacked>,
) -> Result<Vec<Entry>> {
    let (text, linked) = (folder.join("AndroidManifest.xml"), folder.join("resources"));
    fs::write(&text, manifest)?;
    let _ = fs::remove_dir_all(sources);
    let mut compiled = vec![compile(tools, &shell.join("res"), folder.join("resources.zip"))?];
    let mut link = Command::new(&tools.aapt2);
    link.args(["link", "--version-name", env!("CARGO_PKG_VERSION")]);
    link.args([
        "--version-code",
        &version_code(env!("CARGO_PKG_VERSION"))?.to_string(),
    ]);
    link.arg("-I").arg(&tools.framework).arg("--manifest").arg(&text);
    if let Some((arcore, resources)) = arcore.and_then(|arcore| Some((arcore, arcore.resources()?))) {
        compiled.push(compile(tools, &resources, folder.join("arcore.zip"))?);
        link.args(["--auto-add-overlay", "--extra-packages", arcore.package()?]);
        link.arg("--java").arg(sources);
    }
    let base = folder.join("base.zip");
    command::run(link.arg("-o").arg(&base).args(&compiled))?;
    unzip(&base, &linked)?;
    let entries = files_below(&linked).into_iter().map(|path| {
        let name = path.strip_prefix(&linked)?.display().to_string();
        Ok(entry(&name, fs::read(&path)?))
    });
    entries.collect()
}

fn compile(tools: &Tools, resources: &Path, compiled: PathBuf) -> Result<PathBuf> {
    let mut compile = Command::new(&tools.aapt2);
    compile.arg("compile").arg("--dir").arg(resources);
    command::run(compile.arg("-o").arg(&compiled))?;
    Ok(compiled)
}

/// A number that grows with the version, as the store requires: two digits for each part.
fn version_code(version: &str) -> Result<u32> {
    version.split('.').try_fold(0, |code, part| {
        let part: u32 = part.parse().with_context(|| format!("version {version}"))?;
        if part > 99 {
            bail!("version {version}: a part above 99 has no place in the version code");
        }
        Ok(100 * code + part)
    })
}

/// Signs with a key of this machine alone, for trials.
fn sign(tools: &Tools, folder: &Path, apk: &Path) -> Result<()> {
    let keystore = folder.join("debug.keystore");
    if !keystore.is_file() {
        let mut make = Command::new("keytool");
        make.args([
            "-genkeypair",
            "-alias",
            "debug",
            "-dname",
            "CN=Debug",
            "-keyalg",
            "RSA",
        ]);
        make.args(["-keysize", "2048", "-validity", "10000", "-storetype", "PKCS12"]);
        make.args(["-storepass", KEYSTORE_PASSWORD, "-keystore"]);
        command::run(make.arg(&keystore))?;
    }
    let level = ndk::ANDROID_API.to_string();
    let mut sign = Command::new(&tools.apksigner);
    // Every phone of that level supports the later schemes, which cover the whole file.
    sign.args([
        "sign",
        "--v1-signing-enabled",
        "false",
        "--min-sdk-version",
        &level,
        "--ks",
    ]);
    sign.arg(&keystore);
    sign.args(["--ks-pass", &format!("pass:{KEYSTORE_PASSWORD}")]);
    command::run(sign.arg(apk))?;
    let mut verify = Command::new(&tools.apksigner);
    verify.args(["verify", "--verbose", "--min-sdk-version", &level]);
    command::run(verify.arg(apk))
}

fn report(apk: &Path, has_code: bool) -> Result<()> {
    let archive = fs::read(apk)?;
    let found = zip::read(&archive)?;
    println!(
        "{}: {} bytes, signed with a key of this machine",
        apk.display(),
        archive.len()
    );
    for found in &found {
        println!("  {:>9} bytes at {:>8}  {}", found.n_bytes, found.at, found.name);
        if !found.is_aligned() || (found.name.starts_with(LIBRARIES) && !found.is_stored) {
            bail!("{} is not where phones with pages of 16 KB map it", found.name);
        }
    }
    if has_code && ndk::ndk().is_some() {
        println!("install it with: adb install -r {}", apk.display());
    } else {
        println!("This is a check and no app to hand on:");
    }
    if !has_code {
        println!(
            "  without ARCore's classes, which need its archive (--arcore, --sha256) and the SDK's d8, no session can begin"
        );
    }
    if ndk::ndk().is_none() {
        println!("  linked without the NDK: no phone has run such a library");
    }
    Ok(())
}

#[cfg(test)]
mod tests;
