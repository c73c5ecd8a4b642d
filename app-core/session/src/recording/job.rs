//! Records a live session: its initial data, and a queue of further items.

use std::collections::BTreeMap;
use std::io::Write;
use std::sync::Arc;

use serde_json::json;

use super::codec::{PictureCodec, png};
use super::error::{Stop, WriteError};
use super::queue::{RecordingReceiver, RecordingSender, queue};
use super::writer::{Limits, Writer};
use crate::ScenePaths;
use crate::record::{CaptureRecord, Index};
use app_scene::scene::{Intrinsics, Scene};

/// Limit for waiting items: a second of frames with their notes.
const N_ITEMS: usize = 256;
/// Limit for waiting bytes: ten of a phone's pictures.
const MAX_BYTES: u64 = 48 << 20;
/// Path of the toy.
const TOY: &str = "toy.glb";
/// Path of the mesh of the place.
const PLACE_MESH: &str = "place.glb";

/// A recording to write, on a thread of the caller, which has the file.
#[derive(Debug)]
pub struct RecordingJob {
    number: u64,
    scene: Scene,
    intrinsics: Intrinsics,
    receiver: RecordingReceiver,
}

/// The caller's data for a recording.
#[derive(Debug)]
pub struct RecordingOptions<'a> {
    /// The toy's file.
    pub toy: &'a [u8],
    /// Encoding of pictures; plates are always lossless.
    pub codec: PictureCodec,
    /// Facts about the device: model, system, version of the app.
    pub device: BTreeMap<String, String>,
    /// Limits of the recording.
    pub limits: Limits,
}

/// The reason why a recording ended.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Ending {
    /// The caller ended it.
    Asked,
    /// The device has no more space.
    NoRoom,
    /// It has reached its size limit.
    TooLarge,
    /// Writing there is not permitted.
    NotAllowed,
    /// Writing failed, for this reason.
    Failed(String),
    /// The thread panicked; the file has all frames that were flushed, whose number is unknown.
    Died,
}

/// The outcome of a recording.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RecordingOutcome {
    /// Number of the recording.
    pub number: u64,
    /// Number of recorded frames.
    pub n_frames: u32,
    /// Number of frames that are missing, since writing was too slow or their pictures could not be
    /// encoded.
    pub n_dropped: u64,
    /// The reason why it ended.
    pub ending: Ending,
}

impl RecordingOutcome {
    /// The outcome if the recording thread panicked.
    #[must_use]
    pub fn died(number: u64) -> Self {
        Self {
            number,
            n_frames: 0,
            n_dropped: 0,
            ending: Ending::Died,
        }
    }
}

impl RecordingJob {
    /// The recording with that number, of a scene whose cameras mostly have these `intrinsics`, and
    /// the sender of its frames: it ends when all senders are dropped.
    #[must_use]
    pub fn new(number: u64, scene: Scene, intrinsics: Intrinsics) -> (RecordingSender, Self) {
        let (sender, receiver) = queue(N_ITEMS, MAX_BYTES);
        let job = Self {
            number,
            scene,
            intrinsics,
            receiver,
        };
        (sender, job)
    }

    /// Writes it into an empty sink until it ends: the toy, the plates, then further items; this
    /// takes seconds or minutes.
    pub fn run<W: Write>(mut self, sink: W, options: RecordingOptions<'_>) -> RecordingOutcome {
        self.receiver
            .take_live_frames(options.codec, Arc::clone(&self.scene.toy));
        let paths: Vec<_> = (0..self.scene.plates.len())
            .map(|place| format!("plates/{place:03}.png"))
            .collect();
        let index = Index::from(CaptureRecord::new(
            &self.scene,
            &self.intrinsics,
            ScenePaths {
                toy: TOY,
                plates: &paths,
                // The probe's pictures are not kept: a replay estimates the lights from the toy's
                // shadow alone.
                probe: &[],
                place_mesh: Some(PLACE_MESH),
            },
        ));
        let index = json!(index).to_string();
        let begun = Writer::new(sink, &index, options.device, options.limits).and_then(|mut writer| {
            writer.file(0, TOY, options.toy)?;
            if let Some(mesh) = &self.scene.place_mesh {
                writer.file(0, PLACE_MESH, &mesh.to_glb())?;
            }
            for (plate, path) in self.scene.plates.iter().zip(&paths) {
                writer.file(0, path, &png(&plate.image)?)?;
            }
            Ok(writer)
        });
        let mut writer = match begun {
            Ok(writer) => writer,
            Err(error) => return self.ended(0, ending_of(error)),
        };
        let mut stop = None;
        while let Some(written) = self.receiver.write_next(&mut writer) {
            // Items that cannot be encoded are skipped; a stopped writer stays stopped.
            if let Err(WriteError::Stopped(reason)) = written {
                stop = Some(reason);
                break;
            }
        }
        self.receiver.drop_rest();
        let flushed = writer.flushed();
        match (writer.finish(), stop) {
            (Ok((_, flushed)), stop) => {
                let ending = stop.map_or(Ending::Asked, |stop| ending_of(stop.into()));
                self.ended(flushed.n_frames, ending)
            }
            (Err(error), _) => self.ended(flushed.n_frames, ending_of(error)),
        }
    }

    /// The outcome if the file could not be created.
    #[must_use]
    pub fn without_file(self, error: &std::io::Error) -> RecordingOutcome {
        use std::io::ErrorKind;
        let ending = match error.kind() {
            ErrorKind::StorageFull | ErrorKind::QuotaExceeded => Ending::NoRoom,
            ErrorKind::PermissionDenied | ErrorKind::ReadOnlyFilesystem => Ending::NotAllowed,
            _ => Ending::Failed(error.to_string()),
        };
        self.ended(0, ending)
    }

    /// Number of the recording.
    #[must_use]
    pub fn number(&self) -> u64 {
        self.number
    }

    fn ended(&self, n_frames: u32, ending: Ending) -> RecordingOutcome {
        RecordingOutcome {
            number: self.number,
            n_frames,
            n_dropped: self.receiver.n_dropped_frames(),
            ending,
        }
    }
}

fn ending_of(error: WriteError) -> Ending {
    match error {
        WriteError::Stopped(Stop::Size { .. } | Stop::Index { .. }) => Ending::TooLarge,
        WriteError::Stopped(Stop::Space { .. } | Stop::Full) => Ending::NoRoom,
        error => Ending::Failed(error.to_string()),
    }
}
