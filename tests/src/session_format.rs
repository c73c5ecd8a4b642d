//! The format of sessions: its schema as it is kept in the repository, and its document, whose tables are made of that.

use app_core::session::schema;
use serde_json::Value;

/// Where the schema is kept, beside the document.
pub const SCHEMA_FILE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../app-core/doc/session.schema.json");
/// Where the document is kept.
pub const DOCUMENT_FILE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../app-core/doc/session.md");
/// The document as it is kept.
pub const DOCUMENT: &str = include_str!("../../app-core/doc/session.md");
/// The index itself, where other objects have their path in it.
pub const WHOLE: &str = "capture.json";

/// Lines before and after a table that is made.
const BEGIN: &str = "<!-- keys -->\n";
const END: &str = "<!-- end of keys -->\n";
const HEAD: &str =
    "\n| key | type | range | needed | meaning | example |\n| --- | --- | --- | --- | --- | --- |\n";

/// The schema from the types that the reader has now.
#[must_use]
pub fn schema_text() -> String {
    format!("{:#}\n", schema())
}

/// The document with the tables that the schema has now.
#[must_use]
pub fn document_text() -> String {
    let schema = schema();
    let example = example().and_then(|example| serde_json::from_str(example).ok());
    let example = example.unwrap_or_default();
    let mut text = String::new();
    let (mut heading, mut is_in_table) = ("", false);
    for line in DOCUMENT.split_inclusive('\n') {
        if line.starts_with("### ") {
            heading = line;
        }
        is_in_table &= line != END;
        if !is_in_table {
            text += line;
        }
        if line == BEGIN {
            is_in_table = true;
            text += &table(&schema, &example, &quoted(heading));
        }
    }
    text
}

/// The `capture.json` that the document gives as an example; none where it has lost it.
#[must_use]
pub fn example() -> Option<&'static str> {
    let (_, from) = DOCUMENT.split_once("```json\n")?;
    from.split_once("```").map(|(example, _)| example)
}

/// What stands between backticks: in a heading, the paths of the objects whose keys are below it.
#[must_use]
pub fn quoted(text: &str) -> Vec<&str> {
    text.split('`').skip(1).step_by(2).collect()
}

/// What is at a path as `frames[].animation`.
///
/// Only the first of a list's entries that has something there tells of it.
fn value_at<'a>(value: &'a Value, path: &[&str]) -> Option<&'a Value> {
    match (path, value) {
        ([], value) => Some(value).filter(|value| !value.is_null()),
        (path, Value::Array(entries)) => entries.iter().find_map(|entry| value_at(entry, path)),
        ([key, rest @ ..], value) => value_at(value.get(key)?, rest),
    }
}

/// The keys in a path.
fn keys(path: &str) -> Vec<&str> {
    let keys = path.split('.').map(|key| key.trim_end_matches("[]"));
    if path == WHOLE { Vec::new() } else { keys.collect() }
}

/// The schema of the object at a path.
fn object_at<'a>(schema: &'a Value, path: &str) -> &'a Value {
    keys(path).into_iter().fold(schema, |object, key| {
        let of_key = &object["properties"][key];
        of_key.get("items").unwrap_or(of_key)
    })
}

/// The keys of the objects at `paths`, which are alike: needed ones first.
fn table(schema: &Value, example: &Value, paths: &[&str]) -> String {
    let object = object_at(schema, paths.first().unwrap_or(&WHOLE));
    let needs = needs(object);
    let place = |key: &str| needs.iter().position(|(needed, _)| *needed == key);
    let mut entries: Vec<_> = object["properties"].as_object().into_iter().flatten().collect();
    entries.sort_by_key(|(key, _)| place(key).unwrap_or(usize::MAX));
    let rows = entries.into_iter().map(|(key, of_key)| {
        let need = place(key).map_or("", |place| &needs[place].1);
        let shown = paths
            .iter()
            .find_map(|path| value_at(example, &[keys(path), vec![key]].concat()));
        let cells = [
            type_of(of_key),
            range_of(of_key),
            need.to_owned(),
            meaning_of(of_key),
            shown.map_or_else(String::new, shown_as),
        ];
        format!("| `{key}` | {} |\n", cells.join(" | "))
    });
    format!("{HEAD}{}\n", rows.collect::<String>())
}

