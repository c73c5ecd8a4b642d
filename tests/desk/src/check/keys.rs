//! Unknown keys of `capture.json`, which are mostly misspelt.

use serde_json::Value;

use crate::files::SESSION_FILE;

/// The format's schema, which a test compares with the types that read it.
const SCHEMA: &str = include_str!("../../../../app-core/doc/session.schema.json");

/// The unknown keys of a session's index.
pub(super) fn unknown(index: &Value) -> Vec<String> {
    let mut unknown = Vec::new();
    let schema = serde_json::from_str(SCHEMA).unwrap_or_default();
    look(index, &schema, "", &mut unknown);
    unknown
}

/// Goes through a value and its schema side by side. If the schema names no keys, any key may
/// stand.
fn look(value: &Value, schema: &Value, path: &str, unknown: &mut Vec<String>) {
    match (value, &schema["properties"]) {
        (Value::Object(entries), Value::Object(known)) => {
            for (key, value) in entries {
                let path = match path {
                    "" => key.clone(),
                    parent => format!("{parent}.{key}"),
                };
                match known.get(key) {
                    Some(schema) => look(value, schema, &path, unknown),
                    None => unknown.push(format!("{SESSION_FILE} ({path}): the key is not known")),
                }
            }
        }
        (Value::Array(entries), _) => {
            for (index, value) in entries.iter().enumerate() {
                look(value, &schema["items"], &format!("{path}[{index}]"), unknown);
            }
        }
        _ => {}
    }
}
