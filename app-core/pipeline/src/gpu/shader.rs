//! Shaders: WGSL joined from parts, each part with the host's mirrors of its declarations.

use std::hash::{Hash, Hasher};

use super::shared::Mirror;

/// A file of WGSL, and the declarations that the host shares.
#[derive(Clone, Copy, Debug)]
pub struct Part {
    /// Path below `shaders`, without its ending.
    pub path: &'static str,
    /// The WGSL.
    pub text: &'static str,
    /// Host mirrors of structs that it declares.
    pub structs: &'static [Mirror],
    /// The host's values of constants that it declares.
    pub constants: &'static [(&'static str, f64)],
}

/// A pass's shader: its own part after those that it shares with others.
#[derive(Clone, Copy, Debug)]
pub struct Shader {
    /// The pass's one name, that of its own part's file.
    pub name: &'static str,
    /// In the order in which they are joined.
    pub parts: &'static [&'static Part],
}

impl Shader {
    /// A shader of parts, its own the last one.
    pub(crate) const fn new(parts: &'static [&'static Part]) -> Self {
        Self {
            name: file_name(parts[parts.len() - 1].path),
            parts,
        }
    }

    /// The joined WGSL.
    #[must_use]
    pub fn source(&self) -> String {
        let texts: Vec<&str> = self.parts.iter().map(|part| part.text).collect();
        texts.join("\n")
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

/// A file of WGSL below `shaders` as a [`Part`], with the host's structs and constants of the same names.
macro_rules! part {
    (
        $path:literal
        $(, structs: [$($of:ty),* $(,)?])?
        $(, constants: [$($constant:ident),* $(,)?])?
        $(,)?
    ) => {
        $crate::gpu::shader::Part {
            path: $path,
            text: include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/../../shaders/", $path, ".wgsl")),
            structs: &[$($(<$of as $crate::gpu::shared::Shared>::MIRROR),*)?],
            #[allow(clippy::cast_precision_loss, clippy::cast_lossless, reason = "small whole numbers, and f32")]
            constants: &[$($((stringify!($constant), $constant as f64)),*)?],
        }
    };
}

pub(crate) use part;
