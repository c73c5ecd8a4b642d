//! Shaders: WGSL joined with the parts that it imports, and the host's mirrors of its declarations.
//!
//! A file names the parts that it needs in its head, each in a line `//#import common/x`; parts may import others. To WGSL these
//! lines are comments.

use std::hash::{Hash, Hasher};

use super::common;
use super::shared::Mirror;

/// What begins a line that imports a part.
const IMPORT: &str = "//#import ";

/// Declarations of a file of WGSL that the host shares.
#[derive(Clone, Copy, Debug)]
pub struct Mirrors {
    /// Path of the file below `shaders`, without its ending.
    pub path: &'static str,
    /// Host mirrors of structs that it declares.
    pub structs: &'static [Mirror],
    /// The host's values of constants that it declares.
    pub constants: &'static [(&'static str, f64)],
}

/// A pass's shader.
#[derive(Clone, Copy, Debug)]
pub struct Shader {
    /// The pass's one name, that of its file.
    pub name: &'static str,
    /// The file's own WGSL.
    pub text: &'static str,
    /// What the host shares of it.
    pub mirrors: Mirrors,
}

impl Shader {
    pub(crate) const fn new(text: &'static str, mirrors: Mirrors) -> Self {
        Self {
            name: file_name(mirrors.path),
            text,
            mirrors,
        }
    }

    /// Paths of the parts that it imports and that these import, each once and after those that it needs itself.
    #[must_use]
    pub fn imports(&self) -> Vec<&'static str> {
        let mut paths = Vec::new();
        add_imports(self.text, &mut Vec::new(), &mut paths);
        paths
    }

    /// The WGSL of the imported parts, then its own. A part that does not exist is left out.
    #[must_use]
    pub fn source(&self) -> String {
        let parts = self.imports().into_iter().filter_map(common::text);
        let texts: Vec<&str> = parts.chain([self.text]).collect();
        texts.join("\n")
    }
}

/// Adds the parts that `text` imports to `paths`; those in `seen` are there, or are about to be.
fn add_imports(text: &'static str, seen: &mut Vec<&'static str>, paths: &mut Vec<&'static str>) {
    for path in text.lines().filter_map(|line| line.strip_prefix(IMPORT)) {
        if !seen.contains(&path) {
            seen.push(path);
            add_imports(common::text(path).unwrap_or_default(), seen, paths);
            paths.push(path);
        }
    }
}

impl PartialEq for Shader {
    fn eq(&self, other: &Self) -> bool {
        self.name == other.name
    }
}

impl Eq for Shader {}

impl Hash for Shader {
    fn hash<H: Hasher>(&self, state: &mut H) {
        self.name.hash(state);
    }
}

/// The part of `path` after the last slash.
const fn file_name(path: &'static str) -> &'static str {
    let mut first = path.len();
    while first > 0 && path.as_bytes()[first - 1] != b'/' {
        first -= 1;
    }
    path.split_at(first).1
}

/// The host's structs and constants of the same names as those of a file of WGSL below `shaders`.
macro_rules! mirrors {
    (
        $path:literal
        $(, structs: [$($of:ty),* $(,)?])?
        $(, constants: [$($constant:ident),* $(,)?])?
        $(,)?
    ) => {
        $crate::gpu::shader::Mirrors {
            path: $path,
            structs: &[$($(<$of as $crate::gpu::shared::Shared>::MIRROR),*)?],
            constants: &[$($((stringify!($constant), $constant as f64)),*)?],
        }
    };
}

/// The shader of a file of WGSL below `shaders`, with the host's structs and constants of the same names.
macro_rules! shader {
    ($path:literal $($mirrors:tt)*) => {
        $crate::gpu::shader::Shader::new(
            include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/../../shaders/", $path, ".wgsl")),
            $crate::gpu::shader::mirrors!($path $($mirrors)*),
        )
    };
}

pub(crate) use {mirrors, shader};
