//! Between the thread of the camera, which must not wait, and the one that writes.

use std::io::Write;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, SyncSender, TrySendError, sync_channel};

use serde_json::json;

use super::codec::PictureCodec;
use super::entry::LiveFrame;
use super::error::WriteError;
use super::topics::Topic;
use super::writer::{Flushed, Picture, Writer};
use crate::tags::JPEG_MAGIC;
use app_scene::camera_frame::CameraImage;
use app_scene::toy::Toy;

/// Something to be recorded.
#[derive(Clone, Debug)]
pub enum Item {
    /// [`Writer::set_session`].
    Session(String),
    /// [`Writer::file`].
    File {
        /// Relative to the session.
        path: String,
        /// The whole file.
        bytes: Vec<u8>,
    },
    /// [`Writer::frame`] with a picture of its own.
    Frame {
        /// The file, PNG or JPEG.
        picture: Vec<u8>,
        /// Its entry of the session's frames, JSON.
        entry: String,
    },
    /// [`Writer::frame`], whose picture is encoded only when it is written.
    Live(Box<LiveFrame>),
    /// [`Writer::note`].
    Note {
        /// The channel.
        topic: Topic,
        /// JSON.
        message: String,
    },
    /// [`Writer::tick`].
    Tick {
        /// What is free on the device, bytes.
        free_bytes: Option<u64>,
    },
}

impl Item {
    fn n_bytes(&self) -> u64 {
        let n_bytes = match self {
            Self::Session(text) => text.len(),
            Self::File { path, bytes } => path.len() + bytes.len(),
            Self::Frame { picture, entry } => picture.len() + entry.len(),
            Self::Live(live) => live.image.n_bytes(),
            Self::Note { message, .. } => message.len(),
            Self::Tick { .. } => 0,
        };
        n_bytes as u64
    }

    fn is_frame(&self) -> bool {
        matches!(self, Self::Frame { .. } | Self::Live(_))
    }
}

/// What the two ends share.
#[derive(Debug, Default)]
struct Counts {
    waiting_bytes: AtomicU64,
    n_dropped: AtomicU64,
    /// Of those, frames.
    n_dropped_frames: AtomicU64,
}

impl Counts {
    fn drop_one(&self, is_frame: bool) {
        self.n_dropped.fetch_add(1, Ordering::AcqRel);
        self.n_dropped_frames
            .fetch_add(u64::from(is_frame), Ordering::AcqRel);
    }
}

/// A queue of at most `n_items` items and `max_bytes` bytes.
#[must_use]
pub fn queue(n_items: usize, max_bytes: u64) -> (RecordingSender, RecordingReceiver) {
    let (sender, receiver) = sync_channel(n_items);
    let counts = Arc::new(Counts::default());
    let sender = RecordingSender {
        sender,
        counts: Arc::clone(&counts),
        max_bytes,
    };
    let receiver = RecordingReceiver {
        receiver,
        counts,
        n_told: 0,
        encoder: None,
    };
    (sender, receiver)
}

/// Where items are put in.
#[derive(Clone, Debug)]
pub struct RecordingSender {
    sender: SyncSender<(u64, Item)>,
    counts: Arc<Counts>,
    max_bytes: u64,
}

impl RecordingSender {
    /// Puts an item in, or hands it back at once where there is no room or nobody writes any more: it counts as dropped.
    /// Never waits.
    ///
    /// # Errors
    /// With the item.
    pub fn offer(&self, time_ns: u64, item: Item) -> Result<(), Item> {
        let (n_bytes, is_frame) = (item.n_bytes(), item.is_frame());
        let waiting = &self.counts.waiting_bytes;
        let before = waiting.fetch_add(n_bytes, Ordering::AcqRel);
        let refused = if before.saturating_add(n_bytes) > self.max_bytes {
            Some(item)
        } else {
            match self.sender.try_send((time_ns, item)) {
                Ok(()) => None,
                Err(TrySendError::Full((_, item)) | TrySendError::Disconnected((_, item))) => Some(item),
            }
        };
        refused.map_or(Ok(()), |item| {
            waiting.fetch_sub(n_bytes, Ordering::AcqRel);
            self.counts.drop_one(is_frame);
            Err(item)
        })
    }

    /// How many items were refused so far.
    #[must_use]
    pub fn n_dropped(&self) -> u64 {
        self.counts.n_dropped.load(Ordering::Acquire)
    }

    /// How many of them were frames.
    #[must_use]
    pub fn n_dropped_frames(&self) -> u64 {
        self.counts.n_dropped_frames.load(Ordering::Acquire)
    }
}

