//! The document of the format names each key of the schema and no other, with its type, its range and its need.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Debug;

use app_core::session::schema;
use harness::session_format::{DOCUMENT, example};
use image::{DynamicImage, ImageFormat};
use serde_json::{Value, json};

use crate::session::follows::follows;
use crate::session::parts::{Parts, encode, toy_glb};

/// Path of the index itself, as the document's headings have it.
const WHOLE: &str = "capture.json";

/// A line of a table.
#[derive(Clone)]
struct Row {
    of_type: String,
    range: String,
    without: String,
    example: String,
}

/// The rows of the document by their keys' paths; those of an object that occurs in several places are in all of them.
fn documented() -> BTreeMap<String, Row> {
    let mut rows = BTreeMap::new();
    let mut objects = Vec::new();
    for line in DOCUMENT.lines() {
        if line.starts_with('#') {
            objects = if line.starts_with("### ") {
                quoted(line)
            } else {
                Vec::new()
            };
        }
        let cells: Vec<&str> = line.split('|').map(str::trim).collect();
        let &[_, key, of_type, _, range, without, _, example, _] = cells.as_slice() else {
            continue;
        };
        let row = [of_type, range, without, example].map(str::to_owned);
        let [of_type, range, without, example] = row;
        let row = Row {
            of_type,
            range,
            without,
            example,
        };
        for (object, key) in objects
            .iter()
            .flat_map(|object| quoted(key).into_iter().map(move |key| (object, key)))
        {
            let is_new = rows.insert(joined(object, key), row.clone()).is_none();
            assert!(is_new, "{object}, {key}: twice");
        }
    }
    rows
}

/// What stands between backticks.
fn quoted(text: &str) -> Vec<&str> {
    text.split('`').skip(1).step_by(2).collect()
}

fn joined(object: &str, key: &str) -> String {
    if object == WHOLE {
        key.to_owned()
    } else {
        format!("{object}.{key}")
    }
}

/// A key of the schema.
struct Key {
    schema: Value,
    /// What the object says of it as a whole.
    object: Value,
}

impl Key {
    fn is_needed(&self, name: &str) -> bool {
        requires(&self.object, name)
    }

    /// Kinds of light that need it.
    fn kinds(&self, name: &str) -> Vec<&str> {
        let shapes = self.object["anyOf"].as_array().into_iter().flatten();
        let needing = shapes.filter(|shape| requires(shape, name));
        needing
            .map(|shape| shape["properties"]["kind"]["const"].as_str().unwrap())
            .collect()
    }
}

fn requires(schema: &Value, name: &str) -> bool {
    let required = schema["required"].as_array();
    required.is_some_and(|required| required.contains(&json!(name)))
}

/// The keys of the schema by their paths, as `frames[].animation.time`.
fn keys(object: &Value, path: &str) -> BTreeMap<String, Key> {
    let mut found = BTreeMap::new();
    for (name, schema) in object["properties"].as_object().into_iter().flatten() {
        let path = joined(path, name);
        found.extend(keys(schema, &path));
        found.extend(keys(&schema["items"], &format!("{path}[]")));
        let key = Key {
            schema: schema.clone(),
            object: object.clone(),
        };
        found.insert(path, key);
    }
    found
}

#[test]
fn each_key_is_documented_and_no_other() {
    let schema = keys(&schema(), WHOLE);
    let known: BTreeSet<&String> = schema.keys().collect();
    let documented = documented();
    let named: BTreeSet<&String> = documented.keys().collect();
    assert!(known.len() > 50, "{known:?}");
    assert_same(&named, &known);
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
fn types_ranges_needs_and_examples_are_those_of_the_schema() {
    let documented = documented();
    for (path, key) in keys(&schema(), WHOLE) {
        let name = path.rsplit('.').next().unwrap();
        let row = &documented[&path];
        assert_eq!(row.of_type, type_of(&key.schema), "{path}");
        check_range(&path, &row.range, &key.schema);
        let kinds = key.kinds(name);
        let need = match (key.is_needed(name), kinds.is_empty()) {
            (true, _) => "needed".to_owned(),
            (false, false) => format!("{}: needed", kinds.join(", ")),
            (false, true) => row.without.replace("needed", "?"),
        };
        assert_eq!(row.without, need, "{path}");
        assert!(!row.without.is_empty(), "{path}");
        check_example(&path, &row.example, &key.schema);
    }
}

fn type_of(schema: &Value) -> String {
    if let Some(values) = schema["oneOf"].as_array() {
        let names = values
            .iter()
            .map(|value| format!("`{}`", value["const"].as_str().unwrap()));
        return names.collect::<Vec<_>>().join(" or ");
    }
    // One that may be missing is null besides.
    let of_type = match &schema["type"] {
        Value::Array(types) => types.iter().find(|of_type| *of_type != "null").unwrap(),
        of_type => of_type,
    };
    match of_type.as_str().unwrap() {
        "string" => "text".to_owned(),
        "integer" => "whole number".to_owned(),
        "array" if schema["items"]["type"] == "object" => "list of objects".to_owned(),
        "array" => {
            assert_eq!(schema["minItems"], schema["maxItems"]);
            format!("{} numbers", schema["minItems"])
        }
        of_type => of_type.to_owned(),
    }
}

fn check_range(path: &str, range: &str, schema: &Value) {
    let of_numbers = if schema["items"]["minimum"].is_number() {
        &schema["items"]
    } else {
        schema
    };
    if let (Some(min), Some(max)) = (of_numbers["minimum"].as_f64(), of_numbers["maximum"].as_f64()) {
        let ends: Vec<f64> = range.split(" to ").map(|end| end.parse().unwrap()).collect();
        assert_eq!(ends, [min, max], "{path}");
        return;
    }
    let is_fixed = schema["minItems"] == schema["maxItems"];
    let expected = match (&schema["minItems"], &schema["maxItems"], &schema["minLength"]) {
        (Value::Number(min), ..) if !is_fixed => format!("{min} or more entries"),
        (_, Value::Number(max), _) if !is_fixed => format!("at most {max} entries"),
        (.., Value::Number(_)) => "not empty".to_owned(),
        _ => String::new(),
    };
    assert_eq!(range, expected, "{path}");
}

/// Objects have theirs in a table of their own.
fn check_example(path: &str, example: &str, schema: &Value) {
    if ["below", "above"].contains(&example) {
        assert!(type_of(schema).contains("object"), "{path}");
        return;
    }
    let value = serde_json::from_str(quoted(example)[0]).unwrap();
    assert!(follows(&value, schema), "{path}: {example}");
}

#[test]
fn the_example_has_every_key_and_the_reader_takes_it() {
    let index: Value = serde_json::from_str(example().unwrap()).unwrap();
    let mut found = BTreeSet::new();
    collect_keys(&index, "", &mut found);
    let known: BTreeSet<String> = keys(&schema(), WHOLE).into_keys().collect();
    assert_same(&found, &known);

    let size_px = ["width", "height"].map(|key| u32::try_from(index[key].as_u64().unwrap()).unwrap());
    let [width_px, height_px] = size_px;
    let photo = encode(&DynamicImage::new_rgb8(width_px, height_px), ImageFormat::Png);
    let mask = encode(&DynamicImage::new_rgba8(width_px, height_px), ImageFormat::Png);
    let files = [
        ("toy.glb", toy_glb(true)),
        ("plate.png", photo.clone()),
        ("frame_0000.png", photo.clone()),
        ("frame_0001.png", photo.clone()),
        ("truth_0000.png", photo.clone()),
        ("mask_0000.png", mask),
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
