//! The iPhone app: built by Xcode on a Mac; on other systems linked against stubs of Apple's
//! libraries and packed.
//!
//! The stubs are text stubs with the names of `app-ios/imports.txt` and nothing else, so that the
//! link proves that the shell imports nothing else. Nothing of Apple's is needed, and no phone
//! accepts the resulting app.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, bail};

use super::imports::{Imports, text_stub};
use super::macho::{self, Executable};
use super::tools::{self, Tool};
use super::zip::{self, Entry};
use super::{IOS, NOTICES, Profile};
use crate::command;
use crate::toolchain::Toolchain;

const NAME: &str = "ShadowRetargeting";
pub(super) const BUNDLE: &str = "org.example.ShadowRetargeting";
/// Oldest supported iOS; the project for Xcode has the same.
const OLDEST: [u32; 2] = [16, 0];
/// The SDK version of the stubs.
const SDK: &str = "18.0";
const CLANG: &str = "clang-19";
const LINKER: &str = "ld64.lld-19";
#[rustfmt::skip] // One tool a line.
const TOOLS: [Tool; 2] = [
    Tool { program: CLANG, package: "clang-19" },
    Tool { program: LINKER, package: "lld-19" },
];
/// Languages of the app, each with the system's questions in a folder of `words`.
const LANGUAGES: [&str; 2] = ["en", "de"];
/// Loaded although no name of it is imported: its classes are looked up at run time.
const ARKIT: &str = "/System/Library/Frameworks/ARKit.framework/ARKit";

/// Makes the app as far as this machine can.
pub(super) fn package(toolchain: &Toolchain, profile: Profile) -> Result<()> {
    let shell = toolchain.root.join(IOS.package);
    if cfg!(target_os = "macos") {
        by_xcode(toolchain, profile, &shell)
    } else {
        by_stand_ins(toolchain, profile, &shell)
    }
}

fn by_xcode(toolchain: &Toolchain, profile: Profile, shell: &Path) -> Result<()> {
    for (program, from) in [
        ("xcodebuild", "Xcode, from the App Store"),
        ("xcodegen", "brew install xcodegen"),
    ] {
        if command::find(program).is_none() {
            bail!("{program} is missing ({from})");
        }
    }
    command::run(&mut IOS.build(toolchain, profile, &[])?)?;
    command::run(
        Command::new("xcodegen")
            .arg("generate")
            .env("LIBRARY_PROFILE", profile.name())
            .current_dir(shell),
    )?;
    let project = shell.join(format!("{NAME}.xcodeproj"));
    let mut build = Command::new("xcodebuild");
    build.arg("-project").arg(&project);
    build.args(["-scheme", NAME, "-sdk", "iphoneos", "-configuration", "Release"]);
    command::run(build.args(["CODE_SIGNING_ALLOWED=NO", "build"]))?;
    println!(
        "Built without a signature. To run it, open {}, choose a signing team and a phone, and run.",
        project.display()
    );
    Ok(())
}

fn by_stand_ins(toolchain: &Toolchain, profile: Profile, shell: &Path) -> Result<()> {
    tools::ensure(&TOOLS)?;
    let folder = toolchain.root.join("target/phone/ios");
    fs::create_dir_all(&folder)?;
    let imports = Imports::read(&shell.join("imports.txt"), false)?;
    command::run(&mut IOS.build(toolchain, profile, &[])?)?;
    let program = link(toolchain, profile, shell, &folder, &imports)?;
    let file = fs::read(&program)?;
    let executable = Executable::read(&file).with_context(|| program.display().to_string())?;
    check(&executable, &imports)?;
    println!(
        "{}: {} bytes, arm64, iOS {}.{} or later\n  imports: {} of {} libraries, ARKit among them",
        program.display(),
        file.len(),
        OLDEST[0],
        OLDEST[1],
        executable.imports.len(),
        executable.loads.len()
    );
    pack(shell, &folder, file)
}