/// How live frames become those of a recording.
#[derive(Debug)]
struct LiveEncoder {
    codec: PictureCodec,
    /// Whose clips they name.
    toy: Arc<Toy>,
    /// The latest picture with its number and its path.
    latest: Option<(CameraImage, u32, String)>,
}

/// Where items are taken out.
#[derive(Debug)]
pub struct RecordingReceiver {
    receiver: Receiver<(u64, Item)>,
    counts: Arc<Counts>,
    /// Of the items dropped, those that the recording knows of.
    n_told: u64,
    /// None where no live frames are taken.
    encoder: Option<LiveEncoder>,
}

impl RecordingReceiver {
    /// Takes live frames, too, which show clips of `toy`.
    pub(super) fn take_live_frames(&mut self, codec: PictureCodec, toy: Arc<Toy>) {
        self.encoder = Some(LiveEncoder {
            codec,
            toy,
            latest: None,
        });
    }

    /// What waits when writing has ended counts as dropped.
    pub(super) fn drop_rest(&mut self) {
        while let Ok((_, item)) = self.receiver.try_recv() {
            self.counts.drop_one(item.is_frame());
        }
    }

    /// How many frames were refused so far, or could not be written.
    pub(super) fn n_dropped_frames(&self) -> u64 {
        self.counts.n_dropped_frames.load(Ordering::Acquire)
    }

    /// Waits for the next item and writes it; items that were dropped meanwhile are told on [`Topic::Events`]. None once
    /// all senders are gone and nothing waits.
    pub fn write_next<W: Write>(&mut self, writer: &mut Writer<W>) -> Option<Result<Flushed, WriteError>> {
        let (time_ns, item) = self.receiver.recv().ok()?;
        self.counts
            .waiting_bytes
            .fetch_sub(item.n_bytes(), Ordering::AcqRel);
        let written = self
            .tell_dropped(time_ns, writer)
            .and_then(|()| self.write(time_ns, item, writer));
        Some(written.map(|()| writer.flushed()))
    }

    fn write<W: Write>(
        &mut self,
        time_ns: u64,
        item: Item,
        writer: &mut Writer<W>,
    ) -> Result<(), WriteError> {
        match item {
            Item::Session(session) => writer.set_session(&session),
            Item::File { path, bytes } => writer.file(time_ns, &path, &bytes),
            Item::Frame { picture, entry } => {
                writer.frame(time_ns, Picture::New(&picture), &entry).map(|_| ())
            }
            Item::Live(live) => self
                .write_live(time_ns, &live, writer)
                .inspect_err(|_| self.counts.drop_one(true)),
            Item::Note { topic, message } => writer.note(time_ns, topic, &message),
            Item::Tick { free_bytes } => writer.tick(time_ns, free_bytes),
        }
    }

    /// A picture that is that of the frame before is written once.
    fn write_live<W: Write>(
        &mut self,
        time_ns: u64,
        live: &LiveFrame,
        writer: &mut Writer<W>,
    ) -> Result<(), WriteError> {
        let encoder = self.encoder.as_mut();
        let encoder = encoder.ok_or_else(|| WriteError::Picture("nobody encodes it".to_owned()))?;
        let time_secs = 1e-9 * time_ns as f64;
        let before = encoder.latest.as_ref();
        if let Some((_, number, path)) = before.filter(|(image, ..)| image.is(&live.image)) {
            let entry = json!(live.entry(time_secs, path, &encoder.toy)).to_string();
            return writer.frame(time_ns, Picture::Again(*number), &entry).map(|_| ());
        }
        let file = encoder.codec.encode(&live.image)?;
        let number = before.map_or(0, |(_, number, _)| number + 1);
        let ending = if file.starts_with(JPEG_MAGIC) {
            "jpg"
        } else {
            "png"
        };
        let path = format!("frames/{number:06}.{ending}");
        let entry = json!(live.entry(time_secs, &path, &encoder.toy)).to_string();
        let number = writer.frame(time_ns, Picture::New(&file), &entry)?;
        encoder.latest = Some((live.image.clone(), number, path));
        Ok(())
    }

    fn tell_dropped<W: Write>(&mut self, time_ns: u64, writer: &mut Writer<W>) -> Result<(), WriteError> {
        let n_dropped = self.counts.n_dropped.load(Ordering::Acquire);
        if n_dropped > self.n_told {
            let message = format!(r#"{{"event":"dropped","n_items":{}}}"#, n_dropped - self.n_told);
            writer.note(time_ns, Topic::Events, &message)?;
            self.n_told = n_dropped;
        }
        Ok(())
    }
}
