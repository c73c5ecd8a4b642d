//! Structs shared with shaders, and their layout; a test compares each with the WGSL through naga.

/// Layout of a struct in Rust.
#[derive(Clone, Copy, Debug)]
pub struct Mirror {
    /// Its name on both sides.
    pub name: &'static str,
    /// Size in bytes.
    pub size: usize,
    /// Members in the order of declaration.
    pub members: &'static [Member],
}

/// A member of a shared struct.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Member {
    /// Its name on both sides.
    pub name: &'static str,
    /// Offset from the beginning of the struct in bytes.
    pub offset: usize,
    /// Size in bytes.
    pub size: usize,
    /// Scalar type; `None` for a struct, whose members are compared separately.
    pub kind: Option<NumberKind>,
}

/// A scalar type.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NumberKind {
    /// `f32`.
    Float,
    /// `i32`.
    Signed,
    /// `u32`.
    Unsigned,
}

/// A struct that shaders share.
pub(crate) trait Shared: bytemuck::Pod {
    /// Its layout.
    const MIRROR: Mirror;
}

/// Scalar type of a member.
pub(crate) trait Numbers {
    /// `None` for a struct.
    const KIND: Option<NumberKind>;
}

impl Numbers for f32 {
    const KIND: Option<NumberKind> = Some(NumberKind::Float);
}

impl Numbers for i32 {
    const KIND: Option<NumberKind> = Some(NumberKind::Signed);
}

impl Numbers for u32 {
    const KIND: Option<NumberKind> = Some(NumberKind::Unsigned);
}

impl<T: Numbers, const N: usize> Numbers for [T; N] {
    const KIND: Option<NumberKind> = T::KIND;
}

/// A 3 x 3 matrix in uniform layout: columns aligned to 16 bytes.
pub(crate) type Mat3Columns = [[f32; 4]; 3];

/// Declares a struct that a shader declares under the same name, with the same members.
macro_rules! shared_struct {
    ($(#[$meta:meta])* $vis:vis struct $name:ident { $(pub $field:ident: $type:ty),* $(,)? }) => {
        $(#[$meta])*
        #[repr(C)]
        #[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
        #[allow(missing_docs, reason = "documented where the shader declares them")]
        $vis struct $name {
            $(pub $field: $type),*
        }

        impl $crate::gpu::shared::Numbers for $name {
            const KIND: Option<$crate::gpu::shared::NumberKind> = None;
        }

        impl $crate::gpu::shared::Shared for $name {
            const MIRROR: $crate::gpu::shared::Mirror = $crate::gpu::shared::Mirror {
                name: stringify!($name),
                size: size_of::<Self>(),
                members: &[$($crate::gpu::shared::Member {
                    name: stringify!($field),
                    offset: std::mem::offset_of!(Self, $field),
                    size: size_of::<$type>(),
                    kind: <$type as $crate::gpu::shared::Numbers>::KIND,
                }),*],
            };
        }
    };
}

pub(crate) use shared_struct;
