//! A recording as the files of a session.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::{Mutex, PoisonError};

use super::error::{Loss, RecordingError};
use super::found::{Note, Packed, Span};
use super::index::assembled;
use super::inflate::inflate;
use super::scan::scan;
use super::source::Source;
use crate::{FileError, Files, INDEX_FILE, check_path};

/// A readable recording: its files are those of a session's folder, with `capture.json` assembled
/// from its messages.
///
/// Opening reads all of it once. It needs memory for the texts and for one chunk, whatever the
/// recording's size.
pub struct Recording {
    source: Box<dyn Source>,
    index: Vec<u8>,
    /// Pictures and maps of frames come before attached files.
    spans: BTreeMap<String, Span>,
    n_frames: usize,
    device: BTreeMap<String, String>,
    notes: Vec<Note>,
    losses: Vec<Loss>,
    /// Position and records of the compressed chunk that was read last: its pictures are read one
    /// after another.
    unpacked: Mutex<Option<(u64, Vec<u8>)>>,
}

impl Recording {
    /// Opens the recording of `source`, as far as it is intact.
    ///
    /// # Errors
    /// When it cannot be read, is no MCAP file, or no intact chunk of it has a session.
    pub fn open(source: impl Source + 'static) -> Result<Self, RecordingError> {
        let mut found = scan(&source)?;
        if found.has_two_sessions {
            return Err(RecordingError::TwoSessions);
        }
        found.number_pictures();
        found.tell_losses();
        let Some(session) = found.session.take() else {
            return Err(RecordingError::NoSession { losses: found.losses });
        };
        let entries = found.frames.iter().map(|frame| frame.entry.as_str());
        let Some(index) = assembled(&session.session, entries) else {
            return Err(RecordingError::NoSession { losses: found.losses });
        };
        let pictures: Vec<(String, Span)> = found.picture_spans().collect();
        let mut spans = found.files;
        spans.extend(pictures);
        spans.remove(INDEX_FILE);
        Ok(Self {
            source: Box::new(source),
            index,
            spans,
            n_frames: found.frames.len(),
            device: session.device,
            notes: found.notes,
            losses: found.losses,
            unpacked: Mutex::new(None),
        })
    }

    /// Bytes of a compressed chunk.
    fn unpacked(&self, packed: &Packed, span: &Span) -> Result<Vec<u8>, FileError> {
        let failed = |reason: String| FileError::Io(reason);
        let mut last = self.unpacked.lock().unwrap_or_else(PoisonError::into_inner);
        let records = match last.take() {
            Some((at, records)) if at == packed.at => records,
            _ => {
                let mut stored = vec![0; usize::try_from(packed.n_stored_bytes).unwrap_or(0)];
                self.source
                    .read_at(packed.at, &mut stored)
                    .map_err(|error| failed(error.to_string()))?;
                inflate(packed.compression, &stored, packed.n_record_bytes)
                    .map_err(|damage| failed(damage.to_string()))?
            }
        };
        let end = span.at.saturating_add(span.n_bytes);
        let range =
            usize::try_from(span.at).unwrap_or(usize::MAX)..usize::try_from(end).unwrap_or(usize::MAX);
        let bytes = records.get(range).map(<[u8]>::to_vec);
        *last = Some((packed.at, records));
        bytes.ok_or_else(|| failed("the recording was changed while it was read".to_owned()))
    }

    /// Paths of all files, relative to the session; without those that a session does not permit.
    #[must_use]
    pub fn paths(&self) -> BTreeSet<&str> {
        let named = self.spans.keys().map(String::as_str).chain([INDEX_FILE]);
        named.filter(|path| check_path(path).is_ok()).collect()
    }

    /// Number of frames with intact entry and picture.
    #[must_use]
    pub fn n_frames(&self) -> usize {
        self.n_frames
    }

    /// Facts about the recording device.
    #[must_use]
    pub fn device(&self) -> &BTreeMap<String, String> {
        &self.device
    }

    /// Messages of the platform's channels, as they were recorded.
    #[must_use]
    pub fn notes(&self) -> &[Note] {
        &self.notes
    }

    /// Lost parts; empty for a finished and intact recording.
    #[must_use]
    pub fn losses(&self) -> &[Loss] {
        &self.losses
    }
}

impl Files for Recording {
    fn read(&self, path: &str, max_bytes: u64) -> Result<Vec<u8>, FileError> {
        check_path(path)?;
        if path == INDEX_FILE {
            let is_allowed = self.index.len() as u64 <= max_bytes;
            return if is_allowed {
                Ok(self.index.clone())
            } else {
                Err(FileError::TooLarge { max_bytes })
            };
        }
        let span = self.spans.get(path).ok_or(FileError::Missing)?;
        if span.n_bytes > max_bytes {
            return Err(FileError::TooLarge { max_bytes });
        }
        if let Some(packed) = &span.packed {
            return self.unpacked(packed, span);
        }
        let n_bytes = usize::try_from(span.n_bytes).map_err(|_| FileError::TooLarge { max_bytes })?;
        let mut bytes = vec![0; n_bytes];
        self.source
            .read_at(span.at, &mut bytes)
            .map_err(|error| FileError::Io(error.to_string()))?;
        Ok(bytes)
    }
}
