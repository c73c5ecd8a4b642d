//! Writes a recording live: append-only, one chunk per second.

use std::collections::BTreeMap;
use std::io::{ErrorKind, Write};

use serde_json::value::RawValue;

use super::chunk::{MAX_CHUNK_BYTES, OpenChunk};
use super::error::{Stop, WriteError};
use super::index::IndexSize;
use super::json::{json_error, object, session_without_frames};
use super::maps::{MAP_TOPICS, Maps, N_MAPS};
use super::message::{FrameMessage, SessionMessage};
use super::summary::{FileEntry, Written, media_type};
use super::topics::Topic;
use super::viewer::{self, EntryShape, SessionShape};
use super::wire::{ATTACHMENT, Body, HEADER, MAGIC, METADATA, head};
use crate::MAX_INDEX_BYTES;

/// A chunk is closed after this time.
const CHUNK_NS: u64 = 1_000_000_000;
/// A chunk is closed at this size, so that at most this much and a picture waits in memory.
const CHUNK_BYTES: u64 = 4 << 20;
const DEVICE: &str = "device";

/// Limits of a recording.
#[derive(Clone, Copy, Debug)]
pub struct Limits {
    /// Largest size of the file, its summary included, in bytes.
    pub max_bytes: u64,
    /// Free space to keep on the device, which the caller reports by [`Writer::tick`]; bytes.
    pub min_free_bytes: u64,
}

impl Limits {
    /// Limits for an app: they leave room for photos, and keep the file small enough for other
    /// devices.
    pub const APP: Self = Self {
        max_bytes: 4_000_000_000,
        min_free_bytes: 512 << 20,
    };
}

impl Default for Limits {
    /// No limit.
    fn default() -> Self {
        Self {
            max_bytes: u64::MAX,
            min_free_bytes: 0,
        }
    }
}

/// The data that survives the end of the process: it was written to the sink and flushed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Flushed {
    /// Size of the file so far.
    pub n_bytes: u64,
    /// Number of frames in it.
    pub n_frames: u32,
    /// Number of attached files in it.
    pub n_files: u32,
    /// Number of chunks in it.
    pub n_chunks: u32,
}

/// A frame's picture.
#[derive(Clone, Copy, Debug)]
pub enum Picture<'a> {
    /// A file, PNG or JPEG.
    New(&'a [u8]),
    /// The picture of an earlier frame, by its number among all pictures, from 0.
    Again(u32),
}

impl<'a> Picture<'a> {
    /// The file of a new one, and its number, `n` after those before it.
    fn numbered(self, n: u32) -> Result<(Option<&'a [u8]>, u32), WriteError> {
        match self {
            Self::New(bytes) => Ok((Some(bytes), n)),
            Self::Again(sequence) if sequence < n => Ok((None, sequence)),
            Self::Again(sequence) => Err(WriteError::NoSuchPicture { sequence }),
        }
    }
}

/// Writes one recording.
///
/// Flushed data can be read whatever happens to the process. Dropping a writer ends the file
/// without a summary, which readers do not need; unflushed data is lost.
pub struct Writer<W> {
    sink: W,
    session: Box<RawValue>,
    shape: SessionShape,
    device: BTreeMap<String, String>,
    limits: Limits,
    /// Reported free space, and the size of the file at that time; bytes.
    free: Option<(u64, u64)>,
    stop: Option<Stop>,
    chunk: Option<OpenChunk>,
    written: Written,
    index_size: IndexSize,
    n_bytes: u64,
    n_frames: u32,
    n_pictures: u32,
    /// Number of each map so far, in order.
    n_maps: [u32; N_MAPS],
    flushed: Flushed,
}

