//! Dependencies of the project: licences, sources and versions of every package that is compiled
//! for a desktop or a phone, and the packages that the core must not use.

use std::collections::{BTreeMap, BTreeSet};
use std::process::Command;

use serde::Deserialize;
use spdx::{Expression, ParseMode};

/// Desktop for replay and tests, and the two phones.
const TARGETS: [&str; 3] = [
    "x86_64-unknown-linux-gnu",
    "aarch64-apple-ios",
    "aarch64-linux-android",
];
/// Permissive licences: they require a notice and nothing else. Parts of AccessKit also carry the
/// BSD-3-Clause of Chromium and Flutter, whose notice both phones' packages contain
/// (`LICENSE-THIRD-PARTY`).
const LICENCES: [&str; 5] = ["MIT", "Apache-2.0", "ISC", "Unicode-3.0", "Zlib"];
/// Additional licences for the desktop programs: these require a notice from a distributor of
/// binaries, too.
const DESKTOP_LICENCES: [&str; 2] = ["BSD-2-Clause", "BSD-3-Clause"];
const CRATES_IO: &str = "registry+https://github.com/rust-lang/crates.io-index";
/// Packages of which more than one version is compiled, and the packages that cause it.
const TWICE: [(&str, &str); 12] = [
    ("hashbrown", "gpu-allocator is one behind wgpu"),
    ("jni-sys", "jni-sys 0.3 is a shim over 0.4"),
    ("linux-raw-sys", "follows rustix"),
    ("miniz_oxide", "png is one behind flate2"),
    ("objc2", "accesskit_ios is one behind"),
    ("objc2-foundation", "follows objc2"),
    ("objc2-ui-kit", "follows objc2"),
    ("rustc-hash", "naga is one behind egui-wgpu"),
    ("rustix", "winit is one behind x11rb"),
    ("syn", "derive macros move to 3 one by one"),
    ("thiserror", "ndk is at 1"),
    ("thiserror-impl", "follows thiserror"),
];
/// Windows, event loops, networks and file systems: these belong to the shells and the programs.
const NOT_IN_CORE: [&str; 14] = [
    "android-activity",
    "indicatif",
    "memmap2",
    "mio",
    "ndk",
    "notify",
    "objc2-ui-kit",
    "reqwest",
    "rustls",
    "socket2",
    "tempfile",
    "tokio",
    "walkdir",
    "winit",
];
/// The core's own packages, behind the interface `app-core`.
const CORE: [&str; 6] = [
    "app-alignment",
    "app-core",
    "app-live",
    "app-pipeline",
    "app-scene",
    "app-session",
];
/// Packages for an Android phone that compile C or declare functions of C, each with its reason.
const C_ON_PHONES: [(&str, &str); 5] = [
    ("cc", "android-activity compiles the platform's own glue with it"),
    ("jni-sys", "declares Java's interface alone"),
    ("linux-raw-sys", "constants of the kernel"),
    ("ndk-sys", "declares the platform's libraries alone"),
    ("renderdoc-sys", "declares a header alone"),
];
/// The same for an iPhone: it declares the runtime of Objective-C alone, for `accesskit_ios`.
const C_ON_IPHONES: [&str; 1] = ["objc-sys"];

/// The part of the output of `cargo metadata` that is used.
#[derive(Deserialize)]
struct Metadata {
    packages: Vec<Package>,
}

#[derive(Deserialize)]
struct Package {
    name: String,
    version: String,
    license: Option<String>,
    /// `None` for a package of this workspace, or one beside it.
    source: Option<String>,
}

/// Output of a cargo command about the locked workspace.
fn cargo(args: &[&str]) -> Vec<u8> {
    let output = Command::new(env!("CARGO"))
        .args(args)
        .arg("--locked")
        .current_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/.."))
        .output()
        .unwrap();
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    output.stdout
}

/// The packages of each target.
fn all_metadata() -> Vec<Metadata> {
    let of_target = |target| {
        let metadata = ["metadata", "--format-version", "1", "--filter-platform", target];
        serde_json::from_slice(&cargo(&metadata)).unwrap()
    };
    TARGETS.map(of_target).into()
}

#[test]
fn licences_and_sources_are_known() {
    let mut n_packages = 0;
    let [_, ios, android] = TARGETS;
    let of_phones: BTreeSet<(String, String)> = [("app-ios", ios), ("app-android", android)]
        .into_iter()
        .flat_map(|(package, target)| compiled(&["--package", package], target))
        .collect();
    assert!(
        of_phones.len() > 100,
        "only {} packages are on phones",
        of_phones.len()
    );
    for package in all_metadata().iter().flat_map(|metadata| &metadata.packages) {
        let label = format!("{} {}", package.name, package.version);
        let licence = package
            .license
            .as_deref()
            .unwrap_or_else(|| panic!("{label} names no licence"));
        let is_on_phone = of_phones.contains(&(package.name.clone(), package.version.clone()));
        assert!(is_allowed(licence, is_on_phone), "{label} is under {licence}");
        match package.source.as_deref() {
            None | Some(CRATES_IO) => n_packages += 1,
            Some(source) => panic!("{label} comes from {source}"),
        }
    }
    assert!(n_packages > 100, "only {n_packages} packages were looked at");
}

