//! The result of a scan: positions of pictures and files, texts of frames and notes.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

use super::error::Loss;
use super::index::IndexSize;
use super::inflate::Compression;
use super::maps::{MAP_TOPICS, Maps, N_MAPS};
use super::message::{FrameMessage, NamedPictures, SessionMessage};
use super::topics::Topic;
use super::viewer::image_file;
use super::wire::{CHANNEL, MESSAGE, Rest};
use crate::MAX_INDEX_BYTES;

/// Limit for the texts of notes, in bytes.
const MAX_NOTE_BYTES: u64 = 64 << 20;

/// A compressed chunk.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Packed {
    pub(super) compression: Compression,
    /// Range of bytes in the file.
    pub(super) at: u64,
    pub(super) n_stored_bytes: u64,
    /// Decompressed size.
    pub(super) n_record_bytes: u64,
}

/// Range of bytes in the file, or in the records of a compressed chunk.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Span {
    pub(super) packed: Option<Packed>,
    pub(super) at: u64,
    pub(super) n_bytes: u64,
}

/// Origin of records: the file, or a compressed chunk.
#[derive(Clone, Copy, Debug)]
pub(super) enum Home {
    At(u64),
    Packed(Packed),
}

impl Home {
    fn span(self, within: Range<usize>) -> Span {
        let n_bytes = within.len() as u64;
        let (packed, records_at) = match self {
            Self::At(at) => (None, at),
            Self::Packed(packed) => (Some(packed), 0),
        };
        Span {
            packed,
            at: records_at + within.start as u64,
            n_bytes,
        }
    }
}

/// A recorded frame.
pub(super) struct FoundFrame {
    /// Its entry in the index, JSON.
    pub(super) entry: String,
    /// Path and number of its picture.
    picture: (String, u32),
    /// Path and number of its maps that the recording has, in order.
    maps: [Option<(String, u32)>; N_MAPS],
}

/// Pictures of one channel.
#[derive(Default)]
struct Pictures {
    /// By their numbers, once all are found.
    spans: BTreeMap<u32, Span>,
    /// Sequence number and position, in the order of the file.
    numbered: Vec<(u32, Span)>,
    /// Number of pictures before the first gap, if there is one.
    n_before_gap: Option<usize>,
}

impl Pictures {
    /// Numbers the pictures by their sequence numbers, or by their order if another program has
    /// rewritten the recording without those. By order, pictures after a gap cannot be numbered and
    /// are skipped. `wanted` are the numbers that frames have.
    fn number(&mut self, wanted: impl Iterator<Item = u32>) {
        let numbered = std::mem::take(&mut self.numbered);
        self.spans = numbered.iter().copied().collect();
        let mut wanted = wanted;
        if self.spans.len() < numbered.len() {
            let n = self.n_before_gap.unwrap_or(numbered.len());
            let spans = numbered.into_iter().map(|(_, span)| span);
            self.spans = (0..).zip(spans.take(n)).collect();
        } else if self.n_before_gap.is_none() && !wanted.all(|number| self.spans.contains_key(&number)) {
            // The first number of a program that does not count from 0.
            let first = self.spans.keys().next().copied().unwrap_or(0);
            let spans = std::mem::take(&mut self.spans).into_iter();
            self.spans = spans.map(|(number, span)| (number - first, span)).collect();
        }
    }
}

/// A message of a channel for arbitrary JSON objects.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Note {
    /// Nanoseconds, from an origin of the recording's own.
    pub time_ns: u64,
    /// Its channel.
    pub topic: Topic,
    /// The message, JSON.
    pub message: String,
}

/// The result of a scan.
#[derive(Default)]
pub(super) struct Found {
    /// The last chunk's session; `None` before the first.
    pub(super) session: Option<SessionMessage>,
    pub(super) frames: Vec<FoundFrame>,
    pictures: Pictures,
    /// Of each map, in order.
    maps: [Pictures; N_MAPS],
    /// Whether a chunk of a session occurs twice.
    pub(super) has_two_sessions: bool,
    pub(super) files: BTreeMap<String, Span>,
    pub(super) notes: Vec<Note>,
    pub(super) losses: Vec<Loss>,
    /// Numbers of the chunks that were found.
    chunks: BTreeSet<u32>,
    channels: BTreeMap<u16, Option<Topic>>,
    /// Size of the index so far, which limits the memory for texts of frames.
    index_size: IndexSize,
    /// Number of bytes of the texts of notes.
    n_note_bytes: u64,
    n_frames_left_out: u32,
    n_notes_left_out: u32,
}

