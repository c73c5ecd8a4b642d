//! Fetches files from a phone by cable: the app's log, its times and its recordings, and its
//! messages in the system's log.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, bail};

use super::{ANDROID, Phone};
use crate::command;

/// The Android app's folder that is accessible by cable.
const ANDROID_FILES: &str = "/sdcard/Android/data/org.example.shadowretargeting/files/.";
/// Tag of the app's output in the system's log.
const ANDROID_TAG: &str = "RustStdoutStderr";
/// The log that the app writes at run time.
const LOG: &str = "log.txt";
/// Lines of it that are printed at once: the error of the device's test picture, and starts and
/// ends.
const SHOWN: [&str; 4] = ["test picture", "self-test", "preset fast", "Simplified"];

/// The iPhone, and the app on it, since each team has its own identifier.
#[derive(Clone, Debug, Default)]
pub(crate) struct IphoneApp {
    pub(crate) device: Option<String>,
    pub(crate) bundle: Option<String>,
}

/// Fetches the files into a folder of `target`.
pub(super) fn fetch(root: &Path, phone: &Phone, app: &IphoneApp) -> Result<()> {
    let folder = root.join("target/phone/log").join(phone.package);
    if phone.package == ANDROID.package {
        fetch_android(Path::new("adb"), &folder)
    } else {
        fetch_iphone(Path::new("xcrun"), &folder, app)
    }
}

fn fetch_android(adb: &Path, folder: &Path) -> Result<()> {
    let partial = empty_beside(folder)?;
    command::run(Command::new(adb).arg("pull").arg(ANDROID_FILES).arg(&partial))
        .context("adb comes with the SDK's platform-tools, and the phone has to allow debugging")?;
    let told = command::output(&adb.display().to_string(), &["logcat", "-d", "-s", ANDROID_TAG]);
    fs::write(partial.join("logcat.txt"), told.unwrap_or_default())?;
    replace(folder, &partial)
}

fn fetch_iphone(xcrun: &Path, folder: &Path, app: &IphoneApp) -> Result<()> {
    let Some(device) = &app.device else {
        bail!("--device NAME: which iPhone? `xcrun devicectl list devices` names them");
    };
    let partial = empty_beside(folder)?;
    let mut copy = Command::new(xcrun);
    copy.args(["devicectl", "device", "copy", "from", "--device", device]);
    copy.args(["--domain-type", "appDataContainer", "--domain-identifier"]);
    copy.arg(app.bundle.as_deref().unwrap_or(super::ios::BUNDLE));
    command::run(
        copy.args(["--source", "Documents", "--destination"])
            .arg(&partial),
    )
    .context("devicectl comes with Xcode 15; --bundle names the identifier that the app was signed with")?;
    replace(folder, &partial)
}

/// Makes an empty folder beside the one of the files: what was fetched before stays until there is
/// more.
fn empty_beside(folder: &Path) -> Result<PathBuf> {
    let mut name = folder.file_name().unwrap_or_default().to_owned();
    name.push(".partial");
    let partial = folder.with_file_name(name);
    remove(&partial)?;
    fs::create_dir_all(&partial)?;
    Ok(partial)
}

fn remove(folder: &Path) -> Result<()> {
    if folder.exists() {
        fs::remove_dir_all(folder).with_context(|| format!("{} has to be emptied", folder.display()))?;
    }
    Ok(())
}

/// Puts the fetched files in the place of earlier ones, for which they could be mistaken, and shows
/// them.
fn replace(folder: &Path, partial: &Path) -> Result<()> {
    if log_in(partial).is_none() {
        bail!("{}: no {LOG}: the app has drawn nothing yet", partial.display());
    }
    remove(folder)?;
    fs::rename(partial, folder)?;
    show(folder)
}

/// The log among the files of a phone.
fn log_in(folder: &Path) -> Option<PathBuf> {
    let places = [folder.join(LOG), folder.join("Documents").join(LOG)];
    places.into_iter().find(|path| path.is_file())
}

/// Prints the path of the files, and the most important lines.
fn show(folder: &Path) -> Result<()> {
    let Some(log) = log_in(folder) else {
        return Ok(());
    };
    println!("{}:", log.display());
    let text = fs::read_to_string(&log)?;
    for line in text
        .lines()
        .filter(|line| SHOWN.iter().any(|shown| line.contains(shown)))
    {
        println!("  {}", line.trim());
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A program that records its arguments and runs `script`.
    fn stand_in(folder: &Path, script: &str) -> PathBuf {
        let program = folder.join("program");
        let note = format!("#!/bin/sh\necho \"$*\" >> {}/asked\n{script}\n", folder.display());
        fs::write(&program, note).expect("a script");
        command::run(Command::new("chmod").arg("+x").arg(&program)).expect("a program");
        program
    }

    #[test]
    fn the_log_is_fetched_by_one_command_or_it_is_said_what_is_missing() {
        let folder = std::env::temp_dir().join(format!("xtask-log-{}", std::process::id()));
        fs::create_dir_all(&folder).expect("a folder");
        let (to, log) = (folder.join("to"), "0.1 (\"test picture\", \"0.20 codes off\")");
        let adb = stand_in(
            &folder,
            &format!("[ $1 = pull ] && echo '{log}' > $3/log.txt || echo told"),
        );
        fetch_android(&adb, &to).expect("a log");
        let asked = fs::read_to_string(folder.join("asked")).expect("what was asked for");
        let to_name = to.display();
        assert_eq!(
            asked,
            format!("pull {ANDROID_FILES} {to_name}.partial\nlogcat -d -s {ANDROID_TAG}\n")
        );
        assert_eq!(
            fs::read_to_string(to.join("logcat.txt")).expect("a log"),
            "told\n"
        );
        fs::remove_dir_all(&to).expect("a folder");

        let app = IphoneApp {
            device: Some("mine".to_owned()),
            bundle: Some("org.me.toy".to_owned()),
        };
        let xcrun = stand_in(
            &folder,
            "while [ \"$1\" != --destination ]; do shift; done; mkdir $2/Documents; echo x > $2/Documents/log.txt",
        );
        fetch_iphone(&xcrun, &to, &app).expect("a log");
        let asked = fs::read_to_string(folder.join("asked")).expect("what was asked for");
        assert!(asked.contains("--device mine --domain-type appDataContainer --domain-identifier org.me.toy --source Documents"), "{asked}");
        let error = fetch_iphone(&xcrun, &to, &IphoneApp::default())
            .expect_err("which?")
            .to_string();
        assert!(error.contains("--device"), "{error}");

        // Earlier files are not shown as new ones, and stay if nothing is fetched.
        fs::write(to.join("log.txt"), "old").expect("a log");
        fs::write(to.join("toy.mcap"), "a recording").expect("a recording");
        for (script, reason) in [("true", "no log.txt"), ("exit 1", "adb comes with")] {
            let error = fetch_android(&stand_in(&folder, script), &to).expect_err("no log");
            assert!(error.to_string().contains(reason), "{error}");
            assert!(
                to.join("log.txt").exists() && to.join("toy.mcap").exists(),
                "{reason}"
            );
        }
        fs::remove_dir_all(folder).expect("a folder");
    }

    #[test]
    fn the_folder_is_that_of_the_manifests_package() {
        let manifest = include_str!("../../../app-android/AndroidManifest.xml");
        let package = ANDROID_FILES.split('/').nth(4).expect("a package");
        assert!(manifest.contains(&format!("package=\"{package}\"")), "{package}");
    }
}
