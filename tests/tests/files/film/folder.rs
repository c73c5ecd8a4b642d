//! The files that a film's folder keeps from the previous film, and the ones it refuses.

use std::fs;
use std::path::Path;
use std::sync::Barrier;
use std::thread;

use app_core::shadow_style::ShadowStyle;
use desk::stored::Stored;
use film::animate::folder::{Film, FilmFolder, FilmFrame, MadeBy, SourceFile, sources};
use film::animate::grammar::items;
use film::animate::render::missing;
use film::animate::timeline::{Timing, frames};
use harness::temporary::Temporary;

use super::clips;

fn film(text: &str) -> Film {
    let clips = clips();
    // Times are exact, in a text as well.
    let timing = Timing {
        fps: 8.0,
        ..Timing::default()
    };
    let poses = frames(&items(text, &clips).unwrap(), &clips, &timing).unwrap();
    Film {
        version: "1".to_owned(),
        made_by: MadeBy::default(),
        name: "a toy".to_owned(),
        sources: vec![SourceFile {
            path: "toy.glb".to_owned(),
            n_bytes: 1,
            crc32: 2,
        }],
        is_as_given: false,
        is_moving: false,
        shadow: ShadowStyle::TRUE,
        bits: 8,
        has_layers: false,
        preset: "best".to_owned(),
        clips: text.to_owned(),
        timing,
        frames: (1..)
            .zip(poses)
            .map(|(number, pose)| FilmFrame {
                number,
                file: format!("{number}.png"),
                photograph: 0,
                pose,
            })
            .collect(),
    }
}

/// Begins a film; returns whether its session was made.
fn begin(path: &Path, film: &Film, is_forced: bool) -> anyhow::Result<bool> {
    let mut is_made = false;
    FilmFolder::take(path, false)?.begin(film, is_forced, |to| {
        is_made = true;
        Ok(fs::create_dir(to)?)
    })?;
    assert_eq!(FilmFolder::film_in(path)?.as_ref(), Some(film));
    Ok(is_made)
}

/// The first three pictures: whether each exists.
fn pictures(path: &Path) -> [bool; 3] {
    [1, 2, 3].map(|number| path.join(format!("{number}.png")).exists())
}

#[test]
fn pictures_stay_as_long_as_all_that_decides_on_them_does() {
    let folder = Temporary::new("film-kept");
    let path = &folder.0.join("film");
    let write = || [1, 3].map(|number| fs::write(path.join(format!("{number}.png")), "").unwrap());
    let first = film("Look");
    assert!(begin(path, &first, false).unwrap());
    write();
    assert!(!begin(path, &first, false).unwrap());
    assert_eq!(pictures(path), [true, false, true]);
    // Other frames beside them change the retargeted region.
    let longer = film("Look,Step");
    let other_preset = Film {
        preset: "fast".to_owned(),
        ..longer.clone()
    };
    let mut other_toy = other_preset.clone();
    other_toy.sources[0].crc32 = 3;
    let other_bits = Film {
        bits: 16,
        ..first.clone()
    };
    let mut other_shadow = first.clone();
    other_shadow.shadow.strength = 0.5;
    for other in [longer, other_preset, other_toy, other_bits, other_shadow] {
        let refused = begin(path, &other, false).unwrap_err();
        assert!(refused.to_string().contains("--force"), "{refused}");
        assert_eq!(pictures(path), [true, false, true]);
        assert!(begin(path, &other, true).unwrap());
        assert_eq!(pictures(path), [false; 3]);
        // The other film overwrites nothing, so no confirmation is needed.
        begin(path, &first, false).unwrap();
        begin(path, &other, false).unwrap();
        write();
    }
    // The origin of these is unknown.
    fs::write(path.join("film.json"), "{").unwrap();
    assert!(begin(path, &first, false).is_err());
    assert_eq!(pictures(path), [true, false, true]);
}

