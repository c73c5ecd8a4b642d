//! The schema of `capture.json` is up to date, sessions conform to it, and it agrees with the
//! reader.

use std::fs;
use std::path::Path;

use app_core::session::schema;
use desk::files::{BUNDLED_SESSION, SESSION_FILE};
use harness::session_format::{SCHEMA_FILE, example, schema_text};
use serde_json::{Value, json};

use crate::session::follows::follows;
use crate::session::parts::{Parts, good_index};

#[test]
fn the_schema_is_the_one_that_is_kept() {
    let kept = fs::read_to_string(SCHEMA_FILE).unwrap();
    assert!(
        kept == schema_text(),
        "{SCHEMA_FILE} is not that of the reader: `cargo xtask bless session.schema`, and look at what has changed"
    );
}

#[test]
fn good_sessions_follow_the_schema() {
    let bundled = fs::read_to_string(Path::new(BUNDLED_SESSION).join(SESSION_FILE)).unwrap();
    for text in [&bundled, example().unwrap(), &good_index().to_string()] {
        let index = serde_json::from_str(text).unwrap();
        assert!(follows(&index, &schema()), "{text}");
    }
}

/// Errors other than those planted below.
#[test]
fn wrong_sessions_do_not() {
    let plate = &good_index()["backgrounds"][0];
    let cases = [
        ("/format", json!("shadow-movie")),
        ("/width", json!(2.5)),
        ("/lights/0/kind", json!("directional")),
        ("/backgrounds", json!(vec![plate; 513])),
    ];
    for (pointer, wrong) in cases {
        let mut index = good_index();
        *index.pointer_mut(pointer).unwrap() = wrong;
        assert!(!follows(&index, &schema()), "{pointer}");
    }
}

/// Each key is removed, and each value replaced by values of other types and sizes: the schema and
/// the reader refuse the same ones.
#[test]
fn schema_and_reader_agree() {
    let (mut n_good, mut n_wrong, mut disagreed) = (0, 0, Vec::new());
    for (change, index) in changes(&good_index()) {
        let follows = follows(&index, &schema());
        let parts = Parts {
            index,
            ..Parts::good()
        };
        match parts.read_all() {
            Ok(()) if follows => n_good += 1,
            Err(_) if !follows => n_wrong += 1,
            Ok(()) => disagreed.push(format!("{change}: the reader alone takes it")),
            Err(error) => disagreed.push(format!("{change}: the reader alone refuses it, {error}")),
        }
    }
    assert!(disagreed.is_empty(), "{}", disagreed.join("\n"));
    assert!(n_good > 50 && n_wrong > 1000, "{n_good} good, {n_wrong} wrong");
}

/// The changes, and the changed indices.
fn changes(good: &Value) -> Vec<(String, Value)> {
    let mut changes = Vec::new();
    for (pointer, schema) in values(good, &schema(), "") {
        let (parent, key) = pointer.rsplit_once('/').unwrap();
        let mut without = good.clone();
        if let Some(entries) = without.pointer_mut(parent).unwrap().as_object_mut() {
            entries.remove(key);
            changes.push((format!("no {pointer}"), without));
        }
        for value in replacements(&pointer, &schema) {
            let mut index = good.clone();
            let change = format!("{pointer} = {value}");
            *index.pointer_mut(&pointer).unwrap() = value;
            changes.push((change, index));
        }
    }
    changes
}

/// All values of the index, each with its schema, or null without one.
fn values(value: &Value, schema: &Value, pointer: &str) -> Vec<(String, Value)> {
    let mut found = Vec::new();
    let mut below = |key: &str, value, schema: &Value| {
        let pointer = format!("{pointer}/{key}");
        found.extend(values(value, schema, &pointer));
        found.push((pointer, schema.clone()));
    };
    match value {
        Value::Object(entries) => entries
            .iter()
            .for_each(|(key, value)| below(key, value, &schema["properties"][key])),
        Value::Array(entries) => entries
            .iter()
            .enumerate()
            .for_each(|(index, value)| below(&index.to_string(), value, &schema["items"])),
        _ => {}
    }
    found
}

fn replacements(pointer: &str, schema: &Value) -> Vec<Value> {
    let mut values = vec![
        json!(null),
        json!(true),
        json!([]),
        json!({}),
        json!(-1e300),
        json!(1e300),
    ];
    // The toy has no clip without a name.
    if !pointer.ends_with("/clip") {
        values.push(json!(""));
    }
    if let (Some(min), Some(max)) = (schema["minimum"].as_f64(), schema["maximum"].as_f64()) {
        let beyond = 0.1 * (max - min);
        values.extend([json!(min - beyond), json!(max + beyond)]);
        // The entries of a matrix and the size of the pictures are also subject to other rules.
        if !pointer.contains("/world_from_") && !["/width", "/height"].contains(&pointer) {
            values.extend([json!(min), json!(max)]);
        }
    }
    values
}
