//! Filters: convert numbers in meshopt's compressible forms to those of accessors.

#![expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "numbers are rounded into the bits that the format gives them"
)]

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::toy) enum Filter {
    None,
    Octahedral,
    Quaternion,
    Exponential,
    Color,
}

impl Filter {
    pub(in crate::toy) fn of(name: &str) -> Option<Self> {
        Some(match name {
            "NONE" => Self::None,
            "OCTAHEDRAL" => Self::Octahedral,
            "QUATERNION" => Self::Quaternion,
            "EXPONENTIAL" => Self::Exponential,
            "COLOR" => Self::Color,
            _ => return None,
        })
    }
}

/// In place, over elements of `stride` bytes.
pub(super) fn apply(filter: Filter, bytes: &mut [u8], stride: usize) {
    match (filter, stride) {
        (Filter::None, _) => {}
        (Filter::Octahedral, 4) => octahedral8(bytes),
        (Filter::Octahedral, _) => octahedral16(bytes),
        (Filter::Quaternion, _) => quaternion(bytes),
        (Filter::Exponential, _) => exponential(bytes),
        (Filter::Color, 4) => color8(bytes),
        (Filter::Color, _) => color16(bytes),
    }
}

/// Decodes a unit vector in octahedral coordinates, relative to the length that stands for one.
fn unfolded([x, y, one]: [f32; 3], most: f32) -> [f32; 3] {
    let z = one - x.abs() - y.abs();
    let fold = z.min(0.0);
    let x = x + if x >= 0.0 { fold } else { -fold };
    let y = y + if y >= 0.0 { fold } else { -fold };
    let length = (x * x + y * y + z * z).sqrt();
    let scale = if length > 0.0 { most / length } else { 0.0 };
    [x, y, z].map(|part| (part * scale).round())
}

fn octahedral8(bytes: &mut [u8]) {
    for element in bytes.as_chunks_mut::<4>().0 {
        let [x, y, one, _] = element.map(|byte| f32::from(byte.cast_signed()));
        let normal = unfolded([x, y, one], 127.0);
        for (byte, part) in element.iter_mut().zip(normal) {
            *byte = (part as i8).cast_unsigned();
        }
    }
}

fn shorts(element: &[u8; 8]) -> [i16; 4] {
    let [a, b, c, d, e, f, g, h] = *element;
    [[a, b], [c, d], [e, f], [g, h]].map(i16::from_le_bytes)
}

fn write_shorts(element: &mut [u8; 8], values: [i16; 4]) {
    for (bytes, value) in element.as_chunks_mut::<2>().0.iter_mut().zip(values) {
        *bytes = value.to_le_bytes();
    }
}

fn octahedral16(bytes: &mut [u8]) {
    for element in bytes.as_chunks_mut::<8>().0 {
        let [x, y, one, rest] = shorts(element);
        let [x, y, z] = unfolded([x, y, one].map(f32::from), 32767.0).map(|part| part as i16);
        write_shorts(element, [x, y, z, rest]);
    }
}

/// Decodes the three smaller components of a unit quaternion; the last number holds the index of
/// the largest, and the scale.
fn quaternion(bytes: &mut [u8]) {
    for element in bytes.as_chunks_mut::<8>().0 {
        let [a, b, c, code] = shorts(element);
        let scale = std::f32::consts::FRAC_1_SQRT_2 / f32::from(code | 3);
        let parts = [a, b, c].map(|part| f32::from(part) * scale);
        let largest = (1.0 - parts.iter().map(|part| part * part).sum::<f32>())
            .max(0.0)
            .sqrt();
        let at = (code & 3) as usize;
        let mut values = [0; 4];
        values[at] = (largest * 32767.0).round() as i16;
        for (step, part) in (1..).zip(parts) {
            values[(at + step) & 3] = (part * 32767.0).round() as i16;
        }
        write_shorts(element, values);
    }
}

/// Decodes 24 bits of a mantissa and 8 of its exponent.
fn exponential(bytes: &mut [u8]) {
    for element in bytes.as_chunks_mut::<4>().0 {
        let code = i32::from_le_bytes(*element);
        let (mantissa, exponent) = (code << 8 >> 8, code >> 24);
        // Exact in 64 bits, with one rounding.
        let value = (f64::from(mantissa) * 2.0_f64.powi(exponent)) as f32;
        *element = value.to_le_bytes();
    }
}

/// Decodes luma, two colour differences and alpha, whose highest bit defines the scale.
fn rgba([luma, orange, green, alpha]: [i32; 4], most: i32) -> [i32; 4] {
    let mut scale = alpha;
    for shift in [1, 2, 4, 8] {
        scale |= scale >> shift;
    }
    let rgb = [luma + orange - green, luma + green, luma - orange - green];
    let alpha = ((alpha << 1) & scale) | (alpha & 1);
    let factor = if scale > 0 {
        most as f32 / scale as f32
    } else {
        0.0
    };
    let scaled = |value: i32| (value as f32 * factor).round().clamp(0.0, most as f32) as i32;
    [rgb[0], rgb[1], rgb[2], alpha].map(scaled)
}

fn color8(bytes: &mut [u8]) {
    for element in bytes.as_chunks_mut::<4>().0 {
        let [luma, orange, green, alpha] = *element;
        let signed = |byte: u8| i32::from(byte.cast_signed());
        let values = [i32::from(luma), signed(orange), signed(green), i32::from(alpha)];
        *element = rgba(values, 255).map(|value| value as u8);
    }
}

fn color16(bytes: &mut [u8]) {
    for element in bytes.as_chunks_mut::<8>().0 {
        let [luma, orange, green, alpha] = shorts(element);
        let unsigned = |value: i16| i32::from(value.cast_unsigned());
        let values = [unsigned(luma), orange.into(), green.into(), unsigned(alpha)];
        write_shorts(
            element,
            rgba(values, 65535).map(|value| (value as u16).cast_signed()),
        );
    }
}
