//! WGSL files as they are built in.

/// A file's text without its comments, but for those that import a part.
#[must_use]
pub fn without_comments(text: &str) -> String {
    let lines = text.split('\n').map(|line| match line.split_once("//") {
        Some((code, comment)) if !comment.starts_with("#import ") => code,
        _ => line,
    });
    lines.collect::<Vec<&str>>().join("\n")
}
