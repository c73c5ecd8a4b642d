//! Scans a recording once, from its first byte to its last, and trusts data with a valid checksum.
//!
//! A chunk or file is either intact or missing. After wrong lengths or checksums, the next chunk or
//! file is searched byte by byte: it counts only if its own checksum is valid. The summary at the
//! end is ignored, since a cut recording has none.

use super::chunk::{CHUNK_HEAD_BYTES, MAX_CHUNK_BYTES};
use super::error::{Damage, Loss, RecordingError};
use super::found::{Found, Home, Packed, Span};
use super::inflate::{Compression, inflate};
use super::source::Source;
use super::wire::{
    ATTACHMENT, CHANNEL, CHUNK, DATA_END, FOOTER, HEAD_BYTES, HEAD_LEN, HEADER, MAGIC, MESSAGE,
    MESSAGE_INDEX, METADATA, Rest, SCHEMA, parse_head,
};

/// Size of a read, unless a larger one is needed.
const WINDOW_BYTES: u64 = 64 << 10;
/// Limit for the path and the media type of an attached file.
const MAX_NAME_BYTES: u64 = 4096;
/// Longest name of a compression in the format.
const MAX_COMPRESSION_BYTES: u64 = 4;
/// Bytes of an attached file's body before its path: two times.
const TIMES_BYTES: u64 = 16;
const CHECKSUM_BYTES: u64 = 4;
/// Number of times that the file's size may be read for apparent chunks and files in damaged parts.
const MAX_TRIALS: u64 = 4;
/// Limit for all decompressed bytes, over the file's size plus one file. Pictures do not compress
/// further, and texts to a tenth.
const MAX_INFLATION: u64 = 100;
/// Number of losses that are listed one by one.
const MAX_LOSSES: usize = 1000;

/// Scans all of it.
pub(super) fn scan(source: &dyn Source) -> Result<Found, RecordingError> {
    let mut scan = Scan {
        source,
        n_bytes: source.n_bytes(),
        at: 0,
        trusted: 0,
        trials_left: source.n_bytes().saturating_mul(MAX_TRIALS),
        inflation_left: max_inflated(source.n_bytes()),
        has_chunk: false,
        is_loose: false,
        has_data_end: false,
        has_footer: false,
        buffer: Vec::new(),
        found: Found::default(),
    };
    scan.run()?;
    Ok(scan.found)
}

/// Limit for the decompressed bytes of a file.
fn max_inflated(n_bytes: u64) -> u64 {
    n_bytes
        .saturating_mul(MAX_INFLATION)
        .saturating_add(MAX_CHUNK_BYTES)
}

struct Scan<'a> {
    source: &'a dyn Source,
    n_bytes: u64,
    at: u64,
    /// Data before this position is verified, or checked as far as possible. From there up to `at`
    /// are presumably indices.
    trusted: u64,
    /// Number of bytes.
    trials_left: u64,
    /// Number of bytes.
    inflation_left: u64,
    has_chunk: bool,
    /// Whether messages are outside of chunks, as some programs write them: all of them are then.
    is_loose: bool,
    has_data_end: bool,
    has_footer: bool,
    /// Buffer of a chunk, reused.
    buffer: Vec<u8>,
    found: Found,
}

/// The header of a chunk.
struct ChunkHead {
    home: Home,
    n_record_bytes: u64,
    checksum: u32,
}

/// The reason why a record is refused.
enum Refused {
    Damage(Damage),
    Io(RecordingError),
}

impl From<Damage> for Refused {
    fn from(damage: Damage) -> Self {
        Self::Damage(damage)
    }
}

impl From<std::io::Error> for Refused {
    fn from(error: std::io::Error) -> Self {
        Self::Io(RecordingError::Io(error.to_string()))
    }
}

