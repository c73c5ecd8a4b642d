//! The Android package: resources, manifest, library and, where they can be had, ARCore's classes; aligned, signed,
//! verified.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, bail};

use super::ndk;
use super::tools::{self, Tool};
use super::zip::{self, Entry};
use crate::command;

/// Tools of a package, where Android's own are missing.
#[rustfmt::skip] // One tool a line.
const TOOLS: [Tool; 4] = [
    Tool { program: "aapt2", package: "aapt" },
    Tool { program: "apksigner", package: "apksigner" },
    Tool { program: "unzip", package: "unzip" },
    Tool { program: "keytool", package: "default-jre-headless" },
];
/// What manifests refer to, from Debian: Android 10's.
const FRAMEWORK: &str = "/usr/share/android-framework-res/framework-res.apk";
const FRAMEWORK_PACKAGE: &str = "android-framework-res";
const KEYSTORE_PASSWORD: &str = "android";
const HAS_CODE: &str = "android:hasCode=\"true\"";
const LIBRARIES: &str = "lib/arm64-v8a";

/// ARCore's archive of classes, library and manifest (`com.google.ar:core`), which is not ours to hand on.
#[derive(Clone)]
pub(crate) struct Arcore {
    /// Where it lies.
    pub(crate) archive: PathBuf,
    /// What it must be, in hexadecimal.
    pub(crate) sha256: String,
}

/// Where the tools are: the SDK's, or Debian's.
struct Tools {
    aapt2: PathBuf,
    apksigner: PathBuf,
    /// What is compiled against.
    framework: PathBuf,
    /// Makes an Android program of Java's classes; only the SDK has it.
    d8: Option<PathBuf>,
}

/// ARCore's parts.
struct Unpacked {
    manifest: String,
    library: Vec<u8>,
    classes: Option<Vec<u8>>,
}

/// Makes, signs and verifies a package around the shell's `library`, and says what it is.
pub(super) fn make(shell: &Path, folder: &Path, library: Vec<u8>, arcore: Option<&Arcore>) -> Result<()> {
    let tools = Tools::find()?;
    let arcore = arcore.map(|arcore| arcore.unpack(folder, &tools)).transpose()?;
    let manifest = fs::read_to_string(shell.join("AndroidManifest.xml"))?;
    let has_code = arcore.as_ref().is_some_and(|arcore| arcore.classes.is_some());
    let manifest = manifest_for(
        &manifest,
        arcore.as_ref().map(|arcore| arcore.manifest.as_str()),
        has_code,
    )?;
    let mut entries = resources(&tools, shell, folder, &manifest)?;
    entries.push(entry("lib/arm64-v8a/libapp_android.so", library));
    if let Some(arcore) = arcore {
        entries.push(entry("lib/arm64-v8a/libarcore_sdk_c.so", arcore.library));
        entries.extend(arcore.classes.map(|classes| entry("classes.dex", classes)));
    }
    let apk = folder.join("shadow-retargeting.apk");
    fs::write(&apk, zip::write(&entries)?)?;
    sign(&tools, folder, &apk)?;
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
            let tools = ndk::newest_folder(&sdk.join("build-tools"))?;
            let platform = ndk::newest_folder(&sdk.join("platforms"))?;
            Some(Self {
                aapt2: tools.join("aapt2"),
                apksigner: tools.join("apksigner"),
                framework: platform.join("android.jar"),
                d8: Some(tools.join("d8")),
            })
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
            framework: FRAMEWORK.into(),
            d8: None,
        })
    }
}

impl Arcore {
    fn unpack(&self, folder: &Path, tools: &Tools) -> Result<Unpacked> {
        let archive = fs::canonicalize(&self.archive).with_context(|| self.archive.display().to_string())?;
        let sum = sha256(&archive)?;
        if !sum.eq_ignore_ascii_case(&self.sha256) {
            bail!("{}: SHA-256 is {sum}, not {}", archive.display(), self.sha256);
        }
        let unpacked = folder.join("arcore");
        let _ = fs::remove_dir_all(&unpacked);
        fs::create_dir_all(&unpacked)?;
        command::run(
            Command::new("unzip")
                .args(["-q"])
                .arg(&archive)
                .current_dir(&unpacked),
        )?;
        let classes = match &tools.d8 {
            Some(d8) => {
                let mut dex = Command::new(d8);
                dex.args(["--release", "--min-api", &ndk::ANDROID_API.to_string(), "--lib"]);
                dex.arg(&tools.framework).arg("--output").arg(&unpacked);
                command::run(dex.arg(unpacked.join("classes.jar")))?;
                Some(fs::read(unpacked.join("classes.dex"))?)
            }
            None => None,
        };
        Ok(Unpacked {
            manifest: fs::read_to_string(unpacked.join("AndroidManifest.xml"))?,
            library: fs::read(unpacked.join("jni/arm64-v8a/libarcore_sdk_c.so"))
                .context("no library for 64-bit ARM in ARCore's archive")?,
            classes,
        })
    }
}