impl<W: Write> Writer<W> {
    /// Begins a recording in an empty sink.
    ///
    /// `session` is the index of the session, JSON, whose `frames` are ignored here. `device` holds
    /// facts about the device: model, system, version of the app.
    ///
    /// # Errors
    /// When `session` is no JSON object, or the sink refuses.
    pub fn new(
        sink: W,
        session: &str,
        device: BTreeMap<String, String>,
        limits: Limits,
    ) -> Result<Self, WriteError> {
        let (session, shape) = session_without_frames(session)?;
        let mut writer = Self {
            sink,
            session,
            shape,
            device,
            limits,
            free: None,
            stop: None,
            chunk: None,
            written: Written::default(),
            index_size: IndexSize::default(),
            n_bytes: 0,
            n_frames: 0,
            n_pictures: 0,
            n_maps: [0; N_MAPS],
            flushed: Flushed::default(),
        };
        let header = Body::new().text("shadow-capture");
        let header = header
            .text(concat!("app-core ", env!("CARGO_PKG_VERSION")))
            .record(HEADER);
        writer.put(&[&MAGIC[..], &header].concat())?;
        if !writer.device.is_empty() {
            let metadata = Body::new().text(DEVICE).map(&writer.device).record(METADATA);
            let entry = (writer.n_bytes, metadata.len() as u64, DEVICE);
            writer.put(&metadata)?;
            writer.written.metadata.push(entry);
        }
        writer.flush()?;
        Ok(writer)
    }

    /// Sets the session's index, JSON; the last one applies to the whole recording.
    ///
    /// # Errors
    /// When it is no JSON object, or writing has ended.
    pub fn set_session(&mut self, session: &str) -> Result<(), WriteError> {
        self.check()?;
        let (session, shape) = session_without_frames(session)?;
        self.close_chunk()?;
        (self.session, self.shape) = (session, shape);
        Ok(())
    }

    /// Attaches a file that the session's index names, or any other; `path` is relative to the
    /// session. It is flushed.
    ///
    /// # Errors
    /// When writing has ended, or ends with this call.
    pub fn file(&mut self, time_ns: u64, path: &str, bytes: &[u8]) -> Result<(), WriteError> {
        self.check()?;
        self.close_chunk()?;
        let media_type = media_type(path);
        let body = Body::new().u64(time_ns).u64(time_ns);
        let body = body.text(path).text(media_type).u64(bytes.len() as u64);
        let mut checksum = crc32fast::Hasher::new();
        checksum.update(body.as_bytes());
        checksum.update(bytes);
        let n_body_bytes = (body.as_bytes().len() + bytes.len() + size_of::<u32>()) as u64;
        let entry = FileEntry {
            at: self.n_bytes,
            n_bytes: super::wire::HEAD_BYTES + n_body_bytes,
            n_data_bytes: bytes.len() as u64,
            time_ns,
            path: path.to_owned(),
            media_type,
        };
        self.need(entry.n_bytes + path.len() as u64)?;
        self.put(&head(ATTACHMENT, n_body_bytes))?;
        self.put(body.as_bytes())?;
        self.put(bytes)?;
        self.put(&checksum.finalize().to_le_bytes())?;
        self.written.files.push(entry);
        self.flush_sink()
    }

    /// Adds a frame: its picture, and its entry of the session's `frames`, JSON. Returns the
    /// picture's number.
    ///
    /// # Errors
    /// When the entry is no JSON object, the picture is too large or was never recorded, or writing
    /// has ended or ends with this call.
    pub fn frame(&mut self, time_ns: u64, picture: Picture, entry: &str) -> Result<u32, WriteError> {
        let (picture, _) = self.frame_with_maps(time_ns, picture, Maps::default(), entry)?;
        Ok(picture)
    }

