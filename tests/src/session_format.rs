//! The format of sessions: its schema as it is kept in the repository, and its document.

use app_core::session::schema;

/// Name of the file that holds the schema.
pub const SCHEMA_NAME: &str = "session.schema.json";
/// Where it lies, beside the document; `cargo xtask bless` writes it.
pub const SCHEMA_FILE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../app-core/doc/session.schema.json");
/// The document.
pub const DOCUMENT: &str = include_str!("../../app-core/doc/session.md");

/// What the file holds, from the types that the reader has now.
#[must_use]
pub fn schema_text() -> String {
    format!("{:#}\n", schema())
}

/// The `capture.json` that the document gives as an example; none where it has lost it.
#[must_use]
pub fn example() -> Option<&'static str> {
    let (_, from) = DOCUMENT.split_once("```json\n")?;
    from.split_once("```").map(|(example, _)| example)
}
