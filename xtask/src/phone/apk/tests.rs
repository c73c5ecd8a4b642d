//! Tests of packages, with a fake ARCore archive of the real one's structure.

use super::super::classes::class_file;
use super::*;

const OURS: &str = r#"<manifest><application android:hasCode="true"><activity/></application></manifest>"#;
const ARCORE: &str =
    r#"<manifest><queries><package/></queries><application ><meta-data/></application></manifest>"#;

#[test]
fn a_manifest_is_joined_with_that_of_arcore() {
    let joined = manifest_for(OURS, Some(ARCORE), true, 36).expect("a manifest");
    let expected = r#"<manifest><queries><package/></queries><application android:hasCode="true"><activity/><meta-data/></application></manifest>"#;
    assert_eq!(joined, expected);
}

#[test]
fn without_classes_a_manifest_has_no_code() {
    let alone = manifest_for(OURS, None, false, 36).expect("a manifest");
    assert_eq!(alone, OURS.replace("true", "false"));
    assert!(
        manifest_for(&alone, None, false, 36).is_err(),
        "says nothing to replace"
    );
}

#[test]
fn what_a_framework_does_not_know_is_left_out() {
    let ours = OURS.replace("hasCode", "enableOnBackInvokedCallback=\"false\" android:hasCode");
    let old = manifest_for(&ours, Some(ARCORE), true, 29).expect("a manifest");
    assert!(
        !old.contains("queries") && !old.contains("Invoked") && old.contains("<meta-data/>"),
        "{old}"
    );
    let new = manifest_for(&ours, Some(ARCORE), true, 33).expect("a manifest");
    assert!(
        new.contains("<queries><package/></queries>") && new.contains("Invoked"),
        "{new}"
    );
}

#[test]
fn a_platforms_folder_says_its_level() {
    let level = |name: &str| level_of(Path::new(name));
    assert_eq!(
        [
            level("p/android-36"),
            level("p/android-36.1"),
            level("p/android-36-ext18"),
            level("p/android-Baklava")
        ],
        [Some(36), Some(36), Some(36), None]
    );
    let folder = temporary("levels");
    for name in ["android-9", "android-36", "android-35"] {
        fs::create_dir_all(folder.join(name)).expect("a folder");
    }
    assert_eq!(ndk::newest_folder(&folder), Some(folder.join("android-36")));
    fs::remove_dir_all(folder).expect("a folder");
}

fn temporary(name: &str) -> PathBuf {
    let folder = std::env::temp_dir().join(format!("xtask-apk-{name}-{}", std::process::id()));
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).expect("a folder");
    folder
}

/// An archive like ARCore's: an activity that uses R classes which are not in it, their resources,
/// and `<queries>`.
fn stand_in(folder: &Path, also_names: &[&str]) -> Arcore {
    let r = ["R", "R$id", "R$layout", "R$string"].map(|name| format!("com/google/ar/core/{name}"));
    let mut names: Vec<&str> = r.iter().map(String::as_str).collect();
    names.extend(["android/app/Activity", "[Lcom/google/ar/core/Session;"]);
    names.extend(also_names);
    let class = |name: &str, names: &[&str]| {
        let name = format!("com/google/ar/core/{name}");
        entry(&format!("{name}.class"), class_file(&name, names))
    };
    let jar = zip::write(&[class("InstallActivity", &names), class("Session", &[])]).expect("a jar");
    let manifest = r#"<manifest xmlns:android="http://schemas.android.com/apk/res/android" package="com.google.ar.core">
        <queries><package android:name="com.google.ar.core"/></queries>
        <application><meta-data android:name="com.google.ar.core.min_apk_version" android:value="1"/>
        <activity android:name="com.google.ar.core.InstallActivity"/></application></manifest>"#;
    let layout = r#"<LinearLayout xmlns:android="http://schemas.android.com/apk/res/android"
        android:id="@+id/box" android:layout_width="1dp" android:layout_height="1dp"/>"#;
    let strings = r#"<resources><string name="install">Install</string></resources>"#;
    let archive = zip::write(&[
        entry("AndroidManifest.xml", manifest.into()),
        entry("R.txt", "int string install 0x0".into()),
        entry("res/layout/ask.xml", layout.into()),
        entry("res/values/values.xml", strings.into()),
        entry("classes.jar", jar),
        entry("jni/arm64-v8a/libarcore_sdk_c.so", vec![7; 9]),
    ]);
    let path = folder.join("core.aar");
    fs::write(&path, archive.expect("an archive")).expect("a file");
    Arcore {
        sha256: super::super::arcore::sha256(&path).expect("a sum"),
        archive: path,
    }
}