/// A message of a known channel.
struct Message<'a> {
    topic: Topic,
    sequence: u32,
    time_ns: u64,
    data: &'a [u8],
    /// Offset of its data within the chunk's records.
    at: usize,
}

impl Found {
    /// Adds a whole chunk's records, which begin at `home`. `None` if they are no records; then
    /// nothing of the chunk is added.
    pub(super) fn chunk(&mut self, home: Home, records: &[u8]) -> Option<()> {
        let mut messages = Vec::new();
        let mut rest = Rest(records);
        while !rest.0.is_empty() {
            let (opcode, body) = rest.record()?;
            let end = records.len() - rest.0.len();
            match opcode {
                CHANNEL => self.channel(body)?,
                MESSAGE => messages.extend(self.message(body, end)?),
                _ => {}
            }
        }
        // A chunk with an invalid text is not ours, and nothing of it is added.
        let read = messages.iter().map(Read::new).collect::<Option<Vec<_>>>()?;
        for (message, read) in messages.iter().zip(read) {
            self.take(home, message, read);
        }
        Some(())
    }

    /// Adds an attached file, which replaces earlier ones of its path.
    pub(super) fn file(&mut self, path: String, span: Span) {
        self.files.insert(path, span);
    }

    fn channel(&mut self, body: &[u8]) -> Option<()> {
        let mut rest = Rest(body);
        let id = rest.u16()?;
        let _schema = rest.u16()?;
        self.channels.insert(id, Topic::named(rest.text()?));
        Some(())
    }

