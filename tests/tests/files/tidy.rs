//! Rules for the source tree that no compiler checks.

use std::fs;
use std::path::{Path, PathBuf};

use app_pipeline::shaders;
use harness::shader_text::without_comments;

/// Passes that draw meshes or copy rather than compute: they have no CPU reference.
const DRAWING_PASSES: &[&str] = &[
    "coverage",
    "masks",
    "moved_mask",
    "gbuffer",
    "present",
    "screen",
    "toy",
    "warp",
];
/// Items that the core must not use: it has no clock, opens no file, and is the same on every
/// platform.
const BANNED_IN_CORE: &[&str] = &["std::time", "std::fs", "std::net", "target_os", "target_vendor"];
/// The exception: the reader of folders, which the feature `fs` alone compiles.
const MAY_OPEN_FILES: &str = "app-core/session/src/folder.rs";
/// The crates of the core; the app on top of it has no clock and opens no file either.
const CORE: [&str; 6] = [
    "app-core/src",
    "app-core/scene/src",
    "app-core/pipeline/src",
    "app-core/alignment/src",
    "app-core/session/src",
    "app-core/live/src",
];
const MAX_RUST_LINES: usize = 500;
const MAX_WGSL_LINES: usize = 300;

struct Source {
    /// Relative to the project's root.
    path: PathBuf,
    text: String,
}

impl Source {
    fn stem(&self) -> &str {
        self.path.file_stem().unwrap().to_str().unwrap()
    }

    fn n_lines(&self) -> usize {
        self.text.lines().count()
    }
}

/// All files in `folder` of the project and in its subfolders whose names end in `extension`.
fn sources(folder: &str, extension: &str) -> Vec<Source> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap();
    let mut folders = vec![root.join(folder)];
    let mut sources = Vec::new();
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(&folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|e| e == extension) {
                let text = fs::read_to_string(&path).unwrap();
                sources.push(Source {
                    path: path.strip_prefix(root).unwrap().to_owned(),
                    text,
                });
            }
        }
    }
    assert!(!sources.is_empty(), "{folder} has no .{extension}");
    sources
}

fn rust_sources() -> Vec<Source> {
    let folders = [
        "app-core/examples",
        "app-core/tests",
        "app-core/shell/src",
        "tests/desk/src",
        "tests/desk/tests",
        "tests/film/src",
        "tests/measure/src",
        "tests/reference/src",
        "tests/view/src",
        "app-ios/src",
        "app-ios/arkit/src",
        "app-ios/media/src",
        "app-android/src",
        "app-android/arcore/src",
        "app-android/media/src",
        "tests/src",
        "tests/tests",
        "xtask/src",
    ];
    folders
        .into_iter()
        .chain(CORE)
        .flat_map(|folder| sources(folder, "rs"))
        .collect()
}

fn core_sources() -> Vec<Source> {
    CORE.into_iter()
        .flat_map(|folder| sources(folder, "rs"))
        .collect()
}

