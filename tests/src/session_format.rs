//! The format of sessions: the committed schema, and the document whose tables are generated from
//! it.

use app_core::session::schema;
use serde_json::Value;

/// Path of the schema, beside the document.
pub const SCHEMA_FILE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../app-core/doc/session.schema.json");
/// Path of the document.
pub const DOCUMENT_FILE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../app-core/doc/session.md");
/// The committed document.
pub const DOCUMENT: &str = include_str!("../../app-core/doc/session.md");
/// Path of the index itself, while other objects have their path in it.
pub const WHOLE: &str = "capture.json";

/// Lines before and after a generated table.
const BEGIN: &str = "<!-- keys -->\n";
const END: &str = "<!-- end of keys -->\n";
const HEAD: &str =
    "\n| key | type | range | needed | meaning | example |\n| --- | --- | --- | --- | --- | --- |\n";

/// The schema of the reader's present types.
#[must_use]
pub fn schema_text() -> String {
    format!("{:#}\n", schema())
}

/// The document with tables of the present schema.
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

/// The example of `capture.json` in the document; `None` if it is missing.
#[must_use]
pub fn example() -> Option<&'static str> {
    let (_, from) = DOCUMENT.split_once("```json\n")?;
    from.split_once("```").map(|(example, _)| example)
}

/// Texts between backticks: in a heading, the paths of the objects whose keys are below it.
#[must_use]
pub fn quoted(text: &str) -> Vec<&str> {
    text.split('`').skip(1).step_by(2).collect()
}

/// The value at a path such as `frames[].animation`.
///
/// For a list, the first entry with a value there counts.
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

/// The keys of the objects at `paths`, which are equal: required ones first.
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

/// Keys that an object requires, and whether always or for which kind.
fn needs(object: &Value) -> Vec<(&str, String)> {
    let always = texts(&object["required"]).map(|key| (key, "yes".to_owned()));
    let kinds = object["anyOf"].as_array().into_iter().flatten();
    let of_kinds = kinds.flat_map(|shape| {
        let kind = shape["properties"]["kind"]["const"].as_str().unwrap_or_default();
        texts(&shape["required"]).map(move |key| (key, format!("`{kind}`")))
    });
    always.chain(of_kinds).collect()
}

/// Possible values of a key, each with its description.
fn choices(schema: &Value) -> impl Iterator<Item = (&str, &str)> {
    let values = schema["oneOf"].as_array().into_iter().flatten();
    values.filter_map(|value| Some((value["const"].as_str()?, value["description"].as_str()?)))
}

fn type_of(schema: &Value) -> String {
    let choices: Vec<_> = choices(schema).map(|(value, _)| format!("`{value}`")).collect();
    if !choices.is_empty() {
        return choices.join(" or ");
    }
    // An optional key may also be null.
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

/// Objects have their own tables.
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
