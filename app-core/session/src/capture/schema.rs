//! JSON Schema of `capture.json`, from the records that the reader fills.

use schemars::Schema;
use schemars::generate::SchemaSettings;
use schemars::transform::RecursiveTransform;
use serde_json::Value;

use super::record::Index;

/// The schema (draft 2020-12) of a session's `capture.json`.
///
/// Only with the feature `schema`, which an app on a phone does not need.
#[must_use]
pub fn schema() -> Value {
    let settings = SchemaSettings::draft2020_12()
        .with(|settings| settings.inline_subschemas = true)
        .with_transform(RecursiveTransform(unwrap_lines));
    let generator = settings.into_generator();
    generator.into_root_schema_for::<Index>().to_value()
}

/// Puts a description on one line: line breaks of a comment have no meaning.
fn unwrap_lines(schema: &mut Schema) {
    if let Some(Value::String(description)) = schema.get_mut("description") {
        *description = description.replace('\n', " ");
    }
}
