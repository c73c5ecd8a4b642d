//! Unpacks ARCore's archive: its resources and their R classes, and all of its classes as an
//! Android program.
//!
//! An archive has resources and the names of their numbers, but not the R classes with the numbers:
//! these are made with the package, from all resources together. Its activity that installs ARCore
//! uses them, and ends the app if they are missing.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, bail};

use super::classes::{ClassFile, check_closure};
use super::ndk;
use super::tools::{self, Tool};
use crate::command;

/// Compiles R classes.
const COMPILER: Tool = Tool {
    program: "javac",
    package: "default-jdk-headless",
};

/// ARCore's archive of classes, library, resources and manifest (`com.google.ar:core`), which may
/// not be redistributed.
#[derive(Clone)]
pub(crate) struct Arcore {
    /// Path of the archive.
    pub(crate) archive: PathBuf,
    /// Its required checksum, in hexadecimal.
    pub(crate) sha256: String,
}

/// ARCore's parts, in a folder.
pub(super) struct Unpacked {
    folder: PathBuf,
    pub(super) manifest: String,
    pub(super) library: Vec<u8>,
}

impl Arcore {
    pub(super) fn unpack(&self, folder: &Path) -> Result<Unpacked> {
        let archive = fs::canonicalize(&self.archive).with_context(|| self.archive.display().to_string())?;
        let sum = sha256(&archive)?;
        if !sum.eq_ignore_ascii_case(&self.sha256) {
            bail!("{}: SHA-256 is {sum}, not {}", archive.display(), self.sha256);
        }
        let unpacked = folder.join("arcore");
        unzip(&archive, &unpacked)?;
        Ok(Unpacked {
            manifest: fs::read_to_string(unpacked.join("AndroidManifest.xml"))?,
            library: fs::read(unpacked.join("jni/arm64-v8a/libarcore_sdk_c.so"))
                .context("no library for 64-bit ARM in ARCore's archive")?,
            folder: unpacked,
        })
    }
}

impl Unpacked {
    /// The package of its R classes.
    pub(super) fn package(&self) -> Result<&str> {
        let named = self.manifest.split_once("package=\"").map(|(_, rest)| rest);
        let name = named.and_then(|rest| rest.split('"').next());
        name.context("the manifest of ARCore's archive names no package")
    }

    /// The folder of its resources, if there are any.
    pub(super) fn resources(&self) -> Option<PathBuf> {
        let folder = self.folder.join("res");
        let has_any = folder
            .read_dir()
            .is_ok_and(|mut entries| entries.next().is_some());
        has_any.then_some(folder)
    }

    /// Its classes with those of its resources, whose sources `aapt2` has written into `sources`:
    /// checked, and compiled to an Android program if the SDK's compiler is installed.
    pub(super) fn program(
        &self,
        framework: &Path,
        d8: Option<&Path>,
        sources: &Path,
    ) -> Result<Option<Vec<u8>>> {
        let jar = self.folder.join("classes.jar");
        let classes = self.folder.join("classes");
        unzip(&jar, &classes)?;
        let of_resources = self.compile_r(sources)?;
        let files = [&classes, &of_resources].map(|folder| files_below(folder));
        let mut read = Vec::new();
        for file in files.iter().flatten().filter(|file| is_class(file)) {
            let class = ClassFile::read(&fs::read(file)?).with_context(|| file.display().to_string())?;
            // The archive's module description is no class.
            if class.name != "module-info" {
                read.push(class);
            }
        }
        check_closure(&read, classes_of(framework).as_ref())?;
        println!("{} classes of ARCore's name none that is missing", read.len());
        let Some(d8) = d8 else {
            return Ok(None);
        };
        let mut dex = Command::new(d8);
        dex.args(["--release", "--min-api", &ndk::ANDROID_API.to_string(), "--lib"]);
        dex.arg(framework).arg("--output").arg(&self.folder).arg(&jar);
        command::run(dex.args(files_below(&of_resources).iter().filter(|file| is_class(file))))?;
        Ok(Some(fs::read(self.folder.join("classes.dex"))?))
    }

    /// Compiles the R classes of its package, in their own folder.
    fn compile_r(&self, sources: &Path) -> Result<PathBuf> {
        let compiled = self.folder.join("r");
        fs::create_dir_all(&compiled)?;
        let source = sources.join(self.package()?.replace('.', "/")).join("R.java");
        if self.resources().is_none() {
            return Ok(compiled);
        }
        tools::ensure(&[COMPILER])?;
        let mut compile = Command::new(COMPILER.program);
        compile.args(["-nowarn", "-source", "8", "-target", "8", "-Xlint:-options", "-d"]);
        command::run(compile.arg(&compiled).arg(source))?;
        Ok(compiled)
    }
}

fn is_class(file: &Path) -> bool {
    file.extension().is_some_and(|end| end == "class")
}

/// The classes of a Java archive, by their files; `None` if it has none, like an archive of
/// resources alone.
fn classes_of(jar: &Path) -> Option<BTreeSet<String>> {
    let list = command::output("unzip", &["-Z1", &jar.display().to_string()])?;
    let classes = list.lines().filter_map(|name| name.strip_suffix(".class"));
    let classes: BTreeSet<String> = classes.map(str::to_owned).collect();
    (!classes.is_empty()).then_some(classes)
}

/// All files of a folder and of those in it, by their names.
pub(super) fn files_below(folder: &Path) -> Vec<PathBuf> {
    let mut files = Vec::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(folder) = folders.pop() {
        let entries = fs::read_dir(folder).into_iter().flatten().flatten();
        for path in entries.map(|entry| entry.path()) {
            if path.is_dir() {
                folders.push(path);
            } else {
                files.push(path);
            }
        }
    }
    files.sort();
    files
}

/// Unpacks into an empty folder.
pub(super) fn unzip(archive: &Path, folder: &Path) -> Result<()> {
    let _ = fs::remove_dir_all(folder);
    fs::create_dir_all(folder)?;
    command::run(Command::new("unzip").arg("-q").arg(archive).arg("-d").arg(folder))
}

pub(super) fn sha256(file: &Path) -> Result<String> {
    let name = file.display().to_string();
    let sum = command::output("sha256sum", &[&name])
        .or_else(|| command::output("shasum", &["-a", "256", &name]))
        .context("neither sha256sum nor shasum runs here")?;
    Ok(sum.split_whitespace().next().unwrap_or_default().to_owned())
}
