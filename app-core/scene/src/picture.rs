//! Unsupported picture formats, recognised by their first bytes, and the way to convert them.

/// The format of an unsupported picture, and the way to convert it; `None` for an unknown one.
#[must_use]
pub fn kind(bytes: &[u8]) -> Option<(&'static str, &'static str)> {
    const DEVELOP: &str = "develop it into PNG or JPEG with the program that reads the camera's raw files";
    const SAVE: &str = "save it as PNG or JPEG";
    // Source: ISO/IEC 14496-12, section 4.3 (file type box).
    if let Some([b'f', b't', b'y', b'p', a, b, c, d]) = bytes.get(4..12) {
        return Some(match &[*a, *b, *c, *d] {
            b"avif" | b"avis" => ("AVIF", SAVE),
            b"heic" | b"heix" | b"hevc" | b"hevx" | b"heim" | b"heis" | b"mif1" | b"msf1" => (
                "HEIC",
                "save it as PNG or JPEG; an iPhone takes JPEG with Settings > Camera > Formats > Most Compatible",
            ),
            b"crx " => ("a raw photograph (CR3)", DEVELOP),
            _ => ("a video", "take single frames out of it, as PNG or JPEG"),
        });
    }
    let is_tiff = bytes.starts_with(b"II*\0") || bytes.starts_with(b"MM\0*");
    let known: [(bool, (&str, &str)); 9] = [
        (is_tiff && is_dng(bytes), ("a raw photograph (DNG)", DEVELOP)),
        (is_tiff, ("TIFF or a raw photograph", SAVE)),
        (
            bytes.starts_with(b"FUJIFILM"),
            ("a raw photograph (RAF)", DEVELOP),
        ),
        (
            bytes.starts_with(b"\xabKTX 20"),
            (
                "KTX2",
                "turn it into PNG, as with `npx @gltf-transform/cli ktxdecompress IN.glb OUT.glb`",
            ),
        ),
        (
            bytes.starts_with(b"\0\0\0\x0cJXL ") || bytes.starts_with(b"\xff\x0a"),
            ("JPEG XL", SAVE),
        ),
        (
            bytes.starts_with(b"RIFF") && bytes.get(8..12) == Some(b"WEBP"),
            ("WebP", SAVE),
        ),
        (bytes.starts_with(b"GIF8"), ("GIF", SAVE)),
        (bytes.starts_with(b"DDS "), ("DDS", SAVE)),
        (bytes.starts_with(b"BM"), ("BMP", SAVE)),
    ];
    known.into_iter().find_map(|(is_it, kind)| is_it.then_some(kind))
}

/// Whether the first directory has the tag that only DNG has, its version.
///
/// Source: TIFF 6.0, section 2; DNG 1.7, `DNGVersion` (50706).
fn is_dng(bytes: &[u8]) -> bool {
    const VERSION: u16 = 50706;
    let is_little = bytes.starts_with(b"II");
    let short = |at: usize| {
        let two: [u8; 2] = bytes.get(at..at.checked_add(2)?)?.try_into().ok()?;
        Some(if is_little {
            u16::from_le_bytes(two)
        } else {
            u16::from_be_bytes(two)
        })
    };
    let first = bytes.get(4..8).and_then(<[u8]>::first_chunk).and_then(|four| {
        let at = if is_little {
            u32::from_le_bytes(*four)
        } else {
            u32::from_be_bytes(*four)
        };
        usize::try_from(at).ok()
    });
    let Some(first) = first else { return false };
    let n_tags = usize::from(short(first).unwrap_or_default());
    (0..n_tags).any(|tag| short(first.saturating_add(2 + 12 * tag)) == Some(VERSION))
}
