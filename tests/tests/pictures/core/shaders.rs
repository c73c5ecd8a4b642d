//! Replacement of shaders while a core runs.

use std::fs;
use std::path::Path;

use app_core::gpu::ShaderTexts;
use app_core::preset::Preset;
use app_core::{Core, CoreError};
use desk::shaders::{ShaderFolder, read_shaders};
use harness::open_core;

use crate::core::bundled::{first_input, picture_of, scene};

const FOLDER: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../shaders");

/// Draws with one file in place of the built-in one.
fn replace_one(core: &mut Core, path: &str, text: &str) -> Result<(), CoreError> {
    core.replace_shaders([(path.to_owned(), text.to_owned())].into_iter().collect())
}

fn first_picture(core: &mut Core) -> Vec<u8> {
    core.set_scene(scene(), Preset::Balanced).unwrap();
    picture_of(core, &first_input())
}

#[test]
fn a_changed_shader_changes_the_picture_and_a_faulty_one_does_not() {
    let mut core = open_core();
    let built_in = first_picture(&mut core);
    let error = replace_one(&mut core, "frame/composite", "fn").unwrap_err();
    assert!(error.to_string().contains("composite"), "{error}");
    assert!(core.has_built_in_shaders());
    assert!(
        picture_of(&mut core, &first_input()) == built_in,
        "the scene stays"
    );
    let covered = fs::read_to_string(format!("{FOLDER}/common/covered.wgsl")).unwrap();
    let half = covered.replace("/ 255.0", "/ 510.0");
    assert_ne!(half, covered);
    replace_one(&mut core, "common/covered", &half).unwrap();
    assert!(matches!(core.frame(&first_input()), Err(CoreError::NoScene)));
    assert!(first_picture(&mut core) != built_in, "nothing has changed");
    // A part that imports itself, and one that does not exist.
    let odd = format!("//#import common/covered\n//#import common/nothing\n{covered}");
    replace_one(&mut core, "common/covered", &odd).unwrap();
    assert!(first_picture(&mut core) == built_in, "as it was");
    core.replace_shaders(read_shaders(FOLDER.as_ref()).unwrap())
        .unwrap();
    assert!(first_picture(&mut core) == built_in, "read from files");
    core.replace_shaders(ShaderTexts::default()).unwrap();
    assert!(core.has_built_in_shaders());
}

#[test]
fn a_folder_tells_of_each_change_once() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("shaders");
    let file = folder.join("frame/composite.wgsl");
    fs::create_dir_all(folder.join("frame")).unwrap();
    fs::write(&file, "// One.").unwrap();
    let mut watched = ShaderFolder::new(folder);
    assert!(watched.changed().unwrap().is_ok());
    assert!(watched.changed().is_none());
    fs::write(&file, "// Two.").unwrap();
    assert!(watched.changed().unwrap().is_ok());
    fs::write(&file, vec![b' '; (1 << 20) + 1]).unwrap();
    let error = watched.changed().unwrap().unwrap_err();
    assert!(error.contains("frame/composite.wgsl"), "{error}");
    assert!(watched.changed().is_none());
    fs::remove_file(&file).unwrap();
    let error = watched.changed().unwrap().unwrap_err();
    assert!(error.contains("holds no shader"), "{error}");
    watched.forget();
    assert!(watched.changed().is_some());
}
