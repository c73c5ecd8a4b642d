//! The document of the format has the tables of the schema, one for each object, and an example
//! with every key.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Debug;

use app_core::session::schema;
use harness::session_format::{DOCUMENT, WHOLE, document_text, example, quoted};
use image::{DynamicImage, ImageFormat};
use serde_json::Value;

use crate::session::parts::{Parts, encode, toy_glb};

#[test]
fn the_tables_are_those_of_the_schema() {
    assert!(
        DOCUMENT == document_text(),
        "the tables of session.md are not those of the reader: `cargo xtask bless session`, and look at what has changed"
    );
}

fn joined(object: &str, key: &str) -> String {
    if object == WHOLE {
        key.to_owned()
    } else {
        format!("{object}.{key}")
    }
}

/// Properties of the schema's objects by their paths, as `frames[].animation`.
fn objects(object: &Value, path: &str, found: &mut BTreeMap<String, Value>) {
    let Some(properties) = object["properties"].as_object() else {
        return;
    };
    for (key, schema) in properties {
        let path = joined(path, key);
        objects(schema, &path, found);
        objects(&schema["items"], &format!("{path}[]"), found);
    }
    found.insert(path.to_owned(), object["properties"].clone());
}

fn all_objects() -> BTreeMap<String, Value> {
    let mut found = BTreeMap::new();
    objects(&schema(), WHOLE, &mut found);
    found
}

#[test]
fn each_object_has_a_table() {
    let objects = all_objects();
    let mut named = BTreeSet::new();
    for section in DOCUMENT.split("\n### ").skip(1) {
        let paths = quoted(section.lines().next().unwrap());
        assert_eq!(section.matches("<!-- keys -->").count(), 1, "{paths:?}");
        let is_alike = paths
            .iter()
            .all(|path| objects.get(*path) == objects.get(paths[0]));
        assert!(is_alike, "{paths:?}: different objects");
        named.extend(paths);
    }
    assert_same(&named, &objects.keys().map(String::as_str).collect());
}

fn assert_same<T: Ord + Debug>(found: &BTreeSet<T>, known: &BTreeSet<T>) {
    let missing: Vec<&T> = known.difference(found).collect();
    let unknown: Vec<&T> = found.difference(known).collect();
    assert!(
        missing.is_empty() && unknown.is_empty(),
        "missing: {missing:?}, not in the schema: {unknown:?}"
    );
}

#[test]
fn the_example_has_every_key_and_the_reader_takes_it() {
    let index: Value = serde_json::from_str(example().unwrap()).unwrap();
    let mut found = BTreeSet::new();
    collect_keys(&index, "", &mut found);
    let objects = all_objects();
    let known: BTreeSet<String> = objects
        .iter()
        .flat_map(|(object, keys)| {
            let keys = keys.as_object().unwrap().keys();
            keys.map(|key| joined(object, key))
        })
        .collect();
    assert_same(&found, &known);

    let size_px = ["width", "height"].map(|key| u32::try_from(index[key].as_u64().unwrap()).unwrap());
    let [width_px, height_px] = size_px;
    let photo = encode(&DynamicImage::new_rgb8(width_px, height_px), ImageFormat::Png);
    let mask = encode(&DynamicImage::new_rgba8(width_px, height_px), ImageFormat::Png);
    let depth = encode(&DynamicImage::new_luma16(256, 192), ImageFormat::Png);
    let people = encode(&DynamicImage::new_luma8(256, 192), ImageFormat::Png);
    let files = [
        ("toy.glb", toy_glb(true)),
        ("place.glb", toy_glb(true)),
        ("plate.png", photo.clone()),
        ("frame_0000.png", photo.clone()),
        ("frame_0001.png", photo.clone()),
        ("truth_0000.png", photo.clone()),
        ("mask_0000.png", mask),
        ("depth_0000.png", depth),
        ("people_0000.png", people),
        ("probe_0000.png", photo.clone()),
        ("probe_0001.png", photo),
    ];
    let parts = Parts {
        index,
        raw_index: None,
        files: files.map(|(name, bytes)| (name.to_owned(), bytes)).into(),
    };
    parts.read_all().unwrap();
}

fn collect_keys(value: &Value, path: &str, found: &mut BTreeSet<String>) {
    match value {
        Value::Object(entries) => {
            for (key, value) in entries {
                let path = if path.is_empty() {
                    key.clone()
                } else {
                    format!("{path}.{key}")
                };
                collect_keys(value, &path, found);
                found.insert(path);
            }
        }
        Value::Array(entries) => {
            for value in entries {
                collect_keys(value, &format!("{path}[]"), found);
            }
        }
        _ => {}
    }
}
