//! Between the thread of the camera, which must not wait, and the one that writes.

use std::io::Write;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, SyncSender, TrySendError, sync_channel};

use super::error::WriteError;
use super::topics::Topic;
use super::writer::{Flushed, Picture, Writer};

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
            Self::Note { message, .. } => message.len(),
            Self::Tick { .. } => 0,
        };
        n_bytes as u64
    }
}

/// What the two ends share.
#[derive(Default)]
struct Counts {
    waiting_bytes: AtomicU64,
    n_dropped: AtomicU64,
}

/// A queue of at most `n_items` items and `max_bytes` bytes.
#[must_use]
pub fn queue(n_items: usize, max_bytes: u64) -> (Inlet, Outlet) {
    let (sender, receiver) = sync_channel(n_items);
    let counts = Arc::new(Counts::default());
    let inlet = Inlet {
        sender,
        counts: Arc::clone(&counts),
        max_bytes,
    };
    let outlet = Outlet {
        receiver,
        counts,
        n_told: 0,
    };
    (inlet, outlet)
}

/// Where items are put in.
#[derive(Clone)]
pub struct Inlet {
    sender: SyncSender<(u64, Item)>,
    counts: Arc<Counts>,
    max_bytes: u64,
}

impl Inlet {
    /// Puts an item in, or hands it back at once where there is no room or nobody writes any more: it counts as dropped.
    /// Never waits.
    ///
    /// # Errors
    /// With the item.
    pub fn offer(&self, time_ns: u64, item: Item) -> Result<(), Item> {
        let n_bytes = item.n_bytes();
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
            self.counts.n_dropped.fetch_add(1, Ordering::AcqRel);
            Err(item)
        })
    }

    /// How many items were refused so far.
    #[must_use]
    pub fn n_dropped(&self) -> u64 {
        self.counts.n_dropped.load(Ordering::Acquire)
    }
}

/// Where items are taken out.
pub struct Outlet {
    receiver: Receiver<(u64, Item)>,
    counts: Arc<Counts>,
    /// Of the items dropped, those that the recording knows of.
    n_told: u64,
}

impl Outlet {
    /// Waits for the next item and writes it; items that were dropped meanwhile are told on [`Topic::Events`]. None once
    /// all inlets are gone and nothing waits.
    pub fn write_next<W: Write>(&mut self, writer: &mut Writer<W>) -> Option<Result<Flushed, WriteError>> {
        let (time_ns, item) = self.receiver.recv().ok()?;
        self.counts
            .waiting_bytes
            .fetch_sub(item.n_bytes(), Ordering::AcqRel);
        let written = self
            .tell_dropped(time_ns, writer)
            .and_then(|()| write(time_ns, item, writer));
        Some(written.map(|()| writer.flushed()))
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

fn write<W: Write>(time_ns: u64, item: Item, writer: &mut Writer<W>) -> Result<(), WriteError> {
    match item {
        Item::Session(session) => writer.set_session(&session),
        Item::File { path, bytes } => writer.file(time_ns, &path, &bytes),
        Item::Frame { picture, entry } => writer.frame(time_ns, Picture::New(&picture), &entry).map(|_| ()),
        Item::Note { topic, message } => writer.note(time_ns, topic, &message),
        Item::Tick { free_bytes } => writer.tick(time_ns, free_bytes),
    }
}