impl Scan<'_> {
    fn run(&mut self) -> Result<(), RecordingError> {
        let magic = self.head_bytes(0, MAGIC.len() as u64)?;
        if magic == MAGIC {
            self.at = MAGIC.len() as u64;
        } else {
            self.skip_damage(Damage::Magic)?;
            if self.at == self.n_bytes {
                return Err(RecordingError::NotMcap);
            }
        }
        let is_finished = loop {
            let left = self.n_bytes - self.at;
            if left < HEAD_BYTES {
                let rest = self.head_bytes(self.at, left)?;
                let is_end = rest == MAGIC;
                if left > 0 && !is_end {
                    self.lose(Loss::Cut { at: self.at });
                }
                break is_end && self.has_footer;
            }
            match self.record() {
                Ok(end) => self.at = end,
                Err(Refused::Io(error)) => return Err(error),
                Err(Refused::Damage(damage)) => self.skip_damage(damage)?,
            }
        };
        let is_reported = match self.found.losses.last() {
            Some(Loss::Cut { .. }) => true,
            Some(Loss::Skipped { to, .. }) => *to == self.n_bytes,
            _ => false,
        };
        if !is_finished && !is_reported {
            self.lose(Loss::Unfinished { at: self.n_bytes });
        }
        Ok(())
    }

    fn lose(&mut self, loss: Loss) {
        if matches!(loss, Loss::Skipped { .. }) {
            self.found.gap();
        }
        if self.found.losses.len() < MAX_LOSSES {
            self.found.losses.push(loss);
        }
    }

    /// Up to `n_bytes` bytes, fewer at the end of the file.
    fn head_bytes(&self, at: u64, n_bytes: u64) -> Result<Vec<u8>, RecordingError> {
        let n_bytes = n_bytes.min(self.n_bytes.saturating_sub(at)).min(MAX_CHUNK_BYTES);
        let mut bytes = vec![0; n_bytes as usize];
        self.source
            .read_at(at, &mut bytes)
            .map_err(|error| RecordingError::Io(error.to_string()))?;
        Ok(bytes)
    }

    /// Reads the record at the scan's position, and returns its end.
    fn record(&mut self) -> Result<u64, Refused> {
        let mut head = [0; HEAD_LEN];
        self.source.read_at(self.at, &mut head)?;
        let (opcode, n_bytes) = parse_head(head);
        let body_at = self.at + HEAD_BYTES;
        let end = body_at
            .checked_add(n_bytes)
            .filter(|end| *end <= self.n_bytes)
            .ok_or(Damage::Length)?;
        match opcode {
            CHUNK => {
                self.chunk(body_at, n_bytes)?;
                self.trusted = end;
            }
            ATTACHMENT => {
                self.file(body_at, n_bytes)?;
                self.trusted = end;
            }
            SCHEMA if !self.has_data_end => {
                self.schema(body_at, n_bytes)?;
                self.trusted = end;
            }
            CHANNEL | MESSAGE if self.is_loose && !self.has_data_end => {
                self.loose(n_bytes)?;
                self.trusted = end;
            }
            MESSAGE => return Err(Damage::Unguarded.into()),
            MESSAGE_INDEX => self.index(body_at, n_bytes)?,
            METADATA => {}
            HEADER if self.at == MAGIC.len() as u64 => {}
            DATA_END => self.data_end(body_at, n_bytes)?,
            FOOTER if self.has_data_end => self.has_footer = true,
            // The summary has no data that chunks do not have.
            _ if self.has_data_end => {}
            _ => return Err(Damage::Kind.into()),
        }
        Ok(end)
    }

    /// Checks the lengths of an index: an invalid one may be a chunk whose opcode has one wrong
    /// bit.
    fn index(&self, body_at: u64, n_bytes: u64) -> Result<(), Refused> {
        const HEAD: u64 = 6;
        const ENTRY: u64 = 16;
        let head = self.head_bytes(body_at, HEAD.min(n_bytes)).map_err(Refused::Io)?;
        let mut rest = Rest(&head);
        let n_entry_bytes = rest.u16().and_then(|_channel| rest.u32()).map(u64::from);
        let is_index = n_entry_bytes.is_some_and(|n| n % ENTRY == 0 && n + HEAD == n_bytes);
        Ok(if is_index { Ok(()) } else { Err(Damage::Kind) }?)
    }

    /// The header of a chunk, if it is plausible.
    fn chunk_head(&self, body_at: u64, n_bytes: u64) -> Result<ChunkHead, Refused> {
        let head = self
            .head_bytes(body_at, CHUNK_HEAD_BYTES + MAX_COMPRESSION_BYTES)
            .map_err(Refused::Io)?;
        let mut rest = Rest(&head);
        let _times = rest.take(TIMES_BYTES).ok_or(Damage::Length)?;
        let n_record_bytes = rest.u64().ok_or(Damage::Length)?;
        let checksum = rest.u32().ok_or(Damage::Length)?;
        let n_name_bytes = u64::from(rest.u32().ok_or(Damage::Length)?);
        let name = rest.take(n_name_bytes).ok_or(Damage::Length)?;
        let n_stored_bytes = rest.u64().ok_or(Damage::Length)?;
        let at = CHUNK_HEAD_BYTES + n_name_bytes;
        if n_stored_bytes.checked_add(at) != Some(n_bytes) {
            return Err(Damage::Length.into());
        }
        let max_bytes = MAX_CHUNK_BYTES;
        let home = if name.is_empty() {
            if n_record_bytes != n_stored_bytes {
                return Err(Damage::Length.into());
            }
            Home::At(body_at + at)
        } else {
            Home::Packed(Packed {
                compression: Compression::named(name).ok_or(Damage::Length)?,
                at: body_at + at,
                n_stored_bytes,
                n_record_bytes,
            })
        };
        if n_record_bytes > max_bytes || n_stored_bytes > max_bytes {
            return Err(Damage::TooLarge { max_bytes }.into());
        }
        Ok(ChunkHead {
            home,
            n_record_bytes,
            checksum,
        })
    }

    fn chunk(&mut self, body_at: u64, n_bytes: u64) -> Result<(), Refused> {
        let home = self.check_chunk(body_at, n_bytes)?;
        self.has_chunk = true;
        let is_taken = self.found.chunk(home, &self.buffer);
        Ok(is_taken.ok_or(Damage::Length)?)
    }

    /// Fills the buffer with a chunk's records, and verifies their checksum.
    fn check_chunk(&mut self, body_at: u64, n_bytes: u64) -> Result<Home, Refused> {
        let head = self.chunk_head(body_at, n_bytes)?;
        match head.home {
            Home::At(at) => self.fill_buffer(at, head.n_record_bytes)?,
            Home::Packed(packed) => self.unpack(packed)?,
        }
        // Zero means no checksum.
        if head.checksum == 0 || crc32fast::hash(&self.buffer) == head.checksum {
            Ok(head.home)
        } else {
            Err(Damage::Checksum.into())
        }
    }

    /// Fills the buffer with at most a chunk.
    fn fill_buffer(&mut self, at: u64, n_bytes: u64) -> Result<(), Refused> {
        #[expect(clippy::cast_possible_truncation, reason = "at most a chunk")]
        self.buffer.resize(n_bytes as usize, 0);
        Ok(self.source.read_at(at, &mut self.buffer)?)
    }

    fn unpack(&mut self, packed: Packed) -> Result<(), Refused> {
        if packed.n_record_bytes > self.inflation_left {
            let max_bytes = max_inflated(self.n_bytes);
            return Err(Damage::Inflated { max_bytes }.into());
        }
        self.inflation_left -= packed.n_record_bytes;
        self.fill_buffer(packed.at, packed.n_stored_bytes)?;
        self.buffer = inflate(packed.compression, &self.buffer, packed.n_record_bytes)?;
        Ok(())
    }

    /// An intact schema outside of chunks, before the first of them: messages are outside, too,
    /// then.
    fn schema(&mut self, body_at: u64, n_bytes: u64) -> Result<(), Refused> {
        if self.has_chunk || n_bytes > WINDOW_BYTES {
            return Err(Damage::Kind.into());
        }
        let body = self.head_bytes(body_at, n_bytes).map_err(Refused::Io)?;
        let mut rest = Rest(&body);
        let is_whole = rest.u16().is_some_and(|id| id != 0)
            && rest.text().is_some()
            && rest.text().is_some()
            && rest.u32().and_then(|n| rest.take(n.into())).is_some()
            && rest.0.is_empty();
        self.is_loose |= is_whole;
        Ok(if is_whole { Ok(()) } else { Err(Damage::Kind) }?)
    }

    /// Adds the channel or the message at the scan's position, outside of chunks.
    fn loose(&mut self, n_body_bytes: u64) -> Result<(), Refused> {
        let max_bytes = MAX_CHUNK_BYTES;
        if n_body_bytes > max_bytes {
            return Err(Damage::TooLarge { max_bytes }.into());
        }
        self.fill_buffer(self.at, HEAD_BYTES + n_body_bytes)?;
        let mut rest = Rest(&self.buffer);
        let (opcode, body) = rest.record().ok_or(Damage::Length)?;
        let channel = Rest(body).u16().ok_or(Damage::Length)?;
        if opcode == MESSAGE && !self.found.has_channel(channel) {
            return Err(Damage::Kind.into());
        }
        let is_taken = self.found.chunk(Home::At(self.at), &self.buffer);
        Ok(is_taken.ok_or(Damage::Length)?)
    }

    /// Verifies the checksum of all data, the only one of messages outside of chunks.
    fn data_end(&mut self, body_at: u64, n_bytes: u64) -> Result<(), Refused> {
        let body = self
            .head_bytes(body_at, n_bytes.min(CHECKSUM_BYTES))
            .map_err(Refused::Io)?;
        let checksum = Rest(&body).u32().unwrap_or(0);
        self.has_data_end = true;
        if self.is_loose && checksum != 0 && checksum != self.checksum_of(0, self.at)? {
            self.lose(Loss::Changed);
        }
        Ok(())
    }

    /// Checksum of bytes of the file, read in windows.
    fn checksum_of(&self, from: u64, to: u64) -> Result<u32, Refused> {
        let mut hasher = crc32fast::Hasher::new();
        let mut at = from;
        while at < to {
            let window = self
                .head_bytes(at, WINDOW_BYTES.min(to - at))
                .map_err(Refused::Io)?;
            hasher.update(&window);
            at += window.len() as u64;
        }
        Ok(hasher.finalize())
    }

    /// Path of an attached file and position of its bytes, from its header.
    fn file_head(&self, body_at: u64, n_bytes: u64) -> Result<(String, Span), Refused> {
        let head = self
            .head_bytes(body_at, n_bytes.min(MAX_NAME_BYTES))
            .map_err(Refused::Io)?;
        let mut rest = Rest(&head);
        let _times = rest.take(TIMES_BYTES).ok_or(Damage::Length)?;
        let path = rest.text().ok_or(Damage::Length)?.to_owned();
        let _media_type = rest.text().ok_or(Damage::Length)?;
        let n_data_bytes = rest.u64().ok_or(Damage::Length)?;
        let n_head_bytes = (head.len() - rest.0.len()) as u64;
        let n_fixed = n_head_bytes + CHECKSUM_BYTES;
        if n_data_bytes.checked_add(n_fixed) != Some(n_bytes) {
            return Err(Damage::Length.into());
        }
        let span = Span {
            packed: None,
            at: body_at + n_head_bytes,
            n_bytes: n_data_bytes,
        };
        Ok((path, span))
    }

    fn file(&mut self, body_at: u64, n_bytes: u64) -> Result<(), Refused> {
        let (path, span) = self.check_file(body_at, n_bytes)?;
        self.found.file(path, span);
        Ok(())
    }

    /// Verifies the checksum of an attached file, read in windows.
    fn check_file(&self, body_at: u64, n_bytes: u64) -> Result<(String, Span), Refused> {
        let (path, span) = self.file_head(body_at, n_bytes)?;
        let end = span.at + span.n_bytes;
        let mut checksum = [0; size_of::<u32>()];
        self.source.read_at(end, &mut checksum)?;
        let checksum = u32::from_le_bytes(checksum);
        if checksum != 0 && checksum != self.checksum_of(body_at, end)? {
            return Err(Damage::Checksum.into());
        }
        Ok((path, span))
    }

    /// Continues with the next chunk or file of valid checksum. Apparent indices before the damage
    /// may have been something else, so they are searched again.
    fn skip_damage(&mut self, damage: Damage) -> Result<(), RecordingError> {
        let (from, damaged_at) = (self.trusted, self.at);
        let mut at = from;
        while at + HEAD_BYTES <= self.n_bytes {
            let window = self.head_bytes(at, WINDOW_BYTES)?;
            for (offset, head) in window.windows(HEAD_LEN).enumerate() {
                let Some(head) = head.first_chunk() else { continue };
                if self.is_good(at + offset as u64, *head)? {
                    self.at = at + offset as u64;
                    // If its records are not ours, it is not found again.
                    self.trusted = self.at + 1;
                    self.has_data_end = false;
                    self.lose(Loss::Skipped {
                        from,
                        to: self.at,
                        reason: damage,
                    });
                    return Ok(());
                }
            }
            at += (window.len() as u64 + 1 - HEAD_BYTES).max(1);
        }
        // Nothing follows: a record that reaches beyond the end was cut.
        let loss = match damage {
            Damage::Length => Loss::Cut { at: damaged_at },
            reason => Loss::Skipped {
                from,
                to: self.n_bytes,
                reason,
            },
        };
        self.lose(loss);
        self.at = self.n_bytes;
        Ok(())
    }

    /// Whether a chunk or file of valid checksum begins here.
    fn is_good(&mut self, at: u64, head: [u8; HEAD_LEN]) -> Result<bool, RecordingError> {
        let (opcode, n_bytes) = parse_head(head);
        let body_at = at + HEAD_BYTES;
        if body_at.checked_add(n_bytes).is_none_or(|end| end > self.n_bytes) {
            return Ok(false);
        }
        let seems = match opcode {
            CHUNK => self.chunk_head(body_at, n_bytes).map(|_| ()),
            ATTACHMENT => self.file_head(body_at, n_bytes).map(|_| ()),
            _ => return Ok(false),
        };
        match seems {
            Ok(()) => {}
            Err(Refused::Damage(_)) => return Ok(false),
            Err(Refused::Io(error)) => return Err(error),
        }
        if n_bytes > self.trials_left {
            return Ok(false);
        }
        self.trials_left -= n_bytes;
        let tried = match opcode {
            CHUNK => self.check_chunk(body_at, n_bytes).map(|_| ()),
            _ => self.check_file(body_at, n_bytes).map(|_| ()),
        };
        match tried {
            Ok(()) => Ok(true),
            Err(Refused::Damage(_)) => Ok(false),
            Err(Refused::Io(error)) => Err(error),
        }
    }
}