fn sha256(file: &Path) -> Result<String> {
    let name = file.display().to_string();
    let sum = command::output("sha256sum", &[&name])
        .or_else(|| command::output("shasum", &["-a", "256", &name]))
        .context("neither sha256sum nor shasum runs here")?;
    Ok(sum.split_whitespace().next().unwrap_or_default().to_owned())
}

/// Our manifest, joined with ARCore's, and true about whether there are classes.
fn manifest_for(ours: &str, arcore: Option<&str>, has_code: bool) -> Result<String> {
    if ours.matches(HAS_CODE).count() != 1 {
        bail!("the manifest does not say {HAS_CODE} once");
    }
    let mut manifest = ours.replace(HAS_CODE, &format!("android:hasCode=\"{has_code}\""));
    for (tag, before) in [("application", "</application>"), ("queries", "<application")] {
        let Some(inside) = arcore.and_then(|manifest| inside(manifest, tag)) else {
            continue;
        };
        let inside = if tag == "queries" {
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

/// What stands inside the first element `tag`.
fn inside<'a>(xml: &'a str, tag: &str) -> Option<&'a str> {
    let from = &xml[xml.find(&format!("<{tag}"))?..];
    let inside = &from[from.find('>')? + 1..];
    Some(&inside[..inside.find(&format!("</{tag}>"))?])
}

/// Manifest and resources as Android reads them.
fn resources(tools: &Tools, shell: &Path, folder: &Path, manifest: &str) -> Result<Vec<Entry>> {
    let (text, compiled, linked) = (
        folder.join("AndroidManifest.xml"),
        folder.join("resources.zip"),
        folder.join("resources"),
    );
    fs::write(&text, manifest)?;
    let _ = fs::remove_dir_all(&linked);
    fs::create_dir_all(&linked)?;
    let mut compile = Command::new(&tools.aapt2);
    compile.arg("compile").arg("--dir").arg(shell.join("res"));
    command::run(compile.arg("-o").arg(&compiled))?;
    let mut link = Command::new(&tools.aapt2);
    link.args(["link", "--version-name", env!("CARGO_PKG_VERSION")]);
    link.args([
        "--version-code",
        &version_code(env!("CARGO_PKG_VERSION"))?.to_string(),
    ]);
    link.arg("-I").arg(&tools.framework).arg("--manifest").arg(&text);
    let base = folder.join("base.zip");
    command::run(link.arg("-o").arg(&base).arg(&compiled))?;
    command::run(Command::new("unzip").arg("-q").arg(&base).arg("-d").arg(&linked))?;
    let mut entries = Vec::new();
    let mut folders = vec![linked.clone()];
    while let Some(folder) = folders.pop() {
        for path in fs::read_dir(folder)?.flatten().map(|entry| entry.path()) {
            if path.is_dir() {
                folders.push(path);
            } else {
                let name = path.strip_prefix(&linked)?.display().to_string();
                entries.push(entry(&name, fs::read(&path)?));
            }
        }
    }
    entries.sort_by(|one, other| one.name.cmp(&other.name));
    Ok(entries)
}

/// A number that grows with the version, as the store asks: two digits for each part.
fn version_code(version: &str) -> Result<u32> {
    version.split('.').try_fold(0, |code, part| {
        let part: u32 = part.parse().with_context(|| format!("version {version}"))?;
        if part > 99 {
            bail!("version {version}: a part above 99 has no place in the version code");
        }
        Ok(100 * code + part)
    })
}

/// Signs with a key of this machine alone, as for trying out.
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
    // Every phone of that level takes the later schemes, which cover the whole file.
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
mod tests {
    use super::*;

    const OURS: &str =
        r#"<manifest><application android:hasCode="true"><activity/></application></manifest>"#;
    const ARCORE: &str =
        r#"<manifest><queries><package/></queries><application ><meta-data/></application></manifest>"#;

    #[test]
    fn a_manifest_is_joined_with_that_of_arcore() {
        let joined = manifest_for(OURS, Some(ARCORE), true).expect("a manifest");
        let expected = r#"<manifest><queries><package/></queries><application android:hasCode="true"><activity/><meta-data/></application></manifest>"#;
        assert_eq!(joined, expected);
    }

    #[test]
    fn without_classes_a_manifest_has_no_code() {
        let alone = manifest_for(OURS, None, false).expect("a manifest");
        assert_eq!(alone, OURS.replace("true", "false"));
        assert!(
            manifest_for(&alone, None, false).is_err(),
            "says nothing to replace"
        );
    }

    #[test]
    fn version_codes_grow_with_versions() {
        let codes = ["0.1.0", "0.1.1", "0.2.0", "1.0.0"].map(|version| version_code(version).ok());
        assert_eq!(codes, [Some(100), Some(101), Some(200), Some(10_000)]);
        assert!(version_code("0.100.0").is_err());
        assert!(version_code("0.1.0-beta").is_err());
    }
}