    /// The message of a record that ends at `end`. The inner `None` is an unknown channel.
    fn message<'a>(&self, body: &'a [u8], end: usize) -> Option<Option<Message<'a>>> {
        let mut rest = Rest(body);
        let channel = rest.u16()?;
        let sequence = rest.u32()?;
        let time_ns = rest.u64()?;
        let _published_ns = rest.u64()?;
        let topic = self.channels.get(&channel).copied().flatten();
        Some(topic.map(|topic| Message {
            topic,
            sequence,
            time_ns,
            data: rest.0,
            at: end - rest.0.len(),
        }))
    }

    fn take(&mut self, home: Home, message: &Message, read: Read) {
        match read {
            Read::Session(session) => {
                let expected = self.chunks.last().map_or(0, |chunk| chunk.saturating_add(1));
                if session.chunk != expected {
                    self.gap();
                }
                self.has_two_sessions |= !self.chunks.insert(session.chunk);
                self.session = Some(*session);
            }
            Read::Image(file) => {
                let file = message.at + file.start..message.at + file.end;
                let of_maps = MAP_TOPICS.into_iter().zip(&mut self.maps);
                let pictures = of_maps
                    .filter(|(topic, _)| *topic == message.topic)
                    .map(|(_, pictures)| pictures)
                    .next()
                    .unwrap_or(&mut self.pictures);
                pictures.numbered.push((message.sequence, home.span(file)));
            }
            Read::Frame(frame) => {
                if self.index_size.add("", &frame.entry) {
                    self.frames.push(frame);
                } else {
                    self.n_frames_left_out += 1;
                }
            }
            Read::Note(text) => {
                self.n_note_bytes += text.len() as u64;
                if self.n_note_bytes > MAX_NOTE_BYTES {
                    self.n_notes_left_out += 1;
                } else {
                    self.notes.push(Note {
                        time_ns: message.time_ns,
                        topic: message.topic,
                        message: text.to_owned(),
                    });
                }
            }
            Read::Other => {}
        }
    }

    /// Whether a channel was announced.
    pub(super) fn has_channel(&self, id: u16) -> bool {
        self.channels.contains_key(&id)
    }

    /// Records that something may be missing here.
    pub(super) fn gap(&mut self) {
        for pictures in std::iter::once(&mut self.pictures).chain(&mut self.maps) {
            pictures.n_before_gap.get_or_insert(pictures.numbered.len());
        }
    }

    /// Numbers pictures and maps.
    pub(super) fn number_pictures(&mut self) {
        let frames = self.frames.iter();
        self.pictures.number(frames.clone().map(|frame| frame.picture.1));
        for (map, pictures) in self.maps.iter_mut().enumerate() {
            pictures.number(
                frames
                    .clone()
                    .filter_map(|frame| Some(frame.maps[map].as_ref()?.1)),
            );
        }
    }

    /// Path and position of the picture and the maps of a frame; `None` if one is lost.
    fn spans_of(&self, frame: &FoundFrame) -> Option<Vec<(String, Span)>> {
        let picture = (&frame.picture, &self.pictures);
        let maps = frame.maps.iter().zip(&self.maps);
        let maps = maps.filter_map(|(map, pictures)| Some((map.as_ref()?, pictures)));
        let all = std::iter::once(picture).chain(maps);
        all.map(|((path, number), pictures)| Some((path.clone(), *pictures.spans.get(number)?)))
            .collect()
    }

    /// Path and position of all pictures and maps.
    pub(super) fn picture_spans(&self) -> impl Iterator<Item = (String, Span)> + '_ {
        let of_frames = self.frames.iter();
        of_frames.filter_map(|frame| self.spans_of(frame)).flatten()
    }

    /// Leaves out frames for which the index has no room beside the session, which only the last
    /// chunk tells.
    fn fit_index(&mut self) {
        let session = self.session.as_ref().map_or("", |session| session.session.get());
        let (n_frames, mut size) = (self.frames.len(), IndexSize::default());
        self.frames.retain(|frame| size.add(session, &frame.entry));
        let n_left_out = u32::try_from(n_frames - self.frames.len()).unwrap_or(u32::MAX);
        self.n_frames_left_out = self.n_frames_left_out.saturating_add(n_left_out);
    }

    /// Adds the losses that only the whole shows: missing chunks and files, missing pictures of
    /// frames, texts beyond the limits.
    pub(super) fn tell_losses(&mut self) {
        let mut expected = 0;
        for chunk in &self.chunks {
            if *chunk > expected {
                self.losses.push(Loss::Chunks {
                    first: expected,
                    n_chunks: chunk - expected,
                });
            }
            expected = chunk.saturating_add(1);
        }
        let n_written = self.session.as_ref().map_or(0, |session| session.n_files);
        let n_files = n_written.saturating_sub(u32::try_from(self.files.len()).unwrap_or(u32::MAX));
        if n_files > 0 {
            self.losses.push(Loss::Files { n_files, n_written });
        }
        let n_frames = self.frames.len();
        let frames = std::mem::take(&mut self.frames).into_iter();
        self.frames = frames.filter(|frame| self.spans_of(frame).is_some()).collect();
        if self.frames.len() < n_frames {
            let n_frames = u32::try_from(n_frames - self.frames.len()).unwrap_or(u32::MAX);
            self.losses.push(Loss::Pictures { n_frames });
        }
        self.fit_index();
        for (n_messages, max_bytes) in [
            (self.n_frames_left_out, MAX_INDEX_BYTES),
            (self.n_notes_left_out, MAX_NOTE_BYTES),
        ] {
            if n_messages > 0 {
                self.losses.push(Loss::TooMany {
                    n_messages,
                    max_bytes,
                });
            }
        }
    }
}

/// The content of a message.
enum Read<'a> {
    Session(Box<SessionMessage>),
    Image(Range<usize>),
    Frame(FoundFrame),
    Note(&'a str),
    /// For viewers only.
    Other,
}

impl<'a> Read<'a> {
    fn new(message: &Message<'a>) -> Option<Self> {
        Some(match message.topic {
            Topic::Session => {
                let session: SessionMessage = serde_json::from_slice(message.data).ok()?;
                if !session.session.get().starts_with('{') {
                    return None;
                }
                Self::Session(Box::new(session))
            }
            Topic::Image | Topic::Depth | Topic::People => Self::Image(image_file(message.data)?),
            Topic::Frame => {
                let frame: FrameMessage = serde_json::from_slice(message.data).ok()?;
                let entry = frame.entry.get().to_owned();
                let named: NamedPictures = serde_json::from_str(&entry).ok()?;
                Self::Frame(FoundFrame {
                    picture: (named.image, frame.picture),
                    maps: Maps {
                        depth: named.depth.zip(frame.depth),
                        people: named.people.zip(frame.people),
                    }
                    .in_order(),
                    entry,
                })
            }
            Topic::Calibration | Topic::Transform => Self::Other,
            _ => Self::Note(std::str::from_utf8(message.data).ok()?),
        })
    }
}
