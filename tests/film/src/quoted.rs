//! Texts for the command lines that programs print.

/// A text as a shell reads it back, whatever is in it.
#[must_use]
pub fn quoted(text: &str) -> String {
    format!("'{}'", text.replace('\'', r"'\''"))
}