fn texts(list: &Value) -> impl Iterator<Item = &str> {
    list.as_array().into_iter().flatten().filter_map(Value::as_str)
}

/// Keys that an object needs, and whether it always does, or of which kind it must be.
fn needs(object: &Value) -> Vec<(&str, String)> {
    let always = texts(&object["required"]).map(|key| (key, "yes".to_owned()));
    let kinds = object["anyOf"].as_array().into_iter().flatten();
    let of_kinds = kinds.flat_map(|shape| {
        let kind = shape["properties"]["kind"]["const"].as_str().unwrap_or_default();
        texts(&shape["required"]).map(move |key| (key, format!("`{kind}`")))
    });
    always.chain(of_kinds).collect()
}

/// Values that a key may have, each with its description.
fn choices(schema: &Value) -> impl Iterator<Item = (&str, &str)> {
    let values = schema["oneOf"].as_array().into_iter().flatten();
    values.filter_map(|value| Some((value["const"].as_str()?, value["description"].as_str()?)))
}

fn type_of(schema: &Value) -> String {
    let choices: Vec<_> = choices(schema).map(|(value, _)| format!("`{value}`")).collect();
    if !choices.is_empty() {
        return choices.join(" or ");
    }
    // One that may be missing is null besides.
    let of_type = match &schema["type"] {
        Value::Array(types) => types.iter().find(|of_type| *of_type != "null"),
        of_type => Some(of_type),
    };
    match of_type.and_then(Value::as_str).unwrap_or_default() {
        "string" => "text".to_owned(),
        "integer" => "whole number".to_owned(),
        "array" if schema["items"]["type"] == "object" => "list of objects".to_owned(),
        "array" => format!("{} numbers", schema["maxItems"]),
        of_type => of_type.to_owned(),
    }
}

fn range_of(schema: &Value) -> String {
    let of_entries = Some(&schema["items"]).filter(|entries| entries["minimum"].is_number());
    let of_numbers = of_entries.unwrap_or(schema);
    if let (Some(min), Some(max)) = (of_numbers["minimum"].as_f64(), of_numbers["maximum"].as_f64()) {
        return format!("{} to {}", short(min), short(max));
    }
    let is_fixed = schema["minItems"] == schema["maxItems"];
    match (&schema["minItems"], &schema["maxItems"], &schema["minLength"]) {
        (Value::Number(min), ..) if !is_fixed => format!("{min} or more entries"),
        (_, Value::Number(max), _) if !is_fixed => format!("at most {max} entries"),
        (.., Value::Number(_)) => "not empty".to_owned(),
        _ => String::new(),
    }
}

fn short(number: f64) -> String {
    let plain = number.to_string();
    if plain.len() > 6 {
        format!("{number:e}")
    } else {
        plain
    }
}

fn meaning_of(schema: &Value) -> String {
    let meaning = schema["description"].as_str().unwrap_or_default().to_owned();
    choices(schema).fold(meaning, |meaning, (value, of_value)| {
        format!("{meaning} `{value}`: {of_value}")
    })
}

/// Objects have tables of their own.
fn shown_as(value: &Value) -> String {
    match value {
        Value::Object(_) => String::new(),
        Value::Array(entries) if entries.iter().any(Value::is_object) => String::new(),
        Value::Array(entries) => {
            let entries: Vec<_> = entries.iter().map(Value::to_string).collect();
            format!("`[{}]`", entries.join(", "))
        }
        value => format!("`{value}`"),
    }
}
