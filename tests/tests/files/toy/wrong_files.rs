//! Files of other kinds are reported with their kind, and with advice.

use app_core::toy::Toy;

use super::FILE;
use super::builder::triangle;

/// The header of a ZIP file whose first file has this name.
fn zip(name: &str) -> Vec<u8> {
    let mut bytes = b"PK\x03\x04".to_vec();
    bytes.resize(26, 0);
    bytes.extend(u16::try_from(name.len()).unwrap().to_le_bytes());
    bytes.extend([0; 2]);
    bytes.extend(name.as_bytes());
    bytes
}

#[test]
fn the_wrong_file_says_what_it_is_and_what_to_do() {
    let mut first = triangle().bytes();
    first[4] = 1;
    let cases: [(&[u8], &str, &str); 14] = [
        (b"Kaydara FBX Binary  \0", "FBX", "Blender"),
        (b"; FBX 7.3.0 project file\n", "FBX", "Blender"),
        (
            b"# made by hand\nmtllib a.mtl\no box\nv 0 0 0\n",
            "OBJ",
            "Blender",
        ),
        (b"v 0 0 0\nv 1 0 0\n", "OBJ", "Blender"),
        (b"ply\nformat ascii 1.0\n", "PLY", "Blender"),
        (&zip("model.usdc"), "USDZ", "Blender"),
        (&zip("rgbd/0.jpg"), "Record3D", "cargo xtask import"),
        (&zip("metadata"), "Record3D", "cargo xtask import"),
        (&zip("scene.gltf"), "ZIP", "unpack"),
        (&first, "glTF 1.0", "gltf-pipeline"),
        (
            br#"{"asset":{"version":"1.0"},"meshes":{}}"#,
            "glTF 1.0",
            "gltf-pipeline",
        ),
        (br#"{"meshes":{"a":{}},"nodes":{}}"#, "glTF 1.0", "gltf-pipeline"),
        (b"<!DOCTYPE html>", "web page", "download"),
        (
            b"version https://git-lfs.github.com/spec/v1\n",
            "Git LFS",
            "git lfs pull",
        ),
    ];
    for (bytes, what, way_out) in cases {
        let refused = Toy::from_glb(FILE, bytes).unwrap_err().to_string();
        let says = |word: &str| refused.contains(word);
        assert!(says(FILE) && says(what) && says(way_out), "{what}: {refused}");
    }
    // JSON is not OBJ, and an unknown kind is not guessed.
    let refused = Toy::from_glb(FILE, b"\x01\x02\x03\x04 nothing")
        .unwrap_err()
        .to_string();
    assert!(refused.contains("not binary glTF"), "{refused}");
}
