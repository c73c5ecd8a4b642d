//! The number formats of accessors.

use gltf::json::accessor::ComponentType;

/// Reads one number, little-endian; normalised integers become fractions. `None` for 32-bit integers.
pub(super) fn float_decoder(component: ComponentType, is_normalized: bool) -> Option<fn(&[u8]) -> f32> {
    Some(match (component, is_normalized) {
        (ComponentType::F32, _) => |b| f32::from_le_bytes(first(b)),
        (ComponentType::U8, true) => |b| f32::from(u8::from_le_bytes(first(b))) / 255.0,
        (ComponentType::U16, true) => |b| f32::from(u16::from_le_bytes(first(b))) / 65535.0,
        (ComponentType::I8, true) => |b| (f32::from(i8::from_le_bytes(first(b))) / 127.0).max(-1.0),
        (ComponentType::I16, true) => |b| (f32::from(i16::from_le_bytes(first(b))) / 32767.0).max(-1.0),
        (ComponentType::U8, false) => |b| f32::from(u8::from_le_bytes(first(b))),
        (ComponentType::U16, false) => |b| f32::from(u16::from_le_bytes(first(b))),
        (ComponentType::I8, false) => |b| f32::from(i8::from_le_bytes(first(b))),
        (ComponentType::I16, false) => |b| f32::from(i16::from_le_bytes(first(b))),
        (ComponentType::U32, _) => return None,
    })
}

/// Reads one number, little-endian; `None` where it may have a sign or a fraction.
pub(super) fn integer_decoder(component: ComponentType) -> Option<fn(&[u8]) -> u32> {
    Some(match component {
        ComponentType::U8 => |b| u32::from(u8::from_le_bytes(first(b))),
        ComponentType::U16 => |b| u32::from(u16::from_le_bytes(first(b))),
        ComponentType::U32 => |b| u32::from_le_bytes(first(b)),
        ComponentType::I8 | ComponentType::I16 | ComponentType::F32 => return None,
    })
}

/// The callers pass chunks of exactly `N` bytes.
fn first<const N: usize>(bytes: &[u8]) -> [u8; N] {
    bytes.first_chunk().copied().unwrap_or([0; N])
}