/// Fails with a list of all violations.
fn assert_none(wrong: impl IntoIterator<Item = String>) {
    let wrong: Vec<String> = wrong.into_iter().collect();
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

fn wrong_files(sources: Vec<Source>, rule: &str, is_wrong: impl Fn(&Source) -> bool) -> Vec<String> {
    let wrong = sources.into_iter().filter(|source| is_wrong(source));
    wrong
        .map(|source| format!("{}: {rule}", source.path.display()))
        .collect()
}

/// The shaders of passes, without the parts that several share.
fn pass_files() -> Vec<Source> {
    sources("shaders", "wgsl")
        .into_iter()
        .filter(|file| !file.path.starts_with("shaders/common"))
        .collect()
}

#[test]
fn a_pass_has_one_name_everywhere() {
    let files = pass_files();
    let mut stems: Vec<&str> = files.iter().map(Source::stem).collect();
    let mut names: Vec<&str> = shaders().map(|shader| shader.name).collect();
    stems.sort_unstable();
    names.sort_unstable();
    assert_eq!(stems, names, "files in shaders/ and the lists of passes");
    let modules = sources("app-core/pipeline/src", "rs");
    for name in names {
        let n_modules = modules.iter().filter(|file| file.stem() == name).count();
        assert_eq!(n_modules, 1, "modules named {name}");
    }
}

#[test]
fn only_the_gpu_layer_creates_on_the_device() {
    let outside = core_sources()
        .into_iter()
        .filter(|file| !file.path.starts_with("app-core/pipeline/src/gpu"))
        // It paints over a finished picture, as any caller may by `Core::present_with`, with its
        // own resources, which are not counted.
        .filter(|file| !file.path.ends_with("interface/painter.rs"))
        .collect();
    assert_none(wrong_files(
        outside,
        "creates past the count in gpu/device.rs",
        |file| file.text.contains(".create_"),
    ));
}

#[test]
fn every_shader_file_is_joined_into_a_shader_and_its_own_under_its_name() {
    assert_none(wrong_files(
        sources("shaders", "wgsl"),
        "is in no shader of the registry",
        |file| !shaders().any(|shader| shader.source().contains(&without_comments(&file.text))),
    ));
    assert_none(wrong_files(
        pass_files(),
        "is not in the shader of its name",
        |file| {
            shaders().any(|shader| {
                shader.name == file.stem() && !shader.source().contains(&without_comments(&file.text))
            })
        },
    ));
}

#[test]
fn every_cpu_reference_that_a_shader_names_exists() {
    let references = |file: &Source| -> Vec<String> {
        let heads = file.text.lines().filter(|line| line.starts_with("//"));
        let named = heads.filter_map(|line| Some(line.split_once("CPU reference: ")?.1.to_owned()));
        // "tests/reference/src/….rs", followed by any text.
        let named = named.filter_map(|path| Some(path.strip_prefix("tests/reference/src/")?.to_owned()));
        named
            .map(|reference| {
                reference
                    .split_inclusive(".rs")
                    .next()
                    .unwrap_or_default()
                    .to_owned()
            })
            .collect()
    };
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("reference/src");
    assert_none(wrong_files(
        pass_files(),
        "names a CPU reference that is not there",
        |file| {
            references(file)
                .iter()
                .any(|reference| !folder.join(reference).is_file())
        },
    ));
    assert_none(wrong_files(
        pass_files(),
        "computes and has no CPU reference",
        |file| references(file).is_empty() != DRAWING_PASSES.contains(&file.stem()),
    ));
}

#[test]
fn every_module_begins_with_what_it_is() {
    assert_none(wrong_files(rust_sources(), "does not begin with //!", |file| {
        !file.text.starts_with("//! ")
    }));
}

#[test]
fn files_are_short() {
    assert_none(wrong_files(rust_sources(), "is too long", |file| {
        file.n_lines() > MAX_RUST_LINES
    }));
    assert_none(wrong_files(sources("shaders", "wgsl"), "is too long", |file| {
        file.n_lines() > MAX_WGSL_LINES
    }));
}

#[test]
fn the_core_has_no_clock_no_files_no_platform_and_no_unsafe_code() {
    for banned in BANNED_IN_CORE {
        let rule = format!("has \"{banned}\"");
        assert_none(wrong_files(core_sources(), &rule, |file| {
            let is_reader = banned == &"std::fs" && file.path == Path::new(MAY_OPEN_FILES);
            file.text.contains(banned) && !is_reader
        }));
    }
    let root = wrong_files(core_sources(), "does not forbid unsafe code", |file| {
        file.path.ends_with("src/lib.rs") && !file.text.contains("#![forbid(unsafe_code)]")
    });
    assert_none(root);
}

/// Decisions belong to the core, and knowledge of a platform's interfaces to the packages beside a
/// shell.
#[test]
fn shells_are_thin() {
    let n_lines = |shell: &str| -> usize {
        let sources = sources(&format!("{shell}/src"), "rs").into_iter();
        let counted = sources.filter(|source| !source.path.ends_with("tests.rs"));
        counted.map(|source| source.n_lines()).sum()
    };
    for shell in ["app-ios", "app-android"] {
        let n_lines = n_lines(shell);
        assert!(n_lines <= 1200, "{shell}: {n_lines} lines");
    }
}

/// Android first offers a mode that draws as often as the processor can: therefore only one place
/// configures surfaces.
#[test]
fn surfaces_are_configured_in_one_place_that_waits_for_the_display() {
    let configured = rust_sources()
        .into_iter()
        .filter(|file| !file.path.starts_with("tests"));
    let places: Vec<String> = configured
        .flat_map(|file| {
            let n_calls = file.text.matches("surface.configure(").count();
            vec![
                format!(
                    "{} {}",
                    file.path.display(),
                    file.text.matches("as_shown(config)").count()
                );
                n_calls
            ]
        })
        .collect();
    assert_eq!(places, ["app-core/pipeline/src/core/window.rs 1"]);
}