/// Debian's tools, with a script in place of the SDK's compiler, whose program is the list of its
/// inputs.
fn tools_with_d8(folder: &Path) -> Option<Tools> {
    let programs = TOOLS.iter().map(|tool| tool.program).chain(["javac"]);
    let has_all = programs
        .into_iter()
        .all(|program| command::find(program).is_some());
    if !has_all || !Path::new(FRAMEWORK).is_file() {
        eprintln!("not tested here: a package, for which the tools of `android package` are missing");
        return None;
    }
    let d8 = folder.join("d8");
    let script = "#!/bin/sh\nlist=\"$*\"\nwhile [ \"$1\" != --output ]; do shift; done\necho \"$list\" > \"$2/classes.dex\"\n";
    fs::write(&d8, script).expect("a script");
    command::run(Command::new("chmod").arg("+x").arg(&d8)).expect("a program");
    Some(Tools {
        aapt2: "aapt2".into(),
        apksigner: "apksigner".into(),
        framework: FRAMEWORK.into(),
        framework_api: framework_level(FRAMEWORK),
        d8: Some(d8),
    })
}

#[test]
fn a_package_has_the_classes_of_its_archives_resources_or_is_refused() {
    let folder = temporary("package");
    let Some(tools) = tools_with_d8(&folder) else {
        return;
    };
    let shell = Path::new(env!("CARGO_MANIFEST_DIR")).join("../app-android");
    let whole = stand_in(&folder, &[]);
    make_with(&tools, &shell, &folder, vec![1; 5], Some(&whole)).expect("a package");
    let apk = fs::read(folder.join("shadow-retargeting.apk")).expect("a package");
    let found = zip::read(&apk).expect("what is in it");
    let bytes = |name: &str| {
        let found = found.iter().find(|found| found.name == name).expect(name);
        String::from_utf8_lossy(&apk[found.at..found.at + found.n_bytes]).into_owned()
    };
    for class in [
        "R.class",
        "R$id.class",
        "R$layout.class",
        "R$string.class",
        "classes.jar",
    ] {
        assert!(
            bytes("classes.dex").contains(class),
            "{class}: {}",
            bytes("classes.dex")
        );
    }
    assert!(
        found.iter().any(|found| found.name == "res/layout/ask.xml"),
        "{found:?}"
    );

    let torn = stand_in(&folder, &["com/google/other/Gone"]);
    let error = make_with(&tools, &shell, &folder, vec![1; 5], Some(&torn))
        .expect_err("torn")
        .to_string();
    assert!(
        error.contains("com/google/other/Gone, which com/google/ar/core/InstallActivity names"),
        "{error}"
    );
    // An older form of packages, without R classes.
    fs::write(
        folder.join("core.aar"),
        zip::write(&without_resources(&folder)).expect("an archive"),
    )
    .expect("a file");
    let plain = Arcore {
        sha256: super::super::arcore::sha256(&whole.archive).expect("a sum"),
        ..whole
    };
    let error = make_with(&tools, &shell, &folder, vec![1; 5], Some(&plain))
        .expect_err("no R")
        .to_string();
    assert!(error.contains("com/google/ar/core/R$layout"), "{error}");
    fs::remove_dir_all(folder).expect("a folder");
}

fn without_resources(folder: &Path) -> Vec<Entry> {
    stand_in(folder, &[]);
    let archive = fs::read(folder.join("core.aar")).expect("an archive");
    let found = zip::read(&archive).expect("what is in it").into_iter();
    let kept = found.filter(|found| !found.name.starts_with("res/"));
    kept.map(|found| entry(&found.name, archive[found.at..found.at + found.n_bytes].to_vec()))
        .collect()
}

#[test]
fn version_codes_grow_with_versions() {
    let codes = ["0.1.0", "0.1.1", "0.2.0", "1.0.0"].map(|version| version_code(version).ok());
    assert_eq!(codes, [Some(100), Some(101), Some(200), Some(10_000)]);
    assert!(version_code("0.100.0").is_err());
    assert!(version_code("0.1.0-beta").is_err());
}

#[test]
#[ignore = "needs ARCORE_ARCHIVE, the path of com.google.ar:core"]
fn a_real_archive_names_nothing_that_is_missing() {
    let folder = temporary("real");
    let tools = tools_with_d8(&folder).expect("tools");
    let shell = Path::new(env!("CARGO_MANIFEST_DIR")).join("../app-android");
    let archive = PathBuf::from(std::env::var_os("ARCORE_ARCHIVE").expect("ARCORE_ARCHIVE"));
    let sha256 = super::super::arcore::sha256(&archive).expect("a sum");
    make_with(
        &tools,
        &shell,
        &folder,
        vec![1; 5],
        Some(&Arcore { archive, sha256 }),
    )
    .expect("a package");
    fs::remove_dir_all(folder).expect("a folder");
}
