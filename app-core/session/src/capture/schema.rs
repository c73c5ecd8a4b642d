//! JSON Schema of `capture.json`, from the records that the reader fills.

use schemars::generate::SchemaSettings;
use schemars::transform::RecursiveTransform;
use schemars::{JsonSchema, Schema};
use serde_json::Value;

use super::record::{CaptureRecord, Header};

/// `capture.json` of a `shadow-capture` folder, version 1. World space is right-handed, +Y up, metres. A matrix `a_from_b`
/// takes points of b to a; its 16 numbers are column-major. The centre of the first pixel is at (0.5, 0.5).
#[derive(JsonSchema)]
#[schemars(title = "shadow-capture")]
#[expect(
    dead_code,
    reason = "described, never filled: the reader takes its parts one by one"
)]
struct Index {
    #[schemars(flatten)]
    header: Header,
    #[schemars(flatten)]
    capture: CaptureRecord,
    #[schemars(flatten)]
    remarks: Remarks,
}

/// Keys for people, which the reader skips like any that it does not know.
#[derive(JsonSchema)]
#[expect(dead_code, reason = "described, never filled")]
struct Remarks {
    /// What is seen, for people. Not read.
    description: Option<String>,
    /// Whose work toy and pictures are, and under which licences. Not read.
    credits: Option<String>,
    /// Unit of all lengths, which is the metre whatever stands here. Not read.
    units: Option<String>,
}

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

/// Puts a description on one line: a comment's lines end where its room does.
fn unwrap_lines(schema: &mut Schema) {
    if let Some(Value::String(description)) = schema.get_mut("description") {
        *description = description.replace('\n', " ");
    }
}
