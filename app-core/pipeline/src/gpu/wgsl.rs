//! WGSL as it is built in: without its comments, which are a third of the files and of no use on a
//! phone. Lines keep their numbers. A comment that imports a part stays.

/// Prefix of a line that imports a part.
pub(super) const IMPORT: &str = "//#import ";

/// The code of a WGSL file below `shaders`, by its path without the extension.
macro_rules! wgsl {
    ($path:expr) => {{
        const TEXT: &str = include_str!(concat!(
            env!("CARGO_MANIFEST_DIR"),
            "/../../shaders/",
            $path,
            ".wgsl"
        ));
        const CODE: &[u8] = &$crate::gpu::wgsl::code::<{ $crate::gpu::wgsl::code_length(TEXT) }>(TEXT);
        match std::str::from_utf8(CODE) {
            Ok(code) => code,
            Err(_) => panic!("no UTF-8"),
        }
    }};
}

pub(crate) use wgsl;

/// Length of a text without comments, in bytes.
pub(crate) const fn code_length(text: &str) -> usize {
    let text = text.as_bytes();
    let (mut at, mut length) = (0, 0);
    while at < text.len() {
        if starts_comment(text, at) {
            at = end_of_line(text, at);
        } else {
            (at, length) = (at + 1, length + 1);
        }
    }
    length
}

/// A text without comments, of that length.
pub(crate) const fn code<const LENGTH: usize>(text: &str) -> [u8; LENGTH] {
    let text = text.as_bytes();
    let mut code = [0; LENGTH];
    let (mut at, mut length) = (0, 0);
    while at < text.len() {
        if starts_comment(text, at) {
            at = end_of_line(text, at);
        } else {
            code[length] = text[at];
            (at, length) = (at + 1, length + 1);
        }
    }
    code
}

/// Whether a comment that imports nothing starts at a byte.
const fn starts_comment(text: &[u8], at: usize) -> bool {
    starts_with(text, at, b"//") && !starts_with(text, at, IMPORT.as_bytes())
}

const fn starts_with(text: &[u8], at: usize, start: &[u8]) -> bool {
    let mut index = 0;
    while index < start.len() {
        if at + index >= text.len() || text[at + index] != start[index] {
            return false;
        }
        index += 1;
    }
    true
}

/// The end of the line of a byte.
const fn end_of_line(text: &[u8], mut at: usize) -> usize {
    while at < text.len() && text[at] != b'\n' {
        at += 1;
    }
    at
}
