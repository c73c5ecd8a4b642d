//! The queue between the camera's thread, which must not wait, and the writing thread.

use std::io::Write;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, SyncSender, TrySendError, sync_channel};

use serde_json::json;

use super::codec::{PictureCodec, depth_png, people_png};
use super::entry::{LiveFrame, LivePaths};
use super::error::WriteError;
use super::maps::{Maps, N_MAPS};
use super::topics::Topic;
use super::writer::{Flushed, Picture, Writer};
use crate::tags::JPEG_MAGIC;
use app_scene::camera_frame::CameraImage;
use app_scene::toy::Toy;

/// An item to record.
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
    /// [`Writer::frame`] with a picture that is encoded just before writing.
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
        /// Free space on the device, bytes.
        free_bytes: Option<u64>,
    },
}

impl Item {
    fn n_bytes(&self) -> u64 {
        let n_bytes = match self {
            Self::Session(text) => text.len(),
            Self::File { path, bytes } => path.len() + bytes.len(),
            Self::Frame { picture, entry } => picture.len() + entry.len(),
            Self::Live(live) => return live.n_bytes(),
            Self::Note { message, .. } => message.len(),
            Self::Tick { .. } => 0,
        };
        n_bytes as u64
    }

    fn is_frame(&self) -> bool {
        matches!(self, Self::Frame { .. } | Self::Live(_))
    }
}

/// Counters that both ends share.
#[derive(Debug, Default)]
struct Counts {
    waiting_bytes: AtomicU64,
    n_dropped: AtomicU64,
    /// Number of frames among them.
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
        n_reported: 0,
        encoder: None,
    };
    (sender, receiver)
}

/// The input end of the queue.
#[derive(Clone, Debug)]
pub struct RecordingSender {
    sender: SyncSender<(u64, Item)>,
    counts: Arc<Counts>,
    max_bytes: u64,
}

impl RecordingSender {
    /// Adds an item, or returns it at once if there is no room or no writer: it counts as dropped.
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

    /// Number of refused items so far.
    #[must_use]
    pub fn n_dropped(&self) -> u64 {
        self.counts.n_dropped.load(Ordering::Acquire)
    }

    /// Number of frames among them.
    #[must_use]
    pub fn n_dropped_frames(&self) -> u64 {
        self.counts.n_dropped_frames.load(Ordering::Acquire)
    }
}

/// Encodes live frames for a recording.
#[derive(Debug)]
struct LiveEncoder {
    codec: PictureCodec,
    /// The toy of their clips.
    toy: Arc<Toy>,
    /// The latest picture with the numbers and paths of itself and of its maps.
    latest: Option<LatestPicture>,
    /// Number of each map so far, in order.
    n_maps: [u32; N_MAPS],
}

/// A picture that was written.
#[derive(Debug)]
struct LatestPicture {
    image: CameraImage,
    number: u32,
    map_numbers: Maps<u32>,
    paths: LivePaths,
}

/// The output end of the queue.
#[derive(Debug)]
pub struct RecordingReceiver {
    receiver: Receiver<(u64, Item)>,
    counts: Arc<Counts>,
    /// Number of dropped items that are recorded as such.
    n_reported: u64,
    /// `None` if live frames are not accepted.
    encoder: Option<LiveEncoder>,
}

impl RecordingReceiver {
    /// Accepts live frames, too, which show clips of `toy`.
    pub(super) fn take_live_frames(&mut self, codec: PictureCodec, toy: Arc<Toy>) {
        self.encoder = Some(LiveEncoder {
            codec,
            toy,
            latest: None,
            n_maps: [0; N_MAPS],
        });
    }

    /// Counts the items that wait when writing ends as dropped.
    pub(super) fn drop_rest(&mut self) {
        while let Ok((_, item)) = self.receiver.try_recv() {
            self.counts.drop_one(item.is_frame());
        }
    }

    /// Number of frames that were refused, or could not be written.
    pub(super) fn n_dropped_frames(&self) -> u64 {
        self.counts.n_dropped_frames.load(Ordering::Acquire)
    }

    /// Waits for the next item and writes it; items dropped meanwhile are reported on
    /// [`Topic::Events`]. `None` once all senders are dropped and the queue is empty.
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

    /// Writes a live frame; a picture equal to that of the frame before is written once.
    fn write_live<W: Write>(
        &mut self,
        time_ns: u64,
        live: &LiveFrame,
        writer: &mut Writer<W>,
    ) -> Result<(), WriteError> {
        let encoder = self.encoder.as_mut();
        let encoder =
            encoder.ok_or_else(|| WriteError::Picture("live frames are not accepted".to_owned()))?;
        let time_secs = 1e-9 * time_ns as f64;
        let before = encoder.latest.as_ref();
        if let Some(same) = before.filter(|before| before.image.is(&live.image)) {
            let entry = json!(live.entry(time_secs, &same.paths, &encoder.toy)).to_string();
            let maps = same.map_numbers.map(Picture::Again);
            let written = writer.frame_with_maps(time_ns, Picture::Again(same.number), maps, &entry);
            return written.map(|_| ());
        }
        let file = encoder.codec.encode(&live.image)?;
        let map_files = Maps {
            depth: live.depth.as_ref().map(depth_png).transpose()?,
            people: live.people.as_ref().map(people_png).transpose()?,
        };
        let number = before.map_or(0, |before| before.number + 1);
        let ending = if file.starts_with(JPEG_MAGIC) {
            "jpg"
        } else {
            "png"
        };
        let [n_depths, n_people] = encoder.n_maps;
        let paths = LivePaths {
            picture: format!("frames/{number:06}.{ending}"),
            maps: Maps {
                depth: map_files
                    .depth
                    .is_some()
                    .then(|| format!("depths/{n_depths:06}.png")),
                people: map_files
                    .people
                    .is_some()
                    .then(|| format!("people/{n_people:06}.png")),
            },
        };
        let entry = json!(live.entry(time_secs, &paths, &encoder.toy)).to_string();
        let maps = map_files.as_ref().map(|file| Picture::New(file));
        let (number, map_numbers) = writer.frame_with_maps(time_ns, Picture::New(&file), maps, &entry)?;
        for (n, written) in encoder.n_maps.iter_mut().zip(map_numbers.in_order()) {
            *n += u32::from(written.is_some());
        }
        encoder.latest = Some(LatestPicture {
            image: live.image.clone(),
            number,
            map_numbers,
            paths,
        });
        Ok(())
    }

    fn tell_dropped<W: Write>(&mut self, time_ns: u64, writer: &mut Writer<W>) -> Result<(), WriteError> {
        let n_dropped = self.counts.n_dropped.load(Ordering::Acquire);
        if n_dropped > self.n_reported {
            let message = format!(
                r#"{{"event":"dropped","n_items":{}}}"#,
                n_dropped - self.n_reported
            );
            writer.note(time_ns, Topic::Events, &message)?;
            self.n_reported = n_dropped;
        }
        Ok(())
    }
}