fn is_allowed(licence: &str, is_on_phone: bool) -> bool {
    // Some older packages write a slash for "or".
    let expression = Expression::parse_mode(licence, ParseMode::LAX).unwrap();
    expression.evaluate(|required| {
        required.addition.is_none()
            && required.license.id().is_some_and(|id| {
                LICENCES.contains(&id.name) || (!is_on_phone && DESKTOP_LICENCES.contains(&id.name))
            })
    })
}

#[test]
fn licence_expressions_are_weighed() {
    for allowed in [
        "MIT",
        "GPL-3.0-only OR MIT",
        "Apache-2.0/GPL-2.0-only",
        "(MIT OR 0BSD) AND Unicode-3.0",
    ] {
        assert!(is_allowed(allowed, true), "{allowed}");
    }
    assert!(is_allowed("BSD-3-Clause", false) && !is_allowed("BSD-3-Clause", true));
    for refused in [
        "GPL-3.0-only",
        "MIT AND GPL-3.0-only",
        "LGPL-2.1-or-later",
        "LicenseRef-Own",
    ] {
        assert!(!is_allowed(refused, false), "{refused}");
    }
}

/// Name and version of every package that is compiled for a target, as `cargo tree` lists them.
///
/// Metadata lists more: also packages that features name only in case something else requires them.
fn compiled(of: &[&str], target: &str) -> Vec<(String, String)> {
    let tree = ["tree", "--prefix=none", "--format={p}", "--target", target];
    let packages = String::from_utf8(cargo(&[&tree, of].concat())).unwrap();
    let named = packages.lines().filter_map(|line| line.split_once(" v"));
    let versions = named.map(|(name, rest)| (name, rest.split(' ').next().unwrap()));
    versions
        .map(|(name, version)| (name.to_owned(), version.to_owned()))
        .collect()
}

#[test]
fn no_package_is_compiled_twice_without_a_reason() {
    let mut versions: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
    for (name, version) in TARGETS
        .into_iter()
        .flat_map(|target| compiled(&["--workspace"], target))
    {
        versions.entry(name).or_default().insert(version);
    }
    assert!(
        versions.len() > 100,
        "only {} packages are compiled",
        versions.len()
    );
    versions.retain(|_, versions| versions.len() > 1);
    let known: BTreeSet<&str> = TWICE.iter().map(|(name, _)| *name).collect();
    let found: BTreeSet<&str> = versions.keys().map(String::as_str).collect();
    assert_eq!(found, known, "{versions:?}");
    assert!(
        versions.values().all(|versions| versions.len() == 2),
        "{versions:?}"
    );
}

/// The core has a feature for the tests, which must not be enabled in an app that is built from the
/// same workspace.
#[test]
fn apps_know_no_schema() {
    let has_schema = |package: &str, target| {
        let packages = compiled(&["--package", package], target);
        assert!(packages.iter().any(|(name, _)| name == "app-core"));
        packages.iter().any(|(name, _)| name == "schemars")
    };
    let [desktop, ios, android] = TARGETS;
    assert!(has_schema("tests", desktop));
    assert!(!has_schema("app-ios", ios));
    assert!(!has_schema("app-android", android));
}

#[test]
fn the_core_reaches_no_window_network_or_file() {
    for (target, metadata) in TARGETS.into_iter().zip(all_metadata()) {
        let linked = compiled(
            &["--package=app-core", "--all-features", "--edges=normal"],
            target,
        );
        let reached: BTreeSet<&str> = linked.iter().map(|(name, _)| name.as_str()).collect();
        assert!(reached.contains("wgpu"), "{reached:?}");
        let wrong: Vec<&&str> = NOT_IN_CORE
            .iter()
            .filter(|name| reached.contains(**name))
            .collect();
        assert!(wrong.is_empty(), "app-core reaches {wrong:?}");
        let of_workspace = metadata
            .packages
            .iter()
            .filter(|package| package.source.is_none());
        let others: Vec<&str> = of_workspace
            .map(|package| package.name.as_str())
            .filter(|name| !CORE.contains(name) && reached.contains(name))
            .collect();
        assert!(others.is_empty(), "app-core depends on {others:?}");
    }
}

#[test]
fn phones_compile_no_c_but_what_is_known() {
    let [_, ios, android] = TARGETS;
    let of_c = |package: &str, target| -> BTreeSet<String> {
        let names = compiled(&["--package", package], target).into_iter();
        let names = names.map(|(name, _)| name);
        names.filter(|name| is_of_c(name)).collect()
    };
    let known: BTreeSet<String> = C_ON_PHONES.iter().map(|(name, _)| (*name).to_owned()).collect();
    assert_eq!(of_c("app-android", android), known);
    assert_eq!(of_c("app-ios", ios), C_ON_IPHONES.map(str::to_owned).into());
    assert!(["cmake", "zstd-sys", "cc"].into_iter().all(is_of_c) && !is_of_c("accesskit"));
}

/// Whether a package builds C, or is, by its name, one of a C library.
fn is_of_c(name: &str) -> bool {
    ["cc", "cmake", "pkg-config", "bindgen"].contains(&name) || name.ends_with("-sys")
}