/// Links `main.c` and the library against stubs.
fn link(
    toolchain: &Toolchain,
    profile: Profile,
    shell: &Path,
    folder: &Path,
    imports: &Imports,
) -> Result<PathBuf> {
    let sdk = folder.join("sdk");
    let _ = fs::remove_dir_all(&sdk);
    let mut libraries = Vec::new();
    for (path, names) in imports.libraries() {
        let stub = sdk.join(path.trim_start_matches('/')).with_extension("tbd");
        fs::create_dir_all(stub.parent().context("a library in no folder")?)?;
        fs::write(&stub, text_stub(path, &names))?;
        libraries.push(stub);
    }
    let object = folder.join("main.o");
    let oldest = format!("{}.{}", OLDEST[0], OLDEST[1]);
    let mut compile = Command::new(CLANG);
    compile.args(["-target", &format!("arm64-apple-ios{oldest}"), "-O2", "-c"]);
    command::run(compile.arg(shell.join("main.c")).arg("-o").arg(&object))?;

    let program = folder.join(NAME);
    let mut link = Command::new(LINKER);
    link.args(["-arch", "arm64", "-platform_version", "ios", &oldest, SDK]);
    // Without unused code, without symbols for a debugger, with the minimal signature that arm64
    // requires.
    link.args(["-dead_strip", "-S", "-x", "-adhoc_codesign", "-syslibroot"])
        .arg(&sdk);
    link.arg("-o").arg(&program).arg(&object);
    link.arg(
        toolchain
            .build_folder()
            .join(IOS.target)
            .join(profile.name())
            .join("libapp_ios.a"),
    );
    // Reports every missing name at once.
    link.arg("--error-limit=0");
    // By their paths, so that each is loaded even without imports.
    command::run(link.args(libraries))?;
    Ok(program)
}

fn check(executable: &Executable, imports: &Imports) -> Result<()> {
    if (executable.processor, executable.kind) != (macho::ARM64, macho::EXECUTABLE) {
        bail!("not an executable for arm64");
    }
    if executable.platform != Some((macho::IOS, OLDEST)) {
        bail!("made for {:?}, not for iOS {OLDEST:?}", executable.platform);
    }
    if !executable.loads.contains(ARKIT) {
        bail!("ARKit is not loaded: none of its classes would be found");
    }
    imports.compare(&executable.imports, |_| true)
}

/// Packs the app as an archive.
fn pack(shell: &Path, folder: &Path, program: Vec<u8>) -> Result<()> {
    let app = format!("Payload/{NAME}.app");
    let entry = |name: &str, bytes: Vec<u8>| Entry {
        name: format!("{app}/{name}"),
        is_program: name == NAME,
        bytes,
    };
    let properties = properties(&fs::read_to_string(shell.join("Info.plist"))?)?;
    let mut entries = vec![
        entry(NAME, program),
        entry("Info.plist", properties.into_bytes()),
        entry("PkgInfo", b"APPL????".to_vec()),
        entry(NOTICES, fs::read(shell.with_file_name(NOTICES))?),
        entry(
            "PrivacyInfo.xcprivacy",
            fs::read(shell.join("PrivacyInfo.xcprivacy"))?,
        ),
    ];
    for language in LANGUAGES {
        let name = format!("{language}.lproj/InfoPlist.strings");
        entries.push(entry(&name, fs::read(shell.join("words").join(&name))?));
    }
    for size in ["60x60@2x", "60x60@3x"] {
        let name = format!("AppIcon{size}.png");
        entries.push(entry(&name, fs::read(shell.join("icon").join(&name))?));
    }
    let ipa = folder.join(format!("{NAME}.ipa"));
    let archive = zip::write(&entries)?;
    fs::write(&ipa, &archive)?;
    println!("{}: {} bytes", ipa.display(), archive.len());
    for found in zip::read(&archive)? {
        println!("  {:>9} bytes  {}", found.n_bytes, found.name);
    }
    println!(
        "This is a check and no app to hand on:\n  linked without Apple's SDK, and without a signature that a phone takes"
    );
    Ok(())
}