    /// Adds a frame with its maps, PNGs, each kind of which is counted apart: the entry names all.
    /// Returns the numbers of the picture and of its maps.
    ///
    /// # Errors
    /// As [`Self::frame`].
    pub fn frame_with_maps(
        &mut self,
        time_ns: u64,
        picture: Picture,
        maps: Maps<Picture>,
        entry: &str,
    ) -> Result<(u32, Maps<u32>), WriteError> {
        self.check()?;
        let raw = object("a frame's entry", entry)?;
        let shape: EntryShape = serde_json::from_str(entry).unwrap_or_default();
        let (bytes, number) = picture.numbered(self.n_pictures)?;
        let mut maps_numbered = [None; N_MAPS];
        for ((numbered, map), n) in maps_numbered.iter_mut().zip(maps.in_order()).zip(self.n_maps) {
            *numbered = map.map(|map| map.numbered(n)).transpose()?;
        }
        let map_numbers = Maps::from_ordered(maps_numbered).map(|(_, number)| number);
        let message = FrameMessage {
            picture: number,
            depth: map_numbers.depth,
            people: map_numbers.people,
            entry: raw,
        };
        let message = serde_json::to_vec(&message).map_err(|error| json_error("a frame's entry", &error))?;
        let calibration = viewer::calibration(time_ns, &self.shape, &shape);
        let transforms = viewer::transforms(time_ns, &self.shape, &shape);
        // Headers and a viewer's messages are far smaller.
        const ROOM: u64 = 4096;
        let of_maps = MAP_TOPICS.into_iter().zip(maps_numbered);
        let pictures: Vec<_> = std::iter::once((Topic::Image, Some((bytes, number))))
            .chain(of_maps)
            .filter_map(|(topic, picture)| Some((topic, picture?.0?, picture?.1)))
            .collect();
        let n_bytes: usize = pictures.iter().map(|(_, bytes, _)| bytes.len()).sum();
        self.make_room(time_ns, (n_bytes + message.len()) as u64 + ROOM)?;
        if !self.index_size.add(self.session.get(), entry) {
            self.end(Stop::Index {
                max_bytes: MAX_INDEX_BYTES,
            })?;
        }
        let n_frames = self.n_frames;
        let chunk = self.open_chunk(time_ns)?;
        for (topic, bytes, number) in pictures {
            let image = viewer::compressed_image(time_ns, bytes);
            chunk.message(topic, number, time_ns, &image);
        }
        if let Some(calibration) = calibration {
            chunk.message(Topic::Calibration, n_frames, time_ns, &calibration);
        }
        for transform in transforms {
            chunk.message(Topic::Transform, n_frames, time_ns, &transform);
        }
        chunk.message(Topic::Frame, n_frames, time_ns, &message);
        self.n_frames += 1;
        self.n_pictures = self.n_pictures.max(number + 1);
        for (n, number) in self.n_maps.iter_mut().zip(map_numbers.in_order()) {
            *n = number.map_or(*n, |number| number.saturating_add(1).max(*n));
        }
        self.close_if_due(time_ns)?;
        Ok((number, map_numbers))
    }

    /// Adds a message to one of the channels for arbitrary JSON objects ([`Topic::NOTES`]).
    ///
    /// # Errors
    /// When it is no object, the channel is another, or writing has ended or ends with this call.
    pub fn note(&mut self, time_ns: u64, topic: Topic, message: &str) -> Result<(), WriteError> {
        const WHAT: &str = "a message";
        self.check()?;
        object(WHAT, message)?;
        if !Topic::NOTES.contains(&topic) {
            let reason = format!("{} takes no notes", topic.name());
            return Err(WriteError::Json { what: WHAT, reason });
        }
        self.make_room(time_ns, message.len() as u64 + super::wire::HEAD_BYTES)?;
        let chunk = self.open_chunk(time_ns)?;
        chunk.message(topic, 0, time_ns, message.as_bytes());
        self.close_if_due(time_ns)
    }

    /// Reports the time if no item arrives, and the free space on the device, if known; bytes.
    ///
    /// # Errors
    /// When writing has ended, or ends with this call.
    pub fn tick(&mut self, time_ns: u64, free_bytes: Option<u64>) -> Result<(), WriteError> {
        self.check()?;
        self.free = free_bytes.map(|free| (free, self.n_bytes)).or(self.free);
        self.need(0)?;
        self.close_if_due(time_ns)
    }

    /// Closes the chunk, so that all added items survive the end of the process.
    ///
    /// # Errors
    /// When writing has ended, or ends with this call.
    pub fn flush(&mut self) -> Result<Flushed, WriteError> {
        self.check()?;
        self.close_chunk()?;
        self.flush_sink()?;
        Ok(self.flushed)
    }

    /// The data that survives the end of the process so far.
    #[must_use]
    pub fn flushed(&self) -> Flushed {
        self.flushed
    }

    /// The reason why writing has ended, if it has.
    #[must_use]
    pub fn stopped(&self) -> Option<&Stop> {
        self.stop.as_ref()
    }

    /// Ends the recording with its summary, for which room is always reserved, and returns the
    /// sink.
    ///
    /// # Errors
    /// When the sink refuses, or has refused before.
    pub fn finish(mut self) -> Result<(W, Flushed), WriteError> {
        if let Some(Stop::Sink(_) | Stop::Full) = &self.stop {
            self.check()?;
        }
        self.stop = None;
        self.close_chunk()?;
        let end = self.written.end(self.n_bytes);
        self.put(&end)?;
        self.flush_sink()?;
        Ok((self.sink, self.flushed))
    }

