//! The text of the clips.

use std::num::NonZeroU32;

use film::animate::grammar::{ClipFacts, Item, items, once};
use film::quoted::quoted;

use super::clips;

fn clip(clip: usize, n_times: u32, speed: f64) -> Item {
    Item::Clip {
        clip,
        n_times: NonZeroU32::new(n_times).unwrap(),
        speed,
    }
}

fn hold(n_frames: u32) -> Item {
    Item::Hold {
        n_frames: NonZeroU32::new(n_frames).unwrap(),
    }
}

#[test]
fn items_are_clips_with_times_and_speeds_and_holds() {
    let cases = [
        ("Look", vec![clip(0, 1, 1.0)]),
        (
            "Look, Step*2@0.5x ,hold:12",
            vec![clip(0, 1, 1.0), clip(1, 2, 0.5), hold(12)],
        ),
        ("Look@-2x", vec![clip(0, 1, -2.0)]),
        ("#1*3", vec![clip(1, 3, 1.0)]),
        // Marks in a name belong to the name.
        ("a*b@2x", vec![clip(2, 1, 1.0)]),
        ("a*b@2x*3@4x", vec![clip(2, 3, 4.0)]),
        ("hold:3", vec![clip(3, 1, 1.0)]),
    ];
    for (text, expected) in cases {
        assert_eq!(items(text, &clips()).unwrap(), expected, "{text}");
    }
}

#[test]
fn a_clip_is_printed_so_that_it_is_read_back() {
    let named = |names: &[&str]| -> Vec<ClipFacts> {
        let facts = names.iter().map(|name| ClipFacts {
            name: (*name).to_owned(),
            duration_secs: 1.0,
        });
        facts.collect()
    };
    let names = [
        "Armature|Walk",
        "#1",
        "Walk, slow",
        "Look*2",
        "",
        "hold:3",
        "Armature|Walk",
    ];
    let texts = ["Armature|Walk", "#1", "#2", "Look*2", "#4", "hold:3", "#6"];
    let clips = named(&names);
    for (index, text) in texts.into_iter().enumerate() {
        assert_eq!(once(index, &clips), text);
        assert_eq!(items(text, &clips).unwrap(), [clip(index, 1, 1.0)]);
    }
    assert_eq!(quoted("Armature|Walk"), "'Armature|Walk'");
    assert_eq!(quoted("a'b"), r"'a'\''b'");
}

#[test]
fn an_item_that_is_none_is_named() {
    let cases = [
        ("", "item 1 is empty"),
        ("Look,,Step", "item 2 is empty"),
        (
            "Look,Nod*2",
            "item 2, \"Nod*2\": no clip is called \"Nod\"; the toy has Look, Step, a*b@2x, hold:3",
        ),
        ("look", "no clip is called \"look\""),
        ("#4", "no clip is called \"#4\""),
        ("Look*0", "item 1, \"Look*0\": \"0\" is no number from 1 to 10000"),
        ("Look*-1", "\"-1\" is no number"),
        ("Look*10001", "\"10001\" is no number"),
        ("Look,hold:", "item 2, \"hold:\": \"\" is no number"),
        ("Look,hold:1.5", "\"1.5\" is no number"),
        ("Look@2", "item 1, \"Look@2\": \"2\" is no speed"),
        ("Look@0x", "\"0x\" is no speed"),
        ("Look@NaNx", "\"NaNx\" is no speed"),
        ("Look@infx", "\"infx\" is no speed"),
        ("hold:12", "no clip is played"),
    ];
    for (text, expected) in cases {
        let error = items(text, &clips()).unwrap_err().to_string();
        assert!(error.contains(expected), "{text}: {error}");
    }
    let error = items("Look", &[]).unwrap_err().to_string();
    assert!(error.ends_with("the toy has none"), "{error}");
}
