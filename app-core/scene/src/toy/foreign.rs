//! Files of other formats, recognised by their first bytes, and the way to convert them to a toy.

use super::error::{Flaw, ToyProblem};

/// A format's name, and the way to convert it to a toy.
type Kind = (&'static str, &'static str);

const BLENDER: &str =
    "open it in Blender (File > Import) and export it as glTF 2.0, format glTF Binary (.glb)";

/// First bytes of known formats.
const MAGICS: [(&[u8], Kind); 15] = [
    (b"Kaydara FBX", ("an FBX model", BLENDER)),
    (b"; FBX", ("an FBX model", BLENDER)),
    (b"PXR-USDC", ("a USD model", BLENDER)),
    (b"#usda", ("a USD model", BLENDER)),
    (b"ply", ("a PLY model", BLENDER)),
    (b"solid ", ("an STL model", BLENDER)),
    (
        b"BLENDER",
        (
            "a Blender scene",
            "export it from Blender as glTF 2.0, format glTF Binary (.glb)",
        ),
    ),
    (
        b"\x1f\x8b",
        ("a packed file (gzip)", "unpack it and give the .glb in it"),
    ),
    (
        b"7z\xbc\xaf",
        ("a packed file (7z)", "unpack it and give the .glb in it"),
    ),
    (
        b"Rar!",
        ("a packed file (RAR)", "unpack it and give the .glb in it"),
    ),
    (b"\x89PNG", ("a picture", "give the toy's model, a .glb file")),
    (
        b"\xff\xd8\xff",
        ("a picture", "give the toy's model, a .glb file"),
    ),
    (
        b"version https://git-lfs",
        (
            "a stand-in for a file that Git LFS keeps elsewhere",
            "fetch the file itself with `git lfs pull`",
        ),
    ),
    (b"<?xml", ("an XML file, perhaps a COLLADA model", BLENDER)),
    (
        b"<",
        ("a web page or XML", "download the model itself, a .glb file"),
    ),
];

/// The refusal of a file that is neither binary glTF nor JSON; `None` if its format is unknown.
pub(super) fn refusal(bytes: &[u8]) -> Option<Flaw> {
    let text = without_blanks(bytes);
    let known = MAGICS.iter().find(|(magic, _)| text.starts_with(magic));
    let kind = match known {
        _ if bytes.starts_with(b"PK\x03\x04") => Some(of_zip(bytes)),
        Some((_, kind)) => Some(*kind),
        None if is_obj(text) => Some(("an OBJ model", BLENDER)),
        None => None,
    };
    kind.map(flaw)
}

/// The refusal of glTF 1.0.
pub(super) fn first_version() -> Flaw {
    flaw((
        "glTF 1.0",
        "turn it into glTF 2.0 with `npx gltf-pipeline -i OLD.glb -o NEW.glb`",
    ))
}

fn flaw((what, way_out): Kind) -> Flaw {
    ToyProblem::Foreign { what, way_out }.at("file")
}

fn without_blanks(bytes: &[u8]) -> &[u8] {
    bytes
        .strip_prefix(b"\xef\xbb\xbf")
        .unwrap_or(bytes)
        .trim_ascii_start()
}

/// USDZ and recordings of Record3D are ZIP files, which begin with the name of a file in them.
fn of_zip(bytes: &[u8]) -> Kind {
    // Source: PKWARE, APPNOTE, section 4.3.7 (local file header): the length of the name, and the name.
    let length = bytes.get(26..28).and_then(<[u8]>::first_chunk);
    let length = length.map_or(0, |length| usize::from(u16::from_le_bytes(*length)));
    let name = bytes.get(30..30 + length).unwrap_or_default();
    let ends = |end: &[u8]| name.to_ascii_lowercase().ends_with(end);
    let holds = |part: &[u8]| bytes.windows(part.len()).any(|window| window == part);
    if ends(b".usdc") || ends(b".usda") || ends(b".usd") {
        ("a USDZ model", BLENDER)
    } else if name == b"metadata" || name.starts_with(b"rgbd/") || holds(b"rgbd/") {
        (
            "a recording of Record3D (.r3d)",
            "it holds no toy; unpack it and make a session of it with `cargo xtask import`",
        )
    } else {
        ("a ZIP file", "unpack it and give the .glb in it")
    }
}

/// Whether the first lines are statements of OBJ.
fn is_obj(text: &[u8]) -> bool {
    const MANY: usize = 64;
    let lines = text
        .split(|byte| *byte == b'\n')
        .map(<[u8]>::trim_ascii)
        .take(MANY);
    let mut lines = lines
        .filter(|line| !line.is_empty() && !line.starts_with(b"#"))
        .peekable();
    let words: [&[u8]; 8] = [b"v ", b"vn ", b"vt ", b"f ", b"o ", b"g ", b"mtllib ", b"usemtl "];
    lines
        .peek()
        .is_some_and(|first| words.iter().any(|word| first.starts_with(word)))
}
