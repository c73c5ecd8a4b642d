//! The page of a film: each frame beside its keys, with the weight of each.

use app_core::scene::Image;
use desk::false_color::Shown;
use desk::output::WriteError;
use desk::output::folder::OutputFolder;
use desk::page::film::{Film, FilmFrame, write, write_picture};
use desk::report::MapEntry;

use super::film::ONION_FOLDER;
use super::keys::Keys;
use super::report::{FrameEntry, Report};

/// Folder of the keys' photographs, registered to the first plate's camera, below the output
/// folder.
const KEYS_FOLDER: &str = "keys";

const KEY_BEFORE: Shown = Shown {
    name: "key_before",
    title: "Key before",
    caption: "The photograph of the key before this frame, with the camera's nudge and the exposure undone.",
    legend: None,
    swatches: &[],
};
const KEY_AFTER: Shown = Shown {
    name: "key_after",
    title: "Key after",
    caption: "The photograph of the key after this frame, with the camera's nudge and the exposure undone.",
    legend: None,
    swatches: &[],
};
const ONION: Shown = Shown {
    name: "onion",
    title: "Onion skin",
    caption: "This frame, with the keys before and after it shining through.",
    legend: None,
    swatches: &[],
};

/// Writes the page and the photographs of the keys. The frames' own pictures exist already.
pub(super) fn write_page(
    output: &OutputFolder,
    report: &Report,
    keys: &Keys,
    has_onion: bool,
) -> Result<(), WriteError> {
    let mut size_px = [0; 2];
    for (index, key) in keys.keys.iter().enumerate() {
        let photograph: &Image = key.input.image.rgba();
        size_px = [photograph.width_px, photograph.height_px];
        write_picture(output, &key_file(index), photograph)?;
    }
    let mut pictures = vec![KEY_BEFORE, KEY_AFTER];
    if has_onion {
        pictures.push(ONION);
    }
    let frames = report.frames.iter();
    let film = Film {
        title: &report.shot,
        size_px,
        pictures,
        frames: frames.map(|entry| film_frame(entry, has_onion)).collect(),
    };
    write(output, &film)
}

fn key_file(index: usize) -> String {
    format!("{KEYS_FOLDER}/key_{index:04}.png")
}

fn film_frame(entry: &FrameEntry, has_onion: bool) -> FilmFrame {
    let beside = [entry.keys.first(), entry.keys.last()];
    let maps = [KEY_BEFORE, KEY_AFTER].into_iter().zip(beside);
    let mut maps: Vec<MapEntry> = maps
        .filter_map(|(shown, key)| {
            Some(MapEntry {
                name: shown.name,
                file: key_file(*key?),
            })
        })
        .collect();
    if has_onion {
        maps.push(MapEntry {
            name: ONION.name,
            file: format!("{ONION_FOLDER}/{}", entry.picture),
        });
    }
    FilmFrame {
        index: entry.number,
        time_secs: entry.time_secs,
        picture: entry.picture.clone(),
        maps,
        words: words(entry),
        ..FilmFrame::default()
    }
}

/// The sources of a frame, one line each.
fn words(entry: &FrameEntry) -> Vec<String> {
    let mut words = vec![entry.pose.clone()];
    if entry.is_key {
        words.extend(entry.keys.iter().map(|key| format!("key {key} at its own time")));
    } else {
        let parts = entry.keys.iter().zip(&entry.weights);
        words.extend(parts.map(|(key, weight)| format!("key {key}: {:.0} %", 100.0 * weight)));
    }
    if let Some(unseen) = entry.unseen.filter(|unseen| *unseen > 0.0) {
        words.push(format!("neither key shows {:.1} % of the toy", 100.0 * unseen));
    }
    words
}
