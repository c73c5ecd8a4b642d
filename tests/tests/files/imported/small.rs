//! Small recordings in a temporary folder, and the data that are given beside them.

use std::fs;

use app_core::scene::Image;
use desk::files::BUNDLED_SESSION;
use desk::import::{Format, Lacking, Source, Written, read, write};
use desk::output::write_png;
use harness::temporary::Temporary;

/// A session from a recording of these files.
pub(crate) struct Small {
    pub(crate) folder: Temporary,
}

impl Small {
    pub(crate) fn new(name: &str) -> Self {
        Self {
            folder: Temporary::new(name),
        }
    }

    pub(crate) fn file(&self, path: &str, bytes: &[u8]) -> &Self {
        let file = self.folder.0.join("recording").join(path);
        fs::create_dir_all(file.parent().unwrap()).unwrap();
        fs::write(file, bytes).unwrap();
        self
    }

    pub(crate) fn picture(&self, path: &str, picture: &Image) -> &Self {
        self.file(path, b"");
        write_png(&self.folder.0.join("recording").join(path), picture).unwrap();
        self
    }

    pub(crate) fn import(&self, format: Format, lacking: &Lacking) -> anyhow::Result<Written> {
        let files = Source::open(&self.folder.0.join("recording")).unwrap();
        let imported = read(format, &files, &files.paths().unwrap(), lacking.object)?;
        write(
            "small",
            &files,
            &imported,
            lacking,
            &self.folder.0.join("session"),
        )
    }
}

/// A grey picture.
pub(crate) fn grey([width_px, height_px]: [u32; 2]) -> Image {
    Image {
        width_px,
        height_px,
        rgba8: vec![128; 4 * width_px as usize * height_px as usize],
    }
}

/// All data that no format contains.
pub(crate) fn lacking() -> Lacking {
    Lacking {
        toy: Some(format!("{BUNDLED_SESSION}/toy.glb").into()),
        world_from_object: Some("1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1".to_owned()),
        receiver: vec![r#"{"name":"","world_from_plane":[1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1],"half_extent":[1,1],"surface":"uniform"}"#.to_owned()],
        light: vec!["none".to_owned()],
        plates: Some("none".to_owned()),
        up: Some("0,1,0".to_owned()),
        metres: Some(1.0),
        fps: Some(30.0),
        ..Lacking::default()
    }
}