    fn check(&self) -> Result<(), WriteError> {
        self.stop.clone().map_or(Ok(()), |stop| Err(stop.into()))
    }

    /// Ends writing if `n_bytes` more, all waiting data and the summary exceed the limits.
    fn need(&mut self, n_bytes: u64) -> Result<(), WriteError> {
        let waiting = self.chunk.as_ref().map_or(0, OpenChunk::n_bytes);
        let to_come = [n_bytes, waiting, self.session.get().len() as u64];
        let to_come = to_come
            .into_iter()
            .fold(self.written.max_end_bytes(), u64::saturating_add);
        let Limits {
            max_bytes,
            min_free_bytes,
        } = self.limits;
        let is_short = self.free.is_some_and(|(free, n_then)| {
            let left = free.saturating_sub(self.n_bytes - n_then);
            left < min_free_bytes.saturating_add(to_come)
        });
        let stop = if self.n_bytes.saturating_add(to_come) > max_bytes {
            Stop::Size { max_bytes }
        } else if is_short {
            Stop::Space { min_free_bytes }
        } else {
            return Ok(());
        };
        self.end(stop)
    }

    /// Ends writing; everything so far is flushed.
    fn end(&mut self, stop: Stop) -> Result<(), WriteError> {
        self.close_chunk()?;
        self.flush_sink()?;
        self.stop = Some(stop);
        self.check()
    }

    /// Makes room in the file and in the chunk.
    fn make_room(&mut self, time_ns: u64, n_bytes: u64) -> Result<(), WriteError> {
        let max_bytes = MAX_CHUNK_BYTES / 2;
        if n_bytes > max_bytes {
            let what = "a picture or message";
            return Err(WriteError::TooLarge {
                what,
                n_bytes,
                max_bytes,
            });
        }
        self.need(n_bytes)?;
        self.close_if_due(time_ns)
    }

    fn open_chunk(&mut self, time_ns: u64) -> Result<&mut OpenChunk, WriteError> {
        let chunk = match self.chunk.take() {
            Some(chunk) => chunk,
            None => {
                let place = count(self.written.chunks.len());
                let message = SessionMessage {
                    chunk: place,
                    n_files: count(self.written.files.len()),
                    device: self.device.clone(),
                    session: self.session.clone(),
                };
                let message =
                    serde_json::to_vec(&message).map_err(|error| json_error("the session", &error))?;
                let mut chunk = OpenChunk::new(time_ns);
                chunk.message(Topic::Session, place, time_ns, &message);
                chunk
            }
        };
        Ok(self.chunk.insert(chunk))
    }

    fn close_if_due(&mut self, time_ns: u64) -> Result<(), WriteError> {
        // A clock that goes back is no reason to wait.
        let is_due = self.chunk.as_ref().is_some_and(|chunk| {
            chunk.n_bytes() >= CHUNK_BYTES || chunk.begun_ns.abs_diff(time_ns) >= CHUNK_NS
        });
        if is_due {
            self.close_chunk()?;
            self.flush_sink()?;
        }
        Ok(())
    }

    fn close_chunk(&mut self) -> Result<(), WriteError> {
        if let Some(chunk) = self.chunk.take() {
            let closed = chunk.close(self.n_bytes);
            self.put(&closed.bytes)?;
            self.written.chunks.push(closed.entry);
        }
        Ok(())
    }

    fn put(&mut self, bytes: &[u8]) -> Result<(), WriteError> {
        let written = self.sink.write_all(bytes);
        self.refused(written)?;
        self.n_bytes += bytes.len() as u64;
        Ok(())
    }

    fn flush_sink(&mut self) -> Result<(), WriteError> {
        let flushed = self.sink.flush();
        self.refused(flushed)?;
        self.flushed = Flushed {
            n_bytes: self.n_bytes,
            n_frames: self.n_frames,
            n_files: count(self.written.files.len()),
            n_chunks: count(self.written.chunks.len()),
        };
        Ok(())
    }

    fn refused(&mut self, result: std::io::Result<()>) -> Result<(), WriteError> {
        result.or_else(|error| {
            self.stop = Some(match error.kind() {
                ErrorKind::StorageFull | ErrorKind::QuotaExceeded => Stop::Full,
                _ => Stop::Sink(error.to_string()),
            });
            self.check()
        })
    }
}

fn count(n: usize) -> u32 {
    u32::try_from(n).unwrap_or(u32::MAX)
}
