//! Shaders: WGSL joined with its imported parts, and the host's mirrors of its declarations.
//!
//! A file names its imports in its head, each in a line `//#import common/x`; parts may import
//! others. To WGSL these lines are comments.

use std::collections::BTreeMap;
use std::hash::{Hash, Hasher};

use super::common;
use super::shared::Mirror;
use super::wgsl::IMPORT;

/// Declarations of a WGSL file that the host shares.
#[derive(Clone, Copy, Debug)]
pub struct Mirrors {
    /// Path of the file below `shaders`, without its extension.
    pub path: &'static str,
    /// Host mirrors of structs that it declares.
    pub structs: &'static [Mirror],
    /// The host's values of constants that it declares.
    pub constants: &'static [(&'static str, f64)],
}

/// WGSL files in place of the built-in ones, by their paths below `shaders` without the extension;
/// a part may be new.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ShaderTexts(BTreeMap<String, String>);

impl FromIterator<(String, String)> for ShaderTexts {
    /// Takes pairs of a path, such as `frame/composite`, and the file's text.
    fn from_iter<T: IntoIterator<Item = (String, String)>>(texts: T) -> Self {
        Self(texts.into_iter().collect())
    }
}

/// All files as they are built in.
static BUILT_IN: ShaderTexts = ShaderTexts(BTreeMap::new());

impl ShaderTexts {
    /// The replacement text for a path, if there is one.
    fn given(&self, path: &str) -> Option<&str> {
        self.0.get(path).map(String::as_str)
    }

    /// The WGSL of a part: the replacement, or the built-in text.
    fn part(&self, path: &str) -> Option<&str> {
        self.given(path).or_else(|| common::text(path))
    }
}

/// A pass's shader.
#[derive(Clone, Copy, Debug)]
pub struct Shader {
    /// The pass's only name, that of its file.
    pub name: &'static str,
    /// The file's own WGSL, without comments.
    pub text: &'static str,
    /// Declarations that the host shares with it.
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

    /// Paths of the parts that it imports and of their own imports, each once and after those that
    /// it needs itself.
    #[must_use]
    pub fn imports(&self) -> Vec<&'static str> {
        imports(self.text, &BUILT_IN)
    }

    /// The WGSL of the imported parts, then its own. A part that does not exist is left out.
    #[must_use]
    pub fn source(&self) -> String {
        self.source_with(&BUILT_IN)
    }

    /// The source with other texts.
    pub(crate) fn source_with(&self, texts: &ShaderTexts) -> String {
        let own = texts.given(self.mirrors.path).unwrap_or(self.text);
        let imported = imports(own, texts).into_iter();
        let parts = imported.filter_map(|path| texts.part(path));
        let joined: Vec<&str> = parts.chain([own]).collect();
        joined.join("\n")
    }
}

/// Paths of the parts that `text` imports and of their own imports, each once and after those that
/// it needs itself.
fn imports<'a>(text: &'a str, texts: &'a ShaderTexts) -> Vec<&'a str> {
    let mut paths = Vec::new();
    add_imports(text, texts, &mut Vec::new(), &mut paths);
    paths
}

/// Adds the parts that `text` imports to `paths`; those in `seen` are in the list already, or are
/// about to be added.
fn add_imports<'a>(text: &'a str, texts: &'a ShaderTexts, seen: &mut Vec<&'a str>, paths: &mut Vec<&'a str>) {
    let imported = text.lines().filter_map(|line| line.strip_prefix(IMPORT));
    for path in imported.map(str::trim_end) {
        if !seen.contains(&path) {
            seen.push(path);
            add_imports(texts.part(path).unwrap_or_default(), texts, seen, paths);
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

/// The host's structs and constants with the names of those in a WGSL file below `shaders`.
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

/// The shader of a WGSL file below `shaders`, with the host's structs and constants of the same
/// names.
macro_rules! shader {
    ($path:literal $($mirrors:tt)*) => {
        $crate::gpu::shader::Shader::new(
            $crate::gpu::wgsl::wgsl!($path),
            $crate::gpu::shader::mirrors!($path $($mirrors)*),
        )
    };
}

pub(crate) use {mirrors, shader};