/// The property list with Xcode's variables filled in.
fn properties(text: &str) -> Result<String> {
    let filled = [
        ("$(EXECUTABLE_NAME)", NAME),
        ("$(PRODUCT_NAME)", NAME),
        ("$(PRODUCT_BUNDLE_IDENTIFIER)", BUNDLE),
        ("$(MARKETING_VERSION)", env!("CARGO_PKG_VERSION")),
        ("$(CURRENT_PROJECT_VERSION)", "1"),
    ]
    .iter()
    .fold(text.to_owned(), |text, (variable, value)| {
        text.replace(variable, value)
    });
    match filled.split_once("$(") {
        Some((_, rest)) => bail!(
            "Info.plist: nothing is known of $({}",
            rest.lines().next().unwrap_or_default()
        ),
        None => Ok(filled),
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;

    const FRAMEWORKS: &str = "/System/Library/Frameworks/";

    fn shell(name: &str) -> String {
        let path = Path::new(env!("CARGO_MANIFEST_DIR"))
            .join("../app-ios")
            .join(name);
        fs::read_to_string(path).expect("a file of the shell")
    }

    #[test]
    fn every_variable_of_the_property_list_is_known() {
        let filled = properties(&shell("Info.plist")).expect("a property list");
        assert!(filled.contains(&format!("<string>{BUNDLE}</string>")));
        assert!(properties("$(PRODUCT_NAME) $(OTHER)").is_err());
    }

    /// Keys and texts of a file of the system's questions.
    fn questions(strings: &str) -> Vec<(&str, &str)> {
        let entries = strings.lines().filter_map(|line| line.split_once(" = \""));
        entries
            .map(|(key, text)| (key, text.strip_suffix("\";").expect("the end of a text")))
            .collect()
    }

    #[test]
    fn the_systems_questions_are_there_in_each_language() {
        let properties = shell("Info.plist");
        let in_language =
            LANGUAGES.map(|language| shell(&format!("words/{language}.lproj/InfoPlist.strings")));
        let [english, german] = in_language.each_ref().map(|strings| questions(strings));
        assert_eq!(
            english.len(),
            properties.matches("UsageDescription</key>").count()
        );
        for ((key, text), (german_key, german)) in english.iter().zip(&german) {
            assert_eq!(key, german_key);
            assert!(properties.contains(&format!("<key>{key}</key>\n    <string>{text}</string>")));
            assert!(german != text && !german.is_empty(), "{key}");
        }
        assert_eq!(english.len(), german.len());
        let (_, list) = properties
            .split_once("<key>CFBundleLocalizations</key>")
            .expect("languages");
        let (list, _) = list.split_once("</array>").expect("their end");
        for language in LANGUAGES {
            assert!(
                list.contains(&format!("<string>{language}</string>")),
                "{language}"
            );
        }
        assert!(questions("A = \"b\";\n/* c */") == [("A", "b")]);
    }

    #[test]
    fn the_project_for_xcode_has_the_same_libraries_name_and_version() {
        let project = shell("project.yml");
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../app-ios/imports.txt");
        let imports = Imports::read(&path, false).expect("a list");
        for (library, _) in imports.libraries() {
            if let Some(name) = library.strip_prefix(FRAMEWORKS) {
                let framework = name.split('/').next().expect("a folder");
                assert!(
                    project.contains(&format!("- sdk: {framework}\n")),
                    "no {framework}"
                );
            }
        }
        let frameworks = imports
            .libraries()
            .filter(|(path, _)| path.starts_with(FRAMEWORKS));
        assert_eq!(project.matches("- sdk: ").count(), frameworks.count());
        assert!(project.contains(&format!("iOS: \"{}.{}\"", OLDEST[0], OLDEST[1])));
        assert!(project.contains(&format!("MARKETING_VERSION: \"{}\"", env!("CARGO_PKG_VERSION"))));
        assert!(project.contains(&format!("name: {NAME}\n")));
    }

    /// APIs for which Apple requires reasons, with their categories.
    const REASONS: [(&str, &str); 10] = [
        ("_fstat", "FileTimestamp"),
        ("_stat", "FileTimestamp"),
        ("_lstat", "FileTimestamp"),
        ("_fstatat", "FileTimestamp"),
        ("_getattrlist", "FileTimestamp"),
        ("_mach_absolute_time", "SystemBootTime"),
        ("_statfs", "DiskSpace"),
        ("_statvfs", "DiskSpace"),
        ("_fstatfs", "DiskSpace"),
        ("_fstatvfs", "DiskSpace"),
    ];

    #[test]
    fn the_privacy_manifest_has_a_reason_for_every_import_that_needs_one() {
        let (manifest, imports) = (shell("PrivacyInfo.xcprivacy"), shell("imports.txt"));
        let is_imported = |name: &str| imports.lines().any(|line| line.ends_with(&format!(" {name}")));
        for heading in ["FileTimestamp", "SystemBootTime", "DiskSpace"] {
            let needs = REASONS
                .iter()
                .any(|(name, of)| *of == heading && is_imported(name));
            let states = manifest.contains(&format!("NSPrivacyAccessedAPICategory{heading}<"));
            assert_eq!(needs, states, "{heading}");
        }
    }

    #[test]
    fn an_executable_without_arkit_or_for_another_version_is_refused() {
        let good = || Executable {
            processor: macho::ARM64,
            kind: macho::EXECUTABLE,
            platform: Some((macho::IOS, OLDEST)),
            loads: BTreeSet::from([ARKIT.to_owned()]),
            imports: BTreeSet::new(),
        };
        let none = Imports::default();
        assert!(check(&good(), &none).is_ok());
        #[rustfmt::skip] // One case a line.
        let wrong = [
            Executable { processor: 7, ..good() },
            Executable { platform: Some((macho::IOS, [17, 0])), ..good() },
            Executable { platform: Some((1, OLDEST)), ..good() },
            Executable { loads: BTreeSet::new(), ..good() },
            Executable { imports: BTreeSet::from(["_system".to_owned()]), ..good() },
        ];
        for wrong in wrong {
            assert!(check(&wrong, &none).is_err(), "{wrong:?}");
        }
    }
}