#[test]
fn all_files_that_change_pictures_are_sources_of_a_film() {
    let folder = Temporary::new("film-sources");
    let index = serde_json::json!({
        "toy": { "file": "toy.glb" },
        "backgrounds": [{ "image": "plate.png" }],
        "probe": { "pictures": [{ "image": "probe.png" }] },
        "place_mesh": { "file": "place.glb" },
        "frames": [
            { "image": "0.png", "depth": "0d.png", "people": "0p.png", "truth": "0t.png", "mask": "0m.png" },
            { "image": "1.png", "depth": "1d.png", "people": "1p.png" },
        ],
    });
    let first = [
        "0.png",
        "0d.png",
        "0p.png",
        "place.glb",
        "plate.png",
        "probe.png",
        "toy.glb",
    ];
    let later = ["1.png", "1d.png", "1p.png"];
    for file in first.iter().chain(&later).chain(&["0t.png", "0m.png"]) {
        fs::write(folder.0.join(file), file).unwrap();
    }
    fs::write(folder.0.join("capture.json"), index.to_string()).unwrap();
    let paths = |is_moving| -> Vec<String> {
        let sources = sources(&Stored::open(&folder.0).unwrap(), is_moving).unwrap();
        sources.into_iter().map(|source| source.path).collect()
    };
    let mut expected = first.to_vec();
    expected.push("capture.json");
    expected.sort_unstable();
    assert_eq!(paths(false), expected);
    expected.extend(later);
    expected.sort_unstable();
    assert_eq!(paths(true), expected);
}

/// Pictures stay when another build continues, and the film records the build that began them until
/// they are made again.
#[test]
fn a_film_says_what_began_it() {
    let folder = Temporary::new("film-made-by");
    let path = &folder.0.join("film");
    let by = |build: &str| {
        let mut film = film("Look");
        film.made_by.build = build.to_owned();
        film
    };
    begin(path, &by("one"), false).unwrap();
    fs::write(path.join("1.png"), "").unwrap();
    let taken = FilmFolder::take(path, false).unwrap();
    taken.begin(&by("two"), false, |_| Ok(())).unwrap();
    drop(taken);
    assert_eq!(FilmFolder::film_in(path).unwrap(), Some(by("one")));
    assert!(path.join("1.png").exists());
    begin(path, &by("two"), true).unwrap();
    assert!(!path.join("1.png").exists());
}

/// A frame is complete when all of its files exist, and layers belong to their picture.
#[test]
fn layers_are_files_of_their_frame() {
    let folder = Temporary::new("film-layers");
    let path = &folder.0.join("film");
    let plain = film("Look");
    let layered = Film {
        has_layers: true,
        ..plain.clone()
    };
    let write = |file: &str| fs::write(path.join(file), "").unwrap();
    let missing_in = |film: &Film| -> Vec<u32> {
        let missing = missing(path, film, &(1..4));
        missing.iter().map(|frame| frame.number).collect()
    };
    begin(path, &layered, false).unwrap();
    ["1.png", "1.exr", "2.png", "3.exr"].into_iter().for_each(write);
    assert_eq!(missing_in(&layered), [2, 3]);
    assert_eq!(missing_in(&plain), [3]);
    let refused = begin(path, &plain, false).unwrap_err();
    assert!(refused.to_string().contains("--force"), "{refused}");
    begin(path, &plain, true).unwrap();
    assert!(!path.join("1.exr").exists() && !path.join("3.exr").exists());
}

#[test]
fn a_folder_of_others_or_in_use_is_refused() {
    let folder = Temporary::new("film-refused");
    let path = folder.0.as_path();
    fs::write(path.join("holiday.png"), "").unwrap();
    let refused = |is_shared| FilmFolder::take(path, is_shared).err().unwrap().to_string();
    assert!(refused(false).contains("something else than a film"));
    fs::remove_file(path.join("holiday.png")).unwrap();
    let one = FilmFolder::take(path, true).unwrap();
    let _two = FilmFolder::take(path, true).unwrap();
    assert!(refused(false).contains("another run"));
    one.begin(&film("Look"), false, |to| Ok(fs::create_dir(to)?))
        .unwrap();
    let other = one.begin(&film("Step"), false, |_| Ok(()));
    assert!(other.unwrap_err().to_string().contains("another film"));
}

#[test]
fn several_runs_may_take_a_new_folder_at_the_same_moment() {
    let top = Temporary::new("film-taken-at-once");
    for round in 0..200 {
        let path = top.0.join(round.to_string());
        let start = Barrier::new(4);
        thread::scope(|scope| {
            let take = || {
                start.wait();
                FilmFolder::take(&path, true).map(drop)
            };
            let runs = [0; 4].map(|_| scope.spawn(take));
            runs.into_iter().for_each(|run| run.join().unwrap().unwrap());
        });
    }
}
